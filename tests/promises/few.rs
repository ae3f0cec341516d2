//! Few particles in every kind of box, resumed at random moments: the state and all observables are those of a run in one piece.

use super::configurations::configurations;
use rand::RngExt;
use std::fmt::Write;
use std::fs;
use std::sync::atomic::AtomicBool;
use stripmine_kernels::noise::{RandomPurpose as Of, Stream};
use stripmine_physics::domain::Domain;
use stripmine_physics::method::langevin::laws::PairLaw;
use stripmine_physics::method::{Clock, METHODS, Prepared, Simulation, Snapshot, StartPurpose, Until, load};
use stripmine_physics::words::Words;

/// Largest number of particles of a scene.
const MOST: usize = 12;
/// Number of moments at which a run is resumed.
const CUTS: u32 = 5;

/// Generator of random scenes of a method.
type Scenes = fn(&mut Stream) -> String;

const METHOD_SCENES: [(&str, Scenes, usize); 4] = [
    ("hard-disks", hard_discs, 60),
    ("lattice-md", granular, 4),
    ("langevin", langevin, 4),
    ("nbody", bodies, 4),
];

/// Keys whose words are tried in addition to engines and searches.
const CHOICES: [(&str, &str); 4] =
    [("machine", "precision"), ("integrator", "kind"), ("machine", "coordinates"), ("machine", "execution")];

/// State and observables that are compared.
#[derive(Debug, PartialEq)]
struct Seen {
    clock: Clock,
    row: Vec<u64>,
    particles: String,
    summary: String,
    snapshot: Snapshot,
}

fn seen(simulation: &dyn Simulation) -> Seen {
    Seen {
        clock: simulation.clock(),
        row: simulation.observe().iter().map(|value| value.to_bits()).collect(),
        particles: format!("{:?} {:?}", simulation.particles(), simulation.per_particle().images()),
        summary: format!("{:?} {} {:?}", simulation.summary(), simulation.in_words(), simulation.warnings()),
        snapshot: simulation.snapshot(),
    }
}

/// Tests `times` as many scenes of each method as the quick share; returns the numbers of runs and of resumptions.
pub fn hold(times: usize) -> [usize; 2] {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("scene.toml");
    let mut stream = Stream::new(53, Of::Test, 0);
    let mut held = [0; 2];
    for (method, scene, count) in METHOD_SCENES {
        let entry = METHODS.iter().find(|entry| entry.vocabulary.keys.method == method).expect("a method");
        let configurations = configurations(entry, &CHOICES);
        for _ in 0..count * times {
            let text = scene(&mut stream);
            fs::write(&path, &text).expect("a temporary folder");
            for configuration in &configurations {
                let Ok((prepared, _)) = load(path.to_str().expect("a plain path"), configuration, METHODS)
                else {
                    continue;
                };
                held[0] += 1;
                held[1] += resumed(&prepared, &mut stream, &format!("{configuration:?}\n{text}"));
            }
        }
    }
    held
}

/// Runs a scene in one piece and in several, and compares both at each cut; returns the number of resumptions.
fn resumed(prepared: &Prepared, stream: &mut Stream, what: &str) -> usize {
    let start = || prepared.start(StartPurpose::Run).unwrap_or_else(|error| panic!("{error:?}: {what}"));
    let (mut whole, mut parts) = (start(), start());
    for cut in 1..=CUTS {
        let moment = match prepared.schedule.until {
            Until::Time(end) => {
                let [from, to] = [cut - 1, cut].map(|part| f64::from(part) / f64::from(CUTS) * end);
                match stream.random_range(0..3) {
                    0 => Until::Events(whole.clock().events + stream.random_range(1..20)),
                    _ => Until::Time(stream.random_range(from..to).max(whole.clock().time)),
                }
            }
            _ => Until::Steps(whole.clock().steps + stream.random_range(1..30)),
        };
        // An end that may never be reached, such as a number of events, is combined with a time.
        let until = match moment {
            Until::Events(_) => vec![moment, Until::Time(whole.clock().time + 1.0)],
            _ => vec![moment],
        };
        let ended =
            [whole.as_mut(), parts.as_mut()].map(|it| it.advance(&until, &AtomicBool::new(false)).err());
        let [of_whole, of_parts] = &ended;
        assert_eq!(format!("{of_parts:?}"), format!("{of_whole:?}"), "{moment:?} {what}");
        if of_whole.is_some() {
            return cut as usize - 1;
        }
        let (clock, snapshot) = (parts.clock(), parts.snapshot());
        parts = start();
        parts.restore(clock, snapshot).unwrap_or_else(|why| panic!("{why}: {clock} {what}"));
        assert_eq!(seen(parts.as_ref()), seen(whole.as_ref()), "{moment:?} {what}");
    }
    CUTS as usize
}

fn one_of<T: Clone>(stream: &mut Stream, all: &[T]) -> T {
    all[stream.random_range(0..all.len())].clone()
}

/// Listed discs in a box: positions without overlap, velocities of which some are zero.
struct Discs {
    sides: [f64; 2],
    periodic: [bool; 2],
    positions: Vec<[f64; 2]>,
    velocities: Vec<[f64; 2]>,
    radii: Vec<f64>,
}

fn discs(stream: &mut Stream, periodic: [bool; 2], least: f64) -> Discs {
    let sides = [0, 1].map(|_| {
        let most = one_of(stream, &[1.5, 4.0, 15.0]) * least;
        stream.random_range(least..most)
    });
    let domain = Domain::planar([0.0; 2], sides, periodic);
    let (count, is_mixed) = (stream.random_range(1..=MOST), stream.random_range(0..3) == 0);
    let speed = one_of(stream, &[0.0, 1.0, 1.0, 3.0]);
    let mut made = Discs { sides, periodic, positions: vec![], velocities: vec![], radii: vec![] };
    for _ in 0..40 * count {
        let radius = if is_mixed { stream.random_range(0.25..0.5) } else { 0.5 };
        let place = [0, 1].map(|axis| {
            let rim = if periodic[axis] { 0.0 } else { radius };
            stream.random_range(rim..sides[axis] - rim)
        });
        let is_free = made
            .positions
            .iter()
            .zip(&made.radii)
            .all(|(&there, other)| domain.distance(place, there) > radius + other);
        if is_free && made.positions.len() < count {
            made.positions.push(place);
            made.velocities.push([0, 1].map(|_| speed * stream.random_range(-1.0..1.0)));
            made.radii.push(radius);
        }
    }
    made
}

impl Discs {
    /// First sections of a scene.
    fn text(&self, method: &str, domain: &str) -> String {
        let Discs { sides, periodic, positions, velocities, radii } = self;
        format!(
            "format = 2\nunits = \"reduced\"\n[method]\nkind = \"{method}\"\n[domain]\nsides = {sides:?}\nperiodic = {periodic:?}\n{domain}\
             [particles]\ngenerate = \"list\"\nradius = 0.5\nmass = 1.0\npositions = {positions:?}\nvelocities = {velocities:?}\nradii = {radii:?}\n"
        )
    }
}

fn any_sides(stream: &mut Stream) -> [bool; 2] {
    one_of(stream, &[[true, true], [true, false], [false, true], [false, false]])
}

fn hard_discs(stream: &mut Stream) -> String {
    let periodic = any_sides(stream);
    let falls = !periodic[1] && stream.random_range(0..2) == 0;
    let is_open = falls && stream.random_range(0..3) == 0;
    let domain = if falls { "gravity = [0.0, -1.0]\n" } else { "" }.to_owned()
        + if is_open { "open_top = true\n" } else { "" };
    let mut text = discs(stream, periodic, 3.0).text("hard-disks", &domain);
    text.push_str("[law]\n");
    if stream.random_range(0..2) == 0 {
        let (pairs, walls) = (stream.random_range(0.5..1.0), stream.random_range(0.5..1.0));
        let _ =
            writeln!(text, "restitution = {pairs:?}\nwall_restitution = {walls:?}\ncontact_duration = 1e-3");
    }
    let moved = if periodic[1] { 2 } else { stream.random_range(0..3) };
    match moved {
        0 => text.push_str("thermal_side = \"bottom\"\nwall_temperature = 2.0\n"),
        1 => text.push_str("floor_amplitude = 0.1\nfloor_frequency = 0.7\n"),
        _ => {}
    }
    text + "[run]\ntime = 12.0\n"
}

fn granular(stream: &mut Stream) -> String {
    let periodic = any_sides(stream);
    let gravity = one_of(stream, &["", "gravity = [0.0, -0.1]\n", "gravity = [0.05, 0.0]\n"]);
    discs(stream, periodic, 6.0).text("lattice-md", gravity)
        + "[law]\nstiffness = 187.0\nnormal_damping = 1.0\n[integrator]\ndt = 0.005\n[run]\nsteps = 300\n"
}

fn langevin(stream: &mut Stream) -> String {
    let law = one_of(stream, PairLaw::WORDS);
    let start = discs(stream, [true; 2], 8.0).text("langevin", "");
    start
        + &format!(
            "[law]\nkind = \"{law}\"\ndrag = 1.0\nbath_temperature = 1.0\n[integrator]\ndt = 0.002\n[run]\nsteps = 300\n"
        )
}

fn bodies(stream: &mut Stream) -> String {
    let (count, seed) = (stream.random_range(1..=MOST), stream.random_range(1..1000));
    format!(
        "format = 2\nunits = \"G = 1\"\n[method]\nkind = \"nbody\"\n[particles]\ngenerate = \"sphere\"\ncount = {count}\nseed = {seed}\nvirial = 0.5\n\
         [law]\nsoftening = 0.05\n[integrator]\ndt = 0.005\n[run]\nsteps = 300\n"
    )
}
