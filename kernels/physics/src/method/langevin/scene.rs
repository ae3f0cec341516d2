//! Scene of Langevin dynamics as plain data.

use super::keys::*;
use super::laws::{LAW, PairLaw, Parameters, SweptLaw};
use super::options::{PairSearchKind, SchemeKind, SortKind};
use crate::scene::{
    Binding, DiscStart, Output, Precision, RunKeys, SceneDomain, WallMotion, Write, bind_arithmetic,
    bind_heading,
};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::integrator::langevin::Bath;

/// Scene of the method, in its own units; `units` names them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LangevinScene {
    /// Label of the unit system.
    pub units: String,
    /// The box.
    pub domain: SceneDomain,
    /// Particles at the start.
    pub start: DiscStart,
    /// Pair law.
    pub law: PairLaw,
    /// Parameters of the pair law.
    pub(super) parameters: Parameters,
    /// Friction and temperature of the bath.
    pub bath: Bath,
    /// Seed of the noise, if it differs from that of the start.
    pub(crate) noise_seed: Option<u64>,
    /// Pair search.
    pub by: PairSearchKind,
    /// Sectors along each side, if given.
    pub per_side: Option<u64>,
    /// Condition for sorting particles by sector.
    pub sort: SortKind,
    /// Skin of the lists beyond the cut-off (length), if given.
    pub skin: Option<f64>,
    /// Integrator.
    pub scheme: SchemeKind,
    /// Time step (time).
    pub dt: f64,
    /// Precision of state and forces.
    pub precision: Precision,
    /// Instruction set; the widest available if none.
    pub instruction_set: Option<InstructionSet>,
    /// Duration and output intervals.
    pub run: RunKeys,
    /// Number of particles that may be lost.
    pub(crate) most_lost: u64,
    /// Output files.
    pub output: Output,
    /// True if each loss is written.
    pub losses: bool,
}

impl Default for LangevinScene {
    fn default() -> Self {
        LangevinScene {
            units: String::new(),
            domain: SceneDomain::default(),
            start: DiscStart::default(),
            law: PairLaw::Wca,
            parameters: Parameters::default(),
            bath: Bath { friction: 1.0, temperature: 1.0 },
            noise_seed: None,
            by: PairSearchKind::Auto,
            per_side: None,
            sort: SortKind::default(),
            skin: None,
            scheme: SchemeKind::Baoab,
            dt: 0.0,
            precision: Precision::F64,
            instruction_set: None,
            run: RunKeys::default(),
            most_lost: 0,
            output: Output::default(),
            losses: true,
        }
    }
}

impl LangevinScene {
    /// Binds every key of the method.
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
        if matches!(self.by, PairSearchKind::Auto | PairSearchKind::Sectors) {
            binding.whole_if_any(&PER_SIDE, &mut self.per_side);
            binding.choice(&SORT, &mut self.sort);
        }
        if matches!(self.by, PairSearchKind::Auto | PairSearchKind::NeighborList) {
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

    /// Pair law between particles of a diameter (length).
    pub(super) fn law_at(&self, diameter: f64) -> SweptLaw {
        self.law.of(&self.parameters, diameter)
    }

    /// Instruction set of a run.
    pub(super) fn instructions(&self) -> InstructionSet {
        self.instruction_set.unwrap_or_else(InstructionSet::best)
    }

    /// Writes the whole scene as TOML, including defaults. Parsing it gives an equal scene.
    pub(super) fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }
}
