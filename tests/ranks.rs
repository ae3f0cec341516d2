//! Independence of the bits from the number of ranks.

use rand::RngExt;
use std::cell::RefCell;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use stripmine::provenance::built;
use stripmine_kernels::noise::{self, Stream};
use stripmine_physics::method::{
    METHODS, MethodEntry, Prepared, RANK_ENDED, Snapshot, StartPurpose, Until, load,
};
use stripmine_physics::ranks::{self, Parcel, RankBackend, RankError, Ranks, local};
use stripmine_physics::run::{Ending, ExistingRun, RunError, RunJob, run};

/// A scene of several bands, with its number of steps.
struct Scene {
    preset: &'static str,
    overrides: &'static [&'static str],
    steps: u64,
}

/// Hot discs, which cross many rows: nearly all of them move to another rank.
const HOT: &[&str] = &[
    "particles.generate=mesh",
    "particles.spacing=1.3",
    "particles.count=900",
    "particles.temperature=1.0",
    "domain.sides=[10.0, 180.0]",
    "law.stiffness=20000",
    "integrator.dt=0.001",
    "run.steps=6000",
];

const SCENES: &[Scene] = &[
    Scene { preset: "bench", overrides: HOT, steps: 5000 },
    // Several sizes.
    Scene {
        preset: "bench",
        overrides: &[
            "particles.generate=random",
            "particles.count=900",
            "particles.temperature=1.0",
            "particles.radius_spread=0.05",
            "particles.radius_cut=0.1",
            "domain.sides=[10.0, 180.0]",
            "law.stiffness=20000",
            "integrator.dt=0.001",
            "run.steps=6000",
        ],
        steps: 800,
    },
    // Moving walls, friction, a closed side.
    Scene {
        preset: "shaken-box",
        overrides: &[
            "domain.sides=[0.5, 3.0]",
            "particles.fill_height=1.5",
            "particles.count=700",
            "run.time=1",
        ],
        steps: 1000,
    },
    Scene { preset: "langevin-dense", overrides: &["domain.sides=[12.0, 140.0]", "run.time=3"], steps: 500 },
    Scene {
        preset: "langevin-dense",
        overrides: &[
            "domain.sides=[12.0, 140.0]",
            "law.kind=wca",
            "integrator.kind=stochastic",
            "run.time=3",
        ],
        steps: 500,
    },
    // Steps so long that particles are lost and the run continues without them.
    Scene {
        preset: "langevin-dense",
        overrides: &["domain.sides=[12.0, 140.0]", "integrator.dt=0.03", "run.most_lost=1000", "run.time=9"],
        steps: 60,
    },
];
const SEARCHES: [&str; 3] = ["lattice", "sectors", "neighbor-list"];
/// The long test uses all numbers up to eight.
const RANKS: [usize; 3] = [2, 3, 7];

impl Scene {
    fn prepared(&self, more: &[String]) -> Result<Prepared, String> {
        let overrides = self.overrides.iter().map(|&text| text.to_owned()).chain(more.iter().cloned());
        let loaded = load(self.preset, &overrides.collect::<Vec<_>>(), METHODS);
        loaded.map(|(prepared, _)| prepared).map_err(|errors| errors.to_string())
    }
}

/// Samples of a run, and the failure that stopped it.
#[derive(Debug, Default, PartialEq)]
struct Seen {
    observed: Vec<Vec<u64>>,
    snapshots: Vec<Snapshot>,
    checksums: Vec<String>,
    positions: Vec<Vec<[u32; 3]>>,
    events: String,
    words: String,
    failure: Option<(u64, String, Vec<u32>)>,
}

/// Number of samples of a run; some follow directly after lists are rebuilt or discs are redistributed.
const LOOKS: u64 = 60;
/// Interval of the samples that contain the whole state.
const WHOLE: u64 = 15;

/// Samples of a run on a number of ranks, or the reason why it cannot start.
fn seen(prepared: &Prepared, ranks: usize, steps: u64) -> Result<Seen, String> {
    ranks::with_backend(RankBackend::Threads(ranks), || seen_as_begun(prepared, steps))
}

/// Like [`seen`], on the ranks of the current crew.
fn seen_as_begun(prepared: &Prepared, steps: u64) -> Result<Seen, String> {
    let mut simulation = prepared.start(StartPurpose::Run).map_err(|failure| failure.to_string())?;
    let mut seen = Seen::default();
    for part in 0..=LOOKS {
        let until = Until::Steps(part * steps / LOOKS);
        if let Err(failure) = simulation.advance(&[until], &AtomicBool::new(false)) {
            let ids = failure.culprits.iter().map(|culprit| culprit.id).collect();
            let at = failure.at.map_or(0, |at| at.steps);
            seen.failure = Some((at, failure.kind.name().to_owned(), ids));
            break;
        }
        seen.observed.push(simulation.observe().iter().map(|value| value.to_bits()).collect());
        if part % WHOLE > 0 {
            continue;
        }
        seen.snapshots.push(simulation.snapshot());
        seen.checksums.push(simulation.particles().checksum());
        seen.positions.push(
            simulation.per_particle().positions().iter().map(|place| place.map(f32::to_bits)).collect(),
        );
    }
    seen.events = simulation.take_events();
    seen.words = simulation.in_words();
    Ok(seen)
}

/// First difference, in words.
fn difference(alone: &Seen, together: &Seen) -> Option<String> {
    for (part, (a, b)) in alone.snapshots.iter().zip(&together.snapshots).enumerate() {
        let columns = a.columns.iter().zip(&b.columns);
        if let Some(((name, _), _)) = columns.into_iter().find(|(a, b)| a != b) {
            return Some(format!("the column {name} of part {part}"));
        }
        if a.counters != b.counters {
            return Some(format!("counters of part {part}: {:?}, {:?}", a.counters, b.counters));
        }
    }
    (alone.failure != together.failure)
        .then(|| format!("{:?}, {:?}", alone.failure, together.failure))
        .or_else(|| (alone.observed != together.observed).then(|| "what is observed".to_owned()))
        .or_else(|| (alone != together).then(|| "positions, events or words".to_owned()))
}

#[test]
fn bits_do_not_depend_on_the_rank_count() {
    let mut compared = 0;
    for (number, scene) in SCENES.iter().enumerate() {
        for (search, precision) in SEARCHES.into_iter().zip(["f64", "mixed", "f32"]) {
            let more = [format!("search.by={search}"), format!("machine.precision={precision}")];
            let prepared = match scene.prepared(&more) {
                Ok(prepared) => prepared,
                // Sectors do not support several sizes, and only granular scenes have lattices and mixed precision.
                Err(why) if why.contains("search.by") || why.contains("machine.precision") => continue,
                Err(why) => panic!("{} {number} {search} {precision}: {why}", scene.preset),
            };
            let alone = seen(&prepared, 1, scene.steps).unwrap();
            for ranks in RANKS {
                let what = format!("{} {number} {search} {precision} on {ranks} ranks", scene.preset);
                match seen(&prepared, ranks, scene.steps) {
                    Err(why) if why.contains("bands of rows") => break,
                    Err(why) => panic!("{what}: {why}"),
                    Ok(together) => assert_eq!(difference(&alone, &together), None, "{what}"),
                }
                compared += 1;
            }
        }
    }
    println!("{compared} runs");
    assert!(compared >= 25, "{compared}");
}

/// At step 207 a disc is on the rim of its cell to the last bit of f32: all ranks must place it in the same cell.
#[test]
fn disc_on_a_rim_is_in_one_cell() {
    let more = [
        "search.by=lattice",
        "machine.precision=f32",
        "particles.seed=45",
        "domain.periodic=[true, false]",
        "domain.closed_sides=edge",
        "domain.sides=[17.5, 161.5]",
        "particles.count=1367",
        "integrator.values=4",
    ];
    let prepared = SCENES[1].prepared(&more.map(str::to_owned)).unwrap();
    let alone = seen(&prepared, 1, 220).unwrap();
    assert_eq!(alone.failure, None);
    assert_eq!(difference(&alone, &seen(&prepared, 8, 220).unwrap()), None);
}

/// A state can be resumed on another number of ranks.
#[test]
fn resumes_on_a_different_rank_count() {
    for (scene, search) in SCENES.iter().zip(SEARCHES.into_iter().cycle()).take(5) {
        let Ok(prepared) = scene.prepared(&[format!("search.by={search}")]) else { continue };
        let stop = AtomicBool::new(false);
        let [half, end] = [scene.steps / 2, scene.steps].map(Until::Steps);
        let whole = seen(&prepared, 1, scene.steps).unwrap();
        let Some(last) = whole.snapshots.last() else { continue };
        let (clock, state) = ranks::with_backend(RankBackend::Threads(2), || {
            let mut first = prepared.start(StartPurpose::Run).unwrap();
            first.advance(&[half], &stop).unwrap();
            (first.clock(), first.snapshot())
        });
        for ranks in [1, 3] {
            ranks::with_backend(RankBackend::Threads(ranks), || {
                let mut second = prepared.start(StartPurpose::Run).unwrap();
                second.restore(clock, state.clone()).unwrap();
                second.advance(&[end], &stop).unwrap();
                assert!(second.snapshot() == *last, "{} {search}: from 2 on {ranks} ranks", scene.preset);
            });
        }
    }
}

/// Bodies are distributed by rows of all pairs.
#[test]
fn bodies_on_ranks_have_the_same_bits() {
    for more in [
        &["particles.count=700", "run.steps=20"][..],
        &["particles.count=700", "run.steps=20", "machine.precision=mixed", "integrator.kind=hermite-4"],
    ] {
        let more: Vec<String> = more.iter().map(|&text| text.to_owned()).collect();
        let (prepared, _) = load("plummer", &more, METHODS).unwrap();
        let alone = seen(&prepared, 1, 20).unwrap();
        for ranks in RANKS {
            assert_eq!(difference(&alone, &seen(&prepared, ranks, 20).unwrap()), None, "{ranks} ranks");
        }
    }
    let (few, _) = load("plummer", &["particles.count=100".to_owned()], METHODS).unwrap();
    assert!(seen(&few, 8, 1).unwrap_err().contains("bands of rows of the all-pairs sum"));
    let (kepler, _) = load("kepler", &[], METHODS).unwrap();
    assert!(seen(&kepler, 2, 1).unwrap_err().contains("only machine.engine = \"fast\""));
}

/// More ranks than bands are refused, with the largest number that the scene allows.
#[test]
fn too_many_ranks_are_refused() {
    let prepared = SCENES[0].prepared(&["search.by=sectors".to_owned()]).unwrap();
    let why = seen(&prepared, 12, 1).unwrap_err();
    assert!(why.contains("12 ranks are more than the 9 bands") && why.contains("at most 9 ranks"), "{why}");
}

/// Random scenes of both methods, including those that fail.
#[test]
#[ignore = "long: cargo test --release --test ranks -- --ignored --nocapture"]
fn random_scenes_on_ranks_have_the_same_bits() {
    let mut random = Stream::new(43, noise::RandomPurpose::Test, 0);
    let (mut compared, mut failed) = (0, 0);
    while compared < 300 {
        let scene = &SCENES[random.random_range(0..SCENES.len())];
        let search = SEARCHES[random.random_range(0..3)];
        let precision = ["f64", "mixed", "f32"][random.random_range(0..3)];
        let mut more = vec![
            format!("search.by={search}"),
            format!("machine.precision={precision}"),
            format!("particles.seed={}", random.random_range(1..1000)),
        ];
        if scene.preset == "bench" {
            let periodic = [random.random_bool(0.8), random.random_bool(0.8)];
            let width = random.random_range(6..20);
            let height = random.random_range(60..240);
            more.push(format!("domain.periodic={periodic:?}"));
            more.push(format!("domain.sides=[{width}.5, {height}.5]"));
            more.push(format!("particles.count={}", random.random_range(40..width * height / 2)));
            more.push(format!("integrator.values={}", random.random_range(4..7)));
        }
        let Ok(prepared) = scene.prepared(&more) else { continue };
        let steps = random.random_range(40..scene.steps);
        let ranks = random.random_range(2..9);
        let threads = random.random_range(1..3);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let Ok(together) = pool.install(|| seen(&prepared, ranks, steps)) else { continue };
        let alone = seen(&prepared, 1, steps).unwrap();
        let what = format!("{} {more:?} on {ranks} ranks, {threads} threads, {steps} steps", scene.preset);
        assert_eq!(difference(&alone, &together), None, "{what}");
        failed += usize::from(alone.failure.is_some());
        compared += 1;
    }
    println!("{compared} runs, {failed} of them ended by a failure");
}

/// Fault of a process.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// Ends after a number of broadcasts from the first process.
    Ends(usize),
    /// Sends the first process a message that lacks a byte, after this number.
    CutsOff(usize),
    /// Reads a message of the first process without its last byte, after this number.
    Mishears(usize),
}

/// A thread of this test that acts as a process.
#[derive(Clone)]
struct Process {
    ranks: Arc<Mutex<local::ThreadRank>>,
    rank: usize,
    count: usize,
    fault: Fault,
    told: Arc<AtomicUsize>,
}

thread_local! {
    static PROCESS: RefCell<Option<Process>> = const { RefCell::new(None) };
}

fn join() -> Box<dyn Ranks> {
    Box::new(PROCESS.with_borrow(|process| process.clone().unwrap()))
}

impl Ranks for Process {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.count
    }

    fn halo(&self, to: [Parcel; 2], meanwhile: &mut dyn FnMut()) -> Result<[Parcel; 2], RankError> {
        self.ranks.lock().unwrap().halo(to, meanwhile)
    }

    fn migrate(&self, to: Vec<Parcel>) -> Result<Vec<Parcel>, RankError> {
        self.ranks.lock().unwrap().migrate(to)
    }

    fn gather(&self, mut own: Parcel) -> Result<Vec<Parcel>, RankError> {
        if let Fault::CutsOff(after) = self.fault
            && self.told.load(Ordering::Relaxed) == after
        {
            own.0.pop();
        }
        self.ranks.lock().unwrap().gather(own)
    }

    fn broadcast(&self, said: Option<Parcel>) -> Result<Parcel, RankError> {
        let mut told = self.ranks.lock().unwrap().broadcast(said);
        let count = self.told.fetch_add(1, Ordering::Relaxed) + 1;
        if self.fault == Fault::Ends(count) {
            resume_unwind(Box::new("this process ends"));
        }
        if self.fault == Fault::Mishears(count) {
            told.iter_mut().for_each(|told| _ = told.0.pop());
        }
        told
    }
}

/// Runs a closure as the first of several processes, while the others take part in a scene.
fn as_processes<R>(prepared: &Prepared, faults: &[Fault], first: impl FnOnce() -> R) -> R {
    let count = faults.len();
    let begin = |ranks: local::ThreadRank, fault: Fault| {
        let (rank, told) = (ranks.rank(), Arc::default());
        PROCESS.set(Some(Process { ranks: Arc::new(Mutex::new(ranks)), rank, count, fault, told }));
    };
    thread::scope(|scope| {
        let mut all = local::ranks(count, 1).into_iter().zip(faults.iter().copied());
        let own = all.next().unwrap();
        for (ranks, fault) in all {
            scope.spawn(move || {
                begin(ranks, fault);
                // Other processes get no simulation, but the reason why their part ended.
                let _ = catch_unwind(AssertUnwindSafe(|| {
                    ranks::with_backend(RankBackend::Processes(join), || {
                        prepared.start(StartPurpose::Run).map(drop)
                    })
                }));
            });
        }
        begin(own.0, own.1);
        let found = ranks::with_backend(RankBackend::Processes(join), first);
        let _ = ranks::dismiss(join().as_ref());
        PROCESS.take();
        found
    })
}

/// Runs a scene into a folder, as the first of several processes.
fn run_as_processes(
    (prepared, entry): (&Prepared, &'static MethodEntry),
    faults: &[Fault],
    (folder, existing): (&Path, ExistingRun),
) -> Result<Ending, RunError> {
    let job = RunJob {
        prepared: prepared.into(),
        quantities: entry.quantities,
        program: &built(),
        is_open_ended: false,
    };
    as_processes(prepared, faults, || run(job, folder, existing, &AtomicBool::new(false), |_, _| {}, |_| {}))
}

/// Scenes of every engine that supports ranks, with the length of the run.
const WRITTEN: [(&str, &[&str]); 4] = [
    ("bench", &["run.steps=40", "search.by=lattice"]),
    ("bench", &["run.steps=40", "search.by=neighbor-list"]),
    ("langevin-dense", &["domain.sides=[12.0, 280.0]", "integrator.dt=0.002", "run.time=0.08"]),
    ("plummer", &["particles.count=700", "run.steps=40"]),
];
/// Settings of their rows, frames and checkpoints.
const OUTPUT: [&str; 4] =
    ["run.thermo_every=4", "run.snapshot_every=8", "run.checkpoint_every=12", "output.trajectory=true"];

fn written((preset, more): (&'static str, &'static [&'static str])) -> (Prepared, &'static MethodEntry) {
    let hot: &[&str] = if preset == "bench" { HOT } else { &[] };
    let sets = hot.iter().chain(more).chain(&OUTPUT).map(|&set| set.to_owned());
    load(preset, &sets.collect::<Vec<_>>(), METHODS).unwrap()
}

/// Lines of the rows and frames in a folder.
fn lines(folder: &Path) -> [Vec<String>; 2] {
    ["thermo.csv", "trajectory.xyz"].map(|file| {
        let text = fs::read_to_string(folder.join(file)).unwrap();
        text.lines().map(str::to_owned).collect()
    })
}

/// A rank that ends, or a damaged message of a rank, ends the run at any message, with an error that names the rank. Files written
/// before are the beginning of a complete run's, and the run resumes from its checkpoint.
#[test]
fn lost_rank_ends_the_run_and_is_named() {
    for scene in WRITTEN {
        let (prepared, entry) = written(scene);
        let folder = tempfile::tempdir().unwrap();
        let carried_out = |faults: &[Fault], name: &str, existing| {
            run_as_processes((&prepared, entry), faults, (&folder.path().join(name), existing))
        };
        if let Err(error) = carried_out(&[Fault::None; 3], "whole", ExistingRun::Refuse) {
            panic!("{scene:?}: {error}");
        }
        let expected = lines(&folder.path().join("whole"));
        for (after, lost) in [(3, 1), (17, 2), (30, 2), (31, 1), (32, 2), (33, 1), (34, 2), (35, 1)] {
            for (fault, named, words) in [
                (Fault::Ends(after), lost, "has ended"),
                (Fault::CutsOff(after), lost, "sent a message that cannot be read"),
                (Fault::Mishears(after), 0, "sent a message that cannot be read"),
            ] {
                let mut faults = [Fault::None; 3];
                faults[lost] = fault;
                let name = format!("{fault:?}");
                let what = format!("{scene:?}: rank {lost}: {name}");
                let error =
                    carried_out(&faults, &name, ExistingRun::Refuse).map(drop).unwrap_err().to_string();
                assert!(
                    error.contains(&format!("rank {named} {words}\n  help: see its last message")),
                    "{what}: {error}"
                );
                let out = folder.path().join(&name);
                if !out.join("thermo.csv").exists() {
                    continue;
                }
                for (found, expected) in lines(&out).iter().zip(&expected) {
                    assert!(found.len() < expected.len() && expected.starts_with(found), "{what}: {found:?}");
                }
                carried_out(&[Fault::None; 2], &name, ExistingRun::Resume { other_version: false }).unwrap();
                assert!(lines(&out) == expected, "{what}: gone on with");
            }
        }
    }
}

/// A simulation that has lost a rank returns no numbers, and no state to resume from.
#[test]
fn simulations_without_a_rank_return_nothing() {
    for scene in WRITTEN {
        let (prepared, _) = written(scene);
        as_processes(&prepared, &[Fault::None, Fault::Ends(20)], || {
            let mut simulation = prepared.start(StartPurpose::Run).unwrap();
            let failure = simulation.advance(&[Until::Steps(40)], &AtomicBool::new(false)).unwrap_err();
            assert_eq!(
                (failure.kind, failure.message.as_str()),
                (RANK_ENDED, "rank 1 has ended"),
                "{scene:?}"
            );
            assert_eq!(simulation.check_ranks(), Err(failure), "{scene:?}");
            assert!(simulation.observe().iter().all(|value| value.is_nan()), "{scene:?}");
            assert_eq!((simulation.snapshot(), simulation.in_words()), Default::default(), "{scene:?}");
            assert!(simulation.summary().is_empty() && simulation.warnings().is_empty(), "{scene:?}");
        });
    }
}

/// Several processes give the bits of one, also when they restart without lost particles.
#[test]
fn processes_have_the_same_bits() {
    for scene in [&SCENES[1], &SCENES[5]] {
        let prepared = scene.prepared(&["search.by=neighbor-list".to_owned()]).unwrap();
        let alone = seen(&prepared, 1, scene.steps).unwrap();
        let faults = [Fault::None; 2];
        let together = as_processes(&prepared, &faults, || seen_as_begun(&prepared, scene.steps)).unwrap();
        assert_eq!(difference(&alone, &together), None, "{}", scene.preset);
    }
}
