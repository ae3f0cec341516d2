//! From how many discs on several ranks pay.

use crate::laboratory::lattice_md::study::bands::{Dealt, PAYS, PER_RANK, Reached, SCENES};
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::report::{Cell, Rows, Section, Verdict};
use stripmine_physics::number::{range, significant};

/// What came out.
pub fn section(data: &Dealt) -> Section {
    let off = data.halos.iter().map(|halo| 100.0 * (halo.bytes[1] / halo.bytes[0] - 1.0).abs());
    let off = off.fold(0.0, f64::max);
    let of =
        |network: &str, discs: f64| data.reached.iter().find(|it| it.network == network && it.discs == discs);
    let says = |network: &str, discs: f64| {
        of(network, discs)
            .map_or(String::new(), |it| format!("{} ranks on {network}", significant(it.pays, 3)))
    };
    let most = of("InfiniBand HDR", SCENES[2]).map_or(1.0, |it| it.bands);
    Section::new("bands", "Beyond one machine: from how many discs on ranks pay")
        .asks("With how many ranks does a scene still use 80 % of each, on which network?")
        .expects("No source says. Bands have at least 16 rows, so that a scene of N discs has no more ranks than some √N/16.")
        .answers(format!(
            "By a model, 10⁶ dense discs use 80 % of {} and of {}, 10⁸ of {} and {}, where their {} bands end; what ranks were seen to send is within {} % of what the model counts.",
            says("InfiniBand HDR", SCENES[0]),
            says("25 Gb/s Ethernet", SCENES[0]),
            says("InfiniBand HDR", SCENES[2]),
            says("25 Gb/s Ethernet", SCENES[2]),
            significant(most, 3),
            significant(off, 2)
        ))
        .verdict(Verdict::Computed)
        .details([format!(
            "Fast lattice, packing fraction {}, f64, {}. The work of a disc is measured on one core of this host, {} ns; two messages a step, counted on {} ranks; networks are {}. Ranks that wait for one with more to do, \
             and ranks that share the bandwidth of a node's memory, are not in it.",
            data.packing_fraction,
            data.instruction_set,
            range(data.work.iter().map(|work| 1e9 * work.seconds), 3),
            range(data.halos.iter().map(|halo| halo.ranks as f64), 2),
            "of figures most of which are assumed (see the files in src/model/networks)"
        )])
        .figures([figure(data)])
        .tables([reached(data), halos(data)])
        .depends_on_host()
}

/// Two networks, with two scenes and those that grow.
fn figure(data: &Dealt) -> Figure {
    let drawn = [(Some(SCENES[0]), "10⁶ discs"), (Some(SCENES[2]), "10⁸ discs"), (None, "10⁶ a rank")];
    let networks =
        [("InfiniBand HDR", "InfiniBand", Style::Line), ("25 Gb/s Ethernet", "Ethernet", Style::Dashed)];
    let series = networks.into_iter().flat_map(|(network, short, style)| {
        drawn.into_iter().enumerate().filter_map(move |(hue, (discs, scene))| {
            let curve = data.curves.iter().find(|it| it.network == network && it.discs == discs)?;
            let points = curve.points.iter().map(|&[ranks, efficiency]| Point::at(ranks, efficiency));
            Some(Series::new(format!("{short}, {scene}"), style, hue, points))
        })
    });
    Chart::of(Axis::logarithmic("ranks", None), Axis::linear("efficiency", None).between([0.0, 1.0]))
        .with(series)
        .figure("efficiency", "Efficiency over ranks, by the model")
        .caption("The part of a step in which ranks move discs of their own. Lines end where a scene has no more bands; Slingshot's lie on InfiniBand's.")
}

fn reached(data: &Dealt) -> crate::report::Table {
    Rows::of(&data.reached)
        .text("network", |it: &&Reached| it.network.clone())
        .short("discs", |it| it.discs)
        .short("bands", |it| it.bands)
        .short("ranks that pay", |it| it.pays)
        .short("ranks that would lose nothing", |it| it.gain)
        .table("reached", format!("How many ranks are used to {} %", 100.0 * PAYS))
        .note(format!(
            "In powers of two. Where scenes grow with the ranks each has {} discs.",
            Cell::Number(PER_RANK, 0).for_reading()
        ))
}

fn halos(data: &Dealt) -> crate::report::Table {
    Rows::of(&data.halos)
        .count("discs", |it| it.discs)
        .count("ranks", |it| it.ranks)
        .number("bytes of a message, counted", 0, |it| it.bytes[0])
        .number("sent", 0, |it| it.bytes[1])
        .number("messages a step", 1, |it| it.messages)
        .table("halos", "What the first rank sends")
}
