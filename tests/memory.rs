//! Memory of runs: it agrees with the estimate of `scene check`.
#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::{Command, Stdio};
use stripmine_physics::method::{METHODS, load};
use stripmine_physics::ranks::RankBackend;

/// Peak memory (bytes) of a process that ends successfully. A small process starts it and measures: a child of a
/// large process would be reported with at least the memory of its parent.
fn peak(arguments: &[String]) -> u64 {
    const ASK: &str = "import resource as r, subprocess as s, sys; \
                       code = s.call(sys.argv[1:], stdout=s.DEVNULL, stderr=s.DEVNULL); \
                       print(r.getrusage(r.RUSAGE_CHILDREN).ru_maxrss); sys.exit(code)";
    let mut command = Command::new("python3");
    command.args(["-I", "-S", "-c", ASK, env!("CARGO_BIN_EXE_stripmine")]).args(arguments);
    let output = command.output().expect("Python is installed");
    assert!(output.status.success(), "{arguments:?} ends with {:?}", output.status);
    String::from_utf8(output.stdout).unwrap().trim().parse::<u64>().unwrap() * 1024
}

/// Bytes of a frame of a hundred thousand particles.
const FRAME: f64 = 8.8e6;

/// Configurations of a hundred thousand discs, begun and resumed: each takes at most 5 % more than estimated, and the larger of the two at most 5 %
/// and
/// a frame less. The frame is a margin for the thread that writes frames: it may or may not still hold one frame when the next is
/// made, and the estimate counts both.
#[test]
fn runs_take_the_estimated_memory() {
    judged_by(&[
        &["machine.engine=fast", "search.by=lattice", "particles.packing_fraction=0.7"],
        &["machine.execution=chained"],
        &["machine.execution=eager"],
        &["search.by=neighbor-list", "machine.engine=fast"],
        &["search.by=sectors", "machine.engine=fast"],
    ]);
}

/// Further configurations.
#[test]
#[ignore = "long: cargo test --test memory -- --ignored"]
fn rarer_configurations_take_the_estimated_memory() {
    judged_by(&[
        &["machine.engine=fast", "search.by=lattice", "particles.packing_fraction=0.05"],
        &["machine.execution=eager", "machine.precision=mixed", "law.friction=0"],
        &["search.by=neighbor-list", "machine.execution=chained"],
    ]);
}

fn judged_by(settings: &[&[&str]]) {
    let taken =
        |sets: &[&str]| foreseen_and_taken("bench", &[sets, &["particles.count=100000"]].concat(), FRAME);
    let said: Vec<_> = settings.iter().map(|sets| taken(sets)).collect();
    judged(&said);
}

/// Configurations of twelve thousand bodies.
#[test]
fn bodies_take_the_estimated_memory() {
    let mut said = Vec::new();
    for sets in [
        &["machine.engine=fast"][..],
        &["machine.engine=fast", "machine.precision=mixed", "integrator.kind=hermite-4"],
        &["machine.engine=programs"],
    ] {
        let sets = [sets, &["particles.count=12000"]].concat();
        // A frame, and the variation of the program's own memory, which matters for such small runs.
        said.push(foreseen_and_taken("plummer", &sets, 0.25 * FRAME));
    }
    judged(&said);
}

fn judged(said: &[(bool, String)]) {
    let off: Vec<&String> = said.iter().filter(|(fits, _)| !fits).map(|(_, said)| said).collect();
    assert!(off.is_empty(), "{off:#?} of {said:#?}");
}

/// Returns true if a begun and a resumed run take the estimated memory, with a description; `frame` is the size of one more frame (bytes).
/// The program's own memory, measured with a run of a few bodies, is subtracted on both sides: the system chooses how much of the executable
/// is in memory, and this differs by several megabytes between hosts.
fn foreseen_and_taken(preset: &str, sets: &[&str], frame: f64) -> (bool, String) {
    foreseen_and_taken_by(preset, sets, frame, [1, 2])
}

/// Like [`foreseen_and_taken`], for a run that is begun up to the first of two ends and resumed up to the second.
fn foreseen_and_taken_by(preset: &str, sets: &[&str], frame: f64, ends: [u32; 2]) -> (bool, String) {
    let itself = needed_and_most("plummer", &["particles.count=64"], [1, 2]);
    let mut all = needed_and_most(preset, sets, ends);
    // A system that reclaims rarely used memory shows too small a peak: the larger of two tries counts.
    if all.0 - itself.0 > 1.05 * (all.1 - itself.1) + frame {
        all.1 = all.1.max(needed_and_most(preset, sets, ends).1);
    }
    let [needed, most] = [all.0 - itself.0, all.1 - itself.1];
    let fits = (0.95 * most..=1.05 * most + frame).contains(&needed) && (itself.0 - itself.1).abs() < PROGRAM;
    (fits, format!("{sets:?}: {needed} foreseen, {most} taken; the program itself {itself:?}"))
}

/// Bytes by which the program's own memory may differ from its estimate.
const PROGRAM: f64 = 12.0e6;

/// Estimated bytes of a run, and its peak memory, begun or resumed.
fn needed_and_most(preset: &str, sets: &[&str], ends: [u32; 2]) -> (f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let until = if preset == "hard-disks" { "run.events" } else { "run.steps" };
    let with_sets = |words: &[&str], end: u32| {
        let end = format!("{until}={end}");
        let sets =
            sets.iter().copied().chain([end.as_str()]).flat_map(|set| ["--set".to_owned(), set.to_owned()]);
        words.iter().map(|&word| word.to_owned()).chain(sets).collect::<Vec<String>>()
    };
    // `scene check` runs in another process: memory held by this one counts in its children while they start.
    let check = with_sets(&["scene", "check", preset, "--json"], ends[1]);
    let checked = Command::new(env!("CARGO_BIN_EXE_stripmine")).args(check).output().unwrap();
    let checked: serde_json::Value = serde_json::from_slice(&checked.stdout).unwrap();
    let out = folder.path().join("run").display().to_string();
    let taken = [("--overwrite", ends[0]), ("--resume", ends[1])]
        .map(|(how, end)| peak(&with_sets(&["run", preset, how, "--threads", "2", "--out", &out], end)));
    (checked["memory"]["needed"].as_u64().unwrap() as f64, taken[0].max(taken[1]) as f64)
}

/// Discs on several ranks of one process, to a tenth below: the memory kept by allocators of several threads cannot be estimated to the byte.
#[test]
fn ranks_take_the_estimated_memory() {
    for (search, ranks) in [("lattice", 2), ("lattice", 4), ("neighbor-list", 4)] {
        let sets =
            ["particles.count=400000", "run.steps=2", "machine.engine=fast", &format!("search.by={search}")]
                .map(str::to_owned);
        let needed = {
            let (prepared, _) = load("bench", &sets, METHODS).unwrap();
            prepared.memory.for_crew(RankBackend::Threads(ranks)).needed as f64
        };
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run").display().to_string();
        let sets = sets.into_iter().flat_map(|set| ["--set".to_owned(), set]);
        let words =
            ["run", "bench", "--quiet", "--threads", "1", "--ranks", &ranks.to_string(), "--out", &out];
        let most = peak(&words.map(str::to_owned).into_iter().chain(sets).collect::<Vec<String>>()) as f64;
        assert!(
            (0.9 * most..1.25 * most + FRAME).contains(&needed),
            "{search}, {ranks}: {needed} foreseen, {most} taken"
        );
    }
}

/// Particles in a bath with every search.
#[test]
fn langevin_runs_take_the_estimated_memory() {
    let mut said = Vec::new();
    for by in ["search.by=neighbor-list", "search.by=sectors", "search.by=lattice"] {
        let sets = ["particles.count=100000", "domain.sides=[160, 160]", by];
        said.push(foreseen_and_taken("langevin-report", &sets, FRAME));
    }
    judged(&said);
}

/// Discs at earlier rows, stored for displacements, and functions sampled at snapshots.
#[test]
fn structure_samples_take_the_estimated_memory() {
    let mut said = Vec::new();
    for structure in [r#"["msd"]"#, r#"["vacf", "g(r)", "S(k)", "psi6", "velocities"]"#] {
        let structure = format!("output.structure={structure}");
        let sets = [
            "particles.count=100000",
            "run.thermo_every=1",
            "run.snapshot_every=40",
            "output.trajectory=false",
        ];
        let sets = [&sets[..], &[&structure, "output.structure_share=1000.0"]].concat();
        said.push(foreseen_and_taken_by("bench", &sets, FRAME, [40, 80]));
    }
    judged(&said);
}

/// Hard discs with both engines; three times as many, so three frames.
#[test]
fn hard_discs_take_the_estimated_memory() {
    let settings = ["machine.engine=fast", "machine.engine=reference"];
    let said = settings
        .map(|setting| foreseen_and_taken("hard-disks", &["particles.count=300000", setting], 3.0 * FRAME));
    judged(&said);
}

/// A hard disc takes at most 200 bytes at the peak, from reading the scene to the last event: what the program itself takes cancels.
#[test]
fn a_hard_disc_takes_two_hundred_bytes() {
    let taken = |discs: &str| {
        let words = [
            "bench",
            "hard-disks",
            "--steps",
            "1000",
            "--repeats",
            "1",
            "--threads",
            "1",
            "--particles",
            discs,
        ];
        peak(&words.map(str::to_owned)) as f64
    };
    let each = (taken("1000000") - taken("250000")) / 750_000.0;
    assert!(each <= 200.0, "{each} bytes");
}

/// A start takes memory for its particles, not for the box: a thousand positions are drawn from a mesh of two milliard.
#[test]
fn empty_boxes_take_no_memory() {
    let check = ["scene", "check", "langevin-free", "--set", "domain.sides=[4600, 4600]"].map(str::to_owned);
    let taken = peak(&check);
    assert!(taken < 64_000_000, "{taken} bytes");
}

/// Under a limit of the address space or of the data, a run either is refused with a message that names the limit, or completes: it is not
/// aborted half-way, whatever the limit.
#[test]
fn process_limits_are_respected() {
    let folder = tempfile::tempdir().unwrap();
    let under = |limit: &str, scene: &str, sets: &[&str]| {
        let mut command = Command::new("sh");
        let out = folder.path().join("run");
        let script = format!("ulimit {limit} && exec \"$0\" \"$@\"");
        command.args([
            "-c",
            &script,
            env!("CARGO_BIN_EXE_stripmine"),
            "run",
            scene,
            "--overwrite",
            "--threads",
            "2",
        ]);
        command.args(["--out", out.to_str().unwrap(), "--set", "run.snapshot_every=0"]);
        sets.iter().for_each(|set| _ = command.args(["--set", set]));
        let output = command.stdin(Stdio::null()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let langevin = ["particles.count=300000", "domain.sides=[300, 300]", "run.steps=1"];
    let scenes: [(&str, &[&str]); 3] = [
        ("langevin-report", &langevin),
        ("bench", &["particles.count=200000", "run.steps=1"]),
        ("hard-disks", &["particles.count=200000", "run.events=10", "run.snapshot_every=0"]),
    ];
    for (scene, sets) in scenes {
        for (limit, name) in [("-v", "the address space (ulimit -v)"), ("-d", "of a process (ulimit -d)")] {
            let mut codes = vec![];
            for mebibytes in [250, 500, 4000] {
                let (code, said) = under(&format!("{limit} {}", mebibytes * 1024), scene, sets);
                assert!(matches!(code, Some(0 | 3)), "{scene} {limit} {mebibytes}: {code:?} {said}");
                assert!(code == Some(0) || said.contains(name), "{scene} {limit} {mebibytes}: {said}");
                codes.push(code);
            }
            assert_eq!(codes.last(), Some(&Some(0)), "{scene} {limit}");
        }
        let (code, said) = under("-v 204800", scene, sets);
        assert!(code == Some(3) && said.contains(" left"), "{scene}: {code:?} {said}");
    }
}

/// Verbs under limits of the address space: each completes, or fails with a message and a documented exit code; no signal ends it.
#[test]
fn no_limit_of_memory_aborts_a_verb() {
    let folder = tempfile::tempdir().unwrap();
    let under = |mebibytes: Option<u32>, words: &str| {
        let limit =
            mebibytes.map_or(String::new(), |mebibytes| format!("ulimit -v {} && ", mebibytes * 1024));
        let script = format!("rm -rf out; {limit}exec \"$0\" {words} --threads 2");
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_stripmine")]).current_dir(folder.path());
        let output = command.stdin(Stdio::null()).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, said) =
        under(None, "run dense-gas --set run.steps=40 --set run.snapshot_every=10 --quiet --out a.run");
    assert_eq!(code, Some(0), "{said}");
    let mut wrong = vec![];
    for words in [
        "run plummer --set run.steps=5 --out out",
        "run hard-disks --set run.events=100 --out out",
        "run dense-gas --set run.steps=5 --out out",
        "run pipe-small --set run.steps=5 --out out",
        "run langevin-report --set run.steps=5 --out out",
        "run dense-gas --ranks 4 --set particles.count=20000 --set run.steps=5 --out out",
        "run plummer --ranks 4 --set run.steps=5 --out out",
        "run hard-disks --seeds 3 --set run.events=100 --out out",
        "plot a.run --color psi6 --film --out out",
        "average a.run",
        "scene check plummer",
        "bench lattice --particles 20000 --steps 5 --repeats 1",
        "bench lattice --particles 20000 --steps 5 --repeats 1 --ranks 4",
        "bench nbody --particles 512 --steps 5 --repeats 1",
        "compare dense-gas --set particles.count=100000 --set run.steps=5 --against machine.engine=programs",
        "chart stability two-discs --over stiffness --size 3 --seeds 1 --budget 300 --set run.time=1 --out out",
        "table",
    ] {
        for mebibytes in [60, 80, 120, 200, 400, 4000] {
            let (code, said) = under(Some(mebibytes), words);
            // 127: the loader reports that the program does not fit with the libraries of MPI.
            let is_loader = cfg!(feature = "mpi") && code == Some(127);
            let is_told = matches!(code, Some(3 | 5)) && said.contains("memory") || is_loader;
            let is_told = is_told && mebibytes < 4000;
            if !(code == Some(0) || is_told) || said.contains("panicked") {
                wrong.push(format!("{words} in {mebibytes} MiB: {code:?} {said}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Measurements and comparisons check memory before they allocate it: these do not fit into 300 MiB, with some 700 bytes a disc
/// and, for a comparison, two runs at once.
#[test]
fn every_simulating_verb_checks_memory() {
    let folder = tempfile::tempdir().unwrap();
    for words in [
        "bench lattice --particles 500000 --steps 1 --repeats 1 --threads 2",
        "bench lattice --particles 500000 --steps 1 --repeats 1 --threads 1,2",
        "compare dense-gas --set particles.count=200000 --set run.steps=2 --against machine.engine=programs",
        "run bench --set particles.count=500000 --set run.steps=2 --out out",
        // The stacks of 63 more threads.
        "run dense-gas --ranks 8 --threads 8 --set run.steps=2 --out out",
    ] {
        let script = format!("ulimit -v {} && exec \"$0\" {words}", 300 * 1024);
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_stripmine")]).current_dir(folder.path());
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{words}: {said}");
        assert!(said.contains("bytes of memory") && said.contains("(ulimit -v)"), "{words}: {said}");
    }
}

/// Memory of the process while it refuses: a tenth of a gigabyte is far below the request.
#[test]
fn oversized_scenes_are_refused_before_allocation() {
    let folder = tempfile::tempdir().unwrap();
    let gas = "format = 2\nmethod.kind = \"lattice-md\"\nunits = \"reduced\"\n[domain]\nsides = [SIDE, SIDE]\n[particles]\ngenerate = \"random\"\ncount = COUNT\n\
               radius = 0.5\nmass = 1.0\n[law]\nstiffness = 187.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 1\n[machine]\nengine = \"programs\"\n";
    for (side, count, words) in [
        // Two billion discs; and two discs in two billion cells.
        ("1e5", "2e9", ["`particles.count` cannot be the number 2e9", "1 to 268435455"]),
        ("3e4", "2", ["a run of 2 discs in", " left"]),
    ] {
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, gas.replace("SIDE", side).replace("COUNT", count)).unwrap();
        let said = refused(&["scene", "check"], &path);
        assert!(words.iter().all(|words| said.contains(words)), "{said}");
        let said = refused(&["run"], &path);
        assert!(said.contains(words[0]), "{said}");
    }
}

fn refused(verb: &[&str], scene: &Path) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    let output = command.args(verb).arg(scene).current_dir(scene.parent().unwrap()).output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}
