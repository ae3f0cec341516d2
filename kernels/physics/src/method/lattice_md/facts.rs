//! Reported properties of a scene.

use super::check::CheckedGranularScene;
use super::theory::limits;
use super::theory::trial_contact::contact_error;
use crate::method::Fact;
use crate::number::{of_limit, significant};
use crate::units::with_symbol;
use crate::words::Words;
use serde_json::json;

/// Returns all facts of a scene.
pub(super) fn facts(checked: &CheckedGranularScene) -> Vec<Fact> {
    let CheckedGranularScene { scene, domain, particles, alike, geometry, estimates: e, .. } = checked;
    let or_none = |value: Option<f64>, words: fn(f64) -> String| value.map_or("nothing moves".into(), words);
    let in_units = |number: f64, digits: usize, dimension| {
        with_symbol(&significant(number, digits), &scene.units, dimension)
    };
    let (grains, walls) = (particles.grain_count(), particles.len() - particles.grain_count());
    let mut facts = vec![
        Fact::new("units", scene.units.as_str(), "units", scene.units.as_str()),
        Fact::new("grains", grains, "grains", grains.to_string()),
        Fact::new("wall_discs", walls, "wall discs", walls.to_string()),
        Fact::data("plane_walls", checked.walls.all().len()),
        Fact::data("discs_alike", *alike),
        Fact::new("radii", json!(geometry.radii), "radii", range(geometry.radii, &scene.units)),
        Fact::data("origin", json!(domain.corner())),
        Fact::new("sides", json!(domain.lengths()), "box", sides(domain.lengths(), &scene.units)),
        Fact::data("periodic", json!(domain.periodic())),
        Fact::data("search", scene.search.by.word()),
        Fact::data("engine", scene.machine.engine.word()),
    ];
    if !checked.walls.is_empty() {
        let (user, all) = (scene.plane.list.len(), checked.walls.all().len());
        let sides = if all > user { format!(", {} closed sides", all - user) } else { String::new() };
        facts.push(Fact::words("plane walls", format!("{user} segments{sides}")));
    }
    if scene.needs_lattice() {
        facts.extend(lattice_facts(checked));
    }
    facts.extend([
        Fact::data("dt", scene.integrator.dt),
        Fact::new("steps", scene.run.steps, "steps", {
            let [dt, duration] =
                [scene.integrator.dt, scene.duration()].map(|time| in_units(time, 7, "time"));
            format!("{} of {dt}, {duration} in total", scene.run.steps)
        }),
        Fact::data("duration", scene.duration()),
        Fact::new("estimates", json!(e), "approach speed", in_units(e.approach_speed, 5, "length/time")),
        Fact::words("steps per contact", or_none(e.steps_per_contact, |steps| format!("{steps:.1}"))),
        Fact::words(
            "penetration of an impact",
            format!("{} diameters", significant(e.impact_penetration, 4)),
        ),
        Fact::words("damping of a step", {
            let [alone, dense] = [e.damping, e.network_damping].map(|it| of_limit(it / e.damping_limit));
            format!(
                "γ dt is {alone} the limit {}; {dense} it in dense packings",
                significant(e.damping_limit, 4)
            )
        }),
    ]);
    facts
}

/// Formats two lengths of any unit.
fn sides(sides: [f64; 2], units: &str) -> String {
    with_symbol(&sides.map(|side| significant(side, 7)).join(" × "), units, "length")
}

/// Formats a range of lengths.
fn range(ends: [f64; 2], units: &str) -> String {
    with_symbol(&ends.map(|end| significant(end, 7)).join(" to "), units, "length")
}

/// Returns the facts about the lattice of a scene that needs one.
fn lattice_facts(checked: &CheckedGranularScene) -> Vec<Fact> {
    let (geometry, units) = (&checked.geometry, &checked.scene.units);
    let [columns, rows] = [geometry.shape.columns(), geometry.shape.rows()];
    let mask = 2 * geometry.mask.half_width() + 1;
    vec![
        Fact::data("columns", columns),
        Fact::data("rows", rows),
        Fact::new("cells", columns * rows, "cells", format!("{columns} × {rows} = {}", columns * rows)),
        Fact::new("cell_edges", json!(geometry.frame.edge), "cell", sides(geometry.frame.edge, units)),
        Fact::new("cell_edge_bounds", json!(geometry.edge_bounds), "cell edge allowed", {
            range(geometry.edge_bounds, units)
        }),
        Fact::new("mask", mask, "mask", format!("{mask} × {mask}")),
        Fact::new("occupancy", geometry.occupancy, "occupancy", significant(geometry.occupancy, 4)),
    ]
}

/// Energy error of a contact at the typical speed; none where nothing moves.
pub(super) fn expected_error(checked: &CheckedGranularScene) -> Option<Fact> {
    let CheckedGranularScene { scene, estimates, .. } = checked;
    let (contact, integrator) = (limits::contact(checked, 1.0), &scene.integrator);
    let error = contact_error(contact, integrator.scheme, integrator.dt)?;
    let most = if error.step > integrator.dt { "at most " } else { "" };
    let words = format!(
        "{most}{} of its energy, falling as dt^{:.1}; by {} trials at {}",
        significant(error.energy, 2),
        error.order,
        error.phases,
        with_symbol(&significant(estimates.approach_speed, 4), &scene.units, "length/time")
    );
    Some(Fact::new("expected_error", json!(error), "error of a contact", words))
}
