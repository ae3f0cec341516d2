//! Oracle for all engines: brute-force search over all pairs and walls for each event.

use super::engine::{EventEngine, EventPartner, ExecutedEvent, FlyingDiscs};
use super::event::{Arena, CollisionLaw, ThermalWall};
use super::fast::{Fast, displacement_limit};
use super::floor::Floor;
use super::reference;
use super::reference::linked_cells::CellCounts;
use crate::domain::{BoxSide, Domain};
use rand::RngExt;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::flight::{FlyingDisc, collision_time};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::noise::{RandomPurpose, Stream};

/// Executes the next event, found among all pairs and walls.
fn brute_force_event(arena: &Arena, discs: &mut [FlyingDisc], now: f64) -> ExecutedEvent {
    let count = discs.len() as u32;
    let mut next = (f64::INFINITY, 0, EventPartner::Wall(0));
    for a in 0..count {
        let (time, axis) = arena.wall(&discs[a as usize]);
        let meetings = (0..count).filter(|&b| b != a).map(|b| {
            let [one, other] = [a, b].map(|disc| &discs[disc as usize]);
            (collision_time(&arena.space, one, other, now, f64::INFINITY), EventPartner::Disc(b))
        });
        let all = meetings.chain([(time, EventPartner::Wall(axis as u8))]);
        for (time, with) in all {
            if (time, a, with) < next {
                next = (time, a, with);
            }
        }
    }
    let (time, first, with) = next;
    match with {
        EventPartner::Wall(axis) => {
            ExecutedEvent::at_wall(arena, (first, &mut discs[first as usize]), axis, time)
        }
        EventPartner::Disc(other) => {
            let [a, b] = [first.min(other), first.max(other)];
            let (left, right) = discs.split_at_mut(b as usize);
            ExecutedEvent::collision(arena, (a, &mut left[a as usize]), (b, &mut right[0]), time)
        }
    }
}

/// Height below which discs start if there is no ceiling.
const HEIGHT: f64 = 20.0;

/// Discs at random positions with random velocities; radii and masses differ by up to `spread`.
fn random(domain: &Domain, count: usize, spread: f64, seed: u64) -> Vec<FlyingDisc> {
    let mut stream = Stream::new(seed, RandomPurpose::Test, 1);
    let mut discs: Vec<FlyingDisc> = vec![];
    while discs.len() < count {
        let radius = 0.5 * (1.0 + spread * stream.random_range(0.0..1.0));
        let position = [0, 1].map(|axis| {
            let length = domain.length(axis);
            let room = if length.is_finite() { length } else { HEIGHT } - 2.0 * radius;
            domain.origin[axis] + radius + stream.random_range(0.0..1.0) * room
        });
        if discs.iter().all(|it| domain.distance(it.position, position) > radius + it.radius) {
            let velocity = [0, 1].map(|_| stream.random_range(-1.0..1.0));
            let mass = 4.0 * radius * radius;
            discs.push(FlyingDisc { position, velocity, time: 0.0, radius, mass, events: 0 });
        }
    }
    discs
}

/// Fast engine at the time 0.
fn fast_engine(arena: Arena, discs: &[FlyingDisc], set: InstructionSet) -> Fast {
    let mut engine = Fast::new(arena, discs.to_vec(), set, 0.0);
    engine.begin().unwrap();
    engine
}

/// Reference engine at the time 0.
fn reference_engine(arena: Arena, discs: &[FlyingDisc], mask: &Mask) -> Box<dyn EventEngine> {
    let mut engine = reference::engine(arena, discs.to_vec(), mask, 0.0);
    engine.begin().unwrap();
    engine
}

/// Engine by cell crossing at the time 0, with about `discs_in_cell` in a linked cell.
fn cell_crossing_engine(arena: Arena, discs: &[FlyingDisc], discs_in_cell: f64) -> Box<dyn EventEngine> {
    let largest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
    let counts = CellCounts::new(&arena.domain, discs.len(), largest, discs_in_cell).unwrap();
    let mut engine = reference::cell_crossing_engine(arena, discs.to_vec(), counts, 0.0);
    engine.begin().unwrap();
    engine
}

/// Engines by cell crossing, reference engines with several masks, and fast engines with every instruction set.
fn engines(arena: Arena, discs: &[FlyingDisc]) -> Vec<(String, Box<dyn EventEngine>)> {
    let mut engines: Vec<(String, Box<dyn EventEngine>)> = vec![];
    for discs_in_cell in [0.5, 3.0].into_iter().filter(|_| arena.domain.sides[1] != BoxSide::Open) {
        let name = format!("{discs_in_cell} discs in a cell");
        engines.push((name, cell_crossing_engine(arena, discs, discs_in_cell)));
    }
    for mask in [Mask::square(2), Mask::round(3), Mask::round(4)] {
        let name = format!("{} offsets", mask.offsets().len());
        engines.push((name, reference_engine(arena, discs, &mask)));
    }
    if displacement_limit(&arena, discs.iter().map(|disc| disc.radius)).is_some() {
        for set in InstructionSet::available() {
            engines.push((set.name().to_owned(), Box::new(fast_engine(arena, discs, set))));
        }
    }
    engines
}

/// Compares all engines with the oracle: every event, and every disc at the end. Returns the number of fast engines.
fn compare_with_oracle(arena: Arena, discs: &[FlyingDisc], events: usize) -> usize {
    let (mut oracle, mut now) = (discs.to_vec(), 0.0);
    let events: Vec<ExecutedEvent> = (0..events)
        .map(|_| {
            let event = brute_force_event(&arena, &mut oracle, now);
            now = event.time;
            event
        })
        .collect();
    let mut fast = 0;
    for (name, mut engine) in engines(arena, discs) {
        for (number, event) in events.iter().enumerate() {
            let found = engine.next(f64::INFINITY, u64::MAX).unwrap().unwrap();
            assert_eq!(found, *event, "event {number}, {name}, {:?}", arena.domain);
        }
        for (number, disc) in oracle.iter().enumerate() {
            assert_eq!(engine.disc(number as u32), disc);
        }
        fast += usize::from(InstructionSet::ALL.iter().any(|set| set.name() == name));
    }
    fast
}

/// Events and times are bitwise equal for all sides, sizes, restitutions and gravities.
#[test]
fn engines_match_the_oracle() {
    let mut fast = 0;
    for (seed, periodic) in [[true, true], [true, false], [false, false]].into_iter().enumerate() {
        for (spread, restitution) in [(0.0, 1.0), (0.1, 0.9)] {
            let law = CollisionLaw { restitution, ..CollisionLaw::ELASTIC };
            for (sides, count) in [([9.0, 8.0], 30), ([14.0, 13.0], 40)] {
                let domain = Domain::planar([-2.0, 1.0], sides, periodic);
                let gravity = if periodic[1] { [0.0; 2] } else { [0.0, -0.3] };
                for gravity in [[0.0; 2], gravity] {
                    let discs = random(&domain, count, spread, seed as u64);
                    fast += compare_with_oracle(Arena::new(domain, gravity, law), &discs, 500);
                }
            }
        }
    }
    assert!(fast > 12, "{fast}");
}

/// A vibrating floor, with a ceiling and without.
#[test]
fn engines_match_above_a_vibrating_floor() {
    let open = Domain { origin: [0.0; 3], sides: [BoxSide::Periodic(14.0), BoxSide::Open, BoxSide::Flat] };
    let floor = Floor { amplitude: 0.3, frequency: 0.7 };
    let law = CollisionLaw {
        restitution: 0.95,
        wall_restitution: 0.9,
        floor: Some(floor),
        ..CollisionLaw::ELASTIC
    };
    for domain in [open, Domain::planar([0.0; 2], [14.0, 16.0], [true, false])] {
        let discs = random(&domain, 50, 0.2, 9);
        assert!(compare_with_oracle(Arena::new(domain, [0.0, -0.5], law), &discs, 3_000) > 0);
    }
}

/// A thermal floor without a ceiling.
#[test]
fn engines_match_above_a_thermal_floor() {
    let domain = Domain { origin: [0.0; 3], sides: [BoxSide::Periodic(14.0), BoxSide::Open, BoxSide::Flat] };
    let thermal = ThermalWall { side: (1, false), temperature: 2.0, seed: 4 };
    let law = CollisionLaw { restitution: 0.95, thermal: Some(thermal), ..CollisionLaw::ELASTIC };
    let discs = random(&domain, 60, 0.2, 9);
    assert!(compare_with_oracle(Arena::new(domain, [0.0, -0.5], law), &discs, 3_000) > 0);
}

/// Discs on a square lattice with velocities along it collide pairwise at equal times, again and again.
#[test]
fn simultaneous_events_are_ordered_by_number() {
    let domain = Domain::planar([0.0; 2], [24.0; 2], [true; 2]);
    let disc = |number: u32| FlyingDisc {
        position: [f64::from(number % 6) * 4.0 + 2.0, f64::from(number / 6) * 4.0 + 2.0],
        velocity: [if number.is_multiple_of(2) { 1.0 } else { -1.0 }, 0.0],
        time: 0.0,
        radius: 0.5,
        mass: 1.0,
        events: 0,
    };
    // Shuffled, so that the order of the numbers differs from that of the positions.
    let discs: Vec<FlyingDisc> = (0..36).map(|number| disc(number * 23 % 36)).collect();
    assert!(compare_with_oracle(Arena::new(domain, [0.0; 2], CollisionLaw::ELASTIC), &discs, 300) > 0);
}

/// 10⁵ collisions of 200 discs: energy and momentum are conserved to rounding, no discs overlap, and both engines agree to the end.
#[test]
fn engines_conserve_energy_and_momentum() {
    let domain = Domain::planar([0.0; 2], [19.0, 18.0], [true; 2]);
    let discs = random(&domain, 200, 0.1, 5);
    let arena = Arena::new(domain, [0.0; 2], CollisionLaw::ELASTIC);
    let energy =
        |discs: &[FlyingDisc]| -> f64 { discs.iter().map(|it| 0.5 * it.mass * it.speed().powi(2)).sum() };
    let momentum = |discs: &[FlyingDisc]| -> f64 { discs.iter().map(|it| it.mass * it.velocity[0]).sum() };
    let before = [energy(&discs), momentum(&discs)];
    let mut source = reference_engine(arena, &discs, &Mask::square(2));
    let mut fast = fast_engine(arena, &discs, InstructionSet::best());
    let mut time = 0.0;
    for number in 0..100_000 {
        let [one, other] = [
            source.next(f64::INFINITY, u64::MAX).unwrap().unwrap(),
            fast.next(f64::INFINITY, u64::MAX).unwrap().unwrap(),
        ];
        assert_eq!(one, other, "event {number}");
        time = one.time;
    }
    let after: Vec<FlyingDisc> = (0..fast.count() as u32).map(|number| *fast.disc(number)).collect();
    assert!((energy(&after) / before[0] - 1.0).abs() < 1e-12 && (momentum(&after) - before[1]).abs() < 1e-11);
    for (number, a) in after.iter().enumerate() {
        for b in &after[number + 1..] {
            let apart = domain.distance(arena.position_at(a, time), arena.position_at(b, time));
            assert!(apart > (a.radius + b.radius) * (1.0 - 1e-12), "{apart}");
        }
    }
}

/// A dense cluster in a thin gas: lists are full, and are narrowed.
#[test]
fn engines_match_in_a_cluster() {
    let domain = Domain::planar([0.0; 2], [150.0; 2], [true; 2]);
    let mut stream = Stream::new(8, RandomPurpose::Test, 2);
    let mut discs = random(&domain, 300, 0.0, 5);
    discs.retain(|disc| disc.position.iter().any(|&along| along > 20.0));
    for at in 0..144 {
        let position = [at / 12, at % 12].map(|along| 2.0 + 1.2 * f64::from(along));
        let velocity = [0, 1].map(|_| stream.random_range(-1.0..1.0));
        discs.push(FlyingDisc { position, velocity, time: 0.0, radius: 0.5, mass: 1.0, events: 0 });
    }
    let arena = Arena::new(domain, [0.0; 2], CollisionLaw::ELASTIC);
    let before = displacement_limit(&arena, discs.iter().map(|disc| disc.radius)).unwrap();
    let narrowed = fast_engine(arena, &discs, InstructionSet::best()).figures()[2].1;
    assert!(narrowed < before, "{narrowed}, {before}");
    assert!(compare_with_oracle(arena, &discs, 600) > 0);
}

/// Small discs among large ones: more than a hundred are within sight of a large disc, and cells have many slots.
#[test]
fn fast_engine_matches_for_wide_sizes() {
    let domain = Domain::planar([0.0; 2], [40.0; 2], [true; 2]);
    let mut stream = Stream::new(9, RandomPurpose::Test, 3);
    let disc = |position: [f64; 2], radius: f64, velocity: [f64; 2]| FlyingDisc {
        position,
        velocity,
        time: 0.0,
        radius,
        mass: radius * radius,
        events: 0,
    };
    let mut discs: Vec<FlyingDisc> =
        [[8.0, 8.0], [28.0, 24.0]].map(|position| disc(position, 3.0, [0.1, -0.2])).to_vec();
    for at in 0..1600 {
        let position = [at / 40, at % 40].map(|along| 0.5 + f64::from(along));
        let velocity = [0, 1].map(|_| stream.random_range(-1.0..1.0));
        let small = disc(position, 0.15, velocity);
        if discs[..2].iter().all(|large| domain.distance(large.position, position) > 3.2) {
            discs.push(small);
        }
    }
    let arena = Arena::new(domain, [0.0; 2], CollisionLaw::ELASTIC);
    for set in InstructionSet::available() {
        let (mut oracle, mut now) = (discs.clone(), 0.0);
        let mut engine = fast_engine(arena, &discs, set);
        for number in 0..60 {
            let event = brute_force_event(&arena, &mut oracle, now);
            now = event.time;
            assert_eq!(engine.next(f64::INFINITY, u64::MAX).unwrap(), Some(event), "event {number}, {set:?}");
        }
    }
}

/// All engines find the same 10⁶ events: at three densities, with polydisperse discs that lose energy, and under gravity.
#[test]
#[ignore = "long: cargo test --workspace --lib -- --ignored engines_agree"]
fn engines_agree_over_a_million_events() {
    let domain = |side: f64, periodic| Domain::planar([0.0; 2], [side, side], periodic);
    let cases = [
        (domain(26.0, [true; 2]), 0.0, 1.0, [0.0; 2]),
        (domain(40.0, [true; 2]), 0.2, 1.0, [0.0; 2]),
        (domain(100.0, [true; 2]), 0.0, 1.0, [0.0; 2]),
        (domain(40.0, [true, false]), 0.2, 0.999, [0.0, -0.05]),
    ];
    for (domain, spread, restitution, gravity) in cases {
        let thermal = ThermalWall { side: (1, false), temperature: 1.0, seed: 2 };
        let law = CollisionLaw {
            restitution,
            thermal: (gravity != [0.0; 2]).then_some(thermal),
            ..CollisionLaw::ELASTIC
        };
        let arena = Arena::new(domain, gravity, law);
        let discs = random(&domain, 400, spread, 8);
        let mut source = reference_engine(arena, &discs, &Mask::round(3));
        let mut rivals: [Box<dyn EventEngine>; 2] = [
            Box::new(fast_engine(arena, &discs, InstructionSet::best())),
            cell_crossing_engine(arena, &discs, 1.0),
        ];
        for number in 0..1_000_000 {
            let one = source.next(f64::INFINITY, u64::MAX).unwrap();
            for engine in &mut rivals {
                assert_eq!(one, engine.next(f64::INFINITY, u64::MAX).unwrap(), "event {number}, {domain:?}");
            }
        }
    }
}
