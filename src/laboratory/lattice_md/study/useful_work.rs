//! How much of what is counted acts on real contacts? By method and density.

use super::StudyError;
use super::density_cost::{CEILING, ListFigures, OCCUPANCIES, list_figures};
use super::efficiency_table::{Question, counting_model, step};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::Serialize;
use stripmine_kernels::isa::OpClass;
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_physics::method::lattice_md::{Part, ledger, rival_ledger};

/// The share of useful operations at a density.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// What lists hold there, and with it how many contacts there are: measured in a run.
    pub figures: ListFigures,
    /// Of the operations of the lattice's forces, those at a place where there is a contact: the same for the eager, the
    /// strip-mined and the chained execution, which all meet every place of every cell.
    pub lattice_forces: f64,
    /// The same of the whole step.
    pub lattice_step: f64,
    /// Of the operations of the lists' forces, those on a pair in contact.
    pub list_forces: f64,
    /// The same of the whole step; making the lists not counted.
    pub list_step: f64,
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct UsefulWork {
    /// By rising density.
    pub shares: Vec<Share>,
}

/// Counts; the contacts are those of a warm gas.
///
/// # Errors
/// [`StudyError`] if a scene breaks whose contacts are counted.
pub fn useful_work() -> Result<UsefulWork, StudyError> {
    let occupancies = [0.01, 0.025].into_iter().chain(OCCUPANCIES);
    let reachable: Vec<f64> = occupancies.filter(|&occupancy| occupancy < CEILING).collect();
    let figures: Vec<ListFigures> = reachable.into_par_iter().map(list_figures).collect::<Result<_, _>>()?;
    let shares = figures.into_iter().map(share).collect::<Result<_, _>>()?;
    Ok(UsefulWork { shares })
}

fn share(figures: ListFigures) -> Result<Share, StudyError> {
    let question = Question { occupancy: figures.occupancy, ..Question::default() };
    let (programs, lengths) = step(&question)?;
    let discs = question.particles as f64;
    let contacts = figures.contacts * discs;
    let lattice = ledger(&programs);
    // Operations of a place of the mask: what is done once a cell is not among them. The law adds to its sums in a section
    // of the same name as the one that stores them.
    let places = 24.0;
    let of_places: u64 = lattice
        .entries()
        .iter()
        .filter(|entry| entry.part == Part::Forces.name() && !["own disc", "watch"].contains(&entry.section))
        .map(|entry| entry.counts.filtered(|op| op.class() != OpClass::Store).total())
        .sum();
    let useful = contacts * of_places as f64 / places;
    let sum = |ledger: &Ledger, forces_only: bool| -> f64 {
        let parts = ledger.parts().into_iter();
        let parts = parts.filter(|(part, ..)| !forces_only || *part == Part::Forces.name());
        parts
            .map(|(_, length, counts)| {
                let n = match length {
                    Length::Candidates => figures.candidates * discs,
                    Length::Pairs => contacts,
                    length => lengths.range(length).len() as f64,
                };
                n * counts.total() as f64
            })
            .sum()
    };
    let model = counting_model(lengths.cells, question.choice).map_err(|cause| {
        super::efficiency_table::QuestionError::Shape {
            particles: question.particles,
            occupancy: question.occupancy,
            cause,
        }
    })?;
    let lists = rival_ledger(&model);
    let of_pair: u64 = lists
        .entries()
        .iter()
        .filter(|entry| matches!(entry.length, Length::Candidates | Length::Pairs))
        .map(|entry| entry.counts.total())
        .sum();
    let useful_pairs = contacts * of_pair as f64;
    Ok(Share {
        figures,
        lattice_forces: useful / sum(&lattice, true),
        lattice_step: useful / sum(&lattice, false),
        list_forces: useful_pairs / sum(&lists, true),
        list_step: useful_pairs / sum(&lists, false),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_of_touching_discs_still_meets_mostly_empty_places() {
        let figures = ListFigures { occupancy: 0.25, candidates: 6.0, contacts: 4.0, steps_a_list: 10.0 };
        let share = share(figures).unwrap();
        // Four of 24 places at a quarter of the cells, less what is done once a cell and in the halo.
        let most = 4.0 * 0.25 / 24.0;
        assert!(share.lattice_forces < most && share.lattice_forces > 0.8 * most, "{share:?}");
        assert!(share.list_forces > 0.5 && share.list_step < share.list_forces, "{share:?}");
    }

    #[test]
    fn without_contacts_nothing_is_useful() {
        let figures = ListFigures { occupancy: 0.05, candidates: 1.0, contacts: 0.0, steps_a_list: 10.0 };
        let share = share(figures).unwrap();
        assert_eq!((share.lattice_step, share.list_step), (0.0, 0.0));
    }
}
