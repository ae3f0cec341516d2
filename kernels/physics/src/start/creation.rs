//! Creation of a scene's initial discs.

use super::box_size::box_for_count;
use super::compressing::compressed;
use super::exact_speed::scale_velocities;
use super::filling::{JAMMING, MOST, check_placement_memory, disc, fill, grain_count};
use super::imported::read_start;
use super::meshing::on_mesh;
use super::{StatedStart, rounded_to_nine_digits};
use crate::domain::Domain;
use crate::number::significant;
use crate::particles::{Particle, ParticleKind, Particles, in_space};
use crate::placement::{WallRow, hexagonal, wall_row};
use crate::scene::{
    Amount, CLEAR_WIDTH, COUNT, DiscStart, FILE, FILL_HEIGHT, GeneratedDiscs, Key, List, MistakeKind, ORIGIN,
    SIDES, SceneError, Speed, WALL_SPACING, WallLining, WallMotion, Warning,
};
use crate::structure::MOST_SPECIES;

/// Smallest and largest radius: those that the scene admits, or those found in a list or file.
pub(crate) fn radii(start: &DiscStart, found: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let spread = |grains: &GeneratedDiscs| {
        let cut = if grains.spread > 0.0 { grains.cut } else { 0.0 };
        let has_second = grains.second.share > 0.0;
        let low = if has_second { grains.radius.min(grains.second.radius) } else { grains.radius };
        [low * (1.0 - cut), grains.second.largest(grains.radius) * (1.0 + cut)]
    };
    let with = |[low, high]: [f64; 2], radius: f64| [low.min(radius), high.max(radius)];
    match start {
        DiscStart::Random { grains, .. } | DiscStart::Compressed { grains, .. } => Some(spread(grains)),
        DiscStart::Pipe { grains, lining, .. } | DiscStart::Box { grains, lining, .. } => {
            Some(with(spread(grains), lining.radius))
        }
        DiscStart::Hexagonal { grains, .. } | DiscStart::Mesh { grains, .. } => Some([grains.radius; 2]),
        DiscStart::List(_) | DiscStart::File(_) => found,
    }
}

/// Initial state of a scene.
pub struct InitialState {
    /// Box.
    pub domain: Domain,
    /// Discs, wrapped into the box; walls have the initial velocity of their motion.
    pub particles: Particles,
    /// Warnings about the start.
    pub warnings: Vec<Warning>,
}

/// Creates the box and the initial discs.
///
/// # Errors
/// [`SceneError`] if the start cannot be created.
pub fn create_initial_state(stated: &StatedStart<'_>) -> Result<InitialState, SceneError> {
    let domain = stated
        .domain
        .stated()
        .or_else(|| box_for_count(stated))
        .unwrap_or(Domain::planar([0.0; 2], [1.0; 2], [true; 2]));
    check_resolution(stated, &domain, radii(stated.start, None))?;
    let mut warnings = Vec::new();
    let (domain, mut particles) = match stated.start {
        DiscStart::File(file) => {
            let (domain, discs) = read_start(stated, file, &mut warnings)?;
            (domain, Particles::new(discs))
        }
        DiscStart::List(list) => (domain, listed_discs(list)),
        DiscStart::Hexagonal { count, packing_fraction, grains } => {
            check_placement_memory(stated, *count as f64, &COUNT)?;
            on_lattice(stated, *count, *packing_fraction, grains)
        }
        DiscStart::Random { amount, grains } => {
            let count = grain_count(stated, *amount, domain.area(), grains, JAMMING)?;
            let far = [0, 1].map(|axis| domain.origin[axis] + domain.length(axis));
            let discs = fill(stated, &domain, [domain.corner(), far], &[], count, grains)?;
            (domain, Particles::new(discs))
        }
        DiscStart::Mesh { amount, grains, spacing } => {
            (domain, on_mesh(stated, &domain, *amount, grains, *spacing)?)
        }
        DiscStart::Compressed { amount, grains } => (domain, compressed(stated, &domain, *amount, grains)?),
        DiscStart::Pipe { amount, grains, lining, clear_width } => {
            (domain, pipe(stated, &domain, *amount, grains, lining, *clear_width)?)
        }
        DiscStart::Box { amount, grains, lining, fill_height } => {
            (domain, place_above_floor(stated, &domain, *amount, grains, lining, *fill_height)?)
        }
    };
    number_by_radius(&mut particles);
    if let Some(grains) = stated.start.drawn().filter(|grains| grains.is_exact) {
        let count = particles.grain_count();
        scale_velocities(&mut particles.all_mut()[..count], grains.speed, stated.conserved);
    }
    let start_velocity = match stated.walls {
        WallMotion::Fixed => [0.0; 2],
        WallMotion::Oscillating { amplitude, frequency } => {
            amplitude.map(|a| a * (std::f64::consts::TAU * frequency))
        }
    };
    check_resolution(stated, &domain, radii(stated.start, particles.radii()))?;
    let moving = |disc: &&Particle| {
        disc.kind == ParticleKind::Wall
            && (disc.velocity != [0.0; 3] || disc.omega != 0.0)
            && disc.planar_velocity() != start_velocity
    };
    if let Some(first) = particles.all().iter().find(moving) {
        let count = particles.all().iter().filter(moving).count();
        warnings.push(Warning {
            check: "walls-in-motion",
            share: f64::INFINITY,
            is_refusal: false,
            key: FILE.path(),
            message: format!(
                "{count} wall discs have a velocity or spin in the start file, first wall disc {} with ({}, {}) and \
                 {}; particles.wall_motion alone moves walls, so these are ignored",
                first.id, significant(first.velocity[0], 5), significant(first.velocity[1], 5), significant(first.omega, 5)),
            suggestion: "set particles.wall_motion, or turn them into grains (species Si)".to_owned(),
        });
    }
    for disc in particles.all_mut() {
        disc.position = domain.wrapped(disc.position);
        if disc.kind == ParticleKind::Wall {
            (disc.velocity, disc.omega) = (in_space(start_velocity), 0.0);
        }
    }
    Ok(InitialState { domain, particles, warnings })
}

/// Numbers the species of grains by their radii, if these are few and nothing else tells species apart.
fn number_by_radius(particles: &mut Particles) {
    let mut radii: Vec<f64> = vec![];
    for grain in particles.grains() {
        if grain.species != 0 || radii.len() > MOST_SPECIES {
            return;
        }
        if !radii.contains(&grain.radius) {
            radii.push(grain.radius);
        }
    }
    radii.sort_by(f64::total_cmp);
    let count = if radii.len() > MOST_SPECIES { 0 } else { particles.grain_count() };
    for grain in &mut particles.all_mut()[..count] {
        grain.species = radii.partition_point(|radius| *radius < grain.radius) as u8;
    }
}

/// Checks that floating-point numbers resolve positions in the box far better than the smallest radius, if known.
fn check_resolution(
    stated: &StatedStart<'_>,
    domain: &Domain,
    radii: Option<[f64; 2]>,
) -> Result<(), SceneError> {
    /// Largest error of a position, relative to the smallest radius.
    const COARSEST: f64 = 1e-6;
    let Some([smallest, _]) = radii else { return Ok(()) };
    for axis in 0..2 {
        let farthest = domain.origin[axis].abs() + domain.length(axis);
        let step = farthest * f64::EPSILON;
        if step > COARSEST * smallest {
            let far_away = domain.origin[axis].abs() > domain.length(axis);
            let key: &Key = if far_away { &ORIGIN } else { &SIDES };
            let message = format!(
                "positions up to {farthest} have a resolution of {step}, too coarse for discs of radius {smallest}",
                farthest = significant(farthest, 6),
                step = significant(step, 2),
                smallest = significant(smallest, 6)
            );
            let error = stated.spot(key).error(MistakeKind::Geometry, message);
            return Err(error.advising("move the box nearer to the origin, or choose other units"));
        }
    }
    Ok(())
}

fn listed_discs(list: &List) -> Particles {
    let of = [list.radius, list.mass];
    let columns = list.velocities.iter().zip(&list.omegas).zip(&list.radii);
    let grains = list.positions.iter().zip(columns).zip(1..);
    let grains = grains.map(|((position, ((velocity, omega), radius)), id)| Particle {
        velocity: in_space(*velocity),
        omega: *omega,
        ..disc(id, ParticleKind::Grain, *position, *radius, of)
    });
    let mut masses = list.masses.iter();
    let grains = grains.map(|grain| Particle { mass: masses.next().copied().unwrap_or(grain.mass), ..grain });
    let walls = list.wall_positions.iter().zip(list.positions.len() as u32 + 1..);
    let walls = walls.map(|(position, id)| disc(id, ParticleKind::Wall, *position, list.wall_radius, of));
    Particles::new(grains.chain(walls).collect())
}

fn on_lattice(
    stated: &StatedStart<'_>,
    count: usize,
    packing_fraction: f64,
    grains: &GeneratedDiscs,
) -> (Domain, Particles) {
    // Velocities are those of discs of mass 1.
    let kt = match grains.speed {
        Speed::Deviation(speed) => speed * speed,
        Speed::Temperature(kt) => kt / grains.mass,
    };
    let mut packing = hexagonal(count, packing_fraction, kt, grains.seed);
    let diameter = 2.0 * grains.radius;
    let origin = stated.domain.origin;
    for disc in packing.particles.all_mut() {
        disc.position = in_space([0, 1].map(|axis| origin[axis] + diameter * disc.position[axis]));
        disc.radius = grains.radius;
        disc.mass = grains.mass;
    }
    let sides = packing.sides.map(|side| diameter * side);
    (Domain::planar(origin, sides, stated.domain.periodic), packing.particles)
}

/// Wall discs with ids after those of `count` grains.
fn place_wall_rows(
    stated: &StatedStart<'_>,
    domain: &Domain,
    rows: &[(f64, f64)],
    count: usize,
    (lining, grains): (&WallLining, &GeneratedDiscs),
) -> Result<Vec<Particle>, SceneError> {
    let each = domain.length(0) / lining.spacing;
    if each * rows.len() as f64 > MOST {
        let message = format!(
            "a row has {each} wall discs; at most {MOST} can be numbered",
            each = significant(each, 5),
            MOST = significant(MOST, 4)
        );
        return Err(stated.spot(&WALL_SPACING).error(MistakeKind::Placement, message));
    }
    check_placement_memory(stated, each * rows.len() as f64 + count as f64, &WALL_SPACING)?;
    let share = lining.radius / grains.radius;
    let mass = grains.mass * share * share;
    let mut walls: Vec<Particle> = Vec::new();
    for &(y, shift) in rows {
        let first_id = (count + walls.len()) as u32 + 1;
        walls.extend(wall_row(
            domain,
            &WallRow { y, shift, radius: lining.radius, spacing: lining.spacing, mass },
            first_id,
        ));
    }
    Ok(walls)
}

fn pipe(
    stated: &StatedStart<'_>,
    domain: &Domain,
    amount: Amount,
    grains: &GeneratedDiscs,
    lining: &WallLining,
    clear_width: f64,
) -> Result<Particles, SceneError> {
    let axis = domain.origin[1] + 0.5 * domain.length(1);
    let reach = 0.5 * clear_width + lining.radius;
    if 2.0 * reach >= domain.length(1) {
        let message = format!(
            "the centres of the two walls are {} apart, but the box is {} high",
            rounded_to_nine_digits(2.0 * reach),
            domain.length(1)
        );
        let error = stated.spot(&CLEAR_WIDTH).error(MistakeKind::Outside, message);
        return Err(error.advising("raise the second of domain.sides, or lower clear_width"));
    }
    let count = grain_count(stated, amount, domain.length(0) * clear_width, grains, JAMMING)?;
    let rows = [(axis - reach, 0.0), (axis + reach, 0.5)];
    let walls = place_wall_rows(stated, domain, &rows, count, (lining, grains))?;
    let end = domain.origin[0] + domain.length(0);
    let room = [[domain.origin[0], axis - 0.5 * clear_width], [end, axis + 0.5 * clear_width]];
    let mut discs = fill(stated, domain, room, &walls, count, grains)?;
    discs.extend(walls);
    Ok(Particles::new(discs))
}

fn place_above_floor(
    stated: &StatedStart<'_>,
    domain: &Domain,
    amount: Amount,
    grains: &GeneratedDiscs,
    lining: &WallLining,
    fill_height: f64,
) -> Result<Particles, SceneError> {
    // The floor is as low as possible with its motion inside the box.
    let swing = match stated.walls {
        WallMotion::Fixed => 0.0,
        WallMotion::Oscillating { amplitude, .. } => amplitude[1].abs(),
    };
    let centres = domain.origin[1] + lining.radius + swing;
    let floor = centres + lining.radius;
    let top = domain.origin[1] + domain.length(1);
    if floor + fill_height > top {
        let message = format!(
            "grains would be placed up to {}, but the box ends at {top}",
            rounded_to_nine_digits(floor + fill_height)
        );
        let error = stated.spot(&FILL_HEIGHT).error(MistakeKind::Outside, message);
        return Err(error.advising("raise the second of domain.sides, or lower fill_height"));
    }
    let count = grain_count(stated, amount, domain.length(0) * fill_height, grains, JAMMING)?;
    let walls = place_wall_rows(stated, domain, &[(centres, 0.0)], count, (lining, grains))?;
    let room = [[domain.origin[0], floor], [domain.origin[0] + domain.length(0), floor + fill_height]];
    let mut discs = fill(stated, domain, room, &walls, count, grains)?;
    discs.extend(walls);
    Ok(Particles::new(discs))
}
