//! Order, free times and speeds of hard discs on both sides of melting.

use super::fluid::compressibility;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::laboratory::running::RunningScene;
use crate::report::figure::{Drawing, DrawnShape, Guide, Picture, Tint};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::MeanWithBar;
use crate::study::StudyError;
use std::f64::consts::{PI, TAU};
use stripmine_physics::domain::Domain;
use stripmine_physics::method::hard_disks::keys::COLLISION_LOG;
use stripmine_physics::method::{METHODS, StartPurpose, Until, load};
use stripmine_physics::near::NeighbourSearch;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Packing fractions: dilute gas, fluid, between fluid and crystal, crystal.
const PACKING_FRACTIONS: [f64; 4] = [0.02, 0.65, 0.71, 0.74];
/// Minimum number of discs.
const DISCS: usize = 4096;
/// Collisions per disc before the measurement.
const SETTLING: u64 = 1500;
/// Samples of the order, and collisions per disc between them.
const LOOKS: (usize, u64) = (20, 50);
/// Collisions whose free times are recorded.
const LOGGED: u64 = 200_000;
/// Width (diameters) and number of the bins of distances.
const DISTANCES: (f64, usize) = (0.02, 200);
/// Width (mean free times) and number of the bins of free times.
const TIMES: (f64, usize) = (0.1, 80);
/// Side of the drawn part of the box (diameters).
const SHOWN: f64 = 30.0;

/// Results at one packing fraction.
struct Structure {
    packing_fraction: f64,
    discs: usize,
    /// Global bond-orientational order |Σ ψ₆|/N, and mean |ψ₆| of a disc.
    order: [MeanWithBar; 2],
    /// Pair correlation in each bin of distances.
    correlation: Vec<f64>,
    /// Pair correlation at contact from the virial, (Z − 1)/(2 ν).
    contact: f64,
    /// Probability density of free times over their mean.
    free_times: Vec<f64>,
    /// Mean free time, and mean free path over the diameter.
    free: [f64; 2],
    /// Probability of the Kolmogorov–Smirnov test for Maxwell's distribution of velocities: at the start, where all speeds are equal, and at
    /// the end.
    maxwell: [f64; 2],
    picture: Picture,
}

/// Simulates every packing fraction, starting from a crystal with equal speeds.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let all = ProgressMeter::new(PACKING_FRACTIONS.len() as f64, lab.progress)
        .run_cases(&PACKING_FRACTIONS, structure)?;
    let dilute: Vec<f64> = (0..TIMES.1).map(|bin| dilute_gas_density(bin_middle(TIMES, bin))).collect();
    let bins = |count: usize| all.iter().flat_map(move |it| (0..count).map(move |bin| (it, bin)));
    let off = all[0].free_times.iter().zip(&dilute).map(|(seen, theory)| (seen - theory).abs());
    let off = off.fold(0.0, f64::max);
    let made = FinishedItem::of([
        table(&all),
        FrameBuilder::of(bins(DISTANCES.1))
            .number("ν", 2, |(it, _)| it.packing_fraction)
            .number("distance over the diameter", 2, |(_, bin)| 1.0 + bin_middle(DISTANCES, *bin))
            .number("pair correlation g", 3, |(it, bin)| it.correlation[*bin])
            .frame("correlation", "Pair correlation"),
        FrameBuilder::of(bins(TIMES.1))
            .number("ν", 2, |(it, _)| it.packing_fraction)
            .number("free time over its mean", 2, |(_, bin)| bin_middle(TIMES, *bin))
            .number("density", 3, |(it, bin)| it.free_times[*bin])
            .number("density of a dilute gas", 3, |(_, bin)| dilute[*bin])
            .frame("times", "Probability density of free times"),
        FrameBuilder::of([()])
            .count("discs", |()| all[0].discs)
            .number("largest difference of free times", 3, |()| off)
            .frame("summary", "Number of discs, and free times of the gas beside theory"),
    ]);
    let made = all.into_iter().skip(1).fold(made, |made, it| {
        made.with_picture(&format!("discs-{}", it.packing_fraction).replace('.', "-"), it.picture)
    });
    Ok(made.with_seeds([1]))
}

fn table(all: &[Structure]) -> ResultFrame {
    FrameBuilder::of(all)
        .number("ν", 2, |it| it.packing_fraction)
        .mean("|Ψ₆| of all", 3, |it| it.order[0])
        .number("mean |ψ₆|", 3, |it| it.order[1].value)
        .number("± (95 %)", 4, |it| it.order[1].bar)
        .number("g at contact, by the virial", 3, |it| it.contact)
        .number("g from 1.00 to 1.02", 3, |it| it.correlation[0])
        .number("mean free time", 5, |it| it.free[0])
        .number("mean free path", 5, |it| it.free[1])
        .short("p of Maxwell at the start", |it| it.maxwell[0])
        .number("p at the end", 3, |it| it.maxwell[1])
        .frame("structure", "Order, free times and velocities (diameter = m = kT = 1)")
}

fn bin_middle((width, _): (f64, usize), bin: usize) -> f64 {
    (bin as f64 + 0.5) * width
}

/// Picture of a part of the box. Each disc has a position and the alignment of its bonds with the global bond order, from −1 to 1.
fn picture(domain: Domain, discs: Vec<([f64; 2], f64)>) -> Picture {
    let sides = domain.lengths().map(|side| side.min(SHOWN));
    let shown =
        discs.into_iter().filter(|(centre, _)| centre.iter().zip(sides).all(|(x, side)| *x < side + 0.5));
    let disc =
        |(centre, along)| DrawnShape::Disc { centre, radius: 0.5, tint: Tint::Shade(0.5 * (along + 1.0)) };
    Picture::Drawing(Drawing {
        window: [[0.0; 2], sides],
        width: 640.0,
        shapes: shown.map(disc).collect(),
        shades: Some((-1.0, 1.0, "ψ₆ along the mean of all".into())),
        guide: Some(Guide { unit: "diameters".into(), gravity: None }),
    })
}

fn structure(&packing_fraction: &f64) -> Result<Structure, StudyError> {
    let overrides = Overrides::new().set(&PACKING_FRACTION, packing_fraction).set(&COUNT, DISCS);
    let overrides = overrides.set(&COLLISION_LOG, true);
    let (scene, method) = load("melting", &overrides.texts(), METHODS)?;
    let (domain, mut start) = (scene.domain, scene.particles().clone());
    for (disc, turn) in start.all_mut().iter_mut().zip(1..) {
        // Multiples of the golden section: directions are uniform but without order.
        let angle = TAU * (f64::from(turn) * 0.618_033_988_749_895).fract();
        disc.velocity = [2f64.sqrt() * angle.cos(), 2f64.sqrt() * angle.sin(), 0.0];
    }
    let mut running = RunningScene::of(method, scene.model.started_from(start), StartPurpose::Run)?;
    let count = running.simulation.particles().grain_count();
    let maxwell = |running: &RunningScene| {
        Ok::<_, StudyError>(running.maxwell_probability(running.observed_values(["temperature"])?[0]))
    };
    let begin = maxwell(&running)?;
    for _ in 0..SETTLING {
        running.advance_events(count as u64 / 2)?;
        // Free times during settling are not recorded.
        running.simulation.take_events();
    }
    let names = ["time", "virial", "collisions", "temperature"];
    let before = running.observed_values(names)?;
    let (mut order, mut pairs, mut drawn) = ([vec![], vec![]], vec![0.0; DISTANCES.1], vec![]);
    let between = before[0] * LOOKS.1 as f64 / SETTLING as f64;
    for look in 0..LOOKS.0 {
        // Sampled at a given time: right after an event two discs would always touch.
        running.advance_until(Until::Time(before[0] + (look + 1) as f64 * between))?;
        running.simulation.take_events();
        let places: Vec<[f64; 2]> =
            running.simulation.particles().grains().iter().map(|disc| disc.planar_position()).collect();
        let bonds = bond_orders(domain, &places);
        let sum = bonds.iter().fold([0.0; 2], |sum, bond| [sum[0] + bond[0], sum[1] + bond[1]]);
        let whole = sum[0].hypot(sum[1]);
        order[0].push(whole / count as f64);
        order[1].push(bonds.iter().map(|bond| bond[0].hypot(bond[1])).sum::<f64>() / count as f64);
        count_pairs(domain, &places, &mut pairs);
        let along = bonds.into_iter().map(|bond| (bond[0] * sum[0] + bond[1] * sum[1]) / whole);
        drawn = places.into_iter().zip(along).collect();
    }
    let after = running.observed_values(names)?;
    let [time, virial, collisions] = [0, 1, 2].map(|which| after[which] - before[which]);
    let compressibility = compressibility(count as f64, [virial, time], after[3]);
    let free_time = count as f64 * time / (2.0 * collisions);
    running.advance_events(LOGGED)?;
    let looks = LOOKS.0 as f64;
    let ring = |bin: usize| {
        let [inner, outer] = [bin, bin + 1].map(|edge| 1.0 + edge as f64 * DISTANCES.0);
        PI * (outer * outer - inner * inner)
    };
    let ideal = |bin: usize| 0.5 * (count as f64).powi(2) / domain.area() * ring(bin) * looks;
    Ok(Structure {
        packing_fraction,
        discs: count,
        order: order.map(|course| MeanWithBar::of_time_series(&course)),
        correlation: (0..DISTANCES.1).map(|bin| pairs[bin] / ideal(bin)).collect(),
        contact: (compressibility - 1.0) / (2.0 * packing_fraction),
        free_times: free_times(&running.simulation.take_events(), free_time),
        // The mean speed of discs with m = kT = 1 is √(π/2).
        free: [free_time, free_time * (0.5 * PI * after[3]).sqrt()],
        maxwell: [begin, maxwell(&running)?],
        picture: picture(domain, drawn),
    })
}

/// ψ₆ of every disc, from its six nearest neighbours.
fn bond_orders(domain: Domain, places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    // Six neighbours are within reach even in a gas.
    let reach = 3.0 * (domain.area() / places.len() as f64).sqrt();
    let near = NeighbourSearch::over_positions(domain, places.iter().copied(), reach);
    let of = |own: &[f64; 2]| {
        let mut around: Vec<[f64; 2]> = near
            .candidates_near(*own)
            .map(|(_, other)| domain.displacement(*own, other))
            .filter(|displacement| *displacement != [0.0; 2])
            .collect();
        let square =
            |displacement: &[f64; 2]| displacement[0] * displacement[0] + displacement[1] * displacement[1];
        around.sort_by(|a, b| square(a).total_cmp(&square(b)));
        around.truncate(6);
        let share = 1.0 / (around.len().max(1) as f64);
        around.iter().fold([0.0; 2], |sum, displacement| {
            let angle = 6.0 * displacement[1].atan2(displacement[0]);
            [sum[0] + share * angle.cos(), sum[1] + share * angle.sin()]
        })
    };
    places.iter().map(of).collect()
}

/// Counts every pair within reach in the bin of its distance.
fn count_pairs(domain: Domain, places: &[[f64; 2]], bins: &mut [f64]) {
    let reach = 1.0 + DISTANCES.0 * DISTANCES.1 as f64;
    let near = NeighbourSearch::over_positions(domain, places.iter().copied(), reach);
    for (own, number) in places.iter().zip(0..) {
        for (_, other) in near.candidates_near(*own).filter(|(other, _)| *other > number) {
            let bin = ((domain.distance(*own, other) - 1.0) / DISTANCES.0).max(0.0) as usize;
            if let Some(count) = bins.get_mut(bin) {
                *count += 1.0;
            }
        }
    }
}

/// Probability density of free times over their mean, from rows of the collision log.
fn free_times(rows: &str, mean: f64) -> Vec<f64> {
    let (width, count) = TIMES;
    let (mut bins, mut all) = (vec![0.0; count], 0.0);
    for time in
        rows.lines().flat_map(|row| row.rsplit(',').take(2)).filter_map(|text| text.parse::<f64>().ok())
    {
        all += 1.0;
        if let Some(bin) = bins.get_mut((time / mean / width) as usize) {
            *bin += 1.0;
        }
    }
    bins.into_iter().map(|bin| bin / (all * width)).collect()
}

/// Probability density of free times over their mean in a dilute gas. A disc of speed v collides at the rate r(v), so free times have the
/// density ∫ f r² e^(−r t) dv / ∫ f r dv, with Maxwell's f and r proportional to the mean relative speed.
fn dilute_gas_density(time: f64) -> f64 {
    let speeds = || (0..400).map(|step| (f64::from(step) + 0.5) * 0.02);
    let weight = |v: f64| v * (-0.5 * v * v).exp() * 0.02;
    let mean: f64 = speeds().map(|v| weight(v) * relative_speed(v)).sum();
    let density = |v: f64| {
        let rate = relative_speed(v) / mean;
        weight(v) * rate * rate * (-rate * time).exp()
    };
    speeds().map(density).sum()
}

/// Mean speed of discs with m = kT = 1 relative to a disc of speed v: mean of Rice's distribution, integrated over angles.
fn relative_speed(v: f64) -> f64 {
    // √(π/2) L(−v²/2) with L = e^(x/2) ((1 − x) I₀(−x/2) − x I₁(−x/2)); e^(−y) I(y) are means over a half turn.
    let y = 0.25 * v * v;
    let mean =
        |of: &dyn Fn(f64) -> f64| (0..64).map(|at| of(PI * (f64::from(at) + 0.5) / 64.0)).sum::<f64>() / 64.0;
    let zeroth = mean(&|angle| (y * (angle.cos() - 1.0)).exp());
    let first = mean(&|angle| angle.cos() * (y * (angle.cos() - 1.0)).exp());
    (0.5 * PI).sqrt() * ((1.0 + 2.0 * y) * zeroth + 2.0 * y * first)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative to a disc at rest the speed is √(π/2), relative to a fast disc it is that disc's speed; the mean over all is √2 √(π/2).
    #[test]
    fn relative_speeds_are_those_of_gas_theory() {
        let rest = (0.5 * PI).sqrt();
        assert!((relative_speed(0.0) / rest - 1.0).abs() < 1e-12);
        assert!((relative_speed(12.0) / (12.0 + 0.5 / 12.0) - 1.0).abs() < 1e-4);
        let mean: f64 = (0..400)
            .map(|step| (f64::from(step) + 0.5) * 0.02)
            .map(|v| v * (-0.5 * v * v).exp() * 0.02 * relative_speed(v))
            .sum();
        assert!((mean / (2f64.sqrt() * rest) - 1.0).abs() < 1e-4);
    }

    /// The density is normalised to 1 and has the mean 1.
    #[test]
    fn free_times_form_a_density() {
        let times = || (0..2000).map(|at| (f64::from(at) + 0.5) * 0.01);
        let whole: f64 = times().map(|time| 0.01 * dilute_gas_density(time)).sum();
        let mean: f64 = times().map(|time| 0.01 * time * dilute_gas_density(time)).sum();
        assert!((whole - 1.0).abs() < 1e-3 && (mean - 1.0).abs() < 1e-3, "{whole} {mean}");
    }

    /// A hexagonal crystal has perfect order and six neighbours in the first shell.
    #[test]
    fn a_crystal_has_perfect_order() {
        let domain = Domain::planar([0.0; 2], [10.0, 10.0 * 3f64.sqrt()], [true; 2]);
        let places: Vec<[f64; 2]> = (0..200)
            .map(|at| {
                let (row, column) = (at / 10, at % 10);
                [f64::from(column) + 0.5 * f64::from(row % 2), f64::from(row) * 0.5 * 3f64.sqrt()]
            })
            .collect();
        for bond in bond_orders(domain, &places) {
            assert!((bond[0] - 1.0).abs() < 1e-9 && bond[1].abs() < 1e-9, "{bond:?}");
        }
        let mut bins = vec![0.0; 20];
        count_pairs(domain, &places, &mut bins);
        assert_eq!(bins[0], 600.0);
    }
}
