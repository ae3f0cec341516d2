//! From one step to the next: the pass over the discs, and those that change cells.

use super::search::Search;
use super::state::{Move, State};
use super::{FastMd, walls_at};
use crate::domain::Domain;
use crate::method::Failure;
use crate::method::lattice_md::Engine;
use crate::method::lattice_md::{GearValues, Model, Scheme};
use crate::scene::WallMotion;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::gear::Gear;
use stripmine_kernels::integrator::velocity_verlet::VelocityVerlet;
use stripmine_kernels::integrator::{self};
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::sweep::fast::{Advance, Grid, Motion, Passed};

/// Does something with the motion of a model, whichever scheme that has.
macro_rules! with_motion {
    ($model:expr, |$motion:ident| $work:expr) => {
        match $model.scheme {
            Scheme::Gear(GearValues::Four) => {
                let $motion = motion($model, Gear::<4>::new($model.acceleration()));
                $work
            }
            Scheme::Gear(GearValues::Five) => {
                let $motion = motion($model, Gear::<5>::new($model.acceleration()));
                $work
            }
            Scheme::Gear(GearValues::Six) => {
                let $motion = motion($model, Gear::<6>::new($model.acceleration()));
                $work
            }
            Scheme::VelocityVerlet => {
                let $motion = motion($model, VelocityVerlet);
                $work
            }
        }
    };
}

fn motion<C: integrator::Scheme>(model: &Model, scheme: C) -> Motion<C> {
    let Model { dt, gravity, .. } = *model;
    // None of these schemes draws random numbers.
    Motion { scheme, dt, inertia: model.inertia(), gravity, seed: 0 }
}

/// One row at the end of the step, from the one that the pass left.
pub(super) fn corrected<S: Precision>(
    model: &Model,
    state: &State<S>,
    step: u64,
    freedom: usize,
    disc: usize,
    row: [S; 6],
    force: S,
) -> [S; 6] {
    let inverse = model.inertia().inverse(freedom, S::from_f64, || state.inverse(freedom)[disc]);
    let who = (step, state.numbers()[disc]);
    with_motion!(model, |motion| motion.corrected(who, freedom, row, force, inverse))
}

/// Corrects the last step, unless the first begins, and predicts the next; gives the discs that left their cells and those
/// that are too fast.
pub(super) fn advance<S: Precision, P: Precision, Q: Search<S, P>>(
    simulation: &mut FastMd<S, P, Q>,
    first: bool,
) -> Result<Passed, ProgramError> {
    let FastMd { model, state, sums, search, start, set, steps, .. } = simulation;
    let freedoms = model.freedoms();
    let (columns, inverse, ids) = state.for_advance();
    let state = columns.iter_mut().map(|row| row.iter_mut().map(Vec::as_mut_slice).collect()).collect();
    let sums = sums.iter_mut().take(freedoms).map(Vec::as_mut_slice).collect();
    let discs = start.grain_count();
    let (limit, copies) = search.displacement_limit();
    let longest_step = model.watch.map_or(f64::INFINITY, |watch| watch.longest_step());
    with_motion!(model, |motion| {
        let advance = Advance {
            motion: &motion,
            state,
            sums,
            inverse,
            discs,
            step: *steps,
            ids,
            corrected: first,
            longest_step,
        };
        advance.run(limit, copies, *set)
    })
}

impl<S: Precision, P: Precision, Q: Search<S, P>> FastMd<S, P, Q> {
    /// The cell of a disc at a position (length), and its place there.
    pub(super) fn locate(&self, disc: usize, position: [f64; 2]) -> Result<Move, Failure> {
        let frame = self.search.grid().frame;
        let place = [0, 1].map(|axis| position[axis] - (frame.origin[axis] + 0.5 * frame.edge[axis]));
        let from = Move { disc, cell: [0, 0], place, periods: [0.0; 2] };
        self.settled(from).ok_or_else(|| self.stray(from, 1))
    }

    /// The cell and place of a disc at a place that may be outside the cell it is seen from; none if it belongs to no
    /// cell.
    fn settled(&self, from: Move) -> Option<Move> {
        let Move { cell, place, .. } = from;
        let Grid { frame, counts, periodic } = self.search.grid();
        let mut to = from;
        for axis in 0..2 {
            let (edge, count) = (frame.edge[axis], counts[axis] as f64);
            if place[axis].abs() < 0.5 * edge {
                continue;
            }
            let steps = (place[axis] / edge + 0.5).floor();
            let mut there = cell[axis] as f64 + steps;
            to.place[axis] = place[axis] - steps * edge;
            if periodic[axis] && (-count..2.0 * count).contains(&there) {
                to.periods[axis] = (there / count).floor();
                there = there.rem_euclid(count);
            } else if there == count && to.place[axis] <= -0.5 * edge {
                // On the far side: that is the last cell's.
                there -= 1.0;
                to.place[axis] += edge;
            }
            if !(0.0..count).contains(&there) {
                return None;
            }
            to.cell[axis] = there as usize;
        }
        Some(to)
    }

    /// Brings the cells up to date after a pass: walls, the discs beyond their limit, the halo, the lists.
    pub(super) fn keep_index(&mut self, left: &[u32]) -> Result<(), Failure> {
        let grains = self.start.grain_count();
        let mut walls = Vec::new();
        if self.walls != WallMotion::Fixed {
            let (displacement, velocity) = walls_at(self.walls, self.time());
            self.state.turn_walls(velocity, self.model.dt);
            for disc in grains..self.start.len() {
                let at = self.start.all()[self.state.number(disc)].position;
                walls.push(self.locate(disc, [at[0] + displacement[0], at[1] + displacement[1]])?);
            }
        }
        if self.search.lists().is_some() {
            return self.keep_lists(left, &walls);
        }
        let mut moves = self.settle_all(left.iter().map(|&disc| disc as usize))?;
        self.changes += moves.len();
        moves.extend(walls);
        self.rehouse(&moves)?;
        self.refuse_beyond_box()
    }

    /// Discs in the cells that their places lie in.
    fn settle_all(&self, discs: impl Iterator<Item = usize>) -> Result<Vec<Move>, Failure> {
        let (mut moves, mut strays) = (Vec::new(), Vec::new());
        for disc in discs {
            let cell = self.search.cell(disc).unwrap_or_default();
            let from = Move { disc, cell, place: self.state.place(disc), periods: [0.0; 2] };
            match self.settled(from) {
                Some(to) => moves.push(to),
                None => strays.push(from),
            }
        }
        match strays.iter().min_by_key(|from| self.state.number(from.disc)) {
            Some(&first) => Err(self.stray(first, strays.len() as u64)),
            None => Ok(moves),
        }
    }

    /// Moves walls within the cells in which they are listed, and makes the lists anew if a disc has gone too far.
    fn keep_lists(&mut self, left: &[u32], walls: &[Move]) -> Result<(), Failure> {
        let edge = self.search.grid().frame.edge;
        let domain = self.model.domain();
        let mut stale = !left.is_empty();
        for to in walls {
            let (from, cell) = (self.search.cell(to.disc).unwrap_or_default(), to.cell);
            let centre = |cell: [usize; 2]| [0, 1].map(|axis| cell[axis] as f64 * edge[axis]);
            let way = domain.way(centre(from), centre(cell));
            let place = [0, 1].map(|axis| to.place[axis] + way[axis]);
            self.state.put(to.disc, place);
            stale |= self.search.lists().is_some_and(|lists| lists.has_strayed(to.disc, place));
        }
        let outside = |&&disc: &&u32| self.is_outside(disc as usize);
        if let Some(&first) =
            self.rim.iter().filter(outside).min_by_key(|&&disc| self.state.number(disc as usize))
        {
            let count = self.rim.iter().filter(outside).count() as u64;
            let cell = self.search.cell(first as usize).unwrap_or_default();
            let place = self.state.place(first as usize);
            return Err(self.stray(Move { disc: first as usize, cell, place, periods: [0.0; 2] }, count));
        }
        if stale {
            let moves = self.settle_all(0..self.start.len())?;
            self.rehouse(&moves)?;
            self.put_in_order();
        }
        Ok(())
    }

    /// The discs that may leave through an open side before lists are made anew.
    pub(super) fn discs_at_the_rim(&self) -> Vec<u32> {
        let Domain { origin, sides, periodic } = self.model.domain();
        let Some(lists) = self.search.lists().filter(|_| periodic != [true; 2]) else { return vec![] };
        // A little more than the lists last: rounding must hide no disc.
        let reach = 0.5 * lists.skin() * (1.0 + 1e-6);
        let near = |disc: usize| {
            let position = self.position(disc, self.state.place(disc));
            (0..2).filter(|&axis| !periodic[axis]).any(|axis| {
                let along = position[axis] - origin[axis];
                !(reach..=sides[axis] - reach).contains(&along)
            })
        };
        (0..self.start.len()).filter(|&disc| near(disc)).map(|disc| disc as u32).collect()
    }

    /// Whether a disc is beyond an open side.
    fn is_outside(&self, disc: usize) -> bool {
        let cell = self.search.cell(disc).unwrap_or_default();
        let from = Move { disc, cell, place: self.state.place(disc), periods: [0.0; 2] };
        self.settled(from).is_none()
    }

    /// Moves discs into their new cells; if two want one that must be one disc's, none is moved.
    pub(super) fn rehouse(&mut self, moves: &[Move]) -> Result<(), Failure> {
        if self.search.is_exclusive() {
            self.refuse_conflicts(moves)?;
        }
        moves.iter().for_each(|to| self.search.leave(to.disc));
        for to in moves {
            if to.disc < self.start.grain_count() {
                self.crossings.add(self.state.number(to.disc), to.periods);
            }
            self.state.put(to.disc, to.place);
            let entered = self.search.enter(to, &self.state);
            debug_assert!(entered.is_ok(), "looked for above");
        }
        self.search.arrange(&self.state);
        Ok(())
    }

    /// Finds two discs that want one cell.
    fn refuse_conflicts(&self, moves: &[Move]) -> Result<(), Failure> {
        let mut targets: Vec<([usize; 2], usize)> = moves.iter().map(|to| (to.cell, to.disc)).collect();
        targets.sort_unstable();
        let mut moving: Vec<usize> = moves.iter().map(|to| to.disc).collect();
        moving.sort_unstable();
        let twice = targets.windows(2).find(|pair| pair[0].0 == pair[1].0).map(|pair| (pair[0].1, pair[1].1));
        let taken = || {
            targets.iter().find_map(|&(cell, disc)| {
                let there = self.search.owner(cell)?;
                moving.binary_search(&there).is_err().then_some((there, disc))
            })
        };
        if let Some((first, second)) = twice.or_else(taken) {
            let of = |disc: usize| moves.iter().find(|to| to.disc == disc);
            return Err(self.conflict([(first, of(first)), (second, of(second))]));
        }
        Ok(())
    }
}
