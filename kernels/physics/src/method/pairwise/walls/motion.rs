//! Motion of plane walls: prescribed, or driven by a force along its direction.

use super::PlaneWalls;
use crate::method::pairwise::PrescribedMotion;

/// Force that drives a wall along its direction, against the grains. The wall does not move sideways and does not turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallDrive {
    /// Mass of the wall.
    pub mass: f64,
    /// Force along x and y.
    pub force: [f64; 2],
}

/// Motion of a plane wall: r(t) = r(0) + v t + a sin(2π f t), or that of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneMotion {
    /// Velocity v (length/time).
    pub velocity: [f64; 2],
    /// Amplitude a (length).
    pub amplitude: [f64; 2],
    /// Frequency f (1/time).
    pub frequency: f64,
    /// Drive of a wall whose motion is not prescribed.
    pub drive: Option<WallDrive>,
}

impl PlaneMotion {
    /// True if the wall is at rest.
    pub(crate) fn is_fixed(&self) -> bool {
        *self == PlaneMotion { frequency: self.frequency, ..PlaneMotion::default() }
    }

    /// Oscillation at a time: displacement and velocity.
    fn oscillation(&self, time: f64) -> PrescribedMotion {
        let PlaneMotion { amplitude: a, frequency, .. } = *self;
        let rate = std::f64::consts::TAU * frequency;
        // Portable sine and cosine give the same bits on every platform.
        let (sine, cosine) = (libm::sin(rate * time), libm::cos(rate * time));
        PrescribedMotion { displacement: a.map(|a| a * sine), velocity: a.map(|a| a * rate * cosine) }
    }

    /// Largest prescribed speed (length/time).
    pub(crate) fn fastest(&self) -> f64 {
        let rate = std::f64::consts::TAU * self.frequency;
        self.velocity[0].hypot(self.velocity[1]) + rate * self.amplitude[0].hypot(self.amplitude[1])
    }
}

/// Motion of one wall along a run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct WallTrack {
    motion: PlaneMotion,
    /// Time since when the wall has its velocity, and its displacement then, without the oscillation (length).
    since: f64,
    from: [f64; 2],
    /// Displacement, velocity and acceleration of a driven wall along its force.
    driven: [f64; 3],
}

impl WallTrack {
    /// Displacement and velocity at a time.
    fn at(&self, time: f64) -> PrescribedMotion {
        if let Some(WallDrive { force: [x, y], .. }) = self.motion.drive {
            let size = x.hypot(y);
            let along = |length: f64| [length * (x / size), length * (y / size)];
            let [displacement, velocity, _] = self.driven;
            return PrescribedMotion { displacement: along(displacement), velocity: along(velocity) };
        }
        let PrescribedMotion { displacement, velocity } = self.motion.oscillation(time);
        let v = self.motion.velocity;
        PrescribedMotion {
            displacement: [0, 1]
                .map(|axis| self.from[axis] + v[axis] * (time - self.since) + displacement[axis]),
            velocity: [0, 1].map(|axis| v[axis] + velocity[axis]),
        }
    }

    /// Acceleration of a driven wall along its force, under the force of the grains.
    fn acceleration(&self, [x, y]: [f64; 2]) -> f64 {
        self.motion.drive.map_or(0.0, |WallDrive { mass, force: [along_x, along_y] }| {
            let size = along_x.hypot(along_y);
            (size + (x * along_x + y * along_y) / size) / mass
        })
    }

    /// Numbers that the future depends on.
    fn state(&mut self) -> [&mut f64; 8] {
        let WallTrack { motion, since, from: [x, y], driven: [displacement, speed, acceleration] } = self;
        let [vx, vy] = &mut motion.velocity;
        [since, x, y, vx, vy, displacement, speed, acceleration]
    }
}

/// Names of the numbers of a wall in checkpoints.
const SAVED: [&str; 8] = [
    "since",
    "from_x",
    "from_y",
    "velocity_x",
    "velocity_y",
    "driven",
    "driven_speed",
    "driven_acceleration",
];

/// Motions of all plane walls along a run. Driven walls follow Newton's law by velocity Verlet.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct WallTracks {
    tracks: Vec<WallTrack>,
    now: Vec<PrescribedMotion>,
}

impl WallTracks {
    /// All walls at the start. Driven walls have no acceleration yet.
    pub(crate) fn new(walls: &PlaneWalls) -> WallTracks {
        let track = |motion| WallTrack { motion, since: 0.0, from: [0.0; 2], driven: [0.0; 3] };
        let tracks = walls.all().iter().map(|wall| track(wall.motion)).collect();
        let mut tracks = WallTracks { tracks, now: vec![] };
        tracks.place(0.0);
        tracks
    }

    /// Displacements and velocities now, by the numbers of the walls.
    pub(crate) fn now(&self) -> &[PrescribedMotion] {
        &self.now
    }

    /// True if no wall moves.
    pub(crate) fn are_fixed(&self) -> bool {
        self.tracks.iter().all(|track| track.motion.is_fixed() && track.from == [0.0; 2])
    }

    /// True if two walls have moved and will move alike.
    pub(super) fn keep_distance(&self, a: usize, b: usize) -> bool {
        self.tracks[a] == self.tracks[b] && self.tracks[a].motion.drive.is_none()
    }

    fn place(&mut self, time: f64) {
        self.now.clear();
        self.now.extend(self.tracks.iter().map(|track| track.at(time)));
    }

    /// Advances by a step of `dt` to a time. The velocities of driven walls are predicted.
    pub(crate) fn advance(&mut self, dt: f64, time: f64) {
        for WallTrack { driven: [displacement, speed, acceleration], .. } in &mut self.tracks {
            *displacement += dt * (*speed + 0.5 * dt * *acceleration);
            *speed += dt * *acceleration;
        }
        self.place(time);
    }

    /// Completes a step of `dt`, or the start with `dt` = 0, with the forces of the grains on the walls.
    pub(crate) fn finish(&mut self, dt: f64, time: f64, forces: &[[f64; 2]]) {
        if self.tracks.iter().all(|track| track.motion.drive.is_none()) {
            return;
        }
        for (track, force) in self.tracks.iter_mut().zip(forces) {
            let acceleration = track.acceleration(*force);
            let [_, speed, before] = &mut track.driven;
            *speed += 0.5 * dt * (acceleration - *before);
            *before = acceleration;
        }
        self.place(time);
    }

    /// Gives all walls whose motion is prescribed other velocities v from a time on (length/time). Driven walls keep theirs.
    pub(crate) fn set_velocities(&mut self, velocities: &[[f64; 2]], time: f64) {
        for (track, velocity) in self.tracks.iter_mut().zip(velocities) {
            let v = track.motion.velocity;
            (0..2).for_each(|axis| track.from[axis] += v[axis] * (time - track.since));
            (track.since, track.motion.velocity) = (time, *velocity);
        }
        self.place(time);
    }

    /// Prescribed motions of all walls now.
    pub(crate) fn motions(&self) -> impl Iterator<Item = PlaneMotion> + '_ {
        self.tracks.iter().map(|track| track.motion)
    }

    /// All numbers by name, for a checkpoint.
    pub(crate) fn entries(&self, walls: &PlaneWalls) -> Vec<(String, f64)> {
        let mut tracks = self.tracks.clone();
        let each = tracks.iter_mut().zip(walls.all()).flat_map(|(track, wall)| {
            let named = SAVED.into_iter().zip(track.state());
            named.map(|(name, value)| (format!("wall.{}.{name}", wall.label), *value))
        });
        each.collect()
    }

    /// Restores what [`entries`](Self::entries) returned, at a time.
    ///
    /// # Errors
    /// As `find`, which returns a number by its name.
    pub(crate) fn restore(
        &mut self,
        walls: &PlaneWalls,
        time: f64,
        find: impl Fn(&str) -> Result<f64, String>,
    ) -> Result<(), String> {
        for (track, wall) in self.tracks.iter_mut().zip(walls.all()) {
            for (name, value) in SAVED.into_iter().zip(track.state()) {
                *value = find(&format!("wall.{}.{name}", wall.label))?;
            }
        }
        self.place(time);
        Ok(())
    }
}
