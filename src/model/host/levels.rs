//! The levels of memory: what a byte takes, by how much is gone over before it is met again.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::{Outlines, Place};
use stripmine_kernels::isa::Array;

/// A level of memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// The footprint at which a byte takes this long; between two levels it is in between, by the logarithm (bytes).
    pub footprint: f64,
    /// Nanoseconds a byte of a pass of the interpreter.
    pub interpreted: f64,
    /// Nanoseconds a byte of a compiled loop, which has many streams at once.
    pub chained: f64,
}

/// By how much each of some levels counts for a footprint: two of them share it.
pub fn shares(footprints: &[f64], footprint: f64) -> Vec<f64> {
    let mut shares = vec![0.0; footprints.len()];
    let Some(last) = footprints.len().checked_sub(1) else { return shares };
    let next = footprints.partition_point(|&at| at <= footprint).min(last);
    let (low, high) = (footprints[next.saturating_sub(1)], footprints[next]);
    let share = if low < high { (footprint / low).ln() / (high / low).ln() } else { 1.0 };
    shares[next] = share.clamp(0.0, 1.0);
    shares[next.saturating_sub(1)] += 1.0 - shares[next];
    shares
}

/// Bytes of a line, the least that moves between levels.
const LINE: f64 = 64.0;

type Name = (Array, &'static str);

/// The arrays of a step, and how many bytes each has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Around(BTreeMap<Name, f64>);

/// Bytes that are moved, and how many are gone over before they are met again.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moved {
    bytes: f64,
    footprint: f64,
}

impl Around {
    /// Of programs that run one after the other over vectors of these lengths.
    pub fn of_step(programs: &[(&Outlines, usize)]) -> Around {
        // What is met element by element somewhere is as long as there; an index vector says nothing about it.
        let mut direct: BTreeMap<Name, f64> = BTreeMap::new();
        let mut indexed = direct.clone();
        for (outlines, n) in programs {
            for place in outlines.passes.iter().flat_map(|pass| pass.reads.iter().chain(&pass.writes)) {
                let (extents, reference) = match place {
                    Place::Memory(reference) => (&mut direct, reference),
                    Place::Indexed(reference) => (&mut indexed, reference),
                    Place::Register(_) => continue,
                };
                let extent = extents.entry((reference.array, reference.element)).or_default();
                *extent = extent.max(element_bytes(reference.element) * *n as f64);
            }
        }
        indexed.extend(direct);
        Around(indexed)
    }

    /// What a program moves in a strip of `n` elements: arrays that it meets for the first time, which lie as far as all of the
    /// step's, and what it meets again or has in registers, of `register_bytes` by file.
    fn moved(&self, outlines: &Outlines, n: f64, register_bytes: [f64; 3]) -> [Moved; 2] {
        let (mut first, mut again, mut met) = (0.0, 0.0, vec![]);
        for place in outlines.passes.iter().flat_map(|pass| pass.reads.iter().chain(&pass.writes)) {
            let (Place::Memory(reference) | Place::Indexed(reference)) = place else {
                let Place::Register(name) = place else { continue };
                again += n * register_bytes[name.file as usize];
                continue;
            };
            let name = (reference.array, reference.element);
            // A line for an element that an index leads to, but no more than there is.
            let bytes = match place {
                Place::Indexed(_) => (n * LINE).min(self.0.get(&name).copied().unwrap_or(f64::INFINITY)),
                _ => n * element_bytes(name.1),
            };
            if met.contains(&name) {
                again += bytes;
            } else {
                met.push(name);
                first += bytes;
            }
        }
        let files = outlines.registers.iter().zip(register_bytes);
        let registers: f64 = files.map(|(&count, bytes)| count as f64 * bytes * n).sum();
        let arrays: f64 = met.iter().map(|(_, element)| n * element_bytes(element)).sum();
        [
            Moved { bytes: first, footprint: registers + self.0.values().sum::<f64>() },
            Moved { bytes: again, footprint: registers + arrays },
        ]
    }

    /// Bytes that a run over `n` elements moves from each level, by the footprints of these.
    pub fn bytes(
        &self,
        outlines: &Outlines,
        (n, execution): (usize, Execution),
        register_bytes: [f64; 3],
        footprints: &[f64],
    ) -> Vec<f64> {
        let mut bytes = vec![0.0; footprints.len()];
        for (times, length) in strips(n, execution) {
            let [first, again] = self.moved(outlines, length as f64, register_bytes);
            // A loop keeps what it meets again in hardware registers.
            let again = (execution != Execution::Chained).then_some(again);
            for moved in [Some(first), again].into_iter().flatten() {
                let shares = shares(footprints, moved.footprint);
                bytes.iter_mut().zip(shares).for_each(|(sum, share)| *sum += times * share * moved.bytes);
            }
        }
        bytes
    }
}

/// How often an execution goes over how many elements.
pub fn strips(n: usize, execution: Execution) -> impl Iterator<Item = (f64, usize)> {
    let strip = if let Execution::Strip(strip) = execution { strip.min(n) } else { n }.max(1);
    [((n / strip) as f64, strip), (1.0, n % strip)].into_iter().filter(|&(times, n)| times > 0.0 && n > 0)
}

/// Bytes of an element type by its name.
fn element_bytes(element: &str) -> f64 {
    if element == "f64" { 8.0 } else { 4.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::backend::tape::{File, Outline, Reference, RegisterName};
    use stripmine_kernels::isa::Op;

    #[test]
    fn two_levels_share_a_footprint_by_its_logarithm() {
        let levels = [10.0, 1000.0, 1e6];
        assert_eq!(shares(&levels, 1.0), [1.0, 0.0, 0.0]);
        assert_eq!(shares(&levels, 1e9), [0.0, 0.0, 1.0]);
        let between = shares(&levels, 100.0);
        assert!((between[0] - 0.5).abs() < 1e-12 && (between[1] - 0.5).abs() < 1e-12, "{between:?}");
        assert_eq!((shares(&[5.0], 2.0), shares(&[], 2.0)), (vec![1.0], vec![]));
    }

    /// By hand: an array met twice, one through an index, and a register, by a program over 10 of 100 elements.
    #[test]
    fn the_first_use_of_an_array_comes_from_the_step_and_the_next_from_the_strip() {
        let x = Reference { array: Array::X, element: "f64", shift: 0 };
        let y = Reference { array: Array::Y, element: "f32", shift: 0 };
        let register = Place::Register(RegisterName { file: File::Number, number: 0 });
        let pass = |reads: &[Place]| Outline {
            op: Op::Add,
            converts: false,
            reads: reads.to_vec(),
            writes: Some(register),
        };
        let passes = vec![pass(&[Place::Memory(x)]), pass(&[Place::Memory(x), Place::Indexed(y)])];
        let program = Outlines { lane: "f64", instructions: vec![], passes, registers: [3, 0, 0] };
        let around = Around::of_step(&[(&program, 100)]);
        let [first, again] = around.moved(&program, 10.0, [8.0, 1.0, 4.0]);
        // 80 bytes of x, and a whole y instead of ten lines; three registers of 80 bytes and arrays of 800 and 400.
        assert_eq!((first.bytes, first.footprint), (80.0 + 400.0, 240.0 + 1200.0));
        assert_eq!((again.bytes, again.footprint), (80.0 + 2.0 * 80.0, 240.0 + 80.0 + 40.0));
        let bytes = |execution| around.bytes(&program, (100, execution), [8.0, 1.0, 4.0], &[64.0])[0];
        assert_eq!(bytes(Execution::Strip(10)), 10.0 * (480.0 + 240.0));
        // A loop meets x and y once, in no registers.
        assert_eq!(bytes(Execution::Chained), 800.0 + 400.0);
    }
}
