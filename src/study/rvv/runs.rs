//! Runs of emitted scenes under the emulator.

use crate::console::CommandFailure;
use crate::emission::{BuiltProgram, EmittedProgram, EmittedScene, Toolchain, differing, emit_scene};
use std::collections::BTreeMap;
use stripmine_kernels::emit::{GroupSize, Purpose};
use stripmine_physics::method::{METHODS, load};

/// Scenes: name, preset, overrides beside the number of particles, and the area of one, if the box has to follow their number.
pub(super) const SCENES: [(&str, &str, &[&str], Option<f64>); 6] = [
    ("grains, our program", "bench", &[], None),
    ("grains, linear springs", "bench", &["law.kind=linear"], None),
    ("grains, printed program", "dense-gas-printed", &[], None),
    ("Lennard-Jones", "langevin-dense", &["law.kind=lennard-jones"], Some(2.0)),
    ("WCA", "langevin-dense", &["law.kind=wca"], Some(2.0)),
    ("gravity", "plummer", &[], None),
];
/// Steps of every run.
const STEPS: u64 = 2;

/// Vector registers of a processor: their length, and how many form one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct VectorFile {
    /// Length of a register (bits).
    pub vlen: usize,
    pub size: GroupSize,
}

impl VectorFile {
    /// Registers of a CRAY-1: eight of 64 numbers.
    pub(super) const CRAY: VectorFile = VectorFile { vlen: 1024, size: GroupSize::Four };

    /// All files, those of one group size beside each other.
    pub(super) fn all() -> Vec<VectorFile> {
        let of = |size| [128, 256, 512, 1024].map(|vlen| VectorFile { vlen, size });
        GroupSize::ALL.into_iter().flat_map(of).collect()
    }

    /// Numbers in a register.
    pub(super) fn elements(self) -> usize {
        self.vlen / 64 * self.size.registers()
    }

    /// Strips of a vector of `n` elements.
    pub(super) fn strips(self, n: usize) -> u64 {
        n.div_ceil(self.elements()) as u64
    }
}

/// Sums over the runs with a register file.
#[derive(Clone, Debug, Default)]
pub(super) struct RunSums {
    pub runs: u64,
    pub bytes: u64,
    pub differing: u64,
    pub executed: u64,
    pub unexplained: u64,
    pub by_purpose: BTreeMap<Purpose, u64>,
}

impl RunSums {
    pub(super) fn add(&mut self, more: &RunSums) {
        self.runs += more.runs;
        self.bytes += more.bytes;
        self.differing += more.differing;
        self.executed += more.executed;
        self.unexplained += more.unexplained;
        for (purpose, count) in &more.by_purpose {
            *self.by_purpose.entry(*purpose).or_default() += count;
        }
    }
}

/// Operations of a section of a program: counted by the ledger, in the text, and executed.
#[derive(Clone, Debug)]
pub(super) struct SectionRow {
    pub scene: &'static str,
    pub program: String,
    pub section: &'static str,
    pub n: usize,
    /// Strips of all steps.
    pub strips: u64,
    pub ledger: u64,
    pub text: u64,
    pub by_purpose: BTreeMap<Purpose, u64>,
    /// Executed vector instructions by mnemonic.
    pub by_mnemonic: BTreeMap<String, u64>,
}

impl SectionRow {
    pub(super) fn executed(&self, purpose: Purpose) -> u64 {
        self.by_purpose.get(&purpose).copied().unwrap_or(0)
    }
}

/// Results of a scene with a number of particles.
#[derive(Clone, Debug, Default)]
pub(super) struct CaseRuns {
    /// Sums of each register file.
    pub sums: Vec<RunSums>,
    /// Rows of the file with the CRAY's registers; none without a trace.
    pub sections: Vec<SectionRow>,
    /// Number of programs.
    pub programs: usize,
}

/// Emits a scene with a number of particles.
///
/// # Errors
/// If the scene is invalid or has no code.
pub(super) fn emitted(scene: usize, count: usize, size: GroupSize) -> Result<EmittedScene, CommandFailure> {
    let (_, preset, overrides, area) = SCENES[scene];
    let mut overrides: Vec<String> = overrides.iter().map(|&it| it.to_owned()).collect();
    overrides.push(format!("particles.count={count}"));
    if let Some(side) = area.map(|area| (area * count as f64).sqrt()) {
        overrides.push(format!("domain.sides=[{side}, {side}]"));
    }
    let (prepared, _) = load(preset, &overrides, METHODS)?;
    Ok(emit_scene(preset, &prepared, size, STEPS)?)
}

/// Runs a scene with a number of particles on every register file. A trace counts its instructions.
///
/// # Errors
/// As [`emitted`], and if a tool fails.
pub(super) fn run_case(
    tools: &Toolchain,
    (scene, count): (usize, usize),
    traced: bool,
) -> Result<CaseRuns, CommandFailure> {
    let mut runs = CaseRuns::default();
    let mut built: Option<(EmittedScene, BuiltProgram)> = None;
    for file in VectorFile::all() {
        if built.as_ref().is_none_or(|(it, _)| it.size != file.size) {
            let emitted = emitted(scene, count, file.size)?;
            let program = tools.build(&emitted)?;
            built = Some((emitted, program));
        }
        let Some((emitted, program)) = &built else { continue };
        let found = program.execute(file.vlen, traced)?;
        let mut sum = RunSums {
            runs: 1,
            bytes: emitted.end.bytes.len() as u64,
            differing: differing(&found.bytes, &emitted.end.bytes) as u64,
            ..RunSums::default()
        };
        for (function, executed) in found.executed.iter().enumerate() {
            let it = &emitted.programs[function];
            sum.unexplained += unexplained(it, emitted.steps, file, program.mnemonics(function), executed);
            for (line, executed) in it.kernel.lines.iter().zip(executed) {
                sum.executed += executed;
                *sum.by_purpose.entry(line.purpose).or_default() += executed;
            }
            if file == VectorFile::CRAY {
                runs.sections.extend(section_rows(SCENES[scene].0, it, emitted.steps, executed));
            }
        }
        runs.programs = emitted.programs.len();
        runs.sums.push(sum);
    }
    Ok(runs)
}

/// Executed instructions of a function that do not follow from its text and the number of strips, and lines that a disassembler reads as others.
fn unexplained<'m>(
    it: &EmittedProgram,
    steps: u64,
    file: VectorFile,
    mnemonics: impl Iterator<Item = &'m str>,
    executed: &[u64],
) -> u64 {
    let lines = &it.kernel.lines;
    let (strips, last) = (file.strips(it.n), lines.len() - 1);
    let expected = (0..=last).map(|line| {
        steps
            * match line {
                0 => 1,
                // The return of a call without elements.
                1 => u64::from(it.n == 0),
                _ if it.n == 0 => 0,
                _ if line < it.kernel.start || line == last => 1,
                _ if line == last - 1 => strips - 1,
                _ => strips,
            }
    });
    let counts: u64 = expected.zip(executed).map(|(expected, executed)| expected.abs_diff(*executed)).sum();
    let texts = lines.iter().zip(mnemonics).filter(|(line, mnemonic)| line.mnemonic() != *mnemonic).count();
    counts + texts as u64 + lines.len().abs_diff(executed.len()) as u64
}

/// Rows of a program, one for each section in order of first use.
fn section_rows(scene: &'static str, it: &EmittedProgram, steps: u64, executed: &[u64]) -> Vec<SectionRow> {
    let of = |&(section, ledger): &(&'static str, u64)| SectionRow {
        scene,
        program: it.name.clone(),
        section,
        n: it.n,
        strips: steps * VectorFile::CRAY.strips(it.n),
        ledger,
        text: 0,
        by_purpose: BTreeMap::new(),
        by_mnemonic: BTreeMap::new(),
    };
    let mut rows: Vec<SectionRow> = it.ledger.iter().map(of).collect();
    for (line, executed) in it.kernel.lines.iter().zip(executed) {
        let section = line.instruction.map(|at| it.tape[at].section);
        let Some(row) = rows.iter_mut().find(|row| Some(row.section) == section) else { continue };
        row.text += u64::from(line.purpose == Purpose::Operation);
        *row.by_purpose.entry(line.purpose).or_default() += executed;
        if line.mnemonic().starts_with('v') {
            *row.by_mnemonic.entry(line.mnemonic().to_owned()).or_default() += executed;
        }
    }
    rows
}
