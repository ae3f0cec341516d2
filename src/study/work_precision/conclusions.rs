//! What a diagram says, in plain words: which way and which step for which wish.

use super::dataset::{Run, WorkPrecision};
use super::measures::Measure;
use crate::study::observables::CHANCE;
use stripmine_physics::number::in_tens;

/// Wishes: errors of positions (the method's length).
pub const WISHES: [f64; 5] = [3e-2, 1e-2, 1e-3, 1e-4, 1e-6];

/// The cheapest run that fulfils a wish.
#[derive(Clone, Copy, Debug)]
pub struct Fulfilled<'d> {
    /// The error that is wished for at most (the method's length).
    pub wish: f64,
    /// The run.
    pub run: &'d Run,
    /// Its cost over that of the scene's own way with its own step; none where that one breaks.
    pub of_own: Option<f64>,
}

/// A wish for which no way is recommended.
#[derive(Clone, Debug, PartialEq)]
pub struct Denied {
    /// The error that is wished for at most (the method's length).
    pub wish: f64,
    /// Why not.
    pub why: String,
}

/// What becomes of each wish that is above the reference's own error and that some run fulfils: the cheapest run against which
/// nothing speaks; none where nothing is decided, or something speaks against every run.
pub fn wishes(data: &WorkPrecision) -> Vec<Result<Fulfilled<'_>, Denied>> {
    let floor = data.reference.floor.get(&Measure::Position).copied().unwrap_or(0.0);
    let own = own_run(data).and_then(Run::cost);
    let answer = |wish: f64| {
        let serves = |run: &&Run| run.error(Measure::Position).is_some_and(|error| error <= wish);
        let timed = || data.runs.iter().filter(serves).filter_map(|run| Some((run, run.cost()?)));
        let cheapest = |a: &(&Run, f64), b: &(&Run, f64)| a.1.total_cmp(&b.1);
        let (first, _) = timed().min_by(cheapest)?;
        if let Some(why) = &data.undecided {
            return Some(Err(Denied { wish, why: format!("not decided: {why}") }));
        }
        let sound = timed().filter(|(run, _)| run.is_sound()).min_by(cheapest);
        Some(match sound {
            Some((run, cost)) => Ok(Fulfilled { wish, run, of_own: own.map(|own| cost / own) }),
            None => {
                let why = format!(
                    "something speaks against every way; against {} at {}: {}",
                    data.ways[first.way].label,
                    multiple(first.power),
                    first.objections.join("; ")
                );
                Err(Denied { wish, why })
            }
        })
    };
    WISHES.into_iter().filter(|wish| *wish > floor).filter_map(answer).collect()
}

/// The scene's own way with its own step.
pub fn own_run(data: &WorkPrecision) -> Option<&Run> {
    data.runs.iter().find(|run| run.power == 0 && data.ways[run.way].label == data.own)
}

/// Sentences on a scene.
pub fn sentences(data: &WorkPrecision) -> Vec<String> {
    [own(data), undecided(data), cheap(data), digits(data), orders(data), means(data), cut(data)]
        .into_iter()
        .flatten()
        .collect()
}

/// How a number with a wide range is written.
pub fn short(value: f64) -> String {
    match value.abs() {
        magnitude if (0.01..1000.0).contains(&magnitude) => {
            let decimals = if magnitude >= 10.0 { 0 } else { 2 };
            format!("{value:.decimals$}")
        }
        0.0 => "0".to_owned(),
        _ => in_tens(value, 2),
    }
}

/// A step as a multiple of the scene's own.
pub fn multiple(power: i32) -> String {
    match power {
        0 => "its own step".to_owned(),
        1.. => format!("{} times its own step", 1_u64 << power),
        _ => format!("1/{} of its own step", 1_u64 << -power),
    }
}

/// A cost below this share of another is worth a change.
pub const WORTH: f64 = 0.95;

/// The cheapest run that is as accurate as the scene's own way with its own step.
#[derive(Clone, Debug)]
pub struct AsGood {
    /// Its way.
    pub way: String,
    /// The power of two by which its step differs from the scene's own.
    pub power: i32,
    /// Its cost over that of the scene's own way.
    pub of_own: f64,
}

/// The cheapest run that is as accurate as the scene's own way and against which nothing speaks; none where nothing is decided, or the
/// scene's own way breaks or was not timed.
pub fn as_good(data: &WorkPrecision) -> Option<AsGood> {
    if data.undecided.is_some() {
        return None;
    }
    let own = own_run(data)?;
    let (error, cost) = (own.error(Measure::Position)?, own.cost()?);
    let is_as_good = |run: &&Run| run.error(Measure::Position).is_some_and(|it| it <= error);
    let as_good = data.runs.iter().filter(|run| run.is_sound()).filter(is_as_good);
    let timed = as_good.filter_map(|run| Some((run, run.cost()?)));
    let (best, least) = timed.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(AsGood { way: data.ways[best.way].label.clone(), power: best.power, of_own: least / cost })
}

fn own(data: &WorkPrecision) -> Option<String> {
    let own = own_run(data)?;
    let error = match (&own.outcome, own.error(Measure::Position)) {
        (Err(why), _) => {
            return Some(format!("The scene's own way, {}, breaks with its own step: {why}.", data.own));
        }
        (Ok(_), error) => error?,
    };
    let mut begin = format!(
        "The scene's own way, {}, errs by {} {} after a time of {}",
        data.own,
        short(error),
        data.unit,
        short(data.duration)
    );
    if !own.is_sound() {
        begin.push_str(&format!(" ({})", own.objections.join("; ")));
    }
    let Some(best) = as_good(data) else { return Some(begin + ".") };
    if best.of_own > WORTH {
        return Some(format!("{begin}; no run that is as accurate is cheaper by more than 5 %."));
    }
    Some(format!(
        "{begin}; {} at {} is at least as accurate for {:.0} % of the cost.",
        best.way,
        multiple(best.power),
        100.0 * best.of_own
    ))
}

/// Why no way is recommended.
fn undecided(data: &WorkPrecision) -> Option<String> {
    let why = data.undecided.as_ref()?;
    Some(format!(
        "Which way is the cheapest is not decided: {why}. More --budget compares a longer time, as far as trajectories are comparable."
    ))
}

/// What the largest wish costs, where that is less than the scene's own way.
fn cheap(data: &WorkPrecision) -> Option<String> {
    let it = wishes(data).into_iter().next()?.ok()?;
    let share = it.of_own.filter(|share| *share < 0.9)?;
    Some(format!(
        "For an error of at most {} {} {} at {} is the cheapest, for {:.0} % of the scene's own cost.",
        in_tens(it.wish, 1),
        data.unit,
        data.ways[it.run.way].label,
        multiple(it.run.power),
        100.0 * share
    ))
}

/// What did not fit into the time that was given.
fn cut(data: &WorkPrecision) -> Option<String> {
    // The time is divided by the coarsest step.
    let is_cut = data.duration < 0.9 * data.growth.window && !data.plan.left_out.is_empty();
    is_cut.then(|| {
        format!(
            "Trajectories are comparable up to a time of {}; more than {} did not fit into the time given.",
            short(data.growth.window),
            short(data.duration)
        )
    })
}

/// What fewer digits cost and where they stop.
fn digits(data: &WorkPrecision) -> Option<String> {
    let [first, ..] = data.reference.ways.each_ref();
    let full = data.ways.iter().find(|way| way.label == *first)?.digits.clone();
    let others: Vec<&str> = data
        .ways
        .iter()
        .map(|way| way.digits.as_str())
        .fold(
            vec![],
            |known, digits| if known.contains(&digits) { known } else { [known, vec![digits]].concat() },
        )
        .into_iter()
        .filter(|digits| *digits != full)
        .collect();
    let least = |digits: &str| {
        let of = data.runs.iter().filter(|run| data.ways[run.way].digits == digits);
        of.filter_map(|run| run.error(Measure::Position)).reduce(f64::min)
    };
    let said: Vec<String> = others
        .iter()
        .filter_map(|digits| Some(format!("{digits} no lower than {}", short(least(digits)?))))
        .collect();
    let best = short(least(&full)?);
    (!said.is_empty())
        .then(|| format!("Errors come down to {best} {} in {full}; {}.", data.unit, said.join(", ")))
}

/// Measured orders beside theory.
fn orders(data: &WorkPrecision) -> Option<String> {
    let said: Vec<String> = data
        .orders
        .iter()
        .filter(|order| order.measure == Measure::Position)
        .filter_map(|order| {
            let scheme = &data.ways[order.way].scheme;
            let theory = order.theory.map_or(String::new(), |(order, _)| format!(" (theory {order})"));
            Some(format!("{scheme} {:.2}{theory}", order.fitted?.order))
        })
        .collect();
    (!said.is_empty()).then(|| format!("Orders of convergence: {}.", said.join(", ")))
}

/// Which means differ significantly.
fn means(data: &WorkPrecision) -> Option<String> {
    let all = &data.observables.as_ref()?.comparisons;
    let significant: Vec<_> = all.iter().filter(|comparison| !comparison.reaches_zero()).collect();
    let seeds = data.seeds.len();
    Some(match significant.iter().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs())) {
        None => format!(
            "Over {seeds} seeds none of {} means over time differs significantly from that of the reference, up to the largest step tried.",
            all.len()
        ),
        Some(worst) => format!(
            "Over {seeds} seeds {} of {} means over time differ significantly from those of the reference, where chance alone makes about {:.0}; the \
             farthest off is the {} of {} with step {}, by {:.1} %.",
            significant.len(),
            all.len(),
            CHANCE * all.len() as f64,
            worst.observable,
            worst.choice,
            short(worst.step),
            100.0 * worst.difference.abs()
        ),
    })
}
