//! Samples of the discs. Data that several observables need are computed once, in memory that is reused for each sample.

use super::cells::SampleCells;
use super::discs::SampledDiscs;
use super::forces::{PairForces, Stress};
use super::heights::Heights;
use super::ideal::{pair_probabilities, probabilities_of_species};
use super::neighbours::Neighbours;
use super::pairs::Distances;
use super::setting::{StructureSetting, species_numbers};
use super::waves::Waves;
use super::{SampleData, SamplingKind, StructureObservable};
use crate::particles::{GrainStates, Particles};

/// Sample of discs at one moment.
#[derive(Clone, Debug)]
pub struct StructureSample {
    pub(super) setting: StructureSetting,
    /// Radius, mass and species of each grain.
    sizes: Vec<([f64; 2], u8)>,
    states: GrainStates,
    pub(super) discs: SampledDiscs,
    cells: SampleCells,
    pub(super) distances: Distances,
    /// Probability of a pair of an ideal gas in each bin of distances, if pairs are needed.
    pub(super) chances: Vec<f64>,
    /// Pairs of an ideal gas at the heights of the moment, if pairs are needed and the box has an open top.
    pub(super) heights: Option<Heights>,
    pub(super) neighbours: Neighbours,
    pub(super) waves: Waves,
    /// Pairs of species by their distance, and the probabilities in an ideal gas, if they are needed.
    pub(super) partial_distances: Distances,
    pub(super) partial_chances: Vec<Vec<f64>>,
    pub(super) stress: Stress,
    asked: Vec<SampleData>,
}

impl StructureSample {
    /// Prepares samples for some observables of a scene's particles.
    pub fn new<'o>(
        setting: StructureSetting,
        particles: &Particles,
        observables: impl Iterator<Item = &'o StructureObservable>,
    ) -> StructureSample {
        let asks = |observable: &StructureObservable| match observable.seen {
            SamplingKind::Once { asks, .. } => Some(asks),
            SamplingKind::Twice { .. } => None,
        };
        let (grains, asked) = (particles.grains(), observables.filter_map(asks).collect::<Vec<SampleData>>());
        let [by_heights, by_area] =
            [true, false].map(|open| asked.contains(&SampleData::Distances) && setting.has_open_top == open);
        StructureSample {
            setting,
            sizes: grains.iter().map(|it| [it.radius, it.mass]).zip(species_numbers(grains).0).collect(),
            states: GrainStates::of(grains),
            discs: SampledDiscs::default(),
            cells: SampleCells::default(),
            distances: Distances::default(),
            neighbours: Neighbours::default(),
            waves: Waves::new(&setting),
            partial_distances: Distances::default(),
            partial_chances: match asked.contains(&SampleData::DistancesOfSpecies) {
                true => probabilities_of_species(&setting, particles),
                false => vec![],
            },
            stress: Stress::default(),
            chances: if by_area { pair_probabilities(&setting, particles) } else { vec![] },
            heights: by_heights.then(|| Heights::new(&setting, particles)),
            asked,
        }
    }

    /// Samples the states that `put` stores; false if no disc is left.
    pub fn take_sample(&mut self, put: impl FnOnce(&mut GrainStates)) -> bool {
        put(&mut self.states);
        self.copy_states();
        if self.discs.x.is_empty() {
            return false;
        }
        let asks = |what: SampleData| self.needs_data(what);
        let (distances, neighbours, waves) =
            (asks(SampleData::Distances), asks(SampleData::Neighbours), asks(SampleData::Waves));
        let (partial, partial_waves) =
            (asks(SampleData::DistancesOfSpecies), asks(SampleData::WavesOfSpecies));
        if distances || partial || neighbours {
            let reaches = [
                if distances || partial { self.setting.reach } else { 0.0 },
                if neighbours { Neighbours::reach(&self.setting, self.discs.x.len()) } else { 0.0 },
            ];
            self.cells.sort(&self.setting, &self.discs, reaches[0].max(reaches[1]));
        }
        if distances {
            self.distances.count(&self.setting, &self.cells, &[]);
            if let Some(heights) = &mut self.heights {
                heights.find(&self.discs);
            }
        }
        if partial {
            self.partial_distances.count(&self.setting, &self.cells, &self.discs.species);
        }
        if neighbours {
            self.neighbours.find(&self.setting, &self.discs, &self.cells);
        }
        if waves {
            self.waves.sum(&self.setting, &self.discs);
        }
        if partial_waves {
            self.waves.sum_species(&self.setting, &self.discs);
        }
        true
    }

    /// True if an observable needs these data.
    pub fn needs_data(&self, what: SampleData) -> bool {
        self.asked.contains(&what)
    }

    /// Computes the forces between the discs of this moment, walls included.
    pub fn add_pair_forces(&mut self, particles: &Particles, forces: &PairForces) {
        self.stress.sum(&self.setting, particles.all(), forces);
    }

    /// Values of an observable of one moment, and their weights in a mean.
    pub fn values(&self, observable: &StructureObservable) -> [Vec<f64>; 2] {
        let SamplingKind::Once { over, of, further, .. } = observable.seen else { return [vec![], vec![]] };
        let width = over.places(&self.setting).len() + further;
        let (mut values, mut weights) = (vec![0.0; width], vec![1.0; width]);
        of(self, &mut values, &mut weights);
        [values, weights]
    }

    /// Copies the states of the discs present into columns.
    fn copy_states(&mut self) {
        let SampledDiscs { x, y, vx, vy, radius, mass, species } = &mut self.discs;
        [&mut *x, y, vx, vy, radius, mass].into_iter().for_each(|column| column.clear());
        species.clear();
        let there = self.states.rows().iter().zip(&self.sizes).filter(|(row, _)| !row[0].is_nan());
        for (&[at_x, at_y, along_x, along_y], &([its_radius, its_mass], its_species)) in there {
            x.push(at_x);
            y.push(at_y);
            vx.push(along_x);
            vy.push(along_y);
            radius.push(its_radius);
            mass.push(its_mass);
            species.push(its_species);
        }
    }
}

/// Hexatic order ψ6 of each disc, real and imaginary part: the mean of exp(6iθ) over the six nearest.
pub fn hexatic_orders(setting: &StructureSetting, discs: &Particles) -> Vec<[f64; 2]> {
    let mut sample = StructureSample::new(*setting, discs, std::iter::empty());
    sample.states.store_grains(discs);
    sample.copy_states();
    if sample.discs.x.is_empty() {
        return vec![];
    }
    let reach = Neighbours::reach(setting, sample.discs.x.len());
    sample.cells.sort(setting, &sample.discs, reach);
    sample.neighbours.keeps_each = true;
    sample.neighbours.find(setting, &sample.discs, &sample.cells);
    sample.neighbours.each()
}

/// Values of an observable for some discs, and their weights in a mean.
pub fn sampled_values(
    observable: &'static StructureObservable,
    setting: StructureSetting,
    discs: &Particles,
) -> [Vec<f64>; 2] {
    let mut sample = StructureSample::new(setting, discs, std::iter::once(observable));
    if sample.take_sample(|states| states.store_grains(discs)) {
        sample.values(observable)
    } else {
        [vec![], vec![]]
    }
}
