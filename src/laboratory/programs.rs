//! What vector programs execute: operations section by section, and clock periods by every clock.

use crate::console::Failure;
use crate::model::clock::{Clock, Work};
use crate::model::machine::MachineModel;
use crate::model::machines;
use crate::report::{Cell, Rows, Section, Table, Verdict};
use crate::results::Made;
use serde::Serialize;
use stripmine_physics::method::{Counted, Prepared, VectorProgram};

/// Clock periods of a step.
#[derive(Clone, Debug, Serialize)]
pub struct Clocks {
    /// The machine.
    pub machine: String,
    /// The clock.
    pub clock: &'static str,
    /// Clock periods.
    pub clocks: f64,
    /// Seconds.
    pub seconds: f64,
}

/// The programs of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Programs {
    /// The scene.
    pub scene: String,
    /// What is executed.
    pub counted: Vec<Counted>,
    /// What it takes on machines.
    pub clocks: Vec<Clocks>,
    /// What there is to be said beside: that the scene itself is run otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl Programs {
    /// Counts the programs of a scene, and charges them by every clock of some machines.
    pub fn of(
        scene: &str,
        programs: &[VectorProgram],
        note: Option<String>,
        machines: &[MachineModel],
    ) -> Programs {
        let works: Vec<(Work, &VectorProgram)> =
            programs.iter().map(|it| (Work::of(it.program.as_ref()), it)).collect();
        let charged = |machine: &MachineModel, clock: Clock| {
            let each = |(work, it): &(Work, &VectorProgram)| {
                it.times as f64 * clock.clocks(machine, work, it.n as u64)
            };
            let clocks: f64 = works.iter().map(each).sum();
            Clocks {
                machine: machine.title().to_owned(),
                clock: clock.name(),
                clocks,
                seconds: clocks * machine.clock_period_ns().value * 1e-9,
            }
        };
        let clocks =
            machines.iter().flat_map(|machine| Clock::ALL.iter().map(|&clock| charged(machine, clock)));
        let clocks = clocks.collect();
        Programs { scene: scene.to_owned(), counted: Counted::of(programs), clocks, note }
    }

    /// Operations of a step.
    pub fn operations(&self) -> u64 {
        self.counted.iter().map(|it| it.operations).sum()
    }

    /// The tables.
    pub fn tables(&self) -> Vec<Table> {
        vec![self.operations_table(), self.clocks_table()]
    }

    fn operations_table(&self) -> Table {
        Rows::of(&self.counted)
            .text("part", |it| it.part)
            .text("section", |it| it.section)
            .text("n is", |it| it.length)
            .count("n", |it| it.n)
            .count("operations (NOP)", |it| it.operations)
            .count("of them computing", |it| it.computing)
            .count("divisions and roots", |it| it.divisions_and_roots)
            .table("operations", format!("{}: whole-array operations of a step", self.scene))
            .notes(self.note.clone())
    }

    fn clocks_table(&self) -> Table {
        Rows::of(&self.clocks)
            .text("machine", |it| &it.machine)
            .text("clock", |it| it.clock)
            .number("clock periods", 0, |it| it.clocks)
            .number("ms", 3, |it| 1e3 * it.seconds)
            .table("clocks", format!("{}: what a step of them takes", self.scene))
    }
}

/// Machines whose clock periods an item shows.
const MACHINES: [&str; 2] = ["cray-y-mp-el", "sx-aurora"];
/// Lines of a listing that an item shows.
const LINES: usize = 5;

/// Milliseconds as a person reads them.
fn milliseconds(clocks: Option<&Clocks>) -> String {
    let ms = clocks.map_or(f64::NAN, |it| 1e3 * it.seconds);
    if ms < 10.0 { format!("{ms:.2}") } else { format!("{ms:.0}") }
}

/// An item of the report: the programs of a method's scenes, by name.
///
/// # Errors
/// [`Failure`] if there is no such machine.
pub fn made(
    (name, title): (&str, &str),
    (question, expected): (&str, &str),
    scenes: &[(&str, Prepared)],
) -> Result<Made, Failure> {
    let machines: Vec<MachineModel> =
        MACHINES.iter().map(|name| machines::preset(name)).collect::<Result<_, _>>()?;
    let all: Vec<(Programs, Vec<VectorProgram>)> = scenes
        .iter()
        .map(|(scene, prepared)| {
            let programs = prepared.model.programs();
            (Programs::of(scene, &programs, prepared.model.programs_note(), &machines), programs)
        })
        .collect();
    let mut said = all.iter().map(|(counted, _)| {
        let of = |clock: Clock| counted.clocks.iter().find(|it| it.clock == clock.name());
        let [paper, ports] = [of(Clock::Paper), of(Clock::Ports)];
        format!(
            "{}: the forces take {} whole-array operations, {} ms by the source's clock on a {} and {} ms chained with memory ports.",
            counted.scene,
            Cell::Count(counted.operations()).for_reading(),
            milliseconds(paper),
            paper.map_or("machine", |it| it.machine.as_str()),
            milliseconds(ports),
        )
    });
    let excerpt = all.first().and_then(|(_, programs)| programs.first()).map(|it| {
        let listing = it.program.listing();
        let lines: Vec<&str> = listing.lines().take(LINES).collect();
        ("The first instructions of the forces".to_owned(), lines.join("\n"))
    });
    let tables = all.iter().enumerate().flat_map(|(at, (counted, _))| {
        let numbered = move |table: Table| Table { name: format!("{}-{}", table.name, at + 1), ..table };
        counted.tables().into_iter().map(numbered)
    });
    let section = Section::new(name, title)
        .asks(question)
        .expects(expected)
        .verdict(Verdict::Computed)
        .answers(said.next().unwrap_or_default())
        .details(said)
        .tables(tables)
        .excerpt(excerpt)
        .seeds([1]);
    let data: Vec<&Programs> = all.iter().map(|(counted, _)| counted).collect();
    Made::new(section, &data)
}
