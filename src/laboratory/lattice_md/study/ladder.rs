//! What does each refinement of the clock add? One step, charged by every rung of the ladder.

use super::efficiency_table::{Choice, Question, QuestionError, step};
use crate::model::clock::{Clock, Memory, Work, convoys};
use crate::model::machine::MachineModel;
use serde::Serialize;
use stripmine_physics::method::lattice_md::Part;

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Ladder {
    /// NP.
    pub particles: usize,
    /// LMAX.
    pub cells: usize,
    /// What is modelled.
    pub choice: Choice,
    /// The machine.
    pub machine: String,
    /// Its clock period (ns).
    pub clock_period_ns: f64,
    /// Numbers of the machine that are assumed.
    pub assumed: Vec<String>,
    /// Of the clock periods of the last rung, the share that depends on start-ups whose values are assumed.
    pub assumed_share: f64,
    /// The parts of the step, in their order.
    pub parts: Vec<&'static str>,
    /// A row for each clock.
    pub rungs: Vec<Rung>,
    /// Convoys of the last rung in each part.
    pub convoys: Vec<Convoys>,
}

/// A step by one clock.
#[derive(Clone, Debug, Serialize)]
pub struct Rung {
    /// The clock.
    pub clock: &'static str,
    /// What it takes into account.
    pub meaning: &'static str,
    /// Clock periods of each part.
    pub parts: Vec<f64>,
    /// Clock periods of the step.
    pub clocks: f64,
    /// Relative to the rung before; none for the first.
    pub relative: Option<f64>,
    /// Seconds of the step.
    pub seconds: f64,
}

/// How the instructions of a part come together.
#[derive(Clone, Debug, Serialize)]
pub struct Convoys {
    /// The part.
    pub part: &'static str,
    /// Instructions, those of expansions each for itself.
    pub instructions: usize,
    /// Convoys with memory never busy.
    pub chained: usize,
    /// Convoys with the machine's memory ports.
    pub with_ports: usize,
}

/// Charges the step of a question by every clock.
///
/// # Errors
/// [`QuestionError`] if no such lattice exists.
pub fn ladder(question: &Question, machine: &MachineModel) -> Result<Ladder, QuestionError> {
    let (programs, lengths) = step(question)?;
    let works: Vec<(Part, Work, u64)> = programs
        .iter()
        .map(|step| (step.part, Work::of(step.program.as_ref()), lengths.range(step.length).len() as u64))
        .collect();
    let there: Vec<Part> =
        Part::ALL.iter().copied().filter(|part| works.iter().any(|(of, ..)| of == part)).collect();
    let of_part = |part: Part| works.iter().filter(move |(of, ..)| *of == part);
    let clocks = |clock: Clock, machine: &MachineModel, part: Part| -> f64 {
        of_part(part).map(|(_, work, n)| clock.clocks(machine, work, *n)).sum()
    };
    let period = machine.clock_period_ns().value;
    let mut rungs: Vec<Rung> = vec![];
    for &clock in Clock::ALL {
        let parts: Vec<f64> = there.iter().map(|&part| clocks(clock, machine, part)).collect();
        let sum: f64 = parts.iter().sum();
        rungs.push(Rung {
            clock: clock.name(),
            meaning: clock.meaning(),
            parts,
            clocks: sum,
            relative: rungs.last().map(|before| sum / before.clocks),
            seconds: sum * period * 1e-9,
        });
    }
    let known = machine.without_assumed_start_ups();
    let last = |machine: &MachineModel| -> f64 {
        there.iter().map(|&part| clocks(Clock::Ports, machine, part)).sum()
    };
    let convoys = there.iter().map(|&part| {
        let count = |memory| -> (usize, usize) {
            let sets = of_part(part).filter_map(|(_, work, _)| work.order());
            let sets = sets.map(|order| convoys(machine, order, memory));
            sets.fold((0, 0), |(convoys, instructions), set| {
                (convoys + set.len(), instructions + set.iter().map(|c| c.instructions).sum::<usize>())
            })
        };
        let ((chained, instructions), (with_ports, _)) = (count(Memory::NeverBusy), count(Memory::Ports));
        Convoys { part: part.name(), instructions, chained, with_ports }
    });
    Ok(Ladder {
        particles: lengths.discs,
        cells: lengths.cells,
        choice: question.choice,
        machine: machine.title().to_owned(),
        clock_period_ns: period,
        assumed: machine.assumed(),
        assumed_share: 1.0 - last(&known) / last(machine),
        parts: there.iter().map(|part| part.name()).collect(),
        convoys: convoys.collect(),
        rungs,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::machines::{names, preset};

    #[test]
    fn every_machine_has_every_rung_and_chaining_pays_where_there_are_units() {
        for name in names() {
            let machine = preset(name).unwrap();
            let ladder = ladder(&Question::default(), &machine).unwrap();
            assert_eq!(ladder.rungs.len(), Clock::ALL.len());
            assert!(ladder.rungs.iter().all(|rung| rung.clocks.is_finite() && rung.clocks > 0.0), "{name}");
            let clocks =
                |clock: Clock| ladder.rungs.iter().find(|rung| rung.clock == clock.name()).unwrap().clocks;
            if machine.has_units() && machine.chains() {
                assert!(clocks(Clock::Chained) < 0.8 * clocks(Clock::Registers), "{name}");
            }
            assert!((0.0..1.0).contains(&ladder.assumed_share), "{name}: {}", ladder.assumed_share);
        }
    }

    #[test]
    fn the_papers_rung_is_the_efficiency_table() {
        let (question, machine) = (Question::default(), preset("cray-1").unwrap());
        let table =
            crate::laboratory::lattice_md::study::efficiency_table::efficiency_table(&question, &machine)
                .unwrap();
        let ladder = ladder(&question, &machine).unwrap();
        assert_eq!(ladder.rungs[2].clocks, table.ours.clocks);
        assert_eq!(ladder.rungs[1].clocks, table.ours.scalar_clocks);
    }
}
