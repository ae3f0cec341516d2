//! A film of a run: the frames of its trajectory in one page.

use super::colouring::{Colouring, ColouringError, units};
use super::particles::{LARGE_POINT, POINT, SHOWN, TRACED, WIDTH, scene};
use super::window;
use crate::report::section::{Film, Frame as Moment, Side};
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use stripmine_physics::io::extxyz::{Frame, Frames, ReadError};
use stripmine_physics::number::counted;
use stripmine_physics::particles::{Kind, Particle};
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, FilePlace, Reported};

/// Places of particles in a film: at two bytes a coordinate and at most two a shade, in base 64, less than 20 million bytes.
const PLACES: usize = 2_400_000;
/// Frames of a film: more take minutes to see.
const FRAMES: usize = 1500;
/// Places that decide what is shown.
const LOOKED_AT: usize = 100_000;

/// The trajectory of a run.
const TRAJECTORY: &str = "trajectory.xyz";

/// Why there is no film.
#[derive(Debug, thiserror::Error)]
pub(super) enum FilmError {
    /// The run has written no trajectory.
    #[error(
        "there is no {}, which a film is made of\n  help: run with --set output.trajectory=true{}",
        quoted::path(file),
        if *has_dcd { "; trajectory.dcd has neither times nor sizes" } else { "" }
    )]
    NoTrajectory {
        /// Where it should be.
        file: PathBuf,
        /// Whether there is one of another kind.
        has_dcd: bool,
    },
    /// The trajectory has no frame.
    #[error("{} has no frame yet; a run writes one every run.snapshot_every", quoted::path(.0))]
    NoFrame(PathBuf),
    /// The trajectory cannot be read.
    #[error(transparent)]
    Trajectory(#[from] ReadError),
    /// Its particles have no such colours.
    #[error(transparent)]
    Colouring(#[from] ColouringError),
}

impl Reported for FilmError {
    fn class(&self) -> Class {
        match self {
            FilmError::NoTrajectory { .. } => Class::InputOutput,
            FilmError::Trajectory(error) if error.system().is_some() => Class::InputOutput,
            FilmError::NoFrame(_) | FilmError::Trajectory(_) => Class::Input,
            FilmError::Colouring(error) => error.class(),
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            FilmError::NoTrajectory { file, .. } | FilmError::NoFrame(file) => Some(FilePlace::at(file)),
            FilmError::Trajectory(error) => Some(FilePlace {
                line: error.mistakes.first().and_then(|mistake| mistake.line),
                ..FilePlace::at(error.file.as_ref())
            }),
            FilmError::Colouring(_) => None,
        }
    }
}

/// The film of a run, and what a reader must know of it, a line each.
///
/// # Errors
/// If there is no trajectory, it cannot be read, or its particles cannot be coloured so.
pub(super) fn film(run: &Path, colouring: &Colouring) -> Result<(Film, Vec<String>), FilmError> {
    let file = run.join(TRAJECTORY);
    let has_dcd = run.join("trajectory.dcd").exists();
    let frames = Frames::open(&file).map_err(|error| match error.system().map(std::io::Error::kind) {
        Some(ErrorKind::NotFound) => FilmError::NoTrajectory { file: file.clone(), has_dcd },
        _ => error.into(),
    })?;
    let mut reel = Reel::default();
    for frame in frames.in_space() {
        reel.add(frame?, colouring)?;
    }
    let Some((last, cast)) = reel.last.take() else { return Err(FilmError::NoFrame(file)) };
    let scene = scene(run);
    reel.film(&last, cast, colouring, scene.as_ref())
}

/// Who is in the film, as of the first frame.
struct Cast {
    /// The place of each in every frame, by its id.
    places: HashMap<u32, usize>,
    particles: Vec<Particle>,
    /// One of so many is in it.
    every: usize,
}

impl Cast {
    fn of(frame: &Frame) -> Cast {
        let all = frame.particles.all();
        let every = all.len().div_ceil(SHOWN).max(1);
        let particles: Vec<Particle> = all.iter().step_by(every).copied().collect();
        let places = particles.iter().enumerate().map(|(place, particle)| (particle.id, place)).collect();
        Cast { places, particles, every }
    }
}

/// Frames as they are read: whenever there are too many, every other one goes.
#[derive(Default)]
struct Reel {
    /// Frames read.
    read: usize,
    /// Frames after which the next is kept, less than 2 for all; doubles.
    stride: usize,
    kept: Vec<(f64, Vec<Option<Seen>>)>,
    /// The newest frame, and the cast.
    last: Option<(Frame, Cast)>,
}

/// Where a particle is in a frame, and its value where it has one.
#[derive(Clone, Copy)]
struct Seen {
    position: [f64; 3],
    value: f64,
}

impl Reel {
    fn add(&mut self, frame: Frame, colouring: &Colouring) -> Result<(), FilmError> {
        let cast = self.last.take().map_or_else(|| Cast::of(&frame), |(_, cast)| cast);
        if self.read.is_multiple_of(self.stride.max(1)) {
            let values = colouring.values(&frame)?;
            let mut seen = vec![None; cast.particles.len()];
            // Grains come before walls, and have values.
            for (at, particle) in frame.particles.all().iter().enumerate() {
                if let Some(&place) = cast.places.get(&particle.id) {
                    let value = values.get(at).copied().unwrap_or(f64::NAN);
                    seen[place] = Some(Seen { position: particle.position, value });
                }
            }
            self.kept.push((frame.time, seen));
            if self.kept.len() > (PLACES / cast.particles.len().max(1)).clamp(2, FRAMES) {
                self.stride = 2 * self.stride.max(1);
                let mut number = 0..;
                self.kept.retain(|_| number.next().is_some_and(|number: usize| number.is_multiple_of(2)));
            }
        }
        self.read += 1;
        self.last = Some((frame, cast));
        Ok(())
    }

    fn film(
        self,
        last: &Frame,
        cast: Cast,
        colouring: &Colouring,
        scene: Option<&toml::Table>,
    ) -> Result<(Film, Vec<String>), FilmError> {
        const AXES: [usize; 2] = [0, 1];
        let everywhere = || self.kept.iter().flat_map(|(_, seen)| seen).flatten();
        let grains = || everywhere().filter(|seen| !seen.value.is_nan());
        let some = (self.kept.len() * cast.particles.len()).div_ceil(LOOKED_AT).max(1);
        let bounds = window::bounds(last, scene, AXES);
        let places: Vec<[f64; 3]> = grains().step_by(some).map(|seen| seen.position).collect();
        let [[left, right], [low, high]] = window::shown(last, &places, AXES, bounds);
        let shades = colouring.ends(grains().map(|seen| seen.value).collect())?;
        let is_seen = |[x, y, _]: [f64; 3], radius: f64| {
            x > left - radius && x < right + radius && y > low - radius && y < high + radius
        };
        let point = if cast.particles.len() <= TRACED { LARGE_POINT } else { POINT };
        let of_a_point = point / WIDTH * (right - left).max(high - low);
        let is_of_points = window::is_of_points(last, bounds);
        let radius = |particle: &Particle| if is_of_points { of_a_point } else { particle.radius };
        // Walls that stand still are drawn once.
        let is_still = |place: usize| {
            let first = cast.particles[place].position;
            let moves =
                |(_, seen): &(f64, Vec<Option<Seen>>)| seen[place].is_none_or(|it| it.position != first);
            cast.particles[place].kind == Kind::Wall && !self.kept.iter().any(moves)
        };
        let (fixed, moving): (Vec<usize>, Vec<usize>) =
            (0..cast.particles.len()).partition(|&at| is_still(at));
        let mut beyond = 0;
        let mut disc = |seen: &[Option<Seen>], place: usize| match seen[place] {
            Some(Seen { position, value }) if is_seen(position, radius(&cast.particles[place])) => {
                ([position[0], position[1]], value)
            }
            other => {
                beyond += usize::from(other.is_some());
                ([f64::NAN; 2], f64::NAN)
            }
        };
        let frames: Vec<Moment> = self
            .kept
            .iter()
            .map(|(time, seen)| Moment {
                time: *time,
                discs: moving.iter().map(|&place| disc(seen, place)).collect(),
            })
            .collect();
        let window = [[left, low], [right, high]];
        let gravity = scene.and_then(|scene| window::pair(scene, "gravity")).unwrap_or([0.0; 2]);
        let [width, height] = [right - left, high - low];
        let film = Film {
            title: format!(
                "{} from time {} to {}",
                counted(
                    cast.particles.iter().filter(|it| it.kind == Kind::Grain).count(),
                    "particle",
                    "particles"
                ),
                self.kept.first().map_or(0.0, |(time, _)| *time),
                self.kept.last().map_or(0.0, |(time, _)| *time)
            ),
            units: units(scene).of_length_and_time(),
            window,
            sides: sides(last, bounds, window),
            falls: if height > width { gravity[1] < 0.0 } else { gravity[0] > 0.0 },
            radii: moving.iter().map(|&place| radius(&cast.particles[place])).collect(),
            fixed: fixed
                .iter()
                .map(|&place| &cast.particles[place])
                .map(|wall| (wall.place(), wall.radius))
                .collect(),
            frames,
            shade: colouring.label(scene),
            shades,
        };
        let has_depth = everywhere().any(|seen| seen.position[2] != 0.0);
        let notes = [
            (self.read == 1).then(|| {
                "The trajectory has one frame: run.snapshot_every says how many there are.".to_owned()
            }),
            (self.stride > 1)
                .then(|| format!("One of {} of its {} frames is shown.", self.stride, self.read)),
            (cast.every > 1).then(|| format!("One of {} particles is shown.", cast.every)),
            has_depth.then(|| "Seen along z: x to the right, y upwards.".to_owned()),
            is_of_points.then(|| "Bodies have no size; the dots are as large as can be seen.".to_owned()),
            (beyond > 0).then(|| {
                let all = self.kept.len() * moving.len();
                format!("Beyond the picture: {:.1} % of all places.", 100.0 * beyond as f64 / all as f64)
            }),
            film.sides
                .iter()
                .any(|side| side.is_periodic)
                .then(|| "Dashed: periodic sides; what leaves there comes in at the other.".to_owned()),
        ];
        Ok((film, notes.into_iter().flatten().collect()))
    }
}

/// The sides of the box that are within a window.
fn sides(frame: &Frame, bounds: [[f64; 2]; 2], [corner, end]: [[f64; 2]; 2]) -> Vec<Side> {
    let mut sides = vec![];
    for axis in [0, 1] {
        let is_periodic = !window::is_endless(frame) && frame.periodic.is_none_or(|periodic| periodic[axis]);
        for at in bounds[axis].into_iter().filter(|at| (corner[axis]..=end[axis]).contains(at)) {
            let ends = [corner, end].map(|mut place| {
                place[axis] = at;
                place
            });
            sides.push(Side { ends, is_periodic });
        }
    }
    sides
}
