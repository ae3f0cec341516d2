//! Workbench: everything about a program of a user's own. It is counted, listed, run in all executions, timed, and priced on every machine.

use crate::emission::listing_text;
use crate::frame::{FormattedTable, FrameBuilder, ResultFrame};
use crate::model::clock::{Clock, ProgramWork};
use crate::model::machine::MachineModel;
use crate::model::machines;
use crate::report::terminal;
use crate::statistics::median;
use std::fmt;
use std::time::Instant;
use stripmine_kernels::backend::ListingLine;
use stripmine_kernels::emit::{EmitError, GroupSize};
use stripmine_kernels::isa::OpCounts;
use stripmine_kernels::own::{OwnKernel, OwnKernelError, OwnProgram};
use stripmine_kernels::{Execution, InstructionSet, single_threaded_if};

/// Executions that are compared and timed.
const EXECUTIONS: [(&str, Execution); 3] =
    [("eager", Execution::Eager), ("strip:512", Execution::Strip(512)), ("chained", Execution::Chained)];
/// Vector lengths that R∞ and n½ are fitted to: with a few arrays they stay in the caches.
const LENGTHS: [usize; 5] = [64, 256, 1024, 4096, 16_384];
/// Elements of the comparison of bits: with a tail in every execution.
const COMPARED: usize = 1021;
/// Shortest time that is measured (s), and repeats.
const SHORTEST: f64 = 0.5e-3;
const REPEATS: usize = 7;

/// Hockney's two numbers of a vector machine: `t(n) = (n + n½) / R∞`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymptote {
    /// Elements per second of infinitely long vectors, R∞.
    pub rate: f64,
    /// Vector length at which half of that rate is reached, n½.
    pub half_length: f64,
    /// Largest relative deviation of a time from the formula.
    pub misfit: f64,
}

impl Asymptote {
    /// Fits the formula to lengths and times (s), with the smallest sum of squared relative deviations.
    pub fn fit(times: &[(usize, f64)]) -> Asymptote {
        // Relative deviations weigh each time by its inverse square.
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            times.iter().map(|&(n, time)| of(n as f64) / (time * time)).sum()
        };
        let timed =
            |of: &dyn Fn(f64) -> f64| -> f64 { times.iter().map(|&(n, time)| of(n as f64) / time).sum() };
        let [one, n, nn] = [sum(&|_| 1.0), sum(&|n| n), sum(&|n| n * n)];
        let [t, nt] = [timed(&|_| 1.0), timed(&|n| n)];
        let determinant = one * nn - n * n;
        let [start, each] = [(t * nn - nt * n) / determinant, (one * nt - n * t) / determinant];
        let misfit = times.iter().map(|&(n, time)| ((start + each * n as f64) / time - 1.0).abs());
        Asymptote { rate: 1.0 / each, half_length: start / each, misfit: misfit.fold(0.0, f64::max) }
    }

    /// Fits the clock periods of a program on a machine.
    pub fn of_clock(machine: &MachineModel, clock: Clock, work: &ProgramWork) -> Asymptote {
        let period = 1e-9 * machine.clock_period_ns();
        let times = LENGTHS.map(|n| (n, period * clock.clocks(machine, work, n as u64)));
        Asymptote::fit(&times)
    }
}

/// Results of [`examine`].
#[derive(Debug)]
pub struct Examination {
    /// Operations, section by section.
    pub operations: ResultFrame,
    /// Measured R∞ and n½ of each execution on this host.
    pub host: ResultFrame,
    /// R∞ and n½ on every machine, by the paper's clock and by the last rung that the machine has.
    pub machines: ResultFrame,
    /// True if all executions give the same bits.
    pub has_same_bits: bool,
    /// Vector instructions.
    pub listing: String,
}

impl fmt::Display for Examination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for frame in [&self.operations, &self.host, &self.machines] {
            writeln!(f, "{}", terminal::render(&FormattedTable::from(frame)))?;
        }
        let bits = if self.has_same_bits { "the same bits" } else { "DIFFERENT BITS" };
        writeln!(f, "eager, strip-mined and chained give {bits}\n\n{}", self.listing)
    }
}

/// Counts, lists, runs, times and prices a program, on numbers between 0.5 and 1.5.
///
/// # Errors
/// As [`OwnProgram::run`].
pub fn examine<K>(name: &str, program: &OwnProgram<K>) -> Result<Examination, OwnKernelError>
where
    K: OwnKernel<Lane = f64> + Send + Sync,
    K::Slots<'static>: Send + Sync,
{
    let runnable = program.runnable();
    let work = ProgramWork::of(runnable);
    let results = EXECUTIONS.iter().map(|(_, execution)| results(program, COMPARED, *execution));
    let results: Vec<Vec<Vec<u64>>> = results.collect::<Result<_, _>>()?;
    let mut measured = vec![];
    for (execution, how) in EXECUTIONS {
        let times = LENGTHS.map(|n| Ok((n, seconds(program, n, how)?)));
        let times: Vec<(usize, f64)> = times.into_iter().collect::<Result<_, OwnKernelError>>()?;
        measured.push((execution, Asymptote::fit(&times)));
    }
    let priced = machines::names().filter_map(|name| machines::preset(name).ok());
    let priced = priced.map(|machine| {
        let of = |clock| Asymptote::of_clock(&machine, clock, &work);
        (machine.title().to_owned(), of(Clock::Paper), of(Clock::WholeRegisters))
    });
    let computing = |counts: &OpCounts| counts.filtered(|op| !op.class().moves_data()).total();
    let millions = |it: &Asymptote| it.rate / 1e6;
    Ok(Examination {
        operations: FrameBuilder::of(runnable.tally())
            .text("section", |(section, _)| *section)
            .count("operations (NOP)", |(_, counts)| counts.total())
            .count("of them computing", |(_, counts)| computing(counts))
            .frame("operations", format!("{name}: operations on each element")),
        host: FrameBuilder::of(measured)
            .text("execution", |(execution, _)| *execution)
            .number("R∞ (million elements/s)", 1, |(_, it)| millions(it))
            .number("n½", 1, |(_, it)| it.half_length)
            .number("largest deviation (%)", 0, |(_, it)| 100.0 * it.misfit)
            .frame(
                "host",
                format!("{name}: measured here, on one thread with {}", InstructionSet::best().name()),
            ),
        machines: FrameBuilder::of(priced)
            .text("machine", |(title, ..)| title.clone())
            .number("R∞, paper's clock (million elements/s)", 2, |(_, paper, _)| millions(paper))
            .number("n½, paper's clock", 1, |(_, paper, _)| paper.half_length)
            .number("R∞, last rung (million elements/s)", 2, |(.., last)| millions(last))
            .number("n½, last rung", 1, |(.., last)| last.half_length)
            .frame("machines", format!("{name}: on every machine")),
        has_same_bits: results.iter().all(|bits| *bits == results[0]),
        listing: runnable.listing(),
    })
}

/// Code of a program for RISC-V's vector extension, with its expansion table.
///
/// # Errors
/// [`EmitError`] names an operation without code.
pub fn riscv<K>(name: &str, program: &OwnProgram<K>, size: GroupSize) -> Result<String, EmitError>
where
    K: OwnKernel<Lane = f64> + Send + Sync,
    K::Slots<'static>: Send + Sync,
{
    listing_text(name, program.runnable(), Some(size))
}

/// Arrays of a program, of a length with all its shifts: numbers between 0.5 and 1.5 in no order.
fn arrays<K: OwnKernel>(program: &OwnProgram<K>, n: usize) -> Vec<Vec<f64>> {
    let golden = 0.618_033_988_749_894_9;
    let value = |at: usize| 0.5 + (at as f64 * golden).fract();
    let around =
        program.arrays().iter().map(|array| array.lowest.unsigned_abs() + array.highest.unsigned_abs());
    let length = n + 2 * around.max().unwrap_or(0);
    (0..program.arrays().len()).map(|array| (0..length).map(|at| value(at + 7 * array)).collect()).collect()
}

/// Runs a program on arrays, and calls `task` with a function that runs it.
fn with_memory<K, T>(
    program: &OwnProgram<K>,
    arrays: &mut [Vec<f64>],
    execution: Execution,
    task: impl FnOnce(&dyn Fn() -> Result<(), OwnKernelError>) -> Result<T, OwnKernelError>,
) -> Result<T, OwnKernelError>
where
    K: OwnKernel<Lane = f64> + Send + Sync,
    K::Slots<'static>: Send + Sync,
{
    let length = arrays.first().map_or(0, Vec::len);
    let mut memory = program.memory();
    for (declared, values) in program.arrays().iter().zip(arrays) {
        memory = memory.write(&declared.name, values)?;
    }
    let (range, set) = (program.interior(length), InstructionSet::best());
    // Two threads would bend the line through the times.
    single_threaded_if(true, || task(&|| program.run(&memory, range.clone(), execution, set)))
}

/// Bits of all arrays after a run.
fn results<K>(
    program: &OwnProgram<K>,
    n: usize,
    execution: Execution,
) -> Result<Vec<Vec<u64>>, OwnKernelError>
where
    K: OwnKernel<Lane = f64> + Send + Sync,
    K::Slots<'static>: Send + Sync,
{
    let mut arrays = arrays(program, n);
    with_memory(program, &mut arrays, execution, |run| run())?;
    Ok(arrays.into_iter().map(|array| array.into_iter().map(f64::to_bits).collect()).collect())
}

/// Median time of a run (s).
fn seconds<K>(program: &OwnProgram<K>, n: usize, execution: Execution) -> Result<f64, OwnKernelError>
where
    K: OwnKernel<Lane = f64> + Send + Sync,
    K::Slots<'static>: Send + Sync,
{
    let mut arrays = arrays(program, n);
    with_memory(program, &mut arrays, execution, |run| {
        let timed = |times: u32| -> Result<f64, OwnKernelError> {
            let start = Instant::now();
            (0..times).try_for_each(|_| run())?;
            Ok(start.elapsed().as_secs_f64() / f64::from(times))
        };
        let mut times = 1;
        while times < 1 << 20 && timed(times)? * f64::from(times) < SHORTEST {
            times *= 2;
        }
        let all: Vec<f64> = (0..REPEATS).map(|_| timed(times)).collect::<Result<_, _>>()?;
        Ok(median(all.into_iter()))
    })
}

/// Operations of a program in words, for other languages.
pub fn lines<K>(program: &OwnProgram<K>) -> Vec<ListingLine>
where
    K: OwnKernel<Lane = f64> + Send + Sync,
    K::Slots<'static>: Send + Sync,
{
    program.runnable().lines()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::isa::Machine;
    use stripmine_kernels::own::{Declarations, OwnMachine, ReadSlot, WriteSlot};

    #[test]
    fn fits_recover_rate_and_half_length() {
        let times = LENGTHS.map(|n| (n, (n as f64 + 37.0) / 2.5e9));
        let Asymptote { rate, half_length, misfit } = Asymptote::fit(&times);
        assert!((rate / 2.5e9 - 1.0).abs() < 1e-9, "{rate}");
        assert!((half_length - 37.0).abs() < 1e-6, "{half_length}");
        assert!(misfit < 1e-9);
    }

    struct Triad;

    impl OwnKernel for Triad {
        type Lane = f64;
        type Slots<'k> = (ReadSlot<'k>, ReadSlot<'k>, WriteSlot<'k>);
        fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
            (arrays.read("b"), arrays.read("c"), arrays.write("a"))
        }
        fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, &(b, c, a): &Self::Slots<'k>) {
            m.store(a, m.load(b) + m.uniform(3.0) * m.load(c));
        }
    }

    /// By hand: five operations of n + 20 clock periods each have R∞ = 1/5 of an element a period and n½ = 20.
    #[test]
    fn triad_is_priced_by_the_papers_formula() {
        let program = OwnProgram::new(Triad).unwrap();
        let paper = machines::preset("paper").unwrap();
        let it = Asymptote::of_clock(&paper, Clock::Paper, &ProgramWork::of(program.runnable()));
        assert!((it.half_length - 20.0).abs() < 1e-6, "{it:?}");
        assert!((it.rate * 5e-9 * paper.clock_period_ns() - 1.0).abs() < 1e-9, "{it:?}");
        let found = examine("triad", &program).unwrap();
        assert!(found.has_same_bits);
        let text = found.to_string();
        for words in ["triad: operations", "CRAY-1", "SpacemiT A100", "[b]", "the same bits"] {
            assert!(text.contains(words), "{words}: {text}");
        }
        let code = riscv("triad", &program, GroupSize::Four).unwrap();
        assert!(code.contains("vfmul.vf") && code.contains("vfadd.vv"), "{code}");
    }
}
