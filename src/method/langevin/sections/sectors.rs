//! Wall time over the number of sectors.

use crate::method::langevin::study::sectors::{Fluid, SEARCHES, Sectors, THREADS};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};

/// Two threads help where they are at least so many times as fast as one.
const HELPS: f64 = 1.2;

/// What came out.
pub fn section(data: &Sectors) -> Section {
    let best = data.rows.iter().map(|row| row.seconds[0]).fold(f64::INFINITY, f64::min);
    let lists = data.rows.iter().find(|row| row.per_side.is_none());
    let [one, two] = lists.map_or([f64::NAN; 2], |row| row.seconds);
    // Where every pair or most are tried, time falls with the area of a sector.
    let at = |count: u64| data.rows.iter().find(|row| row.per_side == Some(count)).map(|row| row.seconds[0]);
    let falls = at(5).zip(at(20)).is_none_or(|(few, many)| (8.0..32.0).contains(&(few / many)));
    Section {
        name: "langevin-sectors".into(),
        title: "Langevin: wall time over the number of sectors".into(),
        part: Part::Host,
        question: "How does the time of a step depend on the number of sectors, and do two threads help?".into(),
        expected: "LAN17: 100 steps of 40 000 particles take 1008 s with 3 sectors along a side, as 1/d² up to 20, and 4 s from 100 on; two \
                   threads do not help at the best d."
            .into(),
        answer: format!("At best 100 steps take {best:.3} s on one thread, {:.0} times as fast as the source.", 4.0 / best),
        details: vec![format!(
            "Neighbour lists take {one:.3} s on one thread and {two:.3} s on two, which are {:.2} times as fast. Where the search is left \
             open it takes at most {:.0} % longer than the best of all.",
            one / two,
            100.0 * data.fluids.iter().filter_map(loss).fold(0.0, f64::max)
        )],
        verdict: Verdict::reproduced(falls && one / two > HELPS),
        again: "stripmine reproduce --only langevin-sectors".into(),
        figures: vec![figure(data)],
        tables: vec![table(data), searches(data), phases(data)],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: true,
        provenance: None,
    }
}

/// By how much `auto` is slower than the best, relative to it.
fn loss(fluid: &Fluid) -> Option<f64> {
    let known = fluid.seconds.iter().flatten().copied();
    let best = known.fold(f64::INFINITY, f64::min);
    // Sorted when needed is what auto does in sectors.
    let name = match fluid.auto.as_str() {
        "neighbor-list" => "lists",
        "sectors" => "sectors, sorted when needed",
        other => other,
    };
    let own = SEARCHES.iter().position(|(known, _)| *known == name).and_then(|place| fluid.seconds[place]);
    own.map(|own| own / best - 1.0)
}

fn searches(data: &Sectors) -> Table {
    let rows = data.fluids.iter().map(|fluid| {
        let begin = [Cell::Text(fluid.law.into()), Cell::Number(fluid.density, 2)];
        let times = fluid.seconds.iter().map(|it| it.map_or(Cell::Nothing, |it| Cell::Number(1e6 * it, 1)));
        let end = [
            Cell::Text(fluid.auto.clone()),
            loss(fluid).map_or(Cell::Nothing, |it| Cell::Number(100.0 * it, 0)),
        ];
        begin.into_iter().chain(times).chain(end).collect()
    });
    let names = SEARCHES.iter().map(|(name, _)| format!("{name} (µs)"));
    let columns = ["pairs", "density N σ²/A"].map(str::to_owned).into_iter().chain(names);
    Table {
        name: "searches".into(),
        title: "A step of 4000 particles by every search, on one thread".into(),
        columns: columns.chain(["auto takes", "slower than the best (%)"].map(str::to_owned)).collect(),
        rows: rows.collect(),
        notes: vec![],
    }
}

fn figure(data: &Sectors) -> Figure {
    let mut series = vec![];
    for (which, threads) in THREADS.into_iter().enumerate() {
        let name = if threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") };
        let of_sectors = || data.rows.iter().filter_map(|row| Some((row.per_side? as f64, row)));
        let ours = of_sectors().map(|(count, row)| Point::at(count, row.seconds[which]));
        let source = of_sectors().filter_map(|(count, row)| Some(Point::at(count, row.source?[which])));
        series.push(Series { name: name.clone(), style: Style::Joined, hue: which, points: ours.collect() });
        series.push(Series {
            name: format!("source, {name}"),
            style: Style::Points,
            hue: which + 2,
            points: source.collect(),
        });
    }
    if let Some(lists) = data.rows.iter().find(|row| row.per_side.is_none()) {
        let points = [3.0, 800.0].map(|count| Point::at(count, lists.seconds[0]));
        series.push(Series {
            name: "lists, 1 thread".into(),
            style: Style::Dashed,
            hue: 6,
            points: points.to_vec(),
        });
    }
    Figure {
        name: "wall-time".into(),
        title: "Wall time of 100 steps".into(),
        caption: format!("{} particles. With 3 sectors along a side every pair is tried.", data.particles),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("sectors along a side", None),
            y: Axis::logarithmic("wall time of 100 steps", Some("s")),
            series,
            bands: vec![],
        }),
    }
}

fn table(data: &Sectors) -> Table {
    let rows = data.rows.iter().map(|row| {
        let source =
            |which: usize| row.source.map_or(Cell::Text(String::new()), |it| Cell::Number(it[which], 1));
        vec![
            Cell::Text(row.per_side.map_or("lists".to_owned(), |count| count.to_string())),
            Cell::Number(row.seconds[0], 4),
            Cell::Number(row.seconds[1], 4),
            Cell::Number(row.seconds[0] / row.seconds[1], 2),
            source(0),
            source(1),
        ]
    });
    let columns = ["sectors", "1 thread (s)", "2 threads (s)", "ratio", "source, 1 (s)", "source, 2 (s)"];
    Table {
        name: "wall-time".into(),
        title: "Wall time of 100 steps".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec!["Medians of alternating repeats; fewer steps where they are long.".into()],
    }
}

fn phases(data: &Sectors) -> Table {
    let rows = data
        .phases
        .iter()
        .map(|(name, seconds)| vec![Cell::Text(name.clone()), Cell::Number(1e3 * seconds, 2)]);
    Table {
        name: "phases".into(),
        title: "Where the time goes: 100 steps by lists on one thread".into(),
        columns: ["part", "time (ms)"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        notes: vec![
            "correct_predict holds velocities, positions, noise and wrapping; index the lists and their order. The source: writing \
             3.8 s, ordering 0.41, velocities 0.08, boundary 0.03, noise 0.03."
                .into(),
        ],
    }
}
