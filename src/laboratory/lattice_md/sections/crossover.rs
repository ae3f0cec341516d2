//! Where the lattice overtakes its rivals.

use crate::laboratory::lattice_md::study::crossover::{Crossover, METHODS, Sample};
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table};

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
    Section::new("crossover", "Lattice, neighbour lists and sectors, each as fast as it goes", Part::Host)
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
        Series::new(
            method,
            Style::Joined,
            hue,
            of(data, group).filter(|sample| sample.method == method).map(|sample| {
                let (best, median) = (1e-6 * sample.rate, 1e-6 * sample.median);
                Point {
                    x: sample.packing_fraction,
                    y: best,
                    spread: Some([best.min(median), best.max(median)]),
                }
            }),
        )
    });
    let (precision, particles) = group;
    Chart::of(
        Axis::logarithmic("packing fraction", None),
        Axis::logarithmic("rate", Some("million particle-steps/s")),
    )
    .with(series)
    .figure(
        format!("crossover_{precision}_{particles}"),
        format!("Rate over the packing fraction, {precision}, {} discs", count(particles)),
    )
    .caption("Points: best repeat in processor time; bars reach to the median in wall time.")
}

fn rates(data: &Crossover) -> Table {
    let mut rows = vec![];
    for group in groups(data) {
        let mut fractions: Vec<f64> = of(data, group).map(|sample| sample.packing_fraction).collect();
        fractions.dedup();
        for phi in fractions {
            let at = || of(data, group).filter(move |sample| sample.packing_fraction == phi);
            let rate = |method: &str| {
                at().find(|sample| sample.method == method).map_or(f64::NAN, |s| 1e-6 * s.rate)
            };
            let contacts = at().map(|sample| sample.contacts).next().unwrap_or(f64::NAN);
            let mut row =
                vec![Cell::Text(group.0.into()), Cell::Number(group.1 as f64, 0), Cell::Number(phi, 2)];
            row.extend(METHODS.map(|method| Cell::Number(rate(method), 1)));
            row.push(Cell::Number(contacts, 3));
            rows.push(row);
        }
    }
    Table {
        name: "rates".into(),
        title: "Million particle-steps a second of processor time".into(),
        columns: ["precision", "discs", "packing fraction"]
            .into_iter()
            .chain(METHODS)
            .chain(["contacts a disc"])
            .map(str::to_owned)
            .collect(),
        rows,
        notes: vec!["The best repeat. All three share state, law and integrator.".into()],
    }
}

fn phases(data: &Crossover) -> Table {
    let names: Vec<&str> =
        data.samples.first().map(|s| s.phases.keys().copied().collect()).unwrap_or_default();
    let rows = data.samples.iter().map(|sample| {
        let mut row = vec![
            Cell::Text(sample.precision.into()),
            Cell::Number(sample.particles as f64, 0),
            Cell::Number(sample.packing_fraction, 2),
            Cell::Text(sample.method.into()),
        ];
        row.extend(names.iter().map(|name| Cell::Number(sample.phases.get(name).copied().unwrap_or(0.0), 2)));
        row
    });
    Table {
        name: "phases".into(),
        title: "Nanoseconds a particle and step in each phase".into(),
        columns: ["precision", "discs", "packing fraction", "method"]
            .into_iter()
            .chain(names.iter().copied())
            .map(str::to_owned)
            .collect(),
        rows: rows.collect(),
        notes: vec![],
    }
}
