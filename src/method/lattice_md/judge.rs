//! What a step of granular discs is judged by: contacts that are too deep, discs that are too fast.

use super::{OnLongStep, Totals, Watch};
use crate::method::Failure;
use crate::method::pairwise::Named;

/// Counts discs that are so fast that contacts may pass unseen in a step, and stops if there must be none.
pub(super) fn judge_steps(
    discs: &impl Named,
    far: impl Iterator<Item = usize>,
    watch: Option<Watch>,
    totals: &mut Totals,
) -> Result<(), Failure> {
    let Some(watch) = watch else { return Ok(()) };
    let speed = |disc: usize| {
        let [x, y] = discs.velocity(disc);
        x.hypot(y)
    };
    // What is no number is found with the cells.
    let far: Vec<usize> = far.filter(|&disc| !speed(disc).is_nan()).collect();
    let count = far.len() as u64;
    totals.long_steps += count;
    let first = far.into_iter().min_by_key(|&disc| discs.number(disc));
    match (watch.on_long_step, first) {
        (OnLongStep::Stop, Some(first)) => {
            let limit = watch.longest_step();
            let dt = limit / speed(first);
            Err(Failure::LongStep { step: discs.step(), count, first: discs.culprit(first), limit, dt })
        }
        _ => Ok(()),
    }
}

/// Counts grains in contacts that are too deep, and stops at what must not be. A pair may be given once or from both sides.
pub(super) fn judge_depth(
    discs: &impl Named,
    pairs: impl Iterator<Item = [usize; 2]>,
    watch: Option<Watch>,
    totals: &mut Totals,
) -> Result<(), Failure> {
    let Some(watch) = watch else { return Ok(()) };
    let is_grain = |disc: &usize| discs.grains().contains(disc);
    let (mut grains, mut deepest): (Vec<usize>, Option<(f64, [usize; 2])>) = (vec![], None);
    for pair in pairs.filter(|pair| pair.iter().any(is_grain)) {
        let penetration = discs.penetration(pair);
        if penetration > watch.max_penetration {
            grains.extend(pair.iter().filter(|disc| is_grain(disc)));
            if deepest.is_none_or(|(deepest, _)| penetration > deepest) {
                deepest = Some((penetration, pair));
            }
        }
    }
    grains.sort_unstable();
    grains.dedup();
    let Some((penetration, pair)) = deepest else { return Ok(()) };
    totals.add_deep(discs.step(), grains.len() as u64, penetration);
    if penetration > watch.stop_penetration {
        let [first, second] = pair.map(|disc| discs.culprit(disc));
        let (step, limit) = (discs.step(), watch.stop_penetration);
        return Err(Failure::TooDeep { step, first, second, penetration, limit });
    }
    Ok(())
}
