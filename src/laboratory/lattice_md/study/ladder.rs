//! Clock periods of one step by every clock model, from the trivial one to chaining and memory ports.

use super::efficiency_table::{TableScene, TableSceneError, programs_in_precision, programs_of_step};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::model::clock::{Clock, MemoryModel, ProgramWork, convoys};
use crate::model::machine::{MachineFeature, MachineModel};
use crate::model::machines;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use stripmine_physics::method::lattice_md::{Part, ProgramVersion, StepProgram};
use stripmine_physics::scene::Precision;

/// The clock with all properties of a machine.
const LAST: Clock = Clock::WholeRegisters;
/// Machines of the report.
const MACHINES: [&str; 3] = ["cray-y-mp-el", "cray-1", "sx-aurora"];

/// Counts the default scene on every machine of the report.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let machines = MACHINES.map(machines::preset).into_iter().collect::<Result<Vec<_>, _>>()?;
    let ladders = machines.iter().map(|machine| Ladder::of(&TableScene::default(), machine));
    let ladders = ladders.collect::<Result<Vec<_>, _>>()?;
    let rungs = ladders.iter().zip(1..).map(|(it, at)| it.rungs(format!("ladder_{at}")));
    let meanings = FrameBuilder::of(Clock::ALL)
        .text("clock", |clock| clock.name())
        .text("meaning", |clock| clock.meaning())
        .frame("clocks", "What each clock charges");
    Ok(FinishedItem::of(rungs.chain([summary(&ladders), gains(&ladders), meanings])))
}

/// Item of one machine: rungs, convoys, summary.
pub(crate) fn ladder(question: &TableScene, machine: &MachineModel) -> Result<FinishedItem, TableSceneError> {
    let ladder = Ladder::of(question, machine)?;
    let ladders = [ladder];
    let [ladder] = &ladders;
    let frames = [ladder.rungs("ladder".into()), ladder.convoys(), summary(&ladders), gains(&ladders)];
    Ok(FinishedItem::of(frames))
}

/// Programs of a step, and the machine whose clock periods are counted.
struct Ladder<'m> {
    works: Vec<(Part, ProgramWork, u64)>,
    /// Programs in single precision; none for the printed program, which has one precision.
    single: Vec<(Part, ProgramWork, u64)>,
    discs: usize,
    cells: usize,
    machine: &'m MachineModel,
}

impl Ladder<'_> {
    fn of<'m>(question: &TableScene, machine: &'m MachineModel) -> Result<Ladder<'m>, TableSceneError> {
        let (programs, lengths) = programs_of_step(question)?;
        let works = |programs: &[StepProgram]| {
            let work = programs.iter().map(|step| {
                (step.part, ProgramWork::of(step.program.as_ref()), lengths.range(step.length).len() as u64)
            });
            work.collect()
        };
        let single = match question.choice.text {
            ProgramVersion::Ours => programs_in_precision(question, Precision::F32)?.0,
            ProgramVersion::Printed => vec![],
        };
        let (works, single) = (works(&programs), works(&single));
        Ok(Ladder { works, single, discs: lengths.discs, cells: lengths.cells, machine })
    }

    /// Ratio of the clock periods of a step by the last clock without a feature to those with it; none without programs in single precision.
    fn gain(&self, feature: MachineFeature) -> Option<f64> {
        let works = if feature == MachineFeature::Fma { &self.works } else { &self.single };
        let step = |is_present: bool| -> f64 {
            let machine = self.machine.with_feature(feature, is_present);
            works.iter().map(|(_, work, n)| LAST.clocks(&machine, work, *n)).sum()
        };
        (!works.is_empty()).then(|| step(false) / step(true))
    }

    fn of_part(&self, part: Part) -> impl Iterator<Item = &(Part, ProgramWork, u64)> {
        self.works.iter().filter(move |(of, ..)| *of == part)
    }

    /// Parts of the step, in their order.
    fn parts(&self) -> impl Iterator<Item = Part> {
        Part::ALL.iter().copied().filter(|part| self.of_part(*part).next().is_some())
    }

    /// Clock periods of a part.
    fn clocks(&self, clock: Clock, machine: &MachineModel, part: Part) -> f64 {
        self.of_part(part).map(|(_, work, n)| clock.clocks(machine, work, *n)).sum()
    }

    /// Clock periods of the step.
    fn step(&self, clock: Clock, machine: &MachineModel) -> f64 {
        self.parts().map(|part| self.clocks(clock, machine, part)).sum()
    }

    /// Ratio of the clock periods of a clock to those of the paper's.
    fn of_paper(&self, clock: Clock) -> f64 {
        self.step(clock, self.machine) / self.step(Clock::Paper, self.machine)
    }

    /// Share of the last rung due to assumed start-up times.
    fn assumed_share(&self) -> f64 {
        let known = self.machine.without_assumed_start_ups();
        1.0 - self.step(Clock::Ports, &known) / self.step(Clock::Ports, self.machine)
    }

    fn rungs(&self, name: String) -> ResultFrame {
        let step = |clock: Clock| self.step(clock, self.machine);
        let mut rows =
            FrameBuilder::of(Clock::ALL.iter().enumerate()).text("clock", |(_, clock)| clock.name());
        for part in self.parts() {
            rows = rows.number(part.name(), 0, |(_, clock)| self.clocks(**clock, self.machine, part));
        }
        rows.number("step", 0, |(_, clock)| step(**clock))
            .number("of the rung before", 3, |(at, clock)| {
                at.checked_sub(1).map(|before| step(**clock) / step(Clock::ALL[before]))
            })
            .number("a disc", 0, |(_, clock)| step(**clock) / self.discs as f64)
            .number("ms", 3, |(_, clock)| 1e3 * (step(**clock) * self.machine.clock_period_ns() * 1e-9))
            .frame(name, format!("Clock periods of one step by every clock: {}", self.machine.title()))
    }

    fn convoys(&self) -> ResultFrame {
        // Convoys, and instructions in them.
        let count = |part: Part, memory| -> (usize, usize) {
            let orders = self.of_part(part).filter_map(|(_, work, _)| work.order());
            let sets = orders.map(|order| convoys(self.machine, order, memory));
            sets.fold((0, 0), |(convoys, instructions), set| {
                (convoys + set.len(), instructions + set.iter().map(|it| it.instructions).sum::<usize>())
            })
        };
        FrameBuilder::of(self.parts())
            .text("part", |part| part.name())
            .count("instructions", |part| count(*part, MemoryModel::NeverBusy).1)
            .count("convoys, memory never busy", |part| count(*part, MemoryModel::NeverBusy).0)
            .count("convoys with memory ports", |part| count(*part, MemoryModel::Ports).0)
            .frame("convoys", "Convoys: instructions that run at once")
    }
}

/// Gains of features that our own executions do not use, so that their bits stay the same.
fn gains(ladders: &[Ladder<'_>]) -> ResultFrame {
    FrameBuilder::of(ladders)
        .text("machine", |it| it.machine.title())
        .text("has them", |it| {
            let own = [(it.machine.fuses(), "fma"), (it.machine.lanes("f32") > 1.0, "lanes of 32 bits")];
            let own: Vec<&str> = own.into_iter().filter(|(has, _)| *has).map(|(_, name)| name).collect();
            if own.is_empty() { "neither".to_owned() } else { own.join(", ") }
        })
        .number("gain by fma", 3, |it| it.gain(MachineFeature::Fma))
        .number("gain by two lanes of 32 bits", 3, |it| it.gain(MachineFeature::Lanes32))
        .frame("gains", "Time of a step by the last clock without a feature, over the time with it")
}

fn summary(ladders: &[Ladder<'_>]) -> ResultFrame {
    FrameBuilder::of(ladders)
        .text("machine", |it| it.machine.title())
        .count("NP", |it| it.discs)
        .count("LMAX", |it| it.cells)
        .number("clock period (ns)", 3, |it| it.machine.clock_period_ns())
        .number("chained over the paper's clock", 2, |it| it.of_paper(Clock::Chained))
        .number("with memory ports over the paper's clock", 2, |it| it.of_paper(Clock::Ports))
        .number("share of the last rung from assumed start-ups (%)", 1, |it| 100.0 * it.assumed_share())
        .text("assumed numbers", |it| it.machine.assumed().join(", "))
        .frame("machines", "Machines, and the last two clocks beside the paper's")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{ExpressionScope, Expressions};
    use crate::laboratory::lattice_md::study::efficiency_table::efficiency_table;
    use crate::model::machines::{names, preset};

    #[test]
    fn every_machine_has_every_rung() {
        for name in names() {
            let machine = preset(name).unwrap();
            let ladder = Ladder::of(&TableScene::default(), &machine).unwrap();
            let clocks = |clock: Clock| ladder.step(clock, &machine);
            assert!(
                Clock::ALL.iter().all(|clock| clocks(*clock).is_finite() && clocks(*clock) > 0.0),
                "{name}"
            );
            if machine.has_units() && machine.chains() {
                assert!(clocks(Clock::Chained) < 0.8 * clocks(Clock::Registers), "{name}");
            }
            assert!((0.0..1.0).contains(&ladder.assumed_share()), "{name}: {}", ladder.assumed_share());
        }
    }

    #[test]
    fn the_paper_rung_equals_the_efficiency_table() {
        let (question, machine) = (TableScene::default(), preset("cray-1").unwrap());
        let ladder = Ladder::of(&question, &machine).unwrap();
        let scope = ExpressionScope::of(efficiency_table(&question, &machine).unwrap().frames);
        let of_table = Expressions::new().value("efficiency_table.at(part='step').clocks_ours", &scope);
        assert_eq!(ladder.step(Clock::Paper, &machine), f64::try_from(of_table.unwrap()).unwrap());
    }
}
