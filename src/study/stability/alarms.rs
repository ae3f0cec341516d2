//! Correct warnings and false alarms of every limit and check over a map.

use super::dataset::StabilityMap;
use super::outcome::MapPoint;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::study::alarm::{Alarm, WarningLevel};

/// Record of a limit or check over a map.
#[derive(Clone, Debug, Default, PartialEq)]
struct AlarmRecord {
    /// Numbers of right runs, and of wrong runs that finish, with its warning.
    right: usize,
    wrong: usize,
    /// Wrong runs with no other warning.
    alone: usize,
    /// Largest value over the limit among right runs; a higher limit gives no false alarm.
    largest_right: Option<f64>,
    /// Smallest value over the limit among wrong runs with no other warning; a higher limit misses one.
    smallest_alone: Option<f64>,
}

/// Limits and checks in order of first occurrence; checks during a run are listed apart from those before it.
fn checks<'c>(cells: impl Iterator<Item = &'c MapPoint>) -> Vec<(String, bool)> {
    let mut all = vec![];
    for alarm in cells.flat_map(|cell| &cell.alarms) {
        let key = (alarm.check.clone(), alarm.finding == WarningLevel::WarnedByRun);
        if !all.contains(&key) {
            all.push(key);
        }
    }
    all
}

impl AlarmRecord {
    fn of<'c>(cells: impl Iterator<Item = &'c MapPoint>, check: &str, is_by_run: bool) -> AlarmRecord {
        let is_it =
            |alarm: &Alarm| alarm.check == check && (alarm.finding == WarningLevel::WarnedByRun) == is_by_run;
        cells.fold(AlarmRecord::default(), |mut record, cell| {
            let Some(alarm) = cell.alarms.iter().find(|alarm| is_it(alarm)) else { return record };
            let tells = alarm.finding.is_warning();
            if cell.is_right() {
                record.right += usize::from(tells);
                record.largest_right =
                    [record.largest_right, alarm.share].into_iter().flatten().reduce(f64::max);
            } else if cell.class.is_undetected_failure() && tells {
                record.wrong += 1;
                if !cell.alarms.iter().any(|other| other.finding.is_warning() && !is_it(other)) {
                    record.alone += 1;
                    record.smallest_alone =
                        [record.smallest_alone, alarm.share].into_iter().flatten().reduce(f64::min);
                }
            }
            record
        })
    }
}

/// A row for each limit and check of each map.
pub(crate) fn alarms(maps: &[(String, StabilityMap)]) -> ResultFrame {
    let rows = maps.iter().flat_map(|(name, data)| {
        let [right, wrong] = [MapPoint::is_right, |cell: &MapPoint| cell.class.is_undetected_failure()]
            .map(|belongs: fn(&MapPoint) -> bool| data.cells().filter(|cell| belongs(cell)).count());
        checks(data.cells()).into_iter().map(move |(check, is_by_run)| {
            let record = AlarmRecord::of(data.cells(), &check, is_by_run);
            (name, data.method, check, is_by_run, [right, wrong], record)
        })
    });
    FrameBuilder::of(rows)
        .text("scene", |(name, ..)| *name)
        .text("method", |(_, method, ..)| *method)
        .text("limit or check", |(_, _, check, ..)| check.clone())
        .text("when", |(_, _, _, is_by_run, ..)| if *is_by_run { "along the run" } else { "before" })
        .count("right", |(.., [right, _], _)| *right)
        .count("right, warned of", |(.., record)| record.right)
        .count("wrong", |(.., [_, wrong], _)| *wrong)
        .count("wrong, warned of", |(.., record)| record.wrong)
        .count("wrong, by nothing else", |(.., record)| record.alone)
        .number("largest value over limit, right", 3, |(.., record)| record.largest_right)
        .number("smallest value over limit, wrong by nothing else", 3, |(.., record)| record.smallest_alone)
        .frame("alarms", "Correct warnings and false alarms of every limit and check")
}

#[cfg(test)]
mod tests {
    use super::super::outcome::RunClass;
    use super::*;
    use crate::study::trial::FailureCause;

    fn cell(class: RunClass, is_decided: bool, alarms: &[(&str, WarningLevel, f64)]) -> MapPoint {
        let alarm = |&(check, finding, share): &(&str, WarningLevel, f64)| Alarm {
            check: check.to_owned(),
            finding,
            share: Some(share),
            message: String::new(),
        };
        MapPoint { class, what: String::new(), is_decided, alarms: alarms.iter().map(alarm).collect() }
    }

    #[test]
    fn hits_and_false_alarms_are_counted_apart() {
        use WarningLevel::{Refused, Warned, WarnedByRun, Within};
        let cells = [
            cell(RunClass::Works, true, &[("a", Within, 0.5)]),
            cell(RunClass::Works, true, &[("a", Warned, 1.5), ("b", WarnedByRun, 2.0)]),
            // Neither right nor wrong with certainty.
            cell(RunClass::Works, false, &[("a", Warned, 9.0)]),
            cell(RunClass::Silent, true, &[("a", Refused, 4.0), ("b", WarnedByRun, 3.0)]),
            cell(RunClass::EnergyGrowth, true, &[("a", Warned, 3.0), ("c", Within, 0.9)]),
            cell(RunClass::Failed(FailureCause::Penetration), true, &[("a", Warned, 1.1)]),
        ];
        let checks = checks(cells.iter());
        let named = |name: &str, by_run: bool| (name.to_owned(), by_run);
        assert_eq!(checks, [named("a", false), named("b", true), named("c", false)]);
        let a = AlarmRecord::of(cells.iter(), "a", false);
        let expected =
            AlarmRecord { right: 1, wrong: 2, alone: 1, largest_right: Some(1.5), smallest_alone: Some(3.0) };
        assert_eq!(a, expected);
        let b = AlarmRecord::of(cells.iter(), "b", true);
        assert_eq!((b.right, b.wrong, b.alone, b.smallest_alone), (1, 1, 0, None));
    }
}
