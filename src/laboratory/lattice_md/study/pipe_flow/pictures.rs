//! Pictures of a pipe: figures 5 and 6, the density map, and the film.

use super::{Flow, ROWS};
use crate::report::figure::{ChartAxis, Drawing, DrawnShape, Guide, HeatMap, Picture, Tint};
use crate::report::section::{Film, FilmFrame};
use stripmine_physics::particles::{Particle, ParticleKind, Particles};

/// Time of the first snapshot (s).
const FROM: f64 = 10.0;
/// Number of drawn snapshots.
const SNAPSHOTS: usize = 14;
/// Number of frames of the film.
const FRAMES: usize = 24;
/// Rim speed (m/s) at the ends of the shade scale.
const SPIN: f64 = 1.0;
/// Label of the shade scale.
const SHADE: &str = "rim speed ΩR (m/s)";

fn shape(disc: &Particle, offset: [f64; 2], tint: Tint) -> DrawnShape {
    let [x, y] = disc.planar_position();
    let tint = if disc.kind == ParticleKind::Wall { Tint::Still } else { tint };
    DrawnShape::Disc { centre: [x + offset[0], y + offset[1]], radius: disc.radius, tint }
}

/// Half the height of the pipe including the walls.
fn half_height(particles: &Particles) -> f64 {
    particles.all().iter().map(|disc| disc.position[1].abs() + disc.radius).fold(0.0, f64::max)
}

/// Drawing in metres. The pipe is drawn horizontally, with gravity to the right.
fn drawing(window: [[f64; 2]; 2], shapes: Vec<DrawnShape>, shades: Option<(f64, f64, String)>) -> Picture {
    let guide = Some(Guide { unit: "m".into(), gravity: Some([1.0, 0.0]) });
    Picture::Drawing(Drawing { window, width: 1200.0, shapes, shades, guide })
}

/// Figure 5: densest stretch of the pipe at the end, every disc with its spin.
pub(super) fn piece(flow: &Flow) -> Picture {
    let (length, particles) = (flow.length.min(1.2), &flow.frames[flow.frames.len() - 1]);
    let (half, counts) = (half_height(particles), &flow.density[flow.density.len() - 1]);
    let width = flow.length / counts.len() as f64;
    let filled =
        |start: usize| counts.iter().cycle().skip(start).take((length / width) as usize).sum::<u32>();
    let start = (0..counts.len()).max_by_key(|&start| (filled(start), std::cmp::Reverse(start))).unwrap_or(0);
    let left = start as f64 * width;
    let shapes = particles.all().iter().flat_map(|disc| {
        let spin = (0.5 + 0.5 * disc.omega * disc.radius / SPIN).clamp(0.0, 1.0);
        // Discs that leave on the right re-enter on the left.
        [0.0, flow.length].map(|turn| shape(disc, [turn - left, 0.0], Tint::Shade(spin)))
    });
    let inside = |shape: &DrawnShape| match shape {
        DrawnShape::Disc { centre, radius, .. } => centre[0] > -radius && centre[0] < length + radius,
        _ => true,
    };
    let window = [[0.0, -1.1 * half], [length, 1.1 * half]];
    drawing(window, shapes.filter(inside).collect(), Some((-SPIN, SPIN, SHADE.into())))
}

/// Times and states of the first `most` samples from [`FROM`].
fn shown(flow: &Flow, most: usize) -> impl Iterator<Item = (f64, &Particles)> {
    let first = flow.times.partition_point(|&time| time < FROM - 1e-9);
    flow.times.iter().copied().zip(&flow.frames).skip(first).take(most)
}

/// Figure 6: snapshots of the whole pipe, the earliest at the bottom.
pub(super) fn snapshots(flow: &Flow) -> Picture {
    let half = half_height(&flow.frames[0]);
    let pitch = (2.6 * half).max(flow.length / 32.0);
    let left = 0.12 * flow.length;
    let (mut shapes, mut rows) = (vec![], 0.0);
    for (time, particles) in shown(flow, SNAPSHOTS) {
        let up = rows * pitch;
        let words = format!("{time:.2} s");
        shapes.push(DrawnShape::Text { centre: [-0.5 * left, up], height: 0.45 * pitch, words });
        for rim in [-half, half] {
            shapes.push(DrawnShape::Line { ends: [[0.0, up + rim], [flow.length, up + rim]] });
        }
        shapes.extend(particles.grains().iter().map(|disc| shape(disc, [0.0, up], Tint::Hue(0))));
        rows += 1.0;
    }
    drawing([[-left, -0.6 * pitch], [1.01 * flow.length, (rows - 0.4) * pitch]], shapes, None)
}

/// Density by position and time.
pub(super) fn map(flow: &Flow) -> Picture {
    let stride = flow.density.len().div_ceil(ROWS);
    let bins = flow.density[0].len();
    let mean = flow.grains as f64 / bins as f64;
    let row = |samples: &[Vec<u32>]| {
        let sum = |bin: usize| samples.iter().map(|counts| f64::from(counts[bin])).sum::<f64>();
        (0..bins).map(|bin| rounded(sum(bin) / samples.len() as f64 / mean)).collect()
    };
    let rows: Vec<Vec<f64>> = flow.density.chunks(stride).map(row).collect();
    let end = flow.times[1] * (rows.len() * stride) as f64;
    Picture::Map(HeatMap {
        x: ChartAxis::linear("place along the pipe, the way grains fall", Some("m"))
            .between([0.0, flow.length]),
        y: ChartAxis::linear("time", Some("s")).between([0.0, end]),
        value: ChartAxis::linear("density, relative to the mean", None),
        rows,
    })
}

/// Rounds to four decimals, since more are not visible.
fn rounded(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// Film of the snapshots.
pub(super) fn film(flow: &Flow) -> Film {
    let start = &flow.frames[0];
    let half = half_height(start);
    let frames = shown(flow, FRAMES).map(|(time, particles)| {
        let disc = |disc: &Particle| (disc.planar_position().map(rounded), rounded(disc.omega * disc.radius));
        FilmFrame { time, walls: vec![], discs: particles.grains().iter().map(disc).collect() }
    });
    Film {
        title: String::new(),
        units: ["m", "s"].map(str::to_owned),
        window: [[0.0, -half], [flow.length, half]],
        sides: vec![],
        falls: true,
        radii: start.grains().iter().map(|disc| disc.radius).collect(),
        fixed: start.all()[flow.grains..].iter().map(|disc| (disc.planar_position(), disc.radius)).collect(),
        frames: frames.collect(),
        shade: SHADE.into(),
        shades: [-SPIN, SPIN],
    }
}
