//! Window of a picture of particles: the part of a box, or of space, that contains almost all of them.

use crate::statistics::quantile;
use stripmine_physics::io::extxyz::ParticleFrame;

/// Fractions of many particles that may lie outside each end of the window, in a box and in space.
const BEYOND: [f64; 2] = [0.01, 0.025];
/// Largest number of particles that are all shown.
const MANY: usize = 100;
/// Margin around the particles, relative to their extent.
const AROUND: f64 = 0.1;
/// Fraction of the box length, occupied by particles, above which the whole box is shown.
const FULL: f64 = 0.6;
/// Least ratio of the sides of the window, and its least side in radii of the largest particle.
const FLATTEST: f64 = 0.25;
const RADII: f64 = 20.0;

/// Returns true if a frame has no box.
pub(super) fn is_endless(frame: &ParticleFrame) -> bool {
    frame.cell.iter().any(|side| side.is_infinite())
}

/// Returns true if a frame's box is periodic along an axis.
pub(super) fn is_periodic(frame: &ParticleFrame, axis: usize) -> bool {
    !is_endless(frame) && frame.periodic.is_none_or(|periodic| periodic[axis])
}

/// Returns true if the particles of a frame with these bounds are bodies, which have no size.
pub(super) fn has_point_bodies(frame: &ParticleFrame, bounds: [[f64; 2]; 2]) -> bool {
    is_endless(frame) && bounds.iter().all(|[low, high]| low.is_infinite() && high.is_infinite())
}

/// Pair of numbers from the scene's `domain`.
pub(super) fn domain_pair(scene: &toml::Table, key: &str) -> Option<[f64; 2]> {
    pair(scene.get("domain")?.get(key)?)
}

/// Pair of numbers of a scene.
pub(super) fn pair(value: &toml::Value) -> Option<[f64; 2]> {
    let pair = value.as_array()?;
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    Some([pair.first().and_then(number)?, pair.get(1).and_then(number)?])
}

/// Ends of the box along two axes (length); infinite without a box, or where particles of the frame or of `traces` are
/// outside it. The width of a box that is open above is in the scene, not in the frame.
pub(super) fn bounds(
    frame: &ParticleFrame,
    scene: Option<&toml::Table>,
    traces: &[[f64; 3]],
    axes: [usize; 2],
) -> [[f64; 2]; 2] {
    let endless = [f64::NEG_INFINITY, f64::INFINITY];
    let places = || frame.particles.grains().iter().map(|it| it.position).chain(traces.iter().copied());
    let known = |axis: usize| -> Option<[f64; 2]> {
        if !is_endless(frame) {
            let (origin, side) = (*frame.origin.get(axis)?, frame.cell.get(axis)?);
            let is_open = !is_periodic(frame, axis) && places().any(|place| place[axis] > origin + side);
            return Some([origin, if is_open { f64::INFINITY } else { origin + side }]);
        }
        let side = *domain_pair(scene?, "sides")?.get(axis)?;
        let origin = domain_pair(scene?, "origin").map_or(0.0, |origin| origin[axis]);
        // An open box is open above.
        Some([origin, if axis == 1 { f64::INFINITY } else { origin + side }])
    };
    axes.map(|axis| known(axis).unwrap_or(endless))
}

/// Window along two axes (length): the whole box if it has plane walls or is full, or the part of it, or of space, with almost all particles.
pub(super) fn visible_window(
    frame: &ParticleFrame,
    traces: &[[f64; 3]],
    (axes, has_walls): ([usize; 2], bool),
    bounds: [[f64; 2]; 2],
) -> [[f64; 2]; 2] {
    let all = frame.particles.all();
    let grains = frame.particles.grains();
    let seen = if grains.is_empty() { all } else { grains };
    // Radii of bodies are only for viewers.
    let sizes =
        seen.iter().map(|particle| if has_point_bodies(frame, bounds) { 0.0 } else { particle.radius });
    let largest = sizes.fold(0.0, f64::max);
    let occupied = [0, 1].map(|which| {
        let [low, high] = bounds[which];
        let is_boxed = low.is_finite() && high.is_finite();
        let places = seen.iter().map(|particle| particle.position).chain(traces.iter().copied());
        let mut places: Vec<f64> = places.map(|place| place[axes[which]]).filter(|x| x.is_finite()).collect();
        places.sort_by(f64::total_cmp);
        let beyond = if places.len() > MANY { BEYOND[usize::from(!is_boxed)] } else { 0.0 };
        let ends = [quantile(&places, beyond), quantile(&places, 1.0 - beyond)];
        let [Some(from), Some(to)] = ends else { return if is_boxed { [low, high] } else { [0.0, 1.0] } };
        let around = AROUND * (to - from) + 2.0 * largest;
        // The floor is always shown.
        let from = if low.is_finite() && !is_boxed { low } else { (from - around).max(low) };
        let to = (to + around).min(high);
        let is_whole = is_boxed && (has_walls || to - from > FULL * (high - low));
        if is_whole { [low, high] } else { [from, to] }
    });
    let length = |[from, to]: [f64; 2]| to - from;
    let longest = length(occupied[0]).max(length(occupied[1]));
    let least = (FLATTEST * longest).max(RADII * largest);
    let mut shown = occupied;
    for (shown, bounds) in shown.iter_mut().zip(bounds) {
        // A flat box is shown as it is.
        if length(*shown) < least && *shown != bounds {
            let middle = shown[0].midpoint(shown[1]);
            *shown = [(middle - 0.5 * least).max(bounds[0]), (middle + 0.5 * least).min(bounds[1])];
        }
        if length(*shown) <= 0.0 {
            let half = (1e-6 * shown[0].abs()).max(0.5);
            *shown = [shown[0] - half, shown[0] + half];
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::particles::{Particle, ParticleKind, Particles};

    fn frame(places: &[[f64; 3]], cell: [f64; 2]) -> ParticleFrame {
        let particle = |(position, id): (&[f64; 3], u32)| Particle {
            id,
            kind: ParticleKind::Grain,
            species: 0,
            position: *position,
            velocity: [0.0; 3],
            angle: 0.0,
            omega: 0.0,
            radius: 0.1,
            mass: 1.0,
        };
        let particles = Particles::new(places.iter().zip(1..).map(particle).collect());
        ParticleFrame {
            particles,
            cell,
            origin: [0.0; 2],
            periodic: None,
            time: 0.0,
            step: 0,
            seed: None,
            has_raised_ids: false,
        }
    }

    fn seen(places: &[[f64; 3]], cell: [f64; 2], axes: [usize; 2]) -> [[f64; 2]; 2] {
        let frame = frame(places, cell);
        visible_window(&frame, &[], (axes, false), bounds(&frame, None, &[], axes))
    }

    /// Square of n × n positions with side 10 and its corner at the origin.
    fn square(n: usize) -> Vec<[f64; 3]> {
        let at = |i: usize| 10.0 * (i as f64 + 0.5) / n as f64;
        (0..n * n).map(|i| [at(i % n), at(i / n), at(i % 7)]).collect()
    }

    #[test]
    fn mostly_empty_boxes_are_cut() {
        let full = [[0.0, 10.0]; 2];
        assert_eq!(seen(&square(20), [10.0, 10.0], [0, 1]), full);
        assert_eq!(seen(&[], [10.0, 10.0], [0, 1]), full);
        let [x, y] = seen(&square(20), [10.0, 500.0], [0, 1]);
        assert_eq!((x, y[0]), ([0.0, 10.0], 0.0));
        assert!((10.0..13.0).contains(&y[1]), "{y:?}");
        // Not if plane walls stand in the empty part.
        let frame = frame(&square(20), [10.0, 500.0]);
        let whole = bounds(&frame, None, &[], [0, 1]);
        assert_eq!(visible_window(&frame, &[], ([0, 1], true), whole), [[0.0, 10.0], [0.0, 500.0]]);
    }

    #[test]
    fn outliers_do_not_shrink_the_picture() {
        let far = [square(20), vec![[1e6, -1e6, 1e6]]].concat();
        for axes in [[0, 1], [0, 2]] {
            for [from, to] in seen(&far, [f64::INFINITY; 2], axes) {
                assert!(from > -3.0 && to < 13.0, "{from} {to}");
            }
        }
        // On a line, a single body, and none.
        let [x, y] = seen(&[[0.0; 3], [4.0, 0.0, 0.0]], [f64::INFINITY; 2], [0, 1]);
        assert!(x[1] - x[0] < 6.0 && y[1] - y[0] >= 0.25 * (x[1] - x[0]) - 1e-12, "{x:?} {y:?}");
        for places in [&[][..], &[[3.0; 3]]] {
            let shown = seen(places, [f64::INFINITY; 2], [0, 1]);
            assert!(shown.iter().all(|[from, to]| to - from > 0.0 && to - from < 5.0), "{shown:?}");
        }
    }

    /// The picture of bodies does not depend on the unit of length or on their nominal radius.
    #[test]
    fn bodies_are_shown_at_their_own_scale() {
        let cross = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, -1.5, 0.0]];
        let of_unit = seen(&cross, [f64::INFINITY; 2], [0, 1]);
        // Along y 3, a tenth around; along x 2, likewise.
        for ([from, to], expected) in of_unit.into_iter().zip([1.2, 1.8]) {
            assert!((to - expected).abs() < 1e-12 && from == -to, "{of_unit:?}");
        }
        for unit in [1e-9, 1e-30, 1.496e11] {
            let scaled = cross.map(|place| place.map(|x| unit * x));
            for ([from, to], [one_from, one_to]) in
                seen(&scaled, [f64::INFINITY; 2], [0, 1]).into_iter().zip(of_unit)
            {
                assert!((from / unit - one_from).abs() < 1e-12 && (to / unit - one_to).abs() < 1e-12);
            }
        }
    }

    /// A box is open above if a disc is above it; leaving a periodic side opens nothing.
    #[test]
    fn boxes_with_discs_above_are_open() {
        let mut frame = frame(&[[5.0, 5.0, 0.0], [5.0, 12.0, 0.0]], [10.0, 10.0]);
        let box_of = |frame: &ParticleFrame, traces: &[[f64; 3]]| bounds(frame, None, traces, [0, 1]);
        assert_eq!(box_of(&frame, &[]), [[0.0, 10.0], [0.0, 10.0]]);
        frame.periodic = Some([true, false]);
        assert_eq!(box_of(&frame, &[[15.0, 5.0, 0.0]]), [[0.0, 10.0], [0.0, f64::INFINITY]]);
    }

    /// A box that is open above shows its floor; its width comes from the scene.
    #[test]
    fn an_open_box_shows_its_floor() {
        let frame = frame(&square(20), [f64::INFINITY; 2]);
        let scene: toml::Table = "[domain]\nsides = [10.0, 40.0]".parse().unwrap();
        let bounds = bounds(&frame, Some(&scene), &[], [0, 1]);
        assert_eq!(bounds, [[0.0, 10.0], [0.0, f64::INFINITY]]);
        let [x, y] = visible_window(&frame, &[], ([0, 1], false), bounds);
        assert_eq!((x, y[0]), ([0.0, 10.0], 0.0));
        assert!((10.0..13.0).contains(&y[1]), "{y:?}");
    }
}
