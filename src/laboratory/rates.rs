//! Throughput of a grid of cases, with its spread over separate processes.
//!
//! Rates of one engine on one day differ by half between processes, because memory pages and other load on the machine stay the same within a
//! process. Each round over the cases therefore runs in a separate process and in a different order. Results are the median over the processes
//! and the range.

mod case;
mod process;

pub(crate) use case::{CaseReading, RateCase, StudyWork, parse_parameters};
pub(crate) use process::{VERB, serve};

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::results::StudyEnvironment;
use crate::statistics::median;
use process::ProcessFailure;

/// Number of processes that measure every case, one after the other.
pub(crate) const PROCESSES: usize = 3;

/// Value measured by several processes: median and range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ProcessSpread {
    /// Median process.
    pub(crate) median: f64,
    /// Lowest and highest process.
    pub range: [f64; 2],
}

impl ProcessSpread {
    /// Median and range of the values of the processes.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> ProcessSpread {
        let values: Vec<f64> = values.collect();
        let least = |sign: f64| sign * values.iter().map(|value| sign * value).fold(f64::INFINITY, f64::min);
        ProcessSpread { median: median(values.iter().copied()), range: [1.0, -1.0].map(least) }
    }

    /// Returns a table cell with the value multiplied by `scale`.
    pub(crate) fn cell(self, scale: f64, decimals: usize) -> TableCell {
        TableCell::Spread {
            value: scale * self.median,
            range: self.range.map(|value| scale * value),
            decimals,
        }
    }
}

/// Readings of one case from all processes.
#[derive(Clone, Debug)]
pub(crate) struct MeasuredCase {
    labels: Vec<(String, TableCell)>,
    /// Reading of each process.
    pub(crate) readings: Vec<CaseReading>,
}

impl MeasuredCase {
    /// Makes a case without labels.
    pub(crate) fn of(readings: impl IntoIterator<Item = CaseReading>) -> MeasuredCase {
        MeasuredCase { labels: vec![], readings: readings.into_iter().collect() }
    }

    fn spread_of_readings(&self, of: impl Fn(&CaseReading) -> f64) -> ProcessSpread {
        ProcessSpread::of(self.readings.iter().map(of))
    }

    /// Work per second.
    pub(crate) fn rate(&self) -> ProcessSpread {
        self.spread_of_readings(|it| it.work / it.seconds)
    }

    /// Seconds per unit of work.
    pub(crate) fn cost(&self) -> ProcessSpread {
        self.spread_of_readings(|it| it.seconds / it.work)
    }

    /// Seconds of a part per unit of work.
    pub(crate) fn part(&self, name: &str) -> ProcessSpread {
        self.spread_of_readings(|it| it.parts.get(name).copied().unwrap_or(0.0) / it.work)
    }

    /// Operations of a kind per unit of work.
    pub(crate) fn count(&self, name: &str) -> f64 {
        self.spread_of_readings(|it| it.counts.get(name).copied().unwrap_or(0.0) / it.work).median
    }

    /// Peak memory of the process that measured the case (bytes). Cases measured together share it.
    pub(crate) fn peak_memory(&self) -> f64 {
        self.spread_of_readings(|it| it.peak_memory).median
    }

    /// Ratio of the rate to that of another case, process by process.
    pub(crate) fn rate_ratio(&self, other: &MeasuredCase) -> ProcessSpread {
        let rate = |it: &CaseReading| it.work / it.seconds;
        ProcessSpread::of(
            self.readings.iter().zip(&other.readings).map(|(own, other)| rate(own) / rate(other)),
        )
    }
}

/// Frame of the rates, one row per case in the given order, with the labels as columns. Every case has the labels of the first.
pub(crate) fn rate_frame(
    measured: &[MeasuredCase],
    (name, title): (&str, &str),
    (heading, scale, decimals): (&str, f64, usize),
) -> ResultFrame {
    let headings = measured.first().map_or(vec![], |it| it.labels.iter().map(|(it, _)| it.clone()).collect());
    FrameBuilder::of(measured)
        .cells(headings, |it| it.labels.iter().map(|(_, value)| value.clone()).collect::<Vec<_>>())
        .cell(heading, |it| it.rate().cell(scale, decimals))
        .count("processes", |it| it.readings.len())
        .frame(name, title)
}

/// Measures cases in [`PROCESSES`] processes, one after the other.
pub(crate) fn measure_rates(
    lab: &StudyEnvironment<'_>,
    cases: &[RateCase],
) -> Result<Vec<MeasuredCase>, CommandFailure> {
    measure_rounds(cases, lab.progress, |cases, heard| match &lab.program {
        Some(program) => process::measure(program, cases, heard),
        None => cases.iter().try_for_each(|case| {
            let reading = case.measure(&[]).map_err(|failure| (failure.class(), failure.message_text()))?;
            heard(reading);
            Ok(())
        }),
    })
}

/// Runs the rounds; `round` measures some cases in order and passes on each reading.
fn measure_rounds(
    cases: &[RateCase],
    progress: &dyn Fn(f64),
    mut round: impl FnMut(&[&RateCase], &mut dyn FnMut(CaseReading)) -> Result<(), ProcessFailure>,
) -> Result<Vec<MeasuredCase>, CommandFailure> {
    let labelled = |case: &RateCase| MeasuredCase { labels: case.labels.clone(), ..MeasuredCase::of([]) };
    let mut all: Vec<MeasuredCase> = cases.iter().map(labelled).collect();
    let rounds = if cases.is_empty() { 0 } else { PROCESSES };
    for number in 0..rounds {
        let order = round_order(cases.len(), number);
        let in_order: Vec<&RateCase> = order.iter().map(|&at| &cases[at]).collect();
        let mut heard = 0;
        let outcome = round(&in_order, &mut |reading| {
            if let Some(&at) = order.get(heard) {
                all[at].readings.push(reading);
                heard += 1;
                progress((number * cases.len() + heard) as f64 / (rounds * cases.len()) as f64);
            }
        });
        outcome.map_err(|(class, said)| {
            let process = in_order.get(heard).map_or_else(String::new, |case| case.name());
            CommandFailure::OfProcess { process: format!("measuring {process}"), class, said }
        })?;
    }
    Ok(all)
}

/// Order of the cases in a round: each round begins at a different case, and every second one runs backwards.
fn round_order(cases: usize, round: usize) -> Vec<usize> {
    let start = round * cases / PROCESSES;
    let place = |step: usize| if round % 2 == 1 { start + cases - step } else { start + step };
    (0..cases).map(|step| place(step) % cases).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameValue;
    use std::cell::RefCell;
    use stripmine_physics::reported::ErrorClass;
    use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

    fn reading(seconds: f64) -> CaseReading {
        CaseReading { work: 12.0, seconds, ..CaseReading::default() }
    }

    fn cases(count: u64) -> Vec<RateCase> {
        let case = |at| RateCase::steps("bench", &Overrides::new(), 0, 1).label("case", at);
        (0..count).map(case).collect()
    }

    /// Every round visits every case, in a different order; rows are in the order of the cases, not of the measurements.
    #[test]
    fn rows_are_in_the_order_of_the_cases() {
        for count in [0, 1, 2, 5, 7] {
            let (orders, shares) = (RefCell::new(vec![]), RefCell::new(vec![]));
            let progress = |share| shares.borrow_mut().push(share);
            // Times by the case and the round.
            let all = measure_rounds(&cases(count), &progress, |cases, heard| {
                let number = orders.borrow().len() as f64;
                let at = |case: &RateCase| match case.labels[0].1 {
                    TableCell::Count(at) => at,
                    _ => 0,
                };
                cases.iter().for_each(|case| heard(reading((at(case) + 1) as f64 + 0.25 * number)));
                orders.borrow_mut().push(cases.iter().map(|case| at(case)).collect::<Vec<_>>());
                Ok(())
            });
            let all = all.unwrap();
            let frame = rate_frame(&all, ("rates", "Rates"), ("rate (1/s)", 1.0, 2));
            let names: Vec<&str> = frame.columns.iter().map(|it| it.name.as_str()).collect();
            if count > 0 {
                assert_eq!(names, ["case", "rate", "rate_lowest", "rate_highest", "processes"]);
            }
            for (at, row) in frame.rows.iter().enumerate() {
                let [slow, middle, fast] = [0.5, 0.25, 0.0].map(|more| 12.0 / ((at + 1) as f64 + more));
                let rates = [middle, slow, fast].map(FrameValue::Number);
                assert_eq!(row[0], FrameValue::Count(at as u64));
                assert_eq!(row[1..4], rates);
                assert_eq!(row[4], FrameValue::Count(PROCESSES as u64));
            }
            for order in orders.borrow().iter() {
                let mut sorted = order.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, (0..count).collect::<Vec<_>>());
            }
            assert_eq!(orders.borrow().len(), if count > 0 { PROCESSES } else { 0 });
            if count > 2 {
                let firsts: std::collections::BTreeSet<u64> =
                    orders.borrow().iter().map(|order| order[0]).collect();
                assert_eq!(firsts.len(), PROCESSES, "{:?}", orders.borrow());
            }
            assert!(shares.borrow().is_sorted() && shares.borrow().last().is_none_or(|share| *share == 1.0));
        }
    }

    /// The error names the failed case and has the class and message of the process.
    #[test]
    fn a_failure_names_its_case() {
        let failed = |cases: &[&RateCase], heard: &mut dyn FnMut(CaseReading)| {
            assert_eq!(cases.len(), 3);
            heard(reading(1.0));
            Err((Some(ErrorClass::Precondition), "disc 3 left the box".to_owned()))
        };
        let failure = measure_rounds(&cases(3), &|_| (), failed).unwrap_err();
        assert_eq!(failure.exit_code(), ErrorClass::Precondition.exit_code());
        assert_eq!(failure.message_text(), "measuring case = 1: disc 3 left the box");
    }

    /// Two cases of one scene count the same work and operations, whatever their times.
    #[test]
    fn readings_count_work_and_operations() {
        let discs = Overrides::new().set(&COUNT, 64_u64).set(&PACKING_FRACTION, 0.3);
        let events = |name: &str| RateCase::events("hard-disks", &discs, 50, 200).label("name", name);
        let steps = RateCase::steps("bench", &discs, 2, 3).label("name", "steps").on_threads(2);
        let lab = StudyEnvironment::here(&|_| ());
        let all = measure_rates(&lab, &[events("a"), events("b"), steps]).unwrap();
        let works = |at: usize| all[at].readings.iter().map(|it| it.work).collect::<Vec<_>>();
        assert_eq!([works(0), works(1)], [[200.0; PROCESSES]; 2]);
        assert_eq!(all[0].readings[0].counts, all[1].readings[2].counts);
        assert!(all[0].count("predictions") > 1.0);
        assert!(all[2].readings[0].parts.contains_key("forces") && works(2)[0] >= 3.0 * 64.0);
        assert!(all[2].part("forces").median <= all[2].cost().range[1]);
        let [low, high] = all[0].rate_ratio(&all[0]).range;
        assert_eq!((low, high), (1.0, 1.0));
    }

    #[test]
    fn a_rejected_scene_names_its_case() {
        let none = Overrides::new().set(&COUNT, 0_u64);
        let case = RateCase::steps("bench", &none, 0, 1).label("discs", 0);
        let failure = measure_rates(&StudyEnvironment::here(&|_| ()), &[case]).unwrap_err();
        assert_eq!(failure.exit_code(), ErrorClass::Input.exit_code());
        assert!(failure.message_text().starts_with("measuring discs = 0: "), "{}", failure.message_text());
    }
}
