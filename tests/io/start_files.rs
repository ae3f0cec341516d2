//! One configuration of 16 discs as different programs write it, started by every method; files of this program; and bad files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use stripmine_physics::method::{METHODS, Prepared, vocabularies};
use stripmine_physics::particles::{Particle, ParticleKind};
use stripmine_physics::scene::SceneValues;

/// Methods, and their scenes without a start.
const SCENES: [(&str, &str); 4] = [
    ("hard-disks", "[run]\ntime = 1.0\n"),
    (
        "lattice-md",
        "[law]\nstiffness = 100.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 4\nthermo_every = 4\nsnapshot_every = 4\n",
    ),
    (
        "langevin",
        "[law]\nkind = \"none\"\ndrag = 1.0\nbath_temperature = 1.0\n[integrator]\ndt = 0.01\n[run]\nsteps = 4\nthermo_every = 4\nsnapshot_every = 4\n",
    ),
    (
        "nbody",
        "[law]\nsoftening = 0.1\n[integrator]\ndt = 0.01\n[run]\nsteps = 4\nthermo_every = 4\nsnapshot_every = 4\n",
    ),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/io/start_files")
}

/// Scene of a method with a start file and further keys.
fn start(method: usize, file: &Path, keys: &[&str]) -> Result<Prepared, String> {
    let (name, rest) = SCENES[method];
    let text = format!(
        "format = 2\nunits = \"reduced\"\n[method]\nkind = \"{name}\"\n[particles]\nfile = {:?}\n{rest}",
        file.display().to_string()
    );
    let keys: Vec<String> = keys.iter().map(|&key| key.to_owned()).collect();
    let values = SceneValues::parse("scene.toml", &text, &keys, &vocabularies(METHODS));
    let prepared = values.and_then(|values| stripmine_physics::method::prepare(values, METHODS));
    prepared.map(|(prepared, _)| prepared).map_err(|errors| errors.to_string())
}

/// Quantities that a file lacks.
const RADIUS: usize = 0;
const MASS: usize = 1;
const MOTION: usize = 2;

/// File, quantities that it lacks, and its digits: positions of files with six decimals differ from those with all.
const CASES: [(&str, &[usize], f64); 14] = [
    ("base.xyz", &[], 5e-7),
    ("bom.xyz", &[], 5e-7),
    ("fortran.xyz", &[], 5e-7),
    ("id0.xyz", &[], 5e-7),
    ("pbc_2.xyz", &[], 5e-7),
    ("species_ar.xyz", &[], 5e-7),
    ("tilt_eps.xyz", &[], 5e-7),
    ("planar.xyz", &[], 5e-7),
    ("ase_momenta.xyz", &[RADIUS], 5e-9),
    ("ovito_student.xyz", &[MASS], 1e-15),
    ("lammps_plain.xyz", &[RADIUS, MASS, MOTION], 1e-15),
    ("edmd.sph", &[MASS, MOTION], 5e-9),
    ("lammps.data", &[MOTION], 1e-15),
    ("dump.lammpstrj", &[RADIUS, MASS, MOTION], 4e-15),
];

/// Disc 1 and disc 16 of the configuration, as the files state them.
const FIRST: [f64; 2] = [1.2888384717899477, 1.1825328273845725];
const LAST: [f64; 2] = [1.4788703100681162, 13.171476965812312];
const VELOCITY: [[f64; 2]; 2] = [[-0.23507, 1.214311], [0.82054, 0.094178]];

fn keys_of(method: usize, missing: &[usize], file: &str) -> Vec<&'static str> {
    let is_space = SCENES[method].0 == "nbody";
    let mut keys: Vec<&str> = missing
        .iter()
        .filter(|&&quantity| !(is_space && quantity == RADIUS))
        .map(|quantity| match (*quantity, is_space) {
            (RADIUS, _) => "particles.radius=0.5",
            (MASS, _) => "particles.mass=1.0",
            (_, true) => "particles.virial=0.0",
            (_, false) => "particles.temperature=0.0",
        })
        .collect();
    if file == "lammps_plain.xyz" && !is_space {
        keys.push("domain.sides=[20.0, 20.0]");
    }
    keys
}

#[test]
fn files_of_other_programs_start_every_method() {
    for (file, missing, precision) in CASES {
        for (method, scene) in SCENES.iter().enumerate() {
            let name = format!("{file} by {}", scene.0);
            let path = folder().join(file);
            let prepared = start(method, &path, &keys_of(method, missing, file))
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            let all = prepared.particles().all();
            assert_eq!(all.len(), 16, "{name}");
            for (disc, [x, y], velocity) in [(&all[0], FIRST, VELOCITY[0]), (&all[15], LAST, VELOCITY[1])] {
                let [found_x, found_y, z] = disc.position;
                assert!(
                    (found_x - x).abs() <= precision && (found_y - y).abs() <= precision && z == 0.0,
                    "{name}: {disc:?}"
                );
                let velocity = if missing.contains(&MOTION) { [0.0; 2] } else { velocity };
                assert_eq!(disc.planar_velocity(), velocity, "{name}");
                assert!((disc.mass - 1.0).abs() < 1e-10, "{name}: {disc:?}");
                assert!(scene.0 == "nbody" || disc.radius == 0.5, "{name}: {disc:?}");
            }
            assert_eq!((all[0].id, all[15].id), (1, 16), "{name}");
            assert!(all.iter().all(|disc| disc.kind == ParticleKind::Grain));
        }
    }
}

/// The file of the package gsd 5.0.1 has positions from the centre of its box of 20 × 20, velocities, and neither diameters nor masses.
#[test]
fn gsd_of_the_package_starts_every_method() {
    for (method, scene) in SCENES.iter().enumerate() {
        let file = folder().join("start.gsd");
        let is_space = scene.0 == "nbody";
        for (keys, radius, mass) in [
            (&[][..], 0.5, 1.0),
            (
                if is_space {
                    &["particles.mass=3.0"][..]
                } else {
                    &["particles.mass=3.0", "particles.radius=0.25"]
                },
                0.25,
                3.0,
            ),
        ] {
            let prepared = start(method, &file, keys).unwrap();
            let first = prepared.particles().all()[0];
            let corner = if is_space { 0.0 } else { 10.0 };
            assert_eq!(first.position, [corner - 6.5, corner - 6.5, 0.0]);
            assert_eq!(first.velocity, [0.3455841839313507, 0.8216181397438049, 0.0]);
            assert_eq!(first.mass, mass);
            assert!(is_space || first.radius == radius);
            let defaults = prepared.warnings.iter().filter(|warning| warning.check == "start-file-defaults");
            assert_eq!(
                defaults.count(),
                if mass == 3.0 {
                    0
                } else if is_space {
                    1
                } else {
                    2
                }
            );
        }
        let moved = start(method, &file, &["domain.origin=[-10.0, -10.0]"]);
        assert!(is_space || moved.unwrap().particles().all()[0].position == [-6.5, -6.5, 0.0]);
    }
}

/// All columns and keys are named at once, with the line; a key for what the file has is refused.
#[test]
fn missing_quantities_name_column_line_and_key() {
    let plain = folder().join("lammps_plain.xyz");
    for (method, words) in [
        (0, "lammps_plain.xyz:2 has no radius:R:1, no mass:R:1 (or masses:R:1), no velo:R:3"),
        (0, "`particles.radius`, `particles.mass`, `particles.temperature` are not given"),
        (3, "lammps_plain.xyz:2 has no mass:R:1 (or masses:R:1), no velo:R:3"),
        (3, "`particles.mass`, `particles.virial` are not given"),
    ] {
        let sides: &[&str] = if method == 3 { &[] } else { &["domain.sides=[20.0, 20.0]"] };
        let error = start(method, &plain, sides).err().unwrap();
        assert!(error.contains(words), "{error}");
    }
    let no_box = start(1, &plain, &[]).err().unwrap();
    assert!(no_box.contains("`domain.sides` is missing, and the start file"), "{no_box}");
    let base = folder().join("base.xyz");
    for key in ["particles.radius=0.4", "particles.mass=2.0", "particles.temperature=1.0"] {
        let error = start(0, &base, &[key]).err().unwrap();
        assert!(error.contains("has no effect: the start file"), "{error}");
    }
    let error = start(0, &base, &["particles.seed=3"]).err().unwrap();
    assert!(error.contains("`particles.seed` has no effect"), "{error}");
}

/// Velocities drawn for a file have its temperature where it is asked for exactly: Σ m v²/(2 N − 2) in a periodic box without a bath.
#[test]
fn drawn_velocities_of_files_are_exact() {
    let keys = ["particles.temperature=0.7", "particles.seed=5", "particles.exact_temperature=true"];
    let prepared = start(0, &folder().join("lammps.data"), &keys).unwrap();
    let all = prepared.particles().all();
    let heat: f64 = all.iter().map(|disc| disc.mass * disc.velocity.iter().map(|v| v * v).sum::<f64>()).sum();
    assert!((heat / 30.0 - 0.7).abs() < 1e-14, "{heat}");
    for axis in 0..2 {
        assert!(all.iter().map(|disc| disc.mass * disc.velocity[axis]).sum::<f64>().abs() < 1e-14);
    }
    let drawn = start(0, &folder().join("lammps.data"), &keys[..2]).unwrap();
    let ratios = all.iter().zip(drawn.particles().all()).map(|(a, b)| a.velocity[0] / b.velocity[0]);
    let ratios: Vec<f64> = ratios.collect();
    assert!(ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).abs() < 1e-9), "{ratios:?}");
    assert_eq!(drawn.seed, Some(5));
}

/// A run's own files start another run with its last particles, to the bit (masses of data files: to rounding), or with any frame.
#[test]
fn own_files_start_every_method() {
    for (method, (name, _)) in SCENES.iter().enumerate() {
        let scratch = tempfile::tempdir().unwrap();
        let out = scratch.path().join("o.run");
        let text = start(method, &folder().join("base.xyz"), &[]).unwrap().scene;
        fs::write(scratch.path().join("scene.toml"), &text).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
        command.current_dir(scratch.path()).args([
            "run",
            "scene.toml",
            "--out",
            "o.run",
            "--set",
            "output.gsd=true",
        ]);
        if *name == "hard-disks" {
            command.args(["--set", "run.snapshot_every=0.5"]);
        }
        let mut files = vec!["trajectory.xyz", "trajectory.gsd"];
        if *name != "nbody" {
            command.args(["--set", "output.lammps_dump=true", "--set", "output.lammps_data=true"]);
            files.extend(["dump.lammpstrj", "final.data"]);
        }
        let done = command.output().unwrap();
        assert!(done.status.success(), "{name}: {}", String::from_utf8_lossy(&done.stderr));
        let particles = |file: &str, keys: &[&str]| -> Vec<Particle> {
            start(method, &out.join(file), keys)
                .unwrap_or_else(|error| panic!("{name} {file}: {error}"))
                .particles()
                .all()
                .to_vec()
        };
        let last = particles("trajectory.xyz", &[]);
        let first = particles("trajectory.xyz", &["particles.frame=0"]);
        let at = |all: &[Particle]| all[0].position[0];
        assert!(last.len() == 16 && at(&first) == 1.288_838 && at(&last) != at(&first), "{name}");
        let beyond = start(method, &out.join("trajectory.gsd"), &["particles.frame=99"]).err().unwrap();
        assert!(beyond.contains("there is no frame 99"), "{beyond}");
        for file in files {
            for (disc, expected) in particles(file, &[]).iter().zip(&last) {
                // XYZ has no angle; a data file has densities in the place of masses.
                let disc = Particle { angle: expected.angle, ..*disc };
                let mass = if file == "final.data" { expected.mass } else { disc.mass };
                assert!((disc.mass - expected.mass).abs() < 1e-15, "{name} {file}");
                assert_eq!(Particle { mass, ..disc }, *expected, "{name} {file}");
            }
            if file.ends_with("gsd") || file.ends_with("lammpstrj") {
                assert_eq!(at(&particles(file, &["particles.frame=0"])), at(&first), "{name} {file}");
            }
        }
    }
}

/// Wall discs of this program's files stay wall discs; types of other programs' files are grains.
#[test]
fn walls_are_kept_in_own_files_only() {
    let scratch = tempfile::tempdir().unwrap();
    let own = "LAMMPS data file by stripmine, atom_style sphere, timestep = 0\n\n2 atoms\n2 atom types\n\n0.0 20.0 xlo xhi\n0.0 20.0 ylo yhi\n-0.5 0.5 zlo zhi\n\nAtoms # sphere\n\n1 1 1.0 1.9098593171 3.0 3.0 0.0\n2 2 1.0 1.9098593171 6.0 3.0 0.0\n\nVelocities\n\n1 0.5 0.0 0.0 0.0 0.0 0.25\n2 0.0 0.0 0.0 0.0 0.0 0.0\n";
    for (text, walls) in [(own.to_owned(), 1), (own.replace(" by stripmine", ""), 0)] {
        let path = scratch.path().join("start.data");
        fs::write(&path, text).unwrap();
        let prepared = start(1, &path, &[]).unwrap();
        let all = prepared.particles();
        assert_eq!(all.len() - all.grain_count(), walls);
        assert_eq!((all.all()[0].omega, all.all()[0].velocity), (0.25, [0.5, 0.0, 0.0]));
    }
}

/// Ten styles and shapes of LAMMPS, ASE and others, with hand-made numbers: two particles at (1, 2) and (4, 2), of mass 2 and radius 0.5, with
/// velocities (3, 0) and (0, −1).
#[test]
fn spellings_of_columns_are_understood() {
    let scratch = tempfile::tempdir().unwrap();
    let dump = |columns: &str, rows: &str| {
        format!(
            "ITEM: UNITS\nlj\nITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 10\n0 5\n-2 2\nITEM: ATOMS {columns}\n{rows}\n"
        )
    };
    let data = |atoms: &str, rest: &str| {
        format!(
            "made by hand\n\n 2 atoms # both\n 2 atom types\n 0 bonds\n0 10 xlo xhi\n0 5 ylo yhi\n-2 2 zlo zhi\n0 0 0 xy xz yz\n\n{atoms}\n\nVelocities\n\n2 0 -1 0\n1 3 0 0\n{rest}"
        )
    };
    let masses = "\nMasses\n\n1 2.0 # one\n2 2.0\n";
    let cases = [
        (dump("type id diameter mass xu yu vx vy", "1 1 1.0 2 1 2 3 0\n1 2 1.0 2 4 2 0 -1"), ""),
        (dump("id xs ys zs vx vy vz radius mass ix", "1 0.1 0.4 0.5 3 0 0 0.5 2 0\n2 0.4 0.4 0.5 0 -1 0 0.5 2 1"), ""),
        (dump("id element x y z vx vy vz", "2 Ar 4 2 0.7 0 -1 0\n1 Ar 1 2 0.7 3 0 0"), "particles.mass=2.0 particles.radius=0.5"),
        (data("Atoms # atomic\n\n2 1 4 2 0\n1 2 1 2 0", masses), "particles.radius=0.5"),
        (data("Atoms\n\n2 1 4 2 0 0 0 0\n1 2 1 2 0 0 0 0", masses), "particles.radius=0.5"),
        (data("Atoms # charge\n\n2 1 0.5 4 2 0\n1 2 -0.5 1 2 0", masses), "particles.radius=0.5"),
        (data("Atoms # full\n\n2 1 1 0.5 4 2 0\n1 1 2 -0.5 1 2 0", masses), "particles.radius=0.5"),
        // Masses of balls: density 2/(π/6).
        (data("Atoms # sphere\n\n2 1 1.0 3.819718634205488 4 2 0\n1 1 1.0 3.819718634205488 1 2 0", "\nBonds\n\n1 1 1 2\n"), ""),
        ("2\nLattice=\"10 0 0 0 5 0 0 0 4\" Properties=momenta:R:2:radius:R:1:pos:R:2\n6 0 0.5 1 2\n0 -2 0.5 4 2\n".to_owned(), "particles.mass=2.0"),
        ("2\n\nC 1 2 7.5\nC 4 2 7.5\n".to_owned(), "domain.sides=[10.0, 5.0] particles.mass=2.0 particles.radius=0.5 particles.temperature=0.0"),
    ];
    for (text, keys) in cases {
        let path = scratch.path().join("start.txt");
        fs::write(&path, &text).unwrap();
        let keys: Vec<&str> = keys
            .split("] ")
            .flat_map(|part| match part.contains('[') {
                true => vec![part],
                false => part.split_whitespace().collect(),
            })
            .collect();
        let closed: Vec<String> =
            keys.iter()
                .map(|key| {
                    if key.contains('[') && !key.ends_with(']') {
                        format!("{key}]")
                    } else {
                        (*key).to_owned()
                    }
                })
                .collect();
        let keys: Vec<&str> = closed.iter().map(String::as_str).collect();
        let prepared = start(0, &path, &keys).unwrap_or_else(|error| panic!("{text}\n{error}"));
        let mut all = prepared.particles().all().to_vec();
        all.sort_by_key(|disc| disc.id);
        let is_at_rest = keys.iter().any(|key| key.contains("temperature"));
        let expected = if is_at_rest { [[0.0; 3]; 2] } else { [[3.0, 0.0, 0.0], [0.0, -1.0, 0.0]] };
        for ((disc, x), velocity) in all.iter().zip([1.0, 4.0]).zip(expected) {
            assert_eq!((disc.position, disc.velocity), ([x, 2.0, 0.0], velocity), "{text}");
            assert!((disc.mass - 2.0).abs() < 1e-14 && disc.radius == 0.5, "{text}");
        }
        assert_eq!([0, 1].map(|axis| prepared.domain.length(axis)), [10.0, 5.0], "{text}");
    }
}

/// File, its change, and words of the error.
const BAD: [(&str, &str, &str, &str); 22] = [
    (
        "dump.lammpstrj",
        "16\nITEM: BOX",
        "17\nITEM: BOX",
        ":25: truncated: 16 of the 17 particles that line 4 announces",
    ),
    (
        "dump.lammpstrj",
        "ITEM: ATOMS id type xs ys zs",
        "ITEM: ATOMS id type a b c",
        ":9: there is no column for the position; expected",
    ),
    ("dump.lammpstrj", "2 1 0.27084232970442723", "2 1 nan", ":11:5: the position is `nan`"),
    (
        "dump.lammpstrj",
        "2 1 0.27084232970442723",
        "1 1 0.27084232970442723",
        ":11: id 1 is taken by the particle in line 10",
    ),
    ("dump.lammpstrj", "2 1 0.27084232970442723", "2 1 0.2 0.27084232970442723", ":11: the row has 6 fields"),
    ("dump.lammpstrj", "0 20\n0 20", "0 20 0.5\n0 20 0", ":6:6: the box has the tilt 0.5"),
    ("dump.lammpstrj", "0 20\n0 20", "20 0\n0 20", ":6:4: the upper bound is `0`"),
    ("dump.lammpstrj", "ITEM: NUMBER OF ATOMS\n16\n", "", "expected ITEM: NUMBER OF ATOMS"),
    (
        "dump.lammpstrj",
        "0.06119889083209641 0.5",
        "0.06119889083209641 0.7",
        ":11: z is 0.19999999999999996, but 0 for the first particle",
    ),
    ("lammps.data", "16 atoms", "17 atoms", ": truncated: 16 of the 17 particles that line 3 announces"),
    ("lammps.data", "Atoms # sphere", "Atoms # ellipsoid", ":10: found `ellipsoid`; expected a style"),
    ("lammps.data", "Atoms # sphere", "Atoms", ":12: the row has 10 fields; expected a style"),
    ("lammps.data", "2 1 1.0 1.9", "1 1 1.0 1.9", ":13: id 1 is taken by the particle in line 12"),
    ("lammps.data", "2 1 1.0 1.9", "2 1 -1.0 1.9", ":13:5: the diameter is `-1.0`"),
    ("lammps.data", "2 1 1.0 1.9098593171", "2 1 1.0 x", ":13:9: the density is `x`"),
    ("lammps.data", "0.0 20.0 xlo xhi\n", "", "expected the box (`xlo xhi`, `ylo yhi`)"),
    ("edmd.sph", "16\n", "17\n", ": truncated: 16 of the 17 particles that line 1 announces"),
    (
        "edmd.sph",
        "0.0 0.5\na 5.4",
        "1.0 0.5\na 5.4",
        ":4: z is 0, but 1 for the first particle; expected one z for all, as discs lie in a plane",
    ),
    ("edmd.sph", "1.28883847", "here", ":3:3: the position is `here`"),
    (
        "base.xyz",
        "16\n",
        "frames\n",
        ": the format is not recognised; expected GSD, LAMMPS dump, LAMMPS data, .sph or XYZ (extended or plain)",
    ),
    (
        "lammps_plain.xyz",
        "\n1 1.2888384717899477 1",
        "\n1 0.5 1.2888384717899477 1",
        ":3: the row has 5 fields, and the comment line has no `Properties`",
    ),
    (
        "ase_momenta.xyz",
        "      1.18253283      0.00000000",
        "      1.18253283      0.50000000",
        ":3:42: component z of pos is 0.5",
    ),
];

#[test]
fn bad_files_are_refused_with_their_place() {
    let scratch = tempfile::tempdir().unwrap();
    let refused = |file: &str, bytes: &[u8], words: &str| {
        let path = scratch.path().join(file);
        fs::write(&path, bytes).unwrap();
        let error = start(0, &path, &["particles.temperature=0.0", "particles.mass=1.0"]).err();
        let error = error.unwrap_or_else(|| panic!("{file}: no error, but {words}"));
        let flat = error.replace("\n  expected: ", "; expected ");
        assert!(flat.contains(words), "{words}\n{error}");
    };
    for (file, old, new, words) in BAD {
        let text = fs::read_to_string(folder().join(file)).unwrap();
        assert!(text.contains(old), "{file}: {old}");
        refused(file, text.replacen(old, new, 1).as_bytes(), words);
    }
    for (bytes, name) in [
        (&b"\x54\0\0\0CORD\0\0"[..], "a DCD file"),
        (b"\x1f\x8b\x08\0", "compressed (gzip)"),
        (b"CDF\x01", "a NetCDF file"),
    ] {
        refused("start.bin", bytes, &format!("this is {name}; expected GSD, LAMMPS dump"));
    }
    refused("empty.xyz", b" \n", "the file is empty; expected GSD");
    // GSD: truncated, the box of another shape, a number that is not finite.
    let gsd = fs::read(folder().join("start.gsd")).unwrap();
    refused("start.gsd", &gsd[..5400], "ends at byte");
    refused("start.gsd", &gsd[..100], "the heading ends at byte 256");
    let changed = |at: usize, bytes: &[u8]| {
        let mut gsd = gsd.clone();
        gsd[at..at + bytes.len()].copy_from_slice(bytes);
        gsd
    };
    refused(
        "start.gsd",
        &changed(5405, &f32::NAN.to_le_bytes()),
        "frame 0, particles/position: row 0 is `NaN`",
    );
    refused(
        "start.gsd",
        &changed(5413, &1.0_f32.to_le_bytes()),
        "frame 0, particles/position: row 1 is `0`; expected one z",
    );
    refused(
        "start.gsd",
        &changed(5377 + 12, &0.5_f32.to_le_bytes()),
        "frame 0, configuration/box: row 3 is `0.5`; expected 0",
    );
    refused("start.gsd", &changed(46, &[1]), "expected version 2 of the file layer");
}
