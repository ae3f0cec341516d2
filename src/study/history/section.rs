//! The page of what `bench --record` measured.

use super::Record;
use crate::console::Failure;
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::report::{Cell, Rows, Section, Table};
use crate::results::Made;
use std::collections::BTreeMap;
use stripmine_physics::number::{counted, range};

/// What the item is called.
pub const NAME: &str = "history";
/// Cases that one picture shows at most.
const SHOWN: usize = 7;

/// The page, and `again`, the command that makes it.
///
/// # Errors
/// If the dataset is none that JSON can hold.
pub fn made(records: &[Record], again: String) -> Result<Made, Failure> {
    Made::new(section(records, again), &records)
}

/// Records by host, in the order in which hosts occur.
fn by_host(records: &[Record]) -> Vec<(&str, Vec<&Record>)> {
    let mut hosts: Vec<(&str, Vec<&Record>)> = vec![];
    for record in records {
        let host = record.machine.processor.as_str();
        match hosts.iter_mut().find(|(known, _)| *known == host) {
            Some((_, own)) => own.push(record),
            None => hosts.push((host, vec![record])),
        }
    }
    hosts
}

fn section(records: &[Record], again: String) -> Section {
    let hosts = by_host(records);
    Section::new(NAME, "How fast it was, and is")
        .asks("Does the program become faster or slower over time, on each host?")
        .expects("Rates of one host and one case that differ by less than their spread are the same.")
        .answers(answer(records, &hosts))
        .figures(hosts.iter().enumerate().map(|(at, (host, own))| figure(at, host, own)))
        .tables([table(records)])
        .again(again)
        .depends_on_host()
}

/// By how much the last measurement of each case differs from the first on its host.
fn answer(records: &[Record], hosts: &[(&str, Vec<&Record>)]) -> String {
    let days: std::collections::BTreeSet<&str> = records.iter().map(|it| it.date.as_str()).collect();
    let mut ratios = vec![];
    for (_, own) in hosts {
        let mut cases: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        own.iter().for_each(|it| cases.entry(it.case()).or_default().push(it.rates[1]));
        let several = cases.values().filter(|rates| rates.len() > 1);
        ratios.extend(several.filter_map(|rates| Some(rates.last()? / rates.first()?)));
    }
    let begin = format!(
        "{} on {}, {}",
        counted(records.len(), "measurement", "measurements"),
        counted(hosts.len(), "host", "hosts"),
        match (days.first(), days.last()) {
            (Some(first), Some(last)) if first != last => format!("from {first} to {last}"),
            (Some(first), _) => format!("on {first}"),
            _ => "none yet".to_owned(),
        }
    );
    match ratios.is_empty() {
        true => format!("{begin}: no case was measured twice on a host yet."),
        false => {
            format!("{begin}: the last rate of a case is {} times the first on its host.", range(ratios, 2))
        }
    }
}

/// Days since the first of January of the year 0 in the calendar of today, or near enough to lie a day apart; none of a text that is no
/// date.
fn day(date: &str) -> Option<f64> {
    let mut parts = date.split('-').map(str::parse::<i64>);
    let (year, month, day) = (parts.next()?.ok()?, parts.next()?.ok()?, parts.next()?.ok()?);
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    Some((365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day) as f64)
}

fn figure(at: usize, host: &str, own: &[&Record]) -> Figure {
    let first = own.iter().filter_map(|it| day(&it.date)).fold(f64::INFINITY, f64::min);
    let since = own.iter().map(|it| it.date.as_str()).min().unwrap_or_default();
    let points = own.iter().filter_map(|it| {
        let [best, median, worst] = it.rates.map(|rate| 1e-6 * rate);
        Some((it.case(), Point { x: day(&it.date)? - first, y: median, spread: Some([worst, best]) }))
    });
    let series = Series::by_name(Style::Joined, points);
    let left_out = series.len().saturating_sub(SHOWN);
    let more = if left_out == 0 { String::new() } else { format!(" {left_out} more are in the table.") };
    Chart::of(
        Axis::linear("days", None),
        Axis::logarithmic("rate: steps, collisions or interactions", Some("million/s")),
    )
    .with(series.into_iter().take(SHOWN))
    .figure(format!("rates_{}", at + 1), format!("Rates on {host}"))
    .caption(format!(
        "Days since {since}. Points: the median of the repeats; bars: the worst and the best.{more}"
    ))
}

fn table(records: &[Record]) -> Table {
    Rows::of(records)
        .text("date", |it| &it.date)
        .text("commit", |it| &it.origin.commit)
        .text("host", |it| &it.machine.processor)
        .text("what", |it| &it.what)
        .count("particles", |it| it.particles)
        .count("threads", |it| it.threads)
        .number("median (million/s)", 2, |it| 1e-6 * it.rates[1])
        .cell("worst and best (million/s)", |it| Cell::Range([1e-6 * it.rates[2], 1e-6 * it.rates[0]], 2))
        .text("rate", |it| it.rate_name.replace('_', " "))
        .text("command", |it| &it.command)
        .table("records", "Every measurement")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_follow_each_other() {
        let days = ["2024-02-28", "2024-02-29", "2024-03-01", "2025-12-31", "2026-01-01"].map(day);
        let days: Vec<f64> = days.into_iter().map(Option::unwrap).collect();
        assert_eq!([days[1] - days[0], days[2] - days[1], days[4] - days[3]], [1.0; 3]);
        assert_eq!(days[4] - days[2], 671.0);
        assert_eq!(day("yesterday"), None);
    }
}
