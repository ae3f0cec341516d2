//! A run of some seconds: what a unit of time costs, and what it says of a mean.

use super::any_number;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use stripmine_physics::averages::{Average, Estimate, Outcome, Rows};
use stripmine_physics::method::{
    Clock, Every, Failure, Prepared, Purpose, Quantity, RunWarning, Simulation, Until,
};
use stripmine_physics::number::significant;

/// Rows of a sample of some seconds, about: as many as a correlation needs, and so few that they cost little; and of one whose time is known.
pub const ROWS: [f64; 2] = [1000.0, 250.0];
/// The first stretches, whose memory is cold and whose threads have not begun, are no part of the cost: this share of the time.
const COLD: f64 = 0.1;

/// A run of some seconds.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Wall seconds of a unit of time, rows apart.
    pub cost: f64,
    /// Wall seconds of a row.
    pub row: f64,
    /// Wall seconds until the first step.
    pub start: f64,
    /// Wall seconds from the beginning to the end.
    pub seconds: f64,
    /// Time that it came to (time).
    pub time: f64,
    /// What it says of the quantity.
    pub outcome: Outcome,
    /// Whether it came beyond the end of the scene's own run.
    pub comes_beyond_end: bool,
    /// What its checks warn of.
    pub warnings: Vec<RunWarning>,
    /// The quantity from stretch to stretch: when each ends (time), and its value there.
    pub series: Vec<[f64; 2]>,
    /// How long a stretch is (time).
    pub spacing: f64,
    /// Wall seconds of a unit of time in each phase, by name.
    pub phases: Vec<(String, f64)>,
}

/// What a run says of a mean.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Known {
    /// The mean.
    #[serde(with = "any_number")]
    pub mean: f64,
    /// Half the width of its interval of 95 %.
    #[serde(with = "any_number")]
    pub bar: f64,
    /// Square of the bar of a mean over one unit of time.
    #[serde(with = "any_number")]
    pub square: f64,
    /// Time that does not count (time).
    #[serde(with = "any_number")]
    pub transient: f64,
    /// Time between independent samples (time).
    #[serde(with = "any_number")]
    pub apart: f64,
    /// Degrees of freedom of the bar; infinite where it is exact.
    #[serde(with = "any_number")]
    pub freedoms: f64,
}

impl From<Estimate> for Known {
    fn from(it: Estimate) -> Known {
        Known {
            mean: it.mean,
            bar: it.bar,
            square: it.bar * it.bar * it.span,
            transient: it.equilibrated_at,
            apart: it.span / it.independent_samples,
            freedoms: it.freedoms,
        }
    }
}

impl Sample {
    /// What it says of the mean, where there is one, however roughly.
    pub fn known(&self) -> Option<Known> {
        match self.outcome {
            Outcome::Mean(estimate) | Outcome::TooShort { estimate: Some(estimate), .. } => {
                Some(estimate.into())
            }
            Outcome::Constant { mean } => Some(Known {
                mean,
                bar: 0.0,
                square: 0.0,
                transient: 0.0,
                apart: 0.0,
                freedoms: f64::INFINITY,
            }),
            Outcome::TooShort { estimate: None, .. }
            | Outcome::Undefined
            | Outcome::Changing { .. }
            | Outcome::Kept { .. } => None,
        }
    }
}

impl Sample {
    /// What its checks warn of, in words.
    pub fn warned(&self) -> String {
        self.warnings.iter().map(|warning| warning.message.as_str()).collect::<Vec<_>>().join("; ")
    }

    /// That it ended before a time, in words; none where it did not.
    pub fn cut_off(&self, time: f64) -> Option<String> {
        // The last stretch may end by rounding before.
        (self.time < time * (1.0 - 1e-9)).then(|| {
            format!(
                "cut off at a time of {} of {}, after {} s",
                significant(self.time, 3),
                significant(time, 3),
                significant(self.seconds, 3)
            )
        })
    }

    /// The mean over the whole run, its beginning among it.
    pub fn whole_mean(&self) -> f64 {
        self.series.iter().map(|[_, value]| value).sum::<f64>() / self.series.len() as f64
    }
}

/// How long a sample is.
#[derive(Clone, Copy, Debug)]
pub enum Span {
    /// About so many wall seconds.
    Seconds(f64),
    /// A time (time), but no more wall seconds than these where they are given.
    Time(f64, Option<f64>),
}

impl Span {
    /// The same in no more than some wall seconds.
    #[must_use]
    pub(super) fn within(self, left: f64) -> Span {
        match self {
            Span::Seconds(seconds) => Span::Seconds(seconds.min(left)),
            Span::Time(time, seconds) => Span::Time(time, Some(seconds.map_or(left, |it| it.min(left)))),
        }
    }
}

/// Runs a scene, observing a quantity.
///
/// # Errors
/// [`Failure`] if it breaks.
pub fn sample(
    prepared: &Prepared,
    (quantities, place): (&'static [Quantity], usize),
    span: Span,
    stop: &AtomicBool,
) -> Result<Sample, Failure> {
    let begun = Instant::now();
    let mut simulation = prepared.start(Purpose::Run)?;
    let start = begun.elapsed().as_secs_f64();
    let mut rows = Rows::new(quantities);
    rows.add(&simulation.row());
    let (seconds, most) = match span {
        Span::Seconds(seconds) => (Some(seconds), f64::INFINITY),
        Span::Time(time, seconds) => (seconds, time),
    };
    let limit = seconds.map_or(Duration::MAX, Duration::from_secs_f64);
    let stride = match span {
        Span::Seconds(seconds) => stride(simulation.as_mut(), prepared, seconds / ROWS[0], stop)?,
        Span::Time(time, _) => {
            simulation.advance(&[first(prepared).after(&simulation.clock())], stop)?;
            let Clock { steps, time: gone, .. } = simulation.clock();
            match prepared.schedule.until {
                Until::Steps(_) => Until::Steps(((time / ROWS[1] * steps as f64 / gone) as u64).max(1)),
                _ => Until::Time(time / ROWS[1]),
            }
        }
    };
    // Rows are evenly spaced from here on.
    rows.add(&simulation.row());
    let running = Instant::now();
    // The start is a part of the time.
    let limit = limit.saturating_sub(running - begun);
    // Of the stretches once it is warm, and of all.
    let (mut warm, mut all) = ((0.0, 0.0), (0.0, 0.0));
    while running.elapsed() < limit && simulation.clock().time < most && !stop.load(Ordering::Relaxed) {
        let (from, begun) = (simulation.clock().time, Instant::now());
        simulation.advance(&[stride.after(&simulation.clock())], stop)?;
        let (gone, spent) = (simulation.clock().time - from, begun.elapsed().as_secs_f64());
        all = (all.0 + gone, all.1 + spent);
        let share = running.elapsed().as_secs_f64() / seconds.unwrap_or(f64::INFINITY);
        if share.max(simulation.clock().time / most) > COLD {
            warm = (warm.0 + gone, warm.1 + spent);
        }
        rows.add(&simulation.row());
    }
    let (gone, spent) = if warm.0 > 0.0 { warm } else { all };
    let row = timed_row(simulation.as_ref());
    let (time, series) = (simulation.clock().time, rows.course(place));
    Ok(Sample {
        cost: spent / gone,
        row,
        start,
        seconds: begun.elapsed().as_secs_f64(),
        time,
        outcome: Average::of(&rows, place).outcome,
        comes_beyond_end: prepared.schedule.until.has_come(&simulation.clock()),
        warnings: simulation.warnings(),
        spacing: series.windows(2).map(|pair| pair[1][0] - pair[0][0]).next().unwrap_or(0.0),
        series,
        phases: phases(simulation.as_ref()),
    })
}

/// Wall seconds of a row, the least of some.
fn timed_row(simulation: &dyn Simulation) -> f64 {
    let once = |_| {
        let begun = Instant::now();
        let _row = simulation.observe();
        begun.elapsed().as_secs_f64()
    };
    (0..3).map(once).fold(f64::INFINITY, f64::min)
}

/// The shortest stretch: a step, or for a method without any a part of the time between rows.
fn first(prepared: &Prepared) -> Until {
    match (prepared.schedule.until, prepared.schedule.rows) {
        (Until::Steps(_), _) => Until::Steps(1),
        (_, Every::Time(time)) => Until::Time(time / 64.0),
        (Until::Time(time), _) => Until::Time(1e-6 * time),
        (Until::Events(_), _) => Until::Time(1e-6),
    }
}

/// A stretch that takes about some seconds: steps, or for a method without any a part of the time between rows.
fn stride(
    simulation: &mut dyn Simulation,
    prepared: &Prepared,
    seconds: f64,
    stop: &AtomicBool,
) -> Result<Until, Failure> {
    let mut stride = first(prepared);
    loop {
        let begun = Instant::now();
        simulation.advance(&[stride.after(&simulation.clock())], stop)?;
        if begun.elapsed().as_secs_f64() > 0.5 * seconds || stop.load(Ordering::Relaxed) {
            return Ok(stride);
        }
        stride = stride.doubled();
    }
}

/// Cost of a unit of time.
#[derive(Clone, Debug)]
pub struct UnitCost {
    /// Wall seconds, by the fastest of some stretches.
    pub seconds: f64,
    /// Wall seconds in each phase, by name, over all stretches.
    pub phases: Vec<(String, f64)>,
}

/// Runs a scene without rows to time it.
///
/// # Errors
/// [`Failure`] if it breaks.
pub fn timed(prepared: &Prepared, seconds: f64, stop: &AtomicBool) -> Result<UnitCost, Failure> {
    const STRETCHES: u32 = 4;
    let mut simulation = prepared.start(Purpose::Run)?;
    let stride = stride(simulation.as_mut(), prepared, seconds / f64::from(STRETCHES), stop)?;
    let mut least = f64::INFINITY;
    for _ in 0..STRETCHES {
        let (from, begun): (Clock, _) = (simulation.clock(), Instant::now());
        simulation.advance(&[stride.after(&from)], stop)?;
        least = least.min(begun.elapsed().as_secs_f64() / (simulation.clock().time - from.time));
    }
    Ok(UnitCost { seconds: least, phases: phases(simulation.as_ref()) })
}

/// Wall seconds of a unit of time in each phase of a run so far, by name.
fn phases(simulation: &dyn Simulation) -> Vec<(String, f64)> {
    let time = simulation.clock().time;
    simulation.phases().into_iter().map(|(name, spent)| (name.to_owned(), spent / time)).collect()
}
