//! Collisions a second of both engines.

use crate::laboratory::hard_disks::study::rates::{ENGINES, Rate, Rates};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};

/// Million collisions an hour of the source's program, by the number of discs: the best over the densities.
const SOURCE: [(f64, f64); 2] = [(2500.0, 460.0), (2_500_000.0, 210.0)];

/// What came out.
pub fn section(data: &Rates) -> Section {
    let best = |engine: &str| {
        let all = data.rates.iter().filter(|rate| rate.engine == engine).map(Rate::median);
        1e-6 * all.fold(0.0, f64::max)
    };
    // The aim is of 2500 discs, and of packing fractions from a half on.
    let aimed = |engine: &str| {
        let of = data.rates.iter().filter(|rate| {
            rate.engine == engine && rate.discs.next_power_of_two() == 4096 && rate.packing_fraction >= 0.5
        });
        1e-6 * of.map(Rate::median).fold(0.0, f64::max)
    };
    Section::new("hard-disks-rates", "Hard discs: collisions a second")
        .asks("How many collisions a second?")
        .expects("ISO99: 0.128 million a second with 2500 discs and 0.058 million with 2 500 000, on an Alpha of 600 MHz. Our aim: at least 5.5 \
                  million with 2500 discs at ν ≥ 0.5, and 1 million by the source's way.")
        .answers(format!(
            "One thread, {}: at best {:.2} million collisions a second by lists of each disc's own, {:.2} million the source's way.",
            data.instruction_set,
            best(ENGINES[0]),
            best(ENGINES[1]),
        ))
        .verdict(Verdict::aim(aimed(ENGINES[0]) >= 5.5 && aimed(ENGINES[1]) >= 1.0))
        .details(["Both engines find the same collisions, to the bit."])
        .figures([figure(data)])
        .tables([table(data)])
        .seeds([1])
        .depends_on_host()
}

fn sizes(data: &Rates) -> Vec<usize> {
    let mut sizes: Vec<usize> = data.rates.iter().map(|rate| rate.discs.next_power_of_two()).collect();
    sizes.sort_unstable();
    sizes.dedup();
    sizes
}

fn figure(data: &Rates) -> Figure {
    let mut series = vec![];
    for (number, engine) in ENGINES.into_iter().enumerate() {
        for (place, size) in sizes(data).into_iter().enumerate() {
            let own: Vec<&Rate> = data
                .rates
                .iter()
                .filter(|rate| rate.engine == engine && rate.discs.next_power_of_two() == size)
                .collect();
            let Some(first) = own.first() else { continue };
            let points = own.iter().map(|rate| {
                let (low, high) = rate.rates.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &rate| {
                    (low.min(1e-6 * rate), high.max(1e-6 * rate))
                });
                (rate.packing_fraction, 1e-6 * rate.median(), [low, high])
            });
            series.push(Series::new(
                format!("{engine}, {} discs", Cell::Number(first.discs as f64, 0).for_reading()),
                if number == 0 { Style::Joined } else { Style::Dashed },
                place,
                points,
            ));
        }
    }
    Chart::of(
        Axis::linear("packing fraction ν", None),
        Axis::logarithmic("rate", Some("million collisions/s")),
    )
    .with(series)
    .figure("rates", "Collisions a second of processor time")
    .caption(format!(
        "Medians of rounds in which the engines take turns, {}, one thread; bars from the lowest to the highest.",
        data.instruction_set
    ))
}

fn table(data: &Rates) -> Table {
    let over_source = |fast: &Rate| {
        let known = SOURCE.iter().find(|(known, _)| (fast.discs as f64 / known - 1.0).abs() < 0.1);
        known.map(|(_, rate)| 3600e-6 * fast.median() / rate)
    };
    Rows::of(data.rates.chunks_exact(ENGINES.len()).map(|pair| [&pair[0], &pair[1]]))
        .number("discs", 0, |[fast, _]| fast.discs as f64)
        .number("ν", 2, |[fast, _]| fast.packing_fraction)
        .number("fast (million/s)", 3, |[fast, _]| 1e-6 * fast.median())
        .number("the source's way (million/s)", 3, |[_, reference]| 1e-6 * reference.median())
        .text("its mask", |[_, reference]| reference.mask.clone().unwrap_or_default())
        .number("fast over it", 1, |[fast, reference]| fast.median() / reference.median())
        .number("fast over the source's machine", 0, |[fast, _]| over_source(fast))
        .number("memory, fast (MB)", 0, |[fast, _]| 1e-6 * fast.bytes as f64)
        .number("memory, the source's way (MB)", 0, |[_, reference]| 1e-6 * reference.bytes as f64)
        .table("rates", "Million collisions a second of processor time")
        .note("Memory as `scene check` foresees it for a run.")
}
