//! Discs across periodic sides: their paths in steps so small that the nearest image of the next position is the right one.

use std::sync::atomic::AtomicBool;
use stripmine_physics::method::{METHODS, Simulation, StartPurpose, Until, load};
use stripmine_physics::particles::GrainStates;

/// Steps of a run, and the step at which it is saved to a checkpoint and resumed.
const STEPS: u64 = 400;
const RESUMED_AT: u64 = 170;

#[test]
fn discs_are_followed_across_periodic_sides() {
    let hard = [
        "domain.sides=[6.0, 6.0]",
        "particles.generate=\"random\"",
        "particles.count=20",
        "particles.radius=0.2",
    ];
    let with = |more: &[&'static str]| [&hard[..], more].concat();
    let soft = ["particles.count=60", "particles.packing_fraction=0.2", "particles.temperature=0.03"];
    let cases: [(&str, Vec<&str>, f64); 9] = [
        ("hard-disks", with(&[]), 0.2),
        ("hard-disks", with(&["machine.engine=\"reference\""]), 0.2),
        ("hard-disks", with(&["domain.sides=[4.0, 60.0]"]), 0.2),
        ("hard-disks", with(&["domain.periodic=[true, false]", "domain.gravity=[0.0, -0.2]"]), 0.2),
        ("hard-disks", with(&["particles.count=1", "run.time=80.0"]), 0.2),
        ("dense-gas", soft.to_vec(), 0.0),
        ("dense-gas", [&soft[..], &["machine.engine=\"programs\""]].concat(), 0.0),
        ("dense-gas", [&soft[..], &["machine.precision=\"f32\""]].concat(), 0.0),
        ("langevin-free", vec!["particles.count=40", "law.drag=0.1"], 0.0),
    ];
    for (scene, sets, dt) in cases {
        let named = format!("{scene} {sets:?}");
        let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
        let asked = [&sets[..], &["output.structure=[\"msd\"]".to_owned()]].concat();
        let (prepared, _) = load(scene, &asked, METHODS).unwrap_or_else(|error| panic!("{named}: {error}"));
        let (domain, grains) = (prepared.domain, prepared.particles().grain_count());
        let mut simulation = prepared.start(StartPurpose::Run).unwrap();
        let mut states = GrainStates::of(prepared.particles().grains());
        let mut look = |simulation: &dyn Simulation| {
            simulation.per_particle().states(&mut states);
            states.rows().iter().map(|row| [row[0], row[1]]).collect::<Vec<_>>()
        };
        let start = look(simulation.as_ref());
        let (mut before, mut displacements) = (start.clone(), vec![[0.0; 2]; grains]);
        for step in 1..=STEPS {
            let until = if dt > 0.0 { Until::Time(dt * step as f64) } else { Until::Steps(10 * step) };
            simulation.advance(&[until], &AtomicBool::new(false)).unwrap();
            let now = look(simulation.as_ref());
            for ((displacement, from), to) in displacements.iter_mut().zip(&before).zip(&now) {
                let moved = domain.displacement(*from, *to);
                assert!(
                    (0..2)
                        .all(|axis| !domain.is_periodic(axis)
                            || moved[axis].abs() < 0.45 * domain.length(axis))
                );
                (0..2).for_each(|axis| displacement[axis] += moved[axis]);
            }
            before = now;
            if step == RESUMED_AT {
                let (clock, kept) = (simulation.clock(), simulation.snapshot());
                simulation = prepared.start(StartPurpose::Run).unwrap();
                simulation.restore(clock, kept).unwrap();
            }
        }
        let images = simulation.per_particle().images();
        assert_eq!(images.len(), prepared.particles().len(), "{named}");
        let mut crossed = 0;
        for (grain, displacement) in displacements.iter().enumerate() {
            for axis in 0..2 {
                let side = if domain.is_periodic(axis) { domain.length(axis) } else { 0.0 };
                let there = before[grain][axis] + f64::from(images[grain][axis]) * side;
                assert!(
                    (there - start[grain][axis] - displacement[axis]).abs() < 1e-6,
                    "{named}: grain {grain}, axis {axis}"
                );
                crossed += images[grain][axis].unsigned_abs();
            }
        }
        assert!(crossed > 0, "{named}: nothing crossed a side");
        // A run without displacements starts to count from here.
        let (without, _) = load(scene, &sets, METHODS).unwrap();
        let mut plain = without.start(StartPurpose::Run).unwrap();
        plain
            .advance(&[if dt > 0.0 { Until::Time(1.0) } else { Until::Steps(10) }], &AtomicBool::new(false))
            .unwrap();
        let mut later = prepared.start(StartPurpose::Run).unwrap();
        later.restore(plain.clock(), plain.snapshot()).unwrap_or_else(|why| panic!("{named}: {why}"));
    }
}
