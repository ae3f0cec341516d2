//! A cold sphere that falls in on itself.

use crate::laboratory::nbody::study::collapse::{BODIES, Bound, Collapse, LATE, Moment};
use crate::report::figure::{Axis, Chart, Drawing, Figure, Guide, Picture, Series, Shape, Style, Tint};
use crate::report::section::{Film, Frame};
use crate::report::{Rows, Section, Table, Verdict};
use crate::statistics::{Mean, quantile};
use stripmine_physics::number::in_tens;

/// The free fall of a uniform sphere of radius and mass 1.
const FREE_FALL: f64 = std::f64::consts::PI / (2.0 * std::f64::consts::SQRT_2);
/// A virial ratio this near to 0.5 is that of equilibrium.
const WITHIN: f64 = 0.02;
/// The fall may end this much earlier or later, in parts of itself.
const FALL_WITHIN: f64 = 0.1;
/// Half of the sides of the film.
const WINDOW: f64 = 1.5;
/// A picture holds this share of the bodies.
const SEEN: f64 = 0.9;
/// The fastest that is told apart by its shade.
const FASTEST: f64 = 3.0;
/// How long the film is.
const FILMED: f64 = 4.0;
/// How large bodies are drawn.
const RADIUS: f64 = 0.015;

/// What came out of spheres that differ by their seed; the first is shown.
pub fn section(all: &[Collapse]) -> Section {
    let first = &all[0];
    let mean = |of: &dyn Fn(&Collapse) -> f64| Mean::of(&all.iter().map(of).collect::<Vec<_>>());
    let late = |of: fn(&Bound) -> f64| {
        mean(&|it: &Collapse| it.bound.iter().map(of).sum::<f64>() / it.bound.len() as f64)
    };
    let (clausius, potential, share) =
        (late(|it| it.clausius_ratio), late(|it| it.virial_ratio), late(|it| it.share));
    let fall = mean(&|it: &Collapse| closest(it).map_or(f64::NAN, |it| it.time));
    let radius = mean(&|it: &Collapse| closest(it).map_or(f64::NAN, |it| it.half_mass_radius));
    let moments = || all.iter().flat_map(|it| &it.moments);
    let error = moments().map(|it| it.energy_error.abs()).fold(0.0, f64::max);
    let momentum = moments().map(|it| it.momentum).fold(0.0, f64::max);
    let claims = [fall.off(FREE_FALL).vanishes(FALL_WITHIN), clausius.off(0.5).vanishes(WITHIN / 0.5)];

    Section::new("nbody-collapse", "Bodies: a cold sphere collapses")
        .asks("Does a uniform sphere of bodies at rest collapse and come to equilibrium as theory says?")
        .expects(format!(
            "It falls in within π/√8 = {FREE_FALL:.2} √(R³/GM), to a tenth, and what stays bound comes to the virial theorem's ratio 0.5, to \
             {WITHIN}, of kinetic energy to Σ r·F of its forces."
        ))
        .answers(format!(
            "The fall ends at {} ({FREE_FALL:.2} by theory); of {BODIES} bodies {:.0} % stay bound, and after a time of {LATE} their virial ratio \
             is {} (0.5 by theory). Bars: 95 % over {} seeds.",
            fall,
            100.0 * share.value,
            clausius,
            all.len()
        ))
        .verdict(Verdict::of_claims(&claims))
        .details([format!(
            "Softened forces are not those of a potential 1/r: with their potential energy in the place of Σ r·F the ratio is {}, and theory \
             says nothing of it. At the closest, half of the mass is within {:.3}. The energy is off by at most {}, the momentum by {}.",
            potential,
            radius.value,
            in_tens(error, 2),
            in_tens(momentum, 1)
        )])
        .figures([course(all)])
        .figures([0.0, FREE_FALL, 3.0].into_iter().filter_map(|time| picture(first, time)))
        .tables([table(all)])
        .film(film(first))
        .seeds(all.iter().map(|it| it.seed))
}

/// The moment at which half of the mass is nearest to the centre.
fn closest(data: &Collapse) -> Option<&Moment> {
    data.moments.iter().min_by(|a, b| a.half_mass_radius.total_cmp(&b.half_mass_radius))
}

fn table(all: &[Collapse]) -> Table {
    let late =
        |it: &Collapse, of: fn(&Bound) -> f64| it.bound.iter().map(of).sum::<f64>() / it.bound.len() as f64;
    Rows::of(all)
        .count("seed", |it| it.seed)
        .number("end of the fall", 3, |it| closest(it).map(|it| it.time))
        .number("radius of half the mass there", 3, |it| closest(it).map(|it| it.half_mass_radius))
        .number("stays bound (%)", 1, |it| 100.0 * late(it, |it| it.share))
        .number("virial ratio, Σ r·F", 3, |it| late(it, |it| it.clausius_ratio))
        .number("with the potential energy", 3, |it| late(it, |it| it.virial_ratio))
        .table("spheres", format!("Spheres of {BODIES} bodies; late means are over times from {LATE} on"))
}

/// Half the side of a picture that holds all but a few bodies.
fn window(moment: &Moment) -> f64 {
    let mut far: Vec<f64> = moment.bodies.iter().map(|([x, y], _)| x.abs().max(y.abs())).collect();
    far.sort_by(f64::total_cmp);
    1.05 * quantile(&far, SEEN).unwrap_or(WINDOW)
}

fn picture(data: &Collapse, time: f64) -> Option<Figure> {
    let moment =
        data.moments.iter().min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()))?;
    let half = window(moment);
    let inside = |centre: [f64; 2]| centre.iter().all(|x| x.abs() < half);
    let bodies: Vec<_> = moment.bodies.iter().filter(|(centre, _)| inside(*centre)).collect();
    let shapes = bodies.iter().map(|&&(centre, speed)| Shape::Disc {
        centre,
        radius: RADIUS * half / WINDOW,
        tint: Tint::Shade((speed / FASTEST).min(1.0)),
    });
    Some(
        Picture::Drawing(Drawing {
            window: [[-half; 2], [half; 2]],
            width: 420.0,
            shapes: shapes.collect(),
            shades: Some((0.0, FASTEST, "speed (√(GM/R))".into())),
            guide: Some(Guide { unit: "R".into(), gravity: None }),
        })
        .figure(
            format!("bodies-{}", format!("{:.1}", moment.time).replace('.', "-")),
            format!("Bodies at a time of {:.2}", moment.time),
        )
        .caption(format!(
            "{} of the first {} of {BODIES} bodies, the others are farther out; seen along z; shade: speed.",
            bodies.len(),
            moment.bodies.len()
        )),
    )
}

fn course(all: &[Collapse]) -> Figure {
    let series = |name: &str, hue, of: fn(&Moment) -> f64| {
        let moments = all[0].moments.iter().enumerate();
        let over_seeds = moments.map(|(at, it)| {
            let values: Vec<f64> = all.iter().filter_map(|data| data.moments.get(at)).map(of).collect();
            (it.time, values.iter().sum::<f64>() / values.len() as f64)
        });
        Series::new(name, Style::Line, hue, over_seeds)
    };
    let bound = all.iter().flat_map(|data| &data.bound).map(|it| (it.time, it.clausius_ratio));
    let end = all[0].moments.last().map_or(0.0, |it| it.time);
    Chart::of(Axis::linear("time", Some("√(R³/GM)")), Axis::linear("ratio, or radius over R", None))
        .with([
            series("kinetic over potential energy, all bodies", 0, |it| it.virial_ratio),
            series("radius of half the mass", 1, |it| it.half_mass_radius),
        ])
        .series("virial ratio of those that stay bound", Style::Points, 2, bound)
        .series("by the virial theorem", Style::Dashed, 6, [(0.0, 0.5), (end, 0.5)])
        .figure("course", "Virial ratio and radius of half the mass")
        .caption(format!(
            "Lines: means over {} seeds. Bodies that are thrown out keep the ratio of all above 0.5. Points: each seed.",
            all.len()
        ))
}

fn film(data: &Collapse) -> Film {
    // Every other moment, and what leaves the window stays at its rim, small enough not to be missed.
    let bodies = data.moments.first().map_or(0, |it| it.bodies.len()).min(300);
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
        units: ["R", "√(R³/GM)"].map(str::to_owned),
        window: [[-WINDOW; 2], [WINDOW; 2]],
        sides: vec![],
        falls: false,
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

    fn section_of(clausius_ratio: f64) -> Section {
        let bound = Bound { time: 7.0, share: 0.8, virial_ratio: 0.443, clausius_ratio };
        let moment = |time: f64, half_mass_radius: f64| Moment {
            time,
            virial_ratio: 0.5,
            half_mass_radius,
            energy_error: 0.0,
            momentum: 0.0,
            bodies: vec![([0.1, 0.2], 1.0); 3],
        };
        let moments = || vec![moment(0.0, 0.8), moment(1.1, 0.1), moment(8.0, 0.3)];
        let of = |seed: u64| Collapse { seed, bound: vec![bound.clone()], moments: moments() };
        section(&[of(1), of(2)])
    }

    #[test]
    fn a_virial_ratio_that_is_not_that_of_equilibrium_is_said() {
        let off = section_of(0.443);
        assert_eq!(off.verdict, Verdict::Partly);
        assert!(off.answer.contains("virial ratio is 0.443 ± 0 (0.5 by theory)"), "{}", off.answer);
        assert_eq!(section_of(0.49).verdict, Verdict::Reproduced);
    }
}
