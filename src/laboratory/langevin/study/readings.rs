//! The source's loop, step by step as it is printed, in every way that its table of losses may be read.
//!
//! The table has two numbers for each step: particles lost, and "interactions". Both are counted here: interactions are pairs nearer
//! than the cut-off, seen from each of the two, added up over all steps.

use rand::RngExt;
use serde::Serialize;
use stripmine_kernels::noise::{Purpose, Stream, normals};

/// The source's table: step, particles lost, interactions.
pub const SOURCE: [(f64, [u64; 2]); 4] =
    [(1.0, [19_200, 43_676]), (0.1, [6393, 98_164]), (0.01, [754, 91_054]), (0.001, [0, 84_520])];
/// Its particles, side of the box and σ (length), steps.
pub const PARTICLES: usize = 40_000;
pub const SIDE: f64 = 100.0;
pub const DIAMETER: f64 = 0.1;
pub const STEPS: u64 = 100;
const SEED: u64 = 1;
/// A sector is at least as wide (length): one of four holds a particle.
const WIDTH: f64 = 0.25;

/// How the force of a pair enters the acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entering {
    /// Added, along the unit vector between the two.
    Added,
    /// Added, times the vector between the two: too small by their distance.
    TimesVector,
    /// The acceleration is multiplied by it, as printed.
    Multiplied,
}

/// A reading of the source; mass 1.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// What it is, in words.
    pub name: &'static str,
    /// Whether any number of it was fitted to the source's table.
    pub is_fitted: bool,
    /// ε and kT (energy), γ (mass/time).
    pub strength: f64,
    pub temperature: f64,
    pub friction: f64,
    /// The cut-off, in diameters.
    pub cutoff: f64,
    /// The spacing of the mesh, in diameters; none for places at random.
    pub spacing: Option<f64>,
    /// The side of the box (length).
    pub side: f64,
    /// Whether the speeds at the start are those of the bath; at rest otherwise.
    pub is_thermal: bool,
    pub entering: Entering,
    /// Friction by the velocity of the step before; by that after half a kick otherwise.
    pub is_friction_old: bool,
    /// Noise as √(2γkT/dt); without dt otherwise.
    pub is_noise_scaled: bool,
    /// Whether particles beyond the lower sides are lost too; otherwise they go on and meet no other.
    pub has_lower_bound: bool,
    /// Whether the offsets of sectors beyond a side are rounded to the nearest number; down otherwise.
    pub rounds_offsets: bool,
    /// Whether the lost are removed; they go on and may come back otherwise.
    pub removes: bool,
}

/// The source as it is stated, where it says; ε = kT = γ = 1.
pub const STATED: Reading = Reading {
    name: "as stated: mesh of σ, from rest, cut-off σ, ε = kT = γ = 1",
    is_fitted: false,
    strength: 1.0,
    temperature: 1.0,
    friction: 1.0,
    cutoff: 1.0,
    spacing: Some(1.0),
    side: SIDE,
    is_thermal: false,
    entering: Entering::Added,
    is_friction_old: false,
    is_noise_scaled: true,
    has_lower_bound: true,
    rounds_offsets: false,
    removes: true,
};

/// 2^(1/6), where the potential is least, in diameters.
const MINIMUM: f64 = 1.122_462_048_309_373;

/// Every reading that is tried.
pub const READINGS: &[Reading] = &[
    STATED,
    Reading { name: "thermal start", is_thermal: true, ..STATED },
    Reading { name: "random places", spacing: None, ..STATED },
    Reading { name: "mesh and cut-off 2^(1/6) σ", cutoff: MINIMUM, spacing: Some(MINIMUM), ..STATED },
    Reading { name: "mesh and cut-off 2.5 σ", cutoff: 2.5, spacing: Some(2.5), ..STATED },
    Reading { name: "force times vector, not over r", entering: Entering::TimesVector, ..STATED },
    Reading { name: "acceleration × F/m, as printed", entering: Entering::Multiplied, ..STATED },
    Reading { name: "friction by the old velocity", is_friction_old: true, ..STATED },
    Reading { name: "noise without dt", is_noise_scaled: false, ..STATED },
    Reading { name: "no lower bound", has_lower_bound: false, ..STATED },
    Reading { name: "offsets rounded", rounds_offsets: true, ..STATED },
    Reading { name: "lost ones not removed", removes: false, ..STATED },
    Reading { name: "ε = 0.07, fitted to the interactions", is_fitted: true, strength: 0.07, ..STATED },
    Reading {
        name: "fitted to both: side 200, ε = 0.0047, kT = 1.56, γ = 0.055, thermal, force times vector, no lower bound",
        is_fitted: true,
        strength: 0.0047,
        temperature: 1.56,
        friction: 0.055,
        side: 2.0 * SIDE,
        is_thermal: true,
        entering: Entering::TimesVector,
        has_lower_bound: false,
        ..STATED
    },
];

/// What a reading gives at a step: particles lost, and interactions.
pub type Counts = [u64; 2];

/// What came of a reading, at the steps of [`SOURCE`].
#[derive(Clone, Debug, Serialize)]
pub struct Read {
    /// What it is, in words.
    pub name: &'static str,
    /// Whether any number of it was fitted to the source's table.
    pub is_fitted: bool,
    /// Lost and interactions at each step.
    pub counts: [Counts; 4],
}

#[derive(Clone, Copy, Default)]
struct Particle {
    id: u32,
    place: [f64; 2],
    velocity: [f64; 2],
    /// After half a kick.
    half: [f64; 2],
    acceleration: [f64; 2],
}

/// The loop of the source over its steps, of a number of particles at its density.
pub fn counted(reading: &Reading, particles: usize, dt: f64) -> Counts {
    let side = reading.side * (particles as f64 / PARTICLES as f64).sqrt();
    let mut all = start(reading, particles, side);
    let (mut lost, mut met) = (0, 0);
    for step in 0..STEPS {
        for particle in &mut all {
            for axis in 0..2 {
                particle.half[axis] = particle.velocity[axis] + 0.5 * particle.acceleration[axis] * dt;
                let there = particle.place[axis] + particle.half[axis] * dt;
                // Once, as the source does.
                particle.place[axis] = match there {
                    there if there >= 0.5 * side => there - side,
                    there if there < -0.5 * side => there + side,
                    there => there,
                };
            }
        }
        let sectors = Sectors::order(&mut all, reading, side);
        let outside = all.len() - sectors.starts[sectors.count * sectors.count + 1];
        if reading.removes {
            all.truncate(all.len() - outside);
            lost += outside;
        } else {
            lost = outside;
        }
        bathe(&mut all, reading, step, dt);
        met += sectors.meet(&mut all, reading, side);
        for particle in &mut all {
            for axis in 0..2 {
                particle.velocity[axis] = particle.half[axis] + 0.5 * particle.acceleration[axis] * dt;
            }
        }
    }
    [lost as u64, met]
}

/// The particles at the start, about the middle of the box.
fn start(reading: &Reading, particles: usize, side: f64) -> Vec<Particle> {
    let mut random = Stream::new(SEED, Purpose::Placement, 0);
    let mut places: Vec<[f64; 2]> = vec![];
    match reading.spacing {
        Some(spacing) => {
            let columns = (side / (spacing * DIAMETER) + 1e-9) as usize;
            let mut sites: Vec<usize> = (0..columns * columns).collect();
            let edge = side / columns as f64;
            for first in 0..particles {
                sites.swap(first, random.random_range(first..columns * columns));
                let site = sites[first];
                let along = [site % columns, site / columns];
                places.push(along.map(|at| (at as f64 + 0.5) * edge - 0.5 * side));
            }
        }
        None => places.extend((0..particles).map(|_| [0, 1].map(|_| side * (random.random::<f64>() - 0.5)))),
    }
    let speed = if reading.is_thermal { reading.temperature.sqrt() } else { 0.0 };
    let particle = |(place, id): ([f64; 2], u32)| {
        let velocity = normals(SEED, Purpose::Placement, id, 1).map(|along| speed * along);
        Particle { id, place, velocity, ..Particle::default() }
    };
    places.into_iter().zip(1..).map(particle).collect()
}

/// Friction and noise: the acceleration begins with them.
fn bathe(all: &mut [Particle], reading: &Reading, step: u64, dt: f64) {
    let Reading { friction, temperature, .. } = *reading;
    let over = if reading.is_noise_scaled { dt } else { 1.0 };
    let strength = (2.0 * friction * temperature / over).sqrt();
    for particle in all {
        let noise = normals(SEED, Purpose::Thermostat, particle.id, step);
        let velocity = if reading.is_friction_old { particle.velocity } else { particle.half };
        particle.acceleration = [0, 1].map(|axis| strength * noise[axis] - friction * velocity[axis]);
    }
}

/// Where in the particles those of each sector begin; then those that are in none and go on, those that are lost, and the end.
struct Sectors {
    count: usize,
    starts: Vec<usize>,
}

impl Sectors {
    /// Puts the particles in the order of their sectors.
    fn order(all: &mut Vec<Particle>, reading: &Reading, side: f64) -> Sectors {
        let count = (side / WIDTH.max(reading.cutoff * DIAMETER)) as usize;
        let is_below = |place: [f64; 2]| place.iter().any(|along| *along < -0.5 * side);
        let sector = |particle: &Particle| {
            let is_in_domain = particle.place.iter().all(|along| *along < 0.5 * side);
            if !is_in_domain || is_below(particle.place) && reading.has_lower_bound {
                return count * count + 1;
            }
            if is_below(particle.place) {
                return count * count;
            }
            let [column, row] = column_and_row(particle.place, side, count);
            row * count + column
        };
        let sectors: Vec<usize> = all.iter().map(sector).collect();
        let mut starts = vec![0; count * count + 3];
        sectors.iter().for_each(|sector| starts[sector + 1] += 1);
        for sector in 1..starts.len() {
            starts[sector] += starts[sector - 1];
        }
        let mut ends = starts.clone();
        let mut ordered = vec![Particle::default(); all.len()];
        for (particle, sector) in all.iter().zip(sectors) {
            ordered[ends[sector]] = *particle;
            ends[sector] += 1;
        }
        *all = ordered;
        Sectors { count, starts }
    }

    /// The forces of all pairs nearer than the cut-off, and how many they are from each of the two.
    fn meet(&self, all: &mut [Particle], reading: &Reading, side: f64) -> u64 {
        let Sectors { count, ref starts } = *self;
        let reach = reading.cutoff * DIAMETER;
        let offsets: Vec<f64> =
            (0..count + 2).map(|along| offset(along, count, reading.rounds_offsets) * side).collect();
        let mut met = 0;
        for own in 0..starts[count * count] {
            let Particle { place, mut acceleration, .. } = all[own];
            let [column, row] = column_and_row(place, side, count);
            // The sectors around are numbered from 0 to count + 1. Plain loops are fast without the optimizer.
            for row in row..row + 3 {
                for column in column..column + 3 {
                    let sector = (row + count - 1) % count * count + (column + count - 1) % count;
                    let members = starts[sector]..starts[sector + 1];
                    for (other, Particle { place: there, .. }) in members.clone().zip(&all[members]) {
                        let x = place[0] - (there[0] + offsets[column]);
                        let y = place[1] - (there[1] + offsets[row]);
                        let square = x * x + y * y;
                        if other != own && square < reach * reach {
                            met += 1;
                            enter(&mut acceleration, reading, [x, y], square);
                        }
                    }
                }
            }
            all[own].acceleration = acceleration;
        }
        met
    }
}

fn column_and_row(place: [f64; 2], side: f64, count: usize) -> [usize; 2] {
    place.map(|along| (((along + 0.5 * side) / side * count as f64) as usize).min(count - 1))
}

/// By how many sides the sectors are off that are `along` − 1 from the first, as the source has it.
fn offset(along: usize, count: usize, rounds: bool) -> f64 {
    let sides = (along + count - 1) as f64 / count as f64;
    (if rounds { sides.round() } else { sides.floor() }) - 1.0
}

/// The force of a partner enters the acceleration of a particle that lies `way` from it.
fn enter(acceleration: &mut [f64; 2], reading: &Reading, way: [f64; 2], square: f64) {
    let ratio = DIAMETER * DIAMETER / square;
    let sixth = ratio * ratio * ratio;
    let distance = square.sqrt();
    let force = 24.0 * reading.strength * sixth * (2.0 * sixth - 1.0) / distance;
    for axis in 0..2 {
        match reading.entering {
            Entering::Added => acceleration[axis] += force * way[axis] / distance,
            Entering::TimesVector => acceleration[axis] += force * way[axis],
            Entering::Multiplied => acceleration[axis] *= force,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2500 particles of the source's density by a reading at a step.
    fn small(reading: &Reading, dt: f64) -> Counts {
        counted(reading, 2500, dt)
    }

    /// Without force random places meet as an ideal gas does, 2500 · 4 · π · 0.1² a step, and none is lost.
    #[test]
    fn particles_without_force_meet_as_an_ideal_gas() {
        let ideal = Reading { strength: 0.0, spacing: None, ..STATED };
        let [lost, met] = small(&ideal, 1.0);
        let expected = 100.0 * 2500.0 * 4.0 * std::f64::consts::PI * 0.01;
        assert!(lost == 0 && (met as f64 / expected - 1.0).abs() < 0.03, "{lost} {met} {expected}");
    }

    /// Long steps throw particles out, short ones none; without a lower bound fewer count as lost, and with rounded offsets only a quarter
    /// of the box meets.
    #[test]
    fn readings_do_what_they_say() {
        let [stated, short] = [1.0, 0.001].map(|dt| small(&STATED, dt));
        assert!(stated[0] > 2000 && short[0] == 0, "{stated:?} {short:?}");
        let open = small(&Reading { has_lower_bound: false, ..STATED }, 1.0);
        assert!(open[0] < stated[0] - 100, "{open:?} {stated:?}");
        let [ideal, quarter] = [false, true].map(|rounds_offsets| {
            small(&Reading { strength: 0.0, spacing: None, rounds_offsets, ..STATED }, 1.0)[1]
        });
        assert!((quarter as f64 / ideal as f64 - 0.25).abs() < 0.02, "{quarter} of {ideal}");
    }

    /// The force that enters is that of the potential, along the vector between the two.
    #[test]
    fn forces_enter_along_the_vector_between_two() {
        let entered = |entering: Entering| {
            let mut acceleration = [1.0, 2.0];
            enter(&mut acceleration, &Reading { entering, ..STATED }, [0.06, 0.08], 0.01);
            acceleration
        };
        let near = |found: [f64; 2], expected: [f64; 2]| {
            assert!((0..2).all(|axis| (found[axis] - expected[axis]).abs() < 1e-9), "{found:?}");
        };
        // At a distance of σ the force is 24 ε/σ.
        near(entered(Entering::Added), [1.0 + 0.6 * 240.0, 2.0 + 0.8 * 240.0]);
        near(entered(Entering::TimesVector), [1.0 + 0.06 * 240.0, 2.0 + 0.08 * 240.0]);
        near(entered(Entering::Multiplied), [240.0, 480.0]);
    }
}
