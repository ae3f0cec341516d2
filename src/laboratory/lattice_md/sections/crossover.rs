//! Where the lattice overtakes its rivals.

use crate::laboratory::lattice_md::study::crossover::{Crossover, METHODS, Sample};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table};

/// What came out.
pub fn section(data: &Crossover) -> Section {
    let named = data.crossings.iter().map(|crossing| {
        let at = match crossing.packing_fraction {
            Some(phi) => format!("{phi:.2}"),
            None if crossing.ratios[0] >= 1.0 => "below all measured".to_owned(),
            None => "above all measured".to_owned(),
        };
        format!("{} with {} discs {at}", crossing.precision, count(crossing.particles))
    });
    Section::new("crossover", "Lattice, neighbour lists and sectors, each as fast as it goes")
        .asks("From which density on is the lattice faster than neighbour lists and sectors, each as fast as it goes?")
        .expects("BP93 expects the vector method to pay where discs are dense.")
        .answers(format!(
            "Packing fraction from which on the lattice is the fastest: {}.",
            named.collect::<Vec<_>>().join("; ")
        ))
        .details([format!(
            "Whole steps with friction, velocity Verlet, one thread, {}, moving discs.",
            data.instruction_set
        )])
        .figures(groups(data).into_iter().map(|group| figure(data, group)))
        .tables([rates(data), phases(data)])
        .seeds([1])
        .depends_on_host()
}

fn count(particles: usize) -> String {
    Cell::Number(particles as f64, 0).for_reading()
}

/// Precisions and numbers of discs, in the order of the samples.
fn groups(data: &Crossover) -> Vec<(&'static str, usize)> {
    let mut groups: Vec<_> = data.samples.iter().map(|sample| (sample.precision, sample.particles)).collect();
    groups.dedup();
    groups
}

fn of<'a>(
    data: &'a Crossover,
    (precision, particles): (&'a str, usize),
) -> impl Iterator<Item = &'a Sample> + Clone {
    data.samples.iter().filter(move |sample| sample.precision == precision && sample.particles == particles)
}

fn figure(data: &Crossover, group: (&'static str, usize)) -> Figure {
    let series = METHODS.into_iter().enumerate().map(|(hue, method)| {
        let points = of(data, group).filter(|sample| sample.method == method).map(|sample| {
            let (best, median) = (1e-6 * sample.rate, 1e-6 * sample.median);
            (sample.packing_fraction, best, [best.min(median), best.max(median)])
        });
        Series::new(method, Style::Joined, hue, points)
    });
    let (precision, particles) = group;
    let title = format!("Rate over the packing fraction, {precision}, {} discs", count(particles));
    Chart::of(
        Axis::logarithmic("packing fraction", None),
        Axis::logarithmic("rate", Some("million particle-steps/s")),
    )
    .with(series)
    .figure(format!("crossover_{precision}_{particles}"), title)
    .caption("Points: best repeat in processor time; bars reach to the median in wall time.")
}

fn rates(data: &Crossover) -> Table {
    let places = groups(data).into_iter().flat_map(|group| {
        let mut fractions: Vec<f64> = of(data, group).map(|sample| sample.packing_fraction).collect();
        fractions.dedup();
        fractions.into_iter().map(move |phi| (group, phi))
    });
    let at = |(group, phi): ((&'static str, usize), f64)| {
        of(data, group).filter(move |sample| sample.packing_fraction == phi)
    };
    let mut rows = Rows::of(places)
        .text("precision", |((precision, _), _)| *precision)
        .number("discs", 0, |((_, particles), _)| *particles as f64)
        .number("packing fraction", 2, |(_, phi)| *phi);
    for method in METHODS {
        rows = rows.number(method, 1, |place| {
            at(*place).find(|sample| sample.method == method).map_or(f64::NAN, |sample| 1e-6 * sample.rate)
        });
    }
    rows.number("contacts a disc", 3, |place| at(*place).next().map_or(f64::NAN, |sample| sample.contacts))
        .table("rates", "Million particle-steps a second of processor time")
        .note("The best repeat. All three share state, law and integrator.")
}

fn phases(data: &Crossover) -> Table {
    let names = data.samples.first().into_iter().flat_map(|sample| sample.phases.keys());
    let mut rows = Rows::of(&data.samples)
        .text("precision", |sample| sample.precision)
        .number("discs", 0, |sample| sample.particles as f64)
        .number("packing fraction", 2, |sample| sample.packing_fraction)
        .text("method", |sample| sample.method);
    for name in names {
        rows = rows.number(*name, 2, |sample| sample.phases.get(name).copied().unwrap_or(0.0));
    }
    rows.table("phases", "Nanoseconds a particle and step in each phase")
}
