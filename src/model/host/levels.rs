//! The levels of memory: what it takes to bring the bytes of a vector from where they lie.

use super::reuse::{LINE, Since, Touch, Vector, element_bytes};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::{Outlines, Place};
use stripmine_kernels::isa::Array;

/// A level of memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Its name.
    pub name: String,
    /// Up to which reuse distance it serves (bytes); none for the last.
    pub capacity: Option<f64>,
    /// What it costs passes of the interpreter.
    pub passes: Transfer,
    /// What it costs compiled loops, which have many streams at once, and more to do meanwhile.
    pub loops: Transfer,
}

/// What it takes to bring something from a level; none is cheaper than a nearer one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transfer {
    /// Nanoseconds a byte of a vector that is read or written comes from there.
    pub fetch: f64,
    /// The same for an array that other programs have used since: no prefetcher follows it yet.
    pub fetch_array: f64,
    /// Additional nanoseconds a byte where the vector is written, for it must be written back.
    pub write_back: f64,
    /// Nanoseconds until a pass over an array has the first of it.
    pub first: f64,
    /// Nanoseconds a line that is met through an index vector and that nothing announces: the line before it was not met.
    pub line: f64,
}

/// The share that a cache of `capacity` bytes has lost of what was touched `distance` bytes ago. Half an octave around
/// a capacity belongs to both levels, for caches do not end sharply.
pub fn beyond(distance: f64, capacity: f64) -> f64 {
    ((distance / capacity).log2() + 0.5).clamp(0.0, 1.0)
}

/// What something costs that was last touched `distance` bytes ago.
pub fn from_afar(levels: &[Level], distance: f64, cost: impl Fn(&Level) -> f64) -> f64 {
    let nearest = levels.first().map_or(0.0, &cost);
    let farther = levels
        .windows(2)
        .filter_map(|pair| Some(beyond(distance, pair[0].capacity?) * (cost(&pair[1]) - cost(&pair[0]))));
    nearest + farther.sum::<f64>()
}

/// Lines that an element meets through an index vector.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lines {
    /// After the line before them: they come as a stream does.
    foreseen: f64,
    /// After one that was passed over.
    unforeseen: f64,
}

impl Lines {
    /// Of elements that lie on lines at random, `elements` a line: Poisson's law says how many lines are met at all, and of
    /// how many the line before is not. Where they come `in_order`, all are foreseen.
    fn met(elements: f64, in_order: bool) -> Lines {
        let passed_over = (-elements).exp();
        let met = (1.0 - passed_over) / elements;
        let unforeseen = if in_order { 0.0 } else { met * passed_over };
        Lines { foreseen: met - unforeseen, unforeseen }
    }
}

/// Nanoseconds of waiting for memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wait {
    /// For vectors met element by element, and for lines of others that follow those before.
    pub streamed: f64,
    /// For lines met through an index vector that nothing announces.
    pub indexed: f64,
    /// Whether anything came from beyond the nearest level: 0 to 1.
    pub far: f64,
}

impl Wait {
    /// For both.
    pub fn sum(self) -> f64 {
        self.streamed + self.indexed
    }
}

/// The arrays around a program: how long each is, and how much is touched between its last use and this one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Elements of the program's vectors, strips or not.
    whole: f64,
    arrays: BTreeMap<(Array, &'static str), Neighbourhood>,
}

/// An array as a program finds it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Neighbourhood {
    /// All its bytes.
    extent: f64,
    /// Bytes touched since it was.
    distance: f64,
}

impl Surroundings {
    /// Of each of some programs, run one after the other over vectors of these lengths again and again, each of which
    /// touches `registers` bytes of registers in addition.
    ///
    /// Eager execution goes over one array after the other; every other one over all of a program's at once, so that what
    /// it has touched last are the ends of all of them.
    pub fn of_cycle(
        programs: &[(&Outlines, usize)],
        execution: Execution,
        registers: f64,
    ) -> Vec<Surroundings> {
        let mut extents: BTreeMap<(Array, &'static str), [f64; 2]> = BTreeMap::new();
        let uses: Vec<Vec<(Array, &'static str)>> = programs
            .iter()
            .map(|(outlines, n)| {
                let mut used = vec![];
                for place in outlines.passes.iter().flat_map(|pass| pass.reads.iter().chain(&pass.writes)) {
                    let (Place::Memory(reference) | Place::Indexed(reference)) = place else { continue };
                    let name = (reference.array, reference.element);
                    let met_directly = usize::from(matches!(place, Place::Memory(_)));
                    let extent = &mut extents.entry(name).or_default()[met_directly];
                    *extent = extent.max(element_bytes(name.1) * *n as f64);
                    if !used.contains(&name) {
                        used.push(name);
                    }
                }
                used
            })
            .collect();
        // What is met element by element somewhere is as long as there; an index vector says nothing about it.
        let extent = |name: &Option<(Array, &'static str)>| match name.map(|name| extents.get(&name)) {
            Some(Some(&[_, directly])) if directly > 0.0 => directly,
            Some(Some(&[through, _])) => through,
            Some(None) => 0.0,
            None => registers,
        };
        // Arrays in the order in which they were last used, and in which turn; the registers, which all programs share, have
        // no name.
        let mut stack: Vec<(usize, Option<(Array, &'static str)>)> = vec![];
        let mut turn = 0;
        let mut around: Vec<Surroundings> = programs
            .iter()
            .map(|(_, n)| Surroundings { whole: *n as f64, ..Surroundings::default() })
            .collect();
        // Twice: in the first round everything is new.
        for (used, surroundings) in uses.iter().zip(0..).chain(uses.iter().zip(0..)) {
            turn += 1;
            for name in used.iter().copied().map(Some).chain([None]) {
                turn += usize::from(execution == Execution::Eager);
                let at = stack.iter().rposition(|(_, known)| *known == name);
                let since = at.map_or(0, |at| stack[at].0);
                let behind = stack.iter().filter(|(turn, _)| *turn >= since);
                let distance: f64 = behind.map(|(_, name)| extent(name)).sum();
                if let Some(at) = at {
                    stack.remove(at);
                }
                stack.push((turn, name));
                if let Some(named) = name {
                    let there = Neighbourhood { extent: extent(&name), distance };
                    around[surroundings].arrays.insert(named, there);
                }
            }
        }
        around
    }

    /// The arrays.
    pub fn arrays(&self) -> impl Iterator<Item = (Array, &'static str)> {
        self.arrays.keys().copied()
    }

    /// How long a pass over `n` elements waits for what it touches, where levels cost what `of` says.
    pub fn wait(&self, levels: &[Level], touches: &[Touch], n: f64, of: impl Fn(&Level) -> Transfer) -> Wait {
        let mut wait = Wait::default();
        for touch in touches {
            let there = match touch.vector {
                Vector::Array(array, element) => self.arrays.get(&(array, element)).copied(),
                Vector::Register(_) => None,
            };
            let distance = match touch.since {
                Since::Here(distance) => distance * n,
                Since::Before => there.map_or(0.0, |array| array.distance),
            };
            let nearest = levels.first().and_then(|level| level.capacity);
            wait.far = nearest.map_or(0.0, |capacity| beyond(distance, capacity)).max(wait.far);
            let fetch = |level: &Level| match touch.since {
                Since::Here(_) => of(level).fetch,
                Since::Before => of(level).fetch_array,
            };
            if touch.since == Since::Before {
                wait.streamed += from_afar(levels, distance, |level| of(level).first);
            }
            if let Some(array) = there.filter(|_| touch.indexed) {
                let Lines { foreseen, unforeseen } =
                    Lines::met(self.whole.max(n) / (array.extent / LINE), touch.in_order());
                wait.indexed += n * unforeseen * from_afar(levels, distance, |level| of(level).line);
                wait.streamed += n * foreseen * LINE * from_afar(levels, distance, fetch);
                continue;
            }
            let written = f64::from(u8::from(touch.written));
            let byte = from_afar(levels, distance, |level| fetch(level) + written * of(level).write_back);
            wait.streamed += touch.bytes * n * byte;
        }
        wait
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::backend::tape::{Outline, Reference};
    use stripmine_kernels::isa::Op;

    fn levels() -> Vec<Level> {
        let level = |name: &str, capacity, fetch, write_back| Level {
            name: name.to_owned(),
            capacity,
            passes: Transfer { fetch, fetch_array: fetch, write_back, ..Transfer::default() },
            ..Level::default()
        };
        vec![level("near", Some(1024.0), 0.0, 0.0), level("far", None, 0.5, 0.25)]
    }

    #[test]
    fn bytes_cost_more_from_afar_and_more_where_they_go_back() {
        let cost = |distance, written| {
            from_afar(&levels(), distance, |level| {
                let Transfer { fetch, write_back, .. } = level.passes;
                fetch + if written { write_back } else { 0.0 }
            })
        };
        assert_eq!([cost(64.0, true), cost(1e6, false), cost(1e6, true)], [0.0, 0.5, 0.75]);
        assert_eq!(cost(1024.0, false), 0.25);
    }

    /// By hand: 100 elements of 8 bytes, met a byte at a time at the costs of memory far away.
    #[test]
    fn a_pass_waits_for_what_it_fetches_and_writes_back() {
        let mut levels = levels();
        levels[1].passes = Transfer { fetch: 0.5, fetch_array: 2.0, write_back: 0.25, first: 7.0, line: 3.0 };
        let array = Vector::Array(Array::X, "f64");
        let touch = |since, written, indexed| Touch { vector: array, bytes: 8.0, since, written, indexed };
        let far = Neighbourhood { extent: 800.0, distance: 1e9 };
        let arrays = BTreeMap::from([((Array::X, "f64"), far)]);
        let around = Surroundings { whole: 100.0, arrays };
        let wait = |touch: Touch| around.wait(&levels, &[touch], 100.0, |level| level.passes);
        let streamed = |touch| wait(touch).streamed;
        // In the same pass: 800 bytes at 0.5, and 0.25 more where they go back; as an array: at 2, and the first byte.
        assert_eq!(streamed(touch(Since::Here(1e7), false, false)), 400.0);
        assert_eq!(streamed(touch(Since::Here(1e7), true, false)), 600.0);
        assert_eq!(streamed(touch(Since::Before, false, false)), 1607.0);
        assert_eq!(streamed(touch(Since::Here(1.0), true, false)), 0.0);
        // Eight elements a line: lines after those before cost their bytes, the others a line each.
        let met = wait(touch(Since::Before, false, true));
        let Lines { foreseen, unforeseen } = Lines::met(8.0, false);
        assert!((met.streamed - (7.0 + 100.0 * foreseen * LINE * 2.0)).abs() < 1e-9, "{met:?}");
        assert!((met.indexed - 100.0 * unforeseen * 3.0).abs() < 1e-9 && met.indexed > 0.0, "{met:?}");
        assert_eq!(met.sum(), met.streamed + met.indexed);
        assert_eq!(met.far, 1.0);
    }

    #[test]
    fn lines_are_foreseen_where_none_is_passed_over() {
        // Every element its own line, far from the others; many on every line; and lines in order.
        let [rare, dense, ordered] =
            [(0.01, false), (10.0, false), (0.01, true)].map(|(elements, order)| Lines::met(elements, order));
        assert!(rare.unforeseen > 0.98 && rare.foreseen < 0.01, "{rare:?}");
        assert!(dense.unforeseen < 1e-5 && (dense.foreseen - 0.1).abs() < 1e-4, "{dense:?}");
        assert_eq!((ordered.unforeseen, ordered.foreseen), (0.0, rare.foreseen + rare.unforeseen));
    }

    #[test]
    fn an_array_is_as_far_as_all_that_is_touched_in_a_cycle() {
        let read = |array| {
            let from = Place::Memory(Reference { array, element: "f64", shift: 0 });
            let pass = Outline { op: Op::Load, converts: false, reads: vec![from], writes: None };
            Outlines { lane: "f64", instructions: vec![], passes: vec![pass], registers: [0; 3] }
        };
        let [x, y] = [read(Array::X), read(Array::Y)];
        let around = Surroundings::of_cycle(&[(&x, 10), (&y, 100), (&y, 100)], Execution::Eager, 0.0);
        let distance = |at: usize, array| around[at].arrays[&(array, "f64")].distance;
        assert_eq!(
            [distance(0, Array::X), distance(1, Array::Y), distance(2, Array::Y)],
            [880.0, 880.0, 800.0]
        );
        // One after the other what comes last is near; all at once, their ends are.
        let both = Outlines { passes: [x.passes.clone(), y.passes.clone()].concat(), ..read(Array::X) };
        for (execution, near) in [(Execution::Eager, 80.0), (Execution::Chained, 160.0)] {
            let around = Surroundings::of_cycle(&[(&both, 10), (&y, 10)], execution, 0.0);
            assert_eq!(around[1].arrays[&(Array::Y, "f64")].distance, near);
        }
        // Each program goes over the registers: they lie between.
        let around = Surroundings::of_cycle(&[(&x, 10), (&y, 100)], Execution::Eager, 1000.0);
        assert_eq!(around[0].arrays[&(Array::X, "f64")].distance, 1880.0);
    }
}
