//! A cold sphere that falls in on itself.

use crate::laboratory::nbody::study::collapse::{BODIES, Bound, Collapse, LATE, Moment};
use crate::report::figure::{Axis, Chart, Drawing, Figure, Guide, Picture, Series, Shape, Style, Tint};
use crate::report::section::{Film, Frame};
use crate::report::{Part, Section, Verdict};
use stripmine_physics::number::in_tens;

/// The free fall of a uniform sphere of radius and mass 1.
const FREE_FALL: f64 = std::f64::consts::PI / (2.0 * std::f64::consts::SQRT_2);
/// A virial ratio this near to 0.5 is that of equilibrium.
const WITHIN: f64 = 0.02;
/// Half of the sides of what is shown.
const WINDOW: f64 = 1.5;
/// The fastest that is told apart by its shade.
const FASTEST: f64 = 3.0;
/// How long the film is.
const FILMED: f64 = 4.0;
/// How large bodies are drawn.
const RADIUS: f64 = 0.015;

/// What came out.
pub fn section(data: &Collapse) -> Section {
    let smallest = data.moments.iter().min_by(|a, b| a.half_mass_radius.total_cmp(&b.half_mass_radius));
    let (radius, time) = smallest.map_or((0.0, 0.0), |it| (it.half_mass_radius, it.time));
    let mean = |of: fn(&Bound) -> f64| data.bound.iter().map(of).sum::<f64>() / data.bound.len() as f64;
    let (virial, clausius, share) =
        (mean(|it| it.virial_ratio), mean(|it| it.clausius_ratio), mean(|it| it.share));
    let error = data.moments.iter().map(|it| it.energy_error.abs()).fold(0.0, f64::max);
    let momentum = data.moments.iter().map(|it| it.momentum).fold(0.0, f64::max);
    let claims = [(time / FREE_FALL - 1.0).abs() < 0.1, (virial - 0.5).abs() < WITHIN];
    let within = if claims[1] { "" } else { ", not" };
    Section::new("nbody-collapse", "Bodies: a cold sphere collapses", Part::Physics)
        .asks("Does a uniform sphere of bodies at rest collapse and come to equilibrium as theory says?")
        .expects(format!("It falls in within π/√8 = {FREE_FALL:.2} √(R³/GM), and what stays bound comes to the virial ratio 0.5."))
        .answers(format!(
            "After a time of {LATE} the {:.0} % of {BODIES} bodies that stay bound have a virial ratio of {virial:.3}{within} 0.5 to {WITHIN}; \
             the fall ends at {time:.2}, by theory at {FREE_FALL:.2}.",
            100.0 * share
        ))
        .verdict(Verdict::of_claims(&claims))
        .details([format!(
            "With Clausius' virial Σ r·F of the softened forces in the place of the potential energy the ratio is {clausius:.3}. At the closest, \
             half of the mass is within {radius:.3}. The energy is off by at most {}, the momentum by {}.",
            in_tens(error, 2),
            in_tens(momentum, 1)
        )])
        .figures([0.0, FREE_FALL, 3.0].into_iter().filter_map(|time| picture(data, time)))
        .figures([course(data)])
        .film(film(data))
        .seeds([1])
}

fn shown(centre: [f64; 2]) -> bool {
    centre.iter().all(|x| x.abs() < WINDOW)
}

fn picture(data: &Collapse, time: f64) -> Option<Figure> {
    let moment =
        data.moments.iter().min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()))?;
    let bodies = moment.bodies.iter().filter(|(centre, _)| shown(*centre));
    let shapes = bodies.map(|&(centre, speed)| Shape::Disc {
        centre,
        radius: RADIUS,
        tint: Tint::Shade((speed / FASTEST).min(1.0)),
    });
    Some(
        Picture::Drawing(Drawing {
            window: [[-WINDOW; 2], [WINDOW; 2]],
            width: 420.0,
            shapes: shapes.collect(),
            shades: Some((0.0, FASTEST, "speed (√(GM/R))".into())),
            guide: Some(Guide { unit: "R".into(), gravity: None }),
        })
        .figure(
            format!("bodies-{}", format!("{:.1}", moment.time).replace('.', "-")),
            format!("Bodies at a time of {:.2}", moment.time),
        )
        .caption(format!("{} of {BODIES} bodies, seen along z; shade: speed.", moment.bodies.len())),
    )
}

fn course(data: &Collapse) -> Figure {
    let series = |name: &str, hue, of: fn(&Moment) -> f64| {
        Series::new(name, Style::Line, hue, data.moments.iter().map(|it| (it.time, of(it))))
    };
    Chart::of(Axis::linear("time", Some("√(R³/GM)")), Axis::linear("ratio, or radius over R", None))
        .with([
            series("kinetic over potential energy", 0, |it| it.virial_ratio),
            series("radius of half the mass", 1, |it| it.half_mass_radius),
        ])
        .figure("course", "Virial ratio and radius of half the mass")
        .caption(
            "Of all bodies: those that are thrown out keep the ratio above 0.5, which it is in equilibrium.",
        )
}

fn film(data: &Collapse) -> Film {
    // Every other moment, and what leaves the window stays at its rim, small enough not to be missed.
    let bodies = data.moments.first().map_or(0, |it| it.bodies.len()).min(350);
    let frames = data.moments.iter().filter(|it| it.time <= FILMED).step_by(2).map(|it| Frame {
        time: it.time,
        discs: it
            .bodies
            .iter()
            .take(bodies)
            .map(|&(centre, speed)| (centre.map(|x| x.clamp(-WINDOW, WINDOW)), speed.min(FASTEST)))
            .collect(),
    });
    Film {
        title: "The collapse, seen along z".into(),
        window: [[-WINDOW; 2], [WINDOW; 2]],
        radii: vec![RADIUS; bodies],
        fixed: vec![],
        frames: frames.collect(),
        shade: "speed (√(GM/R))".into(),
        shades: [0.0, FASTEST],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section_of(virial_ratio: f64) -> Section {
        let bound = Bound { time: 7.0, share: 0.8, virial_ratio, clausius_ratio: 0.5 };
        let moment = |time: f64, half_mass_radius: f64| Moment {
            time,
            virial_ratio,
            half_mass_radius,
            energy_error: 0.0,
            momentum: 0.0,
            bodies: vec![],
        };
        let moments = vec![moment(0.0, 0.8), moment(1.1, 0.1), moment(8.0, 0.3)];
        section(&Collapse { bound: vec![bound], moments })
    }

    #[test]
    fn a_virial_ratio_that_is_not_that_of_equilibrium_is_said() {
        let off = section_of(0.443);
        assert_eq!(off.verdict, Verdict::Partly);
        assert!(off.answer.contains("a virial ratio of 0.443, not 0.5"), "{}", off.answer);
        assert_eq!(section_of(0.49).verdict, Verdict::Reproduced);
    }
}
