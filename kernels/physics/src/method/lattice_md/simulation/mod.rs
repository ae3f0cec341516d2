//! Discs stepped by the vector programs, or by BP93's neighbour lists on the same state. Every violated precondition is detected in the step in which
//! it occurs.

mod accounting;
mod names;
mod saved;

use super::neighbor_list::ScalarLists;
use super::options::ProgramVersion;
use super::programs::{neighbour_list_ledger_of, programs_of, scales};
use super::walls::walls_at;
use super::{
    ContactSearch, GranularModel, Part, ProgramArrays, ProgramExecution, StepProgram, execute, ledger,
};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::pairwise::{
    Crossings, Elapsed, NameableDiscs, Phase, PlaneWalls, PrescribedMotion, SteppingDiscs, Timings,
    WallTouch, unwrapped, wrapped,
};
use crate::method::{PerParticle, PhysicsFailure, SteeringError};
use crate::particles::{Particle, Particles};
use crate::scene::WallMotion;
use std::sync::Arc;
use stripmine_kernels::backend;
use stripmine_kernels::integrator::NOT_FINITE;
use stripmine_kernels::integrator::gear::STATE;
use stripmine_kernels::isa::{Array, COUNTERS, LaneCounter, ProgramError};
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::ledger::{Ledger, VectorLength};
use stripmine_kernels::sweep::fast::SweepReport;
use stripmine_kernels::sweep::lattice::cells::{CONFLICTS, STRAYS};
use stripmine_kernels::sweep::lattice::forces::DEEP;

/// Discs with state of precision `S` and forces of precision `P`.
pub(super) struct LatticeMd<S, P> {
    model: GranularModel,
    machine: ProgramExecution,
    programs: Vec<StepProgram>,
    arrays: ProgramArrays<S, P>,
    start: Particles,
    walls: WallMotion,
    rival: Option<ScalarLists<P>>,
    elapsed: Elapsed,
    /// Cells that positions are measured in while the Index is built; empty if they are those of the arrays.
    anchor: Vec<u32>,
    /// Contacts with plane walls when forces were last computed.
    touches: Vec<WallTouch>,
}

impl<S: backend::Precision, P: backend::Precision> LatticeMd<S, P> {
    /// Places `particles`. Their forces are unknown until [`compute_forces`](SteppingDiscs::compute_forces).
    pub(super) fn new(
        model: GranularModel,
        contacts: ContactSearch,
        machine: ProgramExecution,
        walls: WallMotion,
        particles: Particles,
    ) -> Self {
        let rival = match contacts {
            ContactSearch::Lattice | ContactSearch::Fast(_) => None,
            ContactSearch::Lists(options) => {
                let largest = particles.radii().map_or(1.0, |[_, largest]| largest);
                Some(ScalarLists::new(&model, options, largest))
            }
        };
        let crossings = Crossings::new(model.counts_crossings(), particles.len());
        LatticeMd {
            programs: programs_of::<S, P>(&model),
            arrays: match contacts {
                ContactSearch::Lists(_) => ProgramArrays::with_forces_by_disc(&model, &particles),
                ContactSearch::Lattice | ContactSearch::Fast(_) => ProgramArrays::new(&model, &particles),
            },
            start: particles,
            elapsed: Elapsed::new(model.dt, crossings),
            model,
            machine,
            walls,
            rival,
            anchor: vec![],
            touches: vec![],
        }
    }

    /// Sets the second derivatives of the first forces: a start from zero would reduce the order.
    fn start_derivatives(&mut self) {
        let scale = scales(&self.model)[2];
        let GranularModel { gravity, inertia_factor, discs, .. } = self.model;
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
                        (super::DiscUniformity::Equal { disc, .. }, 0 | 1) => 1.0 / disc.inverse_mass,
                        (super::DiscUniformity::Equal { inverse_inertia, .. }, _) => 1.0 / inverse_inertia,
                        (super::DiscUniformity::Varying, 0 | 1) => grain.mass,
                        (super::DiscUniformity::Varying, _) => {
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
        Ok([0, 1, 2, 3].map(|counter| memory.counted(LaneCounter(counter))))
    }

    fn move_walls(&mut self, time: f64) {
        let (grains, discs) = (self.arrays.lengths().grains, self.arrays.lengths().discs);
        if grains == discs || self.walls == WallMotion::Fixed {
            return;
        }
        let PrescribedMotion { displacement, velocity } = walls_at(self.walls, time);
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
            if self.model.text == ProgramVersion::Printed
                && let Some(rate) = self.arrays.state_mut([Array::X1, Array::Y1][axis])
            {
                rate[grains..].fill(S::from_f64(velocity[axis]));
            }
            if let Some(column) = self.arrays.lattice_mut([Array::DiscVx, Array::DiscVy][axis]) {
                column[grains..].fill(P::from_f64(velocity[axis]));
            }
        }
    }
}

impl<S: backend::Precision, P: backend::Precision> PerParticle for LatticeMd<S, P> {
    fn particles(&self) -> Particles {
        wrapped(self.unwrapped(), &self.model.domain())
    }

    fn images(&self) -> Vec<[i32; 2]> {
        let (domain, crossings) = (self.model.domain(), &self.elapsed.crossings);
        if !crossings.follows(&domain) {
            return vec![];
        }
        let image =
            |(number, disc): (usize, &Particle)| crossings.image(&domain, number, disc.planar_position());
        self.unwrapped().all().iter().enumerate().map(image).collect()
    }
}

impl<S: backend::Precision, P: backend::Precision> SteppingDiscs for LatticeMd<S, P> {
    fn advance(&mut self) -> Result<Vec<u32>, PhysicsFailure> {
        self.elapsed.steps += 1;
        let mut timings = self.elapsed.timings;
        timings.time(Phase::Predict, || self.run(&[Part::Predictor]))?;
        let far = timings.time(Phase::Index, || self.far());
        self.elapsed.timings = timings;
        Ok(far)
    }

    // The programs are compiled for the quantities that the model needs.
    fn compute_forces(&mut self, _asked: ObservationRequest) -> Result<SweepReport, PhysicsFailure> {
        self.move_walls(self.elapsed.time());
        let mut timings = self.elapsed.timings;
        if self.elapsed.crossings.is_followed() || self.model.is_anchored::<S>() {
            self.anchor.clear();
            self.anchor.extend_from_slice(self.arrays.cell());
        }
        // The printed programs do not handle discs outside, so these are detected before their cells are computed.
        let mut strays = timings.time(Phase::Index, || self.run(&[Part::Box]))?[STRAYS.0 as usize];
        let mut conflicts = 0;
        if strays == 0 {
            let counted = timings.time(Phase::Index, || self.run(Part::CELLS))?;
            (strays, conflicts) = (counted[STRAYS.0 as usize], counted[CONFLICTS.0 as usize]);
        }
        if strays > 0
            && let Some(failure) = self.stray(strays)
        {
            return Err(failure);
        }
        self.count_crossings();
        if self.model.reaches_beyond_box()
            && let Some(failure) = self.beyond_box()
        {
            return Err(failure);
        }
        // From here on, positions are measured in the discs' current cells.
        self.anchor.clear();
        if conflicts > 0
            && self.rival.is_none()
            && let Some(failure) = self.conflicting()
        {
            return Err(failure);
        }
        let watch = self.model.watch;
        let met = match self.rival.take() {
            None => {
                timings.time(Phase::Index, || self.run(&[Part::Lattice]))?;
                let counted = timings.time(Phase::Forces, || self.run(&[Part::Forces]))?;
                if !self.model.walls.is_empty() {
                    timings.time(Phase::Forces, || self.run(&[Part::Walls]))?;
                    self.touches = self.arrays.wall_touches(&self.model);
                }
                let found = watch.filter(|_| counted[DEEP.0 as usize] > 0);
                let deep = found.map_or(vec![], |watch| self.marked_on_lattice(watch.depth()));
                SweepReport { deep, dissipated: self.power_on_lattice(), ..SweepReport::default() }
            }
            Some(mut rival) => {
                timings.time(Phase::Index, || rival.update_lists(&self.model, &self.arrays));
                timings.time(Phase::Forces, || rival.forces(&self.model, &mut self.arrays));
                let deep = std::mem::take(&mut rival.met.deep).into_iter();
                let deep = deep.map(|(disc, partner)| [disc as u32, partner as u32]).collect();
                let met = SweepReport {
                    pairs: rival.met.pairs,
                    dissipated: rival.met.dissipated,
                    deep,
                    ..SweepReport::default()
                };
                self.rival = Some(rival);
                met
            }
        };
        self.elapsed.timings = timings;
        Ok(met)
    }

    fn finish(&mut self) -> Result<(), PhysicsFailure> {
        if self.elapsed.is_beginning() {
            self.start_derivatives();
            self.elapsed.timings = Timings::default();
            return Ok(());
        }
        let mut timings = self.elapsed.timings;
        let counted = timings.time(Phase::Correct, || self.run(&[Part::Corrector]))?;
        self.elapsed.timings = timings;
        match counted[NOT_FINITE.0 as usize] {
            0 => Ok(()),
            lost => self.not_finite(lost).map_or(Ok(()), Err),
        }
    }

    fn elapsed(&self) -> &Elapsed {
        &self.elapsed
    }

    fn elapsed_mut(&mut self) -> &mut Elapsed {
        &mut self.elapsed
    }

    fn start(&self) -> &Particles {
        &self.start
    }

    fn move_plane_walls(&mut self, walls: &Arc<PlaneWalls>, motions: &[PrescribedMotion]) {
        self.model.walls = walls.clone();
        self.arrays.move_plane_walls(&self.model, motions);
    }

    fn wall_touches(&self) -> &[WallTouch] {
        &self.touches
    }

    fn lists(&self) -> Option<(usize, u64)> {
        self.rival.as_ref().map(|rival| (rival.candidates(), rival.rebuilds))
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
        let walls = walls_at(self.walls, self.elapsed.time()).velocity;
        unwrapped(&self.start, walls, (0..self.start.len()).map(of))
    }

    fn forces(&self) -> Vec<[f64; 3]> {
        let on = |array, disc: usize| match (self.arrays.lattice(array), self.arrays.force_at(disc)) {
            (Some(column), Some(at)) => column[at].to_f64(),
            _ => 0.0,
        };
        let forces = |disc| [Array::Fx, Array::Fy, Array::Torque].map(|array| on(array, disc));
        (0..self.start.len()).map(forces).collect()
    }

    fn columns(&self) -> Vec<(String, CheckpointColumn)> {
        self.saved()
    }

    fn restore(&mut self, steps: u64, columns: &[(String, CheckpointColumn)]) -> Result<(), String> {
        self.restore_columns(columns)?;
        self.elapsed.steps = steps;
        self.move_walls(self.elapsed.time());
        Ok(())
    }

    fn restart(&mut self, motion: &[([f64; 3], f64)]) -> Result<(), SteeringError> {
        let scale = scales(&self.model)[1];
        for (freedom, arrays) in STATE.iter().enumerate() {
            for (derivative, &array) in arrays.iter().enumerate().skip(1) {
                let Some(column) = self.arrays.state_mut(array) else { continue };
                for (to, ([u, v, _], omega)) in column.iter_mut().zip(&motion[..self.start.grain_count()]) {
                    let rate = if derivative == 1 { [u, v, omega][freedom] * scale } else { 0.0 };
                    *to = S::from_f64(rate);
                }
            }
        }
        self.elapsed.begun = self.elapsed.steps;
        Ok(())
    }

    fn set_gravity(&mut self, gravity: [f64; 2], followed: [bool; 2]) -> bool {
        self.model.gravity = gravity;
        self.programs = programs_of::<S, P>(&self.model);
        self.elapsed.crossings.follow(followed, self.start.len());
        true
    }

    fn ledger(&self) -> Ledger {
        match self.rival {
            None => ledger(&self.programs),
            Some(_) => neighbour_list_ledger_of::<S, P>(&self.model),
        }
    }

    fn length(&self, length: VectorLength) -> Option<u64> {
        if length == VectorLength::WallElements {
            return Some(self.arrays.lengths().range(length).len() as u64);
        }
        let rival = self.rival.as_ref()?;
        match length {
            VectorLength::Candidates => Some(rival.candidates() as u64),
            VectorLength::Pairs => Some(rival.met.pairs),
            _ => None,
        }
    }
}
