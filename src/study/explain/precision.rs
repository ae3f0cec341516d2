//! The error of a mean over the time that it takes, by way and step, as measured: one long run of each is cut into shorter ones, whose means are
//! held against the reference.

use super::findings::{SHARES, Way, Work};
use super::sample::{Known, Sample};
use super::{ExplainError, Target};
use crate::study::Case;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use stripmine_physics::method::Decides;

/// Ways that are measured, and the steps of each in parts of its longest.
const WAYS: usize = 2;
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];
/// Pieces that an error is of, at least.
const FEWEST: usize = 6;
/// A step that breaks or is warned of is halved so often.
const HALVINGS: usize = 4;

/// A way and a step, measured.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The way.
    pub way: String,
    /// The step (time); none where the method takes none.
    pub step: Option<f64>,
    /// Wall seconds of a unit of time.
    pub cost: f64,
    /// The mean, and half the width of its interval of 95 %; none where it has none.
    pub mean: Option<[f64; 2]>,
    /// By rising length of run: its wall seconds after the transient, the root of the mean square of what its mean is off, and of how many runs that is.
    pub points: Vec<[f64; 3]>,
}

/// What was measured of a scene.
#[derive(Clone, Debug)]
pub struct Precision {
    /// The quantity.
    pub quantity: &'static str,
    /// Its unit, empty for a pure number.
    pub unit: &'static str,
    /// The mean that all are held against, and half the width of its interval of 95 %.
    pub reference: [f64; 2],
    /// Its way.
    pub reference_way: String,
    /// Its step (time).
    pub reference_step: Option<f64>,
    /// The transient, which no run counts (time).
    pub transient: f64,
    /// What was measured.
    pub curves: Vec<Curve>,
    /// What was not, with the reason.
    pub left_out: Vec<(String, String)>,
}

/// Measures a scene in about some seconds.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity comes to no mean.
pub fn precision(
    case: &Case,
    target: &Target,
    seconds: f64,
    stop: &AtomicBool,
    progress: &dyn Fn(f64),
) -> Result<Precision, ExplainError> {
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let mut work = Work { case, target, seconds, end, stop, whole: None };
    let ways = work.timed_ways()?;
    progress(SHARES[0]);
    let reference = work.reference(&ways)?;
    progress(SHARES[0] + SHARES[1]);
    let (mut chosen, mut left_out): (Vec<&Way>, Vec<(String, String)>) = (vec![], vec![]);
    for way in &ways {
        let own = work.choice(way);
        // Of each integrator the cheapest; where there are none, of each engine.
        let is_another = chosen.iter().all(|it| {
            let other = work.choice(it);
            !own.agrees(&other, Decides::Order)
                || own.scheme().is_none() && !own.agrees(&other, Decides::Cost)
        });
        match &way.dropped {
            Some(why) => left_out.push((way.label.clone(), why.clone())),
            None if is_another && chosen.len() < WAYS => chosen.push(way),
            None => {}
        }
    }
    let steps = if case.entry.trials.is_some() { &STEPS[..] } else { &STEPS[..1] };
    let share = 1.0 - SHARES[0] - SHARES[1];
    let each = work.left() / (chosen.len() * steps.len()).max(1) as f64;
    let (mut curves, mut samples) = (vec![], vec![]);
    for (at, way) in chosen.iter().enumerate() {
        let mut longest = way.step;
        for (number, part) in steps.iter().enumerate() {
            for _ in 0..HALVINGS {
                let step = longest.map(|step| part * step);
                let what = || step.map_or(way.label.clone(), |step| format!("{} at {step:.3e}", way.label));
                match work.sampled(way, step, each) {
                    Ok(sample) if sample.warnings.is_empty() => {
                        samples.push((way.label.clone(), step, sample));
                        break;
                    }
                    Ok(sample) => left_out.push((what(), sample.warned())),
                    Err(why) => left_out.push((what(), why)),
                }
                longest = longest.map(|step| 0.5 * step);
            }
            let done = (at * steps.len() + number + 1) as f64 / (chosen.len() * steps.len()) as f64;
            progress(SHARES[0] + SHARES[1] + share * done);
        }
    }
    // What finds the end of a transient errs to the later side.
    let known = samples.iter().filter_map(|(_, _, sample)| sample.known());
    let transient = known.map(|it| it.transient).fold(reference.known.transient, f64::min);
    let Known { mean, bar, .. } = reference.known;
    for (way, step, sample) in samples {
        curves.push(Curve {
            points: points(&sample, transient, mean),
            mean: sample.known().map(|known| [known.mean, known.bar]),
            way,
            step,
            cost: sample.cost,
        });
    }
    Ok(Precision {
        quantity: target.quantity.name,
        unit: target.quantity.unit,
        reference: [mean, bar],
        reference_way: reference.way,
        reference_step: reference.step,
        transient,
        curves,
        left_out,
    })
}

/// The long run cut into equal ones, half as many each time.
fn points(sample: &Sample, transient: f64, truth: f64) -> Vec<[f64; 3]> {
    let after = sample.series.iter().filter(|[time, _]| *time > transient);
    let values: Vec<f64> = after.map(|[_, value]| *value).collect();
    let lengths = (0..).map(|power| 1_usize << power).take_while(|length| values.len() / length >= FEWEST);
    let of = |length: usize| {
        let means = values.chunks_exact(length).map(|piece| piece.iter().sum::<f64>() / length as f64);
        let squares: Vec<f64> = means.map(|mean| (mean - truth).powi(2)).collect();
        let runs = squares.len() as f64;
        [sample.cost * sample.spacing * length as f64, (squares.iter().sum::<f64>() / runs).sqrt(), runs]
    };
    lengths.map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::averages::Outcome;

    /// Independent values about 1 that are held against 0.9: the error falls with the root of the length, down to 0.1.
    #[test]
    fn errors_fall_to_what_is_left_of_bias() {
        let mut state = 1_u64;
        let mut value = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            1.0 + 2.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let series = (1..=4096_u32).map(|row| [0.5 * f64::from(row), value()]).collect();
        let outcome = Outcome::Constant { mean: 1.0 };
        let sample = Sample {
            cost: 2.0,
            row: 0.0,
            start: 0.0,
            seconds: 0.0,
            time: 2048.0,
            outcome,
            comes_beyond_end: false,
            warnings: vec![],
            series,
            spacing: 0.5,
            phases: vec![],
        };
        let points = points(&sample, 0.0, 0.9);
        assert_eq!(points.iter().map(|[seconds, ..]| *seconds).take(3).collect::<Vec<_>>(), [1.0, 2.0, 4.0]);
        let expected = |length: f64| (1.0 / (3.0 * length) + 0.01).sqrt();
        for [seconds, error, runs] in points {
            let wide = 4.0 / runs.sqrt();
            assert!((error / expected(seconds) - 1.0).abs() < wide, "{seconds}: {error}");
        }
    }
}
