//! Requests that a method cannot carry out correctly are refused or reported: every contact search, in every precision, compared with
//! known motions.

use std::sync::atomic::AtomicBool;
use stripmine_physics::method::lattice_md::{CheckedGranularScene, GranularDocument};
use stripmine_physics::method::lattice_md::{GranularTotals, SteppedGrains};
use stripmine_physics::method::lattice_md::{assemble, assemble_following_energy, model};
use stripmine_physics::method::{Culprit, FailureKind, METHODS, PhysicsFailure, StartPurpose, Until, load};
use stripmine_physics::observe::{Observation, SceneProperties};

/// Every engine, with the overrides that choose it.
const ENGINES: [(&str, &[&str]); 6] = [
    ("chained lattice", &["machine.execution=chained"]),
    ("eager lattice", &["machine.execution=eager"]),
    ("fast lattice", &["machine.engine=fast", "search.by=lattice"]),
    ("sectors", &["search.by=sectors", "machine.engine=fast"]),
    ("chained lists", &["search.by=neighbor-list", "machine.execution=chained"]),
    ("fast lists", &["search.by=neighbor-list", "machine.engine=fast"]),
];

fn checked(scene: &str, overrides: &[&[&str]]) -> CheckedGranularScene {
    let overrides: Vec<String> = overrides.concat().into_iter().map(str::to_owned).collect();
    let document = match scene.contains('\n') {
        true => GranularDocument::parse("scene", scene, &overrides),
        false => GranularDocument::load(scene, &overrides),
    };
    document.and_then(GranularDocument::check).unwrap_or_else(|errors| panic!("{errors}"))
}

fn refused(scene: &str, overrides: &[&str]) -> String {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let document = match scene.contains('\n') {
        true => GranularDocument::parse("scene", scene, &overrides),
        false => GranularDocument::load(scene, &overrides),
    };
    document.and_then(GranularDocument::check).expect_err("must be refused").to_string()
}

fn observe(checked: &CheckedGranularScene, method: &SteppedGrains) -> Observation {
    Observation::of(method.steps(), method.time(), &method.particles(), &SceneProperties::of(&model(checked)))
}

/// Step of a failure, and the first particle that it names.
fn step_and_first(failure: &PhysicsFailure) -> (u64, Culprit) {
    (failure.at.expect("a moment").steps, failure.culprits[0])
}

fn advance(method: &mut SteppedGrains, steps: u64) {
    (0..steps).for_each(|_| method.step().unwrap_or_else(|failure| panic!("{failure}")));
}

/// Discs of radius 0.5 and mass 1 in a box with periodic sides.
fn discs(sides: [f64; 2], positions: &str, velocities: &str, dt: f64) -> String {
    format!(
        "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"reduced\"\n[domain]\nsides = {sides:?}\n[particles]\ngenerate = \"list\"\n\
         positions = {positions}\nvelocities = {velocities}\nradius = 0.5\nmass = 1.0\n[law]\nstiffness = 100.0\n\
         stop_penetration = 0.99\n[integrator]\nkind = \"velocity-verlet\"\ndt = {dt:?}\n[run]\nsteps = 1\n"
    )
}

/// The box is that of the scene, also if its sides are not multiples of a cell: every engine finds a disc beyond the same side, in
/// the same step.
#[test]
fn thin_box_has_the_sides_of_the_scene() {
    let scene = discs([6.0, 0.9], "[[1.0, 0.45], [4.0, 0.45]]", "[[0.0, 0.5], [0.0, 0.0]]", 1e-2);
    let mut found = Vec::new();
    for (name, engine) in ENGINES {
        let checked =
            checked(&scene, &[engine, &["domain.periodic=[true, false]", "domain.closed_sides=edge"]]);
        let mut method = assemble(&checked).unwrap();
        let failure =
            (0..200).find_map(|_| method.step().err()).unwrap_or_else(|| panic!("{name}: never left"));
        assert_eq!((failure.kind, failure.count), (FailureKind::OUT_OF_BOX, 1), "{name}: {failure}");
        let (step, first) = step_and_first(&failure);
        assert!(first.id == 1 && (0.9..0.906).contains(&first.position[1]), "{name}: {first}");
        found.push(step);
    }
    assert!(found.iter().all(|step| *step == found[0]), "{found:?}");
}

/// Two discs so soft that they enter one cell of the lattice; lists handle them.
#[test]
fn lists_handle_discs_in_one_cell() {
    let scene =
        discs([10.0, 10.0], "[[4.6323, 4.6323], [5.3677, 5.3677]]", "[[1.6, 1.6], [-1.6, -1.6]]", 1e-3);
    let run = |engine: &[&str]| {
        let checked = checked(&scene, &[engine]);
        let mut method = assemble(&checked).unwrap();
        let before = observe(&checked, &method);
        advance(&mut method, 1000);
        let after = observe(&checked, &method);
        assert!((after.energy() / before.energy() - 1.0).abs() < 1e-5, "{engine:?}: {after:?}");
        (method.particles(), method.totals())
    };
    let (sectors, deep) = run(ENGINES[3].1);
    assert!(deep.deepest > 0.3, "they must overlap deeply: {deep:?}");
    for (name, engine) in [ENGINES[4], ENGINES[5]] {
        let (lists, also_deep) = run(engine);
        for (a, b) in sectors.all().iter().zip(lists.all()) {
            assert!((a.velocity[0] - b.velocity[0]).abs() < 1e-9, "{name}: {a:?} {b:?}");
        }
        assert_eq!(deep.deep_disc_steps, also_deep.deep_disc_steps, "{name}");
    }
    let failure = |engine: &[&str]| -> PhysicsFailure {
        let mut method = assemble(&checked(&scene, &[engine, &["law.stop_penetration=0.3"]])).unwrap();
        (0..1000).find_map(|_| method.step().err()).expect("too deep")
    };
    for (name, engine) in [ENGINES[3], ENGINES[4], ENGINES[5]] {
        assert_eq!(failure(engine).kind, FailureKind::TOO_DEEP, "{name}");
    }
}

/// A warm gas whose discs sometimes share a cell conserves its energy with lists.
#[test]
fn hot_gas_conserves_energy_with_lists() {
    let checked =
        checked("dense-gas", &[ENGINES[4].1, &["particles.count=100", "particles.temperature=0.3"]]);
    let mut method = assemble(&checked).unwrap();
    let before = observe(&checked, &method).energy();
    advance(&mut method, 2000);
    let after = observe(&checked, &method).energy();
    assert!((after / before - 1.0).abs() < 1e-4, "{before} {after}");
}

/// Single precision moves a disc by its full displacement, for any size of box and any position.
#[test]
fn single_precision_loses_no_motion() {
    for (length, x, speed) in [(10_000.0, 5000.0, 0.09), (10_000.0, 9000.0, 0.11), (1000.0, 700.0, 0.01)] {
        let scene = discs(
            [length, 4.0],
            &format!("[[{x:?}, 2.0], [1.5, 2.0]]"),
            &format!("[[{speed:?}, 0.0], [0.0, {speed:?}]]"),
            0.005,
        );
        for (name, engine) in ENGINES {
            // Programs sweep all the empty cells.
            let steps = if engine[0].ends_with("fast") || engine[1..].concat().ends_with("fast") {
                2000
            } else {
                100
            };
            let checked = checked(&scene, &[engine, &["machine.precision=f32"]]);
            let mut method = assemble(&checked).unwrap();
            let start = method.particles();
            advance(&mut method, steps);
            let moved = method.particles().all()[0].position[0] - start.all()[0].position[0];
            let off = moved / (speed * 0.005 * steps as f64) - 1.0;
            assert!(off.abs() < 2e-3, "{name} in {length}: moved {moved}");
        }
    }
}

/// Single and double precision agree across every periodic side, in either direction.
#[test]
fn precisions_agree_across_periodic_sides() {
    for (velocity, (name, engine)) in
        ["[[-0.9, -0.7]]", "[[1.1, 0.8]]"].into_iter().flat_map(|v| ENGINES.map(|e| (v, e)))
    {
        let scene = discs([12.0, 9.0], "[[1.0, 1.0]]", velocity, 0.005);
        let run = |precision: &str| {
            let mut method = assemble(&checked(&scene, &[engine, &[precision]])).unwrap();
            advance(&mut method, 6000);
            method.particles()
        };
        for (a, b) in run("machine.precision=f64").all().iter().zip(run("machine.precision=f32").all()) {
            for axis in 0..2 {
                let side = [12.0, 9.0][axis];
                let off = (a.position[axis] - b.position[axis] + 1.5 * side).rem_euclid(side) - 0.5 * side;
                assert!(off.abs() < 5e-3, "{name}: {a:?} {b:?}");
            }
        }
    }
}

/// Nearly empty boxes have wide sectors in double precision only.
#[test]
fn single_precision_conserves_energy_in_empty_boxes() {
    for (name, engine) in &ENGINES[2..] {
        // Chained lists enter discs in a lattice, whose cells are all cleared.
        let (length, x) = if *name == "chained lists" { (200.0, 90.3) } else { (20_000.0, 9000.3) };
        let positions = format!("[[{x:?}, 9.0], [{:?}, 9.4]]", x + 2.0);
        let scene = discs([length, 20.0], &positions, "[[0.3, 0.0], [-0.3, 0.0]]", 0.005);
        for (precision, bound) in [("machine.precision=f32", 2e-3), ("machine.precision=mixed", 2e-3)] {
            let checked = checked(&scene, &[engine, &[precision]]);
            let mut method = assemble(&checked).unwrap();
            let before = observe(&checked, &method).kinetic;
            advance(&mut method, 1500);
            let seen = observe(&checked, &method);
            assert_eq!(seen.contacts, 0, "the collision must be over");
            let turned = method.particles().all()[0].velocity[1].abs();
            assert!(turned > 0.05, "they must have collided: {turned}");
            assert!((seen.kinetic / before - 1.0).abs() < bound, "{name} {precision}: {seen:?}");
        }
    }
}

#[test]
fn absolute_single_precision_is_refused_far_away() {
    let absolute = ["machine.precision=f32", "machine.coordinates=absolute"];
    let scene = discs([1000.0, 4.0], "[[700.0, 2.0]]", "[[0.01, 0.0]]", 0.005);
    let said = refused(&scene, &absolute);
    assert!(said.contains("cell-relative") && said.contains("up to 6e-5"), "{said}");
    let near = discs([5.0, 4.0], "[[1.0, 2.0]]", "[[1.0, 0.0]]", 0.005);
    assert!(checked(&near, &[&absolute]).warnings.iter().all(|warning| warning.key != "machine.precision"));
    // Cell-relative coordinates no longer help slow discs: positions are rounded by up to 5e-8, and these steps move 2.5e-8 and 1e-7.
    let slow = |speed: &str| discs([5.0, 4.0], "[[1.0, 2.0]]", &format!("[[{speed}, 0.0]]"), 0.005);
    assert!(refused(&slow("5e-6"), &["machine.precision=f32"]).contains("single precision"));
    let warned = checked(&slow("2e-5"), &[&["machine.precision=f32"]]).warnings;
    assert!(warned.iter().any(|warning| warning.key == "machine.precision"), "{warned:?}");
}

/// Dissipation is counted in every contact and step: rare rows change nothing, and all engines agree.
#[test]
fn dissipation_balances_the_energy() {
    let run = |engine: &[&str], steps: u64| -> (GranularTotals, f64) {
        let more =
            ["particles.count=100", "law.normal_damping=0.3", "law.shear_damping=0.2", "law.friction=0.4"];
        let checked = checked("dense-gas", &[&more, engine]);
        let mut method = assemble_following_energy(&checked).unwrap();
        let energy = |method: &SteppedGrains| {
            let seen = observe(&checked, method);
            seen.kinetic + seen.rotational + seen.elastic
        };
        let before = energy(&method);
        advance(&mut method, steps);
        let totals = method.totals();
        (totals, energy(&method) - before + totals.dissipated)
    };
    let (faithful, error) = run(ENGINES[0].1, 3000);
    assert!(faithful.dissipated > 0.1, "{faithful:?}");
    assert!(error.abs() < 1e-3 * faithful.dissipated, "{error} of {faithful:?}");
    for (name, engine) in &ENGINES[1..] {
        let (totals, _) = run(engine, 3000);
        assert!((totals.dissipated / faithful.dissipated - 1.0).abs() < 1e-6, "{name}: {totals:?}");
    }
    let elastic = checked("dense-gas", &[&["particles.count=100"]]);
    let mut method = assemble_following_energy(&elastic).unwrap();
    advance(&mut method, 200);
    assert_eq!(method.totals().dissipated, 0.0);
}

/// Grains that fall through a periodic side repeatedly, and a shaken floor.
#[test]
fn work_of_gravity_and_walls_is_counted() {
    for (scene, steps, tolerance) in [("pipe-small", 4000, 0.02), ("shaken-box", 4000, 0.02)] {
        for (name, engine) in [ENGINES[0], ENGINES[2], ENGINES[3], ENGINES[4], ENGINES[5]] {
            let checked = checked(scene, &[engine]);
            let mut method = assemble_following_energy(&checked).unwrap();
            let start = method.particles();
            let inner = |method: &SteppedGrains| {
                let seen = observe(&checked, method);
                seen.kinetic + seen.rotational + seen.elastic
            };
            let before = inner(&method);
            advance(&mut method, steps);
            let (now, crossings, totals) = (method.particles(), method.crossings(), method.totals());
            let mut work = 0.0;
            for (number, (a, b)) in start.grains().iter().zip(now.grains()).enumerate() {
                for axis in 0..2 {
                    let periods = crossings.get(number).map_or(0.0, |periods| periods[axis]);
                    let displacement =
                        b.position[axis] - a.position[axis] + periods * checked.domain.length(axis);
                    let pulled = checked.scene.domain.gravity[axis];
                    if pulled != 0.0 {
                        work += b.mass * pulled * displacement;
                    }
                }
            }
            let error = inner(&method) - before - work - totals.wall_work + totals.dissipated;
            let scale = totals.dissipated + work.abs() + totals.wall_work.abs();
            assert!(error.abs() < tolerance * scale, "{scene}, {name}: {error} {work} {totals:?}");
            assert_eq!(scene == "shaken-box", totals.wall_work != 0.0);
        }
    }
}

/// A correction that moves a disc across a periodic side does not count as a fall by a whole period: energy is balanced in that step.
#[test]
fn corrections_across_sides_do_no_work() {
    const STEP: u64 = 12;
    let seen = |engine: &[&str], origin: f64| {
        let scene = discs([12.0, 9.0], "[[4.0, 4.5], [5.02, 4.5]]", "[[1.5, 0.0], [0.5, 0.0]]", 0.01)
            .replace(
                "sides = [12.0, 9.0]",
                &format!("sides = [12.0, 9.0]\norigin = [{origin:?}, 0.0]\ngravity = [0.5, 0.0]"),
            );
        let gear = ["integrator.kind=gear", "integrator.values=5"];
        let overrides: Vec<String> = [engine, &gear].concat().into_iter().map(str::to_owned).collect();
        let prepared =
            GranularDocument::parse("scene", &scene, &overrides).and_then(GranularDocument::prepare).unwrap();
        let mut run = prepared.start(StartPurpose::Run).unwrap();
        run.advance(&[Until::Steps(STEP)], &AtomicBool::new(false)).unwrap();
        let quantities = METHODS[0].quantities;
        let error = quantities.iter().position(|quantity| quantity.name == "balance_error").unwrap();
        (run.particles().all()[0].position[0], run.observe()[error].abs())
    };
    for (name, engine) in ENGINES {
        let (there, error) = seen(engine, 0.0);
        // The prediction is on the other side in one of the two cases.
        for beside in [-1e-8, 1e-8] {
            let (_, across) = seen(engine, there - 12.0 + beside);
            assert!((across - error).abs() < 1e-6, "{name}: {across}, and {error} elsewhere");
        }
    }
}

/// A grain that falls through a periodic side is counted in that step, not when a search next wraps its position.
#[test]
fn energy_balance_is_continuous_across_sides() {
    let quantities = METHODS[0].quantities;
    let balance = quantities.iter().position(|quantity| quantity.name == "balance_error").unwrap();
    for search in ["lattice", "neighbor-list", "sectors"] {
        let overrides = ["integrator.dt=5e-5".to_owned(), format!("search.by={search}")];
        let (prepared, _) = load("pipe-small", &overrides, METHODS).unwrap();
        let mut simulation = prepared.start(StartPurpose::Run).unwrap();
        for step in 1..=1300 {
            simulation.advance(&[Until::Steps(step)], &AtomicBool::new(false)).unwrap();
            // A fall by the length of the pipe is 3.2e-5 J for a grain.
            let error = simulation.observe()[balance];
            assert!(error.abs() < 1e-6, "{search}, step {step}: {error}");
        }
    }
}

/// A disc that leaves through an open side and returns is detected in the same step, also with lists.
#[test]
fn disc_leaving_for_a_moment_is_detected() {
    let scene = discs([20.0, 20.0], "[[10.0, 19.9], [10.0, 5.0]]", "[[0.0, 1.0], [0.1, 0.0]]", 0.005)
        .replace(
            "sides = [20.0, 20.0]",
            "sides = [20.0, 20.0]\nperiodic = [true, false]\nclosed_sides = \"edge\"\ngravity = [0.0, -4.0]",
        );
    let failure = |engine: &[&str], more: &[&str]| {
        let mut method = assemble(&checked(&scene, &[engine, more])).unwrap();
        (0..200).find_map(|_| method.step().err()).expect("it left the box")
    };
    let left = |failure: PhysicsFailure| {
        assert_eq!(failure.kind, FailureKind::OUT_OF_BOX, "{failure}");
        let (step, first) = step_and_first(&failure);
        (step, first.id)
    };
    let (step, _) = left(failure(ENGINES[3].1, &[]));
    for skin in ["search.skin=0.15", "search.skin=0.6", "search.skin=1.0"] {
        assert_eq!(left(failure(ENGINES[5].1, &[skin])), (step, 1), "{skin}");
    }
}

/// A disc fast enough to pass through others is detected in that step, or counted.
#[test]
fn too_long_steps_are_detected() {
    let scene = discs([12.0, 9.0], "[[1.0, 1.0], [7.0, 5.0]]", "[[0.1, 0.0], [0.0, 0.1]]", 0.01)
        .replace("periodic", "# periodic")
        .replace("sides = [12.0, 9.0]", "sides = [12.0, 9.0]\ngravity = [40.0, 0.0]");
    let mut steps = vec![];
    for (name, engine) in ENGINES {
        let mut method = assemble(&checked(&scene, &[engine])).unwrap();
        let failure = (0..400).find_map(|_| method.step().err()).expect("too fast");
        assert_eq!(failure.kind, FailureKind::LONG_STEP, "{name}: {failure}");
        let ((step, first), limit) = (step_and_first(&failure), failure.value("limit").unwrap());
        assert!(first.velocity[0].abs() * 0.01 > limit && failure.count >= 1, "{name}");
        steps.push(step);
        let mut counting = assemble(&checked(&scene, &[engine, &["integrator.on_long_step=count"]])).unwrap();
        advance(&mut counting, step + 2);
        assert!(counting.totals().long_steps >= 3, "{name}: {:?}", counting.totals());
    }
    assert!(steps.iter().all(|step| step.abs_diff(steps[0]) <= 1), "{steps:?}");
}

#[test]
fn too_fast_discs_at_the_start_are_refused() {
    // Five diameters a step.
    let scene = discs([100.0, 9.0], "[[10.0, 4.0], [30.0, 4.0]]", "[[500.0, 0.0], [0.0, 0.0]]", 0.01);
    let said = refused(&scene, &["law.stiffness=1e12"]);
    assert!(said.contains("disc 1 moves at 500,") && said.contains("on_long_step"), "{said}");
    let counted = ["law.stiffness=1e9", "integrator.on_long_step=count", "integrator.dt=0.002"];
    assert!(refused(&scene, &counted).contains("steps"), "a collision of less than a step");
}

#[test]
fn too_few_steps_a_contact_are_refused() {
    let scene = discs([10.0, 10.0], "[[3.0, 5.0], [6.0, 5.0]]", "[[1.0, 0.0], [0.0, 0.0]]", 0.3);
    let said = refused(&scene, &["law.stiffness=1e4"]);
    assert!(said.contains("steps: with fewer than 3"), "{said}");
}

/// Cells so wide that single precision makes the search miss contacts.
#[test]
fn cells_too_wide_for_the_search_are_refused() {
    let resolve = ["machine.engine=fast", "search.by=lattice", "search.on_conflict=resolve"];
    let scene = discs([1e5, 1e5], "[[4.0, 5.0], [7.0, 5.0]]", "[[1.0, 0.0], [0.0, 0.0]]", 1e-3);
    let said = refused(&scene, &[&resolve[..], &["search.cell_edge=1e4"]].concat());
    assert!(said.contains("single precision") && said.contains("at most 8"), "{said}");
    // The largest allowed cells find every contact.
    let packed = ["particles.count=400", "particles.temperature=0.05", "machine.precision=f64"];
    let run = |engine: &[&str]| {
        let checked = checked("dense-gas", &[&packed, engine]);
        let mut method = assemble(&checked).unwrap();
        advance(&mut method, 200);
        observe(&checked, &method)
    };
    let (wide, sectors) = (run(&[&resolve[..], &["search.cell_edge=4"]].concat()), run(ENGINES[3].1));
    assert_eq!(wide.contacts, sectors.contacts);
    assert!((wide.energy() / sectors.energy() - 1.0).abs() < 1e-9);
}

/// Positions far from the origin that numbers cannot resolve.
#[test]
fn positions_too_coarse_for_their_distance_are_refused() {
    let scene = discs([12.0, 9.0], "[[1e12, 1.0], [1e12, 5.0]]", "[[0.0, 0.0], [0.0, 0.1]]", 0.01)
        .replace("sides = [12.0, 9.0]", "origin = [1e12, 0.0]\nsides = [12.0, 9.0]");
    assert!(refused(&scene, &[]).contains("too coarse"));
}

/// Lists in narrow boxes, and skins too large for a box, are refused when a scene is checked.
#[test]
fn boxes_too_small_for_lists_are_refused() {
    let lists = ["search.by=neighbor-list", "machine.engine=fast"];
    let mut method = assemble(&checked("two-discs", &[&lists, &["search.skin=7.4"]])).unwrap();
    advance(&mut method, 50);
    let said = refused("dense-gas", &[&lists[..], &["particles.count=64", "search.skin=4.0"]].concat());
    assert!(said.contains("no room for three sectors"), "{said}");
    // Without a given skin, the box decides.
    let small = discs([4.0, 3.2], "[[1.0, 1.0]]", "[[0.1, 0.0]]", 0.005);
    advance(&mut assemble(&checked(&small, &[&lists])).unwrap(), 10);
    // Scenes that pass the check start: small boxes of every size, with every search.
    for sides in (0..60).map(|n| [2.6 + 0.07 * f64::from(n), 2.6 + 0.11 * f64::from(n % 13)]) {
        let scene = discs(sides, "[[1.0, 1.0]]", "[[0.1, 0.0]]", 0.005);
        for (name, engine) in ENGINES {
            let overrides: Vec<String> = engine.iter().map(|&text| text.to_owned()).collect();
            if let Ok(checked) =
                GranularDocument::parse("scene", &scene, &overrides).and_then(GranularDocument::check)
            {
                assert!(assemble(&checked).is_ok(), "{name} in {sides:?}");
            }
        }
    }
}

/// Unused velocities of wall discs in a start file are reported.
#[test]
fn unused_wall_disc_velocities_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("start.xyz");
    let row = |species: &str, x: f64, id: u32, v: f64| {
        format!("{species} {x:?} 4.0 0.0 {id} {v:?} 0.0 0.0 0.5 1.0 0.0 0.0 0.0\n")
    };
    let head = "Lattice=\"10.0 0 0 0 8.0 0 0 0 1\" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";
    let rows = row("Si", 2.0, 1, 0.5) + &row("W", 5.0, 2, 0.25) + &row("W", 8.0, 3, 0.0);
    std::fs::write(&file, format!("3\n{head}\n{rows}")).unwrap();
    // Without pbc the scene alone decides which sides are periodic.
    let scene = format!(
        "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"reduced\"\n[domain]\nsides = [10.0, 8.0]\nperiodic = [true, false]\n[particles]\nfile = {:?}\n\
         [law]\nstiffness = 100.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 1\n",
        file.display().to_string()
    );
    let checked = checked(&scene, &[]);
    let said: Vec<String> = checked.warnings.iter().map(ToString::to_string).collect();
    assert!(
        said.iter().any(|text| text.contains("1 wall discs") && text.contains("wall disc 2")),
        "{said:?}"
    );
    assert_eq!(checked.particles.all()[1].velocity, [0.0; 3]);
}

/// Sums that overflow stop a run: no `inf` is written to a table.
#[test]
fn sums_that_overflow_are_failures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let output = assert_cmd::Command::cargo_bin("stripmine")
        .unwrap()
        .args([
            "run",
            "two-discs",
            "--quiet",
            "--out",
            out.to_str().unwrap(),
            "--set",
            "particles.mass=1e308",
        ])
        .args([
            "--set",
            "law.stiffness=1e300",
            "--set",
            "law.normal_damping=0",
            "--set",
            "integrator.on_long_step=count",
        ])
        .args(["--set", "particles.velocities=[[3.0, 0.0], [0.0, 0.0]]"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.contains("not a finite number"), "{said}");
}
