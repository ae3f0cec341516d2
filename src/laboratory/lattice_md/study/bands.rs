//! From how many discs on do several ranks pay, and how far? What one rank takes is measured, what ranks tell each other is counted, and networks are models.

use super::running;
use crate::model::network::{Bands, Network, presets};
use serde::Serialize;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::sweep::fast::Rows;
use stripmine_physics::method::lattice_md::keys::{ENGINE, SEARCH};
use stripmine_physics::method::lattice_md::options::{By, EngineChoice};
use stripmine_physics::method::lattice_md::{Document, Phase, assemble, halo_rows};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::ranks::{self, Crew};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Discs of a rank, rising.
    pub discs: Vec<usize>,
    /// Packing fraction.
    pub packing_fraction: f64,
    /// Disc-steps of a repeat, about.
    pub disc_steps: usize,
    /// Repeats.
    pub repeats: usize,
    /// Ranks by which halos are counted.
    pub ranks: Vec<usize>,
}

/// Discs of the scenes that are dealt out.
pub const SCENES: [f64; 4] = [1e6, 1e7, 1e8, 1e10];
/// Discs of each rank where scenes grow with the ranks.
pub const PER_RANK: f64 = 1e6;
/// The least efficiency with which ranks are said to pay.
pub const PAYS: f64 = 0.8;
/// Steps whose halos are counted.
const STEPS: u64 = 20;
/// Fewest rows of a band.
const BAND: f64 = 16.0;

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Dealt {
    /// Instructions.
    pub instruction_set: &'static str,
    /// Packing fraction.
    pub packing_fraction: f64,
    /// Work of one rank.
    pub work: Vec<Work>,
    /// Halos, as counted and as measured.
    pub halos: Vec<Counted>,
    /// Efficiencies by the model.
    pub curves: Vec<Curve>,
    /// How far each network carries each scene.
    pub reached: Vec<Reached>,
}

/// What a disc and step takes on one rank.
#[derive(Clone, Debug, Serialize)]
pub struct Work {
    /// Discs.
    pub discs: usize,
    /// Seconds, of the best repeat.
    pub seconds: f64,
    /// The part of it that is pairs.
    pub pairs: f64,
}

/// The halo of the first rank.
#[derive(Clone, Debug, Serialize)]
pub struct Counted {
    /// Discs.
    pub discs: usize,
    /// Ranks.
    pub ranks: usize,
    /// Bytes of a message by the model, and as sent.
    pub bytes: [f64; 2],
    /// Messages of a step, as sent.
    pub messages: f64,
}

/// The part of a step in which ranks move discs of their own, over ranks: strong where the scene is given, weak where it grows with them.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// The network.
    pub network: String,
    /// Discs of the scene; none where each rank has as many.
    pub discs: Option<f64>,
    /// Ranks, and the efficiency with them.
    pub points: Vec<[f64; 2]>,
}

/// How far a network carries a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Reached {
    /// The network.
    pub network: String,
    /// Discs.
    pub discs: f64,
    /// The most ranks that have bands.
    pub bands: f64,
    /// The most ranks, in powers of two, that pay.
    pub pays: f64,
    /// How many ranks that lose nothing would be as fast.
    pub gain: f64,
}

/// Measures, counts and models.
///
/// # Errors
/// [`MeasurementError`] if the scene breaks.
///
/// # Panics
/// If a network of the program is none.
pub fn bands(effort: &Effort, progress: impl Fn(f64)) -> Result<Dealt, MeasurementError> {
    let networks = presets().expect("a test reads every network");
    let all = (effort.discs.len() + effort.ranks.len()) as f64;
    let mut work = vec![];
    for &discs in &effort.discs {
        let steps = (effort.disc_steps / discs).max(2) as u64;
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
        let scene = document(discs, effort.packing_fraction)?;
        let measured = pool.install(|| {
            let mut run = running(scene, 200, steps)?;
            (0..effort.repeats).try_for_each(|_| run.repeat())?;
            Ok::<_, MeasurementError>(run.measured())
        })?;
        let of_pairs = measured.phases.get(Phase::Forces.name()).copied().unwrap_or(0.0);
        work.push(Work {
            discs,
            seconds: measured.seconds / (measured.particles as f64 * steps as f64),
            pairs: of_pairs / measured.seconds,
        });
        progress(work.len() as f64 / all);
    }
    let largest = effort.discs.last().copied().unwrap_or(1);
    let checked = document(largest, effort.packing_fraction)?.check()?;
    let shape = checked.geometry.shape;
    let ahead = (shape.stride() - shape.columns()) / 2;
    let rows = Rows { count: shape.rows(), ahead, band: BAND as usize };
    let [halo, again] = halo_rows(rows);
    let of = |discs: f64| Bands {
        discs,
        // The box stays a square.
        rows: shape.rows() as f64 * (discs / checked.particles.len() as f64).sqrt(),
        band: BAND,
        halo: halo as f64,
        again: again as f64,
        // Place, velocity and spin.
        words: 5.0,
        pairs: work.last().map_or(0.0, |work| work.pairs),
    };
    let mut halos = vec![];
    for (done, &ranks) in effort.ranks.iter().enumerate() {
        let mut engine = ranks::over(Crew::Threads(ranks), || assemble(&checked))?;
        for _ in 0..STEPS {
            engine.step()?;
        }
        let sent = engine.timings().halo();
        let discs = checked.particles.len();
        halos.push(Counted {
            discs,
            ranks,
            bytes: [of(discs as f64).halo_bytes(), sent.bytes as f64 / sent.messages.max(1) as f64],
            messages: sent.messages as f64 / STEPS as f64,
        });
        progress((effort.discs.len() + done + 1) as f64 / all);
    }
    let takes = |discs: f64| interpolated(&work, discs);
    let mut dealt = Dealt {
        instruction_set: InstructionSet::best().name(),
        packing_fraction: effort.packing_fraction,
        work: work.clone(),
        halos,
        curves: vec![],
        reached: vec![],
    };
    for network in &networks {
        for discs in SCENES {
            let scene = of(discs);
            let efficiency = |ranks: f64| scene.efficiency(ranks, takes(discs / ranks), network);
            let points = powers(scene.most_ranks()).map(|ranks| [ranks, efficiency(ranks)]);
            let points: Vec<[f64; 2]> = points.collect();
            let best = points.iter().rev().find(|[_, efficiency]| *efficiency >= PAYS);
            let [pays, efficiency] = best.copied().unwrap_or([1.0, 1.0]);
            dealt.reached.push(Reached {
                network: network.title.clone(),
                discs,
                bands: scene.most_ranks(),
                pays,
                gain: pays * efficiency,
            });
            dealt.curves.push(Curve { network: network.title.clone(), discs: Some(discs), points });
        }
        dealt.curves.push(weak(network, of, takes(PER_RANK)));
    }
    Ok(dealt)
}

/// Efficiency where each rank has as many discs, as far as there are bands.
fn weak(network: &Network, of: impl Fn(f64) -> Bands, work: f64) -> Curve {
    let there = powers(1e5).take_while(|&ranks| ranks <= of(ranks * PER_RANK).most_ranks());
    let points = there.map(|ranks| [ranks, of(ranks * PER_RANK).efficiency(ranks, work, network)]);
    Curve { network: network.title.clone(), discs: None, points: points.collect() }
}

/// Powers of two up to a number.
fn powers(most: f64) -> impl Iterator<Item = f64> {
    (0..).map(|power| 2f64.powi(power)).take_while(move |&ranks| ranks <= most)
}

fn document(discs: usize, packing_fraction: f64) -> Result<Document, MeasurementError> {
    let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, packing_fraction);
    Ok(Document::load("bench", &scene.set(&SEARCH, By::Lattice).set(&ENGINE, EngineChoice::Fast))?)
}

/// The work of a disc on a rank with so many: between two measured ones by the logarithm of their number, beyond them that of the last.
fn interpolated(work: &[Work], discs: f64) -> f64 {
    let at = work.partition_point(|work| (work.discs as f64) < discs);
    match (at.checked_sub(1).and_then(|before| work.get(before)), work.get(at)) {
        (Some(a), Some(b)) => {
            let [from, to, here] = [a.discs as f64, b.discs as f64, discs].map(f64::ln);
            let part = (here - from) / (to - from);
            a.seconds + part * (b.seconds - a.seconds)
        }
        (Some(last), None) => last.seconds,
        (None, first) => first.map_or(f64::NAN, |first| first.seconds),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What ranks send is what the model counts.
    #[test]
    fn halos_are_as_large_as_counted() {
        let effort = Effort {
            discs: vec![500, 20_000],
            packing_fraction: 0.8,
            disc_steps: 40_000,
            repeats: 1,
            ranks: vec![2, 4],
        };
        let data = bands(&effort, |_| ()).unwrap();
        for Counted { bytes: [counted, sent], messages, .. } in &data.halos {
            assert!((sent / counted - 1.0).abs() < 0.1 && *messages == 2.0, "{counted} {sent}");
        }
        for curve in &data.curves {
            assert!(curve.points.iter().all(|[_, efficiency]| (0.0..=1.0).contains(efficiency)), "{curve:?}");
        }
        // The slower the network, the fewer ranks pay.
        let pays = |network: &str, discs: f64| {
            let of = data.reached.iter().find(|it| it.network == network && it.discs == discs);
            of.unwrap().pays
        };
        assert!(pays("25 Gb/s Ethernet", 1e8) <= pays("Slingshot 11", 1e8));
        assert!(pays("Slingshot 11", 1e6) <= pays("Slingshot 11", 1e10));
    }
}
