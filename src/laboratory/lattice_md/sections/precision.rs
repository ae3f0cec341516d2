//! What fewer digits cost: tables, figures and what came out.

use crate::laboratory::lattice_md::study::precision::energy::{self, EnergyCase, STEPPINGS};
use crate::laboratory::lattice_md::study::precision::forces::ForceError;
use crate::laboratory::lattice_md::study::precision::trajectories::{self, Divergence};
use crate::laboratory::lattice_md::study::precision::{EQUILIBRATION, PACKING_FRACTIONS, Precisions, SEEDS};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table};
use crate::statistics::Spread;
use stripmine_physics::number::{in_tens, range};

/// What came out.
pub fn section(data: &Precisions) -> Section {
    Section::new("precision", "What single precision costs")
        .asks("What do fewer digits than 64 bits cost in forces, energy and trajectories?")
        .expects("The source used 64 bits only; single precision rounds to 6e-8 of a number.")
        .answers(answer(data))
        .details([details(data)])
        .figures([force_figure(&data.forces)])
        .figures(steps().map(|dt| energy_figure(&data.energies, dt)))
        .figures([trajectory_figure(&data.trajectories)])
        .tables([
            force_table(&data.forces),
            energy_table(&data.energies),
            trajectory_table(&data.trajectories),
        ])
        .seeds(SEEDS)
}

/// Root-mean-square errors of a configuration's forces, one of each dense box.
fn over_boxes<'d>(data: &'d Precisions, name: &'d str) -> impl Iterator<Item = f64> + use<'d> {
    let of_variant = data.forces.iter().filter(move |error| error.variant.name == name);
    let dense = of_variant.filter(|error| error.packing_fraction == PACKING_FRACTIONS[0]);
    dense.map(|error| error.rms)
}

fn answer(data: &Precisions) -> String {
    let [single, mixed] = ["f32, fast", "mixed, fast"].map(|name| over_boxes(data, name));
    format!(
        "In boxes of a thousand to a hundred thousand discs the forces err by {} of their size in f32, and by {} in mixed precision.",
        range(single, 2),
        range(mixed, 2)
    )
}

fn details(data: &Precisions) -> String {
    let stepping = STEPPINGS[0];
    let energies = data.energies.iter().filter(|case| case.stepping == stepping);
    let energies: Vec<String> =
        energies.map(|case| format!("{} in {}", in_tens(case.largest.mean, 2), case.precision)).collect();
    let dense = || data.trajectories.iter().filter(|rival| rival.packing_fraction == PACKING_FRACTIONS[0]);
    let rates: Vec<String> =
        dense().map(|rival| format!("{:.3} ({})", rival.rate.mean, named(rival))).collect();
    let absolute = range(over_boxes(data, "mixed, programs, absolute"), 2);
    format!(
        "Errors are roots of mean squares at packing fraction {}, of the fast engine; programs in mixed precision whose positions count from the \
         corner of the box have {absolute}. Over {} undamped steps of {} with dt = {} the energy strays by {}. Trajectories part from those in \
         f64 at the rates {} in a unit of time, which is the chaos of the gas itself: digits only set where it starts.",
        PACKING_FRACTIONS[0],
        Cell::Count(energy::STEPS).for_reading(),
        stepping.name,
        stepping.dt,
        energies.join(", "),
        rates.join(", ")
    )
}

fn named(rival: &Divergence) -> String {
    let engine = if rival.engine == "fast" { "" } else { ", programs" };
    format!("{}{engine}", rival.precision)
}

/// Points that a logarithmic axis can show.
fn above_zero(x: &[f64], y: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    x.iter().copied().zip(y.iter().copied()).filter(|(_, y)| *y > 0.0)
}

fn force_figure(errors: &[ForceError]) -> Figure {
    let dense = errors
        .iter()
        .filter(|error| error.packing_fraction == PACKING_FRACTIONS[0] && error.variant.precision != "f64");
    let series =
        Series::by_name(Style::Joined, dense.map(|error| (error.variant.name, (error.side, error.rms))));
    Chart::of(
        Axis::logarithmic("side of the box", Some("diameters")),
        Axis::logarithmic("relative error of a force", None),
    )
    .with(series)
    .figure("force_error", "Error of the forces over the size of the box")
    .caption(format!(
        "Packing fraction {}. Root of the mean square error over that of the forces; held against the fast engine in f64. The fast engine keeps \
         positions from the cell's centre, as programs do in f32. In mixed precision programs keep them in f64 from the box's corner and take \
         the difference with the cell in f64; absolute ones are from the corner in f32. Ways that are equally good lie upon each other: the last \
         of the legend is in front.",
        PACKING_FRACTIONS[0]
    ))
}

/// The time steps that were tried, each once.
fn steps() -> impl Iterator<Item = f64> {
    let mut steps: Vec<f64> = STEPPINGS.iter().map(|stepping| stepping.dt).collect();
    steps.dedup();
    steps.into_iter()
}

fn energy_figure(cases: &[EnergyCase], dt: f64) -> Figure {
    let series = cases.iter().filter(|case| case.stepping.dt == dt).map(|case| {
        Series::new(
            format!("{}, {}", case.stepping.name, case.precision),
            if case.stepping.gear_values.is_some() { Style::Dashed } else { Style::Line },
            energy::PRECISIONS.iter().position(|&precision| precision == case.precision).unwrap_or(0),
            above_zero(&case.times, &case.deviation),
        )
    });
    Chart::of(
        Axis::logarithmic("time", Some("reduced")),
        Axis::logarithmic("relative deviation of the energy", None),
    )
    .with(series)
    .figure(
        format!("energy_dt_{}", dt.to_string().replace('.', "_")),
        format!("How far the energy strays, dt = {dt}"),
    )
    .caption(format!(
        "Packing fraction {}, about {} discs without damping and friction, fast engine. Root of the mean square, over {} seeds and the looks of \
         a window, of the energy's relative deviation from its first value.",
        energy::PACKING_FRACTION,
        energy::PARTICLES,
        SEEDS.len()
    ))
}

fn trajectory_figure(rivals: &[Divergence]) -> Figure {
    let hue = |rival: &Divergence| {
        let variant = (rival.precision, rival.engine);
        trajectories::RIVALS.iter().position(|&other| other == variant).unwrap_or(0)
    };
    let series = rivals.iter().map(|rival| {
        Series::new(
            format!("{}, packing fraction {}", named(rival), rival.packing_fraction),
            if rival.packing_fraction == PACKING_FRACTIONS[0] { Style::Line } else { Style::Dashed },
            hue(rival),
            above_zero(&rival.times, &rival.distance),
        )
    });
    Chart::of(Axis::linear("time", Some("reduced")), Axis::logarithmic("distance", Some("diameters")))
        .with(series)
        .figure("trajectories", "How far trajectories run apart")
        .caption(format!(
            "Distance between a disc and its twin in the fast engine in f64: root of the mean square over about {} discs and {} seeds. Velocity \
             Verlet, dt = {}. A straight line is exponential growth.",
            trajectories::PARTICLES,
            SEEDS.len(),
            trajectories::DT
        ))
}

/// A relative error in millionths.
fn millionths(it: &Spread) -> Cell {
    Cell::with_error(1e6 * it.mean, it.error.map(|error| 1e6 * error), 2)
}

fn force_table(errors: &[ForceError]) -> Table {
    Rows::of(errors)
        .number("packing fraction", 2, |error| error.packing_fraction)
        .count("discs", |error| error.particles)
        .number("side (diameters)", 0, |error| error.side)
        .number("contacts a disc", 3, |error| error.contacts)
        .text("variant", |error| error.variant.name)
        .short("rms error", |error| error.rms)
        .short("largest error", |error| error.largest)
        .table("forces", "Errors of the forces on one configuration")
        .note(format!("The bench scene after {EQUILIBRATION} steps; errors of a disc's force, over the root of the mean square of all forces, \
                       against the fast engine in f64."))
}

fn energy_table(cases: &[EnergyCase]) -> Table {
    let steps = Cell::Count(energy::STEPS).for_reading();
    Rows::of(cases)
        .text("integrator", |case| case.stepping.name)
        .number("dt", 4, |case| case.stepping.dt)
        .text("precision", |case| case.precision)
        .cell("largest deviation (10⁻⁶)", |case| millionths(&case.largest))
        .cell("deviation at the end (10⁻⁶)", |case| millionths(&case.last))
        .cell("drift (10⁻⁶)", |case| millionths(&case.drift))
        .table("energy", format!("The energy over {steps} undamped steps"))
        .note(format!(
            "Relative to the energy at the first look, after {} steps; looks are {} steps apart. Drift: the change over {steps} steps by the \
             straight line of least squares. Means over {} seeds with their standard errors.",
            energy::SETTLING,
            energy::LOOK,
            SEEDS.len()
        ))
}

fn trajectory_table(rivals: &[Divergence]) -> Table {
    let lost = |rival: &Divergence| {
        let look = rival.distance.iter().position(|&distance| distance >= trajectories::LOST)?;
        Some(rival.times[look])
    };
    Rows::of(rivals)
        .number("packing fraction", 2, |rival| rival.packing_fraction)
        .text("variant", |rival| named(rival))
        .short(format!("distance after {} steps (diameters)", trajectories::LOOK), |rival| {
            rival.distance.first().copied()
        })
        .cell("rate of growth (1/time)", |rival| {
            Cell::with_error(rival.rate.mean, rival.rate.error, 3)
        })
        .number(format!("time until {} diameters", trajectories::LOST), 1, |rival| lost(rival))
        .table("trajectories", "How fast trajectories part from those of the fast engine in f64")
        .note(format!(
            "Rate: least squares through the logarithm of the distance, from {} times its first value to {} diameters; mean over {} seeds with \
             its standard error. Programs and the fast engine differ in f64 in the order of their sums only: the growth is the gas's own.",
            trajectories::PARTED,
            trajectories::LOST,
            SEEDS.len()
        ))
}
