//! What a run says of itself at the end.

use super::work::Balance;
use crate::method::lattice_md::{self, Discs, Lengths, Model, programs};
use crate::method::{Failure, Method};
use crate::observe::{Observation, Scenery};
use crate::origin::{Origin, host};
use crate::scene::{Checked, Start};
use serde::Serialize;
use std::collections::BTreeMap;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::isa::OpCounts;
use stripmine_kernels::ledger::Length;

/// The content of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The program.
    pub origin: Origin,
    /// The processor, where the system names it, and the platform.
    pub host: String,
    /// Seed of the random numbers that made the start; none where it was read or listed.
    pub seed: Option<u64>,
    /// Instructions used.
    pub instruction_set: &'static str,
    /// Threads used.
    pub threads: usize,
    /// Grains, and wall discs.
    pub discs: [usize; 2],
    /// Columns and rows of the lattice; none where the method needs none.
    pub lattice: Option<[usize; 2]>,
    /// Grains and wall discs for each cell of it.
    pub occupancy: Option<f64>,
    /// What the scene has no need of, with the reason.
    pub left_out: Vec<String>,
    /// What was warned about.
    pub warnings: Vec<String>,
    /// What was out of the ordinary along the run's sessions: another version of the program, an older checkpoint and the
    /// like; known once it is written.
    pub notes: Vec<String>,
    /// What stopped the run, if the physics did.
    pub failure: Option<String>,
    /// Steps done.
    pub steps: u64,
    /// Wall seconds of this session, writing included.
    pub seconds: f64,
    /// Wall seconds of this session in each phase of the steps.
    pub phases: BTreeMap<&'static str, f64>,
    /// Energies put in and taken out since the start, and the error of their balance.
    pub energy: Balance,
    /// Discs that moved farther in a step than contacts can be seen, summed over the steps.
    pub long_steps: u64,
    /// Grains in contacts deeper than `max_penetration`, summed over the steps.
    pub deep_disc_steps: u64,
    /// Discs beside the lattice because their cell was another's, summed over the steps.
    pub resolved_conflicts: u64,
    /// The deepest such contact (fraction of the sum of the radii), 0 if there was none.
    pub deepest_watched: f64,
    /// What a step executes; empty where that depends on the contacts.
    pub ledger: Vec<LedgerRow>,
    /// Operations times elements of a step, relative to a scene with friction and different discs; none where a step is no
    /// fixed program.
    pub work_relative_to_everything: Option<f64>,
    /// The last state.
    pub last: Observation,
}

impl Summary {
    pub(super) fn of(
        checked: &Checked,
        method: &dyn Method,
        energy: Balance,
        seconds: f64,
        failure: Option<&Failure>,
    ) -> Summary {
        let Checked { scene, particles, geometry, left_out, warnings, .. } = checked;
        let set = scene.method.instruction_set.unwrap_or_else(InstructionSet::best);
        let grains = particles.grain_count();
        let totals = method.totals();
        let mut warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        if totals.deep_disc_steps > 0 {
            warnings.push(format!(
                "contacts were deeper than law.max_penetration = {}: {} disc-steps, the deepest {:.4} at step {}; the \
                 contact law and the lattice are exact only for shallow contacts: stiffen them or slow the discs",
                scene.law.max_penetration, totals.deep_disc_steps, totals.deepest, totals.deepest_step
            ));
        }
        if totals.long_steps > 0 {
            warnings.push(format!(
                "{} times a disc moved so far in a step that contacts deeper than law.max_penetration may have passed unseen: \
                 lower dt, or slow the discs",
                totals.long_steps
            ));
        }
        if totals.shared_cells > 0 {
            warnings.push(format!(
                "{} times a disc was in a lattice cell that was another's, and was kept beside the lattice: exact, but \
                 slower the more there are",
                totals.shared_cells
            ));
        }
        let scenery = Scenery::of(&super::model(checked));
        let (on_lattice, ledger) = (scene.method.needs_lattice(), ledger(method));
        Summary {
            origin: Origin::here(),
            host: host(),
            seed: seed(&scene.start),
            instruction_set: set.name(),
            threads: rayon::current_num_threads(),
            discs: [grains, particles.len() - grains],
            lattice: on_lattice.then(|| [geometry.shape.columns(), geometry.shape.rows()]),
            occupancy: on_lattice.then_some(geometry.occupancy),
            left_out: left_out.clone(),
            warnings,
            notes: vec![],
            failure: failure.map(ToString::to_string),
            steps: method.steps(),
            seconds,
            phases: method.timings().named(),
            energy,
            long_steps: totals.long_steps,
            deep_disc_steps: totals.deep_disc_steps,
            resolved_conflicts: totals.shared_cells,
            deepest_watched: totals.deepest,
            work_relative_to_everything: (!ledger.is_empty()).then(|| relative_work(checked)),
            ledger,
            last: Observation::of(method.steps(), method.time(), &method.particles(), &scenery),
        }
    }
}

/// Seed of a start that random numbers make.
pub(super) fn seed(start: &Start) -> Option<u64> {
    match start {
        Start::File(_) | Start::List(_) => None,
        Start::Hexagonal { grains, .. }
        | Start::Random { grains, .. }
        | Start::Pipe { grains, .. }
        | Start::Box { grains, .. } => Some(grains.seed),
    }
}

/// Part of a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LedgerRow {
    /// The part.
    pub part: &'static str,
    /// Vector length, as a symbol.
    pub length: &'static str,
    /// Vector length in the last step.
    pub n: u64,
    /// Operations on each element.
    pub operations: u64,
}

fn ledger(method: &dyn Method) -> Vec<LedgerRow> {
    let rows = method.ledger().parts();
    let row = |(part, length, counts): &(&'static str, Length, OpCounts)| LedgerRow {
        part,
        length: length.symbol(),
        n: method.length(*length),
        operations: counts.total(),
    };
    rows.iter().map(row).collect()
}

/// What leaving out saves: the programs as they are against those of the fullest model, on the same lattice.
fn relative_work(checked: &Checked) -> f64 {
    let model = super::model(checked);
    let lengths = Lengths::new(&model, checked.particles.grain_count(), checked.particles.len());
    let work = |model: &Model| -> u64 {
        let parts = lattice_md::ledger(&programs::<f64, f64>(model)).parts();
        parts.iter().map(|(_, length, counts)| counts.total() * lengths.range(*length).len() as u64).sum()
    };
    let everything = Model { friction: true, discs: Discs::Varying, ..model.clone() };
    work(&model) as f64 / work(&everything) as f64
}
