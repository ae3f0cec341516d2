//! Loops compiled for each law and each scheme of a method. The engine calls them through one trait, so that the rest of it is compiled only once for
//! each precision and search.

use super::search::PairSearch;
use super::search::SearchCells;
use super::state::{AT_A_TIME, MovingDiscs, StepEndRow};
use super::{
    CarriedQuery, CarriedState, Dynamics, LawTask, PairSystem, PlaneWalls, PrescribedMotion, SchemeTask,
    WallGrid, WallTouch, touching_disc,
};
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::{Draws, Inertia, Scheme};
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::{Law, ObservationRequest};
use stripmine_kernels::over_pieces;
use stripmine_kernels::sweep::fast::{
    Advance, EquationOfMotion, ForceRecords, PassReport, StateRecords, SweepReport,
};
use stripmine_kernels::sweep::walls::touch;

/// [`Dynamics`] of any method, for an engine with state of precision `S`, forces of precision `P` and search `Q`.
pub(super) trait CompiledDynamics<S, P, Q>: Send + Sync {
    /// Returns the form in which the scheme carries the state, for steps of `dt` (time).
    fn carried(&self, dt: f64) -> CarriedState;

    /// As [`Dynamics::prescribed`].
    fn prescribed(&self, time: f64) -> Option<PrescribedMotion>;

    /// Advances some discs by one step.
    fn pass(&self, pass: PassArguments<'_, S, P, Q>) -> Result<PassReport, ProgramError>;

    /// Corrects some discs.
    fn correct(&self, discs: CorrectionArguments<'_, S, P>);

    /// Adds up the forces of all pairs.
    fn sweep(&self, sweep: SweepArguments<'_, S, P, Q>) -> Result<SweepReport, ProgramError>;

    /// As [`Dynamics::walls`].
    fn walls(&self) -> Option<&Arc<PlaneWalls>>;

    /// Finds the contacts with plane walls.
    fn touch_walls(&self, touching: WallArguments<'_, S, P, Q>) -> Vec<WallTouch>;

    /// Observes all pairs.
    fn observe(&self, sweep: ObservationArguments<'_, S, P, Q>) -> Result<SweepReport, ProgramError>;
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>, D: Dynamics> CompiledDynamics<S, P, Q> for D {
    fn carried(&self, dt: f64) -> CarriedState {
        self.with_scheme(CarriedQuery { dt })
    }

    fn prescribed(&self, time: f64) -> Option<PrescribedMotion> {
        Dynamics::prescribed(self, time)
    }

    fn pass(&self, pass: PassArguments<'_, S, P, Q>) -> Result<PassReport, ProgramError> {
        self.with_scheme(pass)
    }

    fn correct(&self, discs: CorrectionArguments<'_, S, P>) {
        self.with_scheme(discs);
    }

    fn sweep(&self, sweep: SweepArguments<'_, S, P, Q>) -> Result<SweepReport, ProgramError> {
        self.with_law(sweep)
    }

    fn walls(&self) -> Option<&Arc<PlaneWalls>> {
        Dynamics::walls(self)
    }

    fn touch_walls(&self, touching: WallArguments<'_, S, P, Q>) -> Vec<WallTouch> {
        self.with_wall_law(touching).unwrap_or_default()
    }

    fn observe(&self, sweep: ObservationArguments<'_, S, P, Q>) -> Result<SweepReport, ProgramError> {
        self.with_law(sweep)
    }
}

/// Motion of discs in a scheme.
fn motion<C: Scheme>(system: &PairSystem, scheme: C) -> EquationOfMotion<C> {
    let PairSystem { dt, inertia, gravity, noise, .. } = *system;
    EquationOfMotion { scheme, dt, inertia, gravity, noise }
}

/// Arguments of a pass over some discs.
pub(super) struct PassArguments<'a, S, P, Q> {
    pub(super) discs: Range<usize>,
    pub(super) system: &'a PairSystem,
    pub(super) state: &'a mut MovingDiscs<S>,
    pub(super) sums: &'a mut ForceRecords<P>,
    pub(super) search: &'a mut Q,
    pub(super) steps: u64,
    /// True in the first step: the state is not predicted.
    pub(super) is_beginning: bool,
    pub(super) set: InstructionSet,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> SchemeTask for PassArguments<'_, S, P, Q> {
    type Output = Result<PassReport, ProgramError>;

    fn with<C: Scheme>(self, scheme: C) -> Self::Output {
        let PassArguments { discs, system, state, sums, search, steps, is_beginning, set } = self;
        let (records, higher, inverse_inertia, ids) = state.for_advance();
        let (limit, copies) = search.displacement_limit();
        let advance = Advance {
            motion: &motion(system, scheme),
            freedoms: system.freedoms,
            records,
            higher: higher
                .iter_mut()
                .map(|row| row.iter_mut().map(|column| &mut **column).collect())
                .collect(),
            sums,
            inverse_inertia,
            discs,
            step: steps,
            ids,
            corrected: is_beginning,
            longest_step: system.longest_step,
        };
        advance.run(limit, copies, set)
    }
}

/// Arguments of the correction of some discs at the end of the step, from the rows left by the pass.
pub(super) struct CorrectionArguments<'a, S, P> {
    pub(super) system: &'a PairSystem,
    pub(super) state: &'a MovingDiscs<S>,
    pub(super) sums: &'a ForceRecords<P>,
    pub(super) steps: u64,
    /// Number of discs that the pass has moved; the others stand as they are.
    pub(super) moving: usize,
    pub(super) discs: &'a [u32],
    pub(super) to: &'a mut [StepEndRow],
}

impl<S: Precision, P: Precision> SchemeTask for CorrectionArguments<'_, S, P> {
    type Output = ();

    fn with<C: Scheme>(self, scheme: C) {
        let CorrectionArguments { system, state, sums, steps, moving, discs, to } = self;
        let motion = motion(system, scheme);
        for (discs, to) in discs.chunks(AT_A_TIME).zip(to.chunks_mut(AT_A_TIME)) {
            let mut normals = [[S::from_f64(f64::NAN); AT_A_TIME]; 2];
            if C::DRAWS == Draws::InCorrector {
                let mut ids = [0; AT_A_TIME];
                ids.iter_mut().zip(discs).for_each(|(id, &disc)| *id = state.id(disc as usize));
                motion.draw(steps, &ids[..discs.len()], normals.each_mut().map(|to| &mut to[..discs.len()]));
            }
            for (at, (&disc, to)) in discs.iter().zip(to).enumerate() {
                let disc = disc as usize;
                let forces = sums.of(disc);
                for (freedom, to) in to.iter_mut().enumerate().take(system.freedoms) {
                    let mut row = state.row(freedom, disc);
                    if disc < moving {
                        let force = S::from_f64(forces[freedom].to_f64());
                        let inverse =
                            system.inertia.inverse(freedom, S::from_f64, || state.inverse(freedom, disc));
                        let normal = normals[freedom.min(1)][at];
                        row = motion.corrected(freedom, row, force, inverse, normal);
                    }
                    *to = state.value_and_rate(&row);
                }
            }
        }
    }
}

/// Arguments of a force sweep.
pub(super) struct SweepArguments<'a, S, P, Q> {
    pub(super) state: &'a MovingDiscs<S>,
    pub(super) sums: &'a mut ForceRecords<P>,
    pub(super) search: &'a mut Q,
    pub(super) asked: ObservationRequest,
    pub(super) set: InstructionSet,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> LawTask for SweepArguments<'_, S, P, Q> {
    type Output = Result<SweepReport, ProgramError>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        self.search.sweep(&law, &self.state.records, self.sums, self.asked, self.set)
    }
}

/// Arguments of the search for contacts with plane walls.
pub(super) struct WallArguments<'a, S, P, Q> {
    pub(super) state: &'a MovingDiscs<S>,
    pub(super) inertia: Inertia,
    pub(super) search: &'a Q,
    pub(super) walls: &'a WallGrid<P>,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> LawTask for WallArguments<'_, S, P, Q> {
    type Output = Vec<WallTouch>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Vec<WallTouch> {
        let WallArguments { state, inertia, search, walls } = self;
        let cells = search.cells();
        let touches = |discs: Range<usize>| {
            let mut found = vec![];
            for disc in discs {
                let elements = cells.cell(disc).map_or(&[][..], |cell| walls.in_cell(cell));
                if elements.is_empty() {
                    continue;
                }
                let inverse = inertia.inverse(0, |number| number, || state.inverse(0, disc).to_f64());
                let radius = state.radius(disc);
                let [vx, vy, omega] = state.rates(disc);
                let touching = touching_disc(state.place(disc), [vx, vy], omega, [radius, inverse]);
                for element in elements {
                    if let Some(contact) = touch(&law, &touching, &element.numbers) {
                        found.push(WallTouch::new(disc, element.wall, radius, &contact));
                    }
                }
            }
            found
        };
        over_pieces(0..state.moving(), touches).concat()
    }
}

/// Arguments of an observing sweep.
pub(super) struct ObservationArguments<'a, S, P, Q> {
    pub(super) search: &'a Q,
    pub(super) discs: &'a StateRecords<f64>,
    pub(super) moved: f64,
    pub(super) set: InstructionSet,
    pub(super) precisions: PhantomData<(S, P)>,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> LawTask for ObservationArguments<'_, S, P, Q> {
    type Output = Result<SweepReport, ProgramError>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        self.search.observe(&law, self.discs, self.moved, self.set)
    }
}
