//! Plane walls of a scene as lines of a picture.

use super::window;

/// True if a scene has plane walls.
pub(super) fn has_walls(scene: Option<&toml::Table>) -> bool {
    scene.is_some_and(|scene| scene.contains_key("walls"))
}

/// Parts of the plane walls of a scene that are inside a window at a time, with their periodic images (length).
pub(super) fn segments(scene: &toml::Table, time: f64, window: [[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
    let walls = scene.get("walls").and_then(toml::Value::as_array).map_or(&[][..], Vec::as_slice);
    let images = images(scene);
    let of_wall = |wall: &toml::Value| {
        let pair = |key: &str| wall.get(key).and_then(window::pair);
        let frequency = wall.get("frequency").and_then(toml::Value::as_float).unwrap_or(0.0);
        let swing = (std::f64::consts::TAU * frequency * time).sin();
        let [velocity, amplitude] = ["velocity", "amplitude"].map(|key| pair(key).unwrap_or_default());
        let moved = [0, 1].map(|axis| velocity[axis] * time + amplitude[axis] * swing);
        Some([pair("from")?, pair("to")?].map(|end| [end[0] + moved[0], end[1] + moved[1]]))
    };
    let all = walls.iter().filter_map(of_wall).flat_map(|ends| {
        // As many periods back as it has moved.
        let middle = [0, 1].map(|axis| 0.5 * (ends[0][axis] + ends[1][axis]) - window[0][axis]);
        let back =
            [0, 1].map(|axis| images[axis].1.map_or(0.0, |period| (middle[axis] / period).floor() * period));
        let shifted = move |[x, y]: [f64; 2]| ends.map(|end| [end[0] - back[0] + x, end[1] - back[1] + y]);
        let shifts = images[0].0.iter().flat_map(|&x| images[1].0.iter().map(move |&y| [x, y]));
        shifts.filter_map(|shift| clipped(shifted(shift), window)).collect::<Vec<_>>()
    });
    all.collect()
}

/// True if a wall of a scene moves.
fn moves(wall: &toml::Value) -> bool {
    wall.get("velocity").is_some() || wall.get("amplitude").is_some()
}

/// A scene with its plane walls at rest alone, and true if others move.
pub(super) fn resting(scene: &toml::Table) -> (toml::Table, bool) {
    let mut scene = scene.clone();
    let walls = scene.get_mut("walls").and_then(toml::Value::as_array_mut);
    let all = walls.as_ref().map_or(0, |walls| walls.len());
    let still = walls.map_or(0, |walls| {
        walls.retain(|wall| !moves(wall));
        walls.len()
    });
    (scene, still < all)
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

    /// A wall that moves is left out of what rests.
    #[test]
    fn moving_walls_do_not_rest() {
        let scene = "[[walls]]\nfrom = [0.0, 1.0]\nto = [1.0, 1.0]\nvelocity = [1.0, 0.0]\n\
            [[walls]]\nfrom = [0.0, 2.0]\nto = [1.0, 2.0]\n";
        let (rest, others_move) = resting(&scene.parse().unwrap());
        let window = [[0.0, 0.0], [5.0, 5.0]];
        assert!(others_move && segments(&rest, 7.0, window) == [[[0.0, 2.0], [1.0, 2.0]]]);
        assert!(!resting(&rest).1 && !resting(&toml::Table::new()).1);
    }

    /// A wall that has moved by one and a half periods is seen in two parts; one outside the window is not seen.
    #[test]
    fn walls_are_cut_at_the_window() {
        let scene = "[domain]\nsides = [10.0, 4.0]\nperiodic = [true, false]\n\
            [[walls]]\nfrom = [0.0, 1.0]\nto = [10.0, 1.0]\nvelocity = [1.0, 0.0]\n\
            [[walls]]\nfrom = [2.0, 7.0]\nto = [3.0, 9.0]\n[[walls]]\nfrom = [2.0, 2.0]\nto = [2.0, 6.0]\n";
        let found = segments(&scene.parse().unwrap(), 15.0, [[0.0, 0.0], [10.0, 4.0]]);
        assert_eq!(found, [[[0.0, 1.0], [5.0, 1.0]], [[5.0, 1.0], [10.0, 1.0]], [[2.0, 2.0], [2.0, 4.0]]]);
    }
}
