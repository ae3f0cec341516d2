//! Share of the counted operations that act on real contacts, by method and density.

use super::StudyError;
use super::density_cost::{CEILING, ListStatistics, OCCUPANCIES, list_statistics};
use super::efficiency_table::{TableScene, programs_of_step, scene_model};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::results::{FinishedItem, StudyEnvironment, StudySize, run_in_parallel};
use stripmine_kernels::isa::OpClass;
use stripmine_kernels::ledger::{Ledger, VectorLength};
use stripmine_physics::method::lattice_md::{Part, ledger, neighbour_list_ledger};

/// Counts operations; the contacts are those of a warm gas.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let occupancies = [0.01, 0.025].into_iter().chain(OCCUPANCIES);
    let reachable: Vec<f64> = occupancies.filter(|&occupancy| occupancy < CEILING).collect();
    let rows = run_in_parallel(&reachable, |&occupancy| -> Result<_, StudyError> {
        let figures = list_statistics(occupancy)?;
        Ok((figures, shares(figures)?))
    })?;
    let shares = ["lattice, forces", "lattice, step", "lists, forces", "lists, step"];
    let frame = FrameBuilder::of(rows)
        .number("ρ", 3, |(figures, _)| figures.occupancy)
        .number("contacts a disc, each from both sides", 3, |(figures, _)| figures.contacts)
        .number("candidates a disc", 2, |(figures, _)| figures.candidates)
        .cells(shares, |(_, shares)| shares.map(|share| TableCell::Number(100.0 * share, 3)))
        .frame("useful_work", "Share of the operations that act on real contacts (%)");
    Ok(FinishedItem::of([frame]).with_seeds([1]))
}

/// Share of operations on contacts: lattice forces, lattice step, list forces, list step. Every execution of the lattice visits every
/// offset of every cell. Building the lists is not counted.
fn shares(figures: ListStatistics) -> Result<[f64; 4], StudyError> {
    let question = TableScene { occupancy: figures.occupancy, ..TableScene::default() };
    let (programs, lengths) = programs_of_step(&question)?;
    let discs = question.particles as f64;
    let contacts = figures.contacts * discs;
    let lattice = ledger(&programs);
    // Operations of an offset of the mask, without those of a cell. The law adds to its sums in a section with the name of the section that
    // stores them.
    let offsets = 24.0;
    let of_offsets: u64 = lattice
        .entries()
        .iter()
        .filter(|entry| entry.part == Part::Forces.name() && !["own disc", "watch"].contains(&entry.section))
        .map(|entry| entry.counts.filtered(|op| op.class() != OpClass::Store).total())
        .sum();
    let useful = contacts * of_offsets as f64 / offsets;
    let sum = |ledger: &Ledger, forces_only: bool| -> f64 {
        let parts = ledger.parts().into_iter();
        let parts = parts.filter(|(part, ..)| !forces_only || *part == Part::Forces.name());
        let n = |length: VectorLength| {
            figures.length(length, discs).unwrap_or(lengths.range(length).len() as f64)
        };
        parts.map(|(_, length, counts)| n(length) * counts.total() as f64).sum()
    };
    let lists = neighbour_list_ledger(&scene_model(&question)?);
    let pairs = lists
        .entries()
        .iter()
        .filter(|entry| matches!(entry.length, VectorLength::Candidates | VectorLength::Pairs));
    let of_pair: u64 = pairs.map(|entry| entry.counts.total()).sum();
    let useful_pairs = contacts * of_pair as f64;
    let of = |useful: f64, ledger: &Ledger, forces_only: bool| useful / sum(ledger, forces_only);
    Ok([
        of(useful, &lattice, true),
        of(useful, &lattice, false),
        of(useful_pairs, &lists, true),
        of(useful_pairs, &lists, false),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lattice_visits_mostly_empty_cells() {
        let figures = ListStatistics { occupancy: 0.25, candidates: 6.0, contacts: 4.0, steps_a_list: 10.0 };
        let [lattice_forces, _, list_forces, list_step] = shares(figures).unwrap();
        // Four of 24 offsets at a quarter of the cells, minus the work done once per cell and in the halo.
        let most = 4.0 * 0.25 / 24.0;
        assert!(lattice_forces < most && lattice_forces > 0.8 * most, "{lattice_forces}");
        assert!(list_forces > 0.5 && list_step < list_forces, "{list_forces} {list_step}");
    }

    #[test]
    fn without_contacts_nothing_is_useful() {
        let figures = ListStatistics { occupancy: 0.05, candidates: 1.0, contacts: 0.0, steps_a_list: 10.0 };
        let [_, lattice_step, _, list_step] = shares(figures).unwrap();
        assert_eq!([lattice_step, list_step], [0.0, 0.0]);
    }
}
