//! What the source's table of losses may mean: every reading of its loop beside its two numbers.

use crate::laboratory::langevin::study::readings::{DIAMETER, PARTICLES, Read, SIDE, SOURCE, STEPS};
use crate::report::{Cell, Rows, Table};
use std::f64::consts::PI;

/// By how many times counts are off the source's at most: those of losses, or of interactions.
fn off(read: &Read, which: usize) -> f64 {
    let ratios = read.counts.iter().zip(SOURCE).map(|(counts, (_, source))| {
        let ratio = counts[which].max(1) as f64 / source[which].max(1) as f64;
        ratio.max(1.0 / ratio)
    });
    ratios.fold(1.0, f64::max)
}

/// By how many times a reading is off at most, in either.
fn worst(read: &Read) -> f64 {
    off(read, 0).max(off(read, 1))
}

/// The nearest reading of which no number was fitted, and the nearest of all others.
pub(super) fn nearest(readings: &[Read]) -> String {
    let of = |is_fitted: bool| readings.iter().filter(move |read| read.is_fitted == is_fitted);
    let best = |is_fitted: bool| of(is_fitted).min_by(|a, b| worst(a).total_cmp(&worst(b)));
    let (Some(read), Some(fitted)) = (best(false), best(true)) else {
        return String::new();
    };
    format!(
        "Of {} readings the nearest ({}) is {:.0} times off; seven fitted choices, with a fourth of the density, {:.1} times.",
        of(false).count(),
        read.name,
        worst(read),
        worst(fitted)
    )
}

/// Pairs nearer than a distance (length) seen from each of the two, of a number of particles at random places in the source's box.
fn near(particles: f64, distance: f64) -> f64 {
    particles * particles * PI * distance * distance / (SIDE * SIDE)
}

/// Particles that are left in the source at a step.
fn left([lost, _]: [u64; 2]) -> f64 {
    PARTICLES as f64 - lost as f64
}

/// Why the source's two columns do not belong together.
pub(super) fn what_cannot_be() -> String {
    let (_, counts) = SOURCE[0];
    let least = STEPS as f64 * near(left(counts), DIAMETER);
    format!(
        "Its columns contradict its N, L and σ: the {} left, at random, meet {} times in 100 steps of 1, not {}. Only its program tells why.",
        Cell::Count(left(counts) as u64).for_reading(),
        Cell::Count(least as u64).for_reading(),
        Cell::Count(counts[1]).for_reading()
    )
}

/// Both numbers by every reading, the source's first.
pub(super) fn counts(readings: &[Read]) -> Table {
    let source = Read { name: "the source", is_fitted: false, counts: SOURCE.map(|(_, counts)| counts) };
    let is_source = |read: &Read| read.name == source.name;
    let columns = |what: &str| SOURCE.map(|(dt, _)| format!("{what}, dt = {dt}"));
    let times = |read: &Read, which: usize| (!is_source(read)).then(|| off(read, which));
    let all = std::iter::once(&source).chain(readings);
    Rows::of(all)
        .text("reading", |read| read.name)
        .cells(columns("lost"), |read| read.counts.map(|[lost, _]| Cell::Count(lost)))
        .number("times off", 1, |read| times(read, 0))
        .cells(columns("interactions"), |read| read.counts.map(|[_, met]| Cell::Count(met)))
        .number("times off", 1, |read| times(read, 1))
        .table("readings", "The source's loop by every reading of its print")
        .note(
            "Of a quarter of the particles at the source's density, times four. Interactions: pairs within the cut-off, from each of the two, over \
             100 steps. Each reading differs from the stated one in what its name says.",
        )
        .note(
            "The last but one fits ε, the last ε, kT, γ and the choices it names, the best of 1600 trials. 700 trials \
             at the stated density came within 3.4 at best. Seven choices fit eight numbers by chance: nothing follows from them.",
        )
}

/// Ways to read "interactions", and what they come to with 40 000 particles.
fn ways() -> [(&'static str, f64); 7] {
    let particles = PARTICLES as f64;
    let (steps, tried) = (STEPS as f64, |sectors: f64| 9.0 * (particles / sectors).powi(2));
    let within = |diameters: f64| near(particles, diameters * DIAMETER);
    [
        ("within σ, over 100 steps", steps * within(1.0)),
        ("within σ, over 100 steps, each pair once", 0.5 * steps * within(1.0)),
        ("within σ, at one step", within(1.0)),
        ("within 2^(1/6) σ, over 100 steps", steps * within(1.122_462)),
        ("within 2.5 σ, at one step", within(2.5)),
        ("tried in 400 sectors a side, at one step", tried(400.0)),
        ("tried in 200 sectors a side, at one step", tried(200.0)),
    ]
}

/// What "interactions" may count, between the least that the source's particles at the end make and the most that all make.
pub(super) fn interactions() -> Table {
    let words = |number: f64| Cell::Count(number.round() as u64).for_reading();
    let ends = |most: f64, counts: [u64; 2]| [most * (left(counts) / PARTICLES as f64).powi(2), most];
    let cell = |most: f64, counts: [u64; 2]| match ends(most, counts) {
        [least, most] if counts[0] > 0 => format!("{} to {}", words(least), words(most)),
        [_, most] => words(most),
    };
    let columns =
        SOURCE.map(|(dt, [_, met])| format!("dt = {dt} (source {})", Cell::Count(met).for_reading()));
    Rows::of(ways())
        .text("interactions are pairs", |(name, _)| *name)
        .cells(columns, |(_, most)| SOURCE.map(|(_, counts)| Cell::from(cell(*most, counts))))
        .table("interactions", "What the source's interactions may count, at random places")
        .note(
            "From the particles that are left at the end to all of them. At steps of 1 and 0.1, as long as σ and longer, places are random; at \
             shorter ones the mesh of the start and the repulsion leave fewer pairs within σ.",
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &'static str, is_fitted: bool, lost: u64, factor: u64) -> Read {
        let counts = SOURCE.map(|(_, [_, met])| [lost, factor * met]);
        Read { name, is_fitted, counts }
    }

    /// Fitted readings are never the nearest of the print, and the farther of the two columns counts.
    #[test]
    fn what_is_fitted_is_told_from_what_is_read() {
        let readings =
            [read("first", false, 754, 30), read("second", false, 754, 40), read("fit", true, 754, 1)];
        let said = nearest(&readings);
        assert!(said.starts_with("Of 2 readings the nearest (first) is 754 times off"), "{said}");
        assert!(said.ends_with("with a fourth of the density, 754.0 times."), "{said}");
        assert!((off(&readings[1], 1) - 40.0).abs() < 1e-9);
    }

    /// 40 000 particles in a square of 100 have 4 in a unit of area, each of which sees 0.126 within 0.1.
    #[test]
    fn pairs_at_random_places_are_counted_from_both() {
        assert!((ways()[2].1 - 40_000.0 * 4.0 * 0.0314159).abs() < 0.5);
        let said = what_cannot_be();
        assert!(said.contains("135") && said.contains("917") && said.contains("43"), "{said}");
    }
}
