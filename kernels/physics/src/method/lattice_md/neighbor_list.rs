//! Scalar neighbour lists on the lattice method's state: the alternative in BP93.

use super::options::ProgramVersion;
use super::programs::with_program_law;
use super::{DiscUniformity, GranularModel, ProgramArrays};
use crate::domain::Domain;
use crate::method::pairwise::LawTask;
use crate::near::NeighbourSearch;
use crate::words::define_words;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Array;
use stripmine_kernels::law::Law;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::sweep::neighbor_list::{self, CellOffsets, ListReport, NeighbourLists, sweep_lists};

define_words! {
    /// Construction of neighbour lists.
    pub enum Rebuild {
        /// By searching the cells around each disc.
        Cells = "cells",
        /// By trying every pair, as in BP93.
        AllPairs = "all-pairs",
    }
}

/// Options of the neighbour lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListOptions {
    /// Construction of the lists.
    pub rebuild: Rebuild,
    /// Largest gap of a listed pair (length).
    pub skin: f64,
}

/// Neighbour lists and the positions at which they were built.
#[derive(Clone, Debug)]
pub(super) struct ScalarLists<P> {
    options: ListOptions,
    cell_offsets: CellOffsets,
    lists: NeighbourLists,
    /// Positions when the lists were built.
    made_at: Vec<[f64; 2]>,
    /// Largest sum of radii.
    reach: f64,
    radius: Vec<P>,
    pub(super) rebuilds: u64,
    pub(super) met: ListReport,
}

impl<P: Precision> ScalarLists<P> {
    pub(super) fn new(model: &GranularModel, options: ListOptions, largest_radius: f64) -> Self {
        let relative = model.coordinates == Coordinates::CellRelative;
        ScalarLists {
            options,
            cell_offsets: CellOffsets::new(model.shape, model.frame, &model.mask, relative),
            lists: NeighbourLists::default(),
            made_at: vec![],
            reach: 2.0 * largest_radius,
            radius: vec![],
            rebuilds: 0,
            met: ListReport::default(),
        }
    }

    /// Number of candidates that a step checks.
    pub(super) fn candidates(&self) -> usize {
        self.lists.entries()
    }

    /// Coordinates of the discs when the lists were built (length), along each axis.
    pub(super) fn made_at(&self) -> [Vec<f64>; 2] {
        [0, 1].map(|axis| self.made_at.iter().map(|position| position[axis]).collect())
    }

    /// Restores lists that were built with the discs at `made_at`, after `rebuilds` builds, and visited `pairs` pairs in the last step.
    pub(super) fn restore_lists(
        &mut self,
        model: &GranularModel,
        made_at: [Vec<f64>; 2],
        rebuilds: u64,
        pairs: u64,
    ) {
        let [x, y] = made_at;
        self.make(model, x.into_iter().zip(y).map(|(x, y)| [x, y]).collect());
        self.rebuilds = rebuilds;
        self.met.pairs = pairs;
    }

    /// Rebuilds the lists if a pair that is not listed could have come into contact.
    pub(super) fn update_lists<S: Precision>(&mut self, model: &GranularModel, arrays: &ProgramArrays<S, P>) {
        let (Some(x), Some(y)) = (arrays.state(Array::X0), arrays.state(Array::Y0)) else { return };
        let moved_too_far = 0.25 * self.options.skin * self.options.skin;
        let domain = model.domain();
        let anchored = model.is_anchored::<S>();
        let at = |i: usize| match anchored {
            true => model.position(arrays.cell()[i], [x[i].to_f64(), y[i].to_f64()]),
            false => [x[i].to_f64(), y[i].to_f64()],
        };
        let discs = x.len();
        let fresh = self.made_at.len() == discs
            && (0..discs).all(|i| square(&domain, at(i), self.made_at[i]) < moved_too_far);
        if !fresh {
            self.make(model, (0..discs).map(at).collect());
        }
    }

    /// Builds the lists for discs at these positions (length).
    fn make(&mut self, model: &GranularModel, made_at: Vec<[f64; 2]>) {
        let domain = model.domain();
        let discs = made_at.len();
        let limit = self.reach + self.options.skin;
        // Free the old lists first: they are as large as the new ones.
        self.lists = NeighbourLists::default();
        let near = |i: usize, j: usize| square(&domain, made_at[i], made_at[j]) < limit * limit;
        self.lists = match self.options.rebuild {
            Rebuild::AllPairs => NeighbourLists::by_all_pairs(discs, near),
            Rebuild::Cells => {
                let wrapped = |position: &[f64; 2]| domain.wrapped(*position);
                let cells = NeighbourSearch::over_positions(domain, made_at.iter().map(wrapped), limit);
                let around = |i: usize, take: &mut dyn FnMut(u32)| {
                    cells.candidates_near(wrapped(&made_at[i])).for_each(|(number, _)| take(number));
                };
                NeighbourLists::by_candidates(discs, around, near)
            }
        };
        self.made_at = made_at;
        self.rebuilds += 1;
    }

    /// Computes the forces of all grains and stores them where the corrector reads them.
    pub(super) fn forces<S: Precision>(&mut self, model: &GranularModel, arrays: &mut ProgramArrays<S, P>) {
        if self.radius.is_empty()
            && let Some(radius) = arrays.constant(Array::DiscRadius)
        {
            self.radius = radius.to_vec();
        }
        let mut sums = [vec![], vec![], vec![]];
        for sum in &mut sums {
            sum.resize(arrays.lengths().grains, P::from_f64(0.0));
        }
        self.met = with_program_law(model, ListTraversal { rival: self, model, arrays, sums: &mut sums });
        for (array, sum) in [Array::Fx, Array::Fy, Array::Torque].into_iter().zip(sums) {
            if let Some(column) = arrays.lattice_mut(array) {
                column[..sum.len()].copy_from_slice(&sum);
            }
        }
    }
}

/// Squared distance of two positions (length²).
fn square(domain: &Domain, from: [f64; 2], to: [f64; 2]) -> f64 {
    let [dx, dy] = domain.displacement(from, to);
    dx * dx + dy * dy
}

/// Traversal of the lists with the law of the model.
struct ListTraversal<'a, S, P> {
    rival: &'a ScalarLists<P>,
    model: &'a GranularModel,
    arrays: &'a ProgramArrays<S, P>,
    sums: &'a mut [Vec<P>; 3],
}

impl<S: Precision, P: Precision> LawTask for ListTraversal<'_, S, P> {
    type Output = ListReport;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> ListReport {
        let constant = |array| self.arrays.constant(array).unwrap_or(&[]);
        // In the printed programs, positions and velocities are the state itself.
        let of_state = |array| -> Vec<P> {
            let column = self.arrays.state(array).unwrap_or(&[]).iter();
            column.map(|value| P::from_f64(value.to_f64())).collect()
        };
        let state = match self.model.text {
            ProgramVersion::Ours => [const { vec![] }; 5],
            ProgramVersion::Printed => {
                [Array::X0, Array::Y0, Array::X1, Array::Y1, Array::Phi1].map(of_state)
            }
        };
        let of_text = |array, number: usize| match self.model.text {
            ProgramVersion::Ours => self.arrays.lattice(array).unwrap_or(&[]),
            ProgramVersion::Printed => state[number].as_slice(),
        };
        let discs = neighbor_list::ListDiscs {
            position: [of_text(Array::DiscX, 0), of_text(Array::DiscY, 1)],
            velocity: [of_text(Array::DiscVx, 2), of_text(Array::DiscVy, 3)],
            omega: of_text(Array::DiscOmega, 4),
            radius: constant(Array::DiscRadius),
            inverse_mass: constant(Array::DiscInverseMass),
            mass: constant(Array::DiscMass),
            cell: self.arrays.cell(),
        };
        debug_assert!(self.model.discs != DiscUniformity::Varying || discs.radius.len() == discs.cell.len());
        let asked = self.model.asked();
        // Contact distance plus a rounding error, so that the law decides on every contact.
        let reach = self.rival.reach * (1.0 + 1e-6);
        let grains = self.arrays.lengths().grains;
        let ScalarLists { lists, cell_offsets, .. } = self.rival;
        sweep_lists(&law, lists, cell_offsets, discs, grains, reach, asked, |disc, sums| {
            self.sums.iter_mut().zip(sums).for_each(|(column, sum)| column[disc] = sum);
        })
    }
}
