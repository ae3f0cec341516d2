//! Observation of the discs at the end of a step. The engine is not changed.
//!
//! ```text
//! corrected      records in double precision, in the order in memory     in parts of them, on all threads
//! grains         sums over the grains, in the scene's order              in parts of the scene, on all threads
//! contacts       a sweep of the search over the corrected positions      in bands, on all threads
//! ```
//!
//! Positions are relative to the current cells or lists: a correction may move a disc slightly beyond its cell, by far less than the margin of the
//! cells. No sum depends on the number of threads, the order in memory, or the history of the run.

use super::compiled::ObservationArguments;
use super::search::PairSearch;
use super::state::{AT_A_TIME, StepEndRow};
use super::{GravityWork, PairEngine};
use crate::observe::{ContactSums, GrainSums, SceneProperties};
use crate::particles::{Particle, ParticleKind, Particles, in_space};
use std::marker::PhantomData;
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::Inertia;
use stripmine_kernels::sweep::fast::{RecordEntry, StateRecords, SweepReport};
use stripmine_kernels::{in_pieces, over_parts, single_threaded_if};

/// All discs at the end of a step, in memory order.
pub(super) struct CorrectedDiscs {
    pub(super) records: StateRecords<f64>,
    /// Largest displacement by the correction (length).
    moved: f64,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> PairEngine<S, P, Q> {
    /// Computes the discs at the end of the step.
    pub(super) fn corrected_discs(&self) -> CorrectedDiscs {
        single_threaded_if(self.is_small(), || {
            let (system, state, discs) = (&self.system, &self.state, self.state.len());
            let vary = system.inertia == Inertia::Varying;
            let mut records = StateRecords::zeros(0, discs, [system.freedoms == 3, vary], 1.0);
            let moved = records.in_parts(|first, part| {
                // The sentinels are at rest.
                let corrected = first..(first + part.records()).min(discs);
                let mut moved = [0.0; 2];
                self.for_each_row(corrected, |disc, row| {
                    for (freedom, values) in row.iter().enumerate().take(system.freedoms) {
                        (0..2).for_each(|k| part.set(RecordEntry::of(freedom, k), disc - first, values[k]));
                    }
                    let place = state.place(disc);
                    (0..2).for_each(|axis| moved[axis] = (row[axis][0] - place[axis]).abs().max(moved[axis]));
                });
                moved
            });
            let along = |axis: usize| moved.iter().map(|part: &[f64; 2]| part[axis]).fold(0.0, f64::max);
            // The sentinels are farther apart than any pair acts.
            records.set(RecordEntry::X, discs, 4.0 * system.reach);
            if vary {
                let disc = |disc: usize| &self.start.all()[state.number(disc)];
                let inverse_mass =
                    |disc: &Particle| if disc.kind == ParticleKind::Grain { 1.0 / disc.mass } else { 0.0 };
                records.fill(RecordEntry::Radius, |at| {
                    if at < discs { disc(at).radius } else { 0.5 * system.reach }
                });
                records.fill(
                    RecordEntry::InverseMass,
                    |at| {
                        if at < discs { inverse_mass(disc(at)) } else { 1.0 }
                    },
                );
            }
            CorrectedDiscs { records, moved: (along(0).powi(2) + along(1).powi(2)).sqrt() }
        })
    }

    /// Returns the index in memory of each of the scene's discs.
    pub(super) fn indices_by_number(&self) -> Vec<u32> {
        let mut disc = vec![0; self.start.len()];
        self.state.numbers().iter().zip(0..).for_each(|(&number, at)| disc[number as usize] = at);
        disc
    }

    /// Computes the particles in the scene's order at the end of the step, on all threads.
    pub(super) fn step_end_particles(&self) -> Particles {
        let (grains, discs) = (self.start.grain_count(), self.indices_by_number());
        let walls = in_space(self.prescribed().unwrap_or_default().velocity);
        let turns = self.system.freedoms == 3;
        let mut particles = Particles::clone(&self.start);
        single_threaded_if(self.is_small(), || {
            in_pieces(particles.all_mut(), |first, piece| {
                let discs = &discs[first..first + piece.len()];
                let mut piece = (first..).zip(piece);
                self.for_each_row_of(discs, |disc, [[x, u], [y, v], [angle, omega]]| {
                    let Some((number, particle)) = piece.next() else { return };
                    particle.position = in_space(self.absolute_position(disc, [*x, *y]));
                    if number >= grains {
                        particle.velocity = walls;
                    } else {
                        particle.velocity = in_space([*u, *v]);
                        particle.omega = *omega;
                        if turns {
                            particle.angle = *angle;
                        }
                    }
                });
            });
        });
        particles
    }

    /// Computes positions alone, inside the box and in single precision, in the scene's order: first in memory order on all threads, then sorted.
    pub(super) fn step_end_positions(&self) -> Vec<[f32; 3]> {
        let mut standing = vec![[0.0; 2]; self.state.len()];
        single_threaded_if(self.is_small(), || {
            in_pieces(&mut standing, |first, piece| {
                let discs = first..first + piece.len();
                self.for_each_at_step_end(discs, |disc, place, _| {
                    piece[disc - first] = self.system.domain.wrapped(place).map(|x| x as f32);
                });
            });
        });
        let mut places = vec![[0.0; 3]; self.start.len()];
        for (&number, [x, y]) in self.state.numbers().iter().zip(standing) {
            places[number as usize] = [x, y, 0.0];
        }
        places
    }

    /// Returns the periods each disc has crossed along x and y since the start relative to its image inside the box, in the scene's order; empty if a
    /// periodic side is not counted.
    pub(super) fn step_end_images(&self) -> Vec<[i32; 2]> {
        let (domain, crossings) = (&self.system.domain, &self.elapsed.crossings);
        if !crossings.follows(domain) {
            return vec![];
        }
        let mut images = vec![[0; 2]; self.start.len()];
        self.for_each_at_step_end(0..self.state.len(), |disc, place, _| {
            let number = self.state.number(disc);
            images[number] = crossings.image(domain, number, place);
        });
        images
    }

    /// Passes each disc of a range in memory, its position (length) and velocity (length/time), without storing columns of them.
    pub(super) fn for_each_at_step_end(
        &self,
        discs: Range<usize>,
        mut to: impl FnMut(usize, [f64; 2], [f64; 2]),
    ) {
        self.for_each_row(discs, |disc, [[x, u], [y, v], _]| {
            to(disc, self.absolute_position(disc, [*x, *y]), [*u, *v]);
        });
    }

    /// Passes each disc of a range in memory and its row at the end of the step.
    fn for_each_row(&self, discs: Range<usize>, mut to: impl FnMut(usize, &StepEndRow)) {
        let mut numbers = [0; AT_A_TIME];
        for first in discs.clone().step_by(AT_A_TIME) {
            let count = AT_A_TIME.min(discs.end - first);
            numbers.iter_mut().zip(first as u32..).for_each(|(number, disc)| *number = disc);
            self.for_each_row_of(&numbers[..count], &mut to);
        }
    }

    /// Passes discs in memory and their rows at the end of the step.
    pub(super) fn for_each_row_of(&self, discs: &[u32], mut to: impl FnMut(usize, &StepEndRow)) {
        let mut rows = [StepEndRow::default(); AT_A_TIME];
        for discs in discs.chunks(AT_A_TIME) {
            self.correct(discs, &mut rows[..discs.len()]);
            discs.iter().zip(&rows).for_each(|(&disc, row)| to(disc as usize, row));
        }
    }

    /// Computes the sums over the grains.
    pub(super) fn grain_sums(
        &self,
        corrected: &CorrectedDiscs,
        scenery: &SceneProperties,
        work: &GravityWork<'_>,
    ) -> GrainSums {
        let discs = self.indices_by_number();
        single_threaded_if(self.is_small(), || {
            sums_of_grains(self.start.grains(), (scenery, work), |number| {
                self.step_end_disc(corrected, discs[number] as usize)
            })
        })
    }

    /// Returns a disc at the end of the step.
    pub(super) fn step_end_disc(&self, corrected: &CorrectedDiscs, disc: usize) -> StepEndDisc {
        let records = &corrected.records;
        let [position, velocity] =
            [0, 1].map(|k| [0, 1].map(|axis| records.get(RecordEntry::of(axis, k), disc)));
        let omega = if self.system.freedoms == 3 { records.get(RecordEntry::Omega, disc) } else { 0.0 };
        StepEndDisc { position: self.absolute_position(disc, position), velocity, omega }
    }

    /// Computes the sums over the contacts.
    pub(super) fn contact_sums(&self, corrected: &CorrectedDiscs) -> ContactSums {
        let met = self.contacts_met(corrected);
        contact_sums(&met)
    }

    /// Sweeps all pairs at the end of the step.
    pub(super) fn contacts_met(&self, corrected: &CorrectedDiscs) -> SweepReport {
        single_threaded_if(self.is_small(), || {
            let observing = ObservationArguments {
                search: &self.search,
                discs: &corrected.records,
                moved: corrected.moved,
                set: self.set,
                precisions: PhantomData,
            };
            let met = self.dynamics.observe(observing);
            // Unreachable error: this law and this instruction set have run in every step.
            met.unwrap_or_else(|_| SweepReport { energy: [f64::NAN; 2], ..SweepReport::default() })
        })
    }
}

/// Sums over the contacts of a sweep.
pub(super) fn contact_sums(met: &SweepReport) -> ContactSums {
    let &SweepReport { energy: [elastic, virial], contacts: count, deepest, .. } = met;
    ContactSums { count, elastic, virial, deepest }
}

/// Disc at the end of a step, its position consistent with the counted periods (length).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StepEndDisc {
    pub(super) position: [f64; 2],
    pub(super) velocity: [f64; 2],
    pub(super) omega: f64,
}

/// Sums over grains in the scene's order.
pub(super) fn sums_of_grains(
    grains: &[Particle],
    (scenery, work): (&SceneProperties, &GravityWork<'_>),
    standing: impl Fn(usize) -> StepEndDisc + Sync,
) -> GrainSums {
    let has_gravity = scenery.gravity != [0.0; 2];
    let parts = over_parts(0..grains.len(), |numbers| {
        let mut sums = GrainSums::default();
        for number in numbers {
            let (grain, standing) = (&grains[number], standing(number));
            let StepEndDisc { position, velocity, omega } = standing;
            sums.add(scenery, grain, velocity, omega, || scenery.domain.wrapped(position));
            if has_gravity {
                sums.gravity_work += work(number, grain, position);
            }
        }
        sums
    });
    let mut sums = GrainSums::default();
    parts.iter().for_each(|part| sums.join(part));
    sums
}
