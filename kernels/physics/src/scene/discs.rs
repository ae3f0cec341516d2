//! Initial discs of a scene, generated, listed or read, and the motion of wall discs.

use super::binding::Binding;
use super::disc_keys::*;
use super::keys::{Key, KeyValue};
use super::speed::{Speed, bind_exactness};
use super::start_file::StartFile;
use crate::placement::Second;
use crate::words::define_words;
use std::path::Path;

define_words! {
    /// Kind of the initial placement.
    enum PlacementKind {
        /// At random.
        Random = "random",
        /// Placed small and grown while they move.
        Compressed = "compressed",
        /// At random sites of a mesh.
        Mesh = "mesh",
        /// On a hexagonal lattice.
        Hexagonal = "hexagonal",
        Pipe = "pipe",
        /// Above a floor.
        Box = "box",
        /// Listed one by one.
        List = "list",
        /// From a file.
        File = "file",
    }
}

/// Initial discs.
#[derive(Clone, Debug, PartialEq)]
pub enum DiscStart {
    /// Read from a file.
    File(StartFile),
    /// Listed one by one.
    List(List),
    /// On a hexagonal lattice, each shifted at random by at most 0.45 of the gap; the lattice determines the box.
    Hexagonal {
        /// Smallest number of discs.
        count: usize,
        /// N π R² over the area of the box.
        packing_fraction: f64,
        /// Properties of the discs.
        grains: GeneratedDiscs,
    },
    /// At random in the box, without overlap.
    Random {
        /// Number or packing fraction.
        amount: Amount,
        /// Properties of the discs.
        grains: GeneratedDiscs,
    },
    /// At random in the box, but small, then grown while they move and collide.
    Compressed {
        /// Number or packing fraction.
        amount: Amount,
        /// Properties of the discs.
        grains: GeneratedDiscs,
    },
    /// At random sites of a square mesh, at most one disc on each.
    Mesh {
        /// Number or packing fraction.
        amount: Amount,
        /// Properties of the discs.
        grains: GeneratedDiscs,
        /// Smallest distance of neighbouring sites (length).
        spacing: f64,
    },
    /// At random in a pipe along x between two rows of wall discs, the upper row shifted by half a spacing.
    Pipe {
        /// Number, or packing fraction in the clear channel.
        amount: Amount,
        /// Properties of the discs.
        grains: GeneratedDiscs,
        /// Wall discs.
        lining: WallLining,
        /// Width between the surfaces of the wall discs (length).
        clear_width: f64,
    },
    /// At random above a floor of wall discs.
    Box {
        /// Number, or packing fraction in the fill height.
        amount: Amount,
        /// Properties of the discs.
        grains: GeneratedDiscs,
        /// The floor.
        lining: WallLining,
        /// Height above the floor up to which discs are placed (length).
        fill_height: f64,
    },
}

impl Default for DiscStart {
    fn default() -> Self {
        DiscStart::Random { amount: Amount::default(), grains: GeneratedDiscs::default() }
    }
}

/// Number of discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Number itself.
    Count(usize),
    /// Packing fraction N π R² over the area open to the discs.
    PackingFraction(f64),
    /// Number and packing fraction, which determine the box.
    Both(usize, f64),
}

impl Default for Amount {
    fn default() -> Self {
        Amount::Count(0)
    }
}

/// Properties of generated discs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GeneratedDiscs {
    /// Mean radius (length).
    pub radius: f64,
    /// Standard deviation of the Gaussian radii, relative to the mean.
    pub spread: f64,
    /// Largest deviation of a radius, relative to the mean.
    pub cut: f64,
    /// Discs of a second mean radius among them.
    pub second: Second,
    /// Mass of a disc of the mean radius (mass); masses scale as (R/mean)².
    pub mass: f64,
    /// Velocities.
    pub speed: Speed,
    /// True if velocities are scaled to their temperature exactly.
    pub is_exact: bool,
    /// Seed of radii, positions and velocities.
    pub seed: u64,
}

/// Row of wall discs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallLining {
    /// Radius (length).
    pub radius: f64,
    /// Distance of neighbouring centres (length).
    pub spacing: f64,
}

/// Discs given one by one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct List {
    /// Centres of the grains (length).
    pub positions: Vec<[f64; 2]>,
    /// Velocities (length/time).
    pub velocities: Vec<[f64; 2]>,
    /// Angular velocities (1/time).
    pub(crate) omegas: Vec<f64>,
    /// Radii (length).
    pub radii: Vec<f64>,
    /// Masses (mass); by area if empty.
    pub masses: Vec<f64>,
    /// Radius (length) of a disc of mass `mass`.
    pub radius: f64,
    /// Mass of a disc of radius `radius`; masses scale as (R/radius)².
    pub mass: f64,
    /// Centres of the wall discs (length).
    pub(crate) wall_positions: Vec<[f64; 2]>,
    /// Radius of the wall discs (length).
    pub wall_radius: f64,
}

/// Common motion of the wall discs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WallMotion {
    /// At rest.
    #[default]
    Fixed,
    /// r(t) = r(0) + a sin(2π f t).
    Oscillating {
        /// Amplitude a (length).
        amplitude: [f64; 2],
        /// Frequency f (1/time).
        frequency: f64,
    },
}

impl WallMotion {
    /// Binds its keys if the start may have walls.
    pub fn bind(&mut self, binding: &mut dyn Binding, start: &DiscStart) {
        if matches!(
            start,
            DiscStart::Random { .. }
                | DiscStart::Compressed { .. }
                | DiscStart::Mesh { .. }
                | DiscStart::Hexagonal { .. }
        ) {
            return;
        }
        let (mut motion, mut amplitude, mut frequency) = match *self {
            WallMotion::Fixed => (WallMotionKind::Fixed, [0.0; 2], 0.0),
            WallMotion::Oscillating { amplitude, frequency } => {
                (WallMotionKind::Oscillating, amplitude, frequency)
            }
        };
        binding.choice(&WALL_MOTION, &mut motion);
        *self = match motion {
            WallMotionKind::Fixed => WallMotion::Fixed,
            WallMotionKind::Oscillating => {
                binding.pair(&WALL_AMPLITUDE, &mut amplitude);
                binding.number(&WALL_FREQUENCY, &mut frequency);
                WallMotion::Oscillating { amplitude, frequency }
            }
        };
    }
}

impl DiscStart {
    fn origin(&self) -> PlacementKind {
        match self {
            DiscStart::Random { .. } => PlacementKind::Random,
            DiscStart::Compressed { .. } => PlacementKind::Compressed,
            DiscStart::Mesh { .. } => PlacementKind::Mesh,
            DiscStart::Hexagonal { .. } => PlacementKind::Hexagonal,
            DiscStart::Pipe { .. } => PlacementKind::Pipe,
            DiscStart::Box { .. } => PlacementKind::Box,
            DiscStart::List(_) => PlacementKind::List,
            DiscStart::File(_) => PlacementKind::File,
        }
    }

    fn empty(origin: PlacementKind) -> DiscStart {
        let (amount, grains, lining) = (Amount::default(), GeneratedDiscs::default(), WallLining::default());
        match origin {
            PlacementKind::Random => DiscStart::Random { amount, grains },
            PlacementKind::Compressed => DiscStart::Compressed { amount, grains },
            PlacementKind::Mesh => DiscStart::Mesh { amount, grains, spacing: 0.0 },
            PlacementKind::Hexagonal => DiscStart::Hexagonal { count: 0, packing_fraction: 0.0, grains },
            PlacementKind::Pipe => DiscStart::Pipe { amount, grains, lining, clear_width: 0.0 },
            PlacementKind::Box => DiscStart::Box { amount, grains, lining, fill_height: 0.0 },
            PlacementKind::List => DiscStart::List(List::default()),
            PlacementKind::File => DiscStart::File(StartFile::default()),
        }
    }

    /// Binds its keys.
    pub fn bind(&mut self, binding: &mut dyn Binding) {
        let mut origin = self.origin();
        binding.choice(&GENERATE, &mut origin);
        if origin != self.origin() {
            *self = DiscStart::empty(origin);
        }
        match self {
            DiscStart::File(file) => file.bind(binding),
            DiscStart::List(list) => list.bind(binding),
            DiscStart::Hexagonal { count, packing_fraction, grains } => {
                binding.count(&COUNT, count);
                binding.number(&PACKING_FRACTION, packing_fraction);
                grains.bind(binding, false);
            }
            DiscStart::Random { amount, grains } | DiscStart::Compressed { amount, grains } => {
                amount.bind(binding);
                grains.bind(binding, true);
            }
            DiscStart::Mesh { amount, grains, spacing } => {
                amount.bind(binding);
                grains.bind(binding, false);
                bind_number_or(binding, &SPACING, spacing, 2.0 * grains.radius);
            }
            DiscStart::Pipe { amount, grains, lining, clear_width } => {
                amount.bind(binding);
                grains.bind(binding, true);
                lining.bind(binding, grains.radius);
                binding.number(&CLEAR_WIDTH, clear_width);
            }
            DiscStart::Box { amount, grains, lining, fill_height } => {
                amount.bind(binding);
                grains.bind(binding, true);
                lining.bind(binding, grains.radius);
                binding.number(&FILL_HEIGHT, fill_height);
            }
        }
    }

    /// Properties of drawn discs; none if the start is read or listed.
    pub(crate) fn drawn(&self) -> Option<&GeneratedDiscs> {
        match self {
            DiscStart::File(_) | DiscStart::List(_) => None,
            DiscStart::Hexagonal { grains, .. }
            | DiscStart::Random { grains, .. }
            | DiscStart::Compressed { grains, .. }
            | DiscStart::Mesh { grains, .. }
            | DiscStart::Pipe { grains, .. }
            | DiscStart::Box { grains, .. } => Some(grains),
        }
    }

    /// Seed of its random numbers; none if the start is listed, or read with its velocities.
    pub fn seed(&self) -> Option<u64> {
        match self {
            DiscStart::File(file) => file.supplied.speed.map(|_| file.supplied.seed),
            _ => self.drawn().map(|grains| grains.seed),
        }
    }

    /// Path of the start file, if there is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            DiscStart::File(file) => Some(file.path()),
            _ => None,
        }
    }
}

impl Amount {
    fn bind(&mut self, binding: &mut dyn Binding) {
        let (mut count, mut fraction) = match *self {
            Amount::Count(count) => (Some(count as u64), None),
            Amount::PackingFraction(fraction) => (None, Some(fraction)),
            Amount::Both(count, fraction) => (Some(count as u64), Some(fraction)),
        };
        if binding.reads() {
            (count, fraction) = (None, None);
        }
        binding.whole_if_any(&COUNT, &mut count);
        binding.number_if_any(&PACKING_FRACTION, &mut fraction);
        *self = match (fraction, count) {
            (Some(fraction), Some(count)) => Amount::Both(count as usize, fraction),
            (Some(fraction), None) => Amount::PackingFraction(fraction),
            (None, count) => Amount::Count(count.unwrap_or_default() as usize),
        };
    }
}

impl GeneratedDiscs {
    fn bind(&mut self, binding: &mut dyn Binding, spread: bool) {
        binding.number(&RADIUS, &mut self.radius);
        binding.number(&MASS, &mut self.mass);
        binding.whole(&SEED, &mut self.seed);
        let mut speed = Some(self.speed);
        Speed::bind(binding, &mut speed);
        self.speed = speed.unwrap_or_default();
        bind_exactness(binding, &mut self.is_exact);
        if spread {
            bind_number_or(binding, &SECOND_RADIUS, &mut self.second.radius, self.radius);
            binding.number(&SECOND_SHARE, &mut self.second.share);
            binding.number(&RADIUS_SPREAD, &mut self.spread);
            bind_number_or(binding, &RADIUS_CUT, &mut self.cut, (2.0 * self.spread).min(0.12));
        }
    }
}

/// Binds a number whose default depends on other values.
fn bind_number_or(binding: &mut dyn Binding, key: &'static Key, field: &mut f64, otherwise: f64) {
    match binding.meet(key, Some(KeyValue::Number(*field))) {
        Some(KeyValue::Number(value)) => *field = value,
        _ if binding.reads() => *field = otherwise,
        _ => {}
    }
}

impl WallLining {
    fn bind(&mut self, binding: &mut dyn Binding, grain: f64) {
        bind_number_or(binding, &WALL_RADIUS, &mut self.radius, 0.9 * grain);
        bind_number_or(binding, &WALL_SPACING, &mut self.spacing, 3.0 * self.radius);
    }
}

impl List {
    fn bind(&mut self, binding: &mut dyn Binding) {
        binding.number(&RADIUS, &mut self.radius);
        binding.number(&MASS, &mut self.mass);
        binding.pairs(&POSITIONS, &mut self.positions);
        if binding.reads() {
            let count = self.positions.len();
            (self.velocities, self.omegas) = (vec![[0.0; 2]; count], vec![0.0; count]);
            self.radii = vec![self.radius; count];
        }
        binding.pairs(&VELOCITIES, &mut self.velocities);
        binding.numbers(&OMEGAS, &mut self.omegas);
        binding.numbers(&RADII, &mut self.radii);
        let mut masses = Some(std::mem::take(&mut self.masses)).filter(|masses| !masses.is_empty());
        binding.numbers_if_any(&MASSES, &mut masses);
        self.masses = masses.unwrap_or_default();
        binding.pairs(&WALL_POSITIONS, &mut self.wall_positions);
        bind_number_or(binding, &WALL_RADIUS, &mut self.wall_radius, 0.9 * self.radius);
    }
}
