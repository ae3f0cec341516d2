//! Film of a run: the frames of its trajectory in one HTML page.

use super::colouring::{ColouringError, RunColouring};
use super::particles::{SHOWN, WIDTH, point_radius};
use super::segments::WallSegments;
use super::window;
use crate::cli::display::{UnitSystem, scene_of};
use crate::report::section::{Film, FilmFrame as Moment, FilmSide};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use stripmine_physics::io::FORMATS;
use stripmine_physics::io::extxyz::ParticleFrame;
use stripmine_physics::io::output_format::OutputFormat;
use stripmine_physics::io::trajectory::{FrameReading, Trajectory, TrajectoryError};
use stripmine_physics::number::{count_with_noun, significant};
use stripmine_physics::particles::{Particle, ParticleKind};
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, FilePlace, Reported};

/// Most positions in a film: at two bytes per coordinate and at most two per shade, in base 64, less than 20 million bytes.
const MOST_POSITIONS: usize = 2_400_000;
/// Most frames of a film; more take minutes to watch.
const FRAMES: usize = 1500;
/// Largest displacement of a fixed wall disc, in radii; the rest is rounding.
const STILL: f64 = 1e-6;
/// Most positions used to choose the window.
const LOOKED_AT: usize = 100_000;

/// Errors of making a film.
#[derive(Debug, thiserror::Error)]
pub(super) enum FilmError {
    /// The trajectory has no frame.
    #[error(
        "{} has no frames for a film\n  help: run the scene with --set {}, which writes a frame every run.snapshot_every{others}",
        quoted::path(file),
        film_keys()
    )]
    NoFrame {
        /// The trajectory.
        file: PathBuf,
        /// Existing files of other formats, with what they lack.
        others: String,
    },
    /// The trajectory cannot be read.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// The particles cannot be coloured this way.
    #[error(transparent)]
    Colouring(#[from] ColouringError),
}

impl Reported for FilmError {
    fn class(&self) -> ErrorClass {
        match self {
            FilmError::Trajectory(error) if error.is_of_system => ErrorClass::InputOutput,
            FilmError::NoFrame { .. } | FilmError::Trajectory(_) => ErrorClass::Input,
            FilmError::Colouring(error) => error.class(),
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            FilmError::NoFrame { file, .. } => Some(FilePlace::at(file)),
            FilmError::Trajectory(error) => {
                Some(FilePlace { line: error.line, ..FilePlace::at(&error.file) })
            }
            FilmError::Colouring(_) => None,
        }
    }
}

/// Output keys whose files a film can be made from.
fn film_keys() -> String {
    let read = FORMATS.iter().filter(|format| format.is_read());
    read.map(|format| format!("output.{}=true", format.key)).collect::<Vec<_>>().join(" or ")
}

/// Files of a run that cannot be used for a film, with what they lack.
fn unusable_files(run: &Path) -> String {
    let lacking = |format: &OutputFormat| match format.reading {
        FrameReading::Lacks(what) => Some(format!("; {} has no {what}", format.file)),
        FrameReading::Opens(_) | FrameReading::Never => None,
    };
    FORMATS.iter().filter(|format| run.join(format.file).exists()).filter_map(lacking).collect()
}

/// Film of a run, with notes for the viewer.
///
/// # Errors
/// If the trajectory is missing or cannot be read, or its particles cannot be coloured this way.
pub(super) fn film(run: &Path, colours: &RunColouring) -> Result<(Film, Vec<String>), FilmError> {
    let trajectory = Trajectory::open(run)?;
    let file = trajectory.path().to_owned();
    let mut reel = FilmFrames::default();
    for frame in trajectory {
        reel.add(frame?, colours)?;
    }
    let Some((last, cast)) = reel.last.take() else {
        return Err(FilmError::NoFrame { file, others: unusable_files(run) });
    };
    let scene = scene_of(run);
    let walls = WallSegments::of_run(run, scene.as_ref());
    let (mut film, notes) = reel.film(&last, cast, colours, (scene.as_ref(), &walls))?;
    let name = run.file_stem().unwrap_or_default().to_string_lossy();
    film.title = format!("{}: {}", quoted::quoted(&name), film.title);
    Ok((film, notes))
}

/// Particles in the film, as of the first frame.
struct FilmParticles {
    /// Index of each particle in every frame, by its id.
    places: HashMap<u32, usize>,
    particles: Vec<Particle>,
    /// Stride: one of this many particles is shown.
    every: usize,
}

impl FilmParticles {
    fn of(frame: &ParticleFrame) -> FilmParticles {
        let all = frame.particles.all();
        let every = all.len().div_ceil(SHOWN).max(1);
        let particles: Vec<Particle> = all.iter().step_by(every).copied().collect();
        let places = particles.iter().enumerate().map(|(place, particle)| (particle.id, place)).collect();
        FilmParticles { places, particles, every }
    }
}

/// Frames read so far. When there are too many, every other one is dropped.
#[derive(Default)]
struct FilmFrames {
    /// Frames read.
    read: usize,
    /// Every `stride`-th frame is kept, all if less than 2. It doubles when frames are dropped.
    stride: usize,
    kept: Vec<(f64, Vec<Option<FilmPosition>>)>,
    /// The latest frame, and the cast.
    last: Option<(ParticleFrame, FilmParticles)>,
}

/// Position of a particle in a frame, and its value if it has one.
#[derive(Clone, Copy)]
struct FilmPosition {
    position: [f64; 3],
    value: f64,
}

impl FilmFrames {
    fn add(&mut self, frame: ParticleFrame, colours: &RunColouring) -> Result<(), FilmError> {
        let cast = self.last.take().map_or_else(|| FilmParticles::of(&frame), |(_, cast)| cast);
        if self.read.is_multiple_of(self.stride.max(1)) {
            let values = colours.values(&frame)?;
            let mut seen = vec![None; cast.particles.len()];
            // Grains come before walls; only grains have values.
            for (at, particle) in frame.particles.all().iter().enumerate() {
                if let Some(&place) = cast.places.get(&particle.id) {
                    let value = values.get(at).copied().unwrap_or(f64::NAN);
                    seen[place] = Some(FilmPosition { position: particle.position, value });
                }
            }
            self.kept.push((frame.time, seen));
            if self.kept.len() > (MOST_POSITIONS / cast.particles.len().max(1)).clamp(2, FRAMES) {
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
        last: &ParticleFrame,
        cast: FilmParticles,
        colours: &RunColouring,
        (scene, walls): (Option<&toml::Table>, &WallSegments),
    ) -> Result<(Film, Vec<String>), FilmError> {
        const AXES: [usize; 2] = [0, 1];
        let everywhere = || self.kept.iter().flat_map(|(_, seen)| seen).flatten();
        let grains = || everywhere().filter(|seen| !seen.value.is_nan());
        let some = (self.kept.len() * cast.particles.len()).div_ceil(LOOKED_AT).max(1);
        let places: Vec<[f64; 3]> = grains().step_by(some).map(|seen| seen.position).collect();
        let bounds = window::bounds(last, scene, &places, AXES);
        let [[left, right], [low, high]] =
            window::visible_window(last, &places, (AXES, !walls.is_empty()), bounds);
        let shades = colours.ends(grains().map(|seen| seen.value).collect())?;
        let is_seen = |[x, y, _]: [f64; 3], radius: f64| {
            x > left - radius && x < right + radius && y > low - radius && y < high + radius
        };
        let point = point_radius(cast.particles.len());
        let of_a_point = point / WIDTH * (right - left).max(high - low);
        let is_of_points = window::has_point_bodies(last, bounds);
        let radius = |particle: &Particle| if is_of_points { of_a_point } else { particle.radius };
        // Fixed walls are drawn once.
        let is_still = |place: usize| {
            let Particle { kind, position: first, radius, .. } = cast.particles[place];
            let stays = |(_, seen): &(f64, Vec<Option<FilmPosition>>)| {
                let is_near = |(a, b): (f64, f64)| (a - b).abs() <= STILL * radius;
                seen[place].is_some_and(|it| it.position.into_iter().zip(first).all(is_near))
            };
            kind == ParticleKind::Wall && self.kept.iter().all(stays)
        };
        let (fixed, moving): (Vec<usize>, Vec<usize>) =
            (0..cast.particles.len()).partition(|&at| is_still(at));
        let mut beyond = 0;
        let mut disc = |seen: &[Option<FilmPosition>], place: usize| match seen[place] {
            Some(FilmPosition { position, value }) if is_seen(position, radius(&cast.particles[place])) => {
                ([position[0], position[1]], value)
            }
            other => {
                beyond += usize::from(other.is_some());
                ([f64::NAN; 2], f64::NAN)
            }
        };
        let window = [[left, low], [right, high]];
        let frames: Vec<Moment> = self
            .kept
            .iter()
            .map(|(time, seen)| Moment {
                time: *time,
                walls: walls.moving(*time, window),
                discs: moving.iter().map(|&place| disc(seen, place)).collect(),
            })
            .collect();
        let grain_count = cast.particles.iter().filter(|it| it.kind == ParticleKind::Grain).count();
        let gravity = scene.and_then(|scene| window::domain_pair(scene, "gravity")).unwrap_or([0.0; 2]);
        let [width, height] = [right - left, high - low];
        let planes = walls.resting(window).into_iter().map(|ends| FilmSide { ends, is_periodic: false });
        let film = Film {
            title: format!(
                "{}, time {} to {}",
                count_with_noun(grain_count, "particle", "particles"),
                self.kept.first().map_or(0.0, |(time, _)| *time),
                self.kept.last().map_or(0.0, |(time, _)| *time)
            ),
            units: UnitSystem::of(scene).of_length_and_time(),
            window,
            sides: sides(last, bounds, window).into_iter().chain(planes).collect(),
            falls: if height > width { gravity[1] < 0.0 } else { gravity[0] > 0.0 },
            radii: moving.iter().map(|&place| radius(&cast.particles[place])).collect(),
            fixed: fixed
                .iter()
                .map(|&place| &cast.particles[place])
                .map(|wall| (wall.planar_position(), wall.radius))
                .collect(),
            frames,
            shade: colours.label(scene),
            shades,
        };
        let beyond = beyond as f64 / (self.kept.len() * moving.len()).max(1) as f64;
        let notes = self.notes(&cast, &film, is_of_points, beyond);
        Ok((film, notes))
    }

    /// Notes for the viewer: what is not shown, the fraction of positions outside the picture, and how things are drawn.
    fn notes(&self, cast: &FilmParticles, film: &Film, is_of_points: bool, beyond: f64) -> Vec<String> {
        let mut seen = self.kept.iter().flat_map(|(_, seen)| seen).flatten();
        let notes = [
            (self.read == 1).then(|| {
                "The trajectory has only one frame; a smaller run.snapshot_every writes more.".to_owned()
            }),
            (self.stride > 1)
                .then(|| format!("Shows one of every {} frames, of {}.", self.stride, self.read)),
            (cast.every > 1).then(|| format!("Shows one of every {} particles.", cast.every)),
            seen.any(|seen| seen.position[2] != 0.0)
                .then(|| "Seen along z: x to the right, y upwards.".to_owned()),
            is_of_points.then(|| "Bodies have no size; the dots are enlarged.".to_owned()),
            (beyond > 0.0).then(|| {
                format!("Outside the picture: {} % of all positions.", significant(100.0 * beyond, 2))
            }),
            film.sides
                .iter()
                .any(|side| side.is_periodic)
                .then(|| "Dashed lines: periodic sides.".to_owned()),
        ];
        notes.into_iter().flatten().collect()
    }
}

/// Sides of the box that lie within a window.
fn sides(frame: &ParticleFrame, bounds: [[f64; 2]; 2], [corner, end]: [[f64; 2]; 2]) -> Vec<FilmSide> {
    let mut sides = vec![];
    for axis in [0, 1] {
        let is_periodic = window::is_periodic(frame, axis);
        for at in bounds[axis].into_iter().filter(|at| (corner[axis]..=end[axis]).contains(at)) {
            let ends = [corner, end].map(|mut place| {
                place[axis] = at;
                place
            });
            sides.push(FilmSide { ends, is_periodic });
        }
    }
    sides
}
