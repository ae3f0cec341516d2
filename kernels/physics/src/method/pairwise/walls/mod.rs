//! Plane walls of stepped discs: their motion, and their contacts with the discs.

mod contacts;
mod grid;

pub(crate) use contacts::{WallTouch, each_touch, touching_disc};
pub(crate) use grid::WallGrid;

use super::PrescribedMotion;
use crate::domain::Domain;
use stripmine_kernels::sweep::walls::{PieceShape, WallPiece, WallSurface, pieces};

/// Motion of a plane wall: r(t) = r(0) + v t + a sin(2π f t).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneMotion {
    /// Velocity v (length/time).
    pub velocity: [f64; 2],
    /// Amplitude a (length).
    pub amplitude: [f64; 2],
    /// Frequency f (1/time).
    pub frequency: f64,
}

impl PlaneMotion {
    /// True if the wall is at rest.
    pub(crate) fn is_fixed(&self) -> bool {
        *self == PlaneMotion { frequency: self.frequency, ..PlaneMotion::default() }
    }

    /// Displacement and velocity at a time.
    pub(crate) fn at(&self, time: f64) -> PrescribedMotion {
        let PlaneMotion { velocity: v, amplitude: a, frequency } = *self;
        let rate = std::f64::consts::TAU * frequency;
        // Portable sine and cosine give the same bits on every platform.
        let (sine, cosine) = (libm::sin(rate * time), libm::cos(rate * time));
        PrescribedMotion {
            displacement: [0, 1].map(|axis| v[axis] * time + a[axis] * sine),
            velocity: [0, 1].map(|axis| v[axis] + a[axis] * rate * cosine),
        }
    }

    /// Largest speed (length/time).
    pub(crate) fn fastest(&self) -> f64 {
        let rate = std::f64::consts::TAU * self.frequency;
        self.velocity[0].hypot(self.velocity[1]) + rate * self.amplitude[0].hypot(self.amplitude[1])
    }
}

/// Plane wall: a segment with its motion and its coefficients in the contact law.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneWall {
    /// Label in names of quantities: a number from 1, or the side of the box.
    pub label: String,
    /// Ends at the start (length).
    pub ends: [[f64; 2]; 2],
    /// Motion.
    pub motion: PlaneMotion,
    /// Normal damping (1/time).
    pub normal_damping: f64,
    /// Tangential damping (1/time).
    pub shear_damping: f64,
    /// Friction coefficient.
    pub friction: f64,
}

/// Largest distance of ends that are one point, in largest radii.
const JOINED: f64 = 1e-6;

/// Plane walls of a scene, and the pieces that they consist of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaneWalls {
    walls: Vec<PlaneWall>,
    pieces: Vec<WallPiece>,
    /// Lengths of the periodic sides, and the corner of the box (length).
    periods: [Option<f64>; 2],
    corner: [f64; 2],
    /// Largest radius of a disc (length).
    reach: f64,
}

impl PlaneWalls {
    /// Walls in a box, for discs of radii up to `reach` (length). Ends of walls of one motion that are much closer than this are one point.
    pub(crate) fn new(walls: Vec<PlaneWall>, domain: &Domain, reach: f64) -> PlaneWalls {
        let periods = [0, 1].map(|axis| domain.is_periodic(axis).then(|| domain.length(axis)));
        let segments: Vec<[[f64; 2]; 2]> = walls.iter().map(|wall| wall.ends).collect();
        let pieces = pieces(&segments, periods, JOINED * reach, |a, b| walls[a].motion == walls[b].motion);
        PlaneWalls { walls, pieces, periods, corner: domain.corner(), reach }
    }

    /// True without walls.
    pub fn is_empty(&self) -> bool {
        self.walls.is_empty()
    }

    /// Largest radius of a disc (length).
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// The walls, by their numbers.
    pub fn all(&self) -> &[PlaneWall] {
        &self.walls
    }

    /// True if no wall moves.
    pub(crate) fn are_fixed(&self) -> bool {
        self.walls.iter().all(|wall| wall.motion.is_fixed())
    }

    /// Pieces at a time, their middles inside the box along periodic sides.
    pub(crate) fn pieces_at(&self, time: f64) -> Vec<WallPiece> {
        let moved = self.walls.iter().map(|wall| wall.motion.at(time).displacement);
        let moved: Vec<[f64; 2]> = moved.collect();
        let at = |piece: &WallPiece| {
            let piece = piece.moved(moved[piece.wall as usize]);
            let [a, b] = match piece.shape {
                PieceShape::Inside { ends, .. } => ends,
                PieceShape::Corner { at, .. } => [at; 2],
            };
            piece.moved([0, 1].map(|axis| {
                let middle = 0.5 * (a[axis] + b[axis]) - self.corner[axis];
                self.periods[axis].map_or(0.0, |period| -(middle / period).floor() * period)
            }))
        };
        self.pieces.iter().map(at).collect()
    }

    /// Middle of a wall at a time (length).
    pub(crate) fn middle_at(&self, wall: usize, time: f64) -> [f64; 2] {
        let PlaneWall { ends: [a, b], motion, .. } = &self.walls[wall];
        let moved = motion.at(time).displacement;
        [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]) + moved[axis])
    }

    /// Surfaces of all walls at a time.
    pub(crate) fn surfaces_at(&self, time: f64) -> Vec<WallSurface> {
        let at = |wall: &PlaneWall| WallSurface {
            velocity: wall.motion.at(time).velocity,
            normal_damping: wall.normal_damping,
            shear_damping: wall.shear_damping,
            friction: wall.friction,
        };
        self.walls.iter().map(at).collect()
    }

    /// Vectors from the box to its images that a disc inside the box may touch (length).
    fn images(&self) -> Vec<[f64; 2]> {
        let [x, y] = self.periods.map(|period| period.map_or(vec![0.0], |period| vec![-period, 0.0, period]));
        x.iter().flat_map(|&x| y.iter().map(move |&y| [x, y])).collect()
    }
}
