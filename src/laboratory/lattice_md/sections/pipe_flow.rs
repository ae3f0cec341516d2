//! Figures 5 and 6 of the source: grains in a pipe.

use crate::laboratory::lattice_md::study::pipe_flow::{FANO_BIN, LOOK, MAP_BIN, PipeFlow};
use crate::report::figure::{Axis, Chart, Drawing, Figure, Guide, Map, Picture, Series, Shape, Style, Tint};
use crate::report::section::{Film, Frame};
use crate::report::{Rows, Section, Table, Verdict};
use stripmine_physics::number::{counted, range, significant};
use stripmine_physics::observe::waves::Directions;
use stripmine_physics::particles::{Kind, Particle, Particles};

/// How a section of the report shows a pipe.
#[derive(Clone, Copy, Debug)]
pub struct Showing {
    /// The item's name.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// What is asked of it.
    pub question: &'static str,
    /// Whether the question is which way the waves run.
    pub asks_ways: bool,
    /// The time from which snapshots are drawn (s), as the source does from 10 s on.
    pub from: f64,
    /// Snapshots that are drawn.
    pub snapshots: usize,
}

/// Waves run a way where its share of the late spectral power is this many times that of either control at least: a gas in which no wave runs,
/// and waves of the same strength that run one way each.
const BEYOND_CONTROL: f64 = 2.0;

/// What came out of runs that differ by their seed, the first of which kept its frames, and of the control.
pub fn section(showing: Showing, flows: &[PipeFlow], control: &PipeFlow) -> Section {
    let first = &flows[0];
    let late: Vec<f64> = flows.iter().map(|flow| flow.late(&flow.fano).value).collect();
    let waves = late.iter().filter(|&&fano| fano > 1.0).count();
    let lasting = first.times.last().copied().unwrap_or(0.0);
    let mean = |share: fn(&Directions) -> f64| {
        100.0 * flows.iter().map(|flow| share(&flow.directions)).sum::<f64>() / flows.len() as f64
    };
    let seen = (!first.frames.is_empty()).then(|| [piece(first), snapshots(showing, first)]);
    let shares: [f64; 3] = [mean(|it| it.back), mean(|it| it.forth), mean(|it| it.standing)];
    let [back, forth, standing] = shares;
    // The least over the runs, in multiples of the controls'.
    let least = |of: &dyn Fn(&Directions) -> f64| {
        flows.iter().map(|flow| of(&flow.directions)).fold(f64::INFINITY, f64::min)
    };
    let beyond_gas = |power: fn(&Directions) -> f64| least(&power) / power(&control.directions);
    let gas = [beyond_gas(|it| it.power * it.back), beyond_gas(|it| it.power * it.forth)];
    // Against gravity is the way of the one wave; what it lacks there runs with gravity, and the other way round.
    let one_wave = least(&|it| it.forth / it.of_one_wave[1]);
    let runs = [gas[0] >= BEYOND_CONTROL, gas[1] >= BEYOND_CONTROL && one_wave >= BEYOND_CONTROL];
    let runs_both = runs == [true; 2];
    let fano = format!(
        "The Fano factor (of waves above 1) rises from {:.2} to {} in {waves} of {} of {lasting:.0} s.",
        first.fano[0],
        range(late.iter().copied(), 3),
        counted(flows.len(), "run", "runs"),
    );
    let both = format!(
        "{}: {back:.0} % of the late spectral power runs against gravity and {forth:.0} % with it: {} and {} times that of an elastic gas without \
         gravity, and with it {} times what waves against gravity alone would have.",
        match runs {
            [true, true] => "Waves run both ways",
            [true, false] => "Waves run against gravity only",
            [false, true] => "Waves run with gravity only",
            [false, false] => "Waves run no way",
        },
        significant(gas[0], 2),
        significant(gas[1], 2),
        significant(one_wave, 2),
    );
    Section::new(showing.name, showing.title)
        .asks(showing.question)
        .expects("BP93, section 4, figures 5 and 6, of which no numbers are printed: grains in a rough vertical pipe, started evenly spread, form \
                  density waves that move both ways.")
        .answers(if showing.asks_ways { format!("{both} {fano}") } else { format!("{fano} {both}") })
        .verdict(Verdict::of_claims(&[waves == flows.len(), runs_both]))
        .details([
            format!(
                "Of the late spectral power {standing:.0} % stands. The strongest Fourier mode grows from {:.3} to {:.2}; the mean velocity is {} \
                 m/s.",
                first.strongest_mode[0],
                first.late(&first.strongest_mode).value,
                first.late(&first.flow),
            ),
            format!(
                "A wave runs a way where its power there is at least {BEYOND_CONTROL:.0} times that of the controls in every run. A wave against gravity \
                 that grows and decays also has power with gravity: the second control has the strength of each wavelength at every moment, and turns \
                 at its mean rate."
            ),
        ])
        .figures(seen.into_iter().flatten())
        .figures([map(first), over_time(flows)])
        .tables([table(flows, control)])
        .film(film(showing, first))
        .seeds(flows.iter().map(|flow| flow.seed))
}

/// Surface speeds (m/s) between the shades' ends: spin times radius.
const SPIN: f64 = 1.0;

/// From −SPIN to SPIN as a shade.
fn spin_shade(disc: &Particle) -> f64 {
    (0.5 + 0.5 * disc.omega * disc.radius / SPIN).clamp(0.0, 1.0)
}

fn shape(disc: &Particle, offset: [f64; 2], tint: Tint) -> Shape {
    let [x, y] = disc.place();
    let tint = if disc.kind == Kind::Wall { Tint::Still } else { tint };
    Shape::Disc { centre: [x + offset[0], y + offset[1]], radius: disc.radius, tint }
}

/// Half the height of the pipe with its walls.
fn half_height(particles: &Particles) -> f64 {
    particles.all().iter().map(|disc| disc.position[1].abs() + disc.radius).fold(0.0, f64::max)
}

/// Figure 5: the densest stretch of the pipe at the end, every disc with its spin.
fn piece(flow: &PipeFlow) -> Figure {
    let length = flow.length.min(1.2);
    let (shapes, half) = flow.frames.last().map_or((vec![], 0.05), |particles| {
        let counts = flow.density.last().map_or(&[][..], |counts| counts);
        let width = flow.length / counts.len().max(1) as f64;
        let bins = (length / width) as usize;
        let filled = |start: usize| counts.iter().cycle().skip(start).take(bins).sum::<u32>();
        let start =
            (0..counts.len()).max_by_key(|&start| (filled(start), std::cmp::Reverse(start))).unwrap_or(0);
        let left = start as f64 * width;
        let shapes = particles.all().iter().flat_map(|disc| {
            // The pipe is closed on itself: what has left on the right comes in on the left.
            [0.0, flow.length].map(|turn| shape(disc, [turn - left, 0.0], Tint::Shade(spin_shade(disc))))
        });
        let inside = |shape: &Shape| match shape {
            Shape::Disc { centre, radius, .. } => centre[0] > -radius && centre[0] < length + radius,
            _ => true,
        };
        (shapes.filter(inside).collect(), half_height(particles))
    });
    Picture::Drawing(Drawing {
        window: [[0.0, -1.1 * half], [length, 1.1 * half]],
        width: 1200.0,
        shapes,
        shades: Some((-SPIN, SPIN, "rim speed ΩR (m/s)".into())),
        guide: guide(),
    })
    .figure("figure_5", format!("A stretch of {length:.1} m of the pipe at the end"))
    .caption("Grey discs make the walls; the shade of a grain is the speed of its rim, counter-clockwise positive. Gravity pulls to the right.")
}

/// Figure 6: the whole pipe again and again, look after look, the first at the bottom.
fn snapshots(showing: Showing, flow: &PipeFlow) -> Figure {
    let first = first_look(showing, flow);
    let shown: Vec<usize> = (first..flow.frames.len()).take(showing.snapshots).collect();
    let half = flow.frames.first().map_or(0.05, half_height);
    let pitch = (2.6 * half).max(flow.length / 32.0);
    let left = 0.12 * flow.length;
    let mut shapes = vec![];
    for (row, &at) in shown.iter().enumerate() {
        let up = row as f64 * pitch;
        let words = format!("{:.2} s", flow.times[at]);
        shapes.push(Shape::Text { centre: [-0.5 * left, up], height: 0.45 * pitch, words });
        for rim in [-half, half] {
            shapes.push(Shape::Line { ends: [[0.0, up + rim], [flow.length, up + rim]] });
        }
        let grains = flow.frames[at].grains().iter();
        shapes.extend(grains.map(|disc| shape(disc, [0.0, up], Tint::Hue(0))));
    }
    let top = (shown.len() as f64 - 0.4) * pitch;
    Picture::Drawing(Drawing {
        window: [[-left, -0.6 * pitch], [1.01 * flow.length, top]],
        width: 1200.0,
        shapes,
        shades: None,
        guide: guide(),
    })
    .figure("figure_6", "Snapshots of the pipe: crowds of grains drift and dissolve")
    .caption(format!(
        "Every {LOOK} s as in the source, the earliest at the bottom; gravity pulls to the right, what leaves on the right comes in on the left. \
         Every grain is a dot."
    ))
}

/// Metres, and gravity along the pipe, which lies.
fn guide() -> Option<Guide> {
    Some(Guide { unit: "m".into(), gravity: Some([1.0, 0.0]) })
}

/// The look from which on snapshots are drawn.
fn first_look(showing: Showing, flow: &PipeFlow) -> usize {
    flow.times.partition_point(|&time| time < showing.from - 1e-9).min(flow.frames.len())
}

/// Rows of a map that a picture still resolves.
const ROWS: usize = 120;

/// The density over place and time.
fn map(flow: &PipeFlow) -> Figure {
    let stride = flow.density.len().div_ceil(ROWS);
    let bins = flow.density[0].len() as f64;
    let mean = flow.grains as f64 / bins;
    let rows: Vec<Vec<f64>> = flow
        .density
        .chunks(stride)
        .map(|looks| {
            let sum = |bin: usize| looks.iter().map(|counts| f64::from(counts[bin])).sum::<f64>();
            (0..bins as usize).map(|bin| rounded(sum(bin) / looks.len() as f64 / mean)).collect()
        })
        .collect();
    let look = flow.times.get(1).copied().unwrap_or(1.0);
    Picture::Map(Map {
        x: Axis::linear("place along the pipe, the way grains fall", Some("m")).between([0.0, flow.length]),
        y: Axis::linear("time", Some("s")).between([0.0, look * (rows.len() * stride) as f64]),
        value: Axis::linear("density, relative to the mean", None),
        rows,
    })
    .figure("density_map", "Density along the pipe over time")
    .caption(format!("Grains in bins of {MAP_BIN:.0} mean radii, relative to their mean. Bands that lean to the left run against gravity."))
}

/// The Fano factor of every run over time.
fn over_time(flows: &[PipeFlow]) -> Figure {
    let runs = flows.iter().enumerate().map(|(hue, flow)| {
        let looks = flow.times.iter().zip(&flow.fano).step_by(flow.times.len().div_ceil(2 * ROWS));
        Series::new(format!("seed {}", flow.seed), Style::Line, hue, looks.map(|(&time, &fano)| (time, fano)))
    });
    let end = flows.iter().filter_map(|flow| flow.times.last()).copied().fold(0.0, f64::max);
    Chart::of(Axis::linear("time", Some("s")), Axis::logarithmic("Fano factor", None))
        .with(runs)
        .series("waves above this", Style::Dashed, flows.len(), [(0.0, 1.0), (end, 1.0)])
        .figure("fano", "Variance over mean of the grains in a bin, over time")
        .caption(format!("Bins of {FANO_BIN:.0} mean radii."))
}

fn table(flows: &[PipeFlow], control: &PipeFlow) -> Table {
    let overrides = flows[0].overrides.iter().map(|text| format!(", {text}")).collect::<String>();
    let named = flows.iter().map(|flow| ("pipe", flow)).chain([("elastic gas, no gravity", control)]);
    Rows::of(named)
        .text("run", |(name, _)| *name)
        .count("seed", |(_, flow)| flow.seed)
        .number("Fano at the start", 2, |(_, flow)| flow.fano[0])
        .number("Fano late", 2, |(_, flow)| flow.late(&flow.fano).value)
        .number("± (95 %)", 2, |(_, flow)| flow.late(&flow.fano).bar)
        .number("mode at the start", 3, |(_, flow)| flow.strongest_mode[0])
        .number("mode late", 3, |(_, flow)| flow.late(&flow.strongest_mode).value)
        .number("mean velocity late (m/s)", 3, |(_, flow)| flow.late(&flow.flow).value)
        .number("± (95 %)", 3, |(_, flow)| flow.late(&flow.flow).bar)
        .number("spectral power (independent grains: 1)", 2, |(_, flow)| flow.directions.power)
        .number("power against gravity (%)", 0, |(_, flow)| 100.0 * flow.directions.back)
        .number("standing (%)", 0, |(_, flow)| 100.0 * flow.directions.standing)
        .number("with gravity (%)", 0, |(_, flow)| 100.0 * flow.directions.forth)
        .number("deepest penetration, where beyond the warned", 3, |(_, flow)| {
            (flow.deepest > 0.0).then_some(flow.deepest)
        })
        .text("final state, CRC-32", |(_, flow)| format!("0x{}", flow.checksum))
        .table("runs", format!("Runs of {}{overrides}", flows[0].scene))
        .note(format!(
            "{} grains; late is the mean over the second half of the run, whose spectral power at wavelengths from 80 mean radii on is divided \
             by the way it runs.",
            flows[0].grains
        ))
}

/// A tenth of a millimetre, or of a millimetre a second: more digits are not visible.
fn rounded(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// Frames of a film that a page can bear.
const FRAMES: usize = 24;

/// The snapshots as a film; none without frames.
fn film(showing: Showing, flow: &PipeFlow) -> Option<Film> {
    let start = flow.frames.first()?;
    let half = half_height(start);
    let shown: Vec<usize> = (first_look(showing, flow)..flow.frames.len()).take(FRAMES).collect();
    let frames = shown.iter().map(|&at| Frame {
        time: flow.times[at],
        discs: flow.frames[at]
            .grains()
            .iter()
            .map(|disc| (disc.place().map(rounded), rounded(disc.omega * disc.radius)))
            .collect(),
    });
    Some(Film {
        title: format!("{} grains falling", flow.grains),
        units: ["m", "s"].map(str::to_owned),
        window: [[0.0, -half], [flow.length, half]],
        sides: vec![],
        falls: true,
        radii: start.grains().iter().map(|disc| disc.radius).collect(),
        fixed: start.all()[flow.grains..].iter().map(|disc| (disc.place(), disc.radius)).collect(),
        frames: frames.collect(),
        shade: "rim speed ΩR (m/s)".into(),
        shades: [-SPIN, SPIN],
    })
}
