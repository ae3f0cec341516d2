//! Plane walls against exact solutions, and against each other in every engine.

use crate::domain::Domain;
use crate::method::lattice_md::{GranularScene, SteppedGrains, assemble_following_energy};
use crate::particles::Particle;

/// One disc of radius ½ and mass 2 in a closed box of 10 × 10, with a linear spring.
const DISC: &str = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"lattice-md\"\n[domain]\nsides = [10.0, 10.0]\n\
    periodic = [false, false]\ngravity = [GX, GY]\n[particles]\ngenerate = \"list\"\nradius = 0.5\nmass = 2.0\n\
    positions = [[X, Y]]\nvelocities = [[VX, VY]]\n[law]\nkind = \"linear\"\nstiffness = 2e4\nKEYS\n[integrator]\nkind = \"velocity-verlet\"\n\
    dt = 1e-4\n[run]\nsteps = 1\n";

fn one_disc(position: [f64; 2], velocity: [f64; 2], gravity: [f64; 2], keys: &str) -> SteppedGrains {
    let mut text = DISC.replace("KEYS", keys);
    for (name, value) in [("GX", gravity[0]), ("GY", gravity[1]), ("VX", velocity[0]), ("VY", velocity[1])] {
        text = text.replace(name, &format!("{value:?}"));
    }
    let text = text.replace("X", &format!("{:?}", position[0])).replace("Y", &format!("{:?}", position[1]));
    started(&text, &[])
}

fn started(text: &str, overrides: &[&str]) -> SteppedGrains {
    let scene = GranularScene::parse("walls", text).unwrap().with_overrides(overrides).unwrap();
    assemble_following_energy(&scene.check().unwrap()).unwrap()
}

fn disc(grains: &SteppedGrains) -> Particle {
    grains.particles().all()[0]
}

/// A damped linear spring returns the speed times exp(−γ π/(2 ω)), with ω² = k/m − γ²/4, at each of the four sides.
#[test]
fn bounce_has_the_restitution_of_theory() {
    let (k, m, gamma) = (2e4f64, 2.0, 20.0);
    let omega = (k / m - 0.25 * gamma * gamma).sqrt();
    let expected = (-0.5 * gamma * std::f64::consts::PI / omega).exp();
    for towards in [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]] {
        let start = [0, 1].map(|axis| 5.0 + 4.4 * towards[axis]);
        let mut grains = one_disc(start, towards, [0.0; 2], "normal_damping = 20.0\ncohesionless = false");
        (0..3000).for_each(|_| grains.step().unwrap());
        let velocity = disc(&grains).planar_velocity();
        let back = -(velocity[0] * towards[0] + velocity[1] * towards[1]);
        // The damping begins within a step: an error of γ dt/2.
        assert!((back / expected - 1.0).abs() < 2e-3, "{towards:?}: {back} {expected}");
    }
}

/// A disc rolls down an incline with ⅔ of g sin α, and slides with g (sin α − μ cos α) where friction is weak.
#[test]
fn disc_rolls_and_slides_down_an_incline() {
    let (sine, cosine) = (0.6, 0.8);
    let depth = 2.0 * cosine / 2e4;
    let acceleration = |friction: f64| {
        let keys = format!("normal_damping = 100.0\nshear_damping = 100.0\nfriction = {friction:?}");
        let mut grains = one_disc([1.0, 0.5 - depth], [0.0; 2], [sine, -cosine], &keys);
        (0..5_000).for_each(|_| grains.step().unwrap());
        let [before, _] = disc(&grains).planar_velocity();
        (0..10_000).for_each(|_| grains.step().unwrap());
        let Particle { velocity, omega, .. } = disc(&grains);
        (velocity[0] - before, velocity[0] + 0.5 * omega)
    };
    let (rolling, slip) = acceleration(0.9);
    assert!((rolling / (2.0 / 3.0 * sine) - 1.0).abs() < 1e-6, "{rolling}");
    // The drag of the slip is a third of the weight along the incline.
    assert!((slip / (sine / 3.0 / 100.0) - 1.0).abs() < 1e-6, "{slip}");
    let (sliding, _) = acceleration(0.1);
    assert!((sliding / (sine - 0.1 * cosine) - 1.0).abs() < 1e-6, "{sliding}");
}

/// A disc at rest on the floor is carried with its weight, m g, at the depth m g/k; a fixed wall does no work.
#[test]
fn floor_carries_the_weight() {
    let mut grains = one_disc([5.0, 0.502], [0.0; 2], [0.0, -3.0], "normal_damping = 100.0");
    (0..8_000).for_each(|_| grains.step().unwrap());
    let [[_, force, _]] = grains.forces().try_into().unwrap();
    assert!((force / 6.0 - 1.0).abs() < 1e-9, "{force}");
    let height = disc(&grains).position[1];
    assert!((0.5 - height - 6.0 / 2e4).abs() < 1e-9, "{height}");
    assert!(grains.totals().wall_work == 0.0 && grains.totals().dissipated > 0.0);
}

/// An override replaces one value of one wall.
#[test]
fn overrides_name_walls_by_their_number() {
    let scene = GranularScene::parse("walls", MANY).unwrap();
    let changed = scene.with_overrides(&["walls.2.to=[8.0, 5.0]", "walls.1.friction=0.3"]).unwrap();
    let (before, after) = (&scene.plane.list, &changed.plane.list);
    assert_eq!(after[1].ends, [Some([6.0, 4.0]), Some([8.0, 5.0])]);
    assert!(after[0].ends == before[0].ends && after[0] != before[0] && after[2..] == before[2..]);
    let refused = scene.with_overrides(&["walls.1.fricton=0.3"]).unwrap_err().to_string();
    assert!(refused.contains("did you mean \"friction\"?"), "{refused}");
    assert!(scene.with_overrides(&["walls.9.friction=0.3"]).is_err());
}

/// Wall discs may overlap each other: a grain on the middle one of three rests at 2R − m g/k above it.
#[test]
fn overlapping_wall_discs_carry_a_grain() {
    let text = DISC
        .replace("KEYS", "normal_damping = 100.0")
        .replace("periodic = [false, false]", "periodic = [true, true]");
    let text = [("GX", "0.0"), ("GY", "-3.0"), ("VX", "0.0"), ("VY", "0.0"), ("X", "5.0"), ("Y", "3.9997")]
        .into_iter()
        .fold(text, |text, (name, value)| text.replace(name, value));
    let walls = "wall_radius = 0.5\nwall_positions = [[4.7, 3.0], [5.0, 3.0], [5.3, 3.0]]\n[law]";
    let text = text.replace("[law]", walls);
    for overrides in [
        ["search.by=sectors", "machine.engine=fast"],
        ["search.by=neighbor-list", "machine.engine=fast"],
        ["search.by=neighbor-list", "machine.engine=programs"],
    ] {
        let mut grains = started(&text, &overrides);
        (0..8_000).for_each(|_| grains.step().unwrap());
        let [x, y, _] = disc(&grains).position;
        assert!((x - 5.0).abs() < 1e-12 && (y - (4.0 - 6.0 / 2e4)).abs() < 1e-9, "{overrides:?}: {x} {y}");
        assert!(grains.totals().dissipated.is_finite());
    }
    let scene = GranularScene::parse("walls", &text).unwrap().with_overrides(&["search.by=lattice"]).unwrap();
    assert!(scene.check().unwrap_err().to_string().contains("are in one cell of the lattice"));
}

/// Oblique collisions with a wall that rests, shears or oscillates agree with LAMMPS's `fix wall/gran hooke` in position, velocity and spin.
#[test]
fn wall_contacts_agree_with_lammps() {
    let table = include_str!("../../../../../../tests/rivals/wall_contacts.csv").lines();
    let (mut rows, mut turned) = (0, 0.0f64);
    for row in table.filter(|line| !line.starts_with('#')).skip(1) {
        let row: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (wall, disc, after) = (&row[..3], &row[3..10], &row[10..]);
        let (&[shear, amplitude, frequency], &[radius, mass, x, y, vx, vy, omega]) = (wall, disc) else {
            panic!()
        };
        let moving = match (shear != 0.0, frequency != 0.0) {
            (true, _) => format!("velocity = [{shear:?}, 0.0]\n"),
            (_, true) => format!("amplitude = [0.0, {amplitude:?}]\nfrequency = {frequency:?}\n"),
            _ => String::new(),
        };
        // The wall of LAMMPS is one length lower.
        let text = format!(
            "format = 2\nunits = \"reduced\"\n[method]\nkind = \"lattice-md\"\n[domain]\nsides = [16.0, 16.0]\nperiodic = [true, false]\n\
             closed_sides = \"edge\"\n[particles]\ngenerate = \"list\"\nradius = {radius:?}\nmass = {mass:?}\npositions = [[{x:?}, {:?}]]\n\
             velocities = [[{vx:?}, {vy:?}]]\nomegas = [{omega:?}]\n[law]\nkind = \"linear\"\nstiffness = 187.0\nnormal_damping = 0.7\n\
             shear_damping = 20.0\nfriction = 0.3\ncohesionless = false\n[integrator]\nkind = \"velocity-verlet\"\ndt = 2.5e-4\n\
             [run]\nsteps = 1\n[[walls]]\nfrom = [0.0, {:?}]\nto = [16.0, {:?}]\n{moving}",
            y + 1.0,
            1.0 + amplitude,
            1.0 + amplitude
        );
        for engine in ["fast", "programs"] {
            let mut grains = started(&text, &[&format!("machine.engine={engine}")]);
            (0..10_000).for_each(|_| grains.step().unwrap());
            let Particle { position, velocity, omega: spin, .. } = grains.particles().all()[0];
            let found = [position[0], position[1] - 1.0, velocity[0], velocity[1], spin];
            let off = found.iter().zip(after).map(|(ours, theirs)| (ours - theirs).abs()).fold(0.0, f64::max);
            assert!(off < 2e-4, "{engine}: {found:?} {after:?}");
            turned = turned.max((spin - omega).abs());
        }
        rows += 1;
    }
    assert!(rows == 15 && turned > 0.1, "{rows} {turned}");
}

/// Many discs between walls that lean, bend and move.
const MANY: &str = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"lattice-md\"\n[domain]\nsides = [14.0, 17.0]\n\
    periodic = [true, false]\ngravity = [0.0, -2.0]\n[particles]\ngenerate = \"random\"\ncount = 90\nradius = 0.5\n\
    mass = 1.0\nspeed = 4.0\n[law]\nstiffness = 3e5\nnormal_damping = 3.0\nshear_damping = 5.0\nfriction = 0.4\n\
    [integrator]\nkind = \"velocity-verlet\"\ndt = 2e-4\n[run]\nsteps = 1\n\
    [[walls]]\nfrom = [2.0, 8.0]\nto = [6.0, 4.0]\nfriction = 0.1\n\
    [[walls]]\nfrom = [6.0, 4.0]\nto = [9.5, 4.5]\nnormal_damping = 9.0\n\
    [[walls]]\nfrom = [0.0, 12.0]\nto = [14.0, 12.0]\nvelocity = [1.5, 0.0]\n\
    [[walls]]\nfrom = [11.0, 9.0]\nto = [12.0, 2.0]\namplitude = [0.3, 0.1]\nfrequency = 2.0\n\
    [[walls]]\nside = \"top\"\nmass = 30.0\nforce = [0.0, -40.0]\nfriction = 0.2\n";

/// Every engine, precision and search has the trajectory of the programs up to rounding; executions and threads have its bits.
#[test]
fn engines_agree_at_walls() {
    let run = |overrides: &[&str]| {
        let mut grains = started(MANY, overrides);
        (0..1500).for_each(|_| grains.step().unwrap());
        grains
    };
    let programs = run(&["machine.engine=programs"]);
    let particles = programs.particles();
    let checksum = particles.checksum();
    let domain = Domain::planar([0.0; 2], [14.0, 17.0], [true, false]);
    assert!(programs.totals().wall_work != 0.0);
    for execution in ["eager", "strip:16"] {
        let other = run(&["machine.engine=programs", &format!("machine.execution={execution}")]);
        assert_eq!(other.particles().checksum(), checksum, "{execution}");
    }
    let absolute = run(&["machine.engine=programs", "machine.coordinates=absolute"]);
    for (other, bound) in [
        (absolute, 1e-9),
        (run(&[]), 1e-9),
        (run(&["search.by=sectors"]), 1e-9),
        (run(&["search.by=neighbor-list"]), 1e-9),
        (run(&["machine.precision=mixed"]), 1e-3),
        (run(&["machine.precision=f32"]), 1e-3),
    ] {
        for (a, b) in particles.all().iter().zip(other.particles().all()) {
            let apart = domain.distance(a.planar_position(), b.planar_position());
            assert!(apart < bound, "disc {}: {apart}", a.id);
        }
        let [a, b] = [&programs, &other].map(SteppedGrains::totals);
        assert!(
            (a.dissipated / b.dissipated - 1.0).abs() < bound
                && (a.wall_work / b.wall_work - 1.0).abs() < bound
        );
    }
}

/// Momentum of the grains and impulses on the walls: what the grains lose the walls get, beside gravity, to rounding.
#[test]
fn momentum_goes_to_the_walls() {
    let momentum = |grains: &SteppedGrains| {
        let particles = grains.particles();
        [0, 1].map(|axis| particles.grains().iter().map(|disc| disc.mass * disc.velocity[axis]).sum::<f64>())
    };
    for engine in ["fast", "programs"] {
        let mut grains = started(MANY, &[&format!("machine.engine={engine}")]);
        let start = momentum(&grains);
        (0..1500).for_each(|_| grains.step().unwrap());
        let now = momentum(&grains);
        let gravity = [0.0, -2.0 * 90.0 * grains.time()];
        let impulses = &grains.wall_sums().impulses;
        assert_eq!(impulses.len(), 6);
        for axis in 0..2 {
            let to_walls: f64 = impulses.iter().map(|wall| wall[axis]).sum();
            let balance = now[axis] - start[axis] - gravity[axis] + to_walls;
            assert!(to_walls.abs() > 1.0 && balance.abs() < 1e-9, "{engine} {axis}: {balance} {to_walls}");
        }
    }
}

/// The torque of a weight on a floor is its lever times the weight, about the middle of the floor.
#[test]
fn torque_is_lever_times_force() {
    let mut grains = one_disc([7.0, 0.4997], [0.0; 2], [0.0, -3.0], "normal_damping = 100.0");
    (0..4_000).for_each(|_| grains.step().unwrap());
    let values = grains.own_values();
    // Left, right, bottom, top.
    let [_, impulse, _, force, torque] = values[10..15] else { panic!("{values:?}") };
    assert!((force / -6.0 - 1.0).abs() < 1e-9 && (torque / -12.0 - 1.0).abs() < 1e-9, "{force} {torque}");
    assert!((impulse / (-6.0 * 0.4) - 1.0).abs() < 1e-6, "{impulse}");
}

/// A disc that falls around a periodic box crosses a line once a turn: 8 falls through heights of 10 take √(2·80/2).
#[test]
fn flux_counts_every_passage() {
    let text = DISC.replace("KEYS", "").replace("periodic = [false, false]", "periodic = [true, true]");
    let text = [("GX", "0.0"), ("GY", "-2.0"), ("VX", "0.1"), ("VY", "0.0"), ("X", "5.0"), ("Y", "9.0")]
        .into_iter()
        .fold(text, |text, (name, value)| text.replace(name, value));
    let lines =
        "[[flux]]\nfrom = [0.0, 8.0]\nto = [10.0, 8.0]\n[[flux]]\nfrom = [6.0, 3.0]\nto = [0.0, 3.0]\n";
    let mut grains = started(&format!("{text}{lines}"), &[]);
    let steps = ((160.0f64 / 2.0).sqrt() / 1e-4) as usize;
    (0..steps).for_each(|_| grains.step().unwrap());
    // The second line is crossed to its left, and only while x is below 6.
    assert_eq!(grains.own_values(), [8.0, 16.0, -8.0, -16.0]);
}

/// Discs on a straight joint, and on the end of a wall that leans on another, touch one wall's worth of force.
#[test]
fn joints_carry_a_disc_once() {
    let text = DISC.replace("KEYS", "normal_damping = 100.0");
    let text = [("GX", "0.0"), ("GY", "-3.0"), ("VX", "0.0"), ("VY", "0.0"), ("X", "5.0"), ("Y", "4.4997")]
        .into_iter()
        .fold(text, |text, (name, value)| text.replace(name, value));
    let walls = |ends: [[f64; 4]; 2]| {
        ends.map(|[a, b, c, d]| format!("[[walls]]\nfrom = [{a:?}, {b:?}]\nto = [{c:?}, {d:?}]\n")).concat()
    };
    for ends in [
        [[0.0, 4.0, 5.0, 4.0], [5.0, 4.0, 10.0, 4.0]],
        [[10.0, 4.0, 5.0, 4.0], [0.0, 4.0, 5.0, 4.0]],
        [[0.0, 4.0, 10.0, 4.0], [5.0, 4.0, 5.0, 1.0]],
        [[5.0, 4.0, 2.0, 1.0], [5.0, 4.0, 8.0, 1.0]],
    ] {
        for engine in ["fast", "programs"] {
            let mut grains =
                started(&format!("{text}{}", walls(ends)), &[&format!("machine.engine={engine}")]);
            (0..4_000).for_each(|_| grains.step().unwrap());
            let [[x, force, _]] = grains.forces().try_into().unwrap();
            assert!((force / 6.0 - 1.0).abs() < 1e-9 && x.abs() < 1e-12, "{engine} {ends:?}: {x} {force}");
        }
    }
}

/// A lid of mass M = 4 that nothing touches falls by F t²/(2M).
#[test]
fn free_lid_follows_its_force() {
    let lid = "\n[[walls]]\nside = \"top\"\nmass = 4.0\nforce = [0.0, -2.0]\n";
    for engine in ["fast", "programs"] {
        let mut grains = with_lid([5.0, 1.0], [0.0; 2], lid, engine);
        (0..1000).for_each(|_| grains.step().unwrap());
        let [x, y, vx, vy] = grains.own_values()[5..9].try_into().unwrap();
        let expected = [5.0, 10.0 - 0.5 * 0.5 * 0.01, 0.0, -0.05];
        let differences = [x, y, vx, vy].into_iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-12, "{engine}: {x} {y} {vx} {vy}");
    }
}

/// A disc between the floor and a lid under a force F is compressed by F/k at both: the lid rests at 2R − 2F/k, and each wall bears F.
#[test]
fn lid_rests_where_springs_balance_its_force() {
    let lid = "\n[[walls]]\nfrom = [1.0, 1.0]\nto = [9.0, 1.0]\nmass = 2.0\nforce = [0.0, -6.0]\n";
    for engine in ["fast", "programs"] {
        let mut grains = with_lid([5.0, 0.5], [0.0; 2], lid, engine);
        (0..20_000).for_each(|_| grains.step().unwrap());
        let values = grains.own_values();
        let [force, height, speed] = [values[3], values[6], values[8]];
        assert!(
            (height - (1.0 - 12.0 / 2e4)).abs() < 1e-9 && speed.abs() < 1e-9,
            "{engine}: {height} {speed}"
        );
        // Lid, left, right, bottom.
        assert!(
            (force - 6.0).abs() < 1e-6 && (values[9 + 10 + 3] + 6.0).abs() < 1e-6,
            "{engine}: {values:?}"
        );
    }
}

/// A disc of mass m = 2 at speed 1 meets a lid of mass M = 6 at rest: (m − M)/(m + M) = −½ and 2m/(m + M) = ½ follow from momentum and energy.
#[test]
fn disc_and_lid_collide_elastically() {
    let lid = "\n[[walls]]\nfrom = [0.0, 6.0]\nto = [10.0, 6.0]\nmass = 6.0\nforce = [0.0, -1e-9]\n";
    for engine in ["fast", "programs"] {
        let mut grains = with_lid([5.0, 5.4], [0.0, 1.0], &lid.replace("1e-9", "0.000000001"), engine);
        (0..5000).for_each(|_| grains.step().unwrap());
        let (disc, lid) = (disc(&grains).velocity[1], grains.own_values()[8]);
        assert!((disc + 0.5).abs() < 1e-4 && (lid - 0.5).abs() < 1e-4, "{engine}: {disc} {lid}");
    }
}

/// A lid over many grains: its kinetic energy is the work of its force less its work on the grains, to the order of the step.
#[test]
fn lid_exchanges_energy_with_grains() {
    let lid = "[[walls]]\nfrom = [0.0, 9.0]\nto = [14.0, 9.0]\nmass = 40.0\nforce = [0.0, -30.0]\n";
    let text = MANY
        .replace("sides = [14.0, 17.0]", "sides = [14.0, 12.0]")
        .split("[[walls]]")
        .next()
        .unwrap()
        .to_owned();
    let text =
        text.replace("count = 90", "count = 60").replace("gravity = [0.0, -2.0]", "gravity = [0.0, 0.0]");
    let balance = |dt: &str, engine: &str| {
        let dt_key = format!("integrator.dt={dt}");
        let mut grains = started(&format!("{text}{lid}"), &[&dt_key, &format!("machine.engine={engine}")]);
        let steps = (0.3 / dt.parse::<f64>().unwrap()).round() as usize;
        (0..steps).for_each(|_| grains.step().unwrap());
        let values = grains.own_values();
        let [height, speed] = [values[6], values[8]];
        let work = grains.totals().wall_work;
        assert!(work.abs() > 1.0, "{work}");
        (20.0 * speed * speed - 30.0 * (9.0 - height) + work).abs()
    };
    for engine in ["fast", "programs"] {
        let [coarse, fine] = ["2e-4", "5e-5"].map(|dt| balance(dt, engine));
        assert!(coarse < 2e-2 && fine < 0.15 * coarse, "{engine}: {coarse} {fine}");
    }
}

/// Two joined walls part by g = ½: a disc rests on their ends, at the height √(R'² − g²/4) with R' = R − ξ and 2 k ξ cos α = m g.
#[test]
fn walls_that_part_have_corners() {
    let walls =
        "\n[[walls]]\nfrom = [0.0, 4.0]\nto = [5.0, 4.0]\n[[walls]]\nfrom = [5.0, 4.0]\nto = [10.0, 4.0]\n";
    let at_height = |depth: f64| ((0.5 - depth) * (0.5 - depth) - 0.0625f64).sqrt();
    let mut depth = 0.0;
    (0..50).for_each(|_| depth = 6.0 * (0.5 - depth) / at_height(depth) / 4e4);
    for engine in ["fast", "programs"] {
        let mut grains = with_walls(([5.25, 4.6], [0.0; 2], [0.0, -3.0]), walls, engine);
        grains.set_wall_velocities(&[[0.0; 2], [5.0, 0.0]]);
        (0..1000).for_each(|_| grains.step().unwrap());
        grains.set_wall_velocities(&[[0.0; 2]; 2]);
        (0..20_000).for_each(|_| grains.step().unwrap());
        let [x, y, _] = disc(&grains).position;
        assert!((x - 5.25).abs() < 1e-9 && (y - 4.0 - at_height(depth)).abs() < 1e-9, "{engine}: {x} {y}");
    }
}

/// A wall moves on from where it is when its velocity is changed.
#[test]
fn walls_change_their_velocity() {
    let walls = "\n[[walls]]\nfrom = [2.0, 4.0]\nto = [8.0, 4.0]\nvelocity = [0.5, 0.0]\n";
    for engine in ["fast", "programs"] {
        let mut grains = with_lid([7.0, 5.0], [0.0; 2], walls, engine);
        (0..10_000).for_each(|_| grains.step().unwrap());
        grains.set_wall_velocities(&[[-1.0, -0.25]]);
        (0..10_000).for_each(|_| grains.step().unwrap());
        let found = &grains.own_values()[5..9];
        let differences = found.iter().zip([4.5, 3.75, -1.0, -0.25]).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-9, "{engine}: {found:?}");
    }
}

/// One disc in a closed box without gravity.
fn with_lid(position: [f64; 2], velocity: [f64; 2], walls: &str, engine: &str) -> SteppedGrains {
    with_walls((position, velocity, [0.0; 2]), walls, engine)
}

/// One disc in a closed box, with damping where it starts at rest.
fn with_walls(
    (position, velocity, gravity): ([f64; 2], [f64; 2], [f64; 2]),
    walls: &str,
    engine: &str,
) -> SteppedGrains {
    let damping = if velocity == [0.0; 2] { "normal_damping = 100.0" } else { "" };
    let mut text = DISC.replace("KEYS", damping);
    for (name, value) in [("GX", gravity[0]), ("GY", gravity[1]), ("VX", velocity[0]), ("VY", velocity[1])] {
        text = text.replace(name, &format!("{value:?}"));
    }
    let text = text.replace("X", &format!("{:?}", position[0])).replace("Y", &format!("{:?}", position[1]));
    started(&format!("{text}{walls}"), &[&format!("machine.engine={engine}")])
}
