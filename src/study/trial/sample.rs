//! A trial run of some seconds: the cost of a unit of time, and an estimate of a mean.

use super::TrialControl;
use super::mean_error::{MeanEstimate, ROWS, RowPace};
use std::sync::atomic::Ordering;
use stripmine_physics::averages::{Average, AverageOutcome, AveragedRows};
use stripmine_physics::method::{
    Clock, Every, ObservedQuantity, PhysicsFailure, Prepared, QuantityKind, RunWarning, Simulation,
    StartPurpose, Until,
};
use stripmine_physics::number::significant;
use stripmine_physics::particles::Particles;

/// Numbers of rows of a sample of some seconds: enough for its correlations, and more where values between rows are lost.
const FEWEST_ROWS: f64 = 1000.0;
const MOST_ROWS: f64 = 8000.0;
/// Fewest steps between rows, unless they take too long: a row costs about as much as three steps.
const STEPS: u64 = 8;
/// Settings of longer stretches, which give the cost of a row: their share of the time, the doublings of their length, and their fewest number.
const OF_FAR: f64 = 0.1;
const FARTHER: i32 = 3;
const FEW: f64 = 4.0;
/// Samples of a conserved quantity.
const LOOKS: f64 = 2000.0;
/// Share of the time that does not count for the cost: caches are cold and threads have not started.
const COLD: f64 = 0.1;
/// Most states kept by a sample, and most particles in all of them together.
const STATES: usize = 32;
const KEPT: usize = 2_000_000;

/// A trial run of some seconds.
#[derive(Clone, Debug)]
pub(crate) struct TrialSample {
    /// Wall seconds of a unit of time, without rows.
    pub(crate) cost: f64,
    /// Wall seconds of a row.
    pub row: f64,
    /// Wall seconds until the first step.
    pub start: f64,
    /// Wall seconds from the beginning to the end.
    pub seconds: f64,
    /// Time reached (time).
    pub time: f64,
    /// Mean of the quantity, or the reason why there is none.
    pub outcome: AverageOutcome,
    /// Set if it reached the end of the scene's own run.
    pub(crate) reaches_scene_end: bool,
    pub warnings: Vec<RunWarning>,
    /// Time series of the quantity: end of each stretch (time), and its value.
    pub(crate) series: Vec<[f64; 2]>,
    /// Wall seconds of a unit of time in each phase, by name.
    pub phases: Vec<(String, f64)>,
    /// States along the run, evenly spaced, each with its time (time).
    pub states: Vec<(f64, Particles)>,
    /// Rows with all quantities, the time first.
    pub rows: Vec<Vec<f64>>,
    /// Kind of the quantity, and its index in a row.
    pub observed: (QuantityKind, usize),
    /// Largest deviation of a conserved quantity at any step, where the simulation watches it.
    pub(crate) watched: Option<f64>,
    /// Set where values between rows are lost, so that closer rows give more information: instantaneous values, unless a periodic drive repeats them.
    pub(crate) loses: bool,
}

impl TrialSample {
    /// Estimated mean, if there is one, however rough.
    pub(crate) fn known(&self) -> Option<MeanEstimate> {
        match self.outcome {
            AverageOutcome::Mean(estimate) | AverageOutcome::TooShort { estimate: Some(estimate), .. } => {
                let values = values(&self.rows, self.observed.1, &self.series, self.loses);
                Some(MeanEstimate::of(estimate, &values, self.pace()))
            }
            AverageOutcome::Constant { mean } => Some(MeanEstimate::exactly(mean)),
            AverageOutcome::TooShort { estimate: None, .. }
            | AverageOutcome::Undefined
            | AverageOutcome::Changing { .. }
            | AverageOutcome::Kept { .. } => None,
        }
    }
}

impl TrialSample {
    /// Largest deviations of a conserved quantity, at the rows and at any step that was watched; none where it is not conserved or not a number.
    pub(crate) fn deviations(&self) -> Option<[f64; 2]> {
        let AverageOutcome::Kept { farthest, .. } = self.outcome else { return None };
        Some([farthest, self.watched.map_or(farthest, |watched| watched.max(farthest))])
    }

    /// Costs of time and rows, where values between rows are lost.
    pub(crate) fn pace(&self) -> Option<RowPace> {
        self.loses.then_some(RowPace { cost: self.cost, row: self.row })
    }

    /// Warnings of its checks, joined.
    pub(crate) fn warning_text(&self) -> String {
        self.warnings.iter().map(|warning| warning.message.as_str()).collect::<Vec<_>>().join("; ")
    }

    /// Describes that the run ended before a time; none if it did not.
    pub(crate) fn early_end(&self, time: f64) -> Option<String> {
        // A scene whose time is no multiple of its step ends up to half a step early.
        let is_whole = self.reaches_scene_end && self.deviations().is_some();
        // The last stretch may end early by rounding.
        (!is_whole && self.time < time * (1.0 - 1e-9)).then(|| {
            format!(
                "stopped at a time of {} of {}, after {} s",
                significant(self.time, 3),
                significant(time, 3),
                significant(self.seconds, 3)
            )
        })
    }

    /// Describes why it has no mean.
    pub(crate) fn missing_mean_reason(&self) -> String {
        let time = significant(self.time, 3);
        match self.outcome {
            AverageOutcome::Changing { first, last } => format!(
                "still changing up to a time of {time}, from {} to {}",
                significant(first, 3),
                significant(last, 3)
            ),
            AverageOutcome::TooShort { enough_at, .. } => {
                format!("a time of {time} is too short, {} would be enough", significant(enough_at, 2))
            }
            _ => format!("no mean up to a time of {time}"),
        }
    }

    /// Mean from one time to another, or to the end of the run.
    ///
    /// Instantaneous values are interpolated linearly between rows: for a changing quantity, a sum of rows would lag by half of their spacing.
    pub(crate) fn mean_over(&self, [from, to]: [f64; 2]) -> f64 {
        let (kind, place) = self.observed;
        let of = |rows: &[Vec<f64>]| {
            let [times, values] = [0, place].map(|at| [rows[0][at], rows[1][at]]);
            let [begin, end] = [times[0].max(from), times[1].min(to)];
            if begin >= end {
                return [0.0; 2];
            }
            let (gone, part) = (times[1] - times[0], end - begin);
            let sum = match kind {
                _ if kind.grows() => (values[1] - values[0]) * part / gone,
                QuantityKind::Instant => {
                    let slope = (values[1] - values[0]) / gone;
                    (values[0] + slope * (0.5 * (begin + end) - times[0])) * part
                }
                _ => values[1] * part,
            };
            [sum, part]
        };
        let add = |all: [f64; 2], one: [f64; 2]| [all[0] + one[0], all[1] + one[1]];
        let [sum, time] = self.rows.windows(2).map(of).fold([0.0; 2], add);
        sum / time
    }
}

/// Values of a quantity with their times: those of all rows but the first where others are lost, otherwise the ends of stretches with their means.
pub(crate) fn values(rows: &[Vec<f64>], place: usize, series: &[[f64; 2]], loses: bool) -> Vec<[f64; 2]> {
    match loses {
        true => rows.iter().skip(1).map(|row| [row[0], row[place]]).collect(),
        false => series.to_vec(),
    }
}

/// Length of a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SampleSpan {
    /// About so many wall seconds.
    Seconds(f64),
    /// A time (time), but at most so many wall seconds where these are given.
    Time(f64, Option<f64>),
    /// As `Time`, with the scene's own spacing of rows. A conserved quantity is followed to the end of the scene, also between two rows.
    Planned(f64, Option<f64>),
}

impl SampleSpan {
    /// Limits the span to some wall seconds.
    #[must_use]
    pub(crate) fn within(self, left: f64) -> SampleSpan {
        match self {
            SampleSpan::Seconds(seconds) => SampleSpan::Seconds(seconds.min(left)),
            SampleSpan::Time(time, seconds) => {
                SampleSpan::Time(time, Some(seconds.map_or(left, |it| it.min(left))))
            }
            SampleSpan::Planned(time, seconds) => {
                SampleSpan::Planned(time, Some(seconds.map_or(left, |it| it.min(left))))
            }
        }
    }
}

impl TrialControl<'_> {
    /// Runs a scene and observes a quantity.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if it fails.
    pub(crate) fn sample(
        &self,
        prepared: &Prepared,
        (quantities, place): (&'static [ObservedQuantity], usize),
        span: SampleSpan,
    ) -> Result<TrialSample, PhysicsFailure> {
        let begun = self.watch.now();
        let mut simulation = prepared.start(StartPurpose::Run)?;
        let simulation = simulation.as_mut();
        let start = self.watch.now() - begun;
        let mut rows = AveragedRows::new(quantities);
        let mut all_rows = vec![simulation.row()];
        rows.add(&all_rows[0]);
        let (seconds, most) = match span {
            SampleSpan::Seconds(seconds) => (Some(seconds), f64::INFINITY),
            SampleSpan::Time(time, seconds) | SampleSpan::Planned(time, seconds) => (seconds, time),
        };
        let own = own_rows(prepared).filter(|_| matches!(span, SampleSpan::Planned(..)));
        let loses = quantities[place].kind == QuantityKind::Instant && prepared.model.period().is_none();
        let mut of_stretch = None;
        let stride = match (span, own) {
            (SampleSpan::Seconds(seconds), _) => {
                let most = if loses { MOST_ROWS } else { FEWEST_ROWS };
                of_stretch = loses.then_some(OF_FAR * seconds);
                self.stride(simulation, prepared, [most, FEWEST_ROWS].map(|rows| seconds / rows))?
            }
            (_, Some(own)) => own,
            (SampleSpan::Time(time, _) | SampleSpan::Planned(time, _), None) => {
                // The deviation of a quantity is only seen at samples.
                let rows = if quantities[place].kind == QuantityKind::Kept { LOOKS } else { ROWS };
                self.advance(simulation, first(prepared))?;
                let Clock { steps, time: gone, .. } = simulation.clock();
                match prepared.schedule.until {
                    Until::Steps(_) => Until::Steps(((time / rows * steps as f64 / gone) as u64).max(1)),
                    _ => Until::Time(time / rows),
                }
            }
        };
        // Rows are evenly spaced from here on.
        all_rows.push(simulation.row());
        rows.add(&all_rows[1]);
        let running = self.watch.now();
        // The start is included in the time.
        let limit = seconds.map_or(f64::INFINITY, |all| all - (running - begun) - of_stretch.unwrap_or(0.0));
        let mut states = StateSamples::new(prepared);
        // Time and cost of the stretches after warm-up, and of all.
        let (mut warm, mut all) = ((0.0, 0.0), (0.0, 0.0));
        let is_kept = quantities[place].kind == QuantityKind::Kept;
        let end_of_scene = own.filter(|_| is_kept).map(|_| prepared.schedule.until);
        while self.watch.now() - running < limit
            && simulation.clock().time < most
            && end_of_scene.is_none_or(|end| !end.has_been_reached(&simulation.clock()))
            && !self.stop.load(Ordering::Relaxed)
        {
            let (from, before) = (simulation.clock().time, self.watch.now());
            let end = stride.after(&simulation.clock());
            let moment = states.next(from);
            if moment > from {
                self.advance_to(simulation, &[Until::Time(moment), end])?;
            }
            states.look(simulation, moment);
            match end_of_scene {
                Some(last) => self.advance_to(simulation, &[end, last])?,
                None => self.advance_to(simulation, &[end])?,
            }
            let (gone, spent) = (simulation.clock().time - from, self.watch.now() - before);
            all = (all.0 + gone, all.1 + spent);
            let share = (self.watch.now() - running) / seconds.unwrap_or(f64::INFINITY);
            if share.max(simulation.clock().time / most) > COLD {
                warm = (warm.0 + gone, warm.1 + spent);
            }
            let row = simulation.row();
            rows.add(&row);
            all_rows.push(row);
        }
        let (gone, spent) = if warm.0 > 0.0 { warm } else { all };
        let (time, series, phases) = (simulation.clock().time, rows.time_series(place), phases(simulation));
        let reaches_scene_end = prepared.schedule.until.has_been_reached(&simulation.clock());
        let warnings = simulation.warnings();
        let watched = simulation.summary().get(&format!("largest_{}", quantities[place].name)).cloned();
        let near = spent / gone;
        let [cost, row] = match of_stretch {
            Some(of_stretch) => self.costs(simulation, stride, (near, of_stretch))?,
            None => [near, self.timed_row(simulation)],
        };
        Ok(TrialSample {
            cost,
            row,
            start,
            seconds: self.watch.now() - begun,
            time,
            outcome: Average::of(&rows, place).outcome,
            reaches_scene_end,
            warnings,
            series,
            phases,
            states: states.kept,
            rows: all_rows,
            observed: (quantities[place].kind, place),
            watched: watched.and_then(|it| it.as_f64()).map(f64::abs),
            loses,
        })
    }

    /// Advances by one stretch.
    fn advance(&self, simulation: &mut dyn Simulation, stretch: Until) -> Result<(), PhysicsFailure> {
        let end = stretch.after(&simulation.clock());
        self.advance_to(simulation, &[end])
    }

    /// Advances to the first of some moments.
    fn advance_to(&self, simulation: &mut dyn Simulation, moments: &[Until]) -> Result<(), PhysicsFailure> {
        self.watch.during(simulation, |it| it.advance(moments, self.stop))
    }

    /// Wall seconds of a unit of time without rows, and of a row. Longer stretches cost less per unit of time by their share of a row, which takes
    /// more than its observation.
    fn costs(
        &self,
        simulation: &mut dyn Simulation,
        stride: Until,
        (near, seconds): (f64, f64),
    ) -> Result<[f64; 2], PhysicsFailure> {
        let of_look = self.timed_row(simulation);
        let farther = (0..FARTHER).fold(stride, |stride, _| stride.doubled());
        let (begun, from) = (self.watch.now(), simulation.clock().time);
        let mut stretches = 0.0;
        while self.watch.now() - begun < seconds && !self.stop.load(Ordering::Relaxed) {
            self.advance(simulation, farther)?;
            stretches += 1.0;
        }
        let gone = simulation.clock().time - from;
        if stretches < FEW {
            return Ok([near, of_look]);
        }
        let far = (self.watch.now() - begun) / gone;
        // By hand, for costs c and r in stretches of L and F L: near = c + r/L, far = c + r/(F L).
        let factor = 2f64.powi(FARTHER);
        let each = gone / stretches / factor;
        let of_stretch = ((near - far) * each / (1.0 - 1.0 / factor)).max(0.0);
        Ok([far.min(near) - of_stretch / (factor * each), of_look + of_stretch])
    }

    /// Wall seconds of a row, the least of several.
    fn timed_row(&self, simulation: &dyn Simulation) -> f64 {
        let once = |_| {
            let begun = self.watch.now();
            let _row = simulation.observe();
            self.watch.now() - begun
        };
        (0..3).map(once).fold(f64::INFINITY, f64::min)
    }

    /// Stretch that takes between `least` and `most` seconds. It consists of steps, fewer than [`STEPS`] only where more would exceed `most`, or, for
    /// a method without steps, of a part of the time between rows.
    fn stride(
        &self,
        simulation: &mut dyn Simulation,
        prepared: &Prepared,
        [least, most]: [f64; 2],
    ) -> Result<Until, PhysicsFailure> {
        let mut stride = first(prepared);
        loop {
            let begun = self.watch.now();
            self.advance(simulation, stride)?;
            let spent = 2.0 * (self.watch.now() - begun);
            let is_long = !matches!(stride, Until::Steps(steps) if steps < STEPS);
            if spent > most || is_long && spent > least || self.stop.load(Ordering::Relaxed) {
                return Ok(stride);
            }
            stride = stride.doubled();
        }
    }

    /// Times a scene without rows.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if it fails.
    pub(crate) fn timed(&self, prepared: &Prepared, seconds: f64) -> Result<UnitCost, PhysicsFailure> {
        const STRETCHES: u32 = 4;
        let mut simulation = prepared.start(StartPurpose::Run)?;
        let simulation = simulation.as_mut();
        let stride = self.stride(simulation, prepared, [seconds / f64::from(STRETCHES); 2])?;
        let mut least = f64::INFINITY;
        for _ in 0..STRETCHES {
            let (from, begun) = (simulation.clock().time, self.watch.now());
            self.advance(simulation, stride)?;
            least = least.min((self.watch.now() - begun) / (simulation.clock().time - from));
        }
        Ok(UnitCost { seconds: least, phases: phases(simulation) })
    }
}

/// States along a run of unknown length: once there are too many, every other one is dropped and the spacing doubles. Where forces depend on
/// time, states are taken at whole periods: a run from such a state begins at time 0 with the right forces.
struct StateSamples {
    period: Option<f64>,
    most: usize,
    every: usize,
    seen: usize,
    kept: Vec<(f64, Particles)>,
}

impl StateSamples {
    fn new(prepared: &Prepared) -> StateSamples {
        let most = (KEPT / prepared.particles().len().max(1)).clamp(4, STATES);
        StateSamples { period: prepared.model.period(), most, every: 1, seen: 0, kept: vec![] }
    }

    /// Time of the next state (time): now, or the end of the current period.
    fn next(&self, now: f64) -> f64 {
        self.period.map_or(now, |period| period * (now / period).floor() + period)
    }

    /// Records the state, if the run has reached the moment.
    fn look(&mut self, simulation: &dyn Simulation, moment: f64) {
        if simulation.clock().time < moment {
            return;
        }
        self.seen += 1;
        if !self.seen.is_multiple_of(self.every) {
            return;
        }
        self.kept.push((simulation.clock().time, simulation.particles()));
        if self.kept.len() > self.most {
            let mut number = 0;
            self.kept.retain(|_| {
                number += 1;
                number % 2 == 0
            });
            self.every *= 2;
        }
    }
}

/// Stretch between rows of the scene; none where it writes no rows.
fn own_rows(prepared: &Prepared) -> Option<Until> {
    match prepared.schedule.rows {
        Every::Steps(steps) => Some(Until::Steps(steps)),
        Every::Time(time) => Some(Until::Time(time)),
        Every::Never | Every::Seconds(_) => None,
    }
}

/// Shortest stretch: a step, or, for a method without steps, a part of the time between rows.
fn first(prepared: &Prepared) -> Until {
    match (prepared.schedule.until, prepared.schedule.rows) {
        (Until::Steps(_), _) => Until::Steps(1),
        (_, Every::Time(time)) => Until::Time(time / 64.0),
        (Until::Time(time), _) => Until::Time(1e-6 * time),
        (Until::Events(_), _) => Until::Time(1e-6),
    }
}

/// Cost of a unit of time.
#[derive(Clone, Debug)]
pub(crate) struct UnitCost {
    /// Wall seconds in the fastest of some stretches.
    pub seconds: f64,
    /// Wall seconds in each phase, by name, over all stretches.
    pub phases: Vec<(String, f64)>,
}

/// Wall seconds of a unit of time in each phase of a run so far, by name.
fn phases(simulation: &dyn Simulation) -> Vec<(String, f64)> {
    let time = simulation.clock().time;
    simulation.phases().into_iter().map(|(name, spent)| (name.to_owned(), spent / time)).collect()
}
