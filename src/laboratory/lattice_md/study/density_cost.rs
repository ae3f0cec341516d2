//! What does a step cost, over the number of particles and their density, by the source's model? BP93 figures 3 and 4.

use super::StudyError;
use super::efficiency_table::{Choice, Question, QuestionError, counting_model, printed_nop, step};
use crate::model::clock::Clock;
use crate::model::machine::MachineModel;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::Serialize;
use std::f64::consts::PI;
use stripmine_kernels::isa::{Op, OpCounts};
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::lattice_md::assemble;
use stripmine_physics::method::lattice_md::keys::{EXECUTION, SEARCH};
use stripmine_physics::method::lattice_md::options::By;
use stripmine_physics::method::lattice_md::{Lengths, Part, ledger, rival_ledger};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// The densest that discs can lie on cells as wide as their radius: touching discs in hexagonal order, `1/(2√3)`.
pub const CEILING: f64 = 0.288_675_134_594_812_9;

/// LMAX of figure 3.
pub const LATTICES: [usize; 3] = [1_000, 10_000, 100_000];

/// ρ of figure 4; the last two lie above [`CEILING`].
pub const OCCUPANCIES: [f64; 6] = [0.05, 0.1, 0.2, 0.25, 0.35, 0.5];

/// ρ of the lists of figure 3.
pub const DENSE: f64 = 0.25;

/// What lists hold at a density: measured in a run, because no model knows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ListFigures {
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// Candidates that a step looks at, for each disc.
    pub candidates: f64,
    /// Candidates in contact, for each disc.
    pub contacts: f64,
    /// Steps between two makings of the lists.
    pub steps_a_list: f64,
}

/// Clock periods of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// NP.
    pub particles: usize,
    /// By the source's formula and its NOP; none where the source has no formula.
    pub printed: Option<f64>,
    /// By the same clock, from the operations counted.
    pub counted: f64,
}

/// A curve over NP.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// LMAX where it is fixed.
    pub cells: Option<usize>,
    /// ρ where it is fixed.
    pub occupancy: Option<f64>,
    /// Whether discs can lie that densely on cells as wide as their radius.
    pub reachable: bool,
    /// The costs.
    pub costs: Vec<Cost>,
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct DensityCost {
    /// The machine.
    pub machine: String,
    /// Operations of a test of one pair while lists are made: the law's own, up to whether there is contact.
    pub test_operations: u64,
    /// What lists hold.
    pub lists: Vec<ListFigures>,
    /// Figure 3: a step of the vector algorithm over NP, for several LMAX.
    pub vector: Vec<Curve>,
    /// Figure 3: a step with scalar neighbour lists, made by trying all pairs.
    pub list: Curve,
    /// Figure 4: the vector algorithm over NP, for several ρ.
    pub densities: Vec<Curve>,
    /// Figure 4: the lists for the same ρ.
    pub list_densities: Vec<Curve>,
}

/// The dataset on a machine.
///
/// # Errors
/// [`StudyError`] if a scene breaks whose lists are counted.
pub fn density_cost(machine: &MachineModel) -> Result<DensityCost, StudyError> {
    let choice = Question::default().choice;
    let figures = OCCUPANCIES.into_par_iter().filter(|&occupancy| occupancy < CEILING).map(list_figures);
    let lists: Vec<ListFigures> = figures.collect::<Result<_, _>>()?;
    // Counts depend on what is modelled, not on how large the lattice is.
    let (programs, _) = step(&Question::default())?;
    let model = Model { machine, choice, lattice: ledger(&programs), rival: rival(choice)? };
    let vector = LATTICES.map(|cells| model.over_particles(Some(cells), None));
    let densities = OCCUPANCIES.map(|occupancy| model.over_particles(None, Some(occupancy)));
    Ok(DensityCost {
        machine: machine.title().to_owned(),
        test_operations: model.test().total(),
        vector: vector.into_iter().collect::<Result<_, _>>()?,
        list: model.with_lists(&list_figures(DENSE)?),
        densities: densities.into_iter().collect::<Result<_, _>>()?,
        list_densities: lists.iter().map(|figures| model.with_lists(figures)).collect(),
        lists,
    })
}

/// NP, ρ and the clock periods of a step, on the lattice and with lists, wherever there is a lattice.
///
/// # Errors
/// [`StudyError`] never for numbers of particles and occupancies that make lattices.
pub(super) fn grid(
    machine: &MachineModel,
    lists: &[ListFigures],
    particles: &[usize],
) -> Result<Vec<(usize, f64, [f64; 2])>, StudyError> {
    let choice = Question::default().choice;
    let (programs, _) = step(&Question::default())?;
    let model = Model { machine, choice, lattice: ledger(&programs), rival: rival(choice)? };
    let mut costs = vec![];
    for figures in lists {
        for &particles in particles {
            let cells = (particles as f64 / figures.occupancy).ceil() as usize;
            let [vector, list] =
                [model.step(particles, cells)?.counted, model.list_cost(particles, figures).counted];
            costs.push((particles, figures.occupancy, [vector, list]));
        }
    }
    Ok(costs)
}

/// NP of every curve: five a decade.
fn particles() -> impl Iterator<Item = usize> {
    (5..=25).map(|fifth| 10f64.powf(f64::from(fifth) / 5.0).round() as usize)
}

fn rival(choice: Choice) -> Result<Ledger, QuestionError> {
    let Question { particles, occupancy, .. } = Question::default();
    let cells = (particles as f64 / occupancy) as usize;
    let model = counting_model(cells, choice).map_err(|cause| QuestionError::Shape {
        particles,
        occupancy,
        cause,
    })?;
    Ok(rival_ledger(&model))
}

/// What is counted, and the machine whose clock charges it.
struct Model<'m> {
    machine: &'m MachineModel,
    choice: Choice,
    lattice: Ledger,
    rival: Ledger,
}

impl Model<'_> {
    /// A curve of the vector algorithm, with LMAX or ρ fixed.
    fn over_particles(&self, cells: Option<usize>, occupancy: Option<f64>) -> Result<Curve, StudyError> {
        let mut costs = vec![];
        for particles in particles() {
            let cells = match (cells, occupancy) {
                (Some(cells), _) => cells,
                (None, occupancy) => (particles as f64 / occupancy.unwrap_or(1.0)).ceil() as usize,
            };
            let least = if occupancy.is_some() { 25 } else { 0 };
            if cells < least || particles as f64 > CEILING.max(occupancy.unwrap_or(0.0)) * cells as f64 + 1.0
            {
                continue;
            }
            costs.push(self.step(particles, cells)?);
        }
        Ok(Curve {
            cells,
            occupancy,
            reachable: occupancy.is_none_or(|occupancy| occupancy < CEILING),
            costs,
        })
    }

    fn step(&self, particles: usize, cells: usize) -> Result<Cost, StudyError> {
        let occupancy = particles as f64 / cells as f64;
        let model = counting_model(cells, self.choice).map_err(|cause| QuestionError::Shape {
            particles,
            occupancy,
            cause,
        })?;
        let lengths = Lengths::new(&model, particles, particles);
        let clocks = |counts: &OpCounts, n| Clock::Paper.clocks(self.machine, &counts.clone().into(), n);
        let counted = self
            .lattice
            .parts()
            .into_iter()
            .map(|(_, length, counts)| clocks(&counts, lengths.range(length).len() as u64));
        let printed = Part::ALL.iter().filter_map(|&part| {
            let mut counts = OpCounts::default();
            (0..printed_nop(part)?).for_each(|_| counts.record(Op::Add));
            Some(clocks(&counts, if part == Part::Forces { cells } else { particles } as u64))
        });
        Ok(Cost { particles, printed: Some(printed.sum()), counted: counted.sum() })
    }

    /// A curve of the scalar rival.
    fn with_lists(&self, figures: &ListFigures) -> Curve {
        let costs = particles().map(|particles| self.list_cost(particles, figures)).collect();
        Curve { cells: None, occupancy: Some(figures.occupancy), reachable: true, costs }
    }

    /// The scalar rival: every operation costs the whole depth of the pipeline. The Index belongs to the lattice and is
    /// left out.
    fn list_cost(&self, particles: usize, figures: &ListFigures) -> Cost {
        let clocks =
            |counts: &OpCounts, n: f64| n * Clock::Scalar.clocks(self.machine, &counts.clone().into(), 1);
        let np = particles as f64;
        let rows = self.rival.parts();
        let walking =
            rows.iter().filter(|(part, ..)| *part != Part::Index.name()).map(|(_, length, counts)| {
                clocks(
                    counts,
                    match length {
                        Length::Candidates => figures.candidates * np,
                        Length::Pairs => figures.contacts * np,
                        _ => np,
                    },
                )
            });
        let making = clocks(&self.test(), 0.5 * np * (np - 1.0)) / figures.steps_a_list;
        Cost { particles, printed: None, counted: walking.sum::<f64>() + making }
    }

    /// Distance and contact of one pair.
    fn test(&self) -> OpCounts {
        let mut test = OpCounts::default();
        let rows = self.rival.entries().iter().filter(|entry| entry.length == Length::Candidates);
        rows.for_each(|entry| test.add(&entry.counts));
        test
    }
}

/// Looks into the lists of a warm gas of about a thousand discs.
pub(super) fn list_figures(occupancy: f64) -> Result<ListFigures, StudyError> {
    const EQUILIBRATION: u64 = 200;
    const STEPS: u64 = 1000;
    let scene = Overrides::new().set(&COUNT, 1024_u64).set(&PACKING_FRACTION, PI * occupancy);
    let overrides = scene.set(&SEARCH, By::NeighborList).set(&EXECUTION, "chained");
    let mut method = assemble(&Document::load("bench", &overrides)?.check()?)?;
    (0..EQUILIBRATION).try_for_each(|_| method.step())?;
    let made = method.lists().map_or(0, |(_, rebuilds)| rebuilds);
    let mut sums = [0; 2];
    for _ in 0..STEPS {
        method.step()?;
        sums[0] += method.length(Length::Candidates);
        sums[1] += method.length(Length::Pairs);
    }
    let made = method.lists().map_or(0, |(_, rebuilds)| rebuilds) - made;
    let discs = method.particles().grain_count() as f64 * STEPS as f64;
    Ok(ListFigures {
        occupancy,
        candidates: sums[0] as f64 / discs,
        contacts: sums[1] as f64 / discs,
        steps_a_list: STEPS as f64 / made.max(1) as f64,
    })
}
