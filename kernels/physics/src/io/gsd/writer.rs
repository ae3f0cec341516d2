//! Schema layer of GSD: chunks of a frame.
//!
//! A chunk equal to that of the first frame is omitted, since readers take it from there. This concerns masses, sizes, ids and types if the
//! particles are the same, the box of a planar scene, and angles and spins if nothing rotates.

use super::file::GsdFile;
use super::{
    ANGLE, BOX, CHUNKS, CORNER, COUNT, DIAMETER, DIMENSIONS, EXACT_MASS, EXACT_POSITION, EXACT_VELOCITY,
    GsdFrames, ID, IMAGE, MASS, OMEGA, PERIODIC, POSITION, RADIUS, SIDES, STEP, TIME, TYPE, TYPE_NAMES,
    TYPES, VELOCITY,
};
use crate::io::FileError;
use crate::io::extxyz::ParticleFrame;
use crate::io::growing_file::{FileMark, GrowingFileError};
use crate::io::run_moment::{RunHeader, RunMoment};
use crate::io::sink::Sink;
use crate::io::species::{symbol, type_of};
use crate::particles::Particle;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Frame with its logged values.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedFrame {
    /// Particles in their box, shared with other files.
    pub frame: Arc<ParticleFrame>,
    /// Periods that each particle has crossed along x and y since the start; empty if unknown.
    pub images: Vec<[i32; 2]>,
    /// Value of each logged quantity; NaN if unknown.
    pub values: Vec<f64>,
}

/// Open trajectory.
#[derive(Debug)]
pub struct GsdWriter {
    file: GsdFile,
    /// Names of the logged chunks.
    logged: Vec<String>,
    first: Option<FirstFrame>,
}

/// Properties of the first frame that later frames may omit.
#[derive(Debug)]
struct FirstFrame {
    ids: Vec<u32>,
    /// True if any particle has an angle or rotates.
    turns: bool,
    sides: [f32; 6],
}

impl FirstFrame {
    fn of(frame: &ParticleFrame) -> FirstFrame {
        let particles = frame.particles.all();
        FirstFrame {
            ids: ids(particles).collect(),
            turns: is_any_rotating(particles),
            sides: SchemaBox::of(frame).sides,
        }
    }
}

impl Sink for GsdWriter {
    type Entry = LoggedFrame;

    fn begin(path: PathBuf, header: &RunHeader) -> Result<GsdWriter, FileError> {
        let logged = chunks_of(header);
        Ok(GsdWriter { file: GsdFile::create(path, names(&logged))?, logged, first: None })
    }

    fn resume(
        path: PathBuf,
        header: &RunHeader,
        mark: FileMark,
        _notes: &mut Vec<String>,
    ) -> Result<GsdWriter, GrowingFileError> {
        let logged = chunks_of(header);
        Ok(GsdWriter { file: GsdFile::resume(path, names(&logged), mark)?, logged, first: None })
    }

    fn cut(&mut self) -> Result<(), FileError> {
        self.file.cut()?;
        let path = self.file.path();
        let first = GsdFrames::open(path).and_then(|mut frames| frames.next().transpose());
        let first = first.map_err(|error| FileError::at(path, "reading")(io::Error::other(error)))?;
        self.first = first.map(|frame| FirstFrame::of(&frame));
        Ok(())
    }

    fn entry(moment: &RunMoment<'_>) -> Option<LoggedFrame> {
        let (frame, images) = (moment.frame().clone(), moment.per_particle.images());
        Some(LoggedFrame { frame, images, values: moment.logged() })
    }

    fn write(&mut self, LoggedFrame { frame, images, values }: LoggedFrame) -> io::Result<()> {
        let (particles, SchemaBox { sides, centre, is_plane }) =
            (frame.particles.all(), SchemaBox::of(&frame));
        let first = self.first.as_ref();
        let is_first = first.is_none();
        let is_same = first.is_some_and(|first| first.ids.iter().copied().eq(ids(particles)));
        let is_still = is_same && first.is_some_and(|first| !first.turns) && !is_any_rotating(particles);
        let has_sides = first.is_some_and(|first| first.sides == sides);
        let number = |of: fn(&Particle) -> f64| particles.iter().map(move |it| [of(it)]);
        let single = |of: fn(&Particle) -> f64| particles.iter().map(move |it| [of(it) as f32]);

        let file = &mut self.file;
        file.begin_frame()?;
        file.add(STEP, [[frame.step]])?;
        if is_first {
            file.add(DIMENSIONS, [[if is_plane { 2_u8 } else { 3 }]])?;
        }
        if !has_sides {
            file.add(BOX, sides.map(|side| [side]))?;
        }
        if !is_same {
            file.add(COUNT, [[particles.len() as u32]])?;
        }
        if is_first {
            let last = particles.iter().map(|it| it.species).max().unwrap_or(0);
            let more = (1..=last).map(|species| {
                let [first, second] = symbol(species);
                [first, second, 0]
            });
            let names: Vec<[u8; 3]> = TYPE_NAMES.into_iter().chain(more).collect();
            file.add(TYPES, names.into_iter().map(|name| name.map(|byte| byte as i8)))?;
        }
        if !is_same {
            file.add(TYPE, particles.iter().map(|it| [type_of(it)]))?;
            file.add(MASS, single(|it| it.mass))?;
            file.add(DIAMETER, single(|it| 2.0 * it.radius))?;
        }
        let from_centre =
            |it: &Particle| std::array::from_fn(|axis| (it.position[axis] - centre[axis]) as f32);
        file.add::<f32, 3>(POSITION, particles.iter().map(from_centre))?;
        file.add(VELOCITY, particles.iter().map(|it| it.velocity.map(|v| v as f32)))?;
        if !images.is_empty() {
            file.add(IMAGE, images.iter().map(|&[x, y]| [x, y, 0]))?;
        }
        file.add(TIME, [[frame.time]])?;
        if is_first {
            file.add(SIDES, frame.cell.map(|side| [side]))?;
            file.add(CORNER, frame.origin.map(|at| [at]))?;
            file.add(PERIODIC, frame.periodic.unwrap_or([true; 2]).map(|repeats| [u8::from(repeats)]))?;
        }
        if !is_same {
            file.add(ID, particles.iter().map(|it| [it.id]))?;
            file.add(RADIUS, number(|it| it.radius))?;
            file.add(EXACT_MASS, number(|it| it.mass))?;
        }
        if is_plane {
            file.add(EXACT_POSITION, particles.iter().map(Particle::planar_position))?;
            file.add(EXACT_VELOCITY, particles.iter().map(Particle::planar_velocity))?;
        } else {
            file.add(EXACT_POSITION, particles.iter().map(|it| it.position))?;
            file.add(EXACT_VELOCITY, particles.iter().map(|it| it.velocity))?;
        }
        if !is_still {
            file.add(ANGLE, number(|it| it.angle))?;
            file.add(OMEGA, number(|it| it.omega))?;
        }
        for (name, value) in self.logged.iter().zip(values) {
            file.add(name, [[value]])?;
        }
        file.end_frame()?;
        if is_first {
            self.first = Some(FirstFrame::of(&frame));
        }
        Ok(())
    }

    fn mark(&mut self) -> Result<FileMark, FileError> {
        self.file.sync()
    }
}

fn ids(particles: &[Particle]) -> impl Iterator<Item = u32> {
    particles.iter().map(|it| it.id)
}

fn is_any_rotating(particles: &[Particle]) -> bool {
    particles.iter().any(|it| it.angle != 0.0 || it.omega != 0.0)
}

fn chunks_of(header: &RunHeader) -> Vec<String> {
    header.logged.iter().map(|&place| format!("log/{}", header.columns[place])).collect()
}

fn names(logged: &[String]) -> Vec<String> {
    CHUNKS.into_iter().map(str::to_owned).chain(logged.iter().cloned()).collect()
}

/// Box in the schema's terms.
struct SchemaBox {
    /// Sides along x, y and z, then the tilts.
    sides: [f32; 6],
    /// Centre of the box, the schema's origin.
    centre: [f64; 3],
    is_plane: bool,
}

impl SchemaBox {
    /// A planar box has no depth, and its sides are doubled until they contain discs above an open box. Unbounded space is represented by a cube
    /// about the origin that contains all particles. Its side is a power of two, so that it rarely changes.
    fn of(frame: &ParticleFrame) -> SchemaBox {
        let ParticleFrame { cell: [lx, ly], origin: [x, y], particles, .. } = frame;
        if lx.is_finite() && ly.is_finite() {
            let centre = [x + 0.5 * lx, y + 0.5 * ly, 0.0];
            let side = |axis: usize, mut side: f64| {
                let distances = particles.all().iter().map(|it| (it.position[axis] - centre[axis]).abs());
                let reach = distances.fold(0.0, f64::max);
                while reach > 0.5 * side {
                    side *= 2.0;
                }
                side as f32
            };
            return SchemaBox {
                sides: [side(0, *lx), side(1, *ly), 0.0, 0.0, 0.0, 0.0],
                centre,
                is_plane: true,
            };
        }
        let coordinates = particles.all().iter().flat_map(|it| it.position);
        let side = power_of_two_above(2.0 * coordinates.fold(0.5, |most: f64, x| most.max(x.abs()))) as f32;
        SchemaBox { sides: [side, side, side, 0.0, 0.0, 0.0], centre: [0.0; 3], is_plane: false }
    }
}

/// Next larger power of two of a number from 1 on.
fn power_of_two_above(number: f64) -> f64 {
    const FRACTION: u64 = (1 << 52) - 1;
    2.0 * f64::from_bits(number.to_bits() & !FRACTION)
}
