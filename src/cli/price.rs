//! `stripmine price`: operations and clock periods of a kernel that another language has traced.

use crate::console::{CommandFailure, Common, print, print_json};
use crate::emission::{EmissionError, ListingTarget, listing_text};
use crate::frame::{FormattedTable, FrameBuilder, ResultFrame};
use crate::model::clock::{Clock, ProgramWork};
use crate::model::machine::MachineModel;
use crate::model::machines;
use crate::report::terminal;
use clap::Args;
use serde_json::Map;
use std::path::{Path, PathBuf};
use stripmine_kernels::Runnable;
use stripmine_kernels::own::{OwnProgram, TracedKernel};
use stripmine_physics::input::{InputErrors, MistakeKind, Spot, TextLocation, read_text};

/// Largest size of a file (bytes).
const LONGEST: u64 = 4 << 20;

/// Counts the operations of a kernel of your own, and its clock periods on vector machines
///
/// The kernel is a JSON file: names of its inputs, operations, and outputs, as `stripmine.trace` of the Python package makes it.
#[derive(Args)]
pub(super) struct PriceVerb {
    /// Kernel file
    kernel: PathBuf,
    /// Machine: a preset of `table`, or a machine file; can be repeated; default: all presets
    #[arg(long)]
    machine: Vec<String>,
    /// Length of the vectors
    #[arg(long, default_value_t = 1000)]
    elements: u64,
    /// Prints the vector instructions as an assembly listing instead
    #[arg(long)]
    listing: bool,
    #[command(flatten)]
    target: ListingTarget,
}

impl PriceVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        let program = read_kernel(&self.kernel)?;
        let runnable = program.runnable();
        if self.listing || self.target.size().is_some() {
            let text = listing_text("kernel", runnable, self.target.size());
            return print(&text.map_err(|cause| EmissionError::NoCode { part: "kernel", cause })?);
        }
        let names: Vec<&str> = match self.machine.as_slice() {
            [] => machines::names().collect(),
            some => some.iter().map(String::as_str).collect(),
        };
        let machines: Vec<MachineModel> = names.into_iter().map(machines::find).collect::<Result<_, _>>()?;
        let frames = [operation_frame(runnable), self.clock_frame(runnable, &machines)];
        if common.json {
            return print_json(&Map::from_iter(
                frames.iter().map(|frame| (frame.name.clone(), frame.json())),
            ));
        }
        print(&frames.each_ref().map(|frame| terminal::render(&FormattedTable::from(frame))).join("\n"))
    }

    fn clock_frame(&self, program: &dyn Runnable, machines: &[MachineModel]) -> ResultFrame {
        let work = ProgramWork::of(program);
        let rows = machines.iter().flat_map(|machine| {
            let charged = |clock: Clock| clock.clocks(machine, &work, self.elements);
            Clock::ALL.iter().map(move |&clock| (machine, clock, charged(clock)))
        });
        let rows: Vec<(&MachineModel, Clock, f64)> = rows.collect();
        FrameBuilder::of(rows)
            .text("machine", |(machine, ..)| machine.title())
            .text("clock", |(_, clock, _)| clock.name())
            .number("clock periods", 1, |(.., clocks)| *clocks)
            .short("time (s)", |(machine, _, clocks)| clocks * machine.clock_period_ns() * 1e-9)
            .frame("clocks", format!("Clock periods of {} elements", self.elements))
    }
}

fn operation_frame(program: &dyn Runnable) -> ResultFrame {
    FrameBuilder::of(program.tally())
        .text("section", |(section, _)| *section)
        .count("operations (NOP)", |(_, counts)| counts.total())
        .count("of them computing", |(_, counts)| counts.filtered(|op| !op.class().moves_data()).total())
        .frame("operations", "Operations on each element")
}

/// Reads and records a kernel.
///
/// # Errors
/// [`InputErrors`] names the file, and line and column of a syntax error.
fn read_kernel(path: &Path) -> Result<OwnProgram<TracedKernel>, InputErrors> {
    let file = path.display().to_string();
    let at = |place| Spot { file: file.clone(), place };
    let text = read_text(path, LONGEST, |cause| at(None).error(MistakeKind::System, cause.to_string()))?;
    let kernel: TracedKernel = serde_json::from_str(&text).map_err(|cause| {
        let place = TextLocation { line: cause.line() as u32, column: cause.column() as u32 };
        let place = (cause.line() > 0).then_some(place);
        at(place)
            .error(MistakeKind::Syntax, cause.to_string())
            .advising("make the file with stripmine.trace of the Python package")
    })?;
    Ok(OwnProgram::new(kernel).map_err(|cause| at(None).error(MistakeKind::Range, cause.to_string()))?)
}
