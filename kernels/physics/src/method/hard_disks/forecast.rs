//! Cost forecast of a run of hard discs: collisions per time, and the number of rows and frames.

use super::checked::CheckedHardDisks;
use super::keys::{CHECKPOINT_EVERY, EVENTS, MOST_EVENTS, SNAPSHOT_EVERY, THERMO_EVERY, TIME};
use super::options::EngineChoice;
use crate::method::{Every, Until};
use crate::number::significant;
use crate::particles::Particle;
use crate::scene::{MistakeKind, SceneError, SceneValues};
use std::f64::consts::{PI, SQRT_2, TAU};

/// Maximum number of rows, snapshots or checkpoints of a run.
const MOST_WRITTEN: f64 = 1e12;

/// Nanoseconds per collision by packing fraction, for the fast and the reference engine. Measured by the item
/// `hard-disks-rates` with 2500 discs. In larger systems collisions take longer, so sampling takes a smaller share than requested.
const COLLISION: [(f64, [f64; 2]); 5] = [
    (0.1, [1310.0, 3550.0]),
    (0.3, [790.0, 2260.0]),
    (0.5, [500.0, 1830.0]),
    (0.65, [400.0, 1810.0]),
    (0.7, [380.0, 1830.0]),
];

/// Nanoseconds per collision in a scene.
pub(super) fn nanoseconds_per_collision(checked: &CheckedHardDisks) -> f64 {
    interpolated_nanoseconds(checked.packing_fraction(), checked.scene.engine)
}

/// Nanoseconds per collision at a packing fraction: interpolated within the table, constant beyond its ends.
fn interpolated_nanoseconds(fraction: f64, engine: EngineChoice) -> f64 {
    let column = usize::from(engine == EngineChoice::Reference);
    let [(first, lowest), .., (_, highest)] = COLLISION;
    let between = COLLISION.windows(2).find(|ends| (ends[0].0..=ends[1].0).contains(&fraction));
    match between {
        Some(&[(low, at_low), (high, at_high)]) => {
            at_low[column] + (fraction - low) / (high - low) * (at_high[column] - at_low[column])
        }
        _ if fraction < first => lowest[column],
        _ => highest[column],
    }
}

/// Enskog's collision rate per disc, each collision counted once for the pair, at a thermal speed √(kT/m).
pub(super) fn enskog_collision_rate(checked: &CheckedHardDisks, speed: f64) -> f64 {
    let count = checked.particles.len() as f64;
    let [x, y] = checked.domain.lengths();
    let diameter = 2.0 * mean(checked, |disc| disc.radius);
    let square = mean(checked, |disc| (disc.radius / x) * (disc.radius / y));
    let fraction = (PI * square * count).min(0.9);
    let at_contact = (1.0 - 7.0 / 16.0 * fraction) / (1.0 - fraction).powi(2);
    PI.sqrt() * (count / x) * (diameter / y) * at_contact * speed
}

/// Thermal speed √(kT/m) of the discs at the start (length/time).
pub(super) fn thermal_speed(checked: &CheckedHardDisks) -> f64 {
    let largest = checked.particles.all().iter().map(speed_of).fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    // Relative to the largest speed, because squares of extreme speeds overflow or underflow.
    largest * mean(checked, |disc| (speed_of(disc) / largest).powi(2)).sqrt() / SQRT_2
}

fn speed_of(disc: &Particle) -> f64 {
    let [x, y] = disc.planar_velocity();
    x.hypot(y)
}

fn mean(checked: &CheckedHardDisks, of: impl Fn(&Particle) -> f64) -> f64 {
    let discs = checked.particles.all();
    discs.iter().map(of).sum::<f64>() / discs.len() as f64
}

/// Rate of all collisions, of pairs and at sides, at the speeds due to the start, gravity, a thermal side and a floor.
fn rate(checked: &CheckedHardDisks) -> f64 {
    let (scene, domain) = (&checked.scene, &checked.domain);
    let fall = |axis: usize| (scene.domain.gravity[axis].abs() * domain.length(axis)).sqrt();
    let heated = |temperature: f64| temperature.sqrt() / mean(checked, |disc| disc.mass).sqrt();
    let speed = thermal_speed(checked)
        + fall(0)
        + fall(1)
        + scene.law.thermal.map_or(0.0, |thermal| heated(thermal.temperature))
        + scene.law.floor.map_or(0.0, |floor| TAU * floor.amplitude * floor.frequency);
    let at_sides = (0..2).filter(|&axis| !domain.is_periodic(axis)).map(|axis| speed / domain.length(axis));
    (enskog_collision_rate(checked, speed) + at_sides.sum::<f64>()) * checked.particles.len() as f64
}

impl CheckedHardDisks {
    /// Error for a run that could never finish: too many collisions, rows, snapshots or checkpoints.
    pub(super) fn endless(&self, values: &SceneValues) -> Option<SceneError> {
        let (run, rate) = (&self.scene.run, rate(self));
        let number = |value: f64| significant(value, 3);
        let duration = match run.until {
            Until::Time(time) => {
                if time * rate > MOST_EVENTS as f64 {
                    let message = format!(
                        "`{}` = {} takes about {} collisions at the speeds due to the start, gravity and the sides",
                        TIME.path(),
                        number(time),
                        number(time * rate)
                    );
                    let error = values.spot(&TIME).error(MistakeKind::Range, message);
                    return Some(error.expecting(format!(
                        "a time of at most {}, for {} collisions",
                        number(MOST_EVENTS as f64 / rate),
                        number(MOST_EVENTS as f64)
                    )));
                }
                time
            }
            Until::Events(events) => events as f64 / rate,
            Until::Steps(_) => return None,
        };
        let schedule = run.schedule();
        let written = [
            (&THERMO_EVERY, schedule.rows, "rows"),
            (&SNAPSHOT_EVERY, schedule.snapshots, "snapshots"),
            (&CHECKPOINT_EVERY, schedule.checkpoints, "checkpoints"),
        ];
        written.into_iter().find_map(|(key, every, what)| {
            let Every::Time(every) = every else { return None };
            let too_many = duration / every > MOST_WRITTEN;
            too_many.then(|| {
                let length = match run.until {
                    Until::Events(events) => format!("the duration of `{}` = {events}", EVENTS.path()),
                    _ => format!("`{}` = {}", TIME.path(), number(duration)),
                };
                let message = format!(
                    "`{}` = {} makes about {} {what} in {length}",
                    key.path(),
                    number(every),
                    number(duration / every)
                );
                let error = values.spot(key).error(MistakeKind::Range, message);
                error.expecting(format!("0 for none, or at least {}", number(duration / MOST_WRITTEN)))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, load};

    /// Expected work by hand: √π ρ d χ(ν) √(kT/m) collisions per disc, at the rate measured for the density (million per second).
    #[test]
    fn expected_work_matches_measured_rates() {
        for (fraction, engine, rate) in [
            (0.1, "auto", 0.764),
            (0.3, "fast", 1.272),
            (0.5, "auto", 2.02),
            (0.65, "auto", 2.493),
            (0.7, "auto", 2.64),
            (0.5, "reference", 0.5466),
            (0.7, "reference", 0.5478),
        ] {
            let sets = [
                "particles.generate=\"hexagonal\"".to_owned(),
                format!("particles.packing_fraction={fraction}"),
                "particles.count=400".to_owned(),
                "particles.temperature=4.0".to_owned(),
                format!("machine.engine={engine}"),
            ];
            let (prepared, _) = load("hard-disks", &sets, METHODS).unwrap();
            let density = 4.0 * fraction / PI;
            let at_contact = (1.0 - 7.0 / 16.0 * fraction) / (1.0 - fraction).powi(2);
            let collisions = PI.sqrt() * density * at_contact * 2.0;
            let work = prepared.model.work();
            let expected = 1000.0 / rate * collisions;
            assert!((work / expected - 1.0).abs() < 0.1, "{fraction} {engine}: {work} ns, not {expected}");
        }
    }

    #[test]
    fn collision_costs_are_interpolated() {
        for (fraction, cost) in [(0.0, 1310.0), (0.2, 1050.0), (0.6, 433.333), (0.8, 380.0)] {
            let found = interpolated_nanoseconds(fraction, EngineChoice::Fast);
            assert!((found - cost).abs() < 1e-2, "{fraction}: {found}");
        }
    }
}
