//! From how many discs on several ranks pay.

use crate::laboratory::lattice_md::study::bands::{Dealt, PAYS, PER_RANK, Reached, SCENES};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Verdict};
use stripmine_physics::number::{range, significant};

/// What came out.
pub fn section(data: &Dealt) -> Section {
    let off = data.halos.iter().map(|halo| 100.0 * (halo.bytes[1] / halo.bytes[0] - 1.0).abs());
    let off = off.fold(0.0, f64::max);
    let of =
        |network: &str, discs: f64| data.reached.iter().find(|it| it.network == network && it.discs == discs);
    let says = |network: &str| {
        of(network, SCENES[2]).map_or(String::new(), |it| {
            format!(
                "{} ranks ({} times as fast as one) on {network}",
                significant(it.pays, 3),
                significant(it.gain, 3)
            )
        })
    };
    let most = of("Slingshot 11", SCENES[2]).map_or(1.0, |it| it.bands);
    Section::new("bands", "Beyond one machine: from how many discs on ranks pay")
        .asks("With how many ranks does a scene still use 80 % of each, on which network?")
        .expects("No source says. Bands have at least 16 rows, so that a scene of N discs has no more ranks than some √N/16.")
        .answers(format!(
            "By a model, 10⁸ dense discs use 80 % of {}, {}, {}; they have {} bands, and no more ranks. What ranks were seen to send is within {} % of what the model counts.",
            says("InfiniBand HDR"),
            says("Slingshot 11"),
            says("25 Gb/s Ethernet"),
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

/// Two scenes, and those that grow.
fn figure(data: &Dealt) -> Figure {
    let mut networks: Vec<&str> = data.curves.iter().map(|curve| curve.network.as_str()).collect();
    networks.dedup();
    let drawn = [Some(SCENES[2]), None];
    let series = networks.iter().enumerate().flat_map(|(hue, network)| {
        drawn.into_iter().filter_map(move |discs| {
            let curve = data.curves.iter().find(|it| it.network == *network && it.discs == discs)?;
            let (name, style) = match discs {
                Some(_) => (format!("{network}, 10⁸ discs"), Style::Line),
                None => (format!("{network}, 10⁶ a rank"), Style::Dashed),
            };
            Some(Series::new(name, style, hue, curve.points.iter().map(|&[ranks, e]| (ranks, e, [e, e]))))
        })
    });
    Chart::of(Axis::logarithmic("ranks", None), Axis::linear("efficiency", None).between([0.0, 1.1]))
        .with(series)
        .figure("efficiency", "Efficiency over ranks, by the model")
        .caption("Lines end where a scene has no more bands. Above 1: smaller parts fit a cache.")
}

fn reached(data: &Dealt) -> crate::report::Table {
    Rows::of(&data.reached)
        .text("network", |it: &&Reached| it.network.clone())
        .short("discs", |it| it.discs)
        .short("bands", |it| it.bands)
        .short("ranks that pay", |it| it.pays)
        .short("gain", |it| it.gain)
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
