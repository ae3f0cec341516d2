//! Two discs as a scene has them, alone in a box: an encounter at a speed, as a scene of its own.

use crate::method::{Encounter, Prepared};
use toml::{Table, Value};

/// Tables of a scene that an encounter shares with it. Gravity and walls that move are not among them.
const SHARED: [&str; 6] = ["format", "units", "method", "law", "integrator", "machine"];
/// Distance of the surfaces at the start, in sums of the radii.
const GAP: f64 = 0.5;
/// Side of the box, and the place of the disc at rest, in sums of the radii.
const SIDE: f64 = 40.0;
/// The discs have parted when the first could have flown so many sums of the radii.
const FLIGHT: f64 = 6.0;

/// The scene of an encounter of two discs of mean radius and mass; none where nothing moves.
pub(super) fn encounter(prepared: &Prepared, Encounter { speed, offset }: Encounter) -> Option<String> {
    let grains = prepared.particles().grains();
    let count = grains.len() as f64;
    if !(speed > 0.0 && speed.is_finite()) || grains.is_empty() {
        return None;
    }
    let radius = grains.iter().map(|it| it.radius).sum::<f64>() / count;
    let mass = grains.iter().map(|it| it.mass).sum::<f64>() / count;
    let both = 2.0 * radius;
    let middle = 0.5 * SIDE * both;
    let before = both * ((1.0 - offset * offset).max(0.0).sqrt() + GAP);
    let pairs = |pairs: [[f64; 2]; 2]| Value::from(pairs.map(|pair| Value::from(pair.to_vec())).to_vec());
    let mut scene: Table = prepared.scene.parse().ok()?;
    scene.retain(|name, _| SHARED.contains(&name));
    let mut table = |name: &str, entries: &[(&str, Value)]| {
        let entries = entries.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
        scene.insert(name.to_owned(), Value::Table(entries.collect()));
    };
    let side = Value::from(SIDE * both);
    table(
        "domain",
        &[("sides", Value::from(vec![side.clone(), side])), ("periodic", Value::from(vec![false; 2]))],
    );
    table(
        "particles",
        &[
            ("generate", Value::from("list")),
            ("positions", pairs([[middle - before, middle], [middle, middle + offset * both]])),
            ("velocities", pairs([[0.5 * speed, 0.0], [-0.5 * speed, 0.0]])),
            ("radius", Value::from(radius)),
            ("mass", Value::from(mass)),
        ],
    );
    table("run", &[("time", Value::from(FLIGHT * both / speed))]);
    Some(scene.to_string())
}
