//! Scalar neighbour lists, the alternative to the lattice: partners are visited one by one.
//!
//! Offsets are those of the same lattice, so a pair has the same image and the same displacement to the bit. Contacts are summed
//! in the mask's order, so the sums are those of the full lattice sweep. Two discs may share a cell, which the lattice forbids:
//! such partners come last, in the order of their numbers.

use crate::backend::Precision;
use crate::law::{Env, Law, LawTable, ObservationRequest, ParticleField, ParticleSum, StatedEnv};
use crate::mask::Mask;
use crate::sweep::lattice::{LatticeFrame, LatticeShape};
use std::cell::Cell;

/// Neighbour list of each disc; each pair is in both lists.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NeighbourLists {
    first: Vec<u32>,
    partners: Vec<u32>,
}

impl NeighbourLists {
    /// Lists all pairs for which `near` is true, by trying every pair: O(N²), as in BP93.
    #[inline]
    pub fn by_all_pairs(discs: usize, near: impl Fn(usize, usize) -> bool) -> NeighbourLists {
        NeighbourLists::collect(discs, |i, list| {
            list.extend((0..discs).filter(|&j| j != i && near(i, j)).map(|j| j as u32))
        })
    }

    /// Lists the pairs for which `near` is true among the candidates of each disc.
    #[inline]
    pub fn by_candidates(
        discs: usize,
        candidates: impl Fn(usize, &mut dyn FnMut(u32)),
        near: impl Fn(usize, usize) -> bool,
    ) -> NeighbourLists {
        NeighbourLists::collect(discs, |i, list| {
            candidates(i, &mut |j| {
                if j as usize != i && near(i, j as usize) {
                    list.push(j);
                }
            });
        })
    }

    #[inline]
    fn collect(discs: usize, mut fill: impl FnMut(usize, &mut Vec<u32>)) -> NeighbourLists {
        let mut lists = NeighbourLists { first: vec![0], partners: Vec::new() };
        for i in 0..discs {
            fill(i, &mut lists.partners);
            lists.first.push(lists.partners.len() as u32);
        }
        lists
    }

    /// Discs near disc `i`.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        &self.partners[self.first[i] as usize..self.first[i + 1] as usize]
    }

    /// Entries of all lists: the candidates tried in a step.
    #[inline]
    pub fn entries(&self) -> usize {
        self.partners.len()
    }
}

/// Quantities of the discs, one entry per disc; quantities that the law does not read may be empty.
#[derive(Clone, Copy)]
pub struct ListDiscs<'a, P> {
    /// Positions, absolute or relative to the cell.
    pub position: [&'a [P]; 2],
    /// Velocities.
    pub velocity: [&'a [P]; 2],
    /// Angular velocities.
    pub omega: &'a [P],
    /// Radii.
    pub radius: &'a [P],
    /// Inverse masses.
    pub inverse_mass: &'a [P],
    /// Masses.
    pub mass: &'a [P],
    /// Cells, numbered from 1 in the padded lattice.
    pub cell: &'a [u32],
}

/// Result of a walk through the lists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ListReport {
    /// Pairs the law was evaluated for, each from both sides.
    pub pairs: u64,
    /// Contacts deeper than the watched depth: disc and partner, each from both sides.
    pub deep: Vec<(usize, usize)>,
    /// Power dissipated by the contacts (energy/time), if requested.
    pub dissipated: f64,
    /// Energy and virial of the contacts (energy), if requested.
    pub energy: [f64; 2],
}

/// Offsets between the cells of a lattice.
#[derive(Clone, Debug)]
pub struct CellOffsets {
    shape: LatticeShape,
    half_width: isize,
    /// Number of each mask offset, by row and column from the lower left corner; the own cell has the last number.
    offset_number: Vec<Option<u16>>,
    edge: [f64; 2],
    relative: bool,
}

impl CellOffsets {
    /// Table for a full mask on a lattice; `relative` is true for positions relative to the cell.
    #[inline]
    pub fn new(shape: LatticeShape, frame: LatticeFrame, mask: &Mask, relative: bool) -> CellOffsets {
        let half_width = mask.half_width() as isize;
        let side = 2 * half_width + 1;
        let mut offset_number = vec![None; (side * side) as usize];
        for (number, offset) in mask.offsets().iter().enumerate() {
            let at = (offset.rows as isize + half_width) * side + offset.columns as isize + half_width;
            offset_number[at as usize] = Some(number as u16);
        }
        offset_number[(half_width * side + half_width) as usize] = Some(mask.offsets().len() as u16);
        CellOffsets { shape, half_width, offset_number, edge: frame.edge, relative }
    }

    /// Column and row of a cell numbered from 1 in the padded lattice.
    #[inline]
    fn column_and_row(&self, cell: u32) -> [isize; 2] {
        self.shape.column_and_row(cell as usize - 1)
    }

    /// Number of the mask offset from `own` to `there`, with the vector between their centres and the periods crossed.
    fn offset_between(&self, own: [isize; 2], there: [isize; 2]) -> Option<(u16, [f64; 2], [f64; 2])> {
        let mut offset = [0; 2];
        let mut periods = [0.0; 2];
        for axis in 0..2 {
            let cells = [self.shape.columns(), self.shape.rows()][axis] as isize;
            offset[axis] = there[axis] - own[axis];
            if self.shape.periodic()[axis] && offset[axis].abs() > self.half_width {
                let crossed = if offset[axis] > 0 { -1 } else { 1 };
                offset[axis] += crossed * cells;
                periods[axis] = crossed as f64 * (cells as f64 * self.edge[axis]);
            }
            if offset[axis].abs() > self.half_width {
                return None;
            }
        }
        let side = 2 * self.half_width + 1;
        let at = (offset[1] + self.half_width) * side + offset[0] + self.half_width;
        let number = self.offset_number[at as usize]?;
        Some((number, [offset[0] as f64 * self.edge[0], offset[1] as f64 * self.edge[1]], periods))
    }
}

/// A partner at its offset.
#[derive(Clone, Copy)]
struct ListPartner<P> {
    disc: usize,
    offset_number: u16,
    displacement: [P; 2],
}

/// Environment of a law that evaluates one disc and one partner at a time.
struct ListEnv<'a, P> {
    discs: ListDiscs<'a, P>,
    own: usize,
    watches: bool,
    penetration: Cell<P>,
    dissipation: bool,
    power: Cell<P>,
    observes_energy: bool,
    energy: [Cell<P>; 2],
    sums: [Cell<P>; ParticleSum::PLANAR.len()],
}

impl<'a, P: Precision> ListEnv<'a, P> {
    #[inline]
    fn field(&self, field: ParticleField, disc: usize) -> P {
        let ListDiscs { velocity, omega, radius, inverse_mass, mass, .. } = self.discs;
        match field {
            ParticleField::Velocity(axis) => velocity[axis as usize][disc],
            ParticleField::Omega => omega[disc],
            ParticleField::Radius => radius[disc],
            ParticleField::InverseMass => inverse_mass[disc],
            ParticleField::Mass => mass[disc],
            ParticleField::Occupied => P::from_f64(1.0),
        }
    }
}

impl<P: Precision> Env<2> for &ListEnv<'_, P> {
    type V = P;
    type Partner = ListPartner<P>;
    const BOTH_PARTNERS: bool = false;

    #[inline]
    fn own_position(self) -> [P; 2] {
        self.discs.position.map(|axis| axis[self.own])
    }
    #[inline]
    fn own(self, field: ParticleField) -> P {
        self.field(field, self.own)
    }
    #[inline]
    fn displacement(self, _: [P; 2], partner: ListPartner<P>) -> [P; 2] {
        partner.displacement
    }
    #[inline]
    fn partner(self, field: ParticleField, partner: ListPartner<P>) -> P {
        self.field(field, partner.disc)
    }
    #[inline]
    fn uniform(self, value: f64) -> P {
        P::from_f64(value)
    }
    #[inline]
    fn lookup<const N: usize>(self, table: &LawTable, columns: [usize; N], number: P) -> [P; N] {
        table.numbers(columns, number.to_f64()).map(P::from_f64)
    }
    #[inline]
    fn none(self, predicate: bool) -> bool {
        !predicate
    }
    #[inline]
    fn own_add(self, sum: ParticleSum, value: P) {
        let cell = &self.sums[sum.column::<2>()];
        cell.set(cell.get() + value);
    }
    #[expect(clippy::unreachable, reason = "called only if `Env::BOTH_PARTNERS`")]
    #[inline]
    fn partner_sub(self, _: ParticleSum, _: ListPartner<P>, _: P) {
        unreachable!("every pair is visited from both sides")
    }
    #[inline]
    fn watches(self) -> bool {
        self.watches
    }
    #[inline]
    fn watch(self, penetration: P) {
        self.penetration.set(penetration);
    }
    #[inline]
    fn counts_dissipation(self) -> bool {
        self.dissipation
    }
    #[inline]
    fn dissipate(self, power: P) {
        self.power.set(self.power.get() + power);
    }
    #[inline]
    fn observes_energy(self) -> bool {
        self.observes_energy
    }
    #[inline]
    fn energy(self, energy: P) {
        self.energy[0].set(self.energy[0].get() + energy);
    }
    #[inline]
    fn virial(self, virial: P) {
        self.energy[1].set(self.energy[1].get() + virial);
    }
    #[inline]
    fn section(self, _: &'static str) {}
}

/// Evaluates a law along the lists. `write(disc, sums)` receives the sums (force along x, y, torque) of each of the first
/// `grains` discs. Pairs farther apart than `reach` (length) are skipped. `asked` selects the observations beside the sums.
pub fn sweep_lists<P: Precision, L: Law<2>>(
    law: &L,
    lists: &NeighbourLists,
    cell_offsets: &CellOffsets,
    discs: ListDiscs<'_, P>,
    grains: usize,
    reach: f64,
    asked: ObservationRequest,
    mut write: impl FnMut(usize, [P; 3]),
) -> ListReport {
    let zero = P::from_f64(0.0);
    let square = P::from_f64(reach * reach);
    let columns_and_rows: Vec<[isize; 2]> =
        discs.cell.iter().map(|&cell| cell_offsets.column_and_row(cell)).collect();
    let mut met = ListReport::default();
    let mut contacts: Vec<ListPartner<P>> = Vec::new();
    let mut env = ListEnv {
        discs,
        own: 0,
        watches: asked.watched.is_some(),
        penetration: Cell::new(zero),
        dissipation: asked.dissipation,
        power: Cell::new(zero),
        observes_energy: asked.energy,
        energy: Default::default(),
        sums: Default::default(),
    };
    for i in 0..grains {
        env.own = i;
        env.sums = [Cell::new(zero), Cell::new(zero), Cell::new(zero)];
        env.power.set(zero);
        env.energy.iter().for_each(|sum| sum.set(zero));
        contacts.clear();
        for &j in lists.of(i) {
            let j = j as usize;
            let Some((offset_number, cell_offset, periods)) =
                cell_offsets.offset_between(columns_and_rows[i], columns_and_rows[j])
            else {
                continue;
            };
            let displacement = [0, 1].map(|axis| {
                let (own, there) = (discs.position[axis][i], discs.position[axis][j]);
                if cell_offsets.relative {
                    (own - there) - P::from_f64(cell_offset[axis])
                } else {
                    // The lattice shifts the image, then subtracts.
                    own - (there + P::from_f64(periods[axis]))
                }
            });
            if displacement[0] * displacement[0] + displacement[1] * displacement[1] < square {
                contacts.push(ListPartner { disc: j, offset_number, displacement });
            }
        }
        contacts.sort_unstable_by_key(|partner| (partner.offset_number, partner.disc));
        let met_one = StatedEnv::new(&env, law);
        let own = law.own(met_one);
        for partner in &contacts {
            law.pair(met_one, *partner, &own);
            if asked.watched.is_some_and(|depth| env.penetration.get().to_f64() > depth) {
                met.deep.push((i, partner.disc));
            }
        }
        met.pairs += contacts.len() as u64;
        met.dissipated += env.power.get().to_f64();
        met.energy.iter_mut().zip(&env.energy).for_each(|(sum, of_disc)| *sum += of_disc.get().to_f64());
        write(i, [0, 1, 2].map(|sum| env.sums[sum].get()));
    }
    met
}
