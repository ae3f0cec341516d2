//! Table of promises over all methods: it covers every method of a list, with all its presets and engines.
//!
//! A shortened scene is run whole; interrupted at random moments and resumed; killed and resumed. Every file has
//! as many frames and rows as the scene states, ends with the final state, and has the same bytes each time; so has the summary, except for times.

use super::configurations::configurations;
use super::files::{GsdFrame, Places, TextFrame, dcd, extended_xyz, gsd, lammps_dump, table};
use super::short::{end_of, moments, shortened};
use rand::RngExt;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use stripmine::provenance::built;
use stripmine_kernels::noise::{RandomPurpose as Of, Stream};
use stripmine_physics::io::FORMATS;
use stripmine_physics::io::extxyz::ParticleFrame;
use stripmine_physics::io::output_format::FrameWriting;
use stripmine_physics::io::trajectory::FrameReading;
use stripmine_physics::method::{Every, MethodEntry, Methods, Prepared, Schedule, load};
use stripmine_physics::particles::Particles;
use stripmine_physics::run::{Ending, ExistingRun, RunJob, run};

/// Part of the table that is tested.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// Every preset with its default settings, with all tests; every other engine of a method on one preset, whole and interrupted.
    Quick,
    /// Everything, at twenty times as many moments.
    Full,
}

/// Cases that run at a time: most of the time is spent waiting for files to reach the disk.
const AT_A_TIME: usize = 6;

/// Files of a run with all outputs, in addition to those of the formats.
const FILES: [&str; 3] = ["thermo.csv", "events.csv", "scene.toml"];
/// Entries of a summary that belong to one session.
const OF_THE_SESSION: [&str; 5] = ["begun", "ended", "seconds", "phases", "notes"];

/// A shortened scene with one configuration.
struct Case {
    entry: &'static MethodEntry,
    preset: &'static str,
    overrides: Vec<String>,
    /// True for the preset's default settings; their pictures and messages are tested too.
    is_plain: bool,
}

/// Numbers of tested cases.
#[derive(Debug, Default)]
pub struct Held {
    pub presets: usize,
    pub engines: usize,
    pub runs: usize,
    pub sessions: usize,
    pub killed: usize,
    pub frames: usize,
    pub rows: usize,
    pub files: usize,
    pub pictures: usize,
}

/// Tests the table for some methods; `command` is the program with these methods.
pub fn hold(methods: Methods, command: fn() -> Command, extent: Extent) -> Held {
    let cases: Vec<Case> = methods.iter().flat_map(|entry| cases(methods, entry, extent)).collect();
    let presets: BTreeSet<&str> = cases.iter().map(|case| case.preset).collect();
    let held = Held { presets: presets.len(), engines: cases.len(), ..Held::default() };
    let (next, held) = (AtomicUsize::new(0), Mutex::new(held));
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let found = case.hold(methods, command, extent);
                    held.lock().expect("no case panicked").add(&found);
                }
            });
        }
    });
    held.into_inner().expect("no case panicked")
}

impl Held {
    fn add(&mut self, other: &Held) {
        self.runs += other.runs;
        self.sessions += other.sessions;
        self.killed += other.killed;
        self.frames += other.frames;
        self.rows += other.rows;
        self.files += other.files;
        self.pictures += other.pictures;
    }
}

/// Every preset of a method, with every engine and every search that the scene allows.
fn cases(methods: Methods, entry: &'static MethodEntry, extent: Extent) -> Vec<Case> {
    let configurations = configurations(entry, &[("machine", "precision")]);
    let (mut cases, mut seen) = (vec![], BTreeSet::new());
    for preset in entry.vocabulary.presets {
        let short = shortened(methods, entry, preset.name);
        let mut scenes = BTreeSet::new();
        for configuration in &configurations {
            let overrides = [short.clone(), configuration.clone()].concat();
            let Ok((prepared, _)) = load(preset.name, &overrides, methods) else { continue };
            let is_plain = configuration.is_empty();
            let is_new = scenes.insert(prepared.scene);
            if is_plain || is_new && (extent == Extent::Full || seen.insert(configuration.clone())) {
                cases.push(Case { entry, preset: preset.name, overrides, is_plain });
            }
        }
    }
    cases
}

/// Files of a run that depend on the physics only, including those of every format.
fn files() -> impl Iterator<Item = &'static str> {
    FILES.into_iter().chain(FORMATS.iter().map(|format| format.file))
}

fn places(particles: &Particles) -> Places {
    particles.all().iter().map(|particle| (particle.id, particle.position)).collect()
}

/// Summary without the entries of the session.
fn of_physics(mut summary: Value) -> Value {
    OF_THE_SESSION.into_iter().for_each(|name| summary[name] = Value::Null);
    summary
}

fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("summary.json")).expect("a run has a summary"))
        .expect("JSON")
}

impl Case {
    fn label(&self) -> String {
        let Case { preset, overrides, .. } = self;
        format!(
            "stripmine run {preset} {}",
            overrides.iter().map(|it| format!("--set {it} ")).collect::<String>()
        )
    }

    fn hold(&self, methods: Methods, command: fn() -> Command, extent: Extent) -> Held {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (prepared, _) = load(self.preset, &self.overrides, methods).expect("a valid scene");
        let path = folder.path().join("whole");
        let (_, words) = self.session(&prepared, &path, None);
        let mut held = Held { runs: 1, sessions: 1, ..Held::default() };
        self.files(&prepared, &path, &mut held);
        let mut stream = Stream::new(self.label().len() as u64, Of::Test, 0);
        let repeats = if extent == Extent::Full { 20 } else { 1 };
        for repeat in 0..repeats {
            let parts = folder.path().join(format!("parts{repeat}"));
            held.sessions += self.interrupted(&prepared, &parts, words, &mut stream);
            self.same("interrupted", &path, &parts);
            held.runs += 1;
        }
        if self.is_plain || extent == Extent::Full {
            let killed = folder.path().join("killed");
            held.killed += self.killed(command, &killed);
            self.same("killed", &path, &killed);
            held.runs += 1;
        }
        if self.is_plain {
            held.pictures += self.pictures(command, &path);
            self.itself(command);
            self.check(command, &path);
        }
        held
    }

    /// Starts or resumes a run, and interrupts it when it has reported its progress `stop` times. Returns true if it is complete, and the number of
    /// reports.
    fn session(&self, prepared: &Prepared, folder: &Path, stop: Option<u64>) -> (bool, u64) {
        let (is_interrupted, mut words) = (AtomicBool::new(false), 0);
        let progress = |_, _| {
            words += 1;
            is_interrupted.store(Some(words) == stop, Ordering::Relaxed);
        };
        let existing = ExistingRun::Resume { other_version: false };
        let job = RunJob {
            prepared: prepared.into(),
            quantities: prepared.quantities(self.entry),
            program: &built(),
            is_open_ended: false,
        };
        let ending = run(job, folder, existing, &is_interrupted, progress, |_| {});
        let ending = ending.unwrap_or_else(|error| panic!("{}: {error}", self.label()));
        (matches!(ending, Ending::Done(_)), words)
    }

    /// Runs a scene with three interruptions at random moments.
    fn interrupted(&self, prepared: &Prepared, folder: &Path, words: u64, stream: &mut Stream) -> usize {
        for stops in 0..3 {
            let stop = stream.random_range(1..(words / 2).max(2));
            if self.session(prepared, folder, Some(stop)).0 {
                return stops + 1;
            }
        }
        assert!(self.session(prepared, folder, None).0);
        4
    }

    fn command(&self, command: fn() -> Command, verb: &[&str]) -> Command {
        let mut command = command();
        command.args(verb).arg(self.preset).stdin(Stdio::null());
        command.args(self.overrides.iter().flat_map(|it| ["--set", it]));
        command
    }

    fn output(&self, command: &mut Command) -> String {
        let output = command.output().expect("the program runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {command:?}: {said}", self.label());
        String::from_utf8(output.stdout).expect("it prints text")
    }

    /// Kills a run once it has a checkpoint, and resumes it; returns 1 if it was not yet complete.
    fn killed(&self, command: fn() -> Command, folder: &Path) -> usize {
        let go = |more: &[&str]| {
            let mut command = self.command(command, &["run"]);
            command.args(["--quiet", "--out"]).arg(folder).args(more);
            command
        };
        let mut child =
            go(&[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program runs");
        while !folder.join("run.checkpoint").exists() && child.try_wait().expect("it is there").is_none() {
            thread::sleep(std::time::Duration::from_millis(1));
        }
        // It may have ended.
        let _ = child.kill();
        let was_killed = child.wait().expect("it is there").code().is_none();
        let words = self.output(&mut go(&["--resume"]));
        self.closing_words(&words, &summary(folder));
        usize::from(was_killed)
    }

    /// Checks that the closing words of a run agree with its summary.
    fn closing_words(&self, words: &str, summary: &Value) {
        let line = words.lines().next().unwrap_or_default();
        let parts: Vec<&str> = line.split([',', ':']).collect();
        let (count, unit) = parts[0].split_once(' ').expect("a count and a unit");
        assert!(["steps", "events"].contains(&unit), "{}: {line}", self.label());
        assert_eq!(count, summary[unit].to_string(), "{}: {line}", self.label());
        let time = parts[1].trim_start_matches(" time ").split(' ').next().expect("a number and its unit");
        let time: f64 = time.parse().expect("a time");
        let known = summary["time"].as_f64().expect("a time");
        assert!((time - known).abs() <= 1e-8 * known, "{}: {line}: {known}", self.label());
    }

    /// Checks that files and summary of both runs are equal.
    fn same(&self, treatment: &str, whole: &Path, parts: &Path) {
        for name in files() {
            let [one, other] = [whole, parts].map(|folder| fs::read(folder.join(name)).ok());
            assert!(one == other, "{}: {name} differs, {treatment}", self.label());
        }
        let [one, other] = [whole, parts].map(|folder| of_physics(summary(folder)));
        assert_eq!(one, other, "{}: the summary differs, {treatment}", self.label());
    }

    /// Checks that a run has as many frames and rows as its scene states, and that the last ones show the end.
    fn files(&self, prepared: &Prepared, folder: &Path, held: &mut Held) {
        let Schedule { rows, snapshots, .. } = prepared.schedule;
        let (clock, particles, positions) = end_of(prepared);
        let label = self.label();
        let (expected, (columns, table)) = (moments(rows, &clock), table(&folder.join("thermo.csv")));
        assert!(expected.len() > 5 && table.len() == expected.len(), "{label}: {} rows", table.len());
        let named = |name: &str| columns.iter().position(|column| column == name).expect(name);
        let moment = named(if matches!(rows, Every::Time(_)) { "time" } else { "step" });
        assert_eq!(table.iter().map(|row| row[moment]).collect::<Vec<_>>(), expected, "{label}");
        held.rows += table.len();

        let mut expected = moments(snapshots, &clock);
        let end = if matches!(snapshots, Every::Time(_)) { clock.time } else { clock.steps as f64 };
        expected.extend(Some(end).filter(|end| expected.last() != Some(end)));
        let ends = [places(prepared.particles()), places(&particles)];
        let xyz = extended_xyz(&folder.join("trajectory.xyz"));
        let moment = |frame: &TextFrame| match snapshots {
            Every::Time(_) => frame.time.expect("it has one"),
            _ => frame.number as f64,
        };
        assert!(expected.len() > 5);
        assert_eq!(xyz.iter().map(moment).collect::<Vec<_>>(), expected, "{label}: moments of the frames");
        let dump = folder.join("dump.lammpstrj");
        let dump = dump.exists().then(|| ("dump.lammpstrj", lammps_dump(&dump)));
        let texts: Vec<(u64, u64, Places)> = xyz.iter().map(TextFrame::text).collect();
        for (name, frames) in [("trajectory.xyz", xyz)].into_iter().chain(dump) {
            assert_eq!(frames.len(), expected.len(), "{label}: {name}");
            assert!(
                frames.windows(2).all(|two| two[0].number <= two[1].number),
                "{label}: {name}: numbers grow"
            );
            assert!(frames[0].number < frames[frames.len() - 1].number, "{label}: {name}: numbers grow");
            assert!(
                frames[frames.len() - 1].places == ends[1],
                "{label}: {name}: the last frame is the final state"
            );
        }
        assert!(ends[0] != ends[1], "{label}: nothing moves");
        // At equal intervals: the end, which is between two snapshots, has no frame.
        let frames = dcd(&folder.join("trajectory.dcd"));
        let even = moments(snapshots, &clock);
        assert_eq!(frames.len(), even.len(), "{label}: trajectory.dcd");
        let bits =
            |places: &[[f32; 3]]| places.iter().map(|place| place.map(f32::to_bits)).collect::<Vec<_>>();
        assert!(
            even.last() != Some(&end) || bits(&frames[frames.len() - 1]) == bits(&positions),
            "{label}: trajectory.dcd: the last frame"
        );
        let frames = gsd(&folder.join("trajectory.gsd"));
        assert_eq!(frames.iter().map(GsdFrame::text).collect::<Vec<_>>(), texts, "{label}: trajectory.gsd");
        for frame in &frames {
            frame.single_is_as_double(&label);
            let logged = frame.logged.get("msd").filter(|msd| !msd.is_nan());
            if let (Some(&msd), Some(found)) = (logged, frame.displacement_since(&frames[0])) {
                // The displacement of particles that have not moved is their rounding error.
                let digit = if label.contains("f32") || label.contains("mixed") { 1e-6 } else { 1e-15 };
                let rounding = frame.exact_sides.iter().map(|side| (digit * side).powi(2)).sum::<f64>();
                assert!((found - msd).abs() <= 1e-12 * msd + rounding, "{label}: {found} and {msd}");
            }
        }
        // A frame at the moment of a row contains the row.
        let rows: Vec<(&str, f64)> =
            (columns.iter().map(String::as_str).zip(table[0].iter().copied())).collect();
        for (name, value) in rows.into_iter().filter(|(name, _)| !["step", "time"].contains(name)) {
            assert_eq!(
                frames[0].logged.get(name).map(|it| it.to_bits()),
                Some(value.to_bits()),
                "{label}: {name}"
            );
        }
        held.frames += self.formats(prepared, folder, &texts);

        if let Ok(data) = fs::read_to_string(folder.join("final.data")) {
            for [x, y, z] in ends[1].values() {
                assert!(data.contains(&format!(" {x:?} {y:?} {z:?}\n")), "{label}: final.data");
            }
        }
        let (summary, events) = (summary(folder), fs::read_to_string(folder.join("events.csv")));
        assert_eq!(
            [&summary["steps"], &summary["events"]].map(Value::as_u64),
            [Some(clock.steps), Some(clock.events)]
        );
        // The reader of JSON rounds the last digit.
        let time = summary["time"].as_f64().expect("a time");
        assert!((time / clock.time - 1.0).abs() < 1e-15, "{label}: {time} and {clock:?}");
        if let (Ok(events), true) = (events, clock.events > 0) {
            assert_eq!(events.lines().count() as u64, clock.events + 1, "{label}: events.csv");
        }
        held.files += files().filter(|name| folder.join(name).exists()).count();
    }

    /// Checks that every requested format has a file, and that frames read back equal those of the text; returns the total number of
    /// frames.
    fn formats(&self, prepared: &Prepared, folder: &Path, texts: &[(u64, u64, Places)]) -> usize {
        let mut frames = 0;
        for format in FORMATS {
            let (label, path) = (format!("{}: {}", self.label(), format.file), folder.join(format.file));
            let is_asked = prepared.output.asks_for(format);
            assert_eq!(fs::metadata(&path).is_ok_and(|file| file.len() > 0), is_asked, "{label}");
            // Some formats require scenes in a box.
            assert!(is_asked || format.needs_box, "{label}");
            if let FrameWriting::Growing(_) = format.writing {
                frames += usize::from(is_asked) * texts.len();
            }
            if let FrameReading::Opens(open) = format.reading {
                let frames = open(&path).unwrap_or_else(|error| panic!("{label}: {error}"));
                let frame =
                    |frame: ParticleFrame| (frame.step, frame.time.to_bits(), places(&frame.particles));
                let frames =
                    frames.map(|read| read.map(frame).unwrap_or_else(|error| panic!("{label}: {error}")));
                assert_eq!(frames.collect::<Vec<_>>(), texts, "{label}");
            }
        }
        frames
    }

    /// Draws curves and, if a trajectory is read, particles; returns the number of pictures.
    fn pictures(&self, command: fn() -> Command, run: &Path) -> usize {
        let plots = run.with_extension("plots");
        let mut plot = command();
        // Requested by name, since in a short run not every quantity changes.
        let curve =
            self.entry.quantities.iter().find(|it| it.name != "time").expect("something is observed").name;
        self.output(plot.arg("plot").arg(run).args(["--columns", curve, "--out"]).arg(&plots));
        let names: Vec<String> = fs::read_dir(&plots)
            .expect("there are pictures")
            .map(|file| file.expect("a file").file_name().into_string().expect("a name"))
            // List of the program's own files.
            .filter(|name| name != "plot.files")
            .collect();
        for kind in ["svg", "png"] {
            for name in ["last-state", &curve.replace('_', "-")] {
                assert!(names.contains(&format!("{name}.{kind}")), "{}: {names:?}", self.label());
            }
        }
        let is_there = |name: &String| fs::metadata(plots.join(name)).is_ok_and(|file| file.len() > 500);
        assert!(names.iter().all(is_there), "{}: {names:?}", self.label());
        names.len()
    }

    /// Checks that `compare` finds a scene equal to itself.
    fn itself(&self, command: fn() -> Command) {
        let against = self.overrides.last().expect("an override");
        let mut compare = self.command(command, &["compare"]);
        let found = self.output(compare.args(["--json", "--against", against]));
        let found: Value = serde_json::from_str(&found).expect("JSON");
        assert_eq!(found["same_bits"], true, "{}: {found}", self.label());
        assert!(found["looks"].as_array().is_some_and(|looks| looks.len() > 2), "{}: {found}", self.label());
    }

    /// Checks that `scene check` agrees with the summary of the run.
    fn check(&self, command: fn() -> Command, folder: &Path) {
        let mut check = self.command(command, &["scene", "check"]);
        let found: Value = serde_json::from_str(&self.output(check.arg("--json"))).expect("JSON");
        let summary = summary(folder);
        let (_, table) = table(&folder.join("thermo.csv"));
        let frames = extended_xyz(&folder.join("trajectory.xyz"));
        for (name, count) in [("thermo_rows", table.len()), ("frames", frames.len())] {
            let foreseen = found[name].as_u64();
            assert!(
                foreseen.is_none_or(|foreseen| foreseen == count as u64),
                "{}: {name} {found}",
                self.label()
            );
        }
        let said = found.as_object().expect("facts");
        let of_the_step = summary["foreseen"].as_object().expect("facts");
        // The origin of the box is not that of the program; a run may have further warnings.
        let others = ["origin", "warnings"];
        for (name, value) in said.iter().filter(|(name, _)| !others.contains(&name.as_str())) {
            let ours = summary.get(name).or(of_the_step.get(name));
            assert!(ours.is_none_or(|ours| ours == value), "{}: {name}: {value} and {ours:?}", self.label());
        }
        let time = &found["expected_time"];
        let [low, typical, high] = ["at_least", "seconds", "at_most"].map(|name| time[name].as_f64());
        assert!(time.is_null() || low <= typical && typical <= high, "{}: {time}", self.label());
    }
}
