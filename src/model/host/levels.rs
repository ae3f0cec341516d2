//! The levels of memory: what it takes to bring the bytes of a vector from where they lie.

use super::reuse::{Since, Touch, Vector, element_bytes};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::backend::tape::{Outlines, Place};
use stripmine_kernels::isa::Array;

/// A level of memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Its name.
    pub name: String,
    /// Up to which reuse distance it serves (bytes); none for the last.
    pub capacity: Option<f64>,
    /// Nanoseconds a byte of a vector that is read or written comes from there; none is cheaper than a nearer one.
    pub fetch: f64,
    /// Nanoseconds a byte besides where the vector is written: it must go back.
    pub write_back: f64,
    /// Nanoseconds a line that is met through an index vector, where no stream can be foreseen.
    pub line: f64,
}

/// Bytes of a line, the least that moves between levels.
pub const LINE: f64 = 64.0;

/// How much of what lies `distance` bytes back a cache of so many bytes has lost; half an octave around a capacity belongs
/// to both levels, for caches do not end sharply.
pub fn beyond(distance: f64, capacity: f64) -> f64 {
    ((distance / capacity).log2() + 0.5).clamp(0.0, 1.0)
}

/// What something costs that was last touched so many bytes ago.
pub fn from_afar(levels: &[Level], distance: f64, cost: impl Fn(&Level) -> f64) -> f64 {
    let nearest = levels.first().map_or(0.0, &cost);
    let farther = levels
        .windows(2)
        .filter_map(|pair| Some(beyond(distance, pair[0].capacity?) * (cost(&pair[1]) - cost(&pair[0]))));
    nearest + farther.sum::<f64>()
}

/// Nanoseconds of waiting for memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wait {
    /// For vectors met element by element.
    pub streamed: f64,
    /// For those met through an index vector.
    pub indexed: f64,
}

impl Wait {
    /// Both.
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
    /// touches so many bytes of registers besides.
    pub fn of_cycle(programs: &[(&Outlines, usize)], registers: f64) -> Vec<Surroundings> {
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
        // Arrays in the order in which they were last used; the registers, which all programs share, have no name.
        let mut stack: Vec<Option<(Array, &'static str)>> = vec![];
        let mut around: Vec<Surroundings> = programs
            .iter()
            .map(|(_, n)| Surroundings { whole: *n as f64, ..Surroundings::default() })
            .collect();
        // Twice: in the first round everything is new.
        for (used, surroundings) in uses.iter().zip(0..).chain(uses.iter().zip(0..)) {
            for name in used.iter().copied().map(Some).chain([None]) {
                let at = stack.iter().rposition(|known| *known == name);
                let behind = &stack[at.unwrap_or(0)..];
                let distance: f64 = behind.iter().map(extent).sum();
                if let Some(at) = at {
                    stack.remove(at);
                }
                stack.push(name);
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

    /// How long a pass over `n` elements waits for what it touches.
    pub fn wait(&self, levels: &[Level], touches: &[Touch], n: f64) -> Wait {
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
            if let Some(array) = there.filter(|_| touch.indexed) {
                // As many lines as there are, at most one an element.
                let lines = (array.extent / LINE / self.whole.max(n)).min(1.0);
                wait.indexed += n * lines * from_afar(levels, distance, |level| level.line);
                continue;
            }
            let written = f64::from(u8::from(touch.written));
            let byte = from_afar(levels, distance, |level| level.fetch + written * level.write_back);
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
            fetch,
            write_back,
            line: 0.0,
        };
        vec![level("near", Some(1024.0), 0.0, 0.0), level("far", None, 0.5, 0.25)]
    }

    #[test]
    fn bytes_cost_more_from_afar_and_more_where_they_go_back() {
        let cost = |distance, written| {
            from_afar(&levels(), distance, |level| level.fetch + if written { level.write_back } else { 0.0 })
        };
        assert_eq!([cost(64.0, true), cost(1e6, false), cost(1e6, true)], [0.0, 0.5, 0.75]);
        assert_eq!(cost(1024.0, false), 0.25);
    }

    #[test]
    fn an_array_is_as_far_as_all_that_is_touched_in_a_cycle() {
        let read = |array| {
            let from = Place::Memory(Reference { array, element: "f64", shift: 0 });
            let pass = Outline { op: Op::Load, converts: false, reads: vec![from], writes: None };
            Outlines { lane: "f64", instructions: vec![], passes: vec![pass], registers: [0; 3] }
        };
        let [x, y] = [read(Array::X), read(Array::Y)];
        let around = Surroundings::of_cycle(&[(&x, 10), (&y, 100), (&y, 100)], 0.0);
        let distance = |at: usize, array| around[at].arrays[&(array, "f64")].distance;
        assert_eq!(
            [distance(0, Array::X), distance(1, Array::Y), distance(2, Array::Y)],
            [880.0, 880.0, 800.0]
        );
        // Each program goes over the registers: they lie between.
        let around = Surroundings::of_cycle(&[(&x, 10), (&y, 100)], 1000.0);
        assert_eq!(around[0].arrays[&(Array::X, "f64")].distance, 1880.0);
    }
}
