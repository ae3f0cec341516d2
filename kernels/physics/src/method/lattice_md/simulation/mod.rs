//! A running simulation: one step after the other, every broken precondition found in its step.

mod account;
mod saved;

use super::balance::Way;
use super::fast::{self, FastSearch};
use super::judge::judge_depth;
use super::neighbor_list::Rival;
use super::options::ProgramText;
use super::programs::{programs_of, rival_ledger_of, scales};
use super::walls::walls_at;
use super::watch::Names;
use super::{Arrays, ListOptions, Model, Part, StepProgram, execute, ledger};
use super::{Elapsed, Engine, Phase, Timings, Totals};
use crate::io::checkpoint::Column;
use crate::method::Failure;
use crate::method::pairwise::{Crossings, Named, Prescribed, unwrapped, wrapped};
use crate::observe::{Scenery, Sums};
use crate::particles::{Particle, Particles};
use crate::scene::{Precision, WallMotion};
use stripmine_kernels::backend;
use stripmine_kernels::integrator::NOT_FINITE;
use stripmine_kernels::integrator::gear::STATE;
use stripmine_kernels::isa::{Array, COUNTERS, Counter, ProgramError};
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_kernels::sweep::lattice::cells::{CONFLICTS, STRAYS};
use stripmine_kernels::sweep::lattice::forces::DEEP;
use stripmine_kernels::{Execution, InstructionSet};

/// How contacts are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contacts {
    /// On the lattice: the method of the source.
    Lattice,
    /// Each pair once and the law for contacts only; the machine's execution does not matter.
    Fast(FastSearch),
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
) -> Result<Box<dyn Engine>, Failure> {
    if let Contacts::Fast(search) = contacts {
        let set = machine.set;
        return match precision {
            Precision::F64 => fast::start::<f64, f64>(model, search, set, walls, particles),
            Precision::F32 => fast::start::<f32, f32>(model, search, set, walls, particles),
            Precision::Mixed => fast::start::<f64, f32>(model, search, set, walls, particles),
        };
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
    elapsed: Elapsed,
    totals: Totals,
    /// The cells of the discs before the Index is made, while it is.
    anchor: Vec<u32>,
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
            programs: programs_of::<S, P>(&model),
            arrays: match contacts {
                Contacts::Lists(_) => Arrays::with_forces_by_disc(&model, &particles),
                Contacts::Lattice | Contacts::Fast(_) => Arrays::new(&model, &particles),
            },
            ids: particles.all().iter().map(|disc| disc.id).collect(),
            start: particles,
            elapsed: Elapsed::new(model.dt, crossings),
            model,
            machine,
            walls,
            rival,
            totals: Totals::default(),
            anchor: vec![],
        };
        simulation.move_walls(0.0);
        let power = simulation.compute_forces()?;
        simulation.start_derivatives();
        simulation.totals = Totals::starting_with(power, simulation.wall_power());
        simulation.elapsed.timings = Timings::default();
        Ok(simulation)
    }

    /// The second derivatives that belong to the first forces: a start from zero would spoil the order.
    fn start_derivatives(&mut self) {
        let scale = scales(&self.model)[2];
        let Model { gravity, inertia_factor, discs, .. } = self.model;
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
                q2.iter_mut().zip(acceleration).for_each(|(q, a)| *q = S::from_f64(scale * a));
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
            clock: self.elapsed.clock(),
        }
    }

    fn move_walls(&mut self, time: f64) {
        let (grains, discs) = (self.arrays.lengths().grains, self.arrays.lengths().discs);
        if grains == discs || self.walls == WallMotion::Fixed {
            return;
        }
        let Prescribed { displacement, velocity } = walls_at(self.walls, time);
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
            if self.model.text == ProgramText::Printed
                && let Some(rate) = self.arrays.state_mut([Array::X1, Array::Y1][axis])
            {
                rate[grains..].fill(S::from_f64(velocity[axis]));
            }
            if let Some(column) = self.arrays.lattice_mut([Array::DiscVx, Array::DiscVy][axis]) {
                column[grains..].fill(P::from_f64(velocity[axis]));
            }
        }
    }

    /// Index, lattice vectors and forces of the positions as they stand; gives what contacts dissipate (energy/time).
    fn compute_forces(&mut self) -> Result<f64, Failure> {
        let mut timings = self.elapsed.timings;
        if self.elapsed.crossings.is_followed() || self.model.is_anchored::<S>() {
            self.anchor.clear();
            self.anchor.extend_from_slice(self.arrays.cell());
        }
        // Where the printed text says nothing of discs outside, they are found before it looks for their cells.
        let mut strays = timings.time(Phase::Index, || self.run(&[Part::Box]))?[STRAYS.0 as usize];
        let mut conflicts = 0;
        if strays == 0 {
            let counted = timings.time(Phase::Index, || self.run(Part::CELLS))?;
            (strays, conflicts) = (counted[STRAYS.0 as usize], counted[CONFLICTS.0 as usize]);
        }
        if strays > 0
            && let Some(failure) = self.names().stray(strays)
        {
            return Err(failure);
        }
        self.count_crossings();
        if self.model.reaches_beyond_box()
            && let Some(failure) = self.names().beyond_box()
        {
            return Err(failure);
        }
        // From now on discs are seen from the cells that they are in.
        self.anchor.clear();
        if conflicts > 0
            && self.rival.is_none()
            && let Some(failure) = self.names().conflicting()
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
                let deep = std::mem::take(&mut rival.met.deep).into_iter().map(<[usize; 2]>::from).collect();
                let power = rival.met.dissipated;
                self.rival = Some(rival);
                (power, deep)
            }
        };
        self.elapsed.timings = timings;
        let mut totals = self.totals;
        let judged = judge_depth(&self.names(), marked.into_iter(), watch, &mut totals);
        self.totals = totals;
        judged.map(|()| power)
    }
}

impl<S: backend::Precision, P: backend::Precision> Engine for LatticeMd<S, P> {
    fn step(&mut self) -> Result<(), Failure> {
        self.elapsed.steps += 1;
        let mut timings = self.elapsed.timings;
        timings.time(Phase::Predict, || self.run(&[Part::Predictor]))?;
        timings.time(Phase::Index, || self.judge_steps())?;
        self.elapsed.timings = timings;
        self.move_walls(self.time());
        let power = self.compute_forces()?;
        self.totals.add_work(self.model.dt, power, self.wall_power());
        let mut timings = self.elapsed.timings;
        let counted = timings.time(Phase::Correct, || self.run(&[Part::Corrector]))?;
        self.elapsed.timings = timings;
        let lost = counted[NOT_FINITE.0 as usize];
        if lost > 0
            && let Some(failure) = self.names().not_finite(lost)
        {
            return Err(failure);
        }
        Ok(())
    }

    fn elapsed(&self) -> &Elapsed {
        &self.elapsed
    }

    fn elapsed_mut(&mut self) -> &mut Elapsed {
        &mut self.elapsed
    }

    fn particles(&self) -> Particles {
        wrapped(self.unwrapped(), &self.model.domain())
    }

    fn images(&self) -> Vec<[i32; 2]> {
        let (domain, crossings) = (self.model.domain(), &self.elapsed().crossings);
        if !crossings.follows(&domain) {
            return vec![];
        }
        let image = |(number, disc): (usize, &Particle)| crossings.image(&domain, number, disc.place());
        self.unwrapped().all().iter().enumerate().map(image).collect()
    }

    fn unwrapped(&self) -> Particles {
        let column = |array| self.arrays.state(array).unwrap_or(&[]);
        let places = [Array::X0, Array::Y0].map(column);
        let rates = [Array::X1, Array::Y1, Array::Phi1].map(column);
        let angle = column(Array::Phi0);
        let velocity_scale = scales(&self.model)[1];
        let value = |column: &[S], disc: usize| column.get(disc).map_or(0.0, |x: &S| x.to_f64());
        let of = |disc: usize| {
            let place = places.map(|column| value(column, disc));
            let [x, y] = match self.model.is_anchored::<S>() {
                true => self.model.position(self.arrays.cell()[disc], place),
                false => place,
            };
            let [vx, vy, omega] = rates.map(|column| value(column, disc) / velocity_scale);
            (disc, [[x, vx], [y, vy], [value(angle, disc), omega]])
        };
        let walls = walls_at(self.walls, self.time()).velocity;
        unwrapped(&self.start, walls, (0..self.start.len()).map(of))
    }

    fn sums(&self, scenery: &Scenery, way: &Way) -> Sums {
        let crossings = self.crossings();
        Sums::over_parts(&self.unwrapped(), scenery, |number, grain, position| {
            way.work(number, grain, position, crossings)
        })
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

    fn state(&self) -> Vec<(String, Column)> {
        self.columns()
    }

    fn restore(&mut self, steps: u64, totals: Totals, columns: Vec<(String, Column)>) -> Result<(), String> {
        self.take_up(&columns)?;
        self.elapsed.steps = steps;
        self.totals = totals;
        self.move_walls(self.time());
        Ok(())
    }

    fn ledger(&self) -> Ledger {
        match self.rival {
            None => ledger(&self.programs),
            Some(_) => rival_ledger_of::<S, P>(&self.model),
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
}
