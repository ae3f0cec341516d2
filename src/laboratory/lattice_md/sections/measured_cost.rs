//! Figures 3 and 4 of the source, measured on a host.

use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::laboratory::lattice_md::study::measured_cost::{
    MeasuredCost, OCCUPANCY, PARTICLES, Sample, Variant,
};
use crate::report::Section;
use crate::report::figure::{Axis, Band, Chart, Figure, Series, Style};

/// What came out.
pub fn section(data: &MeasuredCost) -> Section {
    Section::new("measured", "Cost over particles and density, measured")
        .asks("What do the source's ways of executing a step cost on this host?")
        .expects("BP93 predicts the cost and shows no measurement.")
        .answers(answer(data))
        .details([format!("One thread, {}, double precision, friction, moving discs.", data.instruction_set)])
        .figures([over_particles(data), over_density(data)])
        .seeds([1])
        .depends_on_host()
}

fn answer(data: &MeasuredCost) -> String {
    let each = |samples: &[Sample]| -> String {
        let named = samples.iter().map(|sample| {
            let nanoseconds = 1e9 * sample.seconds / sample.particles as f64;
            format!("{} {nanoseconds:.0}", data.variants[sample.variant].name)
        });
        named.collect::<Vec<_>>().join(", ")
    };
    let largest = data.over_particles.iter().map(|sample| sample.particles).max().unwrap_or(0);
    let at_largest: Vec<Sample> =
        data.over_particles.iter().filter(|sample| sample.particles == largest).cloned().collect();
    let fastest = |occupancy: f64| {
        let samples = data.over_density.iter().filter(|sample| sample.occupancy == occupancy);
        samples
            .min_by(|a, b| a.seconds.total_cmp(&b.seconds))
            .map(|sample| data.variants[sample.variant].name)
    };
    let densities: Vec<f64> = data.over_density.iter().map(|sample| sample.occupancy).collect();
    let [lowest, highest] =
        [densities.iter().copied().fold(1.0, f64::min), densities.iter().copied().fold(0.0, f64::max)];
    format!(
        "The fastest at ρ = {lowest:.2} is {}, at ρ = {highest:.2} {}. Nanoseconds a particle and step at NP = {largest}, ρ = {OCCUPANCY}: {}.",
        fastest(lowest).unwrap_or("none"),
        fastest(highest).unwrap_or("none"),
        each(&at_largest),
    )
}

fn series(data: &MeasuredCost, samples: &[Sample], point: impl Fn(&Sample) -> [f64; 3]) -> Vec<Series> {
    let of_variant = |(hue, variant): (usize, &Variant)| {
        let points = samples.iter().filter(|sample| sample.variant == hue).map(|sample| {
            let [x, y, best] = point(sample);
            (x, y, [y.min(best), y.max(best)])
        });
        Series::new(variant.name, Style::Joined, hue, points)
    };
    data.variants.iter().enumerate().map(of_variant).collect()
}

fn over_particles(data: &MeasuredCost) -> Figure {
    let point = |sample: &Sample| [sample.particles as f64, 1e6 * sample.seconds, 1e6 * sample.best];
    Chart::of(
        Axis::logarithmic("number of particles NP", None),
        Axis::logarithmic("time of a step", Some("µs")),
    )
    .with(series(data, &data.over_particles, point))
    .figure("figure_3_measured", "Time of a step over the number of particles, measured")
    .caption(format!("ρ = {OCCUPANCY} on cells as wide as the radius. Points: the median repeat; bars reach to the processor time of the best \
                      one."))
}

fn over_density(data: &MeasuredCost) -> Figure {
    let each = |sample: &Sample, seconds: f64| 1e9 * seconds / sample.particles as f64;
    let point = |sample: &Sample| [sample.occupancy, each(sample, sample.seconds), each(sample, sample.best)];
    Chart::of(
        Axis::linear("occupancy ρ = NP/LMAX", None).between([0.0, 0.35]),
        Axis::logarithmic("time of a particle and step", Some("ns")),
    )
    .with(series(data, &data.over_density, point))
    .band(Band::of_x("out of reach", [CEILING, 0.35]))
    .figure("figure_4_measured", "Time of a particle and step over the density, measured")
    .caption(format!("About {PARTICLES} discs. Hatched: occupancies that discs on cells as wide as their radius cannot reach. Points: the median \
                      repeat; bars reach to the processor time of the best one."))
}
