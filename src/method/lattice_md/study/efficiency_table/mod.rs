//! What does a step cost, by the source's count and by ours? BP93 section 3.

pub mod differences;

use crate::method::lattice_md::{
    Discs, GearValues, Lengths, Model, Part, Scheme, StepProgram, ledger, programs,
};
use crate::model::clock::{Clock, Work};
use crate::model::machine::MachineModel;
use differences::DifferenceRow;
use serde::Serialize;
use stripmine_kernels::isa::{Op, OpClass, OpCounts};
use stripmine_kernels::law::granular::{Contact, ContactArm, Disc};
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{Coordinates, Frame, LatticeShape, ShapeError};

/// What the table is made for.
#[derive(Clone, Debug)]
pub struct Question {
    /// NP.
    pub particles: usize,
    /// ρ = NP/LMAX.
    pub occupancy: f64,
    /// What is modelled.
    pub choice: Choice,
}

impl Default for Question {
    /// 1000 discs on 4000 cells, everything modelled that the source models.
    fn default() -> Self {
        Question { particles: 1000, occupancy: 0.25, choice: Choice::default() }
    }
}

/// What of the method a scene needs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// Friction, and with it rotation, torque and spin.
    pub friction: bool,
    /// Whether radii and masses differ.
    pub varying_discs: bool,
    /// Values of Gear's scheme.
    pub gear_values: usize,
    /// Half-width of the mask: 2 for 5×5, 3 for 7×7.
    pub mask_half_width: u32,
    /// Whether positions are relative to the cell.
    pub cell_relative: bool,
}

impl Default for Choice {
    /// The source's own scene: rough discs of different sizes, absolute positions, 24 places.
    fn default() -> Self {
        Choice {
            friction: true,
            varying_discs: true,
            gear_values: 5,
            mask_half_width: 2,
            cell_relative: false,
        }
    }
}

/// Why there is no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuestionError {
    /// An occupancy that no lattice has.
    #[error("an occupancy lies above 0 and at most at 1 (one disc a cell), not at {0}")]
    Occupancy(f64),
    /// No particles.
    #[error("a step needs at least one particle")]
    NoParticles,
    /// No lattice of that many cells.
    #[error("{particles} particles at occupancy {occupancy} make no lattice: {cause}")]
    Shape {
        /// NP.
        particles: usize,
        /// ρ.
        occupancy: f64,
        /// Why.
        cause: ShapeError,
    },
}

/// BP93's count of a part: NOP. The source has no entry for the lattice vectors.
pub const fn printed_nop(part: Part) -> Option<u64> {
    match part {
        Part::Predictor => Some(59),
        Part::Index => Some(12),
        Part::Lattice => None,
        Part::Forces => Some(1656),
        Part::Corrector => Some(54),
    }
}

/// BP93's vector length of a part.
fn printed_length(part: Part, lengths: &Lengths) -> u64 {
    (if part == Part::Forces { lengths.cells } else { lengths.discs }) as u64
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct EfficiencyTable {
    /// NP.
    pub particles: usize,
    /// LMAX: cells that discs may live in.
    pub cells: usize,
    /// ρ = NP/LMAX as it came out.
    pub occupancy: f64,
    /// Elements of each symbolic vector length.
    pub lengths: Vec<(&'static str, u64)>,
    /// What is modelled.
    pub choice: Choice,
    /// The machine whose clock is asked.
    pub machine: String,
    /// Its clock period (ns).
    pub clock_period_ns: f64,
    /// Numbers of the machine that are assumed.
    pub assumed: Vec<String>,
    /// A row for each part and vector length.
    pub parts: Vec<PartRow>,
    /// Clock periods of a step by the source's formula and its NOP; on the machine asked, with one pipeline depth.
    pub printed_clocks: f64,
    /// Clock periods of a step by the paper clock and our count.
    pub counted_clocks: f64,
    /// The same operations on a scalar machine.
    pub scalar_clocks: f64,
    /// What of predictor, index and corrector the source's count has.
    pub differences: Vec<DifferenceRow>,
    /// Where the operations of the forces go, for each mask place.
    pub force_sections: Vec<SectionRow>,
    /// Operations of each class in each part.
    pub classes: Vec<ClassRow>,
    /// What simpler scenes save.
    pub savings: Vec<SavingRow>,
}

/// A part of the step.
#[derive(Clone, Debug, Serialize)]
pub struct PartRow {
    /// The part.
    pub part: &'static str,
    /// NOP as printed, on the row of the part's main vector length.
    pub printed: Option<u64>,
    /// NOP as counted.
    pub counted: u64,
    /// Of these, operations that compute.
    pub computing: u64,
    /// Of these, loads, shifted copies, stores, gathers and scatters.
    pub moving: u64,
    /// Vector length, as a symbol.
    pub length: &'static str,
    /// Vector length.
    pub n: u64,
    /// Clock periods as the source has them.
    pub printed_clocks: Option<f64>,
    /// Clock periods of our count.
    pub counted_clocks: f64,
}

/// A section of the force computation.
#[derive(Clone, Debug, Serialize)]
pub struct SectionRow {
    /// The section.
    pub section: &'static str,
    /// Operations of the whole sweep.
    pub counted: u64,
    /// Operations for each place of the mask.
    pub each_place: f64,
    /// Of these, loads and shifted copies.
    pub loads_each_place: f64,
    /// Of these, quotients and square roots.
    pub divides_and_roots_each_place: f64,
    /// Share of all operations of the forces.
    pub share: f64,
}

/// A class of operations.
#[derive(Clone, Debug, Serialize)]
pub struct ClassRow {
    /// The class.
    pub class: &'static str,
    /// Operations in each part, in the order of the step.
    pub parts: Vec<u64>,
    /// Their sum.
    pub total: u64,
}

/// A variant of the scene.
#[derive(Clone, Debug, Serialize)]
pub struct SavingRow {
    /// What is different.
    pub variant: &'static str,
    /// NOP in each part, in the order of the step.
    pub parts: Vec<u64>,
    /// Clock periods of a step.
    pub clocks: f64,
    /// Clock periods relative to the scene asked.
    pub relative: f64,
}

/// A model with `choice` on a nearly square, periodic lattice of about `cells` cells.
///
/// Parameters that change no operation count are arbitrary.
///
/// # Errors
/// [`ShapeError`] if no such lattice exists.
pub fn counting_model(cells: usize, choice: Choice) -> Result<Model, ShapeError> {
    let columns = ((cells as f64).sqrt().round() as usize).max(1);
    let rows = cells.div_ceil(columns);
    let mask = Mask::square(choice.mask_half_width);
    let coordinates = if choice.cell_relative { Coordinates::CellRelative } else { Coordinates::Absolute };
    let disc = Disc { radius: 0.5, inverse_mass: 1.0 };
    Ok(Model {
        shape: LatticeShape::new(columns, rows, &mask, [true, true])?,
        frame: Frame { origin: [0.0, 0.0], edge: [0.5, 0.5] },
        sides: [columns, rows].map(|count| 0.5 * count as f64),
        mask,
        coordinates,
        contact: Contact {
            stiffness: 100.0,
            normal_damping: 1000.0,
            shear_damping: 300.0,
            friction: 0.5,
            cohesionless: true,
            arm: ContactArm::Radius,
        },
        friction: choice.friction,
        discs: if choice.varying_discs {
            Discs::Varying
        } else {
            Discs::Equal { disc, inverse_inertia: 8.0 }
        },
        scheme: Scheme::Gear(match choice.gear_values {
            4 => GearValues::Four,
            5 => GearValues::Five,
            _ => GearValues::Six,
        }),
        inertia_factor: 0.5,
        watch: None,
        dt: 1e-4,
        gravity: [9.81, 0.0],
    })
}

/// The programs of a step, and how long their vectors are, for a question.
///
/// # Errors
/// [`QuestionError`] if no such lattice exists.
pub fn step(question: &Question) -> Result<(Vec<StepProgram>, Lengths), QuestionError> {
    let &Question { particles, occupancy, choice } = question;
    if particles == 0 {
        return Err(QuestionError::NoParticles);
    }
    if !(occupancy > 0.0 && occupancy <= 1.0) {
        return Err(QuestionError::Occupancy(occupancy));
    }
    let cells = (particles as f64 / occupancy).ceil() as usize;
    let model = counting_model(cells, choice).map_err(|cause| QuestionError::Shape {
        particles,
        occupancy,
        cause,
    })?;
    let lengths = Lengths::new(&model, particles, particles);
    Ok((programs::<f64, f64>(&model), lengths))
}

/// The efficiency table of a question on a machine.
///
/// # Errors
/// [`QuestionError`] if no such lattice exists.
pub fn efficiency_table(
    question: &Question,
    machine: &MachineModel,
) -> Result<EfficiencyTable, QuestionError> {
    let (programs, lengths) = step(question)?;
    let ledger = ledger(&programs);
    let n = |length| lengths.range(length).len() as u64;
    let clocks = |counts: &OpCounts, n| Clock::Paper.clocks(machine, &counts.clone().into(), n);

    let mut parts: Vec<PartRow> = Vec::new();
    for (part, length, counts) in ledger.parts() {
        let named = Part::ALL.iter().copied().find(|known| known.name() == part);
        let main = match named {
            Some(Part::Forces) => length == Length::SweptCells,
            Some(Part::Index) => length == Length::Discs,
            Some(Part::Predictor | Part::Corrector) => length == Length::Grains,
            Some(Part::Lattice) | None => false,
        };
        let printed = named.filter(|_| main).and_then(printed_nop);
        let printed_n = named.map_or(0, |part| printed_length(part, &lengths));
        parts.push(PartRow {
            part,
            printed,
            counted: counts.total(),
            computing: counts.total() - moving(&counts),
            moving: moving(&counts),
            length: length.symbol(),
            n: n(length),
            printed_clocks: printed.map(|nop| clocks(&any_operations(nop), printed_n)),
            counted_clocks: clocks(&counts, n(length)),
        });
    }

    Ok(EfficiencyTable {
        particles: lengths.discs,
        cells: lengths.cells,
        occupancy: lengths.discs as f64 / lengths.cells as f64,
        lengths: [Length::Grains, Length::Discs, Length::SweptCells, Length::PaddedCells, Length::HaloCells]
            .map(|length| (length.symbol(), n(length)))
            .to_vec(),
        choice: question.choice,
        machine: machine.title().to_owned(),
        clock_period_ns: machine.clock_period_ns().value,
        assumed: machine.assumed(),
        printed_clocks: parts.iter().filter_map(|row| row.printed_clocks).sum(),
        counted_clocks: parts.iter().map(|row| row.counted_clocks).sum(),
        scalar_clocks: step_clocks(Clock::Scalar, &ledger, &lengths, machine),
        parts,
        differences: differences::differences(&ledger),
        force_sections: force_sections(&ledger, question.choice),
        classes: classes(&ledger),
        savings: savings(question, machine)?,
    })
}

/// `nop` operations of no particular kind: sums, which every machine has.
fn any_operations(nop: u64) -> OpCounts {
    let mut counts = OpCounts::default();
    (0..nop).for_each(|_| counts.record(Op::Add));
    counts
}

fn moving(counts: &OpCounts) -> u64 {
    OpClass::ALL.iter().filter(|class| class.moves_data()).map(|&class| counts.of_class(class)).sum()
}

fn step_clocks(clock: Clock, ledger: &Ledger, lengths: &Lengths, machine: &MachineModel) -> f64 {
    let parts = ledger.parts();
    parts
        .iter()
        .map(|(_, length, counts)| {
            clock.clocks(machine, &Work::from(counts.clone()), lengths.range(*length).len() as u64)
        })
        .sum()
}

fn force_sections(ledger: &Ledger, choice: Choice) -> Vec<SectionRow> {
    let forces = || ledger.entries().iter().filter(|entry| entry.part == Part::Forces.name());
    let total: u64 = forces().map(|entry| entry.counts.total()).sum();
    let places = Mask::square(choice.mask_half_width).offsets().len() as f64;
    let rows = forces().map(|entry| {
        let of = |classes: &[OpClass]| {
            classes.iter().map(|&class| entry.counts.of_class(class)).sum::<u64>() as f64
        };
        SectionRow {
            section: entry.section,
            counted: entry.counts.total(),
            each_place: entry.counts.total() as f64 / places,
            loads_each_place: of(&[OpClass::Load, OpClass::Shift]) / places,
            divides_and_roots_each_place: of(&[OpClass::Divide, OpClass::SquareRoot]) / places,
            share: entry.counts.total() as f64 / total as f64,
        }
    });
    rows.collect()
}

fn classes(ledger: &Ledger) -> Vec<ClassRow> {
    let rows = OpClass::ALL.iter().map(|&class| {
        let parts: Vec<u64> = Part::ALL.iter().map(|part| ledger.part(part.name()).of_class(class)).collect();
        ClassRow { class: class.name(), total: parts.iter().sum(), parts }
    });
    rows.filter(|row| row.total > 0).collect()
}

/// The scene asked, and scenes that need less or more.
fn savings(question: &Question, machine: &MachineModel) -> Result<Vec<SavingRow>, QuestionError> {
    let asked = question.choice;
    let variants = [
        ("as asked", asked),
        ("without friction", Choice { friction: false, ..asked }),
        ("with equal discs", Choice { varying_discs: false, ..asked }),
        ("without friction, with equal discs", Choice { friction: false, varying_discs: false, ..asked }),
        ("with 4 Gear values", Choice { gear_values: 4, ..asked }),
        ("with 6 Gear values", Choice { gear_values: 6, ..asked }),
        ("with positions relative to the cell", Choice { cell_relative: true, ..asked }),
        ("with the 7×7 mask", Choice { mask_half_width: 3, ..asked }),
    ];
    let mut rows: Vec<SavingRow> = Vec::new();
    for (variant, choice) in
        variants.into_iter().filter(|(name, choice)| *name == "as asked" || *choice != asked)
    {
        let (programs, lengths) = step(&Question { choice, ..question.clone() })?;
        let ledger = ledger(&programs);
        let clocks = step_clocks(Clock::Paper, &ledger, &lengths, machine);
        let reference = rows.first().map_or(clocks, |row| row.clocks);
        rows.push(SavingRow {
            variant,
            parts: Part::ALL.iter().map(|part| ledger.part(part.name()).total()).collect(),
            clocks,
            relative: clocks / reference,
        });
    }
    Ok(rows)
}
