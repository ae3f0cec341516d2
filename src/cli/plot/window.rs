//! What of a box, or of space, a picture of particles shows: little of it is empty.

use crate::statistics::quantile;
use stripmine_physics::io::extxyz::Frame;

/// Of many particles a few far away do not decide what is seen: these parts of all may lie beyond each end, in a box and in space.
const BEYOND: [f64; 2] = [0.01, 0.025];
/// From this number on there are many.
const MANY: usize = 100;
/// Around what is shown of them (parts of its length).
const AROUND: f64 = 0.1;
/// A box is shown whole where particles take up this part of its length.
const FULL: f64 = 0.6;
/// A side of what is shown is at least this part of the other, and this many largest radii.
const FLATTEST: f64 = 0.25;
const RADII: f64 = 20.0;

/// Whether a frame has no box.
pub(super) fn is_endless(frame: &Frame) -> bool {
    frame.cell.iter().any(|side| side.is_infinite())
}

/// Whether what leaves a frame's box along an axis comes in at the other side.
pub(super) fn is_periodic(frame: &Frame, axis: usize) -> bool {
    !is_endless(frame) && frame.periodic.is_none_or(|periodic| periodic[axis])
}

/// Whether the particles of a frame with these bounds are bodies, which have no size.
pub(super) fn is_of_points(frame: &Frame, bounds: [[f64; 2]; 2]) -> bool {
    is_endless(frame) && bounds.iter().all(|[low, high]| low.is_infinite() && high.is_infinite())
}

/// Two numbers of the scene's `domain`.
pub(super) fn pair(scene: &toml::Table, key: &str) -> Option<[f64; 2]> {
    let pair = scene.get("domain")?.get(key)?.as_array()?;
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    Some([pair.first().and_then(number)?, pair.get(1).and_then(number)?])
}

/// The ends of the box along two axes (length); without end where there is none, or where particles of the frame or of `traces` are
/// beyond it. A frame of a box that is open above does not say how wide it is; the scene does.
pub(super) fn bounds(
    frame: &Frame,
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
        let side = *pair(scene?, "sides")?.get(axis)?;
        let origin = pair(scene?, "origin").map_or(0.0, |origin| origin[axis]);
        // What is open is so above.
        Some([origin, if axis == 1 { f64::INFINITY } else { origin + side }])
    };
    axes.map(|axis| known(axis).unwrap_or(endless))
}

/// What is shown along two axes (length): all of a box, or the part of it, or of space, in which almost all particles are.
pub(super) fn shown(
    frame: &Frame,
    traces: &[[f64; 3]],
    axes: [usize; 2],
    bounds: [[f64; 2]; 2],
) -> [[f64; 2]; 2] {
    let all = frame.particles.all();
    let grains = frame.particles.grains();
    let seen = if grains.is_empty() { all } else { grains };
    // The radius of a body is for viewers: it has none.
    let sizes = seen.iter().map(|particle| if is_of_points(frame, bounds) { 0.0 } else { particle.radius });
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
        // The floor is seen even where nothing lies on it.
        let from = if low.is_finite() && !is_boxed { low } else { (from - around).max(low) };
        let to = (to + around).min(high);
        if is_boxed && to - from > FULL * (high - low) { [low, high] } else { [from, to] }
    });
    let length = |[from, to]: [f64; 2]| to - from;
    let longest = length(occupied[0]).max(length(occupied[1]));
    let least = (FLATTEST * longest).max(RADII * largest);
    let mut shown = occupied;
    for (shown, bounds) in shown.iter_mut().zip(bounds) {
        // A box that is flat itself is shown as it is.
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
    use stripmine_physics::particles::{Kind, Particle, Particles};

    fn frame(places: &[[f64; 3]], cell: [f64; 2]) -> Frame {
        let particle = |(position, id): (&[f64; 3], u32)| Particle {
            id,
            kind: Kind::Grain,
            position: *position,
            velocity: [0.0; 3],
            angle: 0.0,
            omega: 0.0,
            radius: 0.1,
            mass: 1.0,
        };
        let particles = Particles::new(places.iter().zip(1..).map(particle).collect());
        Frame {
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
        shown(&frame, &[], axes, bounds(&frame, None, &[], axes))
    }

    /// A square of n by n places with sides of 10 and its corner at the origin.
    fn square(n: usize) -> Vec<[f64; 3]> {
        let at = |i: usize| 10.0 * (i as f64 + 0.5) / n as f64;
        (0..n * n).map(|i| [at(i % n), at(i / n), at(i % 7)]).collect()
    }

    #[test]
    fn a_box_is_whole_where_it_is_full_or_empty_and_cut_where_most_is_empty() {
        let full = [[0.0, 10.0]; 2];
        assert_eq!(seen(&square(20), [10.0, 10.0], [0, 1]), full);
        assert_eq!(seen(&[], [10.0, 10.0], [0, 1]), full);
        let [x, y] = seen(&square(20), [10.0, 500.0], [0, 1]);
        assert_eq!((x, y[0]), ([0.0, 10.0], 0.0));
        assert!((10.0..13.0).contains(&y[1]), "{y:?}");
    }

    #[test]
    fn bodies_in_space_fill_their_picture_though_one_is_far_away() {
        let far = [square(20), vec![[1e6, -1e6, 1e6]]].concat();
        for axes in [[0, 1], [0, 2]] {
            for [from, to] in seen(&far, [f64::INFINITY; 2], axes) {
                assert!(from > -3.0 && to < 13.0, "{from} {to}");
            }
        }
        // On a line, alone, and none.
        let [x, y] = seen(&[[0.0; 3], [4.0, 0.0, 0.0]], [f64::INFINITY; 2], [0, 1]);
        assert!(x[1] - x[0] < 6.0 && y[1] - y[0] >= 0.25 * (x[1] - x[0]) - 1e-12, "{x:?} {y:?}");
        for places in [&[][..], &[[3.0; 3]]] {
            let shown = seen(places, [f64::INFINITY; 2], [0, 1]);
            assert!(shown.iter().all(|[from, to]| to - from > 0.0 && to - from < 5.0), "{shown:?}");
        }
    }

    /// A picture of bodies is the same in any unit of length, whatever radius they are written with.
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

    /// Where a disc is above the box of its frame there is no ceiling; where it leaves a periodic side, there is one.
    #[test]
    fn a_box_that_is_left_is_open() {
        let mut frame = frame(&[[5.0, 5.0, 0.0], [5.0, 12.0, 0.0]], [10.0, 10.0]);
        let box_of = |frame: &Frame, traces: &[[f64; 3]]| bounds(frame, None, traces, [0, 1]);
        assert_eq!(box_of(&frame, &[]), [[0.0, 10.0], [0.0, 10.0]]);
        frame.periodic = Some([true, false]);
        assert_eq!(box_of(&frame, &[[15.0, 5.0, 0.0]]), [[0.0, 10.0], [0.0, f64::INFINITY]]);
    }

    /// A box that is open above shows its floor and what is above it; how wide it is, the scene says.
    #[test]
    fn an_open_box_shows_its_floor() {
        let frame = frame(&square(20), [f64::INFINITY; 2]);
        let scene: toml::Table = "[domain]\nsides = [10.0, 40.0]".parse().unwrap();
        let bounds = bounds(&frame, Some(&scene), &[], [0, 1]);
        assert_eq!(bounds, [[0.0, 10.0], [0.0, f64::INFINITY]]);
        let [x, y] = shown(&frame, &[], [0, 1], bounds);
        assert_eq!((x, y[0]), ([0.0, 10.0], 0.0));
        assert!((10.0..13.0).contains(&y[1]), "{y:?}");
    }
}
