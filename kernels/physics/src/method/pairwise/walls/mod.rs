//! Plane walls of stepped discs: their motion, and their contacts with the discs.

mod contacts;
mod grid;
mod motion;

pub(crate) use contacts::{WallTouch, each_touch, touching_disc};
pub(crate) use grid::WallGrid;
pub use motion::PlaneMotion;
pub(crate) use motion::WallDrive;
pub(crate) use motion::WallTracks;

use super::PrescribedMotion;
use crate::domain::Domain;
use stripmine_kernels::sweep::walls::{PieceShape, WallPiece, WallSurface, pieces};

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
        let walls = PlaneWalls { walls, pieces: vec![], periods, corner: domain.corner(), reach };
        walls.joined(&WallTracks::new(&walls))
    }

    /// Joins these walls where ends coincide and keep their distance along these tracks.
    pub(crate) fn joined(&self, tracks: &WallTracks) -> PlaneWalls {
        let segments: Vec<[[f64; 2]; 2]> = self.walls.iter().map(|wall| wall.ends).collect();
        let are_joined = |a: usize, b: usize| a == b || tracks.keep_distance(a, b);
        let pieces = pieces(&segments, self.periods, JOINED * self.reach, are_joined);
        PlaneWalls { pieces, ..self.clone() }
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

    /// Pieces of moved walls, their middles inside the box along periodic sides.
    pub(crate) fn pieces_at(&self, motions: &[PrescribedMotion]) -> Vec<WallPiece> {
        let at = |piece: &WallPiece| {
            let piece = piece.moved(motions[piece.wall as usize].displacement);
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

    /// Middle of a moved wall (length).
    pub(crate) fn middle_at(&self, wall: usize, motions: &[PrescribedMotion]) -> [f64; 2] {
        let [a, b] = self.walls[wall].ends;
        let moved = motions[wall].displacement;
        [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]) + moved[axis])
    }

    /// Surfaces of all moved walls.
    pub(crate) fn surfaces_at(&self, motions: &[PrescribedMotion]) -> Vec<WallSurface> {
        let at = |(wall, motion): (&PlaneWall, &PrescribedMotion)| WallSurface {
            velocity: motion.velocity,
            normal_damping: wall.normal_damping,
            shear_damping: wall.shear_damping,
            friction: wall.friction,
        };
        self.walls.iter().zip(motions).map(at).collect()
    }

    /// Vectors from the box to its images that a disc inside the box may touch (length).
    fn images(&self) -> Vec<[f64; 2]> {
        let [x, y] = self.periods.map(|period| period.map_or(vec![0.0], |period| vec![-period, 0.0, period]));
        x.iter().flat_map(|&x| y.iter().map(move |&y| [x, y])).collect()
    }
}
