//! A checked scene and its simulation, as every method offers them.

use super::assemble::model_following_energy;
use super::balance::{Way, Work};
use super::check::{Checked, Estimates};
use super::checks;
use super::document::Document;
use super::engine::Engine;
use super::facts::{expected_error, facts};
use super::fast::reach;
use super::programs::with_law_of_text;
use super::quantities::{OBSERVABLES, Seen};
use super::run_monitor::RunMonitor;
use super::theory::limits::step_limits;
use super::{
    Lengths, Model, StepProgram, Total, Totals, assemble, assemble_following_energy, ledger, memory, model,
    programs,
};
use crate::io::checkpoint::Counter;
use crate::method::observed::values;
use crate::method::pairwise::{Crossings, ToReach};
use crate::method::{
    Clock, Failure, Prepared, Purpose, RunWarning, Schedule, Simulation, Snapshot, Startable, Until,
    VectorProgram,
};
use crate::number::significant;
use crate::observe::{Observation, Scenery, Sums};
use crate::particles::{Particles, States};
use crate::scene::{Precision, SceneErrors, WallMotion};
use crate::structure::PairForces;
use crate::words::Words;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::cell::{Cell, OnceCell};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use stripmine_kernels::isa::OpCounts;

impl Document {
    /// Makes the discs and holds the scene against what the method demands, as every method does.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn prepare(self) -> Result<Prepared, SceneErrors> {
        Ok(self.check()?.prepared())
    }

    /// The same, but whatever the step is: what is foreseen of it refuses nothing.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn prepare_at_any_step(self) -> Result<Prepared, SceneErrors> {
        Ok(self.check_at_any_step()?.prepared())
    }
}

impl Checked {
    /// What is offered.
    fn prepared(self) -> Prepared {
        let scene = &self.scene;
        Prepared {
            scene: scene.to_toml(),
            schedule: Schedule::of_steps(&scene.run),
            target: scene.run.target.clone(),
            output: scene.output.clone(),
            domain: self.domain,
            seed: scene.start.seed(),
            start_file: scene.start.file().map(Path::to_owned),
            facts: facts(&self),
            warnings: self.warnings.clone(),
            choices: self.choices.clone(),
            left_out: self.left_out.clone(),
            step_limits: step_limits(&self),
            expected_error: expected_error(&self),
            memory: memory::foreseen(&self),
            settings: self.settings(),
            event_columns: None,
            model: Box::new(self),
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let Checked { scene, domain, particles, geometry, .. } = self;
        let discs: f64 = particles.all().iter().map(|disc| std::f64::consts::PI * disc.radius.powi(2)).sum();
        let cell_edge = scene.needs_lattice().then_some(geometry.frame.edge);
        let settings = [
            ("packing_fraction", json!(discs / (domain.area()))),
            ("precision", json!(scene.machine.precision.word())),
            ("integrator", json!(scene.integrator.scheme.name())),
            ("execution", json!(scene.machine.execution_name())),
            ("text", json!((!scene.machine.is_fast()).then(|| scene.machine.text.word()))),
            ("friction", json!(scene.law.has_friction())),
            ("cell_edge", json!(cell_edge)),
            ("instruction_set", json!(scene.machine.instructions().name())),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }
}

impl Startable for Checked {
    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn work(&self) -> f64 {
        // To move them and find the pairs, and the contacts, of which there are more the denser they lie.
        let discs = self.particles.all().iter();
        let fraction = discs.map(|disc| PI * disc.radius * disc.radius).sum::<f64>() / self.domain.area();
        2.5 + 16.0 * fraction.min(1.0)
    }

    fn programs(&self) -> Vec<VectorProgram> {
        // Lists and sectors have no vector programs: those of the lattice are counted.
        let on_lattice = match self.scene.needs_lattice() {
            true => None,
            false => match self.on_lattice() {
                Some(on_lattice) => Some(on_lattice),
                None => return vec![],
            },
        };
        let model = model(on_lattice.as_ref().unwrap_or(self));
        let particles = &self.particles;
        let lengths = Lengths::new(&model, particles.grain_count(), particles.len());
        let as_any = |step: StepProgram| VectorProgram {
            part: step.part.name(),
            length: step.length.symbol(),
            n: lengths.range(step.length).len(),
            times: 1,
            program: step.program,
        };
        programs(&model, Precision::F64).into_iter().map(as_any).collect()
    }

    fn programs_note(&self) -> Option<String> {
        let by = self.scene.search.by;
        (!self.scene.needs_lattice()).then(|| {
            format!(
                "the programs are those of search.by = \"lattice\"; a run of the scene finds contacts by {}",
                by.word()
            )
        })
    }

    fn pair_forces(&self) -> Option<PairForces> {
        Some(with_law_of_text(&model(self), ToReach(reach(&self.particles))))
    }

    fn follows_crossings(&self) -> bool {
        true
    }

    fn start(&self, purpose: Purpose) -> Result<Box<dyn Simulation>, Failure> {
        let engine = match purpose {
            Purpose::Run => assemble_following_energy(self)?,
            Purpose::Measurement => assemble(self)?,
        };
        let run_monitor = (purpose == Purpose::Run).then(|| RunMonitor::of(self));
        Ok(Box::new(Running::new(self, engine, run_monitor)))
    }

    fn started_from(&self, particles: Particles) -> Prepared {
        let estimates = Estimates::of(&self.scene, &particles);
        Checked { particles, estimates, ..self.clone() }.prepared()
    }

    fn period(&self) -> Option<f64> {
        match self.scene.walls {
            WallMotion::Oscillating { frequency, .. } => Some(1.0 / frequency),
            WallMotion::Fixed => None,
        }
    }
}

/// The phase in which discs are observed.
const OBSERVING: &str = "observe";

/// A simulation of granular discs, observed.
struct Running {
    engine: Box<dyn Engine>,
    model: Model,
    scenery: Scenery,
    /// The balance of energy since the start.
    work: Work,
    /// What is seen of this moment, once somebody has asked.
    seen: OnceCell<Seen>,
    /// Seconds that this has taken: a phase that belongs to no step.
    observing: Cell<f64>,
    /// Columns and rows of the lattice, where the scene needs one, and discs for each cell.
    lattice: Option<([usize; 2], f64)>,
    discs: [usize; 2],
    /// What is looked at now and then, in a run.
    run_monitor: Option<RunMonitor>,
    /// Whether a checkpoint may have no counts of the periods that discs cross.
    counts_for_motion_alone: bool,
}

impl Running {
    fn new(checked: &Checked, engine: Box<dyn Engine>, run_monitor: Option<RunMonitor>) -> Running {
        let Checked { scene, particles, geometry, .. } = checked;
        let model = model(checked);
        let scenery = Scenery::of(&model);
        let way = Way::begin(engine.as_ref(), &scenery);
        let sums = engine.sums(&scenery, &way);
        let work = Work::begin(way, &Observation::new(engine.steps(), engine.time(), &sums, &scenery));
        let run_monitor = run_monitor.map(|mut run_monitor| {
            run_monitor.look(&sums.grains);
            run_monitor
        });
        let grains = particles.grain_count();
        let cells = [geometry.shape.columns(), geometry.shape.rows()];
        Running {
            engine,
            model,
            scenery,
            work,
            seen: OnceCell::new(),
            observing: Cell::default(),
            lattice: scene.needs_lattice().then_some((cells, geometry.occupancy)),
            discs: [grains, particles.len() - grains],
            run_monitor,
            counts_for_motion_alone: model_following_energy(checked).counts_crossings_for_motion_alone(),
        }
    }

    /// What is to be seen of this moment: looked at once, however many ask.
    fn seen(&self) -> &Seen {
        self.seen.get_or_init(|| {
            let (engine, sums) = (self.engine.as_ref(), self.sums());
            let now = Observation::new(engine.steps(), engine.time(), &sums, &self.scenery);
            let totals = engine.totals();
            Seen { now, balance: self.work.balance(&now, &sums, &totals), totals }
        })
    }

    /// Sums over the discs and their contacts as they stand, with the time that they take.
    fn sums(&self) -> Sums {
        let start = Instant::now();
        let sums = self.engine.sums(&self.scenery, self.work.way());
        self.observing.set(self.observing.get() + start.elapsed().as_secs_f64());
        sums
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
            let parts = ledger(&programs(model, Precision::F64)).parts();
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
            self.seen.take();
            self.engine.step()?;
            if self.run_monitor.is_some() && RunMonitor::is_due(self.engine.steps()) {
                let sums = self.sums();
                self.run_monitor.iter_mut().for_each(|run_monitor| run_monitor.look(&sums.grains));
            }
        }
        Ok(())
    }

    fn clock(&self) -> Clock {
        self.engine.elapsed().clock()
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.model.dt)
    }

    fn particles(&self) -> Particles {
        self.engine.particles()
    }

    fn states(&self, states: &mut States) {
        self.engine.states(states);
    }

    fn positions(&self) -> Vec<[f32; 3]> {
        self.engine.positions()
    }

    fn images(&self) -> Vec<[i32; 2]> {
        self.engine.images()
    }

    fn observe(&self) -> Vec<f64> {
        values(&OBSERVABLES, self.seen())
    }

    fn snapshot(&self) -> Snapshot {
        let counters = self.engine.totals().entries().into_iter().map(|(name, total)| match total {
            Total::Count(count) => (name.to_owned(), Counter::Count(count)),
            Total::Sum(sum) => (name.to_owned(), Counter::Sum(sum)),
        });
        let looked = self.run_monitor.iter().flat_map(RunMonitor::counters);
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
        if let Some(run_monitor) = &mut self.run_monitor {
            run_monitor.restore(&snapshot.counters)?;
        }
        self.seen.take();
        let mut columns = snapshot.columns;
        if self.counts_for_motion_alone {
            Crossings::begin_in(&mut columns, discs);
        }
        self.engine.restore(clock.steps, totals, columns)
    }

    fn phases(&self) -> BTreeMap<&'static str, f64> {
        let observing = Some((OBSERVING, self.observing.get())).filter(|(_, seconds)| *seconds > 0.0);
        self.engine.timings().named().into_iter().chain(observing).collect()
    }

    fn reset_phases(&mut self) {
        self.engine.reset_timings();
        self.observing.take();
    }

    fn work(&self) -> f64 {
        self.discs[0] as f64 * self.engine.steps() as f64
    }

    fn operations(&self) -> Vec<(OpCounts, u64)> {
        let parts = self.engine.ledger().parts();
        parts.into_iter().map(|(_, length, counts)| (counts, self.engine.length(length))).collect()
    }

    fn summary(&self) -> Map<String, Value> {
        let Seen { now, balance, totals, .. } = self.seen();
        let lists = self.engine.lists();
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
            ("listed_pairs", json!(lists.map(|(entries, _)| entries))),
            ("lists_made", json!(lists.map(|(_, made)| made))),
            ("ledger", json!(ledger_rows(self.engine.as_ref()))),
            ("work_relative_to_everything", json!(self.relative_work())),
            ("last", json!(now)),
        ];
        entries.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn warnings(&self) -> Vec<RunWarning> {
        let Seen { balance, totals, .. } = self.seen();
        let energy =
            self.run_monitor.as_ref().and_then(|_| checks::energy(balance, self.work.passed(balance)));
        let looked = self.run_monitor.iter().flat_map(RunMonitor::warnings);
        checks::counted(totals).into_iter().chain(looked).chain(energy).collect()
    }

    fn in_words(&self) -> String {
        let ([grains, walls], Seen { now, .. }) = (self.discs, self.seen());
        let mut text = format!("{grains} grains and {walls} wall discs");
        if let Some(([columns, rows], occupancy)) = self.lattice {
            let occupancy = significant(occupancy, 4);
            text.push_str(&format!(" on {columns}×{rows} cells, occupancy {occupancy}"));
        }
        text.push_str(&format!(
            "; temperature {}, flow {}, contacts {}, deepest penetration {}",
            significant(now.temperature, 5),
            significant(now.flow, 5),
            now.contacts,
            significant(now.deepest_penetration, 4)
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
