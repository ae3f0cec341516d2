//! Theoretical limits of a scene's step.

use super::contact::HeadOn;
use super::step_matrix::largest_step;
use crate::method::lattice_md::check::{CheckedGranularScene, FASTEST, FEWEST_STEPS, LEAST_STEPS, NETWORK};
use crate::method::{LimitConsequence, StepLimit};
use crate::number::significant;
use crate::particles::longest_step;
use crate::units::with_symbol;

/// Packing fraction above which discs have several contacts at once even without gravity and dissipation.
const DENSE: f64 = 0.5;

/// Multiple of an unstable step beyond which the user is warned. Limits assume the stiffest case: three simultaneous contacts of a disc, or an
/// approach at three times the typical speed. A single contact at the typical speed has a third of the stiffness and allows √3 times the step of the
/// three. Up to there most runs are right, and the energy balance finds the others.
const UNSTABLE_ALONE: f64 = 1.732_050_807_568_877_2;

/// Returns all limits of a scene's step.
pub(crate) fn step_limits(checked: &CheckedGranularScene) -> Vec<StepLimit> {
    let all = [
        one_contact(checked),
        packing(checked),
        friction(checked),
        followed(checked),
        fewest(checked),
        mask(checked),
    ];
    all.into_iter().flatten().collect()
}

/// Head-on contact of the lightest grains at a multiple of the typical speed of approach.
pub(crate) fn contact(checked: &CheckedGranularScene, faster: f64) -> HeadOn {
    let masses = checked.particles.grains().iter().map(|disc| disc.mass);
    HeadOn {
        law: checked.scene.law.contact,
        speed: faster * checked.estimates.approach_speed,
        effective_mass: 0.5 * masses.fold(f64::INFINITY, f64::min),
    }
}

fn in_units(checked: &CheckedGranularScene, number: f64, dimension: &str) -> String {
    with_symbol(&significant(number, 4), &checked.scene.units, dimension)
}

fn one_contact(checked: &CheckedGranularScene) -> Option<StepLimit> {
    let (scheme, [damping, _]) = (checked.scene.integrator.scheme, checked.scene.dampings());
    let contact = contact(checked, FASTEST);
    let step = largest_step(scheme, contact.stiffest(), damping)?;
    let why = format!(
        "largest eigenvalue of the step matrix of {} on the spring and damper of a contact at {FASTEST} times the typical speed, \
         {}: ω = {}, γ = {}",
        scheme.name(),
        in_units(checked, contact.speed, "length/time"),
        in_units(checked, contact.stiffest().sqrt(), "1/time"),
        in_units(checked, damping, "1/time")
    );
    Some(StepLimit {
        name: "one contact",
        step,
        share: checked.scene.integrator.dt / step,
        warned_beyond: UNSTABLE_ALONE,
        beyond: LimitConsequence::Unstable,
        why,
    })
}

/// Limit for discs pressed from all sides.
fn packing(checked: &CheckedGranularScene) -> Option<StepLimit> {
    let (scheme, law) = (checked.scene.integrator.scheme, &checked.scene.law.contact);
    let discs = checked.particles.all().iter().map(|disc| std::f64::consts::PI * disc.radius.powi(2));
    let is_dense = discs.sum::<f64>() > DENSE * checked.domain.area();
    let settles = checked.scene.domain.gravity != [0.0; 2] || law.normal_damping > 0.0;
    if checked.particles.grain_count() < 3 || !(is_dense || settles) {
        return None;
    }
    let contact = contact(checked, 1.0);
    let [damping, _] = checked.scene.dampings();
    let step = largest_step(scheme, NETWORK * contact.stiffest(), NETWORK * damping)?;
    let why = format!(
        "largest eigenvalue of the step matrix with {NETWORK} times spring and damper of a contact at the typical speed, {}: a disc pressed from all sides",
        in_units(checked, contact.speed, "length/time")
    );
    Some(StepLimit {
        name: "dense packing",
        step,
        share: checked.scene.integrator.dt / step,
        warned_beyond: UNSTABLE_ALONE,
        beyond: LimitConsequence::Unstable,
        why,
    })
}

/// Limit for the drag that slows both surfaces of a pair: γ_S M_eff (1/m + 1/m + R²/I + R²/I).
fn friction(checked: &CheckedGranularScene) -> Option<StepLimit> {
    let law = &checked.scene.law;
    let [_, damping] = checked.scene.dampings();
    let rate = damping * (1.0 + 1.0 / law.inertia.factor());
    let step =
        largest_step(checked.scene.integrator.scheme, 0.0, rate).filter(|_| checked.scene.has_friction())?;
    let why = format!(
        "largest eigenvalue of the step matrix on the drag of friction between two surfaces: rate {}",
        in_units(checked, rate, "1/time")
    );
    Some(StepLimit {
        name: "drag of friction",
        step,
        share: checked.scene.integrator.dt / step,
        warned_beyond: UNSTABLE_ALONE,
        beyond: LimitConsequence::Unstable,
        why,
    })
}

fn of_duration(
    checked: &CheckedGranularScene,
    name: &'static str,
    steps: f64,
    warned_beyond: f64,
) -> Option<StepLimit> {
    let contact = contact(checked, 1.0);
    let duration = contact.duration();
    let why = format!(
        "an undamped contact at the typical speed, {}, lasts {}",
        in_units(checked, contact.speed, "length/time"),
        in_units(checked, duration, "time")
    );
    let is_known = duration.is_finite() && duration > 0.0;
    let step = duration / steps;
    is_known.then(|| StepLimit {
        name,
        step,
        share: checked.scene.integrator.dt / step,
        warned_beyond,
        beyond: LimitConsequence::Inaccurate,
        why,
    })
}

fn followed(checked: &CheckedGranularScene) -> Option<StepLimit> {
    // With fewer steps single contacts err by percents, which averages over many contacts seldom show.
    of_duration(checked, "15 steps a contact", LEAST_STEPS, f64::INFINITY)
}

fn fewest(checked: &CheckedGranularScene) -> Option<StepLimit> {
    of_duration(checked, "3 steps a contact", FEWEST_STEPS, 1.0)
}

/// Limit for the fastest disc of the start, beyond which contacts are missed.
fn mask(checked: &CheckedGranularScene) -> Option<StepLimit> {
    let speeds = checked.particles.all().iter().map(|disc| disc.velocity[0].hypot(disc.velocity[1]));
    let fastest = speeds.fold(0.0, f64::max).max(checked.estimates.approach_speed);
    let depth = checked.scene.law.max_penetration;
    let longest = longest_step(checked.geometry.radii[0], depth);
    let why = format!(
        "a disc at {fastest} may move {longest} in a step; beyond, contacts deeper than law.max_penetration = {depth} may \
         be missed",
        fastest = in_units(checked, fastest, "length/time"),
        longest = in_units(checked, longest, "length")
    );
    let step = longest / fastest;
    let share = checked.scene.integrator.dt / step;
    (fastest > 0.0).then_some(StepLimit {
        name: "mask",
        step,
        share,
        warned_beyond: 1.0,
        beyond: LimitConsequence::Unseen,
        why,
    })
}
