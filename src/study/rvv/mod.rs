//! Programs on a vector processor of others: RISC-V code under an emulator, its bits and its executed instructions beside ours.

mod picture;
mod runs;

use crate::console::CommandFailure;
use crate::emission::Toolchain;
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::model::clock::{Clock, ProgramWork};
use crate::model::machines;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use picture::strip_picture;
use runs::{CaseRuns, RunSums, SCENES, SectionRow, VectorFile, run_case};
use stripmine_kernels::emit::{FORMS, Form, GroupSize, Purpose};
use stripmine_physics::method::{METHODS, load};

/// Numbers of particles: vectors with tails of every kind.
const COUNTS: [usize; 20] =
    [30, 33, 37, 40, 44, 49, 51, 56, 60, 63, 64, 65, 71, 79, 88, 96, 100, 113, 127, 130];
/// Machines with measured times of instructions.
const SILICON: [&str; 5] = ["spacemit-a100", "spacemit-x60", "spacemit-x100", "xuantie-c908", "sifive-x280"];
/// Numbers of them whose instructions are counted.
const TRACED: usize = 2;

/// Says which tool of the item this machine lacks.
pub(super) fn missing_tools() -> Option<String> {
    Toolchain::find().err().map(|why| why.to_string())
}

/// Runs all scenes on all register files.
///
/// # Errors
/// If the tools are missing or fail, or a scene has no code.
pub(super) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let tools = Toolchain::find()?;
    let counts: &[usize] = if size == StudySize::Quick { &COUNTS[..1] } else { &COUNTS };
    let cases: Vec<(usize, usize)> =
        (0..SCENES.len()).flat_map(|scene| (0..counts.len()).map(move |at| (scene, at))).collect();
    let cases = ProgressMeter::new(cases.len() as f64, lab.progress)
        .run_cases(&cases, |&(scene, at)| run_case(&tools, (scene, counts[at]), at < TRACED))?;
    let files = VectorFile::all();
    let mut sums = vec![RunSums::default(); files.len()];
    for case in &cases {
        sums.iter_mut().zip(&case.sums).for_each(|(sum, more)| sum.add(more));
    }
    // Programs of a scene do not depend on its size.
    let programs: usize = cases.iter().step_by(counts.len()).map(|case| case.programs).sum();
    let sections: Vec<SectionRow> =
        cases.into_iter().flat_map(|CaseRuns { sections, .. }| sections).collect();
    let frames = [
        summary_frame(&tools, [programs, counts.len()], &sums, &sections),
        file_frame(&files, &sums),
        section_frame("equations", &forces(&sections)),
        section_frame("sections", &sections),
        mnemonic_frame(&sections),
        silicon_frame()?,
        form_frame("forms", FORMS.iter()),
        form_frame("expansion", FORMS.iter().filter(|form| form.code.len() > 1)),
    ];
    Ok(FinishedItem::of(frames).with_picture("strips", strip_picture(counts[0])?))
}

fn summary_frame(
    tools: &Toolchain,
    [programs, lengths]: [usize; 2],
    sums: &[RunSums],
    sections: &[SectionRow],
) -> ResultFrame {
    let mut all = RunSums::default();
    sums.iter().for_each(|sum| all.add(sum));
    let counted = |of: fn(&SectionRow) -> u64| sections.iter().map(of).sum::<u64>();
    FrameBuilder::of([()])
        .count("programs", |()| programs)
        .count("register files", |()| sums.len())
        .count("lengths", |()| lengths)
        .count("runs", |()| all.runs)
        .count("bytes compared", |()| all.bytes)
        .count("bytes that differ", |()| all.differing)
        .count("instructions", |()| all.executed)
        .count("unexplained instructions", |()| all.unexplained)
        .count("ledger", |()| counted(|it| it.ledger * it.strips))
        .count("executed", |()| counted(|it| it.executed(Purpose::Operation)))
        .number("address share", 1, |()| purpose_share(&all, Purpose::Address))
        .text("assembler", |()| tools.versions[0].clone())
        .text("emulator", |()| tools.versions[1].clone())
        .frame("summary", "Bits and instructions of all runs")
}

/// Share of the executed instructions with a purpose (percent).
fn purpose_share(sum: &RunSums, purpose: Purpose) -> f64 {
    let count = sum.by_purpose.get(&purpose).copied().unwrap_or(0);
    100.0 * count as f64 / (sum.executed as f64).max(1.0)
}

fn file_frame(files: &[VectorFile], sums: &[RunSums]) -> ResultFrame {
    FrameBuilder::of(files.iter().zip(sums))
        .count("VLEN", |(file, _)| file.vlen)
        .count("LMUL", |(file, _)| file.size.registers())
        .count("elements of a strip", |(file, _)| file.elements())
        .count("runs", |(_, sum)| sum.runs)
        .count("bytes that differ", |(_, sum)| sum.differing)
        .count("instructions", |(_, sum)| sum.executed)
        .count("unexplained", |(_, sum)| sum.unexplained)
        .cells(Purpose::ALL.map(|it| format!("{} (%)", it.name())), |(_, sum)| {
            Purpose::ALL.map(|it| TableCell::Number(purpose_share(sum, it), 1))
        })
        .frame("files", "Executed instructions by purpose")
}

/// Rows of the forces of the first scene and size.
fn forces(sections: &[SectionRow]) -> Vec<SectionRow> {
    let Some(first) = sections.iter().find(|it| it.program.starts_with("forces")) else { return vec![] };
    let is_shown = |it: &&SectionRow| (it.scene, &it.program, it.n) == (first.scene, &first.program, first.n);
    sections.iter().filter(is_shown).cloned().collect()
}

fn section_frame(name: &str, sections: &[SectionRow]) -> ResultFrame {
    FrameBuilder::of(sections)
        .text("scene", |it| it.scene)
        .text("program", |it| it.program.clone())
        .text("section", |it| it.section)
        .count("n", |it| it.n)
        .count("strips", |it| it.strips)
        .count("ledger", |it| it.ledger)
        .count("text", |it| it.text)
        .count("ledger × strips", |it| it.ledger * it.strips)
        .count("executed", |it| it.executed(Purpose::Operation))
        .count("expansion", |it| it.executed(Purpose::Expansion))
        .count("spills", |it| it.executed(Purpose::Spill))
        .frame(name, "Operations by equation, registers of 64 numbers")
}

fn mnemonic_frame(sections: &[SectionRow]) -> ResultFrame {
    let rows = sections.iter().flat_map(|it| it.by_mnemonic.iter().map(move |counted| (it, counted)));
    FrameBuilder::of(rows)
        .text("scene", |(it, _)| it.scene)
        .text("program", |(it, _)| it.program.clone())
        .text("section", |(it, _)| it.section)
        .count("n", |(it, _)| it.n)
        .text("mnemonic", |(_, (mnemonic, _))| mnemonic.as_str())
        .count("executed", |(_, (_, executed))| **executed)
        .frame("mnemonics", "Executed vector instructions by mnemonic and equation, registers of 64 numbers")
}

/// Time of a step of the default bench on processors with the vector extension, by the clock of whole registers.
///
/// # Errors
/// If the scene is invalid.
fn silicon_frame() -> Result<ResultFrame, CommandFailure> {
    let (prepared, _) = load(SCENES[0].1, &[], METHODS)?;
    let programs = prepared.model.programs();
    let works: Vec<(ProgramWork, u64, u64)> =
        programs.iter().map(|it| (ProgramWork::of(it.program.as_ref()), it.n as u64, it.times)).collect();
    let mut rows = vec![];
    for name in SILICON {
        let machine = machines::preset(name)?;
        let step = |clock: Clock, size: GroupSize| -> f64 {
            let machine = machine.with_group(size.registers());
            works.iter().map(|(work, n, times)| *times as f64 * clock.clocks(&machine, work, *n)).sum()
        };
        let periods = GroupSize::ALL.map(|size| step(Clock::WholeRegisters, size));
        rows.push((
            machine.title().to_owned(),
            periods,
            step(Clock::Operations, GroupSize::One),
            machine.clock_period_ns(),
        ));
    }
    Ok(FrameBuilder::of(rows)
        .text("machine", |(title, ..)| title.clone())
        .cells(
            GroupSize::ALL.map(|size| format!("LMUL {} (million periods)", size.registers())),
            |(_, periods, ..)| periods.map(|periods| TableCell::Number(1e-6 * periods, 3)),
        )
        .number("a period an element (million)", 3, |(_, _, operations, _)| 1e-6 * operations)
        .number("time, LMUL 4 (ms)", 2, |(_, periods, _, period)| 1e-6 * periods[2] * period)
        .frame("silicon", "A step of the default bench on processors with the vector extension"))
}

fn form_frame(name: &str, forms: impl Iterator<Item = &'static Form>) -> ResultFrame {
    FrameBuilder::of(forms)
        .text("operation", |form| form.op.mnemonic())
        .text("operands", |form| form.operands)
        .count("instructions", |form| form.code.len())
        .text("code", |form| form.code.join("; "))
        .frame(name, "RISC-V instructions of operations")
}
