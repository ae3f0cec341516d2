//! Runs that were changed, interrupted and resumed; simulations that were saved.

use super::{BATH, GRAVITY, NEVER, VELOCITIES, WALL_VELOCITIES, advance, change, prepared, started};
use crate::io::FORMATS;
use crate::method::{Change, METHODS, MethodEntry, ObservedQuantity, Prepared, Simulation, Until};
use crate::origin::Origin;
use crate::run::{ExistingRun, RunInProgress, RunJob, run};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Quantities of the method of a scene.
fn quantities(prepared: &Prepared) -> &'static [ObservedQuantity] {
    let is_method = |it: &&&MethodEntry| prepared.scene.contains(&format!("{:?}", it.vocabulary.keys.method));
    prepared.quantities(METHODS.iter().find(is_method).unwrap())
}

const PROGRAM: fn() -> Origin = || Origin {
    version: "0".to_owned(),
    commit: "unknown".to_owned(),
    dirty: false,
    target: "here".to_owned(),
};

/// Files of a run that hold results.
fn results(folder: &Path) -> BTreeMap<&'static str, Vec<u8>> {
    let names = ["thermo.csv", FORMATS[0].file, "changes.csv"];
    names.into_iter().map(|name| (name, fs::read(folder.join(name)).unwrap())).collect()
}

/// Runs a scene with changes at two moments; with a `checkpoint` the process ends after the second change. The checkpoint is of the start, or follows
/// that many changes.
fn changed_run(
    folder: &Path,
    (preset, overrides): (&str, &[&str]),
    changes: &[(Until, Change)],
    checkpoint: Option<usize>,
) {
    let (prepared, program) = (prepared(preset, overrides), PROGRAM());
    let quantities = quantities(&prepared);
    let job = || RunJob { prepared: (&prepared).into(), quantities, program: &program, is_open_ended: true };
    let opened = RunInProgress::open(&mut job(), folder, ExistingRun::Refuse, |_| {});
    let (mut record, mut simulation) = opened.unwrap();
    let simulation = simulation.as_mut();
    let to = |record: &mut RunInProgress, simulation: &mut dyn Simulation, end: Until| {
        while !end.has_been_reached(&simulation.clock()) {
            record.advance(&job(), simulation, &[end], &NEVER).unwrap();
        }
    };
    if checkpoint == Some(0) {
        record.checkpoint(simulation).unwrap();
    }
    for (number, (moment, change)) in (1..).zip(changes) {
        to(&mut record, simulation, *moment);
        record.change(&job(), simulation, change).unwrap().unwrap();
        if checkpoint == Some(number) {
            record.checkpoint(simulation).unwrap();
        }
    }
    if checkpoint.is_none() {
        to(&mut record, simulation, prepared.schedule.until);
        record.finish(&job(), simulation).unwrap();
        return;
    }
    drop(record);
    let resumed = RunJob { is_open_ended: false, ..job() };
    run(resumed, folder, ExistingRun::Resume { other_version: false }, &NEVER, |_, _| {}, |_| {}).unwrap();
}

/// A run that was interrupted after changes has the bits of one that was not, from a checkpoint before, between and after the changes.
#[test]
fn resumed_runs_repeat_changes_to_the_bit() {
    let discs =
        ["run.time=0.4", "run.thermo_every=20", "run.snapshot_every=50", "run.checkpoint_every=1000000"];
    let steps =
        ["run.steps=40", "run.thermo_every=4", "run.snapshot_every=10", "run.checkpoint_every=1000000"];
    let fluid = [
        "particles.generate=random",
        "particles.count=30",
        "domain.sides=[9.0, 9.0]",
        "domain.periodic=[false, false]",
        "domain.gravity=[0.0, 0.0]",
    ];
    let hard = ["run.time=6.0", "run.thermo_every=0.5", "run.snapshot_every=1.0", "run.checkpoint_every=1e6"];
    let bath = ["particles.count=100", "domain.sides=[12.0, 12.0]"];
    let grains = |velocities: [f64; 4], gravity: [f64; 2]| {
        [change(VELOCITIES, &velocities), change(GRAVITY, &gravity)]
    };
    let of_steps = |[one, other]: [Change; 2]| vec![(Until::Steps(10), one), (Until::Steps(23), other)];
    let of_discs = || of_steps(grains([0.5, -0.25, -3.0, 0.125], [0.1, -2.0]));
    let of_bath = || {
        let speeds: Vec<f64> = (0..200).map(|at| 0.1 * f64::from(at % 7) - 0.3).collect();
        of_steps([change(BATH, &[2.5]), change(VELOCITIES, &speeds)])
    };
    let bodies = || {
        of_steps([
            change(VELOCITIES, &[0.1, 20.0, 0.0, -0.1, -20.0, 0.0]),
            change(VELOCITIES, &[-0.3, 8.0, 0.1, 0.3, -8.0, -0.1]),
        ])
    };
    let of_hard = || {
        let speeds: Vec<f64> = (0..60).map(|at| 0.3 * f64::from(at % 5) - 0.6).collect();
        vec![
            (Until::Time(1.25), change(GRAVITY, &[0.0, -0.5])),
            (Until::Events(150), change(VELOCITIES, &speeds)),
        ]
    };
    let of_walls = || {
        let velocities = |values: &[f64]| change(WALL_VELOCITIES, values);
        of_steps([velocities(&[-2.0, 0.1, 0.5, 0.0]), velocities(&[0.3, 0.0, 0.3, 0.0])])
    };
    let of_lid = || of_steps([change(GRAVITY, &[0.5, -1.0]), change(GRAVITY, &[0.0, -2.0])]);
    let near = "particles.positions=[[3.0, 4.0], [4.02, 4.25]]";
    type Scene<'s> = (&'s str, Vec<&'s str>, Vec<(Until, Change)>);
    let scenes: Vec<Scene<'_>> = vec![
        ("two-discs", [&discs[..], &[near]].concat(), of_discs()),
        ("two-discs", [&discs[..], &[near, "machine.engine=programs"]].concat(), of_discs()),
        (
            "two-discs",
            [&discs[..], &[near, "integrator.kind=velocity-verlet", "search.by=neighbor-list"]].concat(),
            of_discs(),
        ),
        (
            "two-discs",
            [&discs[..], &[near, "domain.periodic=[true, true]", "machine.precision=f32"]].concat(),
            of_discs(),
        ),
        ("shear-cell", discs.to_vec(), of_walls()),
        ("shear-cell", [&discs[..], &["machine.engine=programs"]].concat(), of_walls()),
        ("piston", discs.to_vec(), of_lid()),
        ("langevin-dense", [&steps[..], &bath].concat(), of_bath()),
        (
            "langevin-dense",
            [&steps[..], &bath, &["integrator.kind=as-printed", "search.by=neighbor-list"]].concat(),
            of_bath(),
        ),
        ("kepler", [&steps[..], &["integrator.kind=hermite-4"]].concat(), bodies()),
        ("kepler", [&steps[..], &["integrator.kind=gear-6"]].concat(), bodies()),
        ("kepler", [&steps[..], &["integrator.kind=ias15"]].concat(), bodies()),
        ("hard-disks", [&hard[..], &fluid].concat(), of_hard()),
        ("hard-disks", [&hard[..], &fluid, &["machine.engine=reference"]].concat(), of_hard()),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (number, (preset, overrides, changes)) in scenes.iter().enumerate() {
        let whole = folder.path().join(format!("whole-{number}"));
        changed_run(&whole, (preset, overrides), changes, None);
        let expected = results(&whole);
        assert_eq!(expected["changes.csv"].iter().filter(|&&byte| byte == b'\n').count(), 3);
        for checkpoint in 0..3 {
            let parts = folder.path().join(format!("parts-{number}-{checkpoint}"));
            changed_run(&parts, (preset, overrides), changes, Some(checkpoint));
            let found = results(&parts);
            for (name, bytes) in &expected {
                let [found, bytes] = [&found[name], bytes].map(|it| String::from_utf8_lossy(it));
                assert!(
                    found == bytes,
                    "{name} of {preset} {overrides:?} from {checkpoint}:\n{found}\n{bytes}"
                );
            }
        }
    }
}

/// Saved simulations continue with the same bits, also ones that were changed; saving changes nothing.
#[test]
fn saved_simulations_continue_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let closed = [
        "particles.generate=random",
        "particles.count=30",
        "domain.sides=[9.0, 9.0]",
        "domain.periodic=[false, false]",
        "run.time=9.0",
    ];
    for (number, (preset, overrides, first, change, last)) in [
        ("two-discs", &[][..], Until::Steps(30), change(GRAVITY, &[0.0, -3.0]), Until::Steps(90)),
        (
            "langevin-dense",
            &["particles.count=100", "domain.sides=[12.0, 12.0]"],
            Until::Steps(30),
            change(BATH, &[0.5]),
            Until::Steps(90),
        ),
        ("hard-disks", &closed, Until::Time(1.0), change(GRAVITY, &[0.0, -3.0]), Until::Time(3.0)),
    ]
    .into_iter()
    .enumerate()
    {
        let (prepared, program) = (prepared(preset, overrides), PROGRAM());
        let job = || RunJob {
            prepared: (&prepared).into(),
            quantities: quantities(&prepared),
            program: &program,
            is_open_ended: true,
        };
        let mut simulation = started(preset, overrides);
        advance(simulation.as_mut(), first);
        simulation.steer(&change).unwrap();
        let [saved, seen] = [folder.path().join(number.to_string()), folder.path().join("seen")];
        let before = simulation.observe();
        RunInProgress::save(&job(), &saved, ExistingRun::Refuse, simulation.as_mut()).unwrap();
        let restored = || RunInProgress::restored(&mut job(), &saved, false).unwrap();
        assert_eq!((restored().observe(), simulation.observe()), (before.clone(), before));
        advance(simulation.as_mut(), last);
        for _ in 0..2 {
            let mut other = restored();
            advance(other.as_mut(), last);
            assert_eq!(other.particles().checksum(), simulation.particles().checksum(), "{preset}");
            assert_eq!(other.observe(), simulation.observe());
        }
        assert!(RunInProgress::restored(&mut job(), &seen, false).is_err());
    }
}
