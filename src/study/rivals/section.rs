//! The page of the rivals.

use super::{Contest, Rival, rivals};
use crate::console::Failure;
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};
use crate::results::Made;
use crate::statistics::median;
use stripmine_physics::number::range;

/// What the item is called.
pub const NAME: &str = "rivals";

/// Aims of our own: a word of the system, a word of our way, and how many times as fast ours is to be.
const AIMS: [(&str, &str, f64); 3] =
    [("Langevin", "f64", 5.0), ("all-pairs", "f32", 13.0 / 4.0), ("all-pairs", "f64", 5.0 / 1.26)];

/// Programs that compute in double precision only, whatever ours computes in.
const DOUBLE_ONLY: [&str; 1] = ["LAMMPS"];

/// The item.
///
/// # Errors
/// If a shipped file is not what the scripts write.
pub fn made() -> Result<Made, Failure> {
    let data = rivals()?;
    Made::new(section(&data), &data)
}

fn ratio(contest: &Contest) -> f64 {
    median(contest.ratios.iter().copied())
}

/// The lowest or the highest ratio over the rounds.
fn end(contest: &Contest, start: f64, pick: fn(f64, f64) -> f64) -> f64 {
    contest.ratios.iter().copied().fold(start, pick)
}

/// The lowest and the highest ratio of the contests of an aim; none if there are none.
fn ratios_of(data: &[Rival], (system, way, _): &(&str, &str, f64)) -> Option<[f64; 2]> {
    let contests = data.iter().flat_map(|rival| &rival.contests);
    let of = contests.filter(|it| it.system.contains(system) && it.way.contains(way)).map(ratio);
    of.fold(None, |ends, ratio| match ends {
        None => Some([ratio; 2]),
        Some([low, high]) => Some([low.min(ratio), high.max(ratio)]),
    })
}

fn section(data: &[Rival]) -> Section {
    let met = |aim: &&(&str, &str, f64)| ratios_of(data, aim).is_some_and(|[low, _]| low >= aim.2);
    let aims = AIMS.iter().map(|aim| format!("{} {} {:.1}", aim.0, aim.1, aim.2));
    Section::new(NAME, "Beside other programs")
        .asks("How many times as fast as other programs is ours, on the same system and one core?")
        .expects(format!(
            "Our aims, times as fast: {}. For granular and hard discs none is stated.",
            aims.collect::<Vec<_>>().join(", ")
        ))
        .answers(answer(data))
        .verdict(Verdict::aim(AIMS.iter().all(|aim| met(&aim))))
        .details(details(data))
        .figures([figure(data)])
        .tables([contests(data), same(data)])
}

/// The contest of the fastest of our ways in a precision, one for each system and size.
fn best<'r>(rival: &'r Rival, precision: &str) -> Vec<&'r Contest> {
    let mut best: Vec<&Contest> = vec![];
    for it in rival.contests.iter().filter(|it| it.way.contains(precision)) {
        let alike = |known: &&mut &Contest| (&known.system, known.particles) == (&it.system, it.particles);
        match best.iter_mut().find(alike) {
            Some(known) if ratio(known) < ratio(it) => *known = it,
            Some(_) => {}
            None => best.push(it),
        }
    }
    best
}

/// The range of the ratios of every system, each by the fastest of our configurations, where a rival is faster, and how the rivals were
/// built.
fn answer(data: &[Rival]) -> String {
    let mut parts: Vec<String> = vec![];
    for rival in data {
        let Some(first) = rival.contests.first() else { continue };
        let system = first.system.split(',').next().unwrap_or_default();
        let ratios = ["f64", "f32"].into_iter().filter_map(|precision| {
            let ratios: Vec<f64> = best(rival, precision).into_iter().map(ratio).collect();
            let theirs = match precision {
                "f32" if DOUBLE_ONLY.contains(&rival.rival.as_str()) => " over its f64",
                _ => "",
            };
            (!ratios.is_empty()).then(|| format!("{} ({precision}{theirs})", range(ratios, 2)))
        });
        parts.push(format!("{system} over {} {}", rival.rival, ratios.collect::<Vec<_>>().join(", ")));
    }
    let lost: Vec<String> =
        data.iter().filter_map(|rival| Some(format!(" {}.", defeats(rival)?.0))).collect();
    let native = data.iter().all(|rival| rival.build.contains("native"));
    let built = if native { "All are" } else { "Not all are" };
    format!(
        "Our rate over theirs, by our fastest configuration: {}.{} {built} built for this processor.",
        parts.join("; "),
        lost.concat()
    )
}

/// Returns the systems that a rival computes faster than our fastest configuration in double precision: a sentence, and the contests.
/// None where ours is faster everywhere.
pub fn defeats(rival: &Rival) -> Option<(String, Vec<&Contest>)> {
    let all = best(rival, "f64");
    let lost: Vec<&Contest> = all.iter().copied().filter(|it| ratio(it) < 1.0).collect();
    let ratios = lost.iter().map(|it| ratio(it));
    let sentence = format!(
        "{} is faster in {} of {} systems, where ours reaches {} of its rate",
        rival.rival,
        lost.len(),
        all.len(),
        range(ratios, 2)
    );
    (!lost.is_empty()).then_some((sentence, lost))
}

/// Version, build, host and date of each program.
fn details(data: &[Rival]) -> Vec<String> {
    let mut details: Vec<String> = data
        .iter()
        .map(|rival| {
            let source = &rival.source;
            format!(
                "{} {} ({}) beside ours of commit {} with {}, on {}, {}: `{}`. Rates in {}.",
                rival.rival,
                rival.version,
                rival.build,
                source.commit,
                rival.instruction_set,
                source.host,
                source.date,
                source.command,
                rival.unit
            )
        })
        .collect();
    for rival in data {
        let Some((_, lost)) = defeats(rival) else { continue };
        let systems = lost.iter().map(|it| format!("{} ({:.2})", it.system, ratio(it)));
        details.push(format!(
            "{} is faster than ours for {}.",
            rival.rival,
            systems.collect::<Vec<_>>().join("; ")
        ));
    }
    details.push(
        "LAMMPS computes in double precision, beside our f32 too. Its granular pairs are of the general style `granular` (Hertz, \
         damping `mass_velocity`, friction without history), of which OPT has no version; its Lennard-Jones pairs are of OPT."
            .to_owned(),
    );
    details.push("Both programs run in turns, each over the same steps of the same system.".to_owned());
    details
}

/// Ratios of the granular contests over the packing fraction; the others have no such axis and stand in the table.
fn figure(data: &[Rival]) -> Figure {
    let granular = |rival: &&Rival| rival.contests.iter().any(|it| it.system.contains("packing fraction"));
    let fastest = data.iter().filter(granular).flat_map(|rival| {
        ["f64", "f32"]
            .into_iter()
            .flat_map(|precision| best(rival, precision).into_iter().map(move |it| (precision, it)))
    });
    let points = fastest.filter_map(|(precision, it)| {
        let fraction: f64 = it.system.split("packing fraction ").nth(1)?.parse().ok()?;
        let ends = [end(it, f64::INFINITY, f64::min), end(it, 0.0, f64::max)];
        Some((format!("{precision}, {} discs", it.particles), (fraction, ratio(it), ends)))
    });
    let mut series = Series::by_name(Style::Joined, points);
    for known in &mut series {
        known.points.sort_by(|a, b| a.x.total_cmp(&b.x));
    }
    Chart::of(
        Axis::linear("packing fraction", None).between([0.0, 0.9]),
        Axis::logarithmic("times as fast as LAMMPS", None),
    )
    .with(series)
    .figure("ratio-over-packing", "Granular discs: ours over LAMMPS, one core")
    .caption("Particle-steps a second of processor time, ours by the faster of lattice and neighbour lists over theirs, which is in \
              double precision; medians and range over the rounds. At 1 both are as fast.")
}

fn contests(data: &[Rival]) -> Table {
    let middle = |rates: &[f64]| median(rates.iter().copied());
    Rows::of(data.iter().flat_map(|rival| rival.contests.iter().map(move |it| (rival, it))))
        .text("beside", |(rival, _)| &rival.rival)
        .text("system", |(_, it)| &it.system)
        .count("particles", |(_, it)| it.particles)
        .text("our way", |(_, it)| &it.way)
        .number("ours", 2, |(_, it)| middle(&it.ours))
        .number("theirs", 2, |(_, it)| middle(&it.theirs))
        .number("ratio", 2, |(_, it)| ratio(it))
        .number("lowest", 2, |(_, it)| end(it, f64::NAN, f64::min))
        .number("highest", 2, |(_, it)| end(it, f64::NAN, f64::max))
        .table("contests", "Rates of both, medians over the rounds")
        .note("Units are those named with each program above.")
}

fn same(data: &[Rival]) -> Table {
    Rows::of(data.iter().flat_map(|rival| rival.same.iter().map(move |it| (rival, it))))
        .text("beside", |(rival, _)| &rival.rival)
        .text("quantity", |(_, it)| &it.what)
        .number("ours", 6, |(_, it)| it.ours)
        .number("theirs", 6, |(_, it)| it.theirs)
        .short("may differ by", |(_, it)| it.within)
        .table("same-physics", "That both compute the same")
}

#[cfg(test)]
mod tests {
    use super::super::Source;
    use super::*;

    fn rival(name: &str, contests: &[(&str, &str, f64)]) -> Rival {
        let contest = |&(system, way, ratio): &(&str, &str, f64)| Contest {
            system: system.to_owned(),
            particles: 100,
            way: way.to_owned(),
            ours: vec![ratio],
            theirs: vec![1.0],
            ratios: vec![ratio],
        };
        Rival {
            rival: name.to_owned(),
            version: "1".to_owned(),
            build: "native".to_owned(),
            instruction_set: "avx512".to_owned(),
            unit: "steps".to_owned(),
            contests: contests.iter().map(contest).collect(),
            same: vec![],
            memory: vec![],
            source: Source::default(),
        }
    }

    /// The answer says where a rival is faster, and that LAMMPS computes in double precision beside our single precision.
    #[test]
    fn the_answer_says_where_a_rival_is_faster() {
        let discs = [
            ("hard discs, dilute", "f64", 1.2),
            ("hard discs, dense", "f64", 0.8),
            ("hard discs, solid", "f64", 0.9),
        ];
        let grains =
            [("granular discs, dense", "lattice f64", 3.0), ("granular discs, dense", "lattice f32", 5.0)];
        let data = [rival("LAMMPS", &grains), rival("EDMD", &discs)];
        assert_eq!(
            answer(&data),
            "Our rate over theirs, by our fastest configuration: granular discs over LAMMPS 3 (f64), 5 (f32 over its f64); hard discs over \
             EDMD 0.8 to 1.2 (f64). EDMD is faster in 2 of 3 systems, where ours reaches 0.8 to 0.9 of its rate. All are built for this \
             processor."
        );
        assert!(
            details(&data)
                .concat()
                .contains("EDMD is faster than ours for hard discs, dense (0.80); hard discs, solid (0.90).")
        );
        assert!(defeats(&data[0]).is_none());
    }
}
