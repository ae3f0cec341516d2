//! What does a step cost, by the source's count and by ours? BP93 section 3.

pub mod conventions;
mod question;

pub use question::{Choice, Question, QuestionError, counting_model, step};

use crate::model::clock::{Clock, Work};
use crate::model::machine::MachineModel;
use conventions::Conventions;
use question::model_of;
use serde::Serialize;
use stripmine_kernels::isa::{Op, OpClass, OpCounts};
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_kernels::mask::Mask;
use stripmine_physics::method::lattice_md::{Lengths, Model, Part, ledger, programs};
use stripmine_physics::scene::Precision;

/// BP93's count of a part: NOP. The source has no entry for the lattice vectors.
pub const fn printed_nop(part: Part) -> Option<u64> {
    match part {
        Part::Predictor => Some(59),
        Part::Index => Some(12),
        // The source has no entry for the lattice vectors, nor for what is ours alone.
        Part::Box | Part::Halo | Part::Lattice => None,
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
    /// What the source prints, part by part.
    pub source: Vec<SourceRow>,
    /// Clock periods of a step by the source's formula and its NOP; on the machine asked, with one pipeline depth.
    pub source_clocks: f64,
    /// The source's own text, counted.
    pub printed: TextCount,
    /// The text asked, counted.
    pub ours: TextCount,
    /// Ways of counting, and what each makes of the parts.
    pub conventions: Conventions,
    /// Where the operations of the printed forces go, for each mask place.
    pub printed_sections: Vec<SectionRow>,
    /// The same of the text asked.
    pub force_sections: Vec<SectionRow>,
    /// Operations of each class in each part.
    pub classes: Vec<ClassRow>,
    /// What simpler scenes save.
    pub savings: Vec<SavingRow>,
}

/// A part as the source prints it.
#[derive(Clone, Debug, Serialize)]
pub struct SourceRow {
    /// The part.
    pub part: &'static str,
    /// NOP.
    pub nop: u64,
    /// n.
    pub n: u64,
    /// NOP·(n + D).
    pub clocks: f64,
}

/// What the programs of a text execute in a step.
#[derive(Clone, Debug, Serialize)]
pub struct TextCount {
    /// A row for each part and vector length.
    pub parts: Vec<PartRow>,
    /// Clock periods of a step by the source's clock.
    pub clocks: f64,
    /// The same operations on a scalar machine.
    pub scalar_clocks: f64,
}

impl TextCount {
    /// Operations of a part, whatever the length of its vectors.
    pub fn of(&self, part: Part) -> u64 {
        self.parts.iter().filter(|row| row.part == part.name()).map(|row| row.counted).sum()
    }

    /// Clock periods of the parts that the source has.
    pub fn clocks_of_the_sources_parts(&self) -> f64 {
        let known = |row: &&PartRow| SOURCES_PARTS.iter().any(|part| part.name() == row.part);
        self.parts.iter().filter(known).map(|row| row.clocks).sum()
    }
}

/// The parts of the source's table.
pub const SOURCES_PARTS: [Part; 4] = [Part::Predictor, Part::Index, Part::Forces, Part::Corrector];

/// A part of the step over vectors of one length.
#[derive(Clone, Debug, Serialize)]
pub struct PartRow {
    /// The part.
    pub part: &'static str,
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
    /// Clock periods.
    pub clocks: f64,
}

/// A section of the force computation.
#[derive(Clone, Debug, Serialize)]
pub struct SectionRow {
    /// The section.
    pub section: &'static str,
    /// Operations of a place of the mask.
    pub in_a_place: u64,
    /// Of these, shifted copies.
    pub shifts_in_a_place: u64,
    /// Operations beside the places, once a cell.
    pub once: u64,
    /// Share of all operations of the forces.
    pub share: f64,
}

/// A class of operations.
#[derive(Clone, Debug, Serialize)]
pub struct ClassRow {
    /// The class.
    pub class: &'static str,
    /// Operations in each part of the step in its order, of the printed text and of the one asked.
    pub parts: Vec<[u64; 2]>,
    /// Their sums.
    pub total: [u64; 2],
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

/// The efficiency table of a question on a machine.
///
/// # Errors
/// [`QuestionError`] if no such lattice exists.
pub fn efficiency_table(
    question: &Question,
    machine: &MachineModel,
) -> Result<EfficiencyTable, QuestionError> {
    let source_question = Question { choice: question.choice.printed(), ..question.clone() };
    let (printed_programs, _) = step(&source_question)?;
    let (programs, lengths) = step(question)?;
    let (printed, ours) = (ledger(&printed_programs), ledger(&programs));
    let source: Vec<SourceRow> = SOURCES_PARTS
        .iter()
        .filter_map(|&part| {
            let (nop, n) = (printed_nop(part)?, printed_length(part, &lengths));
            let clocks = Clock::Paper.clocks(machine, &any_operations(nop).into(), n);
            Some(SourceRow { part: part.name(), nop, n, clocks })
        })
        .collect();
    Ok(EfficiencyTable {
        particles: lengths.discs,
        cells: lengths.cells,
        occupancy: lengths.discs as f64 / lengths.cells as f64,
        lengths: [Length::Grains, Length::Discs, Length::SweptCells, Length::PaddedCells, Length::HaloCells]
            .map(|length| (length.symbol(), lengths.range(length).len() as u64))
            .to_vec(),
        choice: question.choice,
        machine: machine.title().to_owned(),
        clock_period_ns: machine.clock_period_ns().value,
        assumed: machine.assumed(),
        source_clocks: source.iter().map(|row| row.clocks).sum(),
        source,
        conventions: conventions::conventions(&source_question)?,
        printed_sections: force_sections(&source_question)?,
        force_sections: force_sections(question)?,
        classes: classes([&printed, &ours]),
        printed: text_count(&printed, &lengths, machine),
        ours: text_count(&ours, &lengths, machine),
        savings: savings(question, machine)?,
    })
}

fn text_count(ledger: &Ledger, lengths: &Lengths, machine: &MachineModel) -> TextCount {
    let n = |length| lengths.range(length).len() as u64;
    let parts = ledger.parts().into_iter().map(|(part, length, counts)| PartRow {
        part,
        counted: counts.total(),
        computing: counts.total() - moving(&counts),
        moving: moving(&counts),
        length: length.symbol(),
        n: n(length),
        clocks: Clock::Paper.clocks(machine, &counts.into(), n(length)),
    });
    let parts: Vec<PartRow> = parts.collect();
    TextCount {
        clocks: parts.iter().map(|row| row.clocks).sum(),
        scalar_clocks: step_clocks(Clock::Scalar, ledger, lengths, machine),
        parts,
    }
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

/// What a section does once, and what it does at a place, by the sweeps over all places and over one.
fn force_sections(question: &Question) -> Result<Vec<SectionRow>, QuestionError> {
    let tally = |model: &Model| -> Vec<(&'static str, OpCounts)> {
        let forces = programs(model, Precision::F64).into_iter().filter(|step| step.part == Part::Forces);
        forces.flat_map(|step| step.program.tally()).collect()
    };
    let model = model_of(question)?;
    let more = (model.mask.offsets().len() - 1) as u64;
    let all = tally(&model);
    let one = tally(&Model { mask: Mask::one_place(), ..model });
    let total: u64 = all.iter().map(|(_, counts)| counts.total()).sum();
    let rows = all.iter().map(|(section, counts)| {
        let of_one = one.iter().find(|(name, _)| name == section).map(|(_, counts)| counts);
        let at_one = |count: fn(&OpCounts) -> u64| of_one.map_or(0, count);
        let shifts = |counts: &OpCounts| counts.of_class(OpClass::Shift);
        let in_a_place = (counts.total() - at_one(OpCounts::total)) / more;
        SectionRow {
            section,
            in_a_place,
            shifts_in_a_place: (shifts(counts) - at_one(shifts)) / more,
            once: at_one(OpCounts::total) - in_a_place,
            share: counts.total() as f64 / total as f64,
        }
    });
    Ok(rows.collect())
}

fn classes(ledgers: [&Ledger; 2]) -> Vec<ClassRow> {
    let rows = OpClass::ALL.iter().map(|&class| {
        let of = |part: &Part| ledgers.map(|ledger| ledger.part(part.name()).of_class(class));
        let parts: Vec<[u64; 2]> = Part::ALL.iter().map(of).collect();
        let total = [0, 1].map(|text| parts.iter().map(|counts| counts[text]).sum());
        ClassRow { class: class.name(), total, parts }
    });
    rows.filter(|row| row.total != [0, 0]).collect()
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
