//! A checked scene and its simulation, as every method offers them.

use super::balance::{Balance, Work};
use super::check::{Checked, Estimates};
use super::checks;
use super::document::Document;
use super::engine::Engine;
use super::facts::{expected_error, facts};
use super::lookout::Lookout;
use super::theory::limits::step_limits;
use super::{
    Lengths, Model, StepProgram, Total, Totals, assemble, assemble_following_energy, ledger, memory, model,
    programs,
};
use crate::domain::Domain;
use crate::io::checkpoint::Counter;
use crate::memory::Foreseen;
use crate::method::{
    Clock, Every, Fact, Failure, Prepared, Purpose, RunWarning, Schedule, Simulation, Snapshot, StepLimit,
    Until, VectorProgram,
};
use crate::model::clock;
use crate::model::machine::MachineModel;
use crate::number::significant;
use crate::observe::{Observation, Scenery};
use crate::particles::Particles;
use crate::scene::{Output, SceneErrors, Warning};
use crate::words::Words;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// A checked scene of granular discs.
struct Discs(Checked);

impl Document {
    /// Makes the discs and holds the scene against what the method demands, as every method does.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn prepare(self) -> Result<Box<dyn Prepared>, SceneErrors> {
        Ok(Box::new(Discs(self.check()?)))
    }

    /// The same, but whatever the step is: what is foreseen of it refuses nothing.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn prepare_at_any_step(self) -> Result<Box<dyn Prepared>, SceneErrors> {
        Ok(Box::new(Discs(self.check_at_any_step()?)))
    }
}

impl Prepared for Discs {
    fn scene(&self) -> String {
        self.0.scene.to_toml()
    }

    fn schedule(&self) -> Schedule {
        let run = self.0.scene.run;
        Schedule {
            until: Until::Steps(run.steps),
            rows: Every::steps(run.thermo_every),
            snapshots: Every::steps(run.snapshot_every),
            checkpoints: Every::steps(run.checkpoint_every),
        }
    }

    fn output(&self) -> Output {
        self.0.scene.output
    }

    fn domain(&self) -> Domain {
        self.0.domain
    }

    fn particles(&self) -> &Particles {
        &self.0.particles
    }

    fn seed(&self) -> Option<u64> {
        self.0.scene.start.seed()
    }

    fn start_file(&self) -> Option<&Path> {
        self.0.scene.start.file()
    }

    fn facts(&self) -> Vec<Fact> {
        facts(&self.0)
    }

    fn warnings(&self) -> &[Warning] {
        &self.0.warnings
    }

    fn choices(&self) -> &[String] {
        &self.0.choices
    }

    fn left_out(&self) -> &[String] {
        &self.0.left_out
    }

    fn step_limits(&self) -> Vec<StepLimit> {
        step_limits(&self.0)
    }

    fn expected_error(&self) -> Option<Fact> {
        expected_error(&self.0)
    }

    fn memory(&self) -> Foreseen {
        memory::foreseen(&self.0)
    }

    fn settings(&self) -> Map<String, Value> {
        let Checked { scene, domain, particles, geometry, .. } = &self.0;
        let discs: f64 = particles.all().iter().map(|disc| std::f64::consts::PI * disc.radius.powi(2)).sum();
        let cell_edge = scene.needs_lattice().then_some(geometry.frame.edge);
        let settings = [
            ("packing_fraction", json!(discs / (domain.area()))),
            ("precision", json!(scene.machine.precision.word())),
            ("integrator", json!(scene.integrator.scheme.name())),
            ("execution", json!(scene.machine.execution_name())),
            ("friction", json!(scene.law.has_friction())),
            ("cell_edge", json!(cell_edge)),
            ("instruction_set", json!(scene.machine.instructions().name())),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn programs(&self) -> Vec<VectorProgram> {
        let Checked { scene, particles, .. } = &self.0;
        if !scene.needs_lattice() {
            return vec![];
        }
        let model = model(&self.0);
        let lengths = Lengths::new(&model, particles.grain_count(), particles.len());
        let as_any = |step: StepProgram| VectorProgram {
            part: step.part.name(),
            length: step.length.symbol(),
            n: lengths.range(step.length).len(),
            times: 1,
            program: step.program,
        };
        programs::<f64, f64>(&model).into_iter().map(as_any).collect()
    }

    fn start(&self, purpose: Purpose) -> Result<Box<dyn Simulation>, Failure> {
        let engine = match purpose {
            Purpose::Run => assemble_following_energy(&self.0)?,
            Purpose::Measurement => assemble(&self.0)?,
        };
        let lookout = (purpose == Purpose::Run).then(|| Lookout::of(&self.0));
        Ok(Box::new(Running::new(&self.0, engine, lookout)))
    }

    fn started_from(&self, particles: Particles) -> Box<dyn Prepared> {
        let estimates = Estimates::of(&self.0.scene, &particles);
        Box::new(Discs(Checked { particles, estimates, ..self.0.clone() }))
    }
}

/// A simulation of granular discs, observed.
struct Running {
    engine: Box<dyn Engine>,
    model: Model,
    scenery: Scenery,
    max_penetration: f64,
    /// The balance of energy since the start.
    work: Work,
    /// Columns and rows of the lattice, where the scene needs one, and discs for each cell.
    lattice: Option<([usize; 2], f64)>,
    discs: [usize; 2],
    /// What is looked at now and then, in a run.
    lookout: Option<Lookout>,
}

impl Running {
    fn new(checked: &Checked, engine: Box<dyn Engine>, lookout: Option<Lookout>) -> Running {
        let Checked { scene, particles, geometry, .. } = checked;
        let model = model(checked);
        let scenery = Scenery::of(&model);
        let seen = Observation::of(engine.steps(), engine.time(), &engine.particles(), &scenery);
        let work = Work::begin(&seen, &engine.standing(), scenery.domain, scenery.gravity);
        let grains = particles.grain_count();
        let cells = [geometry.shape.columns(), geometry.shape.rows()];
        Running {
            engine,
            model,
            scenery,
            max_penetration: scene.law.max_penetration,
            work,
            lattice: scene.needs_lattice().then_some((cells, geometry.occupancy)),
            discs: [grains, particles.len() - grains],
            lookout,
        }
    }

    fn seen(&self) -> (Observation, Balance) {
        let engine = self.engine.as_ref();
        let seen = Observation::of(engine.steps(), engine.time(), &engine.particles(), &self.scenery);
        let balance = self.work.balance(&seen, &engine.standing(), engine);
        (seen, balance)
    }

    /// What leaving out saves: the programs as they are against those of the fullest model, on the same lattice; none where
    /// a step is no fixed program.
    fn relative_work(&self) -> Option<f64> {
        if self.engine.ledger().parts().is_empty() {
            return None;
        }
        let [grains, walls] = self.discs;
        let lengths = Lengths::new(&self.model, grains, grains + walls);
        let work = |model: &Model| -> u64 {
            let parts = ledger(&programs::<f64, f64>(model)).parts();
            let cost = parts.iter();
            cost.map(|(_, length, counts)| counts.total() * lengths.range(*length).len() as u64).sum()
        };
        let everything = Model { friction: true, discs: super::Discs::Varying, ..self.model.clone() };
        Some(work(&self.model) as f64 / work(&everything) as f64)
    }
}

/// Part of a step.
#[derive(Serialize)]
struct LedgerRow {
    /// The part.
    part: &'static str,
    /// Vector length, as a symbol.
    length: &'static str,
    /// Vector length in the last step.
    n: u64,
    /// Operations on each element.
    operations: u64,
}

fn ledger_rows(engine: &dyn Engine) -> Vec<LedgerRow> {
    let parts = engine.ledger().parts();
    let rows = parts.iter().map(|(part, length, counts)| LedgerRow {
        part,
        length: length.symbol(),
        n: engine.length(*length),
        operations: counts.total(),
    });
    rows.collect()
}

impl Simulation for Running {
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), Failure> {
        while !until.iter().any(|moment| moment.has_come(&self.clock())) {
            if interrupted.load(Ordering::Relaxed) {
                break;
            }
            self.engine.step()?;
            if let Some(lookout) = &mut self.lookout
                && Lookout::is_due(self.engine.steps())
            {
                lookout.look(&self.engine.particles());
            }
        }
        Ok(())
    }

    fn clock(&self) -> Clock {
        self.engine.elapsed().clock()
    }

    fn particles(&self) -> Particles {
        self.engine.particles()
    }

    fn observe(&self) -> Vec<f64> {
        let (seen, balance) = self.seen();
        let totals = self.engine.totals();
        vec![
            seen.time,
            seen.kinetic,
            seen.rotational,
            seen.elastic,
            seen.gravitational,
            balance.dissipated,
            balance.gravity_work,
            balance.wall_work,
            balance.balance_error,
            seen.momentum_x,
            seen.momentum_y,
            seen.temperature,
            seen.pressure,
            seen.flow,
            seen.deepest_penetration,
            seen.contacts as f64,
            totals.deep_disc_steps as f64,
            totals.long_steps as f64,
        ]
    }

    fn snapshot(&self) -> Snapshot {
        let counters = self.engine.totals().entries().into_iter().map(|(name, total)| match total {
            Total::Count(count) => (name.to_owned(), Counter::Count(count)),
            Total::Sum(sum) => (name.to_owned(), Counter::Sum(sum)),
        });
        let looked = self.lookout.iter().flat_map(Lookout::counters);
        Snapshot { counters: counters.chain(looked).collect(), columns: self.engine.state() }
    }

    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        clock.of_steps(self.model.dt)?;
        let totals = Totals::from_entries(|name| match snapshot.counters.get(name)? {
            Counter::Count(count) => Some(Total::Count(*count)),
            Counter::Sum(sum) => Some(Total::Sum(*sum)),
        });
        let discs = self.discs[0] + self.discs[1];
        let totals = totals.map_err(|name| format!("the total {name} is missing"))?;
        totals.are_of(clock.steps, discs as u64)?;
        if let Some(lookout) = &mut self.lookout {
            lookout.restore(&snapshot.counters)?;
        }
        self.engine.restore(clock.steps, totals, snapshot.columns)
    }

    fn phases(&self) -> BTreeMap<&'static str, f64> {
        self.engine.timings().named()
    }

    fn reset_phases(&mut self) {
        self.engine.reset_timings();
    }

    fn work(&self) -> f64 {
        self.discs[0] as f64 * self.engine.steps() as f64
    }

    fn clock_periods(&self, machine: &MachineModel) -> Option<f64> {
        let parts = self.engine.ledger().parts();
        let is_counted = !parts.is_empty();
        let clocks = parts.into_iter().map(|(_, length, counts)| {
            clock::Clock::Paper.clocks(machine, &clock::Work::from(counts), self.engine.length(length))
        });
        is_counted.then(|| clocks.sum())
    }

    fn summary(&self) -> Map<String, Value> {
        let ((seen, balance), totals) = (self.seen(), self.engine.totals());
        let entries = [
            ("discs", json!({ "grains": self.discs[0], "walls": self.discs[1] })),
            (
                "lattice",
                json!(self.lattice.map(|([columns, rows], _)| json!({ "columns": columns, "rows": rows }))),
            ),
            ("occupancy", json!(self.lattice.map(|(_, occupancy)| occupancy))),
            ("energy", json!(balance)),
            ("long_steps", json!(totals.long_steps)),
            ("deep_disc_steps", json!(totals.deep_disc_steps)),
            ("resolved_conflicts", json!(totals.shared_cells)),
            ("deepest_watched", json!(totals.deepest)),
            ("ledger", json!(ledger_rows(self.engine.as_ref()))),
            ("work_relative_to_everything", json!(self.relative_work())),
            ("last", json!(seen)),
        ];
        entries.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn warnings(&self) -> Vec<RunWarning> {
        let (_, balance) = self.seen();
        let energy = self.lookout.as_ref().and_then(|_| checks::energy(&balance, self.work.passed(&balance)));
        let looked = self.lookout.iter().flat_map(Lookout::warnings);
        checks::counted(&self.engine.totals(), self.max_penetration)
            .into_iter()
            .chain(looked)
            .chain(energy)
            .collect()
    }

    fn in_words(&self) -> String {
        let ([grains, walls], (seen, _)) = (self.discs, self.seen());
        let mut text = format!("{grains} grains and {walls} wall discs");
        if let Some(([columns, rows], occupancy)) = self.lattice {
            text.push_str(&format!(" on {columns}×{rows} cells, occupancy {occupancy:.3}"));
        }
        text.push_str(&format!(
            "; temperature {}, flow {}, contacts {}, deepest penetration {:.4}",
            significant(seen.temperature, 5),
            significant(seen.flow, 5),
            seen.contacts,
            seen.deepest_penetration
        ));
        if let Some(share) = self.relative_work().filter(|&share| share < 1.0) {
            let saved = 100.0 * (1.0 - share);
            text.push_str(&format!(
                "\nsaved: {saved:.1} % of a step's operations with friction and different discs"
            ));
        }
        text
    }
}
