//! Pictures of the particles of a run: its last state and, in a long box, the density along it over time.

use super::colouring::{ColouringError, RunColouring};
use super::segments::WallSegments;
use super::window;
use crate::cli::display::{UnitSystem, scene_of};
use crate::report::figure::{ChartAxis, Drawing, DrawnShape, Figure, Guide, HeatMap, Picture, Tint};
use std::path::Path;
use stripmine_physics::io::extxyz::ParticleFrame;
use stripmine_physics::io::trajectory::{Trajectory, TrajectoryError};
use stripmine_physics::number::significant;

/// Most particles of a picture; more cannot be seen, and files would be large.
pub(super) const SHOWN: usize = 20_000;
/// Most rows of a map.
const ROWS: usize = 160;
/// Least aspect ratio of a box whose density is drawn.
const LONG: f64 = 4.0;
/// Width of a density bin in mean diameters, as in the figures of BP93's pipe.
const BIN: f64 = 2.5;

/// Most bodies for which earlier positions are drawn.
const TRACED: usize = 12;
/// Most bodies that get individual colours.
const TOLD_APART: usize = 6;
/// Most earlier positions drawn.
const TRACES: usize = 5000;
/// Width of a picture, and of a very wide one (pixels).
pub(super) const WIDTH: f64 = 720.0;
const WIDE: f64 = 1800.0;
/// Radius of the smallest particle, of one of a few point bodies, and of an earlier position (pixels).
const LEAST: f64 = 1.0;
const LARGE_POINT: f64 = 9.0;
const TRACE: f64 = 1.6;
/// Relative thickness of the tracks of coloured bodies, distinguishable in grey print too.
const THICKNESS: [f64; 3] = [1.0, 0.5, 1.5];
/// Most characters of a run's name in a title.
const NAMED: usize = 60;

/// Radius of a point body (pixels). It shrinks with the number of bodies, so that a dense core is visible in a halo.
pub(super) fn point_radius(bodies: usize) -> f64 {
    let shrunk = 2.5 * (1000.0 / bodies as f64).sqrt();
    if bodies <= TRACED { LARGE_POINT } else { shrunk.clamp(1.7, 2.5) }
}

/// Errors of drawing particles.
#[derive(Debug, thiserror::Error)]
pub(super) enum PictureError {
    /// The trajectory cannot be read.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// The particles cannot be coloured this way.
    #[error(transparent)]
    Colouring(#[from] ColouringError),
}

/// Pictures of a trajectory. The direction of gravity comes from the run's scene, if it can be read.
///
/// # Errors
/// If the trajectory cannot be read, or its particles cannot be coloured this way.
pub(super) fn pictures(run: &Path, colours: &RunColouring) -> Result<Vec<Figure>, PictureError> {
    let (mut last, mut slices, mut tracks) = (None, vec![], vec![]);
    for frame in Trajectory::open(run)? {
        let frame: ParticleFrame = frame?;
        slices.extend(slice_counts(&frame).map(|counts| (frame.time, counts)));
        if frame.particles.len() <= TRACED && window::is_endless(&frame) {
            tracks.push(frame.particles.all().iter().map(|particle| particle.position).collect::<Vec<_>>());
        }
        last = Some(frame);
    }
    let Some(last) = last else { return Ok(vec![]) };
    let scene = scene_of(run);
    let every = (tracks.len() * last.particles.len()).div_ceil(TRACES).max(1);
    let traces = tracks.into_iter().step_by(every).flatten().collect::<Vec<_>>();
    let name = short_name(run);
    let walls = WallSegments::of_run(run, scene.as_ref());
    let mut figures =
        state_figures(("last-state", &name), &last, (scene.as_ref(), &walls), &traces, colours)?;
    figures.extend(density_figure(&name, &last, scene.as_ref(), &slices));
    Ok(figures)
}

/// Name of a run or scene in a title.
pub(super) fn short_name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().chars().take(NAMED).collect()
}

/// Pictures of the particles of a frame, of bodies in space from two sides; `picture` is the name of their files, `name` that in titles.
///
/// # Errors
/// If the particles cannot be coloured this way.
pub(super) fn state_figures(
    (picture, name): (&str, &str),
    frame: &ParticleFrame,
    backdrop: (Option<&toml::Table>, &WallSegments),
    traces: &[[f64; 3]],
    colours: &RunColouring,
) -> Result<Vec<Figure>, ColouringError> {
    let has_depth = frame.particles.all().iter().any(|particle| particle.position[2] != 0.0);
    let views: &[ViewDirection] =
        if has_depth { &[ViewDirection::AlongZ, ViewDirection::AlongY] } else { &[ViewDirection::Plane] };
    let values = colours.values(frame)?;
    let ends = colours.ends(values.clone())?;
    let tells_apart = !colours.is_chosen && !traces.is_empty() && frame.particles.len() <= TOLD_APART;
    let (quantity, label) = (colours.quantity(), colours.label(backdrop.0));
    let shades = Shades { values, ends, quantity, label, tells_apart };
    let of_view =
        |&view: &ViewDirection| state_figure((picture, name), frame, backdrop, traces, &shades, view);
    Ok(views.iter().map(of_view).collect())
}

/// Shades of the particles.
struct Shades {
    /// Values of the grains.
    values: Vec<f64>,
    /// Values of the lowest and the highest shade.
    ends: [f64; 2],
    quantity: &'static str,
    label: String,
    /// True if each particle has an individual colour instead.
    tells_apart: bool,
}

/// Direction of view.
#[derive(Clone, Copy, PartialEq)]
enum ViewDirection {
    /// Particles in a plane.
    Plane,
    /// Bodies in space, from above.
    AlongZ,
    /// Bodies in space, from the side.
    AlongY,
}

impl ViewDirection {
    /// Axes drawn to the right and upwards.
    fn axes(self) -> [usize; 2] {
        if self == ViewDirection::AlongY { [0, 2] } else { [0, 1] }
    }
}

/// Gravity of a scene; none if it is zero.
fn gravity(scene: &toml::Table) -> Option<[f64; 2]> {
    let [x, y] = window::domain_pair(scene, "gravity")?;
    ([x, y] != [0.0, 0.0]).then_some([x, y])
}

/// Picture of the particles of a frame.
fn state_figure(
    (picture, name): (&str, &str),
    frame: &ParticleFrame,
    (scene, walls): (Option<&toml::Table>, &WallSegments),
    traces: &[[f64; 3]],
    shades: &Shades,
    view: ViewDirection,
) -> Figure {
    let all = frame.particles.all();
    let Shades { values, ends: [low, high], quantity, label, tells_apart } = shades;
    let every = all.len().div_ceil(SHOWN).max(1);
    let axes = view.axes();
    let flat = |position: [f64; 3]| axes.map(|axis| position[axis]);
    let bounds = window::bounds(frame, scene, traces, axes);
    let [[x, x_end], [y, y_end]] = window::visible_window(frame, traces, (axes, !walls.is_empty()), bounds);
    let (width, height) = (x_end - x, y_end - y);
    // A tall box is drawn lying, its upper end to the left.
    let lies = height > LONG * width;
    let place = |[a, b]: [f64; 2]| if lies { [y_end - b, a - x] } else { [a, b] };
    let window = if lies { [[0.0, 0.0], [height, width]] } else { [[x, y], [x_end, y_end]] };
    let pixels = if lies || width > LONG * height { WIDE } else { WIDTH };
    let pixel = (window[1][0] - window[0][0]) / pixels;
    let is_point = window::has_point_bodies(frame, bounds);
    let radius = |of: f64| if is_point { point_radius(all.len()) * pixel } else { of.max(LEAST * pixel) };
    let (across, up) = (x..=x_end, y..=y_end);
    // Shapes outside the window would cover the labels around it.
    let upright = bounds[0].into_iter().filter(|at| across.contains(at)).map(|at| [[at, y], [at, y_end]]);
    let level = bounds[1].into_iter().filter(|at| up.contains(at)).map(|at| [[x, at], [x_end, at]]);
    let planes = walls.at(frame.time, [[x, y], [x_end, y_end]]);
    let walls = upright.chain(level).chain(planes).map(|ends| DrawnShape::Line { ends: ends.map(place) });
    let is_inside = |position: [f64; 3]| {
        let [a, b] = flat(position);
        across.contains(&a) && up.contains(&b)
    };
    let seen = traces.iter().enumerate().filter(|(_, trace)| is_inside(**trace));
    let earlier = seen.map(|(at, &trace)| {
        let hue = if *tells_apart { at % all.len() } else { 0 };
        let radius = TRACE * THICKNESS[hue % THICKNESS.len()] * pixel;
        DrawnShape::Disc { centre: place(flat(trace)), radius, tint: Tint::Hue(hue) }
    });
    // Grains come before walls; only grains have values.
    let seen = || all.iter().enumerate().step_by(every).filter(|(_, particle)| is_inside(particle.position));
    let shade = |value: &f64| Tint::Shade(((value - low) / (high - low)).clamp(0.0, 1.0));
    let shapes = seen().map(|(at, particle)| DrawnShape::Disc {
        centre: place(flat(particle.position)),
        radius: radius(particle.radius),
        tint: if *tells_apart { Tint::Hue(at) } else { values.get(at).map_or(Tint::Still, shade) },
    });
    let numbers = seen().filter(|_| *tells_apart).map(|(_, particle)| DrawnShape::Text {
        centre: place(flat(particle.position)),
        height: LARGE_POINT * pixel,
        words: particle.id.to_string(),
    });
    let outside = all.iter().filter(|particle| !is_inside(particle.position)).count();
    let [of_length, of_time] = match UnitSystem::of(scene) {
        UnitSystem::Si => ["m", " s"],
        UnitSystem::Other(_) => ["", ""],
    };
    let time = format!("time {}{of_time}", significant(frame.time, 6));
    let mut title = match *tells_apart {
        true => format!("{name}: tracks of {} bodies until {time}", all.len()),
        false => format!("{name}: particles by {quantity} at {time}"),
    };
    match view {
        ViewDirection::Plane => {}
        ViewDirection::AlongZ => title.push_str(", seen along z: x to the right, y upwards"),
        ViewDirection::AlongY => title.push_str(", seen along y: x to the right, z upwards"),
    }
    if all.is_empty() {
        title.push_str("; there are none");
    }
    if !traces.is_empty() && !tells_apart {
        title.push_str("; small dots: earlier positions");
    }
    if outside > 0 {
        title.push_str(&format!("; {outside} of {} outside the picture", all.len()));
    }
    let is_cut = |[low, high]: [f64; 2], [from, to]: [f64; 2]| {
        low.is_finite() && high.is_finite() && (from > low || to < high)
    };
    if is_cut(bounds[0], [x, x_end]) || is_cut(bounds[1], [y, y_end]) {
        title.push_str("; the rest of the box is almost empty");
    }
    if every > 1 {
        title.push_str(&format!("; one of every {every} is shown"));
    }
    let traced = if traces.is_empty() { "" } else { " Small dots: positions in earlier frames." };
    Picture::Drawing(Drawing {
        window,
        width: pixels,
        shapes: walls.chain(earlier).chain(shapes).chain(numbers).collect(),
        shades: (!tells_apart).then(|| (*low, *high, label.clone())),
        guide: Some(Guide {
            unit: of_length.to_owned(),
            gravity: scene
                .and_then(gravity)
                .filter(|_| view == ViewDirection::Plane)
                .map(|[a, b]| if lies { [-b, a] } else { [a, b] }),
        }),
    })
    .figure(if view == ViewDirection::AlongY { format!("{picture}-side") } else { picture.to_owned() }, title)
    .caption(if *tells_apart { traced.trim().to_owned() } else { format!("Shade: {label}.{traced}") })
}

/// Numbers of grains in slices along a long box, from its lower or left end; none if no side is much longer than the other.
fn slice_counts(frame: &ParticleFrame) -> Option<Vec<f64>> {
    let [width, height] = frame.cell;
    let side = if width > LONG * height { 0 } else { 1 };
    if frame.cell[side] <= LONG * frame.cell[1 - side] {
        return None;
    }
    let grains = frame.particles.grains();
    let (count, sum) = grains.iter().fold((0, 0.0), |(count, sum), disc| (count + 1, sum + disc.radius));
    let bins = (frame.cell[side] / (BIN * 2.0 * sum / f64::from(count.max(1)))).floor().clamp(1.0, 400.0);
    let mut counts = vec![0.0; bins as usize];
    for disc in grains {
        let part = (disc.planar_position()[side] - frame.origin[side]) / frame.cell[side];
        counts[((part * bins) as usize).min(bins as usize - 1)] += 1.0;
    }
    Some(counts)
}

/// Map of the density along a long box over time.
fn density_figure(
    name: &str,
    last: &ParticleFrame,
    scene: Option<&toml::Table>,
    slices: &[(f64, Vec<f64>)],
) -> Option<Figure> {
    let ((begun, first), (ended, _)) = (slices.first()?, slices.last()?);
    let bins = first.len();
    let stride = slices.len().div_ceil(ROWS);
    let even = slices.iter().all(|(_, counts)| counts.len() == bins);
    let mean = last.particles.grain_count() as f64 / bins as f64;
    if slices.len() < 2 || !even || mean == 0.0 {
        return None;
    }
    let rows = slices.iter().step_by(stride).map(|(_, counts)| counts.iter().map(|it| it / mean).collect());
    let [width, height] = last.cell;
    let (side, axis_name) = if width > height { (0, "x") } else { (1, "y") };
    let [of_length, of_time] = UnitSystem::of(scene).at_axes();
    let axis = |label: &str, unit: &str, ends| ChartAxis::linear(label, Some(unit)).between(ends);
    Some(
        Picture::Map(HeatMap {
            x: axis(axis_name, &of_length, [last.origin[side], last.origin[side] + last.cell[side]]),
            y: axis("time", &of_time, [*begun, *ended]),
            value: ChartAxis::linear("density, relative to the mean", None),
            rows: rows.collect(),
        })
        .figure("density-map", format!("{name}: density along the box over time"))
        .caption(format!("Number of grains in {bins} slices along the box, relative to the mean.")),
    )
}
