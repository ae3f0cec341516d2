//! Order, free times and speeds on both sides of melting.

use crate::laboratory::hard_disks::study::structure::{Structure, Structures};
use crate::report::figure::{Axis, Chart, Drawing, Figure, Guide, Picture, Series, Shape, Style, Tint};
use crate::report::{Rows, Section, Table, Verdict};

/// Free times over their mean that are drawn; longer ones are too few.
const LONGEST: f64 = 5.0;

/// From the densest fluid to the least dense crystal, as simulations of a million discs have it (packing fraction).
const TRANSITION: f64 = 0.020;

/// Side of what is drawn of the box, in diameters.
const SHOWN: f64 = 30.0;

/// What came out.
pub fn section(data: &Structures) -> Section {
    let [gas, fluid, between, crystal] = data.structures.as_slice() else {
        unreachable!("the study has four packing fractions")
    };
    let is_ordered = fluid.order[0].value < 0.15 && crystal.order[0].value > 0.6;
    // The fluid that melts and the crystal that does not are as near to each other as the transition is wide, or a little farther.
    let is_located = is_ordered && crystal.packing_fraction - fluid.packing_fraction < 2.0 * TRANSITION;
    let is_maxwell = data.structures.iter().all(|it| it.maxwell[1] > 0.001);
    let largest = gas.free_times.iter().zip(&data.dilute).map(|(seen, theory)| (seen - theory).abs());
    let largest = largest.fold(0.0, f64::max);
    Section::new("hard-disks-structure", "Hard discs: melting, free times and speeds")
        .asks("At which density does a crystal of hard discs melt, and how long do discs fly?")
        .expects("Simulations of a million discs find a fluid below a packing fraction of 0.700, fluid and hexatic phase beside each other up to \
                  0.716, and a crystal above 0.720. A dilute gas has the free times of its Maxwell velocities.")
        .answers(format!(
            "{} densities {} melting: from a crystal of {} discs the global order |Ψ₆| falls to {} at {}, is {} at {} and stays at {} at {}.",
            data.structures.len() - 1,
            if is_located { "locate" } else { "bracket and do not locate" },
            data.discs,
            fluid.order[0],
            fluid.packing_fraction,
            between.order[0],
            between.packing_fraction,
            crystal.order[0],
            crystal.packing_fraction,
        ))
        .verdict(Verdict::of_claims(&[is_ordered, is_located, is_maxwell, largest < 0.05]))
        .details([format!(
            "Free times at 0.02 differ from theory by at most {largest:.3} of a density of about 1. Discs that start equally fast have Maxwell's \
             velocities at the end, p = {:.2} to {:.2}.",
            data.structures.iter().map(|it| it.maxwell[1]).fold(1.0, f64::min),
            data.structures.iter().map(|it| it.maxwell[1]).fold(0.0, f64::max),
        )])
        .figures([correlation(data), free_times(data)])
        .figures(data.structures.iter().skip(1).map(picture))
        .tables([table(data)])
        .seeds([1])
}

fn named(it: &Structure) -> String {
    format!("ν = {}", it.packing_fraction)
}

fn correlation(data: &Structures) -> Figure {
    let curves = data.structures.iter().enumerate().map(|(hue, it)| {
        let points = data.distances.iter().zip(&it.correlation).map(|(&x, &y)| (x, y));
        Series::new(named(it), Style::Line, hue, points)
    });
    let contacts = data.structures.iter().map(|it| (1.0, it.contact));
    Chart::of(
        Axis::linear("distance of the centres over the diameter", None),
        Axis::linear("pair correlation g", None),
    )
    .with(curves)
    .series("at contact, by the virial", Style::Points, 6, contacts)
    .figure("pair-correlation", "Pair correlation on both sides of melting")
    .caption(format!(
        "Means of {} looks; the points at contact follow from the pressure, (Z − 1)/(2 ν).",
        data.looks
    ))
}

fn free_times(data: &Structures) -> Figure {
    let curves = data.structures.iter().enumerate().map(|(hue, it)| {
        let bins = (0..data.times.len()).filter(|&bin| data.times[bin] < LONGEST);
        let points = bins.map(|bin| (data.times[bin], it.free_times[bin] / data.dilute[bin]));
        Series::new(named(it), Style::Steps, hue, points)
    });
    Chart::of(
        Axis::linear("free time over its mean", None),
        Axis::linear("density over that of a dilute gas", None),
    )
    .with(curves)
    .figure("free-times", "Time between two collisions of a disc")
    .caption("Probability density of the free time over what the Maxwell velocities of a dilute gas give. In a crystal long free times are rare.")
}

fn picture(it: &Structure) -> Figure {
    let sides = it.sides.map(|side| side.min(SHOWN));
    let shown =
        it.discs.iter().filter(|(centre, _)| centre.iter().zip(sides).all(|(x, side)| *x < side + 0.5));
    let shapes = shown.map(|&(centre, along)| Shape::Disc {
        centre,
        radius: 0.5,
        tint: Tint::Shade(0.5 * (along + 1.0)),
    });
    Picture::Drawing(Drawing {
        window: [[0.0; 2], sides],
        width: 640.0,
        shapes: shapes.collect(),
        shades: Some((-1.0, 1.0, "ψ₆ along the mean of all".into())),
        guide: Some(Guide { unit: "diameters".into(), gravity: None }),
    })
    .figure(
        format!("discs-{}", it.packing_fraction.to_string().replace('.', "-")),
        format!("Discs at a packing fraction of {}", it.packing_fraction),
    )
    .caption("A part of the box. Shade: the bonds of a disc to its six nearest, ψ₆, along the mean of all. 1 is a crystal in line with the \
              whole.")
}

fn table(data: &Structures) -> Table {
    Rows::of(&data.structures)
        .number("ν", 2, |it| it.packing_fraction)
        .number("|Ψ₆| of all", 3, |it| it.order[0].value)
        .number("± (95 %)", 3, |it| it.order[0].bar)
        .number("mean |ψ₆|", 3, |it| it.order[1].value)
        .number("± (95 %)", 4, |it| it.order[1].bar)
        .number("g at contact, by the virial", 3, |it| it.contact)
        .number("g from 1.00 to 1.02", 3, |it| it.correlation[0])
        .number("mean free time", 5, |it| it.free[0])
        .number("mean free path", 5, |it| it.free[1])
        .short("p of Maxwell at the start", |it| it.maxwell[0])
        .number("p at the end", 3, |it| it.maxwell[1])
        .table("structure", "Order, free times and velocities (diameter = m = kT = 1)")
        .note("p: the probability by Kolmogorov and Smirnov; all discs start equally fast.")
}
