//! Who wins where? Occupancy × number of particles × method × machine: by the clocks of machines, by the model of a host,
//! and as measured on this one.

use super::StudyError;
use super::density_cost::{ListFigures, grid, list_figures};
use super::model_validation::Calibrated;
use super::phase_times::{FAST, FAST_LISTS, HALF_MASK, LISTS, PhaseTimes, Run, Sampling, phase_times};
use super::predicted_step::Step;
use super::rounds::Bound;
use crate::model::host::{Amounts, HostModel, OutOfRange};
use crate::model::machine::MachineModel;
use serde::Serialize;
use stripmine_kernels::Execution;
use stripmine_physics::method::lattice_md::Lengths;
use stripmine_physics::method::lattice_md::Phase;
use stripmine_physics::method::lattice_md::{model, programs};
use stripmine_physics::method::throughput::MeasurementError;

/// ρ of the atlas, below the ceiling of cells as wide as the radius.
pub const OCCUPANCIES: [f64; 7] = [0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25];
/// NP of the atlas by models; at the lowest occupancy the lattice of the last is as large as calibrations go.
pub const PARTICLES: [usize; 6] = [100, 300, 1000, 3000, 10_000, 30_000];

/// Variants that are run on a host, as scenes name them.
const VARIANTS: [(&str, Option<Execution>); 6] = [
    ("eager", Some(Execution::Eager)),
    ("strip:512", Some(Execution::Strip(512))),
    ("chained", Some(Execution::Chained)),
    (FAST, None),
    (FAST_LISTS, None),
    (LISTS, None),
];

/// The costs of a step at one place of the atlas.
#[derive(Clone, Debug, Serialize)]
pub struct Place {
    /// NP.
    pub particles: usize,
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// The cost of a step by each method of the sheet.
    pub costs: Vec<f64>,
}

impl Place {
    /// The cheapest method, and how many times as much the next one costs.
    pub fn winner(&self) -> Option<(usize, f64)> {
        let mut order: Vec<usize> = (0..self.costs.len()).collect();
        order.sort_by(|&a, &b| self.costs[a].total_cmp(&self.costs[b]));
        let (&first, &second) = (order.first()?, order.get(1)?);
        Some((first, self.costs[second] / self.costs[first]))
    }
}

/// One machine of the atlas.
#[derive(Clone, Debug, Serialize)]
pub struct Sheet {
    /// A name for files.
    pub name: String,
    /// The machine, and by what its costs are known.
    pub title: String,
    /// Unit of the costs.
    pub unit: &'static str,
    /// Whether it was measured here and now.
    pub measured: bool,
    /// The methods.
    pub methods: Vec<String>,
    /// The places.
    pub places: Vec<Place>,
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Atlas {
    /// Whose model of a host it is.
    pub model: String,
    /// What lists hold at each density, measured in a run of about a thousand discs: what the models take for the number of
    /// candidates and contacts everywhere.
    pub lists: Vec<ListFigures>,
    /// The same of the fast lists, whose skin is another: a step of that run.
    pub fast_lists: Vec<Amounts>,
    /// The sheets.
    pub sheets: Vec<Sheet>,
}

/// A place that was measured, and what the model of the host says of it.
#[derive(Clone, Debug, Serialize)]
pub struct Named {
    /// NP.
    pub particles: usize,
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// The method that the model names as the cheapest.
    pub named: String,
    /// The one that was measured as the cheapest.
    pub cheapest: String,
    /// Measured cost of the one that the model names, over that of the cheapest.
    pub dearer: f64,
}

impl Atlas {
    /// The method that is the cheapest at most of the measured places, and at how many: what a model is worth that always names it.
    pub fn baseline(&self) -> Option<(&str, usize)> {
        let sheet = self.sheets.iter().find(|sheet| sheet.measured)?;
        let wins = |method: usize| {
            let winners = sheet.places.iter().filter_map(Place::winner);
            winners.filter(|(winner, _)| *winner == method).count()
        };
        let counted = sheet.methods.iter().enumerate().map(|(method, name)| (name.as_str(), wins(method)));
        counted.max_by_key(|(_, wins)| *wins)
    }

    /// Every measured place with the method that the model of the host names there.
    pub fn named(&self) -> Vec<Named> {
        let sheet =
            |measured| self.sheets.iter().find(|sheet| sheet.unit == "ns" && sheet.measured == measured);
        let (Some(measured), Some(predicted)) = (sheet(true), sheet(false)) else { return vec![] };
        let named = measured.places.iter().filter_map(|place| {
            let there =
                |other: &&Place| (other.particles, other.occupancy) == (place.particles, place.occupancy);
            let (named, _) = predicted.places.iter().find(there)?.winner()?;
            let (cheapest, _) = place.winner()?;
            Some(Named {
                particles: place.particles,
                occupancy: place.occupancy,
                named: measured.methods[named].clone(),
                cheapest: measured.methods[cheapest].clone(),
                dearer: place.costs[named] / place.costs[cheapest],
            })
        });
        named.collect()
    }
}

/// Why there is no atlas.
#[derive(Debug, thiserror::Error)]
pub enum AtlasError {
    /// A scene broke whose lists are counted.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A scene broke that was measured.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    /// A place that the host model does not reach.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}

/// The atlas of some machines and a host; measured for these numbers of particles, in this many rounds over all of them, for
/// who else is at work on the machine is the same for a while. `progress` gets the share that is done.
///
/// # Errors
/// [`AtlasError`] if a scene breaks or lies outside what was calibrated.
pub fn atlas(
    machines: &[MachineModel],
    (host, calibrated): (&HostModel, Calibrated),
    measured: &[usize],
    rounds: Bound,
    progress: impl Fn(f64) + Sync,
) -> Result<Atlas, AtlasError> {
    let lists: Vec<ListFigures> = OCCUPANCIES.map(list_figures).into_iter().collect::<Result<_, _>>()?;
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    let fast_lists: Vec<Amounts> = OCCUPANCIES
        .iter()
        .map(|&occupancy| alone.install(|| fast_list_amounts(occupancy)))
        .collect::<Result<_, _>>()?;
    let mut sheets = vec![];
    for machine in machines {
        let places = grid(machine, &lists, &PARTICLES)?.into_iter();
        sheets.push(Sheet {
            name: format!(
                "atlas_{}",
                machine.title().to_lowercase().replace(|c: char| !c.is_alphanumeric(), "_")
            ),
            title: format!("{}, by the paper's clock", machine.title()),
            unit: "clock periods",
            measured: false,
            methods: ["vector lattice", "scalar lists, all pairs"].map(str::to_owned).to_vec(),
            places: places
                .map(|(particles, occupancy, costs)| Place { particles, occupancy, costs: costs.to_vec() })
                .collect(),
        });
    }
    let methods: Vec<String> = VARIANTS.iter().map(|(name, _)| (*name).to_owned()).collect();
    let mut predicted = vec![];
    for particles in PARTICLES {
        for figures in lists.iter().zip(&fast_lists) {
            let costs = VARIANTS.iter().map(|variant| predict(host, particles, figures, variant));
            let costs = costs.collect::<Result<_, AtlasError>>()?;
            predicted.push(Place { particles, occupancy: figures.0.occupancy, costs });
        }
    }
    sheets.push(Sheet {
        name: "atlas_host".to_owned(),
        title: format!("by {}", calibrated.model_of(&host.title)),
        unit: "ns",
        measured: false,
        methods: methods.clone(),
        places: predicted,
    });
    let mut times: Vec<(usize, f64, Vec<PhaseTimes>)> = vec![];
    for &particles in measured {
        times.extend(OCCUPANCIES.map(|occupancy| (particles, occupancy, vec![])));
    }
    let (places, mut rounds) = (times.len() as f64, rounds.begin());
    while rounds.next().is_some() {
        for (at, (particles, occupancy, variants)) in times.iter_mut().enumerate() {
            let before = std::mem::take(variants).into_iter().map(Some).chain(std::iter::repeat(None));
            for (variant, before) in VARIANTS.iter().zip(before) {
                let more = alone.install(|| measure(*particles, *occupancy, variant))?;
                variants.push(PhaseTimes::with(before, more));
            }
            progress(rounds.share((at + 1) as f64 / places));
        }
    }
    let step = |times: &PhaseTimes| Phase::ALL.iter().map(|&phase| times.of(phase)).sum();
    let place = |(particles, occupancy, variants): (usize, f64, Vec<PhaseTimes>)| Place {
        particles,
        occupancy,
        costs: variants.iter().map(step).collect(),
    };
    let places = times.into_iter().map(place).collect();
    sheets.push(Sheet {
        name: "atlas_measured".to_owned(),
        title: "this host, measured".to_owned(),
        unit: "ns",
        measured: true,
        methods,
        places,
    });
    Ok(Atlas { model: calibrated.model_of(&host.title), lists, fast_lists, sheets })
}

fn run(particles: usize, occupancy: f64, (name, _): &(&'static str, Option<Execution>)) -> Run {
    Run { particles, occupancy, precision: "f64", execution: name }
}

/// What fast lists have to do in a step, in a run of about a thousand discs.
fn fast_list_amounts(occupancy: f64) -> Result<Amounts, MeasurementError> {
    let checked = run(1000, occupancy, &(FAST_LISTS, None)).scene(std::convert::identity)?;
    let sampling = Sampling { equilibration: 200, repeats: 2, particle_steps: 300_000, least_steps: 100 };
    Ok(phase_times(&checked, &sampling)?.amounts)
}

/// Nanoseconds of a step by the model; candidates and contacts as in the run of about a thousand discs.
fn predict(
    host: &HostModel,
    particles: usize,
    (figures, fast_lists): (&ListFigures, &Amounts),
    variant: &(&'static str, Option<Execution>),
) -> Result<f64, AtlasError> {
    let run = run(particles, figures.occupancy, variant);
    let checked = run.scene(std::convert::identity)?;
    let (model, discs) = (model(&checked), checked.particles.grain_count());
    let lengths = Lengths::new(&model, discs, checked.particles.len());
    if let Some(execution) = variant.1 {
        let step = Step::new(&programs(&model, checked.scene.machine.precision), &lengths);
        let phases = Phase::ALL.iter().map(|&phase| Ok(step.phase(host, phase, execution)?));
        return phases.sum::<Result<f64, AtlasError>>();
    }
    let np = discs as f64;
    let amounts = if run.execution == LISTS {
        Amounts {
            steps: 1.0,
            discs: np,
            cells: 0.0,
            candidates: figures.candidates * np,
            contacts: figures.contacts * np,
            makings: 1.0 / figures.steps_a_list,
            remade: np / figures.steps_a_list,
            relisted: figures.candidates * np / figures.steps_a_list,
        }
    } else if run.execution == FAST_LISTS {
        let of_so_many = fast_lists.with(&Amounts::default(), |amount, _| amount * np / fast_lists.discs);
        Amounts { steps: 1.0, makings: fast_lists.makings, ..of_so_many }
    } else {
        // Each pair once; in the lists it is in both.
        let contacts = 0.5 * figures.contacts * np;
        let cells = lengths.cells as f64;
        let candidates = HALF_MASK * np * np / cells;
        Amounts { steps: 1.0, discs: np, cells, candidates, contacts, ..Amounts::default() }
    };
    Ok(run.predicted(host, &amounts)?.into_iter().sum())
}

/// The times of a step, measured once.
fn measure(
    particles: usize,
    occupancy: f64,
    variant: &(&'static str, Option<Execution>),
) -> Result<PhaseTimes, MeasurementError> {
    let checked = run(particles, occupancy, variant).scene(std::convert::identity)?;
    let equilibration = (100_000 / particles).clamp(3, 30);
    let sampling = Sampling { equilibration, repeats: 1, particle_steps: 5_000, least_steps: 3 };
    phase_times(&checked, &sampling)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(measured: bool, costs: [f64; 2]) -> Sheet {
        Sheet {
            name: String::new(),
            title: String::new(),
            unit: "ns",
            measured,
            methods: vec!["a".to_owned(), "b".to_owned()],
            places: vec![Place { particles: 100, occupancy: 0.1, costs: costs.to_vec() }],
        }
    }

    #[test]
    fn the_winner_is_the_cheapest_and_its_lead_is_over_the_next() {
        let place = Place { particles: 1, occupancy: 0.1, costs: vec![3.0, 1.0, 2.0] };
        assert_eq!(place.winner(), Some((1, 2.0)));
    }

    #[test]
    fn the_baseline_names_what_wins_most_often() {
        let mut measured = sheet(true, [10.0, 5.0]);
        measured
            .places
            .extend([sheet(true, [3.0, 4.0]), sheet(true, [9.0, 1.0])].into_iter().flat_map(|it| it.places));
        let atlas = Atlas { model: String::new(), lists: vec![], fast_lists: vec![], sheets: vec![measured] };
        assert_eq!(atlas.baseline(), Some(("b", 2)));
    }

    #[test]
    fn a_wrong_winner_costs_what_it_is_dearer() {
        for (measured, cheapest, dearer) in [([10.0, 20.0], "a", 1.0), ([10.0, 5.0], "b", 2.0)] {
            let sheets = vec![sheet(false, [1.0, 2.0]), sheet(true, measured)];
            let named = Atlas { model: String::new(), lists: vec![], fast_lists: vec![], sheets }.named();
            let [only] = named.as_slice() else { panic!("{named:?}") };
            assert_eq!((only.named.as_str(), only.cheapest.as_str(), only.dearer), ("a", cheapest, dearer));
        }
    }
}
