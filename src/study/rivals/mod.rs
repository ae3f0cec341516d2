//! Comparison with other programs, on the same scenes and the same core.
//!
//! These programs are not available everywhere, so scripts in `tests/rivals/` measure them. Their latest results are shipped in
//! `measured/`, with date, host and commit.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::provenance::RepeatedMeasurement;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::statistics::median;
use serde::Deserialize;

/// Results of the scripts: script, contests, and their provenance.
const MEASURED: [(&str, &str, &str); 4] = [
    (
        "lammps.py",
        include_str!("measured/granular/contests.json"),
        include_str!("measured/granular/provenance.json"),
    ),
    (
        "langevin.py",
        include_str!("measured/langevin/contests.json"),
        include_str!("measured/langevin/provenance.json"),
    ),
    (
        "particular.py",
        include_str!("measured/particular/contests.json"),
        include_str!("measured/particular/provenance.json"),
    ),
    ("edmd.py", include_str!("measured/edmd/contests.json"), include_str!("measured/edmd/provenance.json")),
];

/// Contests with another program.
#[derive(Clone, Debug, Deserialize)]
struct RivalProgram {
    rival: String,
    version: String,
    build: String,
    /// Instruction set of our build.
    instruction_set: String,
    unit: String,
    contests: Vec<Contest>,
    /// Quantities that must agree between both programs.
    same: Vec<AgreedQuantity>,
    /// Peak memory of both programs, where it was measured.
    #[serde(default)]
    memory: Vec<PeakMemory>,
    /// Provenance, stored in a file of its own.
    #[serde(skip)]
    source: RepeatedMeasurement,
}

/// Timings of one system, ours and theirs in alternation.
#[derive(Clone, Debug, Deserialize)]
struct Contest {
    system: String,
    particles: u64,
    /// Search, precision and integrator of ours.
    configuration: String,
    /// Rates of each round.
    ours: Vec<f64>,
    theirs: Vec<f64>,
    /// Ratios of our rate to theirs in each round.
    ratios: Vec<f64>,
}

/// A quantity that both programs computed.
#[derive(Clone, Debug, Deserialize)]
struct AgreedQuantity {
    what: String,
    ours: f64,
    theirs: f64,
    within: f64,
}

/// Peak memory of both programs, in bytes.
#[derive(Clone, Debug, Deserialize)]
struct PeakMemory {
    system: String,
    particles: u64,
    ours: u64,
    theirs: u64,
}

impl Contest {
    fn ratio(&self) -> f64 {
        median(self.ratios.iter().copied())
    }

    fn lowest(&self) -> f64 {
        self.ratios.iter().copied().fold(f64::NAN, f64::min)
    }

    fn highest(&self) -> f64 {
        self.ratios.iter().copied().fold(f64::NAN, f64::max)
    }

    fn packing_fraction(&self) -> Option<f64> {
        self.system.split("packing fraction ").nth(1)?.parse().ok()
    }
}

/// Reads all contests.
fn rivals() -> Result<Vec<RivalProgram>, CommandFailure> {
    let read = |(script, contests, source): &(&str, &str, &str)| {
        let wrong =
            |cause: serde_json::Error| CommandFailure::writing(format!("contests of {script}"))(cause.into());
        let rival: RivalProgram = serde_json::from_str(contests).map_err(wrong)?;
        Ok(RivalProgram { source: serde_json::from_str(source).map_err(wrong)?, ..rival })
    };
    MEASURED.iter().map(read).collect()
}

/// Returns the contests as the scripts measured them.
///
/// # Errors
/// Fails if a shipped file is not in the format of the scripts.
pub(crate) fn made(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let all = rivals()?;
    let repeated = all.iter().map(|rival| rival.source.clone()).collect();
    Ok(FinishedItem {
        repeated,
        ..FinishedItem::of([
            contests(&all),
            fastest(&all),
            same(&all),
            memory(&all),
            programs(&all),
            summary(&all),
        ])
    })
}

fn contests(all: &[RivalProgram]) -> ResultFrame {
    let middle = |rates: &[f64]| median(rates.iter().copied());
    FrameBuilder::of(all.iter().flat_map(|rival| rival.contests.iter().map(move |it| (rival, it))))
        .text("beside", |(rival, _)| &rival.rival)
        .text("system", |(_, it)| &it.system)
        .count("particles", |(_, it)| it.particles)
        .text("our configuration", |(_, it)| &it.configuration)
        .number("ours", 2, |(_, it)| middle(&it.ours))
        .number("theirs", 2, |(_, it)| middle(&it.theirs))
        .number("ratio", 2, |(_, it)| it.ratio())
        .number("lowest", 2, |(_, it)| it.lowest())
        .number("highest", 2, |(_, it)| it.highest())
        .frame("contests", "Rates of both, medians over the rounds")
}

/// Our fastest configuration in each precision, for each system and size.
fn fastest(all: &[RivalProgram]) -> ResultFrame {
    let mut best: Vec<(&RivalProgram, &str, &Contest)> = vec![];
    for rival in all {
        for precision in ["f64", "f32"] {
            for it in rival.contests.iter().filter(|it| it.configuration.contains(precision)) {
                let alike = |known: &&mut (&RivalProgram, &str, &Contest)| {
                    (&known.0.rival, known.1, &known.2.system, known.2.particles)
                        == (&rival.rival, precision, &it.system, it.particles)
                };
                match best.iter_mut().find(alike) {
                    Some(known) if known.2.ratio() < it.ratio() => known.2 = it,
                    Some(_) => {}
                    None => best.push((rival, precision, it)),
                }
            }
        }
    }
    FrameBuilder::of(best)
        .text("beside", |(rival, ..)| &rival.rival)
        .text("kind", |(.., it)| it.system.split(',').next().unwrap_or_default())
        .text("system", |(.., it)| &it.system)
        .number("packing fraction", 2, |(.., it)| it.packing_fraction())
        .text("precision", |(_, precision, _)| *precision)
        .count("particles", |(.., it)| it.particles)
        .text("our configuration", |(.., it)| &it.configuration)
        .number("ratio", 2, |(.., it)| it.ratio())
        .number("lowest", 2, |(.., it)| it.lowest())
        .number("highest", 2, |(.., it)| it.highest())
        .frame("fastest", "Our rate over theirs, for our fastest configuration")
}

fn same(all: &[RivalProgram]) -> ResultFrame {
    FrameBuilder::of(all.iter().flat_map(|rival| rival.same.iter().map(move |it| (rival, it))))
        .text("beside", |(rival, _)| &rival.rival)
        .text("quantity", |(_, it)| &it.what)
        .number("ours", 6, |(_, it)| it.ours)
        .number("theirs", 6, |(_, it)| it.theirs)
        .short("may differ by", |(_, it)| it.within)
        .frame("same-physics", "Quantities that both programs compute")
}

fn memory(all: &[RivalProgram]) -> ResultFrame {
    FrameBuilder::of(all.iter().flat_map(|rival| rival.memory.iter().map(move |it| (rival, it))))
        .text("beside", |(rival, _)| &rival.rival)
        .text("system", |(_, it)| &it.system)
        .count("particles", |(_, it)| it.particles)
        .number("ours (MB)", 0, |(_, it)| 1e-6 * it.ours as f64)
        .number("theirs (MB)", 0, |(_, it)| 1e-6 * it.theirs as f64)
        .frame("memory", "Peak memory of both programs")
}

fn summary(all: &[RivalProgram]) -> ResultFrame {
    let same = all.iter().flat_map(|rival| &rival.same);
    let differ = same.filter(|it| (it.ours - it.theirs).abs() > it.within).count();
    FrameBuilder::of([differ])
        .count("quantities that differ", |differ| *differ)
        .frame("summary", "Quantities that should agree between both programs but do not")
}

fn programs(all: &[RivalProgram]) -> ResultFrame {
    FrameBuilder::of(all)
        .text("program", |it| &it.rival)
        .text("version", |it| &it.version)
        .text("build", |it| &it.build)
        .text("our instructions", |it| &it.instruction_set)
        .text("unit of the rates", |it| &it.unit)
        .text("host", |it| &it.source.host)
        .text("measured on", |it| &it.source.date)
        .text("our commit", |it| &it.source.commit)
        .frame("programs", "Programs, their builds, and when they were measured")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_programs_compute_the_same_physics() {
        for rival in rivals().unwrap() {
            assert!(!rival.contests.is_empty(), "{}", rival.rival);
            for it in &rival.contests {
                assert!(it.ratios.len() >= 2 && it.ours.len() == it.theirs.len(), "{it:?}");
            }
            for same in &rival.same {
                assert!((same.ours - same.theirs).abs() <= same.within, "{}: {same:?}", rival.rival);
            }
            let RepeatedMeasurement { date, commit, command, host } = &rival.source;
            assert!(!date.is_empty() && !host.is_empty() && command.contains("tests/rivals/"), "{rival:?}");
            assert!(!commit.contains("dirty"), "{} was measured with a changed source", rival.rival);
        }
    }
}
