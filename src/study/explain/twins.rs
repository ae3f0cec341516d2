//! What a scene may be modelled without, and what that changes and saves.

use super::findings::{SHARES, Way, Without, Work};
use super::reference::no_mean;
use super::sample::Known;
use super::whole::Warned;
use stripmine_physics::method::{Prepared, Twin};
use stripmine_physics::scene::Overrides;

impl Work<'_> {
    /// The scene without each of what it may be modelled without.
    pub(super) fn without(&self, way: &Way, reference: &Known) -> Vec<Without> {
        let twins: Vec<(&Twin, Overrides)> = self
            .case
            .entry
            .twins
            .iter()
            .filter_map(|twin| Some((twin, (twin.overrides)(&self.case.values)?)))
            .collect();
        let seconds = SHARES[3] * self.seconds / twins.len().max(1) as f64;
        let shortest =
            |prepared: &Prepared| prepared.step_limits.iter().map(|limit| limit.step).reduce(f64::min);
        let of_scene = self.prepared(&way.overrides, None).ok().as_ref().and_then(shortest);
        let measured = |(twin, overrides): (&Twin, Overrides)| {
            let more = [&way.overrides[..], &overrides].concat();
            let of = |failed: Option<String>| Without {
                name: twin.name.to_owned(),
                difference: None,
                cost: None,
                failed,
            };
            let prepared = match self.prepared(&more, None) {
                Ok(prepared) => prepared,
                Err(why) => return of(Some(why)),
            };
            // As far below its own limit as the way is below that of the scene.
            let longer = shortest(&prepared).zip(of_scene).map_or(1.0, |(own, of_scene)| own / of_scene);
            let step = way.step.map(|step| step * longer);
            let twin_way = Way { overrides: more, ..way.clone() };
            match self.measured(&twin_way, step, seconds, Warned::GoesOn) {
                Ok((sample, known)) => Without {
                    difference: known
                        .map(|known| [known.mean - reference.mean, known.bar.hypot(reference.bar)]),
                    cost: way.cost.map(|cost| sample.cost / cost),
                    ..of(known.is_none().then(|| no_mean(&sample)))
                },
                Err(why) => of(Some(why)),
            }
        };
        twins.into_iter().map(measured).collect()
    }
}
