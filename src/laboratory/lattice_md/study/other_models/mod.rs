//! Models of others beside ours, section by section of the chained step, as `tests/rivals/models.py` measured them; and the rates of all executions.

mod measured;

use super::phase_times::{BenchRun, step_of_scene};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::model::clock::{Clock, ProgramWork};
use crate::model::host::StepArrays;
use crate::model::machines;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::statistics::median;
use measured::{
    LoopPrediction, MeasuredModels, MemoryLevel, PhaseTime, ProcessorPeaks, VectorSection, measured_models,
};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::OpCounts;
use stripmine_physics::method::lattice_md::{Part, Phase};
use stripmine_physics::scene::Overrides;

/// Phases of a chained step, with the parts of its programs.
const PHASES: [(Phase, &[Part]); 4] = [
    (Phase::Predict, &[Part::Predictor]),
    (Phase::Index, &[Part::Index, Part::Lattice]),
    (Phase::Forces, &[Part::Forces]),
    (Phase::Correct, &[Part::Corrector]),
];
/// Executions by their names in scenes.
const EXECUTIONS: [(&str, Execution); 4] = [
    ("eager", Execution::Eager),
    ("strip:64", Execution::Strip(64)),
    ("strip:512", Execution::Strip(512)),
    (CHAINED, Execution::Chained),
];
const CHAINED: &str = "chained";
/// Largest relative difference of agreement between llvm-mca and a machine file.
const AGREEMENT: f64 = 0.15;

/// A program of the step.
struct CountedProgram {
    part: Part,
    n: usize,
    outlines: Outlines,
    counts: OpCounts,
    sections: Vec<(&'static str, OpCounts)>,
}

impl CountedProgram {
    fn flops(&self) -> f64 {
        self.counts.flops() as f64 * self.n as f64
    }
}

/// Step of the bench with a number of discs.
struct CountedStep {
    /// Number that was asked for.
    particles: usize,
    /// Number of discs: whole rows of a hexagonal lattice.
    discs: usize,
    programs: Vec<CountedProgram>,
    arrays: StepArrays,
}

impl CountedStep {
    fn of(particles: usize, occupancy: f64) -> Result<CountedStep, CommandFailure> {
        let run = BenchRun { particles, occupancy, precision: "f64", execution: CHAINED };
        let (programs, lengths) = step_of_scene(&run.scene(&Overrides::new())?);
        let programs: Vec<CountedProgram> = programs
            .iter()
            .map(|it| {
                let sections = it.program.tally();
                let mut counts = OpCounts::default();
                sections.iter().for_each(|(_, more)| counts.add(more));
                let n = lengths.range(it.length).len();
                CountedProgram { part: it.part, n, outlines: it.program.outlines(), counts, sections }
            })
            .collect();
        let visited: Vec<(&Outlines, usize)> = programs.iter().map(|it| (&it.outlines, it.n)).collect();
        let arrays = StepArrays::of_step(&visited);
        Ok(CountedStep { particles, discs: lengths.discs, programs, arrays })
    }

    /// Sum over the programs of some parts, which are numbered in the order of the step.
    fn sum(&self, parts: &[Part], each: impl Fn(usize, &CountedProgram) -> f64) -> f64 {
        let own = self.programs.iter().enumerate().filter(|(_, it)| parts.contains(&it.part));
        own.map(|(at, it)| each(at, it)).sum()
    }

    /// Bytes that all programs move in a step.
    fn bytes(&self, execution: Execution) -> f64 {
        self.programs.iter().map(|it| self.arrays.bytes(&it.outlines, it.n, execution)).sum()
    }
}

/// Predicted and measured time of a phase (ns).
struct PredictedPhase {
    model: &'static str,
    discs: usize,
    phase: &'static str,
    predicted: f64,
    measured: f64,
}

impl PredictedPhase {
    fn error(&self) -> f64 {
        (self.predicted / self.measured - 1.0).abs()
    }
}

/// Names of the models. Those with `true` have a constant that is fitted to these times.
const MODEL_NAMES: [(&str, bool); 6] = [
    ("host model", false),
    ("llvm-mca", false),
    ("OSACA", false),
    ("roofline", false),
    ("operations", true),
    ("paper's clock", true),
];

/// Returns the predictions as the script measured them, beside ours.
///
/// # Errors
/// Fails if a shipped file is not in the format of the script, or the scene is invalid.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (found, source) = measured_models()?;
    let mut sizes: Vec<usize> = found.steps.iter().map(|it| it.particles).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let steps: Vec<CountedStep> =
        sizes.into_iter().map(|it| CountedStep::of(it, found.occupancy)).collect::<Result<_, _>>()?;
    let cases = predicted_phases(&found, &steps)?;
    let riscv = riscv_rows(&found, steps.first())?;
    let frames = [
        summary_frame(&found, &cases, &riscv),
        error_frame(&found, &cases),
        phase_frame(&cases),
        case_frame(&cases),
        execution_frame(&found, &steps),
        loop_frame(&found),
        unknown_frame(&found),
        riscv_frame(&riscv),
        level_frame(&found),
    ];
    Ok(FinishedItem { repeated: vec![source], ..FinishedItem::of(frames) })
}

/// Phases predicted by every model.
fn predicted_phases(
    found: &MeasuredModels,
    steps: &[CountedStep],
) -> Result<Vec<PredictedPhase>, CommandFailure> {
    let paper = machines::preset("paper")?;
    let mut cases = vec![];
    for step in steps {
        for (phase, parts) in PHASES {
            let is_own = |it: &&PhaseTime| {
                (it.particles, &*it.execution, &*it.phase) == (step.particles, CHAINED, phase.name())
            };
            let Some(time) = found.steps.iter().find(is_own) else { continue };
            let by_loops = |periods: fn(&LoopPrediction) -> f64| {
                let strips = |it: &CountedProgram| it.n as f64 / found.lanes;
                step.sum(parts, |at, it| {
                    found.loops.get(at).map_or(f64::NAN, |of| strips(it) * periods(of) / found.processor.ghz)
                })
            };
            let predictions = [
                time.host,
                by_loops(|it| it.mca),
                by_loops(|it| it.osaca),
                step.sum(parts, |_, it| roofline(&found.processor, step, it)),
                step.sum(parts, |_, it| it.counts.total() as f64 * it.n as f64),
                step.sum(parts, |_, it| {
                    Clock::Paper.clocks(&paper, &ProgramWork::from(it.counts.clone()), it.n as u64)
                }),
            ];
            cases.extend(MODEL_NAMES.iter().zip(predictions).map(|((model, _), predicted)| PredictedPhase {
                model,
                discs: step.discs,
                phase: phase.name(),
                predicted,
                measured: time.measured,
            }));
        }
    }
    for (model, _) in MODEL_NAMES.iter().filter(|(_, is_fitted)| *is_fitted) {
        let of_model = cases.iter().filter(|it| it.model == *model);
        let unit = median(of_model.map(|it| it.measured / it.predicted));
        cases.iter_mut().filter(|it| it.model == *model).for_each(|it| it.predicted *= unit);
    }
    Ok(cases)
}

/// Time of a program by a roofline (ns): the larger of computing at the peak of separate operations, and of moving its arrays at the bandwidth of the
/// level that holds those of the step.
fn roofline(peaks: &ProcessorPeaks, step: &CountedStep, program: &CountedProgram) -> f64 {
    let holds = |level: &&MemoryLevel| step.arrays.footprint() <= level.footprint * LEVEL_MARGIN;
    let level = peaks.levels.iter().find(holds).or(peaks.levels.last());
    let bytes = step.arrays.bytes(&program.outlines, program.n, Execution::Chained);
    let moving = level.map_or(0.0, |level| bytes / level.gb_s);
    moving.max(program.flops() / peaks.separate_gflops)
}

/// Arrays somewhat larger than those of the measured bandwidth are still in the level.
const LEVEL_MARGIN: f64 = 1.3;

fn errors_of(cases: &[PredictedPhase], model: &str) -> Vec<f64> {
    cases.iter().filter(|it| it.model == model).map(PredictedPhase::error).collect()
}

/// Cases in which a model is the closest of those without a fitted constant, which meets a case by construction.
fn closest_count(cases: &[PredictedPhase], model: &str) -> usize {
    let is_fitted = |name: &str| MODEL_NAMES.contains(&(name, true));
    let is_closest = |it: &&PredictedPhase| {
        let rivals = cases
            .iter()
            .filter(|other| (other.discs, other.phase) == (it.discs, it.phase) && !is_fitted(other.model));
        rivals.map(PredictedPhase::error).all(|error| it.error() <= error)
    };
    cases.iter().filter(|it| it.model == model).filter(is_closest).count()
}

fn summary_frame(found: &MeasuredModels, cases: &[PredictedPhase], riscv: &[RiscvRow]) -> ResultFrame {
    let middle = |model: &str| median(errors_of(cases, model).into_iter());
    let others = MODEL_NAMES.iter().skip(1).filter(|(_, is_fitted)| !is_fitted);
    let best = others.map(|(model, _)| middle(model)).fold(f64::INFINITY, f64::min);
    let agreeing = riscv.iter().filter(|it| (it.ours / it.theirs - 1.0).abs() <= AGREEMENT).count();
    FrameBuilder::of([()])
        .number("error of the host model (%)", 1, |()| 100.0 * middle("host model"))
        .number("error of the closest other (%)", 1, |()| 100.0 * best)
        .number("host model over the closest other", 2, |()| middle("host model") / best)
        .count("RISC-V sections", |()| riscv.len())
        .count("RISC-V sections within 15 %", |()| agreeing)
        .number("clock rate (GHz)", 2, |()| found.processor.ghz)
        .number("peak (GFlop/s)", 1, |()| found.processor.separate_gflops)
        .number("peak of fused operations (GFlop/s)", 1, |()| found.processor.fused_gflops)
        .text("LLVM", |()| &found.llvm)
        .text("OSACA", |()| &found.osaca)
        .frame("summary", "Models of others beside ours")
}

fn error_frame(found: &MeasuredModels, cases: &[PredictedPhase]) -> ResultFrame {
    let unknown = |model: &str| -> Option<u64> {
        let of: fn(&LoopPrediction) -> &BTreeMap<String, u64> = match model {
            "llvm-mca" => |it| &it.mca_unknown,
            "OSACA" => |it| &it.osaca_unknown,
            _ => return None,
        };
        Some(found.loops.iter().flat_map(|it| of(it).values()).sum())
    };
    FrameBuilder::of(MODEL_NAMES)
        .text("model", |(model, _)| *model)
        .text("fitted here", |(_, is_fitted)| if *is_fitted { "one constant" } else { "nothing" })
        .number("median error (%)", 1, |(model, _)| 100.0 * median(errors_of(cases, model).into_iter()))
        .number("worst (%)", 1, |(model, _)| 100.0 * errors_of(cases, model).into_iter().fold(0.0, f64::max))
        .number("closest in", 0, |(model, is_fitted)| {
            (!is_fitted).then(|| closest_count(cases, model) as f64)
        })
        .number("unknown instructions", 0, |(model, _)| unknown(model).map(|count| count as f64))
        .frame("errors", "Errors of the predicted phases of a chained step")
}

/// Ratio of the predictions to the measured times, a column a model.
fn phase_frame(cases: &[PredictedPhase]) -> ResultFrame {
    let mut rows = FrameBuilder::of(cases.iter().filter(|it| it.model == MODEL_NAMES[0].0))
        .count("discs", |it| it.discs)
        .text("phase", |it| it.phase)
        .number("measured (µs)", 1, |it| 1e-3 * it.measured);
    for (model, _) in MODEL_NAMES {
        rows = rows.number(model, 2, |it| {
            let is_same = |other: &&PredictedPhase| {
                (other.model, other.discs, other.phase) == (model, it.discs, it.phase)
            };
            cases.iter().find(is_same).map(|other| other.predicted / other.measured)
        });
    }
    rows.frame("phases", "Predicted over measured time of the phases of a chained step")
}

fn case_frame(cases: &[PredictedPhase]) -> ResultFrame {
    FrameBuilder::of(cases)
        .text("model", |it| it.model)
        .count("discs", |it| it.discs)
        .text("phase", |it| it.phase)
        .number("predicted (ns)", 0, |it| it.predicted)
        .number("measured (ns)", 0, |it| it.measured)
        .frame("cases", "Every prediction")
}

/// Rates of a step by execution.
fn execution_frame(found: &MeasuredModels, steps: &[CountedStep]) -> ResultFrame {
    let rows = steps.iter().flat_map(|step| EXECUTIONS.map(|(name, execution)| (step, name, execution)));
    let nanoseconds = |step: &CountedStep, name: &str| -> f64 {
        let is_own =
            |it: &&PhaseTime| (it.particles, &*it.execution) == (step.particles, name) && it.phase != "step";
        found.steps.iter().filter(is_own).map(|it| it.measured).sum()
    };
    let flops = |step: &CountedStep| step.programs.iter().map(CountedProgram::flops).sum::<f64>();
    let rate = |step: &CountedStep, name: &str| flops(step) / nanoseconds(step, name);
    FrameBuilder::of(rows)
        .count("discs", |(step, ..)| step.discs)
        .text("execution", |(_, name, _)| *name)
        .number("step (µs)", 1, |(step, name, _)| 1e-3 * nanoseconds(step, name))
        .number("GFlop/s", 2, |(step, name, _)| rate(step, name))
        .number("of the peak (%)", 1, |(step, name, _)| {
            100.0 * rate(step, name) / found.processor.separate_gflops
        })
        .number("moved (MB a step)", 2, |(step, _, execution)| 1e-6 * step.bytes(*execution))
        .number("GB/s", 1, |(step, name, execution)| step.bytes(*execution) / nanoseconds(step, name))
        .number("flop a byte", 2, |(step, _, execution)| flops(step) / step.bytes(*execution))
        .frame("executions", "Rates of a step by execution")
}

fn loop_frame(found: &MeasuredModels) -> ResultFrame {
    FrameBuilder::of(&found.loops)
        .text("part", |it| &it.part)
        .text("kernel", |it| &it.kernel)
        .count("instructions", |it| it.instructions)
        .count("branches", |it| it.branches)
        .number("llvm-mca", 1, |it| it.mca)
        .number("OSACA", 1, |it| it.osaca)
        .frame("loops", "Clock periods of a strip of eight elements")
}

fn unknown_frame(found: &MeasuredModels) -> ResultFrame {
    let listed = |of: &BTreeMap<String, u64>| {
        let words: Vec<String> = of.iter().map(|(form, count)| format!("{form} {count}")).collect();
        if words.is_empty() { "none".to_owned() } else { words.join(", ") }
    };
    FrameBuilder::of(&found.loops)
        .text("kernel", |it| &it.kernel)
        .text("llvm-mca", |it| listed(&it.mca_unknown))
        .text("OSACA", |it| listed(&it.osaca_unknown))
        .frame("unknown", "Instructions of a strip that a model does not know, with their numbers")
}

/// Clock periods of a section of the RISC-V text.
struct RiscvRow {
    program: String,
    section: String,
    ours: f64,
    theirs: f64,
}

/// Clock periods of a strip of a full register group, section by section of the RISC-V text: by our machine file, which charges operations only, and by
/// llvm-mca, which charges addresses and expansions as well.
fn riscv_rows(found: &MeasuredModels, step: Option<&CountedStep>) -> Result<Vec<RiscvRow>, CommandFailure> {
    let machine = machines::preset("sifive-x280")?;
    let strip = machine.group_elements().unwrap_or(1.0) as u64;
    let programs = step.map_or(&[][..], |step| &step.programs);
    let own = programs.iter().zip(1..).flat_map(|(it, number)| {
        let name = format!("{}_{number}", it.part.name());
        it.sections.iter().map(move |(section, counts)| (name.clone(), *section, counts))
    });
    let mut rows = vec![];
    for (program, section, counts) in own {
        let is_same = |it: &&VectorSection| (&*it.program, &*it.section) == (&*program, section);
        if let Some(theirs) = found.sections.iter().find(is_same) {
            let ours = Clock::WholeRegisters.clocks(&machine, &ProgramWork::from(counts.clone()), strip);
            rows.push(RiscvRow { program, section: section.to_owned(), ours, theirs: theirs.mca });
        }
    }
    Ok(rows)
}

fn riscv_frame(rows: &[RiscvRow]) -> ResultFrame {
    FrameBuilder::of(rows)
        .text("program", |it| &it.program)
        .text("section", |it| &it.section)
        .number("machine file", 0, |it| it.ours)
        .number("llvm-mca", 0, |it| it.theirs)
        .number("ratio", 2, |it| it.ours / it.theirs)
        .frame("riscv", "Clock periods of a strip on a SiFive X280, groups of four registers")
}

fn level_frame(found: &MeasuredModels) -> ResultFrame {
    FrameBuilder::of(&found.processor.levels)
        .text("level", |it| &it.name)
        .number("arrays (kB)", 0, |it| 1e-3 * it.footprint)
        .number("GB/s", 1, |it| it.gb_s)
        .frame("levels", "Bandwidth of sums of two arrays into a third")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The order of the loops is that of the programs, or predictions belong to other loops.
    #[test]
    fn loops_are_those_of_the_step() {
        let (found, _) = measured_models().unwrap();
        let step = CountedStep::of(560, found.occupancy).unwrap();
        let parts: Vec<&str> = step.programs.iter().map(|it| it.part.name()).collect();
        assert_eq!(parts, found.loops.iter().map(|it| &*it.part).collect::<Vec<_>>());
        // 30 sums of the expansion with five values of three coordinates, and three products for the velocities.
        assert_eq!(step.programs[0].counts.flops(), 33);
        // The bench places whole rows of a hexagonal lattice.
        assert_eq!((step.programs[0].n, step.programs[0].flops()), (572, 33.0 * 572.0));
    }

    #[test]
    fn every_phase_is_predicted_by_every_model() {
        let (found, _) = measured_models().unwrap();
        let steps = [560, 9500].map(|particles| CountedStep::of(particles, found.occupancy).unwrap());
        let cases = predicted_phases(&found, &steps).unwrap();
        assert_eq!(cases.len(), MODEL_NAMES.len() * PHASES.len() * steps.len());
        assert!(cases.iter().all(|it| it.predicted > 0.0 && it.measured > 0.0));
        let own = MODEL_NAMES.iter().filter(|(_, is_fitted)| !is_fitted);
        let closest = own.map(|(model, _)| closest_count(&cases, model));
        // Models that agree are both the closest.
        assert!(closest.sum::<usize>() >= PHASES.len() * steps.len());
    }

    /// By hand, for 32 elements in four registers of 512 bits: three gathers of a period an element and a load of 8 periods;
    /// three products of 8.14 periods for the acceleration.
    #[test]
    fn riscv_strips_fill_a_register_group() {
        let (found, _) = measured_models().unwrap();
        let step = CountedStep::of(560, found.occupancy).unwrap();
        let rows = riscv_rows(&found, Some(&step)).unwrap();
        let of = |section: &str| {
            rows.iter().find(|it| it.program == "corrector_8" && it.section == section).unwrap().ours
        };
        assert!((of("gather") - (3.0 * 32.0 + 8.0)).abs() < 1e-9, "{}", of("gather"));
        assert!((of("acceleration") - 3.0 * 8.14).abs() < 1e-9, "{}", of("acceleration"));
    }

    /// By hand: 33 flops an element at 2 GFlop/s take 16.5 ns; the predictor loads 15 arrays and stores as many and the velocities.
    #[test]
    fn roofline_takes_the_larger_time() {
        let step = CountedStep::of(560, 0.168).unwrap();
        let level = |gb_s| MemoryLevel { name: String::new(), footprint: 1e12, gb_s };
        let peaks = |separate_gflops, gb_s| ProcessorPeaks {
            ghz: 1.0,
            separate_gflops,
            fused_gflops: 1.0,
            levels: vec![level(gb_s)],
        };
        let n = 572.0;
        assert_eq!(roofline(&peaks(2.0, 1e9), &step, &step.programs[0]), 16.5 * n);
        let moved = roofline(&peaks(1e9, 1.0), &step, &step.programs[0]) / n;
        assert!((8.0 * 15.0..=8.0 * 33.0).contains(&moved) && moved % 8.0 == 0.0, "{moved}");
    }
}
