//! Costs of a program: the amounts that a run is charged for, and their prices.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::{Outline, Outlines, VectorLocation};
use stripmine_kernels::isa::{Array, OpClass};

/// Prices of a kind of execution on lanes of one element type (ns).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExecutionPrices {
    /// Price of a run of a program.
    pub run: f64,
    /// Price of the start of a pass of the interpreter.
    pub start: f64,
    /// Price of an operation on an element.
    pub(crate) operation: f64,
    /// Additional price through an index vector.
    pub indexed: f64,
    /// Price of a byte, at each of the footprints.
    pub bytes: Vec<f64>,
}

/// Costs on lanes of one element type, and the layout of their registers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaneCosts {
    /// Bytes of an element in a register of each file (numbers, predicates, indices).
    pub(crate) register_bytes: [f64; 3],
    /// Lanes of a hardware register.
    pub lanes: usize,
    /// Prices of the interpreter, pass by pass.
    pub(crate) interpreted: ExecutionPrices,
    /// Prices of a compiled loop.
    pub(crate) chained: ExecutionPrices,
}

/// Amounts that a run of a program is charged for: a run, starts of passes, operations on elements, those through an index vector, and bytes at
/// each footprint.
pub(crate) type Charges = Vec<f64>;

impl ExecutionPrices {
    /// Prices in the order of `Charges`.
    pub(crate) fn of(prices: &[f64]) -> ExecutionPrices {
        let [run, start, operation, indexed] =
            std::array::from_fn(|at| prices.get(at).copied().unwrap_or(0.0));
        ExecutionPrices { run, start, operation, indexed, bytes: prices.iter().skip(4).copied().collect() }
    }

    /// Total of the charges in nanoseconds.
    pub(crate) fn total(&self, charges: &Charges) -> f64 {
        let prices = [self.run, self.start, self.operation, self.indexed]
            .into_iter()
            .chain(self.bytes.iter().copied());
        prices.zip(charges).map(|(price, amount)| price * amount).sum()
    }
}

/// Charges of a run of a program over `n` elements, with registers of this layout, among the arrays of its step.
pub(crate) fn charges(
    outlines: &Outlines,
    (n, execution): (usize, Execution),
    (register_bytes, lanes): ([f64; 3], usize),
    around: &StepArrays,
    footprints: &[f64],
) -> Charges {
    let is_chained = execution == Execution::Chained;
    let all = if is_chained { &outlines.instructions } else { &outlines.passes };
    let (mut operations, mut indexed) = (0.0, 0.0);
    for op in all.iter().flat_map(Outline::operations) {
        operations += n as f64;
        if matches!(op.class(), OpClass::Gather | OpClass::Scatter) {
            indexed += n as f64;
        }
    }
    let mut charges = vec![1.0, 0.0, operations, indexed];
    charges.resize(4 + footprints.len(), 0.0);
    for (times, length) in strips(n, execution) {
        if !is_chained {
            // Elements beyond whole hardware registers are processed one by one, in a pass of their own.
            let is_whole = length < lanes || length.is_multiple_of(lanes.max(1));
            charges[1] += times * outlines.passes.len() as f64 * if is_whole { 1.0 } else { 2.0 };
        }
        let [first, again] = around.moved(outlines, length as f64, register_bytes);
        // A loop keeps data that it visits again in hardware registers.
        for moved in if is_chained { vec![first] } else { vec![first, again] } {
            let shares = shares(footprints, moved.footprint);
            charges[4..].iter_mut().zip(shares).for_each(|(sum, share)| *sum += times * share * moved.bytes);
        }
    }
    charges
}

/// Weights of some points for a value: its two neighbours share it, by logarithmic interpolation.
fn shares(points: &[f64], value: f64) -> Vec<f64> {
    let mut shares = vec![0.0; points.len()];
    let Some(last) = points.len().checked_sub(1) else { return shares };
    let next = points.partition_point(|&at| at <= value).min(last);
    let (low, high) = (points[next.saturating_sub(1)], points[next]);
    let share = if low < high { (value / low).ln() / (high / low).ln() } else { 1.0 };
    shares[next] = share.clamp(0.0, 1.0);
    shares[next.saturating_sub(1)] += 1.0 - shares[next];
    shares
}

/// Bytes of a cache line, the smallest transfer between levels.
const LINE: f64 = 64.0;

/// Arrays of a step by name and element type, with their sizes in bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StepArrays(BTreeMap<(Array, &'static str), f64>);

/// Bytes moved, and the footprint between two visits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MovedBytes {
    bytes: f64,
    footprint: f64,
}

impl StepArrays {
    /// Collects the arrays of programs that run one after the other over vectors of these lengths.
    pub(crate) fn of_step(programs: &[(&Outlines, usize)]) -> StepArrays {
        // An array visited element by element has that length; an index vector gives no length.
        let [mut direct, mut indexed]: [BTreeMap<_, f64>; 2] = Default::default();
        for (outlines, n) in programs {
            for place in places(outlines) {
                let (extents, reference) = match place {
                    VectorLocation::Memory(reference) => (&mut direct, reference),
                    VectorLocation::Indexed(reference) => (&mut indexed, reference),
                    VectorLocation::Register(_) => continue,
                };
                let extent = extents.entry((reference.array, reference.element)).or_default();
                *extent = extent.max(element_bytes(reference.element) * *n as f64);
            }
        }
        indexed.extend(direct);
        StepArrays(indexed)
    }

    /// Bytes of all arrays.
    pub(crate) fn footprint(&self) -> f64 {
        self.0.values().sum()
    }

    /// Bytes that a run of a program moves between memory or caches and the hardware's registers. A compiled loop moves each element of an array
    /// once.
    pub(crate) fn bytes(&self, outlines: &Outlines, n: usize, execution: Execution) -> f64 {
        // Registers of the interpreter are in memory; their sizes are those of f64 with packed predicates.
        let register_bytes = [8.0, 0.125, 4.0];
        let of_strip = |(times, length): (f64, usize)| {
            let [first, again] = self.moved(outlines, length as f64, register_bytes);
            times * if execution == Execution::Chained { first.bytes } else { first.bytes + again.bytes }
        };
        strips(n, execution).map(of_strip).sum()
    }

    /// Bytes that a program moves in a strip of `n` elements: of arrays that it visits for the first time, at the footprint of the whole
    /// step, and of arrays that it visits again or has in registers, of `register_bytes` by file.
    fn moved(&self, outlines: &Outlines, n: f64, register_bytes: [f64; 3]) -> [MovedBytes; 2] {
        let (mut first, mut again, mut visited) = (0.0, 0.0, vec![]);
        for place in places(outlines) {
            let (bytes, reference) = match place {
                VectorLocation::Register(name) => {
                    again += n * register_bytes[name.file as usize];
                    continue;
                }
                VectorLocation::Memory(it) => (n * element_bytes(it.element), it),
                // An indexed element moves a whole line, but at most the whole array.
                VectorLocation::Indexed(it) => {
                    let all = self.0.get(&(it.array, it.element)).copied().unwrap_or(f64::INFINITY);
                    ((n * LINE).min(all), it)
                }
            };
            let name = (reference.array, reference.element);
            if visited.contains(&name) {
                again += bytes;
            } else {
                visited.push(name);
                first += bytes;
            }
        }
        let files = outlines.registers.iter().zip(register_bytes);
        let registers: f64 = files.map(|(&count, bytes)| count as f64 * bytes * n).sum();
        let arrays: f64 = visited.iter().map(|(_, element)| n * element_bytes(element)).sum();
        [
            MovedBytes { bytes: first, footprint: registers + self.footprint() },
            MovedBytes { bytes: again, footprint: registers + arrays },
        ]
    }
}

fn places(outlines: &Outlines) -> impl Iterator<Item = &VectorLocation> {
    outlines.passes.iter().flat_map(|pass| pass.reads.iter().chain(&pass.writes))
}

/// Strips of an execution: their number and length.
fn strips(n: usize, execution: Execution) -> impl Iterator<Item = (f64, usize)> {
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
    use stripmine_kernels::backend::tape::{ArrayReference, RegisterKind, RegisterName};
    use stripmine_kernels::isa::Op;

    const SHAPE: ([f64; 3], usize) = ([8.0, 1.0, 4.0], 4);

    #[test]
    fn weights_interpolate_logarithmically() {
        let levels = [10.0, 1000.0, 1e6];
        assert_eq!(shares(&levels, 1.0), [1.0, 0.0, 0.0]);
        assert_eq!(shares(&levels, 1e9), [0.0, 0.0, 1.0]);
        let between = shares(&levels, 100.0);
        assert!((between[0] - 0.5).abs() < 1e-12 && (between[1] - 0.5).abs() < 1e-12, "{between:?}");
        assert_eq!((shares(&[5.0], 2.0), shares(&[], 2.0)), (vec![1.0], vec![]));
    }

    #[test]
    fn charges_include_operations_and_pass_starts() {
        let of = |op| Outline { op, converts: false, reads: vec![], writes: None };
        let (passes, instructions) =
            (vec![of(Op::Add), of(Op::Gather)], vec![of(Op::Load), of(Op::Multiply)]);
        let program = Outlines { lane: "f64", instructions, passes, registers: [0; 3] };
        let charged = |n, execution| charges(&program, (n, execution), SHAPE, &StepArrays::default(), &[]);
        assert_eq!(charged(8, Execution::Eager), [1.0, 2.0, 16.0, 8.0]);
        // Passes start twice where elements are left over, and once per strip.
        assert_eq!(charged(9, Execution::Eager), [1.0, 4.0, 18.0, 9.0]);
        assert_eq!(charged(9, Execution::Strip(4)), [1.0, 6.0, 18.0, 9.0]);
        assert_eq!(charged(9, Execution::Chained), [1.0, 0.0, 18.0, 0.0]);
        let costs = ExecutionPrices::of(&[100.0, 10.0, 0.5, 2.0]);
        assert_eq!(costs.total(&charged(8, Execution::Eager)), 100.0 + 20.0 + 8.0 + 16.0);
    }

    /// By hand: an array visited twice, one through an index, and a register, by a program over 10 of 100 elements.
    #[test]
    fn first_visits_have_the_step_footprint() {
        let x = ArrayReference { array: Array::X, element: "f64", shift: 0 };
        let y = ArrayReference { array: Array::Y, element: "f32", shift: 0 };
        let register = VectorLocation::Register(RegisterName { file: RegisterKind::Number, number: 0 });
        let pass = |reads: &[VectorLocation]| Outline {
            op: Op::Add,
            converts: false,
            reads: reads.to_vec(),
            writes: Some(register),
        };
        let passes = vec![
            pass(&[VectorLocation::Memory(x)]),
            pass(&[VectorLocation::Memory(x), VectorLocation::Indexed(y)]),
        ];
        let program = Outlines { lane: "f64", instructions: vec![], passes, registers: [3, 0, 0] };
        let around = StepArrays::of_step(&[(&program, 100)]);
        let [first, again] = around.moved(&program, 10.0, SHAPE.0);
        // 80 bytes of x, and a whole y instead of ten lines; three registers of 80 bytes and arrays of 800 and 400.
        assert_eq!((first.bytes, first.footprint), (80.0 + 400.0, 240.0 + 1200.0));
        assert_eq!((again.bytes, again.footprint), (80.0 + 2.0 * 80.0, 240.0 + 80.0 + 40.0));
        let bytes = |execution| charges(&program, (100, execution), SHAPE, &around, &[64.0])[4];
        assert_eq!(bytes(Execution::Strip(10)), 10.0 * (480.0 + 240.0));
        // A loop visits x and y once, in no registers.
        assert_eq!(bytes(Execution::Chained), 800.0 + 400.0);
        assert_eq!(around.bytes(&program, 100, Execution::Chained), 800.0 + 400.0);
        assert_eq!(around.bytes(&program, 100, Execution::Strip(10)), 10.0 * (480.0 + 240.0));
    }
}
