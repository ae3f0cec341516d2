//! Wall time over the number of sectors.

use crate::laboratory::langevin::study::sectors::{Fluid, Row, SEARCHES, SOURCE, Sectors, THREADS};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};

/// Two threads help where they are at least this many times as fast as one.
const HELPS: f64 = 1.2;
/// The floor is reached where a time is below this many times the shortest.
const FLOOR: f64 = 1.25;

/// How many times as fast two threads are as one, in ours and in the source.
struct Gain {
    per_side: u64,
    ours: f64,
    source: f64,
}

impl Gain {
    fn of(row: &Row) -> Option<Gain> {
        let gain = |[one, two]: [f64; 2]| one / two;
        Some(Gain { per_side: row.per_side?, ours: gain(row.seconds), source: gain(row.source?) })
    }

    /// Whether both help, or both do not.
    fn agrees(&self) -> bool {
        (self.ours > HELPS) == (self.source > HELPS)
    }

    fn in_words(&self) -> String {
        format!("{}: {:.2} ({:.2})", self.per_side, self.ours, self.source)
    }
}

/// Whether two threads do as the source's at the fewest and at the best number of sectors.
fn of_threads(gains: &[Option<Gain>; 2]) -> String {
    let [Some(few), Some(best)] = gains else {
        return String::new();
    };
    let begin = match (few.agrees(), best.agrees()) {
        (true, true) => "Two threads do as in the source",
        (true, false) => "At the best number of sectors two threads do the opposite of the source's",
        (false, _) => "At the fewest sectors two threads do the opposite of the source's",
    };
    format!(
        "{begin}: they are {:.2} times as fast as one at the fewest (source {:.2}) and {:.2} at the best number (source {:.2}). ",
        few.ours, few.source, best.ours, best.source
    )
}

/// The same at every number of sectors.
fn at_every_number(gains: &[Gain]) -> String {
    let all: Vec<String> = gains.iter().map(Gain::in_words).collect();
    format!("Two threads over one by sectors a side, source in brackets: {}. ", all.join(", "))
}

/// What came out.
pub fn section(data: &Sectors) -> Section {
    let lists = data.rows.iter().find(|row| row.per_side.is_none());
    let of_sectors = || data.rows.iter().filter(|row| row.per_side.is_some());
    let at = |count: u64| data.rows.iter().find(|row| row.per_side == Some(count));
    let best = of_sectors().min_by(|a, b| a.seconds[0].total_cmp(&b.seconds[0]));
    let fewest = of_sectors().min_by_key(|row| row.per_side);
    // Where every pair or most are tried, time falls with the area of a sector: 16 times from 5 to 20 along a side.
    let fall = at(5).zip(at(20)).map(|(few, many)| few.seconds[0] / many.seconds[0]);
    let floor = at(100).zip(best).map(|(row, best)| row.seconds[0] / best.seconds[0]);
    let gains = [fewest, best].map(|row| row.and_then(Gain::of));
    let shortest = SOURCE.iter().map(|(_, [one, _])| *one).fold(f64::INFINITY, f64::min);
    let faster = |row: Option<&Row>| Some(format!("{:.0}", shortest / row?.seconds[0]));
    let sought = faster(best).zip(faster(lists)).map_or(String::new(), |(sectors, lists)| {
        format!("On one thread sectors are {sectors} times as fast as the source at its best; neighbour lists, which it does not have, {lists} times.")
    });
    let is_as = |held: Option<bool>| held.unwrap_or(true);
    let claims = [
        is_as(fall.map(|fall| (8.0..32.0).contains(&fall))),
        is_as(floor.map(|floor| floor < FLOOR)),
        is_as(gains[0].as_ref().map(Gain::agrees)),
        is_as(gains[1].as_ref().map(Gain::agrees)),
    ];
    let falling = fall.map_or(String::new(), |fall| {
        format!("From 5 to 20 a side the time falls {fall:.0} times (1/d²: 16). ")
    });
    let floored = floor.map_or(String::new(), |floor| {
        format!(
            "At 100 it is {floor:.2} times the shortest (source {:.2}). ",
            SOURCE[4].1[0] / SOURCE[5].1[0]
        )
    });
    let all: Vec<Gain> = of_sectors().filter_map(Gain::of).collect();
    Section::new("langevin-sectors", "Langevin: wall time over the number of sectors")
        .asks("How does the time of a step depend on the number of sectors, and do two threads help?")
        .expects("LAN17: 1008 s with 3 sectors a side, as 1/d² up to 20, 4 s from 100 on; two threads help with 3 (1.92 times), not at the best d.")
        .answers(format!("{}{sought}", of_threads(&gains)))
        .verdict(Verdict::of_claims(&claims))
        .details([format!(
            "{}{falling}{floored}A search left open takes at most {:.0} % longer than the best.",
            at_every_number(&all),
            100.0 * data.fluids.iter().filter_map(loss).fold(0.0, f64::max)
        )])
        .figures([figure(data)])
        .tables([table(data), searches(data), phases(data)])
        .seeds([1])
        .depends_on_host()
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
    let microseconds = |it: &Option<f64>| it.map_or(Cell::Nothing, |it| Cell::Number(1e6 * it, 1));
    Rows::of(&data.fluids)
        .text("pairs", |fluid| fluid.law)
        .number("density N σ²/A", 2, |fluid| fluid.density)
        .cells(SEARCHES.map(|(name, _)| format!("{name} (µs)")), |fluid| {
            fluid.seconds.iter().map(microseconds)
        })
        .text("auto takes", |fluid| &fluid.auto)
        .number("slower than the best (%)", 0, |fluid| loss(fluid).map(|it| 100.0 * it))
        .table("searches", "A step of 4000 particles by every search, on one thread")
}

fn figure(data: &Sectors) -> Figure {
    let of_sectors = || data.rows.iter().filter_map(|row| Some((row.per_side? as f64, row)));
    let threads = THREADS.into_iter().enumerate().flat_map(|(which, threads)| {
        let name = if threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") };
        let ours = of_sectors().map(|(count, row)| (count, row.seconds[which]));
        let source = of_sectors().filter_map(|(count, row)| Some((count, row.source?[which])));
        let source = Series::new(format!("source, {name}"), Style::Points, which + 2, source);
        [Series::new(name, Style::Joined, which, ours), source]
    });
    let lists = data.rows.iter().find(|row| row.per_side.is_none()).map(|lists| {
        let level = [3.0, 800.0].map(|count| (count, lists.seconds[0]));
        Series::new("lists, 1 thread", Style::Dashed, 6, level)
    });
    Chart::of(
        Axis::logarithmic("sectors along a side", None),
        Axis::logarithmic("wall time of 100 steps", Some("s")),
    )
    .with(threads)
    .with(lists)
    .figure("wall-time", "Wall time of 100 steps")
    .caption(format!("{} particles. With 3 sectors along a side every pair is tried.", data.particles))
}

fn table(data: &Sectors) -> Table {
    let source = |row: &Row, which: usize| row.source.map_or(Cell::from(""), |it| Cell::Number(it[which], 1));
    Rows::of(&data.rows)
        .text("sectors", |row| row.per_side.map_or("lists".to_owned(), |count| count.to_string()))
        .number("1 thread (s)", 4, |row| row.seconds[0])
        .number("2 threads (s)", 4, |row| row.seconds[1])
        .number("one over two", 2, |row| row.seconds[0] / row.seconds[1])
        .number("source", 2, |row| row.source.map(|[one, two]| one / two))
        .cell("source, 1 (s)", |row| source(row, 0))
        .cell("source, 2 (s)", |row| source(row, 1))
        .table("wall-time", "Wall time of 100 steps")
        .note("Medians of alternating repeats; fewer steps where they are long.")
}

fn phases(data: &Sectors) -> Table {
    Rows::of(&data.phases)
        .text("part", |(name, _)| *name)
        .number("time (ms)", 2, |(_, seconds)| 1e3 * **seconds)
        .table("phases", "Where the time goes: 100 steps by lists on one thread")
        .note("correct_predict holds velocities, positions, noise and wrapping; index the lists and their order. The source: writing 3.8 s, \
               ordering 0.41, velocities 0.08, boundary 0.03, noise 0.03.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// The source's rows with other times, and lists.
    fn section_of(seconds: impl Fn(u64, [f64; 2]) -> [f64; 2], lists: [f64; 2]) -> Section {
        let row = |&(count, source): &(u64, [f64; 2])| Row {
            per_side: Some(count),
            seconds: seconds(count, source),
            source: Some(source),
        };
        let rows = SOURCE.iter().map(row).chain([Row { per_side: None, seconds: lists, source: None }]);
        section(&Sectors { fluids: vec![], particles: 40_000, rows: rows.collect(), phases: BTreeMap::new() })
    }

    #[test]
    fn threads_that_do_the_opposite_are_said_first_and_sectors_are_not_lists() {
        let tenth = section_of(|_, source| source.map(|seconds| 0.1 * seconds), [0.04, 0.02]);
        assert_eq!(tenth.verdict, Verdict::Reproduced, "{}", tenth.answer);
        assert!(tenth.answer.starts_with("Two threads do as in the source: "), "{}", tenth.answer);
        assert!(
            tenth.answer.contains("sectors are 10 times")
                && tenth.answer.contains("which it does not have, 100 times")
        );
        // Two threads that help everywhere, also where the source's do not.
        let better = section_of(|_, [one, _]| [0.1 * one, 0.05 * one], [0.04, 0.02]);
        assert_eq!(better.verdict, Verdict::Partly);
        let begin = "At the best number of sectors two threads do the opposite of the source's: they are 2.00 times as fast as one at the \
                     fewest (source 1.92) and 2.00 at the best number";
        assert!(better.answer.starts_with(begin), "{}", better.answer);
        assert!(
            better.details[0].contains("in brackets: 3: 2.00 (1.92), 5: 2.00 (1.55), "),
            "{}",
            better.details[0]
        );
        let opposite = section_of(
            |count, [one, _]| [0.1 * one, if count < 100 { 0.1 * one } else { 0.07 * one }],
            [0.04, 0.02],
        );
        assert_eq!(opposite.verdict, Verdict::Partly);
        assert!(
            opposite.answer.starts_with("At the fewest sectors two threads do the opposite"),
            "{}",
            opposite.answer
        );
    }
}
