//! Plane walls of a scene as lines of a picture.

use super::window;
use std::path::Path;
use stripmine_physics::run::TableReader;

/// Plane walls of a run.
#[derive(Default)]
pub(super) struct WallSegments {
    walls: Vec<WallPath>,
    images: [(Vec<f64>, Option<f64>); 2],
}

/// Path of a plane wall.
struct WallPath {
    /// Ends at the start (length).
    ends: [[f64; 2]; 2],
    velocity: [f64; 2],
    amplitude: [f64; 2],
    frequency: f64,
    /// Times and middles of the rows, where the motion does not follow from the scene alone.
    rows: Vec<(f64, [f64; 2])>,
    moves: bool,
}

impl WallPath {
    /// Path of a wall of a scene; none without ends.
    fn of(scene: &toml::Table, wall: &toml::Value) -> Option<WallPath> {
        let pair = |key: &str| wall.get(key).and_then(window::pair);
        let number = |key: &str| wall.get(key).and_then(toml::Value::as_float).unwrap_or(0.0);
        let ends = match wall.get("side").and_then(toml::Value::as_str) {
            Some(side) => side_ends(scene, side)?,
            None => [pair("from")?, pair("to")?],
        };
        Some(WallPath {
            ends,
            velocity: pair("velocity").unwrap_or_default(),
            amplitude: pair("amplitude").unwrap_or_default(),
            frequency: number("frequency"),
            rows: vec![],
            moves: ["velocity", "amplitude", "mass"].iter().any(|key| wall.get(*key).is_some()),
        })
    }

    /// Displacement at a time (length).
    fn displacement(&self, time: f64) -> [f64; 2] {
        let Some((last, rows)) = self.rows.split_last() else {
            let swing = (std::f64::consts::TAU * self.frequency * time).sin();
            return [0, 1].map(|axis| self.velocity[axis] * time + self.amplitude[axis] * swing);
        };
        let after = self.rows.partition_point(|(at, _)| *at < time);
        let (to, middle) = self.rows.get(after).unwrap_or(last);
        let (from, before) = after.checked_sub(1).and_then(|it| rows.get(it)).unwrap_or(&self.rows[0]);
        let share = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        let start = |axis: usize| 0.5 * (self.ends[0][axis] + self.ends[1][axis]);
        [0, 1].map(|axis| before[axis] + share * (middle[axis] - before[axis]) - start(axis))
    }
}

/// Ends of a side of the box (length).
fn side_ends(scene: &toml::Table, side: &str) -> Option<[[f64; 2]; 2]> {
    let [width, height] = window::domain_pair(scene, "sides")?;
    let [left, bottom] = window::domain_pair(scene, "origin").unwrap_or_default();
    let [right, top] = [left + width, bottom + height];
    Some(match side {
        "left" => [[left, bottom], [left, top]],
        "right" => [[right, bottom], [right, top]],
        "bottom" => [[left, bottom], [right, bottom]],
        _ => [[left, top], [right, top]],
    })
}

impl WallSegments {
    /// Walls of the scene of a run. The rows of the run tell where walls are that a force drives, or whose velocity was changed.
    pub(super) fn of_run(run: &Path, scene: Option<&toml::Table>) -> WallSegments {
        let Some(scene) = scene else { return WallSegments::default() };
        let mut segments = WallSegments::of(scene);
        let is_changed = run.join("changes.csv").exists();
        let labels = walls(scene).iter().zip(1..).map(|(wall, number): (_, usize)| {
            let side = wall.get("side").and_then(toml::Value::as_str);
            let is_driven = wall.get("mass").is_some();
            (side.map_or_else(|| number.to_string(), str::to_owned), is_driven || is_changed)
        });
        for (path, (label, needs_rows)) in segments.walls.iter_mut().zip(labels) {
            if needs_rows && path.moves {
                path.rows = middles(run, &label).unwrap_or_default();
            }
        }
        segments
    }

    /// True without walls.
    pub(super) fn is_empty(&self) -> bool {
        self.walls.is_empty()
    }

    /// Walls of a scene that follow its prescribed motions.
    pub(super) fn of(scene: &toml::Table) -> WallSegments {
        let walls = walls(scene).iter().filter_map(|wall| WallPath::of(scene, wall)).collect();
        WallSegments { walls, images: images(scene) }
    }

    /// Parts of all walls that are inside a window at a time, with their periodic images (length).
    pub(super) fn at(&self, time: f64, window: [[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
        self.inside(|_| true, time, window)
    }

    /// Parts of the walls at rest.
    pub(super) fn resting(&self, window: [[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
        self.inside(|path| !path.moves, 0.0, window)
    }

    /// Parts of the walls that move, at a time.
    pub(super) fn moving(&self, time: f64, window: [[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
        self.inside(|path| path.moves, time, window)
    }

    fn inside(
        &self,
        is_seen: impl Fn(&WallPath) -> bool,
        time: f64,
        window: [[f64; 2]; 2],
    ) -> Vec<[[f64; 2]; 2]> {
        let images = &self.images;
        let all = self.walls.iter().filter(|path| is_seen(path)).flat_map(|path| {
            let moved = path.displacement(time);
            let ends = path.ends.map(|end| [end[0] + moved[0], end[1] + moved[1]]);
            // As many periods back as it has moved.
            let middle = [0, 1].map(|axis| 0.5 * (ends[0][axis] + ends[1][axis]) - window[0][axis]);
            let back = [0, 1]
                .map(|axis| images[axis].1.map_or(0.0, |period| (middle[axis] / period).floor() * period));
            let shifted =
                move |[x, y]: [f64; 2]| ends.map(|end| [end[0] - back[0] + x, end[1] - back[1] + y]);
            let shifts = images[0].0.iter().flat_map(|&x| images[1].0.iter().map(move |&y| [x, y]));
            shifts.filter_map(|shift| clipped(shifted(shift), window)).collect::<Vec<_>>()
        });
        all.collect()
    }
}

/// Plane walls of a scene.
fn walls(scene: &toml::Table) -> &[toml::Value] {
    scene.get("walls").and_then(toml::Value::as_array).map_or(&[][..], Vec::as_slice)
}

/// Times of the rows of a run, each with the middle of a wall (length); none without such columns.
fn middles(run: &Path, label: &str) -> Option<Vec<(f64, [f64; 2])>> {
    let mut table = TableReader::open(&run.join("thermo.csv")).ok()?;
    let column = |name: String| table.columns().iter().position(|column| *column == name);
    let [time, x, y] =
        [column("time".to_owned())?, column(format!("wall_{label}_x"))?, column(format!("wall_{label}_y"))?];
    let mut rows = vec![];
    while let Ok(Some(row)) = table.next_row() {
        rows.push((row[time], [row[x], row[y]]));
    }
    Some(rows)
}

/// Shifts to the images of a wall along each axis, and the period, if the side is periodic (length).
fn images(scene: &toml::Table) -> [(Vec<f64>, Option<f64>); 2] {
    let periodic = scene.get("domain").and_then(|domain| domain.get("periodic"));
    let is_periodic = |axis: usize| periodic.and_then(|it| it.get(axis)).and_then(toml::Value::as_bool);
    let sides = window::domain_pair(scene, "sides");
    [0, 1].map(|axis| match sides.filter(|_| is_periodic(axis) == Some(true)) {
        Some(sides) => (vec![-sides[axis], 0.0, sides[axis]], Some(sides[axis])),
        None => (vec![0.0], None),
    })
}

/// Part of a segment inside a window; none if it is outside.
fn clipped(ends: [[f64; 2]; 2], [low, high]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let along = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let bounds = [low[axis] - ends[0][axis], high[axis] - ends[0][axis]];
        if along[axis] == 0.0 {
            if bounds[0] > 0.0 || bounds[1] < 0.0 {
                return None;
            }
            continue;
        }
        let [a, b] = bounds.map(|bound| bound / along[axis]);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    let at = |share: f64| [0, 1].map(|axis| ends[0][axis] + share * along[axis]);
    (from < to).then(|| [at(from), at(to)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Walls that move are apart from those that rest.
    #[test]
    fn moving_walls_do_not_rest() {
        let scene = "[[walls]]\nfrom = [0.0, 1.0]\nto = [1.0, 1.0]\nvelocity = [1.0, 0.0]\n\
            [[walls]]\nfrom = [0.0, 2.0]\nto = [1.0, 2.0]\n";
        let walls = WallSegments::of(&scene.parse().unwrap());
        let window = [[0.0, 0.0], [5.0, 5.0]];
        assert_eq!(walls.resting(window), [[[0.0, 2.0], [1.0, 2.0]]]);
        assert_eq!(walls.moving(2.0, window), [[[2.0, 1.0], [3.0, 1.0]]]);
    }

    /// A lid is where the rows of the run say, between two rows on the line between them.
    #[test]
    fn driven_walls_follow_the_rows() {
        let folder = tempfile::tempdir().unwrap();
        let rows = "step,time,wall_top_x,wall_top_y\n0,0.0,2.0,6.0\n10,1.0,2.0,5.0\n20,2.0,2.0,3.0\n";
        std::fs::write(folder.path().join("thermo.csv"), rows).unwrap();
        let scene =
            "[domain]\nsides = [4.0, 6.0]\n[[walls]]\nside = \"top\"\nmass = 1.0\nforce = [0.0, -1.0]\n";
        let scene: toml::Table = scene.parse().unwrap();
        let walls = WallSegments::of_run(folder.path(), Some(&scene));
        for (time, height) in [(0.0, 6.0), (0.5, 5.5), (1.0, 5.0), (1.5, 4.0), (9.0, 3.0)] {
            assert_eq!(walls.at(time, [[0.0; 2], [4.0, 7.0]]), [[[0.0, height], [4.0, height]]], "{time}");
        }
    }

    /// A wall that has moved by one and a half periods is seen in two parts; one outside the window is not seen.
    #[test]
    fn walls_are_cut_at_the_window() {
        let scene = "[domain]\nsides = [10.0, 4.0]\nperiodic = [true, false]\n\
            [[walls]]\nfrom = [0.0, 1.0]\nto = [10.0, 1.0]\nvelocity = [1.0, 0.0]\n\
            [[walls]]\nfrom = [2.0, 7.0]\nto = [3.0, 9.0]\n[[walls]]\nfrom = [2.0, 2.0]\nto = [2.0, 6.0]\n";
        let found = WallSegments::of(&scene.parse().unwrap()).at(15.0, [[0.0, 0.0], [10.0, 4.0]]);
        assert_eq!(found, [[[0.0, 1.0], [5.0, 1.0]], [[5.0, 1.0], [10.0, 1.0]], [[2.0, 2.0], [2.0, 4.0]]]);
    }
}
