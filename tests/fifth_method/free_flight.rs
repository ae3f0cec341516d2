//! Free flight of discs: the smallest possible method, whose single entry is all that the verbs need.

use serde_json::{Map, Value, json};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use stripmine_physics::domain::Domain;
use stripmine_physics::io::checkpoint::CheckpointColumn;
use stripmine_physics::memory::{MemoryForecast, RankMemory};
use stripmine_physics::method::{
    AxisSetting, Bench, BenchOption, ChoiceEffect, Clock, Elapsed, Fact, MethodEntry, MethodObservable,
    ObservedQuantity, PerParticle, PhysicsFailure, Prepared, QuantityKind, SMALLEST_RADIUS, Schedule,
    SettingAxis, Simulation, Snapshot, StartPurpose, Startable, Stepped, SteppedState, Stepwise, Trials,
    Until, compress,
};
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::{
    self, Binding, DISC_RIVALS, DISCS, DT, DURATION, DiscStart, HEADING, KeySet, OUTPUT, Output, Overrides,
    PLANAR_DOMAIN, Preset, ReadBinding, RunKeys, STEP, STEPPED_RUN, SceneErrors, SceneValues, TARGETED,
    Vocabulary, WallMotion, Write, bind_heading, start_inconsistencies, too_many_steps,
};
use stripmine_physics::start::{StatedStart, create_initial_state, outside};

pub static ENTRY: MethodEntry = MethodEntry {
    vocabulary: &VOCABULARY,
    source: "this test",
    doc: "discs that do not meet",
    quantities: QUANTITIES,
    prepare: |values| Ok(Flight::prepare(values)?.prepared()),
    benches: &[Bench {
        name: "free-flight",
        doc: "Discs that do not meet",
        preset: "drift",
        rate: "particle_steps_per_second",
        until: Until::Steps,
        amount: |_| 100,
        least_warm_up: 1,
        defaults: &[("particles", "50")],
        options: &[BenchOption {
            name: "particles",
            values: &[],
            overrides: |count| vec![format!("particles.count={count}")],
        }],
        overrides: &[],
        quantities: QUANTITIES,
        compared: &["kinetic"],
        at_end: &[],
    }],
    axes: &[SettingAxis {
        name: "integrator",
        decides: ChoiceEffect::Order,
        settings: &[AxisSetting { name: "drift", overrides: Overrides::new }],
        own: |_| Some("drift".to_owned()),
    }],
    twins: &[],
    trials: Some(&TRIALS),
};

/// The only configuration: steps of any length end in the same state.
static TRIALS: Trials = Trials {
    step: &DT,
    references: [&[("integrator", "drift")], &[("integrator", "drift")]],
    balance: None,
    shadow: None,
    encounter: |_, _| None,
    has_trajectories: true,
    has_late_encounters: false,
    adaptive: &[],
    length: SMALLEST_RADIUS,
    has_contacts: false,
    observables: &["kinetic"],
    fluctuating: &[],
    inertia: |_| None,
    theory: |_, _, _| None,
    parameters: &[],
    at_any_step: ENTRY.prepare,
};

static VOCABULARY: Vocabulary = Vocabulary {
    keys: KeySet {
        method: "free-flight",
        groups: &[HEADING, PLANAR_DOMAIN, DISCS, STEP, STEPPED_RUN, TARGETED, OUTPUT],
        rivals: &[DISC_RIVALS, DURATION],
        advice: &[],
    },
    rules: &[start_inconsistencies, too_many_steps],
    presets: &[Preset {
        name: "drift",
        text: "# Discs that fly through each other\nformat = 2\nunits = \"reduced\"\n[method]\nkind = \"free-flight\"\n\
               [domain]\nsides = [40.0, 40.0]\n[particles]\ngenerate = \"random\"\ncount = 20\nradius = 0.5\nmass = 2.0\n\
               speed = 1.0\n[integrator]\ndt = 0.125\n[run]\nsteps = 64\nthermo_every = 8\nsnapshot_every = 32\n\
               checkpoint_every = 16\n",
    }],
    renamed: &[],
};

const QUANTITIES: &[ObservedQuantity] = &[
    ObservedQuantity { name: "time", unit: "time", kind: QuantityKind::Time, doc: "The time." },
    ObservedQuantity { name: "kinetic", unit: "energy", kind: QuantityKind::Instant, doc: "Kinetic energy." },
];

/// A scene of discs in free flight.
#[derive(Clone, Default)]
struct Flight {
    units: String,
    domain: scene::SceneDomain,
    start: DiscStart,
    dt: f64,
    run: RunKeys,
    output: Output,
    made: Particles,
    bounds: Option<Domain>,
}

impl Flight {
    fn bind(&mut self, binding: &mut dyn Binding) {
        bind_heading(binding, &mut self.units, VOCABULARY.keys.method);
        self.domain.bind(binding);
        self.start.bind(binding);
        binding.number(&DT, &mut self.dt);
        self.run.bind(binding, self.dt);
        self.output.bind(binding);
    }

    fn prepare(values: SceneValues) -> Result<Flight, SceneErrors> {
        let (mut flight, mut read) = (Flight::default(), ReadBinding::new(&values));
        flight.bind(&mut read);
        read.finish_reading()?;
        let (domain, start) = (&flight.domain, &flight.start);
        let conserved = domain.periodic;
        let stated = StatedStart {
            values: &values,
            domain,
            start,
            walls: WallMotion::Fixed,
            barriers: &[],
            conserved,
            compress,
        };
        let made = create_initial_state(&stated)?;
        SceneErrors::ok_if_empty(outside(&stated, &made.domain, &made.particles))?;
        Ok(Flight { bounds: Some(made.domain), made: made.particles, ..flight })
    }
}

impl Flight {
    fn prepared(self) -> Prepared {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        Prepared {
            units: self.units.clone(),
            scene: write.to_toml(&VOCABULARY.keys),
            schedule: Schedule::of_steps(&self.run),
            target: self.run.target.clone(),
            output: self.output.clone(),
            domain: self.domain(),
            seed: self.start.seed(),
            start_file: self.start.file().map(Path::to_owned),
            law_file: None,
            facts: vec![Fact::new("discs", self.made.len(), "discs", self.made.len().to_string())],
            warnings: vec![],
            choices: vec![],
            left_out: vec![],
            step_limits: vec![],
            expected_error: None,
            memory: MemoryForecast {
                needed: 1,
                available: None,
                what: "a few discs".to_owned(),
                remedy: "take fewer",
                ranks: RankMemory::default(),
            },
            settings: Map::new(),
            event_columns: None,
            model: Box::new(self),
        }
    }

    fn domain(&self) -> Domain {
        self.bounds.expect("it was prepared")
    }
}

impl Startable for Flight {
    fn particles(&self) -> &Particles {
        &self.made
    }

    fn start(&self, _: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        let (domain, discs) = (self.domain(), self.made.clone());
        Ok(Box::new(Stepped::new(Flying { domain, elapsed: Elapsed::of_steps(self.dt), discs }, Free)))
    }

    fn started_from(&self, particles: Particles) -> Prepared {
        Flight { made: particles, ..self.clone() }.prepared()
    }
}

/// State of the flying discs.
struct Flying {
    domain: Domain,
    elapsed: Elapsed,
    discs: Particles,
}

impl PerParticle for Flying {
    fn particles(&self) -> Particles {
        self.discs.clone()
    }
}

impl SteppedState for Flying {
    fn elapsed(&self) -> &Elapsed {
        &self.elapsed
    }

    fn per_particle(&self) -> &dyn PerParticle {
        self
    }

    fn columns(&self) -> Vec<(String, CheckpointColumn)> {
        let column = |axis: usize| {
            CheckpointColumn::F64(self.discs.all().iter().map(|disc| disc.position[axis]).collect())
        };
        ["x", "y"].iter().zip([0, 1]).map(|(name, axis)| ((*name).to_owned(), column(axis))).collect()
    }
}

/// The law of free flight; it has no state except the discs.
struct Free;

impl Stepwise for Free {
    type State = Flying;
    /// Time and kinetic energy.
    type Seen = [f64; 2];
    const OBSERVABLES: &'static [MethodObservable<[f64; 2]>] = &[
        MethodObservable { quantity: QUANTITIES[0], of: |seen| seen[0] },
        MethodObservable { quantity: QUANTITIES[1], of: |seen| seen[1] },
    ];

    fn step(run: &mut Stepped<Self>, _: &AtomicBool) -> Result<bool, PhysicsFailure> {
        let Flying { domain, elapsed, discs } = &mut run.state;
        for disc in discs.all_mut() {
            let moved = [0, 1, 2].map(|axis| disc.position[axis] + elapsed.dt * disc.velocity[axis]);
            disc.position = domain.wrapped(moved);
        }
        elapsed.steps += 1;
        Ok(true)
    }

    fn with_observation<R>(run: &Stepped<Self>, work: impl FnOnce(&[f64; 2]) -> R) -> R {
        let energy = |v: [f64; 2], mass: f64| 0.5 * mass * (v[0] * v[0] + v[1] * v[1]);
        let discs = run.state.discs.all().iter();
        let kinetic = discs.map(|disc| energy(disc.planar_velocity(), disc.mass)).sum();
        work(&[run.clock().time, kinetic])
    }

    fn save_into(_: &Stepped<Self>, _: &mut Snapshot) {}

    fn restore(run: &mut Stepped<Self>, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        let discs = run.state.discs.all_mut();
        for (axis, name) in ["x", "y"].iter().enumerate() {
            let values = snapshot.numbers(name, discs.len())?;
            discs.iter_mut().zip(values).for_each(|(disc, &value)| disc.position[axis] = value);
        }
        run.state.elapsed.steps = clock.steps;
        Ok(())
    }

    fn work(run: &Stepped<Self>) -> f64 {
        run.state.discs.len() as f64 * run.clock().steps as f64
    }

    fn summary(run: &Stepped<Self>) -> Vec<(&'static str, Value)> {
        vec![("discs", json!(run.state.discs.len()))]
    }

    fn in_words(run: &Stepped<Self>) -> String {
        format!("{} discs", run.state.discs.len())
    }
}
