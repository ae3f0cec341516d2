//! What a diagram says, in plain words: which way and which step for which wish.

use super::dataset::{Run, WorkPrecision};
use super::measures::Measure;

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

/// A step as a multiple of the scene's own.
pub fn multiple(power: i32) -> String {
    match power {
        0 => "its own step".to_owned(),
        1.. => format!("{} times its own step", 1_u64 << power),
        _ => format!("1/{} of its own step", 1_u64 << -power),
    }
}

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
