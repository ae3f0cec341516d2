//! The options that say what is modelled.

use crate::laboratory::lattice_md::study::efficiency_table::{Choice, Question};
use clap::Args;
use stripmine_physics::method::lattice_md::ProgramText;
use stripmine_physics::words::Words;

/// How many particles, how dense, and what is modelled.
#[derive(Args, Clone, Debug)]
pub(super) struct SceneChoice {
    /// Number of particles NP
    #[arg(long, default_value_t = 1000)]
    particles: usize,
    /// Occupancy of the lattice: particles for each cell, above 0 and at most 1
    #[arg(long, default_value_t = 0.25)]
    occupancy: f64,
    /// Whose programs: ours, or the source's own as printed
    #[arg(long, default_value = "ours", value_parser = ProgramText::WORDS.to_vec())]
    text: String,
    /// Leave out friction, and with it rotation
    #[arg(long, conflicts_with = "text")]
    frictionless: bool,
    /// All discs alike: radius and mass are numbers, not vectors
    #[arg(long, conflicts_with = "text")]
    equal_discs: bool,
    /// Values of Gear's scheme
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u8).range(4..=6))]
    gear_values: u8,
    /// Width of the mask: 5 (24 places) or 7 (48)
    #[arg(long, default_value = "5", value_parser = ["5", "7"])]
    mask: String,
    /// Positions relative to the cell instead of the origin
    #[arg(long, conflicts_with = "text")]
    cell_relative: bool,
}

impl SceneChoice {
    /// The question these options ask.
    pub(super) fn question(&self) -> Question {
        let choice = self.choice();
        let is_printed = ProgramText::parse(&self.text) == Some(ProgramText::Printed);
        Question {
            particles: self.particles,
            occupancy: self.occupancy,
            choice: if is_printed { choice.printed() } else { choice },
        }
    }

    fn choice(&self) -> Choice {
        Choice {
            friction: !self.frictionless,
            varying_discs: !self.equal_discs,
            gear_values: self.gear_values.into(),
            mask_half_width: if self.mask == "7" { 3 } else { 2 },
            cell_relative: self.cell_relative,
            ..Choice::default()
        }
    }
}
