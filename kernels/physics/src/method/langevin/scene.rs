//! What a scene of this method says, as plain data.

use super::keys::*;
use super::laws::{LAW, PairLaw, Parameters, SweptLaw};
use super::options::{By, SchemeKind, SortKind};
use crate::scene::{
    Binding, Domain, Output, Precision, Run, Start, WallMotion, Write, bind_arithmetic, bind_heading,
};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::integrator::langevin::Bath;

/// What is simulated. Units are the scene's own; `units` names them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scene {
    /// The unit system: a label.
    pub units: String,
    /// The box.
    pub domain: Domain,
    /// The particles at the start.
    pub start: Start,
    /// What they do to each other.
    pub law: PairLaw,
    /// Its numbers.
    pub(super) parameters: Parameters,
    /// Friction and temperature.
    pub bath: Bath,
    /// Seed of the noise, where it is not that of the start.
    pub(crate) noise_seed: Option<u64>,
    /// How pairs are found.
    pub by: By,
    /// Sectors along each side, where the scene says.
    pub per_side: Option<u64>,
    /// When particles are put in the order of sectors.
    pub sort: SortKind,
    /// How much farther than the cut-off listed pairs may be (length), where the scene says.
    pub skin: Option<f64>,
    /// The integrator.
    pub scheme: SchemeKind,
    /// Time step (time).
    pub dt: f64,
    /// Precision of state and forces.
    pub precision: Precision,
    /// The instructions; the widest set that there is if none.
    pub instruction_set: Option<InstructionSet>,
    /// How long, and how often something is written.
    pub run: Run,
    /// How many particles may be lost.
    pub(crate) most_lost: u64,
    /// Which files are written.
    pub output: Output,
    /// Whether each loss is written.
    pub losses: bool,
}

impl Default for Scene {
    fn default() -> Self {
        Scene {
            units: String::new(),
            domain: Domain::default(),
            start: Start::default(),
            law: PairLaw::Wca,
            parameters: Parameters::default(),
            bath: Bath { friction: 1.0, temperature: 1.0 },
            noise_seed: None,
            by: By::Auto,
            per_side: None,
            sort: SortKind::default(),
            skin: None,
            scheme: SchemeKind::Baoab,
            dt: 0.0,
            precision: Precision::F64,
            instruction_set: None,
            run: Run::default(),
            most_lost: 0,
            output: Output::default(),
            losses: true,
        }
    }
}

impl Scene {
    /// Meets every key of the method.
    pub(super) fn bind(&mut self, binding: &mut dyn Binding) {
        bind_heading(binding, &mut self.units, VOCABULARY.keys.method);
        self.domain.bind(binding);
        self.start.bind(binding);
        WallMotion::Fixed.bind(binding, &self.start);
        binding.choice(&LAW, &mut self.law);
        self.parameters.bind(self.law, binding);
        binding.number(&DRAG, &mut self.bath.friction);
        binding.number(&BATH_TEMPERATURE, &mut self.bath.temperature);
        binding.whole_if_any(&NOISE_SEED, &mut self.noise_seed);
        binding.choice(&SEARCH, &mut self.by);
        if matches!(self.by, By::Auto | By::Sectors) {
            binding.whole_if_any(&PER_SIDE, &mut self.per_side);
            binding.choice(&SORT, &mut self.sort);
        }
        if matches!(self.by, By::Auto | By::NeighborList) {
            binding.number_if_any(&SKIN, &mut self.skin);
        }
        binding.choice(&INTEGRATOR, &mut self.scheme);
        binding.number(&crate::scene::DT, &mut self.dt);
        bind_arithmetic(binding, &mut self.precision, &mut self.instruction_set);
        self.run.bind(binding, self.dt);
        binding.whole(&MOST_LOST, &mut self.most_lost);
        self.output.bind(binding);
        binding.switch(&LOSSES, &mut self.losses);
    }

    /// The law between particles of a diameter (length).
    pub(super) fn law_at(&self, diameter: f64) -> SweptLaw {
        self.law.of(&self.parameters, diameter)
    }

    /// The instructions of a run.
    pub(super) fn instructions(&self) -> InstructionSet {
        self.instruction_set.unwrap_or_else(InstructionSet::best)
    }

    /// The whole scene as TOML, defaults written out. Parsing it gives an equal scene.
    pub(super) fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }
}
