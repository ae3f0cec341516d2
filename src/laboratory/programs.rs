//! Vector programs: operations of a step by section, and clock periods by every clock model.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::model::clock::{Clock, ProgramWork};
use crate::model::machine::MachineModel;
use crate::model::machines;
use crate::results::FinishedItem;
use stripmine_physics::method::{Prepared, SectionCounts, VectorProgram};

/// Machines whose clock periods an item shows.
const MACHINES: [&str; 2] = ["cray-y-mp-el", "sx-aurora"];

/// Operations of a step, and its time on some machines.
pub(crate) fn operation_frames(
    scene: &str,
    programs: &[VectorProgram],
    machines: &[MachineModel],
) -> [ResultFrame; 2] {
    let works: Vec<(ProgramWork, &VectorProgram)> =
        programs.iter().map(|it| (ProgramWork::of(it.program.as_ref()), it)).collect();
    let charged = |machine: &MachineModel, clock: Clock| -> f64 {
        let each = works.iter().map(|(work, it)| it.times as f64 * clock.clocks(machine, work, it.n as u64));
        each.sum()
    };
    let clocks = machines.iter().flat_map(|machine| {
        let charged = &charged;
        Clock::ALL.iter().map(move |&clock| (machine, clock, charged(machine, clock)))
    });
    [
        FrameBuilder::of(SectionCounts::of(programs))
            .text("part", |it| it.part)
            .text("section", |it| it.section)
            .text("n is", |it| it.length)
            .count("n", |it| it.n)
            .count("operations (NOP)", |it| it.operations)
            .count("of them computing", |it| it.computing)
            .count("divisions and roots", |it| it.divisions_and_roots)
            .count("flops", |it| it.flops)
            .count("bytes", |it| it.bytes)
            .number("flop a byte", 2, |it| (it.bytes > 0).then(|| it.intensity()))
            .frame("operations", format!("{scene}: whole-array operations of a step")),
        FrameBuilder::of(clocks)
            .text("machine", |(machine, ..)| machine.title())
            .text("clock", |(_, clock, _)| clock.name())
            .number("clock periods", 0, |(.., clocks)| *clocks)
            .number("ms", 3, |(machine, _, clocks)| 1e3 * (clocks * machine.clock_period_ns() * 1e-9))
            .frame("clocks", format!("{scene}: time of a step by every clock")),
    ]
}

/// Item with the frames of some scenes, numbered in their order, and the listing of the first program.
pub(crate) fn programs_item(scenes: &[(&str, Prepared)]) -> Result<FinishedItem, CommandFailure> {
    let machines: Vec<MachineModel> =
        MACHINES.iter().map(|name| machines::preset(name)).collect::<Result<_, _>>()?;
    let mut made = FinishedItem::default().with_seeds([1]);
    for (number, (scene, prepared)) in (1..).zip(scenes) {
        let programs = prepared.model.programs();
        let numbered = |frame: ResultFrame| ResultFrame { name: format!("{}-{number}", frame.name), ..frame };
        made.frames.extend(operation_frames(scene, &programs, &machines).map(numbered));
        if number == 1
            && let Some(first) = programs.first()
        {
            made = made.with_file("forces.txt", first.program.listing());
        }
    }
    Ok(made)
}
