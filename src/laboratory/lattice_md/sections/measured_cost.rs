//! Figures 3 and 4 of the source, measured on a host.

use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::laboratory::lattice_md::study::measured_cost::{MeasuredCost, OCCUPANCY, PARTICLES, Sample};
use crate::report::figure::{Axis, Band, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Part, Section, Verdict};

/// What came out.
pub fn section(data: &MeasuredCost) -> Section {
    Section {
        name: "measured".into(),
        title: "Cost over particles and density, measured".into(),
        part: Part::Host,
        question: "What do the source's ways of executing a step cost on this host?".into(),
        expected: "BP93 predicts the cost and shows no measurement.".into(),
        answer: answer(data),
        details: vec![format!(
            "One thread, {}, double precision, friction, moving discs.",
            data.instruction_set
        )],
        verdict: Verdict::Measured,
        again: "stripmine reproduce --only measured".into(),
        figures: vec![over_particles(data), over_density(data)],
        tables: vec![],
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: true,
        provenance: None,
    }
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
        "Nanoseconds a particle and step at NP = {largest}, ρ = {OCCUPANCY}: {}; the fastest at ρ = {lowest:.2} is {}, at ρ = \
         {highest:.2} {}.",
        each(&at_largest),
        fastest(lowest).unwrap_or("none"),
        fastest(highest).unwrap_or("none")
    )
}

fn series(
    data: &MeasuredCost,
    samples: &[Sample],
    point: impl Fn(&Sample) -> (f64, f64, f64),
) -> Vec<Series> {
    let of_variant = |variant: usize| {
        let of_variant = samples.iter().filter(|sample| sample.variant == variant);
        let points = of_variant.map(|sample| {
            let (x, y, best) = point(sample);
            Point { x, y, spread: Some([y.min(best), y.max(best)]) }
        });
        Series {
            name: data.variants[variant].name.into(),
            style: Style::Joined,
            hue: variant,
            points: points.collect(),
        }
    };
    (0..data.variants.len()).map(of_variant).collect()
}

fn over_particles(data: &MeasuredCost) -> Figure {
    Figure {
        name: "figure_3_measured".into(),
        title: "Time of a step over the number of particles, measured".into(),
        caption: format!(
            "ρ = {OCCUPANCY} on cells as wide as the radius. Points: the median repeat; bars reach to the processor time of \
             the best one."
        ),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("number of particles NP", None),
            y: Axis::logarithmic("time of a step", Some("µs")),
            series: series(data, &data.over_particles, |sample| {
                (sample.particles as f64, 1e6 * sample.seconds, 1e6 * sample.best)
            }),
            bands: vec![],
        }),
    }
}

fn over_density(data: &MeasuredCost) -> Figure {
    let each = |sample: &Sample, seconds: f64| 1e9 * seconds / sample.particles as f64;
    Figure {
        name: "figure_4_measured".into(),
        title: "Time of a particle and step over the density, measured".into(),
        caption: format!(
            "About {PARTICLES} discs. Hatched: occupancies that discs on cells as wide as their radius cannot reach. Points: \
             the median repeat; bars reach to the processor time of the best one."
        ),
        picture: Picture::Chart(Chart {
            x: Axis { limits: Some([0.0, 0.35]), ..Axis::linear("occupancy ρ = NP/LMAX", None) },
            y: Axis::logarithmic("time of a particle and step", Some("ns")),
            series: series(data, &data.over_density, |sample| {
                (sample.occupancy, each(sample, sample.seconds), each(sample, sample.best))
            }),
            bands: vec![Band::of_x("out of reach", [CEILING, 0.35])],
        }),
    }
}
