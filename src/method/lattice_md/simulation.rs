//! A running simulation: one step after the other, every broken precondition found in its step.

use super::crossings::Crossings;
use super::fast::{FastMd, Search};
use super::neighbor_list::Rival;
use super::programs::rival_ledger;
use super::walls::walls_at;
use super::watch::Names;
use super::{Arrays, ListOptions, Model, OnLongStep, Part, StepProgram, execute, ledger, programs};
use crate::method::{Failure, Method, Phase, StateColumn, Timings, Totals};
use crate::particles::Particles;
use crate::scene::{Precision, WallMotion};
use stripmine_kernels::backend;
use stripmine_kernels::integrator::gear::{NOT_FINITE, STATE};
use stripmine_kernels::isa::{Array, COUNTERS, Counter, ProgramError, Storage};
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_kernels::sweep::lattice::cells::{CONFLICTS, STRAYS};
use stripmine_kernels::sweep::lattice::forces::DEEP;
use stripmine_kernels::{Execution, InstructionSet};

/// Columns of a neighbour list's state: where the discs were when the lists were made.
const MADE_AT: [&str; 2] = ["listed.x", "listed.y"];
/// How often lists were made, and how many pairs the last step met.
const LIST_COUNTS: &str = "listed.counts";

/// How contacts are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contacts {
    /// On the lattice: the method of the source.
    Lattice,
    /// Each pair once and the law for contacts only; the machine's execution does not matter.
    Fast(Search),
    /// By neighbour lists: its rival.
    Lists(ListOptions),
}

/// How the programs are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// How instructions meet elements.
    pub execution: Execution,
    /// The instructions.
    pub set: InstructionSet,
}

/// Begins a simulation in the precision asked for. Compiled here once, for all that run one.
///
/// # Errors
/// As [`LatticeMd::new`].
pub fn start(
    precision: Precision,
    model: Model,
    contacts: Contacts,
    machine: Machine,
    walls: WallMotion,
    particles: Particles,
) -> Result<Box<dyn Method>, Failure> {
    if let Contacts::Fast(search) = contacts {
        let set = machine.set;
        return Ok(match precision {
            Precision::F64 => Box::new(FastMd::<f64, f64>::new(model, search, set, walls, particles)?),
            Precision::F32 => Box::new(FastMd::<f32, f32>::new(model, search, set, walls, particles)?),
            Precision::Mixed => Box::new(FastMd::<f64, f32>::new(model, search, set, walls, particles)?),
        });
    }
    Ok(match precision {
        Precision::F64 => Box::new(LatticeMd::<f64, f64>::new(model, contacts, machine, walls, particles)?),
        Precision::F32 => Box::new(LatticeMd::<f32, f32>::new(model, contacts, machine, walls, particles)?),
        Precision::Mixed => Box::new(LatticeMd::<f64, f32>::new(model, contacts, machine, walls, particles)?),
    })
}

/// A simulation with state of precision `S` and forces of precision `P`.
pub struct LatticeMd<S, P> {
    model: Model,
    machine: Machine,
    programs: Vec<StepProgram>,
    arrays: Arrays<S, P>,
    start: Particles,
    ids: Vec<u32>,
    walls: WallMotion,
    rival: Option<Rival<P>>,
    steps: u64,
    totals: Totals,
    crossings: Crossings,
    /// The cells of the discs before the Index is made, while it is.
    anchor: Vec<u32>,
    timings: Timings,
}

impl<S: backend::Precision, P: backend::Precision> LatticeMd<S, P> {
    /// Lays out `particles` and finds their first accelerations.
    ///
    /// # Errors
    /// [`Failure`] if the start breaks a precondition already.
    pub fn new(
        model: Model,
        contacts: Contacts,
        machine: Machine,
        walls: WallMotion,
        particles: Particles,
    ) -> Result<Self, Failure> {
        let rival = match contacts {
            Contacts::Lattice | Contacts::Fast(_) => None,
            Contacts::Lists(options) => {
                let largest = particles.radii().map_or(1.0, |[_, largest]| largest);
                Some(Rival::new(&model, options, largest))
            }
        };
        let crossings = Crossings::new(model.counts_crossings(), particles.len());
        let mut simulation = LatticeMd {
            programs: programs::<S, P>(&model),
            arrays: match contacts {
                Contacts::Lists(_) => Arrays::with_forces_by_disc(&model, &particles),
                Contacts::Lattice | Contacts::Fast(_) => Arrays::new(&model, &particles),
            },
            ids: particles.all().iter().map(|disc| disc.id).collect(),
            start: particles,
            model,
            machine,
            walls,
            rival,
            steps: 0,
            totals: Totals::default(),
            crossings,
            anchor: vec![],
            timings: Timings::default(),
        };
        simulation.move_walls(0.0);
        let power = simulation.meet()?;
        simulation.start_derivatives();
        simulation.totals = Totals::starting_with(power, simulation.wall_power());
        simulation.timings = Timings::default();
        Ok(simulation)
    }

    /// The second derivatives that belong to the first forces: a start from zero would spoil the order.
    fn start_derivatives(&mut self) {
        let Model { dt, gravity, inertia_factor, discs, .. } = self.model;
        for (freedom, force) in [Array::Fx, Array::Fy, Array::Torque].into_iter().enumerate() {
            let Some(column) = self.arrays.lattice(force) else { continue };
            let acceleration: Vec<f64> = self
                .start
                .grains()
                .iter()
                .enumerate()
                .map(|(number, grain)| {
                    let force = self.arrays.force_at(number).map_or(f64::NAN, |at| column[at].to_f64());
                    let inertia = match (discs, freedom) {
                        (super::Discs::Equal { disc, .. }, 0 | 1) => 1.0 / disc.inverse_mass,
                        (super::Discs::Equal { inverse_inertia, .. }, _) => 1.0 / inverse_inertia,
                        (super::Discs::Varying, 0 | 1) => grain.mass,
                        (super::Discs::Varying, _) => {
                            inertia_factor * grain.mass * grain.radius * grain.radius
                        }
                    };
                    force / inertia + gravity.get(freedom).copied().unwrap_or(0.0)
                })
                .collect();
            if let Some(q2) = self.arrays.state_mut(STATE[freedom][2]) {
                q2.iter_mut().zip(acceleration).for_each(|(q, a)| *q = S::from_f64(0.5 * dt * dt * a));
            }
        }
    }

    fn run(&mut self, parts: &[Part]) -> Result<[u64; COUNTERS], ProgramError> {
        let (memory, lengths) = match parts {
            [Part::Corrector] => self.arrays.memory_of_corrector(),
            _ => self.arrays.memory(),
        };
        execute(&self.programs, parts, &memory, lengths, self.machine.execution, self.machine.set)?;
        Ok([0, 1, 2, 3].map(|counter| memory.counted(Counter(counter))))
    }

    fn names(&self) -> Names<'_, S, P> {
        Names {
            model: &self.model,
            arrays: &self.arrays,
            anchor: &self.anchor,
            ids: &self.ids,
            step: self.steps,
        }
    }

    fn move_walls(&mut self, time: f64) {
        let (grains, discs) = (self.arrays.lengths().grains, self.arrays.lengths().discs);
        if grains == discs || self.walls == WallMotion::Fixed {
            return;
        }
        let (displacement, velocity) = walls_at(self.walls, time);
        let positions = self.start.all()[grains..].iter().map(|disc| disc.position);
        let mut positions: Vec<[f64; 2]> =
            positions.map(|at| [at[0] + displacement[0], at[1] + displacement[1]]).collect();
        if self.model.is_anchored::<S>() {
            for (disc, position) in (grains..).zip(&mut positions) {
                let (cell, place) = self.model.anchored(*position);
                self.arrays.cell_mut()[disc] = cell;
                *position = place;
            }
        }
        for axis in 0..2 {
            let start = positions.iter().map(|position| position[axis]);
            if let Some(position) = self.arrays.state_mut([Array::X0, Array::Y0][axis]) {
                position[grains..].iter_mut().zip(start).for_each(|(to, from)| *to = S::from_f64(from));
            }
            if let Some(column) = self.arrays.lattice_mut([Array::DiscVx, Array::DiscVy][axis]) {
                column[grains..].fill(P::from_f64(velocity[axis]));
            }
        }
    }

    /// Discs that are so fast that contacts may pass unseen in a step.
    fn judge_steps(&mut self) -> Result<(), Failure> {
        let Some(watch) = self.model.watch else { return Ok(()) };
        let column = |array| self.arrays.state(array).unwrap_or(&[]);
        let (x, y) = (column(Array::X1), column(Array::Y1));
        let square = S::from_f64(watch.longest_step() * watch.longest_step());
        // What is no number is found when the cells are.
        let is_far = |&(x, y): &(&S, &S)| square.less_than(*x * *x + *y * *y);
        let grains = || x.iter().zip(y).take(self.arrays.lengths().grains);
        let count = grains().filter(is_far).count() as u64;
        if count == 0 {
            return Ok(());
        }
        self.totals.long_steps += count;
        match (watch.on_long_step, grains().position(|step| is_far(&step))) {
            (OnLongStep::Stop, Some(first)) => {
                Err(self.names().long_step(count, first, watch.longest_step()))
            }
            _ => Ok(()),
        }
    }

    /// Periods that discs crossed when the Index wrapped them: no step is as long as half the box.
    fn count_crossings(&mut self) {
        if !self.crossings.is_followed() {
            return;
        }
        let counts = [self.model.shape.columns(), self.model.shape.rows()];
        for (disc, (&from, &to)) in self.anchor.iter().zip(self.arrays.cell()).enumerate() {
            if from == to || from == 0 || to == 0 {
                continue;
            }
            let [from, to] = [from, to].map(|cell| self.model.shape.column_and_row(cell as usize - 1));
            let crossed = [0, 1].map(|axis| {
                let moved = to[axis] - from[axis];
                if 2 * moved.unsigned_abs() > counts[axis] { -(moved.signum() as f64) } else { 0.0 }
            });
            self.crossings.add(disc, crossed);
        }
    }

    /// What moving walls put in (energy/time): all walls have one velocity, and what they do to the grains is the sum of
    /// the grains' forces, for those of two grains cancel.
    fn wall_power(&self) -> f64 {
        if self.walls == WallMotion::Fixed || !self.model.follows_energy() {
            return 0.0;
        }
        let (_, velocity) = walls_at(self.walls, self.time());
        let grains = self.arrays.lengths().grains;
        let along = |axis: usize| -> f64 {
            let column = self.arrays.lattice([Array::Fx, Array::Fy][axis]).unwrap_or(&[]);
            let forces = (0..grains).filter_map(|disc| Some(column[self.arrays.force_at(disc)?].to_f64()));
            velocity[axis] * forces.sum::<f64>()
        };
        along(0) + along(1)
    }

    /// What the contacts found in the sweep of the lattice dissipate (energy/time).
    fn power_on_lattice(&self) -> f64 {
        let Some(power) = self.arrays.lattice(Array::Power) else { return 0.0 };
        let grains = &self.arrays.cell()[..self.arrays.lengths().grains];
        grains.iter().map(|&cell| power[cell as usize - 1].to_f64()).sum()
    }

    /// Index, lattice vectors and forces of the positions as they stand; gives what contacts dissipate (energy/time).
    fn meet(&mut self) -> Result<f64, Failure> {
        let mut timings = self.timings;
        if self.crossings.is_followed() || self.model.is_anchored::<S>() {
            self.anchor.clear();
            self.anchor.extend_from_slice(self.arrays.cell());
        }
        let counted = timings.time(Phase::Index, || self.run(&[Part::Index]))?;
        let strays = counted[STRAYS.0 as usize];
        if strays > 0
            && let Some(failure) = self.names().stray(strays)
        {
            return Err(failure);
        }
        self.count_crossings();
        // From now on discs are seen from the cells that they are in.
        self.anchor.clear();
        if counted[CONFLICTS.0 as usize] > 0
            && self.rival.is_none()
            && let Some(failure) = self.names().conflict()
        {
            return Err(failure);
        }
        let watch = self.model.watch;
        let (power, marked) = match self.rival.take() {
            None => {
                timings.time(Phase::Index, || self.run(&[Part::Lattice]))?;
                let counted = timings.time(Phase::Forces, || self.run(&[Part::Forces]))?;
                let found = watch.filter(|_| counted[DEEP.0 as usize] > 0);
                let marked = found.map_or(vec![], |watch| self.names().marked_on_lattice(watch.depth()));
                (self.power_on_lattice(), marked)
            }
            Some(mut rival) => {
                timings.time(Phase::Index, || rival.keep(&self.model, &self.arrays));
                timings.time(Phase::Forces, || rival.forces(&self.model, &mut self.arrays));
                let deep = std::mem::take(&mut rival.met.deep);
                let power = rival.met.dissipated;
                self.rival = Some(rival);
                (power, deep)
            }
        };
        self.timings = timings;
        let Some(watch) = watch.filter(|_| !marked.is_empty()) else { return Ok(power) };
        let (grains, deepest) = self.names().deep(&marked, watch.max_penetration);
        if let Some(deepest) = deepest {
            self.totals.add_deep(self.steps, grains, deepest.0);
            if deepest.0 > watch.stop_penetration {
                return Err(self.names().too_deep(deepest, watch.stop_penetration));
            }
        }
        Ok(power)
    }
}

impl<S: backend::Precision, P: backend::Precision> Method for LatticeMd<S, P> {
    fn step(&mut self) -> Result<(), Failure> {
        self.steps += 1;
        let mut timings = self.timings;
        timings.time(Phase::Predict, || self.run(&[Part::Predictor]))?;
        timings.time(Phase::Index, || self.judge_steps())?;
        self.timings = timings;
        self.move_walls(self.time());
        let power = self.meet()?;
        self.totals.add_work(self.model.dt, power, self.wall_power());
        let mut timings = self.timings;
        let counted = timings.time(Phase::Correct, || self.run(&[Part::Corrector]))?;
        self.timings = timings;
        let lost = counted[NOT_FINITE.0 as usize];
        if lost > 0
            && let Some(failure) = self.names().not_finite(lost)
        {
            return Err(failure);
        }
        Ok(())
    }

    fn steps(&self) -> u64 {
        self.steps
    }

    fn time(&self) -> f64 {
        self.steps as f64 * self.model.dt
    }

    fn particles(&self) -> Particles {
        let mut particles = self.start.clone();
        let column = |array| self.arrays.state(array).unwrap_or(&[]);
        let value = |array, disc: usize| column(array).get(disc).map_or(0.0, |x: &S| x.to_f64());
        let (_, wall_velocity) = walls_at(self.walls, self.time());
        let (grains, domain) = (self.arrays.lengths().grains, self.model.domain());
        for (i, disc) in particles.all_mut().iter_mut().enumerate() {
            disc.position = match self.model.is_anchored::<S>() {
                true => {
                    let place = [value(Array::X0, i), value(Array::Y0, i)];
                    domain.inside(self.model.position(self.arrays.cell()[i], place))
                }
                false => [value(Array::X0, i), value(Array::Y0, i)],
            };
            if i < grains {
                disc.velocity = [Array::X1, Array::Y1].map(|array| value(array, i) / self.model.dt);
                disc.omega = value(Array::Phi1, i) / self.model.dt;
                disc.angle = value(Array::Phi0, i);
            } else {
                disc.velocity = wall_velocity;
            }
        }
        particles
    }

    fn forces(&self) -> Vec<[f64; 3]> {
        let on = |array, disc: usize| match (self.arrays.lattice(array), self.arrays.force_at(disc)) {
            (Some(column), Some(at)) => column[at].to_f64(),
            _ => 0.0,
        };
        let forces = |disc| [Array::Fx, Array::Fy, Array::Torque].map(|array| on(array, disc));
        (0..self.start.len()).map(forces).collect()
    }

    fn totals(&self) -> Totals {
        self.totals
    }

    fn crossings(&self) -> Vec<[f64; 2]> {
        self.crossings.counts().to_vec()
    }

    fn state(&self) -> Vec<(String, StateColumn)> {
        let column = |values: &[S]| match S::NAME {
            f64::NAME => StateColumn::F64(values.iter().map(|x| x.to_f64()).collect()),
            _ => StateColumn::F32(values.iter().map(|x| x.to_f64() as f32).collect()),
        };
        let arrays = self.arrays.states().map(|(array, values)| (array.label(), column(values)));
        let crossings =
            self.crossings.columns().into_iter().map(|(name, counts)| (name, StateColumn::F64(counts)));
        let cells = self.model.is_anchored::<S>().then(|| {
            let cells = self.arrays.cell().iter().map(|&cell| f64::from(cell)).collect();
            (Array::DiscCell.label(), StateColumn::F64(cells))
        });
        let state = arrays.chain(cells).chain(crossings).map(|(name, column)| (name.to_owned(), column));
        let mut columns: Vec<(String, StateColumn)> = state.collect();
        if let Some(rival) = &self.rival {
            for (name, values) in MADE_AT.into_iter().zip(rival.made_at()) {
                columns.push((name.to_owned(), StateColumn::F64(values)));
            }
            // Whole numbers up to 2⁵³: far more than there will ever be.
            let counts = vec![rival.rebuilds as f64, rival.met.pairs as f64];
            columns.push((LIST_COUNTS.to_owned(), StateColumn::F64(counts)));
        }
        columns
    }

    fn restore(
        &mut self,
        steps: u64,
        totals: Totals,
        columns: Vec<(String, StateColumn)>,
    ) -> Result<(), String> {
        let expected: Vec<Array> = self.arrays.states().map(|(array, _)| array).collect();
        for array in expected {
            let (_, column) = columns
                .iter()
                .find(|(name, _)| name == array.label())
                .ok_or_else(|| format!("the column {} is missing", array.label()))?;
            let values: Vec<S> = match column {
                StateColumn::F64(values) if S::NAME == f64::NAME => {
                    values.iter().map(|&x| S::from_f64(x)).collect()
                }
                StateColumn::F32(values) if S::NAME == f32::NAME => {
                    values.iter().map(|&x| S::from_f64(x.into())).collect()
                }
                _ => return Err(format!("the column {} has another precision", array.label())),
            };
            let to = self.arrays.state_mut(array).unwrap_or(&mut []);
            if to.len() != values.len() {
                let label = array.label();
                return Err(format!("the column {label} has {} entries, not {}", values.len(), to.len()));
            }
            to.copy_from_slice(&values);
        }
        if self.model.is_anchored::<S>() {
            let label = Array::DiscCell.label();
            let cells = columns.iter().find(|(name, _)| name == label).map(|(_, column)| column);
            let most = self.model.shape.padded() as f64;
            match cells {
                Some(StateColumn::F64(cells))
                    if cells.len() == self.arrays.cell().len()
                        && cells.iter().all(|cell| (1.0..=most).contains(cell)) =>
                {
                    let to = self.arrays.cell_mut().iter_mut();
                    to.zip(cells).for_each(|(to, &cell)| *to = cell as u32);
                }
                _ => {
                    return Err(format!(
                        "the column {label} is missing, or its cells are none of the lattice"
                    ));
                }
            }
        }
        self.crossings.take_up(|name| match columns.iter().find(|(known, _)| known == name) {
            Some((_, StateColumn::F64(values))) => Ok(values.clone()),
            _ => Err(format!("the column {name} is missing")),
        })?;
        if let Some(rival) = &mut self.rival {
            let find = |name: &str, length: usize| -> Result<Vec<f64>, String> {
                match columns.iter().find(|(there, _)| there == name) {
                    Some((_, StateColumn::F64(values)))
                        if values.len() == length && values.iter().all(|x| x.is_finite()) =>
                    {
                        Ok(values.clone())
                    }
                    _ => {
                        Err(format!("there is no column {name} of {length} finite double-precision entries"))
                    }
                }
            };
            let made_at = [find(MADE_AT[0], self.ids.len())?, find(MADE_AT[1], self.ids.len())?];
            let counts = find(LIST_COUNTS, 2)?;
            rival.take_up(&self.model, made_at, counts[0] as u64, counts[1] as u64);
        }
        self.steps = steps;
        self.totals = totals;
        self.move_walls(self.time());
        Ok(())
    }

    fn ledger(&self) -> Ledger {
        match self.rival {
            None => ledger(&self.programs),
            Some(_) => rival_ledger::<S, P>(&self.model),
        }
    }

    fn length(&self, length: Length) -> u64 {
        match (length, &self.rival) {
            (Length::Candidates, Some(rival)) => rival.candidates() as u64,
            (Length::Pairs, Some(rival)) => rival.met.pairs,
            _ => self.arrays.lengths().range(length).len() as u64,
        }
    }

    fn lists(&self) -> Option<(usize, u64)> {
        self.rival.as_ref().map(|rival| (rival.candidates(), rival.rebuilds))
    }

    fn timings(&self) -> &Timings {
        &self.timings
    }

    fn reset_timings(&mut self) {
        self.timings = Timings::default();
    }
}
