//! Mean square displacement and velocities.

use super::point;
use crate::laboratory::langevin::study::diffusion::{Diffusion, Followed, exact};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};

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
    let worst = data.heated.iter().filter(|it| it.scheme != "as-printed");
    let worst = worst.map(|it| ((it.temperature.value - 1.0) / it.temperature.bar).abs()).fold(0.0, f64::max);
    let least = data.systems.iter().map(|it| it.maxwell[0]).fold(1.0, f64::min);
    Section::new("langevin-diffusion", "Langevin: displacements and velocities")
        .asks("Do free and interacting particles in a bath move as theory says, and where do the source's spike and broad velocities come from?")
        .expects("LAN17, figures 3 to 8: displacements grow as t² and then as 4 D t with D = kT/γ; the source shows a spike when the first \
                  particles leave the box, and broader velocities where particles interact.")
        .answers(format!("Without a box the mean square displacement of the thinnest system is within {thin:.1} standard errors of the exact one \
                          at every time."))
        .verdict(Verdict::reproduced(thin < 5.0 && least > 0.001))
        .details([format!(
            "The spike belongs to positions that were wrapped into the box; unwrapped ones have none. Velocities are Maxwell's with pairs too (p \
             of at least {least:.2}): what broadens them in the source is the heat of a long step. Friction as printed heats to 1/(1 − γ dt/2m); \
             the other two schemes do not, within {worst:.1} of their bars."
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
    let systems = data.systems.iter().map(|it| (name(it), it));
    let systems = systems.chain([(format!("{}, no pairs", name(&data.free)), &data.free)]);
    Rows::of(systems.map(|(name, it)| (name, it, it.times.len() - 1)))
        .text("system", |(name, ..)| name.clone())
        .number("time", 2, |(_, it, last)| it.times[*last])
        .number("⟨r²⟩", 3, |(_, it, last)| it.square[*last][0])
        .number("over exact", 3, |(_, it, last)| it.square[*last][0] / exact(it.times[*last]))
        .number("standard error", 3, |(_, it, _)| (it.particles as f64).sqrt().recip())
        .number("⟨r²⟩ wrapped", 3, |(_, it, last)| it.square[*last][1])
        .number("temperature", 4, |(_, it, _)| it.maxwell[1])
        .number("p of Maxwell", 3, |(_, it, _)| it.maxwell[0])
        .table("displacements", "Displacements and velocities at the end")
        .note("Pairs slow diffusion where the system is dense: exact is the result without them.")
}
