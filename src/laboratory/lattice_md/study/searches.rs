//! Fastest neighbour search: rates by particles, density, search, precision and threads, compared with the methods of 1993.

use super::density_cost::{crossing, power_of_density};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::laboratory::rates::{self, MeasuredCase, RateCase, measure_rates};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::study::StudyError;
use std::f64::consts::PI;
use stripmine_physics::method::lattice_md::GranularDocument;
use stripmine_physics::method::lattice_md::keys::{
    CELL_EDGE, COHESIONLESS, ENGINE, EXECUTION, INTEGRATOR, REBUILD, SEARCH, TEXT,
};
use stripmine_physics::method::lattice_md::options::{EngineChoice, IntegratorKind};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, PRECISION};
use stripmine_physics::words::Words;

const F64: &str = "f64";
/// Precisions; the first is measured everywhere.
const PRECISIONS: [&str; 3] = [F64, "mixed", "f32"];
/// Optimised searches by their names in scenes; the lattice is first.
const TODAY: [&str; 3] = ["lattice", "neighbor-list", "sectors"];
const EAGER: &str = "printed lattice, eager";
pub(super) const CHAINED: &str = "lattice, chained";
pub(super) const ALL_PAIRS: &str = "printed lists of all pairs";
/// Methods of 1993, and the lattice's programs as compiled loops (`CHAINED`).
const PAPER: [&str; 3] = [EAGER, CHAINED, ALL_PAIRS];

/// Measured cases of a study size.
struct SearchGrid {
    /// Discs and decreasing packing fractions for the optimised searches.
    discs: &'static [usize],
    packing_fractions: &'static [f64],
    /// Number of discs at which all precisions are compared; 0 for none.
    compared: usize,
    /// Discs and packing fractions for runs on several threads.
    threads: (&'static [usize], &'static [f64]),
    /// Discs for the methods of 1993 at the highest occupancy, and occupancies at [`MIDDLE`] discs.
    paper: (&'static [usize], &'static [f64]),
    /// Discs and occupancies for the break-even of lattice and lists of 1993.
    break_even: (&'static [usize], &'static [f64]),
    /// Minimum seconds of a measurement.
    seconds: f64,
}

const MIDDLE: usize = 1000;
/// Highest occupancy for the methods of 1993, on cells as wide as the radius.
pub(super) const DENSE: f64 = 0.25;

const QUICK: SearchGrid = SearchGrid {
    discs: &[3000],
    packing_fractions: &[0.84, 0.3, 0.1],
    compared: 0,
    threads: (&[10_000], &[0.84]),
    paper: (&[100, 1000], &[]),
    break_even: (&[300, 3000], &[DENSE]),
    seconds: 0.02,
};

const FULL: SearchGrid = SearchGrid {
    discs: &[300, 3000, 10_000, 100_000],
    packing_fractions: &[0.84, 0.8, 0.6, 0.3, 0.1, 0.03],
    compared: 10_000,
    threads: (&[10_000, 100_000], &[0.84, 0.3]),
    paper: (&[100, 300, 1000, 3000, 10_000], &[0.01, 0.03, 0.06, 0.12]),
    break_even: (&[300, 1000, 3000, 10_000, 20_000], &[0.06, 0.12, DENSE]),
    seconds: 0.06,
};

/// Case of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SearchCase {
    pub(super) search: &'static str,
    precision: &'static str,
    /// Number of threads if wall time is measured; otherwise processor time is measured.
    threads: Option<usize>,
    /// Requested number of discs.
    pub(super) discs: usize,
    packing_fraction: f64,
}

impl SearchCase {
    /// Case in double precision, whose processor time is measured.
    pub(super) fn of(search: &'static str, discs: usize, packing_fraction: f64) -> SearchCase {
        SearchCase { search, precision: F64, threads: None, discs, packing_fraction }
    }

    pub(super) fn scene(self) -> Overrides {
        let scene = Overrides::new().set(&COUNT, self.discs).set(&PACKING_FRACTION, self.packing_fraction);
        let scene = scene.set(&PRECISION, self.precision);
        // The paper has no clamp, and cells as wide as the radius.
        let paper = |scene: Overrides, text: &str, execution: &str| {
            let scene = scene.set(&TEXT, text).set(&EXECUTION, execution).set(&COHESIONLESS, false);
            scene.set(&SEARCH, "lattice").set(&CELL_EDGE, 0.5)
        };
        match self.search {
            EAGER => paper(scene, "printed", "eager"),
            CHAINED => paper(scene, "ours", "chained"),
            ALL_PAIRS => {
                let scene = scene.set(&TEXT, "printed").set(&EXECUTION, "chained").set(&COHESIONLESS, false);
                scene.set(&SEARCH, "neighbor-list").set(&REBUILD, "all-pairs")
            }
            search => fast(scene).set(&SEARCH, search),
        }
    }

    /// Steps before the clock starts, and minimum number after it. Lists are rebuilt several times; with a lattice all steps are equal.
    fn steps(self) -> [u64; 2] {
        let most = |particle_steps: usize| (particle_steps / self.discs) as u64;
        match self.search {
            EAGER | CHAINED => [2, 3],
            ALL_PAIRS => [20, most(300_000).clamp(40, 400)],
            _ => [most(6_000_000).clamp(20, 200), most(400_000).max(40)],
        }
    }

    /// Measured case, of at least some seconds.
    pub(super) fn case(self, seconds: f64) -> RateCase {
        let [warm_up, steps] = self.steps();
        // Occupancy as requested.
        let occupancy = (1e6 * self.packing_fraction / PI).round() / 1e6;
        let case = RateCase::steps("bench", &self.scene(), warm_up, steps)
            .for_seconds(seconds)
            .label("search", self.search)
            .label("precision", self.precision)
            .label("discs", self.discs as u64)
            .label("packing fraction", TableCell::Number(self.packing_fraction, 3))
            .label("occupancy ρ", TableCell::Number(occupancy, 3));
        match self.threads {
            Some(threads) => case.label("threads", threads as u64).on_threads(threads),
            None => case,
        }
    }
}

fn fast(scene: Overrides) -> Overrides {
    scene.set(&ENGINE, EngineChoice::Fast).set(&INTEGRATOR, IntegratorKind::VelocityVerlet)
}

/// All distinct cases of a grid.
fn search_cases(grid: &SearchGrid, threads: usize) -> Vec<SearchCase> {
    let crossed = |searches: &[&'static str], discs: &[usize], fractions: &[f64]| {
        let of = |search, discs| fractions.iter().map(move |&phi| SearchCase::of(search, discs, phi));
        let each = searches.iter().flat_map(|&search| discs.iter().map(move |&discs| (search, discs)));
        each.flat_map(|(search, discs)| of(search, discs)).collect::<Vec<SearchCase>>()
    };
    let occupied = |occupancies: &[f64]| occupancies.iter().map(|rho| PI * rho).collect::<Vec<f64>>();
    let mut all = crossed(&TODAY, grid.discs, grid.packing_fractions);
    for &precision in &PRECISIONS[1..] {
        let same = all.iter().filter(|it| it.precision == F64 && it.discs == grid.compared);
        all.extend(same.map(|it| SearchCase { precision, ..*it }).collect::<Vec<_>>());
    }
    let (discs, fractions) = grid.threads;
    for threads in [1, threads] {
        let lattices = crossed(&TODAY[..1], discs, fractions).into_iter();
        all.extend(lattices.map(|it| SearchCase { threads: Some(threads), ..it }));
    }
    all.extend(crossed(&PAPER, grid.paper.0, &occupied(&[DENSE])));
    all.extend(crossed(&PAPER, &[MIDDLE], &occupied(grid.paper.1)));
    all.extend(crossed(&[CHAINED, ALL_PAIRS], grid.break_even.0, &occupied(grid.break_even.1)));
    let mut once: Vec<SearchCase> = vec![];
    all.into_iter().for_each(|place| {
        if !once.contains(&place) {
            once.push(place);
        }
    });
    once
}

/// Measured rates of a grid.
struct SearchRates<'g> {
    grid: &'g SearchGrid,
    all: Vec<(SearchCase, MeasuredCase)>,
}

/// Measures every case of the grid.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let grid = if size == StudySize::Quick { &QUICK } else { &FULL };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let places = search_cases(grid, threads);
    let cases: Vec<RateCase> = places.iter().map(|it| it.case(grid.seconds)).collect();
    let measured = measure_rates(lab, &cases)?;
    let data = SearchRates { grid, all: places.into_iter().zip(measured).collect() };
    let single = data.all.iter().filter(|(place, _)| place.threads.is_none()).map(|(_, it)| it.clone());
    let title = "Million particle-steps a second of processor time, one thread";
    let all = rates::rate_frame(&single.collect::<Vec<_>>(), ("rates", title), ("rate (M/s)", 1e-6, 2));
    let [break_even, summary] = data.break_even();
    let frames =
        [all, data.lost(), data.fastest()?, data.crossings(), break_even, data.threads(threads), summary];
    let made = FinishedItem::of(frames).with_seeds([1]);
    Ok(FinishedItem { processes: Some(rates::PROCESSES), ..made })
}

impl SearchRates<'_> {
    fn at(&self, place: SearchCase) -> Option<&MeasuredCase> {
        self.all.iter().find(|(known, _)| *known == place).map(|(_, measured)| measured)
    }

    /// Discs and increasing packing fractions of the optimised searches on one thread in double precision.
    fn grid(&self) -> impl Iterator<Item = (usize, f64)> {
        let fractions = self.grid.packing_fractions;
        self.grid.discs.iter().flat_map(move |&discs| fractions.iter().rev().map(move |&phi| (discs, phi)))
    }

    /// Optimised searches for a number of discs and a packing fraction, the fastest first.
    fn ranked_searches(&self, discs: usize, packing_fraction: f64) -> Vec<(&'static str, &MeasuredCase)> {
        let each = |search| Some((search, self.at(SearchCase::of(search, discs, packing_fraction))?));
        let mut all: Vec<_> = TODAY.into_iter().filter_map(each).collect();
        all.sort_by(|a, b| b.1.rate().median.total_cmp(&a.1.rate().median));
        all
    }

    /// Time with each search over that with the fastest.
    fn lost(&self) -> ResultFrame {
        let rows = TODAY.into_iter().flat_map(|search| self.grid().map(move |place| (search, place)));
        let rows = rows.filter_map(|(search, (discs, phi))| {
            let own = self.at(SearchCase::of(search, discs, phi))?;
            Some((search, discs, phi, self.ranked_searches(discs, phi)[0].1.rate_ratio(own)))
        });
        FrameBuilder::of(rows)
            .text("search", |row| row.0)
            .count("discs", |row| row.1)
            .number("packing fraction", 2, |row| row.2)
            .cell("time over that of the fastest", |row| row.3.cell(1.0, 2))
            .frame("lost", "Time lost by each search")
    }

    /// Fastest search, and the choice of `auto`.
    fn fastest(&self) -> Result<ResultFrame, StudyError> {
        let mut rows = vec![];
        for (discs, phi) in self.grid() {
            let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, phi);
            let auto = GranularDocument::load("bench", &fast(scene).texts())?.check()?.scene.search.by.word();
            let ranked = self.ranked_searches(discs, phi);
            let Some((first, best)) = ranked.first() else { continue };
            let own = ranked.iter().find(|(name, _)| *name == auto);
            rows.push((discs, phi, *first, best.rate(), auto, own.map(|(_, own)| best.rate_ratio(own))));
        }
        Ok(FrameBuilder::of(rows)
            .count("discs", |row| row.0)
            .number("packing fraction", 2, |row| row.1)
            .text("fastest", |row| row.2)
            .cell("rate (M/s)", |row| row.3.cell(1e-6, 1))
            .text("choice of auto", |row| row.4)
            .cell("time of that over the fastest", |row| row.5.map(|it| it.cell(1.0, 2)))
            .frame("fastest", "Fastest search and choice of auto, million particle-steps a second"))
    }

    /// Packing fractions above which the lattice is faster than the best other search.
    fn crossings(&self) -> ResultFrame {
        let of_f64 = self.grid.discs.iter().map(|&discs| (F64, discs));
        let others = PRECISIONS[1..].iter().map(|&precision| (precision, self.grid.compared));
        let rows = of_f64.chain(others).filter_map(|(precision, discs)| {
            let ratios = self.grid.packing_fractions.iter().filter_map(|&phi| {
                let own = |search| self.at(SearchCase { precision, ..SearchCase::of(search, discs, phi) });
                let rivals = TODAY[1..].iter().filter_map(|&search| own(search));
                let best = rivals.max_by(|a, b| a.rate().median.total_cmp(&b.rate().median))?;
                Some((phi, own(TODAY[0])?.rate_ratio(best).median))
            });
            let ratios: Vec<(f64, f64)> = ratios.collect();
            let densest = ratios.first()?.1;
            Some((precision, discs, crossing(&ratios), densest))
        });
        FrameBuilder::of(rows.collect::<Vec<_>>())
            .text("precision", |row| row.0)
            .count("discs", |row| row.1)
            .number("packing fraction", 3, |row| row.2)
            .number("lattice over its best rival at the densest", 2, |row| row.3)
            .frame("crossings", "Packing fraction from which on the lattice is the fastest")
    }

    /// Numbers of discs above which the lattice's programs are faster than lists of all pairs, and their power of ρ.
    fn break_even(&self) -> [ResultFrame; 2] {
        let (discs, occupancies) = self.grid.break_even;
        let rows = occupancies.iter().map(|rho| {
            let ratios = discs.iter().rev().filter_map(|&discs| {
                let own = |search| self.at(SearchCase::of(search, discs, PI * rho));
                Some((discs as f64, own(CHAINED)?.rate_ratio(own(ALL_PAIRS)?).median))
            });
            (*rho, crossing(&ratios.collect::<Vec<_>>()))
        });
        let rows: Vec<(f64, Option<f64>)> = rows.collect();
        let power = power_of_density(rows.iter().copied());
        let title = "Discs from which on the lattice's programs are faster than lists of all pairs";
        let table =
            FrameBuilder::of(rows).number("occupancy ρ", 2, |row| row.0).number("discs", 0, |row| row.1);
        let summary = FrameBuilder::of([()]).number("power of ρ", 2, |()| power);
        [
            table.frame("break_even", title),
            summary.frame("summary", "Change of the break-even with the density"),
        ]
    }

    /// Speed-up by threads.
    fn threads(&self, threads: usize) -> ResultFrame {
        let single = self.all.iter().filter(|(place, _)| place.threads == Some(1) && threads > 1);
        let rows = single.filter_map(|(place, alone)| {
            Some((place, alone, self.at(SearchCase { threads: Some(threads), ..*place })?))
        });
        let title = "The lattice on one thread and on all, million particle-steps a second of wall time";
        FrameBuilder::of(rows)
            .count("discs", |(place, ..)| place.discs)
            .number("packing fraction", 2, |(place, ..)| place.packing_fraction)
            .cell("one thread (M/s)", |(_, alone, _)| alone.rate().cell(1e-6, 1))
            .count("threads", |_| threads)
            .cell("all threads (M/s)", |(.., all)| all.rate().cell(1e-6, 1))
            .cell("times as fast", |(_, alone, all)| all.rate_ratio(alone).cell(1.0, 2))
            .frame("threads", title)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameValue;
    use crate::laboratory::running::prepare_preset;

    /// Every case of both sizes is a valid scene, and no case occurs twice.
    #[test]
    fn every_case_of_the_grids_is_valid() {
        for (grid, count) in [(&QUICK, 21), (&FULL, 161)] {
            let all = search_cases(grid, 2);
            assert_eq!(all.len(), count);
            for place in all.iter().filter(|it| it.discs <= MIDDLE || grid.discs.len() == 1) {
                prepare_preset("bench", &place.scene()).unwrap_or_else(|error| panic!("{place:?}: {error}"));
            }
        }
    }

    /// Rates computed from known costs give the break-even of these costs, 1/ρ.
    #[test]
    fn the_break_even_follows_from_the_rates() {
        let reading =
            |seconds: f64| rates::CaseReading { work: 1.0, seconds, ..rates::CaseReading::default() };
        let measured = |place: SearchCase| {
            let rho = place.packing_fraction / PI;
            let seconds = if place.search == CHAINED { 50.0 / rho } else { 0.1 * place.discs as f64 };
            (place, MeasuredCase::of([reading(seconds)]))
        };
        let data =
            SearchRates { grid: &FULL, all: search_cases(&FULL, 2).into_iter().map(measured).collect() };
        let [table, summary] = data.break_even();
        let number =
            |value: &FrameValue| if let FrameValue::Number(number) = value { *number } else { f64::NAN };
        for row in &table.rows {
            assert!((number(&row[0]) * number(&row[1]) / 500.0 - 1.0).abs() < 1e-9, "{row:?}");
        }
        assert!((number(&summary.rows[0][0]) + 1.0).abs() < 1e-9);
    }
}
