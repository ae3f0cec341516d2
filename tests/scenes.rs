//! Scenes as a user sees them: presets, round trips, overrides, and every bad file with its expected error.

use assert_cmd::Command;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use stripmine_physics::method::lattice_md::{
    ENTRY, GearValues, GranularDocument, GranularScene, GranularScheme,
};
use stripmine_physics::method::{METHODS, load, prepare, vocabularies};
use stripmine_physics::particles;
use stripmine_physics::scene::{DiscStart, Key, KeyValueKind, MistakeKind, SceneValues};

fn stripmine(arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("stripmine").unwrap().args(arguments).output().unwrap()
}

fn bad_scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/bad");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

/// Every bad scene is refused with exit code 3, and its error has the location and words of the leading comments: `# expect:
/// line L column C`, `# expect: words`; `# set: section.key=value` is an override to check it with.
#[test]
fn bad_scenes_are_refused_with_expected_errors() {
    let files = bad_scenes();
    assert!(files.len() >= 42);
    let mut wrong = Vec::new();
    for file in &files {
        let (path, text) = (file.to_str().unwrap(), std::fs::read_to_string(file).unwrap());
        let comments = |kind: &str| -> Vec<String> {
            let comments = text.lines().map_while(|line| line.strip_prefix("# "));
            comments.filter_map(|line| line.strip_prefix(kind)).map(str::to_owned).collect()
        };
        let mut arguments = vec!["scene", "check", path];
        let overrides = comments("set: ");
        overrides.iter().for_each(|text| arguments.extend(["--set", text]));
        let output = stripmine(&arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let expected = comments("expect: ");
        let mut complaints: Vec<String> = Vec::new();
        for words in &expected {
            let place: Vec<&str> = words.split(' ').collect();
            let words = match place.as_slice() {
                ["line", line, "column", column] => format!("{path}:{line}:{column}: "),
                _ => words.clone(),
            };
            if !said.contains(&words) {
                complaints.push(format!("lacks {words:?}"));
            }
        }
        let named = said.contains(path) || !overrides.is_empty();
        if expected.is_empty() || output.status.code() != Some(3) || !named || !output.stdout.is_empty() {
            complaints.push(format!("ends with {:?}", output.status.code()));
        }
        if said.contains("panicked") || !complaints.is_empty() {
            wrong.push(format!("{path}: {}\n{said}", complaints.join(", ")));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n\n{}", wrong.len(), files.len(), wrong.join("\n\n"));
}

/// Presets pass the check; the one that is meant to fail has a warning about its softness.
#[test]
fn presets_pass_the_check() {
    for preset in ENTRY.vocabulary.presets {
        let checked = GranularDocument::load(preset.name, &[]).and_then(GranularDocument::check);
        let checked = checked.unwrap_or_else(|errors| panic!("{}: {errors}", preset.name));
        let soft = checked.warnings.iter().filter(|warning| warning.key == "law.stiffness").count();
        assert_eq!(checked.warnings.len(), soft, "{}", preset.name);
        assert_eq!(soft > 0, preset.name == "pipe-as-printed", "{}", preset.name);
        assert!(preset.title().len() > 20 && !checked.particles.is_empty());
        if checked.scene.needs_lattice() {
            assert!((0.0..0.5).contains(&checked.geometry.occupancy));
            let [dx, dy] = checked.geometry.frame.edge;
            let [smallest, largest] = checked.geometry.radii;
            assert!(dx.min(dy) >= largest && dx.hypot(dy) <= 0.9 * 2.0 * smallest * (1.0 + 1e-12));
        }
        let ids: Vec<u32> = checked.particles.all().iter().map(|disc| disc.id).collect();
        assert!(ids.iter().copied().eq(1..=ids.len() as u32));
        let again = GranularScene::load(preset.name).unwrap().check().unwrap();
        assert_eq!(again, checked, "{}", preset.name);
    }
}

/// The pipe has the numbers of the table "A complete set that was tried".
#[test]
fn pipe_has_the_tried_numbers() {
    for (name, grains, walls) in [("pipe", 596, 600), ("pipe-small", 238, 240)] {
        let checked = GranularScene::load(name).unwrap().check().unwrap();
        let discs = &checked.particles;
        assert_eq!((discs.grain_count(), discs.len() - discs.grain_count()), (grains, walls));
        let lining = &discs.all()[grains..];
        for (i, disc) in lining.iter().enumerate() {
            let upper = i >= walls / 2;
            let along = (i % (walls / 2)) as f64 + if upper { 0.5 } else { 0.0 };
            assert!((disc.position[0] - 0.027 * along).abs() < 1e-9 && disc.radius == 0.009);
            assert!((disc.position[1] - if upper { 0.0365 } else { -0.0365 }).abs() < 1e-12);
            assert_eq!((disc.kind, disc.velocity), (particles::ParticleKind::Wall, [0.0; 3]));
        }
        let speeds: f64 = discs.grains().iter().map(|d| d.velocity[0].powi(2) + d.velocity[1].powi(2)).sum();
        assert!(((speeds / (2.0 * grains as f64)).sqrt() / 0.3 - 1.0).abs() < 0.1);
        for disc in discs.grains() {
            assert!((disc.mass - 1e-6 * (disc.radius / 0.01).powi(2)).abs() < 1e-18);
        }
        // An even start: counts in bins of 20 radii vary far less than Poisson's.
        let bins = (checked.domain.length(0) / 0.2) as usize;
        let mut counts = vec![0.0; bins];
        discs.grains().iter().for_each(|disc| counts[(disc.position[0] / 0.2) as usize % bins] += 1.0);
        let mean = grains as f64 / checked.domain.length(0) * 0.2;
        let variance = counts[..bins].iter().map(|count| (count - mean).powi(2)).sum::<f64>() / bins as f64;
        assert!(variance / mean < 0.4, "{name}: {}", variance / mean);
    }
}

/// BP93's cells, d = R_max, are 736 × 8.
#[test]
fn cells_of_the_paper_can_be_set() {
    let scene = GranularScene::load("pipe").unwrap().with_overrides(&["search.cell_edge=0.011"]).unwrap();
    let geometry = scene.check().unwrap().geometry;
    assert_eq!((geometry.shape.columns(), geometry.shape.rows()), (736, 8));
    let fewest = GranularScene::load("pipe").unwrap().check().unwrap().geometry;
    assert!(fewest.shape.cells() < geometry.shape.cells());
}

/// Keys that no preset and no scene of the gallery sets, each with its purpose.
const NOT_SHOWN: [(&str, &str); 43] = [
    ("integrator.damping", "the friction of the paper's integrator, which the item of energies varies"),
    ("integrator.on_long_step", "a run continues with rare too-fast discs, which thermo.csv counts"),
    ("integrator.tolerance", "the default of adaptive steps is accurate to rounding"),
    ("law.contact_arm", "contacts as in LAMMPS, for comparison"),
    ("law.file", "a pair potential of the user, which is a file of its own"),
    ("law.gravitational_constant", "units in which G is not 1"),
    ("law.inertia", "spheres that move in a plane; studies of stability vary it"),
    ("law.max_penetration", "soft contacts; studies of stability vary it"),
    ("law.noise_seed", "independent replicas of one start"),
    ("law.screening", "charges in a solvent, which repel over a screening length"),
    ("law.stop_penetration", "soft contacts, together with max_penetration"),
    ("law.wall_restitution", "walls of another material"),
    ("machine.arithmetic", "fast inverse roots, which the item of rates compares"),
    ("machine.coordinates", "positions as in the paper; the study of precision compares them"),
    ("machine.instruction_set", "the same bits on other processors"),
    ("output.collisions", "free flights and impulses, which the item of structure reads"),
    ("output.dcd", "for programs that read DCD"),
    ("output.gsd", "for programs that read GSD"),
    ("output.lammps_data", "a run that LAMMPS continues"),
    ("output.lammps_dump", "for programs that read dumps"),
    ("output.losses", "no table where many particles may be lost"),
    ("output.structure_bins", "wider or narrower bins of g(r)"),
    ("output.structure_range", "pairs farther apart than four diameters"),
    ("output.structure_share", "all rows and snapshots of a small system"),
    ("output.trajectory", "no text if another format is written"),
    ("particles.exact_temperature", "the temperature of a small start to all digits"),
    ("particles.expansion", "a sphere or shell that expands"),
    ("particles.file", "a start from another program, or from a frame"),
    ("particles.frame", "a start from the middle of a trajectory"),
    ("particles.mass_ratio", "two bodies of different masses"),
    ("particles.masses", "listed discs of several materials"),
    ("particles.second_radius", "binary mixtures, which do not crystallise"),
    ("particles.second_share", "the composition of binary mixtures"),
    ("run.most_lost", "losses as in the paper, which the item of losses counts"),
    ("run.until", "a run that ends at a target error"),
    ("search.cell_edge", "cells of the paper, which studies of searches compare"),
    ("search.discs_in_cell", "linked cells of ISO99's rival, whose size a study compares"),
    ("search.mask", "masks of the papers, which the item of masks compares"),
    ("search.on_conflict", "cells that hold several discs"),
    ("search.rebuild", "lists by all pairs, as in the paper"),
    ("search.sectors", "sectors of the paper's size"),
    ("search.skin", "lists that are tuned by hand"),
    ("search.sort", "sorting at every step, as in the paper"),
];

/// A key that no scene of ours sets has a stated purpose, and no other key is listed.
#[test]
fn every_key_is_shown_or_explained() {
    let gallery = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gallery")).unwrap();
    let gallery = gallery.map(|file| file.unwrap().path());
    let gallery = gallery.filter(|file| file.extension().is_some_and(|extension| extension == "toml"));
    let presets = METHODS.iter().flat_map(|method| method.vocabulary.presets);
    let presets = presets.map(|preset| preset.text.to_owned());
    let mut shown = BTreeSet::new();
    for text in presets.chain(gallery.map(|file| std::fs::read_to_string(file).unwrap())) {
        for (section, keys) in text.parse::<toml::Table>().unwrap() {
            let keys = keys.as_table().map_or(vec![], |keys| keys.keys().cloned().collect());
            shown.extend(keys.iter().map(|key| format!("{section}.{key}")));
            shown.insert(section);
        }
    }
    let keys = METHODS.iter().flat_map(|method| method.vocabulary.keys.keys());
    let hidden: BTreeSet<String> = keys.map(Key::path).filter(|path| !shown.contains(path)).collect();
    let listed: BTreeSet<String> = NOT_SHOWN.iter().map(|(path, _)| (*path).to_owned()).collect();
    assert_eq!(hidden, listed);
    assert!(NOT_SHOWN.iter().all(|(_, why)| why.split(' ').count() > 3));
}

/// A scene written by `to_toml` is read back as an equal one, for every preset and for scenes that use every other key.
#[test]
fn written_scenes_are_read_back() {
    let two = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/bad/two.xyz");
    let file = format!("particles.file=\"{}\"", two.display());
    let variants: Vec<(&str, Vec<&str>)> = vec![
        ("pipe", vec!["search.by=neighbor-list", "search.skin=0.003", "search.rebuild=all-pairs"]),
        ("pipe", vec!["search.mask=7", "search.cell_edge=0.0112", "particles.count=10", "run.steps=7"]),
        (
            "bench",
            vec![
                "machine.execution=strip:64",
                "machine.precision=mixed",
                "particles.seed=18446744073709551615",
            ],
        ),
        ("bench", vec!["machine.engine=fast", "search.by=lattice", "integrator.kind=velocity-verlet"]),
        (
            "bench",
            vec!["machine.execution=eager", "machine.instruction_set=scalar", "law.contact_arm=overlap"],
        ),
        ("two-discs", vec!["particles.radii=[0.5, 0.45]", "particles.wall_positions=[[1.0, 1.0]]"]),
        ("two-discs", vec!["units=\"quotes \\\" and \\\\\"", "law.cohesionless=false", "law.inertia=sphere"]),
        (
            "dense-gas",
            vec!["particles.generate=random", "particles.packing_fraction=0.3", "domain.sides=[30, 30]"],
        ),
        (
            "shaken-box",
            vec!["particles.wall_motion=fixed", "machine.coordinates=absolute", "output.lammps_dump=true"],
        ),
        ("two-discs", vec![&file, "domain.sides=[10.0, 8.0]", "domain.periodic=[true, true]"]),
    ];
    let presets = ENTRY.vocabulary.presets.iter().map(|preset| (preset.name, Vec::new()));
    for (name, overrides) in presets.chain(variants) {
        let scene = GranularScene::load(name).unwrap();
        let scene = scene.with_overrides(&overrides).unwrap_or_else(|e| panic!("{name} {overrides:?}: {e}"));
        let text = scene.to_toml();
        let again = GranularScene::parse("elsewhere/scene.toml", &text)
            .unwrap_or_else(|e| panic!("{name}: {e}\n{text}"));
        assert_eq!(again, scene, "{name} {overrides:?}");
        assert_eq!(again.to_toml(), text);
        again.check().unwrap_or_else(|errors| panic!("{name} {overrides:?}: {errors}"));
    }
}

/// An override replaces a value, and drops values that it excludes or makes meaningless.
#[test]
fn overrides_replace_conflicting_values() {
    let load = |name: &str, overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        GranularDocument::load(name, &overrides).map(|document| document.scene)
    };
    let scene = load("pipe", &["run.steps=50", "law.friction=0", "particles.count=7"]).unwrap();
    assert_eq!((scene.run.steps, scene.law.contact.friction), (50, 0.0));
    assert!(matches!(
        scene.start,
        DiscStart::Pipe { amount: stripmine_physics::scene::Amount::Count(7), .. }
    ));
    assert_eq!(load("pipe", &["run.time=0.01"]).unwrap().run.steps, 100);
    // Two overrides that exclude each other are an error.
    assert!(load("pipe", &["run.time=0.01", "run.steps=3"]).is_err());
    // A hexagonal start needs both, so there they do not exclude each other.
    let bench = load("bench", &["particles.count=500", "integrator.values=6"]).unwrap();
    let DiscStart::Hexagonal { count, packing_fraction, .. } = bench.start else { panic!() };
    assert_eq!(
        (count, packing_fraction, bench.integrator.scheme),
        (500, 0.6, GranularScheme::Gear(GearValues::Six))
    );
    // Numbers, words with and without quotes.
    let scene = load("pipe", &["machine.precision=f32", "machine.coordinates=\"absolute\""]).unwrap();
    assert_eq!(scene.machine.precision, stripmine_physics::scene::Precision::F32);
    // An override corrects a mistake of the file.
    let preset = ENTRY.vocabulary.presets.iter().find(|preset| preset.name == "two-discs").unwrap();
    let broken = preset.text.replace("dt = 1e-3", "dt = -1");
    assert!(GranularScene::parse("broken", &broken).is_err());
}

/// The path of a start file is relative to its scene.
#[test]
fn start_file_paths_are_relative_to_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let bad = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/bad");
    std::fs::copy(bad.join("two.xyz"), folder.path().join("two.xyz")).unwrap();
    let good = std::fs::read_to_string(bad.join("start-file-of-another-box.toml")).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, good.replace("[20.0, 20.0]", "[10.0, 8.0]")).unwrap();
    let checked =
        GranularDocument::load(path.to_str().unwrap(), &[]).and_then(GranularDocument::check).unwrap();
    assert_eq!(checked.particles.len(), 2);
    assert_eq!(checked.particles.all()[0].velocity, [1.0, 0.0, 0.0]);
    assert!(checked.alike);
}

/// Ids from 0 are raised by one, with a warning; ids from 1 cause none.
#[test]
fn raised_ids_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let (start, path) = (folder.path().join("start.xyz"), folder.path().join("scene.toml"));
    let head = "Lattice=\"10.0 0 0 0 8.0 0 0 0 1\" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";
    for (method, law) in [
        ("lattice-md", "[law]\nstiffness = 100.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 1\n"),
        ("hard-disks", "[run]\ntime = 1.0\n"),
        (
            "langevin",
            "[law]\nkind = \"none\"\ndrag = 1.0\nbath_temperature = 1.0\n[integrator]\ndt = 0.01\n[run]\nsteps = 1\n",
        ),
    ] {
        for first in [0, 1] {
            let row = |id: u32| format!("Si {}.0 4.0 0.0 {id} 0.5 0.0 0.0 0.5 1.0 0.0 0.0 0.0\n", 2 + 3 * id);
            std::fs::write(&start, format!("2\n{head}\n{}{}", row(first), row(first + 1))).unwrap();
            let scene = format!(
                "format = 2\nmethod.kind = \"{method}\"\nunits = \"reduced\"\n[domain]\nsides = [10.0, 8.0]\n[particles]\nfile = \"start.xyz\"\n{law}"
            );
            std::fs::write(&path, scene).unwrap();
            let (prepared, _) =
                stripmine_physics::method::load(path.to_str().unwrap(), &[], METHODS).unwrap();
            let ids: Vec<u32> = prepared.particles().all().iter().map(|disc| disc.id).collect();
            assert_eq!(ids, [1, 2], "{method}");
            let said = prepared
                .warnings
                .iter()
                .filter(|it| it.message.contains("begin at 0; each is raised by one"));
            assert_eq!(said.count(), usize::from(first == 0), "{method} {first}: {:?}", prepared.warnings);
        }
    }
}

/// A truncated or altered scene gives a scene or errors, never a panic.
#[test]
fn damaged_scenes_never_panic() {
    for preset in ENTRY.vocabulary.presets {
        let bytes = preset.text.as_bytes();
        for at in (0..bytes.len()).step_by(7) {
            let _ = GranularScene::parse("cut", &String::from_utf8_lossy(&bytes[..at]));
            let mut flipped = bytes.to_vec();
            flipped[at] ^= 1 << (at % 7);
            let _ = GranularScene::parse("flipped", &String::from_utf8_lossy(&flipped));
        }
    }
    for text in [
        "",
        "\u{feff}",
        "=",
        "[",
        "[[]]",
        "a.b.c = 1",
        "format.x = 1",
        "law = { stiffness = {} }",
        "\0",
        "é = 1",
    ] {
        assert!(GranularScene::parse("odd", text).is_err(), "{text:?}");
    }
    let deep = format!("x = {}", "[".repeat(100_000));
    assert!(GranularScene::parse("deep", &deep).is_err());
}

/// Numbers at the ends of the number format give a scene or errors, in finite time and memory.
#[test]
fn extreme_numbers_never_panic() {
    for (preset, few) in [
        ("pipe-small", "particles.count=20"),
        ("shaken-box", "particles.count=9"),
        ("dense-gas", "particles.count=64"),
        ("two-discs", "run.steps=1"),
    ] {
        for key in ENTRY.vocabulary.keys.keys() {
            let shapes: &[&str] = match key.kind {
                KeyValueKind::Number(_) | KeyValueKind::Whole(..) => &["{}"],
                KeyValueKind::Pair(_) => &["[{}, 1.0]", "[1.0, {}]"],
                KeyValueKind::Pairs => &["[[{}, 1.0], [1.0, {}]]"],
                KeyValueKind::Numbers(_) => &["[{}, 1.0]"],
                _ => continue,
            };
            for (extreme, shape) in ["0", "5e-324", "1e-308", "1e-30", "1e20", "1e308", "-1e308", "-0.0"]
                .iter()
                .flat_map(|extreme| shapes.iter().map(move |shape| (extreme, shape)))
            {
                let set = format!("{}={}", key.path(), shape.replace("{}", extreme));
                if let Ok(checked) =
                    GranularDocument::load(preset, &[few.to_owned(), set]).and_then(GranularDocument::check)
                {
                    assert_eq!(
                        GranularScene::parse("again", &checked.scene.to_toml()).unwrap(),
                        checked.scene
                    );
                }
            }
        }
    }
}

/// Scenes that do not exist, are not text, or are not readable.
#[test]
fn unreadable_scenes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"format = 2\nmethod.kind = \"lattice-md\"\nunits = \"\xff\xfe\"\n").unwrap();
    let (folder, binary) = (folder.path().to_str().unwrap(), binary.to_str().unwrap());
    for (scene, words) in [
        ("pipe-smal", &["pipe-smal", "no such preset", "did you mean pipe-small?", "shaken-box"][..]),
        ("no/such/file.toml", &["no/such/file.toml", "no such file", "two-discs"]),
        (folder, &[folder, "cannot be read"]),
        (binary, &["binary.toml:3:", "UTF-8"]),
    ] {
        let output = stripmine(&["scene", "check", scene]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    }
    let errors = GranularScene::load("no-such").unwrap_err();
    assert_eq!(errors.0[0].reason, MistakeKind::Unreadable);
}

/// The verbs of scenes print text and data.
#[test]
fn scene_verbs_print_presets_keys_and_checks() {
    let json = |arguments: &[&str]| -> serde_json::Value {
        let output = stripmine(arguments);
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{arguments:?}"))
    };
    let list = json(&["scene", "list", "--json"]);
    let all: usize = METHODS.iter().map(|method| method.vocabulary.presets.len()).sum();
    assert_eq!(list.as_array().unwrap().len(), all);
    assert!(all > ENTRY.vocabulary.presets.len());
    let shown = stripmine(&["scene", "show", "two-discs"]);
    assert!(GranularScene::parse("shown", &String::from_utf8(shown.stdout).unwrap()).is_ok());
    assert_eq!(stripmine(&["scene", "show", "three-discs"]).status.code(), Some(2));
    let keys = json(&["scene", "keys", "--json"]);
    // Keys of tables such as [[walls]] have lines of their own.
    assert_eq!(keys.as_array().unwrap().len(), ENTRY.vocabulary.keys.keys_and_fields().count());
    let table = String::from_utf8(stripmine(&["scene", "keys"]).stdout).unwrap();
    assert!(ENTRY.vocabulary.keys.keys().all(|key| table.contains(key.name)));
    // A word that is no method: keys of all methods, each once.
    let seeds = json(&["scene", "keys", "packing", "--json"]);
    let seeds = seeds.as_array().unwrap();
    assert!(seeds.iter().any(|key| key["key"] == "packing_fraction" && key["section"] == "particles"));
    assert!(seeds.iter().all(|key| !key["methods"].as_array().unwrap().is_empty()), "{seeds:?}");
    assert_eq!(stripmine(&["scene", "keys", "qwertz"]).status.code(), Some(2));
    let found = json(&[
        "scene",
        "check",
        "pipe-small",
        "--json",
        "--set",
        "particles.seed=4",
        "--set",
        "search.by=lattice",
    ]);
    assert_eq!((found["grains"].as_u64(), found["rows"].as_u64()), (Some(238), Some(8)));
    let warned = stripmine(&["scene", "check", "pipe-as-printed"]);
    assert!(warned.status.success());
    assert!(String::from_utf8_lossy(&warned.stderr).contains("presses it 0.1"));
    assert!(stripmine(&["scene", "check", "pipe-as-printed", "--quiet"]).stderr.is_empty());
    // Above the limit of a dense packing, but below that of a single contact at the typical speed, which is √3 times larger: a warning says so.
    let borne = stripmine(&["scene", "check", "pipe-small", "--set", "integrator.dt=2e-4"]);
    let said = String::from_utf8_lossy(&borne.stderr).into_owned();
    assert!(
        borne.status.success() && said.contains("1.36 times the limit") && said.contains("1.73 times"),
        "{said}"
    );
    // SI scenes have symbols, and other scenes have numbers alone.
    let has_symbols = |name: &str| {
        let said = stripmine(&["scene", "check", name]);
        let said = String::from_utf8_lossy(&said.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
        ["3.24 × 0.088 m ", " m/s ", "of 1e-4 s, 2 s "].map(|symbol| said.contains(symbol))
    };
    assert_eq!([has_symbols("pipe-small"), has_symbols("two-discs")], [[true; 3], [false; 3]]);
    let refused = stripmine(&["scene", "check", "pipe", "--set", "law.friction=-1", "--json"]);
    assert_eq!(refused.status.code(), Some(3));
    let data: serde_json::Value = serde_json::from_slice(&refused.stdout).unwrap();
    assert_eq!(data["errors"][0]["reason"], "range");
    for (overrides, words) in [
        (&["integrator.values=6"][..], &["1.96 times the limit 5.0894e-5 s (dense packing)"][..]),
        (&["integrator.dt=3e-4"], &["2.04 times the limit 1.4727e-4 s (dense packing)"]),
        (&["law.shear_damping=0"], &["law.friction: "]),
        (&["law.friction=0"], &["law.shear_damping has no effect"]),
        (&["machine.precision=f32", "integrator.dt=4e-9"], &["single precision are rounded"]),
    ] {
        let mut arguments = vec!["scene", "check", "pipe-small"];
        overrides.iter().for_each(|text| arguments.extend(["--set", text]));
        let output = stripmine(&arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && words.iter().all(|word| said.contains(word)), "{said}");
    }
}

/// Defaults follow from given values: the cut of radii from their spread, wall discs from the grains.
#[test]
fn defaults_follow_from_given_values() {
    let scene = |spread: f64| {
        let text = format!(
            "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"reduced\"\n[domain]\nsides = [30.0, 20.0]\n\
             periodic = [true, false]\n[particles]\ngenerate = \"pipe\"\ncount = 9\nradius = 0.5\nradius_spread = {spread}\n\
             mass = 1.0\nclear_width = 6.0\n[law]\nstiffness = 100.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 1\n"
        );
        GranularScene::parse("scene.toml", &text).unwrap()
    };
    for (spread, cut) in [(0.0, 0.0), (0.03, 0.06), (0.2, 0.12)] {
        let DiscStart::Pipe { grains, lining, .. } = scene(spread).start else { panic!("a pipe") };
        assert!((grains.cut - cut).abs() < 1e-15, "{spread}: {}", grains.cut);
        assert!((lining.radius - 0.45).abs() < 1e-15 && (lining.spacing - 1.35).abs() < 1e-15, "{lining:?}");
    }
    let listed = "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"reduced\"\n[domain]\nsides = [9.0, 9.0]\n[particles]\n\
                  generate = \"list\"\npositions = [[2.0, 2.0]]\nwall_positions = [[6.0, 6.0]]\nradius = 0.5\nmass = 1.0\n\
                  [law]\nstiffness = 100.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 1\n";
    let DiscStart::List(list) = GranularScene::parse("scene.toml", listed).unwrap().start else {
        panic!("a list")
    };
    assert!((list.wall_radius - 0.45).abs() < 1e-15 && list.radii == [0.5] && list.velocities == [[0.0; 2]]);
}

/// Scenes that a run writes are valid scenes, for every preset of every method.
#[test]
fn resolved_scenes_are_valid_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("again.toml");
    let file = file.to_str().unwrap();
    for preset in METHODS.iter().flat_map(|method| method.vocabulary.presets) {
        let (prepared, _) = stripmine_physics::method::load(preset.name, &[], METHODS).unwrap();
        std::fs::write(file, &prepared.scene).unwrap();
        let (again, _) = stripmine_physics::method::load(file, &[], METHODS)
            .unwrap_or_else(|errors| panic!("{}: {errors}", preset.name));
        assert_eq!(again.scene, prepared.scene, "{}", preset.name);
    }
}

/// A warning is given if a grain flies, or falls, out of an open side before the end of the run. By hand: from x = 3 at speed 1 to 12, and from y = 4
/// by gt²/2 to 0.
#[test]
fn grains_leaving_open_sides_cause_a_warning() {
    let strip = "domain.periodic=[true, false]";
    let falls = "domain.gravity=[0.0, -0.1]";
    for (time, more, is_warned) in [
        ("8.9", &[][..], false),
        ("9.1", &[], true),
        ("9.1", &[strip], false),
        ("8.9", &[strip, falls], false),
        ("9.0", &[strip, falls], true),
        ("9.1", &["particles.wall_positions=[[6.0, 0.5]]"], false),
    ] {
        let time = format!("run.time={time}");
        let mut arguments = vec!["scene", "check", "two-discs", "--set", &time];
        more.iter().for_each(|set| arguments.extend(["--set", set]));
        let output = stripmine(&arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {said}");
        assert_eq!(
            said.contains("domain.periodic: sides that are not periodic do not confine discs"),
            is_warned,
            "{said}"
        );
    }
}

/// Facts keep their precision in any unit of length: discs of 1.25 nm in a box of 40 nm × 30 nm, in metres.
#[test]
fn facts_keep_precision_in_any_unit() {
    let small = [
        "particles.generate=random",
        "particles.count=4",
        "particles.radius=1.25e-9",
        "domain.sides=[4e-8, 3e-8]",
    ];
    for (preset, expected) in [
        ("hard-disks", &[("radii", "1.25e-9 to 1.25e-9"), ("box", "4e-8 × 3e-8")][..]),
        ("langevin-free", &[("box", "4e-8 × 3e-8")]),
    ] {
        let (prepared, _) =
            load(preset, &small.map(str::to_owned), METHODS).unwrap_or_else(|why| panic!("{preset}: {why}"));
        let facts: Vec<&(&str, String)> =
            prepared.facts.iter().filter_map(|fact| fact.words.as_ref()).collect();
        for (label, words) in expected {
            assert!(facts.iter().any(|fact| fact.0 == *label && fact.1 == *words), "{label}: {facts:?}");
        }
    }
}

/// Number and packing fraction give the box in every generator: N π r² over the open area, by hand.
#[test]
fn count_and_packing_fraction_give_the_box() {
    let head = "format = 2\nunits = \"reduced\"\n[method]\nkind = \"lattice-md\"\n[law]\nstiffness = 100.0\n[integrator]\ndt = 0.001\n\
                [run]\nsteps = 1\n[particles]\ncount = 80\npacking_fraction = 0.4\nradius = 0.5\nmass = 1.0\n";
    let area = 80.0 * std::f64::consts::PI * 0.25 / 0.4;
    for (generate, more, sides) in [
        ("random", "", [area.sqrt(); 2]),
        ("compressed", "", [area.sqrt(); 2]),
        ("mesh", "spacing = 1.0\n", [area.sqrt(); 2]),
        ("pipe", "clear_width = 5.0\nwall_radius = 0.5\n", [area / 5.0, 7.0]),
        ("box", "fill_height = 8.0\nwall_radius = 0.5\n", [area / 8.0, 10.0]),
    ] {
        let periodic = if more.contains("wall") {
            "domain.periodic=[true, false]"
        } else {
            "domain.periodic=[true, true]"
        };
        let text = format!("{head}generate = \"{generate}\"\n{more}");
        let overrides = [periodic.to_owned()];
        let values = SceneValues::parse("scene", &text, &overrides, &vocabularies(METHODS)).unwrap();
        let (prepared, _) = prepare(values, METHODS).unwrap_or_else(|error| panic!("{generate}: {error}"));
        for (axis, side) in sides.iter().enumerate() {
            assert!((prepared.domain.length(axis) / side - 1.0).abs() < 1e-14, "{generate}");
        }
        assert_eq!(prepared.particles().grain_count(), 80, "{generate}");
        // The written scene has no sides either, and gives the same discs.
        let values = SceneValues::parse("again", &prepared.scene, &[], &vocabularies(METHODS)).unwrap();
        assert_eq!(prepare(values, METHODS).unwrap().0.particles(), prepared.particles(), "{generate}");
        let one = format!("{head}generate = \"{generate}\"\n{more}").replace("count = 80\n", "");
        let error =
            SceneValues::parse("scene", &one, &overrides, &vocabularies(METHODS)).unwrap_err().to_string();
        assert!(error.contains("`domain.sides` is missing"), "{error}");
    }
}
