//! Insides and corners of segments, so that no joint is touched twice.

/// Part of a wall with one closest point: the inside of a segment, or a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPiece {
    /// Number of the wall.
    pub wall: u32,
    /// Its shape.
    pub shape: PieceShape,
}

/// Shape of a piece (length).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PieceShape {
    /// Points between two ends.
    Inside {
        /// The ends.
        ends: [[f64; 2]; 2],
        /// True for an end that belongs to this piece.
        owns: [bool; 2],
    },
    /// An end. It counts for a disc at a displacement u from it only if u·d < 0 for both directions d.
    Corner {
        /// Its position.
        at: [f64; 2],
        /// Unit vectors along the outermost segments that begin here.
        away: [[f64; 2]; 2],
    },
}

impl WallPiece {
    /// The piece displaced by a vector (length).
    #[must_use]
    pub fn moved(self, by: [f64; 2]) -> WallPiece {
        let moved = |[x, y]: [f64; 2]| [x + by[0], y + by[1]];
        let shape = match self.shape {
            PieceShape::Inside { ends, owns } => PieceShape::Inside { ends: ends.map(moved), owns },
            PieceShape::Corner { at, away } => PieceShape::Corner { at: moved(at), away },
        };
        WallPiece { shape, ..self }
    }

    /// Lowest and highest coordinates (length).
    pub(super) fn bounds(&self) -> [[f64; 2]; 2] {
        let [a, b] = match self.shape {
            PieceShape::Inside { ends, .. } => ends,
            PieceShape::Corner { at, .. } => [at; 2],
        };
        [[0, 1].map(|axis| a[axis].min(b[axis])), [0, 1].map(|axis| a[axis].max(b[axis]))]
    }
}

/// Unit vector from one point to another.
pub(super) fn direction([a, b]: [[f64; 2]; 2]) -> [f64; 2] {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    let length = (x * x + y * y).sqrt();
    [x / length, y / length]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Ends and directions that meet at a point.
struct Joint {
    /// Segments that end here, each with the number of its end and its direction away from here.
    ends: Vec<(usize, usize, [f64; 2])>,
    /// True if a segment passes through.
    is_passed: bool,
}

/// Splits segments into insides and corners. Ends closer than `tolerance` (length) are one point, also across a period (length).
/// Segments are joined only if `are_joined`: those that move against each other are not.
pub fn pieces(
    segments: &[[[f64; 2]; 2]],
    periods: [Option<f64>; 2],
    tolerance: f64,
    are_joined: impl Fn(usize, usize) -> bool,
) -> Vec<WallPiece> {
    // The shortest vector from one point to another.
    let apart = |from: [f64; 2], to: [f64; 2]| {
        [0, 1].map(|axis| {
            let along = to[axis] - from[axis];
            periods[axis].map_or(along, |period| along - (along / period).round() * period)
        })
    };
    let joint = |own: usize, at: [f64; 2]| {
        let mut joint = Joint { ends: vec![], is_passed: false };
        for (other, &ends) in segments.iter().enumerate().filter(|&(other, _)| are_joined(own, other)) {
            let along = direction(ends);
            let is_near = ends.map(|end| dot(apart(at, end), apart(at, end)) <= tolerance * tolerance);
            for end in (0..2).filter(|&end| is_near[end]) {
                joint.ends.push((other, end, if end == 0 { along } else { along.map(|x| -x) }));
            }
            if is_near == [false; 2] {
                let middle = [0, 1].map(|axis| 0.5 * (ends[0][axis] + ends[1][axis]));
                let from = apart(middle, at);
                let half = 0.5 * dot(along, [0, 1].map(|axis| ends[1][axis] - ends[0][axis]));
                let beside = from[0] * along[1] - from[1] * along[0];
                joint.is_passed |= beside.abs() <= tolerance && dot(from, along).abs() < half;
            }
        }
        joint
    };
    let mut all = vec![];
    for (own, &ends) in segments.iter().enumerate() {
        let joints = ends.map(|at| joint(own, at));
        let owns = [0, 1].map(|end| {
            let Joint { ends, is_passed } = &joints[end];
            !is_passed && ends.first().is_some_and(|&(first, at, _)| (first, at) == (own, end))
        });
        let wall = own as u32;
        all.push(WallPiece { wall, shape: PieceShape::Inside { ends, owns } });
        for end in (0..2).filter(|&end| owns[end]) {
            let away = joints[end].ends.iter().map(|(.., away)| *away).collect();
            if let Some(away) = outermost(away) {
                all.push(WallPiece { wall, shape: PieceShape::Corner { at: ends[end], away } });
            }
        }
    }
    all
}

/// The two directions beside the widest gap between directions; none if no gap is wider than half a turn, because then a segment is
/// always as near as the point where they meet.
fn outermost(mut directions: Vec<[f64; 2]>) -> Option<[[f64; 2]; 2]> {
    /// Half a turn, and a rounding error more.
    const HALF: f64 = std::f64::consts::PI * (1.0 + 1e-12);
    let angle = |direction: &[f64; 2]| libm::atan2(direction[1], direction[0]);
    directions.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    let count = directions.len();
    let gap = |at: usize| {
        let next = directions[(at + 1) % count];
        (angle(&next) - angle(&directions[at])).rem_euclid(std::f64::consts::TAU)
    };
    if count == 1 {
        return Some([directions[0]; 2]);
    }
    let widest = (0..count).max_by(|&a, &b| gap(a).total_cmp(&gap(b)))?;
    (gap(widest) > HALF).then(|| [directions[widest], directions[(widest + 1) % count]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(segments: &[[[f64; 2]; 2]], periods: [Option<f64>; 2]) -> Vec<[f64; 2]> {
        let all = pieces(segments, periods, 1e-9, |_, _| true);
        let corner = |piece: WallPiece| match piece.shape {
            PieceShape::Corner { at, .. } => Some(at),
            PieceShape::Inside { .. } => None,
        };
        all.into_iter().filter_map(corner).collect()
    }

    /// A straight joint, a joint across the period and an end on another segment have no corner; a bend has one, a free end too.
    #[test]
    fn only_free_ends_and_bends_are_corners() {
        let none = [None; 2];
        assert_eq!(corners(&[[[0.0, 0.0], [2.0, 1.0]]], none), [[0.0, 0.0], [2.0, 1.0]]);
        let straight = [[[0.0, 0.0], [1.0, 0.5]], [[2.0, 1.0], [1.0, 0.5]]];
        assert_eq!(corners(&straight, none), [[0.0, 0.0], [2.0, 1.0]]);
        let bent = [[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 3.0]]];
        assert_eq!(corners(&bent, none), [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0]]);
        assert_eq!(corners(&[[[0.0, 1.0], [7.0, 1.0]]], [Some(7.0), None]), [[0.0; 2]; 0]);
        let tee = [[[-1.0, 0.0], [1.0, 0.0]], [[0.2, 0.0], [0.2, 2.0]]];
        assert_eq!(corners(&tee, none), [[-1.0, 0.0], [1.0, 0.0], [0.2, 2.0]]);
        let star: Vec<_> = [0.0f64, 2.0, 4.0].map(|turn| [[0.0; 2], [turn.cos(), turn.sin()]]).into();
        assert!(!corners(&star, none).contains(&[0.0; 2]));
    }

    /// The two outermost of three segments on one side of a point bound the corner.
    #[test]
    fn corners_are_bounded_by_the_outermost_segments() {
        let [low, middle, high] = [[1.0, 0.0], [0.6, 0.8], [0.0, 1.0]];
        let around = outermost(vec![middle, low, high]).unwrap();
        assert!(around == [high, low], "{around:?}");
        assert_eq!(outermost(vec![[0.0, 1.0], [0.0, -1.0]]), None);
    }

    /// Each end belongs to one inside, the first of those that meet there.
    #[test]
    fn ends_have_one_owner() {
        let bent = [[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 3.0]]];
        let owns = |joined: bool| -> Vec<[bool; 2]> {
            let all = pieces(&bent, [None; 2], 1e-9, |a, b| joined || a == b);
            let owns = |piece: WallPiece| match piece.shape {
                PieceShape::Inside { owns, .. } => Some(owns),
                PieceShape::Corner { .. } => None,
            };
            all.into_iter().filter_map(owns).collect()
        };
        assert_eq!(owns(true), [[true, true], [false, true]]);
        assert_eq!(owns(false), [[true, true], [true, true]]);
    }
}
