//! Distribution of discs to the ranks: at the start, again when they have moved far, and from a saved state.

use super::layout::{BandLayout, RankSide};
use super::wire::{NamedColumns, column_like, entries};
use super::worker::RankWorker;
use crate::method::pairwise::saved::CELL;
use crate::method::pairwise::search::{PairSearch, SearchCells};
use crate::method::pairwise::state::Members;
use crate::ranks::{Parcel, RankError, numbers};
use std::collections::HashMap;
use stripmine_kernels::backend::Precision;

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> RankWorker<S, P, Q> {
    /// Takes the discs that this rank owns or needs near its bands, given the rows of all discs of the scene.
    pub(super) fn take_share(&mut self, rows: &[u32]) {
        let grains = self.engine.start.grain_count();
        let mut weights = vec![0; self.layout_bands()];
        rows[..grains].iter().for_each(|&row| weights[self.layout.band(row as usize)] += 1);
        self.distribute_bands(&weights);
        let rank = self.ranks.rank();
        let of = |numbers: std::ops::Range<usize>, is_wanted: &dyn Fn(usize) -> bool| -> Vec<u32> {
            numbers.filter(|&number| is_wanted(rows[number] as usize)).map(|number| number as u32).collect()
        };
        let own = of(0..grains, &|row| self.layout.owner(row) == rank);
        let near = of(0..grains, &|row| self.layout.side(rank, row).is_some());
        let walls = of(grains..rows.len(), &|_| true);
        let row_of = |number: u32| rows[number as usize] as usize;
        self.replace_discs(own, near, walls, row_of);
    }

    fn layout_bands(&self) -> usize {
        self.engine.search.rows().bands().len()
    }

    /// Distributes bands by their weights.
    fn distribute_bands(&mut self, weights: &[u64]) {
        let (rows, periodic) = (self.engine.search.rows(), self.engine.search.cells().grid().periodic[1]);
        self.layout = BandLayout::new(rows, periodic, weights, self.ranks.count());
    }

    /// Replaces the discs by those of this rank, nearby ones of other ranks, and walls, none in its cell yet.
    fn replace_discs(&mut self, own: Vec<u32>, near: Vec<u32>, walls: Vec<u32>, row: impl Fn(u32) -> usize) {
        let (rank, [below, above]) = (self.ranks.rank(), self.ranks.neighbours());
        let on_side = |discs: &[u32], rank: usize, side: RankSide| -> Vec<u32> {
            discs.iter().copied().filter(|&disc| self.layout.side(rank, row(disc)) == Some(side)).collect()
        };
        // Discs below a rank belong to the rank below, which sends them upwards.
        self.from = [on_side(&near, rank, RankSide::Below), on_side(&near, rank, RankSide::Above)];
        self.to = [on_side(&own, below, RankSide::Above), on_side(&own, above, RankSide::Below)];
        self.homes.clear();
        let (moving, grains) = (own.len(), own.len() + near.len());
        let numbers: Vec<u32> = own.into_iter().chain(near).chain(walls).collect();
        let search = self.engine.search.emptied(numbers.len(), self.layout.share(rank));
        self.engine.replace_members(Members { numbers, moving, grains }, search);
    }

    /// Redistributes the discs: each goes to the rank of its current row.
    pub(super) fn migrate(&mut self) -> Result<Result<(), String>, RankError> {
        let state = &self.engine.state;
        let row = |disc: usize| self.engine.search.cells().cell(disc).map_or(0, |cell| cell[1]);
        let mut weights = vec![0; self.layout_bands()];
        (0..state.moving()).for_each(|disc| weights[self.layout.band(row(disc))] += 1);
        let gathered = self.ranks.gather_messages(weights)?;
        let sums = gathered.into_iter().reduce(|mut sums: Vec<u64>, of_rank| {
            sums.iter_mut().zip(of_rank).for_each(|(sum, of_rank)| *sum += of_rank);
            sums
        });
        let weights = self.ranks.broadcast_message(sums)?;
        self.distribute_bands(&weights);
        let state = &self.engine.state;
        let row = |disc: usize| self.engine.search.cells().cell(disc).map_or(0, |cell| cell[1]);
        let parcels = (0..self.ranks.count()).map(|rank| {
            let own = |disc: &usize| self.layout.owner(row(*disc)) == rank;
            let near = |disc: &usize| self.layout.side(rank, row(*disc)).is_some();
            let of = |is_sent: &dyn Fn(&usize) -> bool| -> Vec<u32> {
                (0..state.moving()).filter(is_sent).map(|disc| disc as u32).collect()
            };
            let (own, near) = (of(&own), of(&near));
            let columns = self.engine.columns_of(&[&own[..], &near].concat());
            let discs = [own, near].map(|discs| self.numbers(&discs));
            Parcel::of(&(discs, Parcel::of_numbers(columns.iter().flat_map(|(_, column)| entries(column)))))
        });
        let came = self.ranks.migrate(parcels.collect())?;
        self.receive_discs(&came)
    }

    /// Takes over the discs received from every rank.
    fn receive_discs(&mut self, came: &[Parcel]) -> Result<Result<(), String>, RankError> {
        let template = self.engine.columns_of(&[]);
        let mut discs: Vec<(bool, u32, Vec<f64>)> = vec![];
        for (rank, parcel) in came.iter().enumerate() {
            let ([own, near], bytes): ([Vec<u32>; 2], &[u8]) = parcel.open(rank)?;
            let mut numbers = numbers(bytes, rank, template.len() * (own.len() + near.len()))?;
            let begin = discs.len();
            discs.extend(own.into_iter().map(|number| (false, number, vec![])));
            discs.extend(near.into_iter().map(|number| (true, number, vec![])));
            for _ in &template {
                let entries = discs[begin..].iter_mut().zip(numbers.by_ref());
                entries.for_each(|(disc, number)| disc.2.push(number));
            }
        }
        Ok(self.install_received(discs, &template))
    }

    /// Replaces the discs, some of them only nearby, with the entries of each in the columns of a template.
    fn install_received(
        &mut self,
        mut discs: Vec<(bool, u32, Vec<f64>)>,
        template: &NamedColumns,
    ) -> Result<(), String> {
        discs.sort_unstable_by_key(|&(is_near, number, _)| (is_near, number));
        let (grains, all) = (self.engine.state.grains(), self.engine.state.len());
        let mut walls: Vec<u32> = (grains..all).map(|disc| disc as u32).collect();
        walls.sort_unstable_by_key(|&disc| self.engine.state.number(disc as usize));
        let of_walls = self.engine.columns_of(&walls);
        let walls: Vec<u32> =
            walls.iter().map(|&disc| self.engine.state.number(disc as usize) as u32).collect();
        let columns: NamedColumns = (template.iter().zip(&of_walls).enumerate())
            .map(|(at, ((name, like), (_, of_walls)))| {
                let values = discs.iter().map(|disc| disc.2[at]).chain(entries(of_walls));
                (name.clone(), column_like(like, values.collect()))
            })
            .collect();
        let rows: HashMap<u32, usize> = {
            let at = columns.iter().position(|(name, _)| name == CELL[1]);
            let at = at.unwrap_or_default();
            discs.iter().map(|disc| (disc.1, disc.2[at] as usize)).collect()
        };
        let of = |near: bool| discs.iter().filter(move |disc| disc.0 == near).map(|disc| disc.1).collect();
        let (own, near): (Vec<u32>, Vec<u32>) = (of(false), of(true));
        let made = self.engine.search.lists().map(|lists| lists.made());
        self.replace_discs(own, near, walls, |number| rows.get(&number).copied().unwrap_or_default());
        let length = self.engine.state.len();
        self.engine.restore_discs(&columns, (0..length as u32).collect(), length)?;
        made.into_iter().for_each(|made| self.engine.search.set_lists_made(made));
        // Migration happens between a step and its forces.
        self.engine.awaits_forces = true;
        self.index_exchanged_discs();
        Ok(())
    }

    /// Restores the state of the whole scene.
    pub(super) fn restore(&mut self, steps: u64, columns: &NamedColumns) -> Result<(), String> {
        let rows = columns.iter().find(|(name, _)| name == CELL[1]);
        let count = self.engine.search.rows().count;
        let rows: Vec<u32> = rows.map_or(vec![], |(_, column)| {
            entries(column).into_iter().map(|row| (row as u32).min(count as u32 - 1)).collect()
        });
        if rows.len() != self.engine.start.len() {
            return Err("the rows of the discs are missing".to_owned());
        }
        self.take_share(&rows);
        self.engine.restore_state(steps, columns)?;
        self.index_exchanged_discs();
        Ok(())
    }
}
