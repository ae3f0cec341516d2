//! Mean square displacement and velocities.

use super::point;
use crate::laboratory::langevin::study::diffusion::{Diffusion, Followed, exact};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};
use std::f64::consts::PI;

/// σ of the source (length).
const DIAMETER: f64 = 0.1;
/// "Similar" mean square displacements differ by no more than this part.
const SIMILAR: f64 = 0.1;

/// ⟨r²⟩ over the exact one without pairs at a look.
fn over_exact(it: &Followed, look: usize) -> f64 {
    it.square[look][0] / exact(it.times[look])
}

/// The same, of the last look at most at a time.
fn over_exact_at(it: &Followed, time: f64) -> f64 {
    let within = it.times.iter().filter(|look| **look <= time * (1.0 + 1e-9)).count();
    over_exact(it, within.saturating_sub(1))
}

/// The same at the end by theory: discs of diameter σ = 0.1 that collide have Enskog's friction 2 n σ χ √(π m kT) beside γ, with χ their
/// distribution function at contact (Henderson); kT = m = γ = 1.
fn by_enskog(it: &Followed) -> f64 {
    let density = it.particles as f64 / (it.side * it.side);
    let packing = 0.25 * PI * density * DIAMETER * DIAMETER;
    let contact = (1.0 - 7.0 / 16.0 * packing) / (1.0 - packing).powi(2);
    let friction = 1.0 + 2.0 * density * DIAMETER * contact * PI.sqrt();
    let end = it.times.last().copied().unwrap_or_default();
    exact(friction * end) / (friction * friction) / exact(end)
}

/// What came out.
pub fn section(data: &Diffusion) -> Section {
    // The square of a Gaussian vector of the plane scatters as itself.
    let off = |it: &Followed| {
        let bars = it.times.iter().zip(&it.square);
        let bars =
            bars.map(|(&time, [square, _])| (square / exact(time) - 1.0) * (it.particles as f64).sqrt());
        bars.fold(0.0, |most: f64, off| most.max(off.abs()))
    };
    let thin = off(&data.systems[2]);
    let dense = &data.systems[3];
    let [early, at_end] = [0.1, f64::INFINITY].map(|time| over_exact_at(dense, time));
    let is_similar = (at_end - 1.0).abs() < SIMILAR;
    let worst = data.heated.iter().filter(|it| it.scheme != "as-printed");
    let worst = worst.map(|it| ((it.temperature.value - 1.0) / it.temperature.bar).abs()).fold(0.0, f64::max);
    let least = data.systems.iter().map(|it| it.maxwell[0]).fold(1.0, f64::min);
    Section::new("langevin-diffusion", "Langevin: displacements and velocities")
        .asks("Do particles in a bath move as theory says?")
        .expects("LAN17, figures 3 to 8: 4 D t with D = kT/γ in the end, with 40 000 pairs too (figure 6); a spike; broader velocities with pairs.")
        .answers(format!(
            "With 40 000 particles the mean square displacement ends at {at_end:.3} of the free one{}; {early:.2} at a time of 0.1. The thinnest \
             system is within {thin:.1} standard errors of it.",
            if is_similar { ", as in figure 6" } else { ", where figure 6 is \"similar\"" },
        ))
        .verdict(Verdict::of_claims(&[thin < 5.0, least > 0.001, is_similar]))
        .details([format!(
            "Collisions explain it: with Enskog's friction beside γ theory has {:.3}. A shorter run, larger γ or smaller σ would hide it. The \
             spike is of wrapped positions. Velocities are Maxwell's (p ≥ {least:.2}). Friction as printed heats; the other schemes stay within \
             {worst:.1} bars.",
            by_enskog(dense)
        )])
        .figures([displacements(data), heating(data)])
        .tables([table(data)])
        .seeds([1])
}

fn name(it: &Followed) -> String {
    format!("N = {}, L = {}", it.particles, it.side)
}

fn displacements(data: &Diffusion) -> Figure {
    let exact = data.free.times.iter().map(|&time| (time, exact(time)));
    let systems = data.systems.iter().enumerate().flat_map(|(hue, it)| {
        let points =
            |which: usize| it.times.iter().zip(&it.square).map(move |(&time, square)| (time, square[which]));
        let wrapped = || Series::new(format!("{}, wrapped", name(it)), Style::Dashed, hue, points(1));
        let own = Series::new(name(it), Style::Points, hue, points(0));
        [own].into_iter().chain((hue == 0 || hue == 3).then(wrapped))
    });
    Chart::of(
        Axis::logarithmic("time", Some("reduced")),
        Axis::logarithmic("mean square displacement", Some("reduced")),
    )
    .series("exact, without pairs", Style::Line, 6, exact)
    .with(systems)
    .figure("displacements", "Mean square displacement")
    .caption("Dashed: by the positions inside the box, as the source has it; they jump when particles come in at the other side.")
}

fn heating(data: &Diffusion) -> Figure {
    let theory = (0..=60).map(|at| 10f64.powf(-2.0 + f64::from(at) / 30.0));
    let schemes = ["stochastic", "as-printed", "baoab"].into_iter().enumerate().map(|(hue, scheme)| {
        let of = data.heated.iter().filter(|it| it.scheme == scheme);
        Series::new(scheme, Style::Points, hue, of.map(|it| point(it.dt, it.temperature)))
    });
    Chart::of(
        Axis::logarithmic("step over m/γ", None),
        Axis::linear("temperature over that of the bath", None),
    )
    .series("1/(1 − γ dt/2m)", Style::Line, 6, theory.map(|dt| (dt, 1.0 / (1.0 - 0.5 * dt))))
    .with(schemes)
    .figure("temperature", "Temperature of free particles over the step")
    .caption("Bars hold the mean in 95 of 100 studies. As printed, friction acts on the velocity of the step before.")
}

fn table(data: &Diffusion) -> Table {
    let systems = data.systems.iter().map(|it| (name(it), Some(by_enskog(it)), it));
    let systems = systems.chain([(format!("{}, no pairs", name(&data.free)), None, &data.free)]);
    Rows::of(systems.map(|(name, theory, it)| (name, theory, it, it.times.len() - 1)))
        .text("system", |(name, ..)| name.clone())
        .number("over exact at 0.1", 3, |(_, _, it, _)| over_exact_at(it, 0.1))
        .number("at 1", 3, |(_, _, it, _)| over_exact_at(it, 1.0))
        .number("at the end", 3, |(_, _, it, last)| over_exact(it, *last))
        .number("by Enskog", 3, |(_, theory, ..)| *theory)
        .number("relative standard error", 3, |(_, _, it, _)| (it.particles as f64).sqrt().recip())
        .number("time", 2, |(_, _, it, last)| it.times[*last])
        .number("⟨r²⟩", 3, |(_, _, it, last)| it.square[*last][0])
        .number("⟨r²⟩ wrapped", 3, |(_, _, it, last)| it.square[*last][1])
        .number("temperature", 4, |(_, _, it, _)| it.maxwell[1])
        .number("p of Maxwell", 3, |(_, _, it, _)| it.maxwell[0])
        .table("displacements", "Displacements over those without pairs, and velocities at the end")
        .note("Exact is the result without pairs. By Enskog: friction of collisions of discs of diameter σ beside γ.")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn followed(particles: u64, side: f64, factor: f64) -> Followed {
        let times = vec![0.1, 1.0, 20.0];
        let square = times.iter().map(|&time| [factor * exact(time), 1.0]).collect();
        Followed { particles, side, times, square, maxwell: [0.5, 1.0] }
    }

    /// Figure 6 of the source is compared: what is not similar to the free one is said first, and graded.
    #[test]
    fn a_dense_system_that_is_slowed_is_not_figure_6() {
        let section_of = |factor: f64| {
            let systems =
                [(1000, 50.0, 1.0), (1000, 100.0, 1.0), (1000, 1000.0, 1.0), (40_000, 100.0, factor)];
            let systems = systems.map(|(count, side, factor)| followed(count, side, factor)).to_vec();
            section(&Diffusion { systems, free: followed(1000, 50.0, 1.0), heated: vec![] })
        };
        let slowed = section_of(0.41);
        assert_eq!(slowed.verdict, Verdict::Partly);
        let begin = "With 40 000 particles the mean square displacement ends at 0.410 of the free one, where figure 6";
        assert!(slowed.answer.starts_with(begin), "{}", slowed.answer);
        assert_eq!(section_of(0.95).verdict, Verdict::Reproduced);
    }

    /// Enskog: four discs of diameter 0.1 in a unit of area collide so often that they diffuse at about 0.4 of kT/γ; thin ones do not.
    #[test]
    fn collisions_slow_what_is_dense() {
        let [dense, thin] =
            [(40_000, 100.0), (1000, 1000.0)].map(|(count, side)| by_enskog(&followed(count, side, 1.0)));
        assert!((dense - 0.411).abs() < 0.005 && thin > 0.999, "{dense}, {thin}");
    }
}
