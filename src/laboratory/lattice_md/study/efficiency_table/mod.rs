//! Vector operations and clock periods of a step, by BP93's count (section 3) and from recorded programs.

mod conventions;
mod question;

pub(crate) use question::{
    TableFeatures, TableScene, TableSceneError, counting_model, programs_in_precision, programs_of_step,
    scene_model,
};

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::model::clock::{Clock, ProgramWork};
use crate::model::machine::MachineModel;
use crate::model::machines;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use conventions::conventions;
use stripmine_kernels::isa::{Op, OpClass, OpCounts};
use stripmine_kernels::ledger::{Ledger, VectorLength};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::printed::EQUATIONS;
use stripmine_physics::method::lattice_md::{GranularModel, Lengths, Part, ledger, programs};
use stripmine_physics::scene::Precision;

/// Parts of BP93's table. BP93 has no entry for the lattice vectors, nor for parts that only our program has.
pub(crate) const SOURCES_PARTS: [Part; 4] = [Part::Predictor, Part::Index, Part::Forces, Part::Corrector];
const PRINTED: [u64; 4] = [59, 12, 1656, 54];

/// BP93's NOP of a part.
pub(crate) fn printed_nop(part: Part) -> Option<u64> {
    SOURCES_PARTS.iter().position(|it| *it == part).map(|at| PRINTED[at])
}

/// Clock periods of a part by BP93's formula and its NOP.
pub(crate) fn printed_clocks(part: Part, machine: &MachineModel, discs: u64, cells: u64) -> Option<f64> {
    // Additions stand for operations of any kind, because every machine has them.
    let mut counts = OpCounts::default();
    (0..printed_nop(part)?).for_each(|_| counts.record(Op::Add));
    Some(Clock::Paper.clocks(machine, &counts.into(), if part == Part::Forces { cells } else { discs }))
}

/// Counts the default scene on the machine of the paper.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    Ok(efficiency_table(&TableScene::default(), &machines::preset("paper")?)?)
}

/// Counted programs of a text.
struct CountedText<'m> {
    ledger: Ledger,
    lengths: Lengths,
    machine: &'m MachineModel,
}

impl CountedText<'_> {
    fn of<'m>(question: &TableScene, machine: &'m MachineModel) -> Result<CountedText<'m>, TableSceneError> {
        let (programs, lengths) = programs_of_step(question)?;
        Ok(CountedText { ledger: ledger(&programs), lengths, machine })
    }

    fn n(&self, length: VectorLength) -> u64 {
        self.lengths.range(length).len() as u64
    }

    /// Parts, each with one vector length: name, operations, length, clock periods.
    fn rows(&self, clock: Clock) -> impl Iterator<Item = (&'static str, OpCounts, VectorLength, f64)> {
        self.ledger.parts().into_iter().map(move |(part, length, counts)| {
            let clocks = clock.clocks(self.machine, &ProgramWork::from(counts.clone()), self.n(length));
            (part, counts, length, clocks)
        })
    }

    /// Operations and clock periods of a part, or of the step; `None` for a part that the program lacks.
    fn sums(&self, part: Option<Part>) -> (Option<u64>, Option<f64>) {
        let rows = self.rows(Clock::Paper).filter(|(name, ..)| part.is_none_or(|part| part.name() == *name));
        let (nop, clocks) =
            rows.fold((0, 0.0), |(nop, sum), (_, counts, _, clocks)| (nop + counts.total(), sum + clocks));
        ((nop > 0).then_some(nop), (clocks != 0.0).then_some(clocks))
    }
}

/// Efficiency table of a scene on a machine.
pub(crate) fn efficiency_table(
    question: &TableScene,
    machine: &MachineModel,
) -> Result<FinishedItem, TableSceneError> {
    let source_question = question.printed();
    let texts = [CountedText::of(&source_question, machine)?, CountedText::of(question, machine)?];
    let [printed, ours] = &texts;
    let Lengths { discs, cells, .. } = ours.lengths;
    let (conventions, convention_numbers) = conventions(&source_question)?;
    let printed_clocks = |part| printed_clocks(part, machine, discs as u64, cells as u64);
    let rows = Part::ALL.iter().map(|&part| {
        let [(printed, printed_text), (ours, by_ours)] = texts.each_ref().map(|text| text.sums(Some(part)));
        (part.name(), [printed_nop(part), printed, ours], [printed_clocks(part), printed_text, by_ours])
    });
    let [(all_printed, clocks_printed), (all_ours, clocks_ours)] =
        texts.each_ref().map(|text| text.sums(None));
    let source: (u64, f64) = SOURCES_PARTS.iter().fold((0, 0.0), |(nop, clocks), &part| {
        (nop + printed_nop(part).unwrap_or(0), clocks + printed_clocks(part).unwrap_or(0.0))
    });
    let step =
        ("step", [Some(source.0), all_printed, all_ours], [Some(source.1), clocks_printed, clocks_ours]);
    let rows = rows.filter(|(_, nop, _)| nop.iter().any(Option::is_some)).chain([step]);
    let mut summary = FrameBuilder::of([()])
        .count("NP", |()| discs)
        .count("LMAX", |()| cells)
        .number("occupancy", 4, |()| discs as f64 / cells as f64)
        .text("machine", |()| machine.title())
        .number("clock period (ns)", 3, |()| machine.clock_period_ns())
        .number("clocks of the printed text on a scalar machine", 0, |()| {
            printed.rows(Clock::Scalar).map(|(.., clocks)| clocks).sum::<f64>()
        })
        .number("clocks of the four parts of the printed text", 0, |()| {
            SOURCES_PARTS.iter().filter_map(|&part| printed.sums(Some(part)).1).sum::<f64>()
        })
        .text("assumed numbers", |()| machine.assumed().join(", "));
    let names = ["ways", "give predictor", "give index", "give a place", "give corrector", "give all four"];
    for (name, count) in names.into_iter().chain(["most numbers of one way"]).zip(convention_numbers) {
        summary = summary.count(name, |()| count);
    }
    Ok(FinishedItem::of([
        FrameBuilder::of(rows)
            .text("part", |(part, ..)| *part)
            .cells(["printed in 1993", "printed text, counted", "ours, counted"], |(_, nop, _)| *nop)
            .cells(["clocks printed", "clocks, printed text", "clocks, ours"], |(.., clocks)| {
                clocks.map(|clocks| clocks.map(|clocks| TableCell::Number(clocks, 0)))
            })
            .frame("efficiency_table", "Operations and clock periods of one step"),
        conventions,
        force_sections(
            &source_question,
            "printed_sections",
            "Printed text: a place of the mask by equation",
        )?,
        force_sections(question, "force_sections", "Our text: operations of the forces")?,
        vector_lengths([("printed", printed), ("ours", ours)]),
        classes([&printed.ledger, &ours.ledger]),
        savings(question, machine)?,
        summary.frame("summary", "Scene, machine, and how many ways of counting give the printed numbers"),
    ]))
}

/// Operations of each section per cell and per offset, from sweeps over all offsets and over one.
fn force_sections(question: &TableScene, name: &str, title: &str) -> Result<ResultFrame, TableSceneError> {
    let tally = |model: &GranularModel| -> Vec<(&'static str, OpCounts)> {
        let forces = programs(model, Precision::F64).into_iter().filter(|step| step.part == Part::Forces);
        forces.flat_map(|step| step.program.tally()).collect()
    };
    let model = scene_model(question)?;
    let more = (model.mask.offsets().len() - 1) as u64;
    let all = tally(&model);
    let one = tally(&GranularModel { mask: Mask::single_offset(), ..model });
    let shifts = |counts: &OpCounts| counts.of_class(OpClass::Shift);
    // Section; operations per offset, shifts among these, operations per cell, total.
    let mut rows: Vec<(&str, [u64; 4])> = vec![];
    for (section, counts) in &all {
        let of_one = one.iter().find(|(name, _)| name == section).map(|(_, counts)| counts);
        let at_one = |count: fn(&OpCounts) -> u64| of_one.map_or(0, count);
        let in_a_place = (counts.total() - at_one(OpCounts::total)) / more;
        let shifts = (shifts(counts) - at_one(shifts)) / more;
        rows.push((section, [in_a_place, shifts, at_one(OpCounts::total) - in_a_place, counts.total()]));
    }
    let sums = [0, 1, 2, 3].map(|at| rows.iter().map(|(_, counts)| counts[at]).sum::<u64>());
    rows.push(("forces", sums));
    let equation =
        |section: &str| EQUATIONS.iter().find(|(known, _)| *known == section).map_or("", |it| it.1);
    Ok(FrameBuilder::of(rows)
        .text("section", |(section, _)| *section)
        .text("what it is", |(section, _)| equation(section))
        .cells(
            ["operations of a place", "of these shifted copies", "operations once a cell"],
            |(_, [place, shifts, once, _])| [*place, *shifts, *once],
        )
        .number("share of the forces (%)", 1, |(_, counts)| 100.0 * (counts[3] as f64 / sums[3] as f64))
        .frame(name, title))
}

fn vector_lengths(texts: [(&'static str, &CountedText<'_>); 2]) -> ResultFrame {
    let rows =
        texts.into_iter().flat_map(|(name, text)| text.rows(Clock::Paper).map(move |row| (name, text, row)));
    let moving = |counts: &OpCounts| counts.filtered(|op| op.class().moves_data()).total();
    FrameBuilder::of(rows)
        .text("text", |(name, ..)| *name)
        .text("part", |(.., (part, ..))| *part)
        .count("NOP", |(.., (_, counts, ..))| counts.total())
        .count("computing", |(.., (_, counts, ..))| counts.total() - moving(counts))
        .count("moving data", |(.., (_, counts, ..))| moving(counts))
        .text("n is", |(.., (_, _, length, _))| length.symbol())
        .count("n", |(_, text, (_, _, length, _))| text.n(*length))
        .number("clocks", 0, |(.., (.., clocks))| *clocks)
        .frame("vector_lengths", "Operations by the length of their vectors")
}

fn classes(ledgers: [&Ledger; 2]) -> ResultFrame {
    let of = |part: Part, class: OpClass| ledgers.map(|ledger| ledger.part(part.name()).of_class(class));
    let total =
        |class: OpClass| [0, 1].map(|text| Part::ALL.iter().map(|&part| of(part, class)[text]).sum::<u64>());
    let both = |name: &str| ["printed", "ours"].map(|text| format!("{name}, {text}"));
    let mut rows = FrameBuilder::of(OpClass::ALL.iter().copied().filter(|class| total(*class) != [0, 0]))
        .text("class", |class| class.name());
    for &part in Part::ALL {
        if OpClass::ALL.iter().any(|&class| of(part, class) != [0, 0]) {
            rows = rows.cells(both(part.name()), |&class| of(part, class));
        }
    }
    rows.cells(both("step"), |&class| total(class)).frame("operation_classes", "Counted operations by class")
}

/// The given scene, and simpler and more expensive scenes.
fn savings(question: &TableScene, machine: &MachineModel) -> Result<ResultFrame, TableSceneError> {
    let asked = question.choice;
    let variants = [
        ("as asked", asked),
        ("without friction", TableFeatures { frictionless: true, ..asked }),
        ("with equal discs", TableFeatures { equal_discs: true, ..asked }),
        (
            "without friction, with equal discs",
            TableFeatures { frictionless: true, equal_discs: true, ..asked },
        ),
        ("with 4 Gear values", TableFeatures { gear_values: 4, ..asked }),
        ("with 6 Gear values", TableFeatures { gear_values: 6, ..asked }),
        ("with positions relative to the cell", TableFeatures { cell_relative: true, ..asked }),
        ("with the 7×7 mask", TableFeatures { mask: 7, ..asked }),
    ];
    let variants = variants.into_iter().filter(|(name, choice)| *name == "as asked" || *choice != asked);
    let counted = |(name, choice)| Ok((name, CountedText::of(&TableScene { choice, ..*question }, machine)?));
    let variants = variants.map(counted).collect::<Result<Vec<_>, TableSceneError>>()?;
    let nop = |counted: &CountedText<'_>, part: Part| counted.ledger.part(part.name()).total();
    let clocks = |counted: &CountedText<'_>| counted.sums(None).1.unwrap_or(f64::NAN);
    let mut rows = FrameBuilder::of(&variants).text("scene", |(name, _)| *name);
    for &part in Part::ALL {
        if variants.iter().any(|(_, counted)| nop(counted, part) != 0) {
            rows = rows.count(format!("NOP {}", part.name()), |(_, counted)| nop(counted, part));
        }
    }
    Ok(rows
        .number("clocks a step", 0, |(_, counted)| clocks(counted))
        .number("relative", 3, |(_, counted)| clocks(counted) / clocks(&variants[0].1))
        .frame("savings", "Operations and clock periods of simpler scenes"))
}
