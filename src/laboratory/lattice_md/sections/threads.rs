//! What more threads give.

use crate::laboratory::lattice_md::study::threads::{Scaling, Threads};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table};
use stripmine_physics::number::{counted, range};

/// How threads are used, in the order of a row.
const VARIANTS: [&str; 3] = ["one thread", "all threads on one scene", "a scene on each thread"];

fn variants(scene: &Scaling) -> [&[f64]; 3] {
    [&scene.alone, &scene.together, &scene.side_by_side]
}

/// What came out.
pub fn section(data: &Threads) -> Section {
    let least = data.scenes.iter().min_by(|a, b| a.speedup().total_cmp(&b.speedup()));
    let least = least.map_or(String::new(), |scene| {
        format!(" The least is {} discs at packing fraction {}.", count(scene), scene.packing_fraction)
    });
    Section::new("threads", "What threads give, and what the machine has to give")
        .asks("How much faster are several threads, and how much faster can they be on this machine?")
        .expects("No source says: BP93's machine had one processor. The ceiling is what scenes side by side reach, one a thread.")
        .answers(format!(
            "{} threads on one scene are {} times as fast as one, where scenes side by side reach {} ({}).{least}",
            data.threads,
            range(data.scenes.iter().map(Scaling::speedup), 3),
            range(data.scenes.iter().map(Scaling::ceiling), 3),
            counted(data.scenes.len(), "scene", "scenes")
        ))
        .details([format!(
            "Fast lattice, f64, whole steps with friction, {}, {} threads. Every scene has the same bits on any number of threads.",
            data.instruction_set, data.threads
        )])
        .figures(packing_fractions(data).into_iter().map(|phi| figure(data, phi)))
        .tables([table(data)])
        .seeds([1])
        .depends_on_host()
}

fn count(scene: &Scaling) -> String {
    Cell::Number(scene.particles as f64, 0).for_reading()
}

fn packing_fractions(data: &Threads) -> Vec<f64> {
    let mut fractions: Vec<f64> = data.scenes.iter().map(|scene| scene.packing_fraction).collect();
    fractions.sort_by(|a, b| b.total_cmp(a));
    fractions.dedup();
    fractions
}

fn middle(rates: &[f64]) -> [f64; 3] {
    let mut sorted: Vec<f64> = rates.iter().map(|rate| 1e-6 * rate).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |place: usize| sorted.get(place).copied().unwrap_or(f64::NAN);
    [at(0), at(sorted.len() / 2), at(sorted.len().saturating_sub(1))]
}

fn figure(data: &Threads, packing_fraction: f64) -> Figure {
    let series = VARIANTS.into_iter().enumerate().map(|(hue, name)| {
        let of = data.scenes.iter().filter(|scene| scene.packing_fraction == packing_fraction);
        let points = of.map(|scene| {
            let [lowest, median, highest] = middle(variants(scene)[hue]);
            (scene.particles as f64, median, [lowest, highest])
        });
        Series::new(name, Style::Joined, hue, points)
    });
    let title = format!("Rate over the number of discs at packing fraction {packing_fraction}");
    Chart::of(Axis::logarithmic("discs", None), Axis::logarithmic("rate", Some("million particle-steps/s")))
        .with(series)
        .figure(format!("threads_{packing_fraction}"), title)
        .caption("Medians of rounds in which the three take turns, in wall time; bars from the lowest to the highest.")
}

fn table(data: &Threads) -> Table {
    Rows::of(&data.scenes)
        .number("discs", 0, |scene| scene.particles as f64)
        .number("packing fraction", 2, |scene| scene.packing_fraction)
        .cells(VARIANTS, |scene| variants(scene).map(|rates| Cell::Number(middle(rates)[1], 1)))
        .number("speed-up", 2, |scene| scene.speedup())
        .number("speed-up of scenes side by side", 2, |scene| scene.ceiling())
        .number("reached of that", 2, |scene| scene.efficiency())
        .table("threads", "Million particle-steps a second")
        .note("Rates are medians over the rounds; a ratio is the median of the rounds' ratios.")
}
