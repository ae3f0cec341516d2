//! Frames of other programs: the schema's chunks in single precision, with the schema's defaults where a chunk is missing.

use super::error::{GsdErrorKind, GsdReadError};
use super::reader::{Chunks, LocatedGsdError};
use super::{BOX, COUNT, DIAMETER, EXACT_MASS, GsdFrames, MASS, POSITION, TYPE, TYPE_NAMES, TYPES, VELOCITY};
use crate::particles::{Particle, ParticleKind};

/// Frame of another program.
pub(crate) struct ForeignFrame {
    /// Particles, with positions from the centre of the box; numbers without a chunk are 0.
    pub(crate) particles: Vec<Particle>,
    /// Sides of the box (length).
    pub(crate) sides: [f64; 3],
    /// True for velocities, diameters and masses that the file has.
    pub(crate) has: [bool; 3],
}

impl GsdFrames {
    /// True if the file has the chunks of this program, in double precision.
    pub(crate) fn is_own(&self) -> bool {
        self.names.iter().any(|name| name == EXACT_MASS)
    }

    /// Reads a frame of another program by its number.
    ///
    /// # Errors
    /// If a chunk has another shape or a number that a particle cannot have.
    pub(crate) fn foreign_frame(
        &mut self,
        number: u64,
        is_planar: bool,
    ) -> Result<ForeignFrame, GsdReadError> {
        let file = self.path().to_owned();
        let read = Chunks { frames: self, number }.foreign(is_planar);
        read.map_err(|(place, reason)| GsdReadError { file, place, reason })
    }
}

impl Chunks<'_> {
    /// Finite numbers of a chunk; none if the file lacks it.
    fn singles(
        &mut self,
        chunk: &'static str,
        rows: usize,
        columns: usize,
    ) -> Result<Option<Vec<f64>>, LocatedGsdError> {
        let Some(numbers) = self.rows::<f32>(chunk, rows, columns)? else { return Ok(None) };
        match numbers.iter().position(|number| !number.is_finite()) {
            None => Ok(Some(numbers.into_iter().map(f64::from).collect())),
            Some(at) => {
                Err(self.number_fault(chunk, at / columns, numbers[at].to_string(), "a finite number"))
            }
        }
    }

    fn number_fault(
        &self,
        chunk: &'static str,
        row: usize,
        found: String,
        expected: &'static str,
    ) -> LocatedGsdError {
        self.wrong(chunk, GsdErrorKind::Number { row, found, expected })
    }

    fn positive_singles(
        &mut self,
        chunk: &'static str,
        rows: usize,
    ) -> Result<Option<Vec<f64>>, LocatedGsdError> {
        let numbers = self.singles(chunk, rows, 1)?;
        match numbers.as_ref().and_then(|numbers| numbers.iter().position(|number| *number <= 0.0)) {
            None => Ok(numbers),
            Some(row) => {
                let found = numbers.map_or(0.0, |numbers| numbers[row]).to_string();
                Err(self.number_fault(chunk, row, found, "a number greater than 0"))
            }
        }
    }

    /// Number of the type that is called as a wall disc, if there is one.
    fn wall_type(&mut self) -> Result<Option<u32>, LocatedGsdError> {
        let Some([rows, columns]) = self.shape(TYPES) else { return Ok(None) };
        // Names may be of signed or of unsigned bytes.
        let bytes = match self.rows::<u8>(TYPES, rows, columns) {
            Ok(bytes) => bytes,
            Err(_) => {
                let signed = self.rows::<i8>(TYPES, rows, columns)?;
                signed.map(|bytes| bytes.into_iter().map(i8::cast_unsigned).collect())
            }
        };
        let bytes: Vec<u8> = bytes.unwrap_or_default();
        let [_, wall] =
            TYPE_NAMES.map(|name| name.split(|&byte| byte == 0).next().unwrap_or_default().to_vec());
        let is_wall = |name: &[u8]| name.split(|&byte| byte == 0).next() == Some(&wall[..]);
        Ok(bytes.chunks(columns.max(1)).position(is_wall).map(|at| at as u32))
    }

    fn foreign(mut self, is_planar: bool) -> Result<ForeignFrame, LocatedGsdError> {
        let count = self.one::<u32>(COUNT)? as usize;
        let Some(sides) = self.singles(BOX, 6, 1)? else {
            return Err(self.wrong(BOX, GsdErrorKind::Missing));
        };
        let tilt = sides[3..].iter().position(|tilt| *tilt != 0.0);
        if let Some(at) = tilt.filter(|&at| at == 0 || !is_planar) {
            let found = sides[3 + at].to_string();
            return Err(self.number_fault(BOX, 3 + at, found, "0, as boxes are rectangles"));
        }
        if let Some(row) = sides[..2].iter().position(|side| *side <= 0.0) {
            return Err(self.number_fault(BOX, row, sides[row].to_string(), "a number greater than 0"));
        }
        let Some(position) = self.singles(POSITION, count, 3)? else {
            return Err(self.wrong(POSITION, GsdErrorKind::Missing));
        };
        let velocity = self.singles(VELOCITY, count, 3)?;
        let diameter = self.positive_singles(DIAMETER, count)?;
        let mass = self.positive_singles(MASS, count)?;
        let wall = self.wall_type()?;
        let kinds = self.rows::<u32>(TYPE, count, 1)?.unwrap_or_default();
        if let Some(at) = velocity
            .as_ref()
            .filter(|_| is_planar)
            .and_then(|velocity| velocity.chunks(3).position(|velocity| velocity[2] != 0.0))
        {
            let found = velocity.map_or(0.0, |velocity| velocity[3 * at + 2]).to_string();
            return Err(self.number_fault(
                VELOCITY,
                at,
                found,
                "0 as the third component, as discs move in a plane",
            ));
        }
        let vector = |of: &[f64], at: usize| [of[3 * at], of[3 * at + 1], of[3 * at + 2]];
        let particle = |at: usize| {
            let kind = kinds.get(at).copied().unwrap_or(0);
            let is_wall = wall == Some(kind);
            // A type of wall discs is no species.
            let before = u32::from(wall.is_some_and(|wall| wall < kind));
            Particle {
                species: if is_wall { 0 } else { (kind - before).min(u8::MAX.into()) as u8 },
                velocity: velocity.as_ref().map_or([0.0; 3], |velocity| vector(velocity, at)),
                radius: diameter.as_ref().map_or(0.0, |diameter| 0.5 * diameter[at]),
                mass: mass.as_ref().map_or(0.0, |mass| mass[at]),
                ..Particle::at_rest(
                    at as u32 + 1,
                    if is_wall { ParticleKind::Wall } else { ParticleKind::Grain },
                    vector(&position, at),
                )
            }
        };
        Ok(ForeignFrame {
            particles: (0..count).map(particle).collect(),
            sides: [sides[0], sides[1], sides[2]],
            has: [velocity.is_some(), diameter.is_some(), mass.is_some()],
        })
    }
}
