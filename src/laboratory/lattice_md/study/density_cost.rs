//! Clock periods of a step against particle number and density, by BP93's clock model: its figures 3 and 4.

use super::StudyError;
use super::efficiency_table::{
    TableFeatures, TableScene, counting_model, printed_clocks, programs_of_step, scene_model,
};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::model::clock::Clock;
use crate::model::machine::MachineModel;
use crate::model::machines;
use crate::results::{FinishedItem, StudyEnvironment, StudySize, run_in_parallel};
use crate::statistics::slope;
use std::f64::consts::PI;
use stripmine_kernels::isa::OpCounts;
use stripmine_kernels::ledger::{Ledger, VectorLength};
use stripmine_physics::method::lattice_md::keys::{EXECUTION, SEARCH};
use stripmine_physics::method::lattice_md::options::SearchKind;
use stripmine_physics::method::lattice_md::{
    GranularDocument, Lengths, Part, assemble, ledger, neighbour_list_ledger,
};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Maximum ρ of discs on cells as wide as their radius: touching discs in hexagonal order, `1/(2√3)`.
pub(crate) const CEILING: f64 = 0.288_675_134_594_812_9;

/// LMAX of figure 3.
const LATTICES: [usize; 3] = [1_000, 10_000, 100_000];

/// ρ of figure 4; the last two exceed [`CEILING`].
pub(super) const OCCUPANCIES: [f64; 6] = [0.05, 0.1, 0.2, 0.25, 0.35, 0.5];

/// Statistics of neighbour lists at a density, measured in a run because no model predicts them.
#[derive(Clone, Copy)]
pub(super) struct ListStatistics {
    /// ρ on cells as wide as the radius.
    pub(super) occupancy: f64,
    /// Candidates tested in a step, and those in contact, per disc.
    pub(super) candidates: f64,
    pub(super) contacts: f64,
    pub(super) steps_a_list: f64,
}

impl ListStatistics {
    /// Elements of a vector whose length depends on lists; `None` for any other length.
    pub(super) fn length(&self, length: VectorLength, discs: f64) -> Option<f64> {
        match length {
            VectorLength::Candidates => Some(self.candidates * discs),
            VectorLength::Pairs => Some(self.contacts * discs),
            _ => None,
        }
    }
}

/// Clock periods of a step.
struct StepCost {
    particles: usize,
    /// From BP93's formula and NOP; BP93 has no formula for lists.
    printed: Option<f64>,
    /// By the same clock, from counted operations.
    counted: f64,
}

/// Curve over NP with LMAX or ρ fixed.
struct CostCurve {
    cells: Option<usize>,
    occupancy: Option<f64>,
    costs: Vec<StepCost>,
}

/// Computes the curves with the clock of the paper's machine.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    Ok(density_cost(&machines::preset("paper")?)?)
}

/// Computes the curves with the clock of a machine.
pub(crate) fn density_cost(machine: &MachineModel) -> Result<FinishedItem, StudyError> {
    let occupancies: Vec<f64> = OCCUPANCIES.into_iter().filter(|&occupancy| occupancy < CEILING).collect();
    let figures = run_in_parallel(&occupancies, |&occupancy| list_statistics(occupancy))?;
    let model = ClockedModel::of(machine)?;
    let cells = LATTICES.iter().map(|&cells| model.lattice_curve(Some(cells), None));
    let densities = OCCUPANCIES.iter().map(|&occupancy| model.lattice_curve(None, Some(occupancy)));
    let (cells, densities): (Vec<_>, Vec<_>) =
        (cells.collect::<Result<_, _>>()?, densities.collect::<Result<_, _>>()?);
    let lists: Vec<CostCurve> = figures.iter().map(|figures| model.list_curve(figures)).collect();
    let dense = &lists[lists.len() - 1];
    let rivals = cells.iter().map(|curve| (curve, dense)).chain(by_density(&densities, &lists));
    Ok(FinishedItem::of([
        curves(&[("vector", &cells), ("vector", &densities), ("lists", &lists)]),
        FrameBuilder::of(rivals)
            .cell("LMAX", |(curve, _)| curve.cells.map(|cells| cells as u64))
            .number("ρ", 2, |(curve, _)| curve.occupancy)
            .number("NP", 0, |(curve, lists)| break_even(curve, lists))
            .frame("break_even", "Number of particles from which on a vector step is the shorter one"),
        FrameBuilder::of(&figures)
            .number("occupancy ρ", 2, |figures| figures.occupancy)
            .number("candidates a disc", 2, |figures| figures.candidates)
            .number("contacts a disc", 3, |figures| figures.contacts)
            .number("steps a list serves", 1, |figures| figures.steps_a_list)
            .frame("lists", "Candidates and contacts in the lists"),
        FrameBuilder::of([()])
            .text("machine", |()| machine.title())
            .count("operations of a test", |()| model.test().total())
            .number("ceiling", 3, |()| CEILING)
            .number("break-even power", 2, |()| break_even_power(&densities, &lists))
            .number("largest ratio of lists by density", 2, |()| spread_by_density(&lists))
            .frame("summary", "Machine, and how costs depend on the density"),
    ])
    .with_seeds([1]))
}

fn curves(groups: &[(&str, &[CostCurve])]) -> ResultFrame {
    let curves = groups.iter().flat_map(|(method, curves)| curves.iter().map(move |curve| (*method, curve)));
    let rows = curves.flat_map(|(method, curve)| curve.costs.iter().map(move |cost| (method, curve, cost)));
    FrameBuilder::of(rows)
        .text("method", |(method, ..)| *method)
        .cell("LMAX", |(_, curve, _)| curve.cells.map(|cells| cells as u64))
        .number("ρ", 2, |(_, curve, _)| curve.occupancy)
        .count("NP", |(.., cost)| cost.particles)
        .number("counted", 0, |(.., cost)| cost.counted)
        .number("as printed", 0, |(.., cost)| cost.printed)
        .frame("curves", "Clock periods of a step, on a lattice of LMAX cells or at an occupancy ρ")
}

/// Pairs of curves of the lattice and of lists at the same density.
fn by_density<'c>(
    lattice: &'c [CostCurve],
    lists: &'c [CostCurve],
) -> impl Iterator<Item = (&'c CostCurve, &'c CostCurve)> {
    let of = |lists: &CostCurve| lattice.iter().find(|curve| curve.occupancy == lists.occupancy);
    lists.iter().filter_map(move |lists| Some((of(lists)?, lists)))
}

/// NP above which the lattice is cheaper than lists, interpolated between points of the curves.
fn break_even(lattice: &CostCurve, lists: &CostCurve) -> Option<f64> {
    let ratios = lattice.costs.iter().filter_map(|cost| {
        let rival = lists.costs.iter().find(|rival| rival.particles == cost.particles)?;
        Some((cost.particles as f64, cost.counted / rival.counted))
    });
    crossing(&ratios.collect::<Vec<_>>())
}

/// Value of x at which a ratio falls below 1, by log-log interpolation.
pub(super) fn crossing(ratios: &[(f64, f64)]) -> Option<f64> {
    ratios.windows(2).find_map(|pair| {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]].map(|(x, ratio)| (x.ln(), ratio.ln()));
        (y0 >= 0.0 && y1 < 0.0).then(|| (x0 + (x1 - x0) * y0 / (y0 - y1)).exp())
    })
}

/// Power of ρ of a number of particles: slope of a line through logarithms; `None` with fewer than two points.
pub(super) fn power_of_density(points: impl Iterator<Item = (f64, Option<f64>)>) -> Option<f64> {
    let known = points.filter_map(|(density, particles)| Some((density.ln(), particles?.ln())));
    let (densities, particles): (Vec<f64>, Vec<f64>) = known.unzip();
    (densities.len() > 1).then(|| slope(&densities, &particles))
}

fn break_even_power(lattice: &[CostCurve], lists: &[CostCurve]) -> Option<f64> {
    let density = |curve: &CostCurve| curve.occupancy.unwrap_or(f64::NAN);
    power_of_density(
        by_density(lattice, lists).map(|(lattice, lists)| (density(lists), break_even(lattice, lists))),
    )
}

/// Largest ratio of the costs of lists between densities at one number of particles.
fn spread_by_density(lists: &[CostCurve]) -> Option<f64> {
    let ratios = (0..lists.first()?.costs.len()).filter_map(|at| {
        let costs = || lists.iter().filter_map(move |curve| Some(curve.costs.get(at)?.counted));
        Some(costs().reduce(f64::max)? / costs().reduce(f64::min)?)
    });
    ratios.reduce(f64::max)
}

/// NP of every curve: five per decade.
fn particles() -> impl Iterator<Item = usize> {
    (5..=25).map(|fifth| 10f64.powf(f64::from(fifth) / 5.0).round() as usize)
}

/// Counted operations, and the machine whose clock is applied.
struct ClockedModel<'m> {
    machine: &'m MachineModel,
    choice: TableFeatures,
    lattice: Ledger,
    rival: Ledger,
}

impl ClockedModel<'_> {
    /// Counts the operations, which do not depend on the size of the lattice.
    fn of(machine: &MachineModel) -> Result<ClockedModel<'_>, StudyError> {
        let question = TableScene::default();
        let (programs, rival) =
            (programs_of_step(&question)?.0, neighbour_list_ledger(&scene_model(&question)?));
        Ok(ClockedModel { machine, choice: question.choice, lattice: ledger(&programs), rival })
    }

    fn clocks(&self, clock: Clock, counts: &OpCounts, n: u64) -> f64 {
        clock.clocks(self.machine, &counts.clone().into(), n)
    }

    /// Curve of the vector algorithm, with LMAX or ρ fixed.
    fn lattice_curve(&self, cells: Option<usize>, occupancy: Option<f64>) -> Result<CostCurve, StudyError> {
        let full = CEILING.max(occupancy.unwrap_or(0.0));
        let lattices = particles().map(|particles| {
            let of_density = || (particles as f64 / occupancy.unwrap_or(1.0)).ceil() as usize;
            (particles, cells.unwrap_or_else(of_density))
        });
        let costs = lattices.filter(|&(particles, cells)| {
            let is_wide = occupancy.is_none() || cells >= 25;
            is_wide && particles as f64 <= full * cells as f64 + 1.0
        });
        let costs = costs.map(|(particles, cells)| self.step(particles, cells));
        Ok(CostCurve { cells, occupancy, costs: costs.collect::<Result<_, _>>()? })
    }

    fn step(&self, particles: usize, cells: usize) -> Result<StepCost, MeasurementError> {
        let lengths = Lengths::new(&counting_model(cells, self.choice)?, particles, particles);
        let counted = self.lattice.parts().into_iter().map(|(_, length, counts)| {
            self.clocks(Clock::Paper, &counts, lengths.range(length).len() as u64)
        });
        let printed = Part::ALL
            .iter()
            .filter_map(|&part| printed_clocks(part, self.machine, particles as u64, cells as u64));
        Ok(StepCost { particles, printed: Some(printed.sum()), counted: counted.sum() })
    }

    /// Curve of scalar neighbour lists: every operation costs the whole depth of the pipeline. The Index belongs to the lattice and is omitted.
    fn list_curve(&self, figures: &ListStatistics) -> CostCurve {
        let rows: Vec<_> =
            self.rival.parts().into_iter().filter(|(part, ..)| *part != Part::Index.name()).collect();
        let costs = particles().map(|particles| {
            let np = particles as f64;
            let clocks = |counts: &OpCounts, n: f64| n * self.clocks(Clock::Scalar, counts, 1);
            let visiting = rows
                .iter()
                .map(|(_, length, counts)| clocks(counts, figures.length(*length, np).unwrap_or(np)));
            let making = clocks(&self.test(), 0.5 * np * (np - 1.0)) / figures.steps_a_list;
            StepCost { particles, printed: None, counted: visiting.sum::<f64>() + making }
        });
        CostCurve { cells: None, occupancy: Some(figures.occupancy), costs: costs.collect() }
    }

    /// Operations of the distance and contact test of one pair.
    fn test(&self) -> OpCounts {
        let mut test = OpCounts::default();
        let rows = self.rival.entries().iter().filter(|entry| entry.length == VectorLength::Candidates);
        rows.for_each(|entry| test.add(&entry.counts));
        test
    }
}

/// Measures the lists of a warm gas of about a thousand discs.
pub(super) fn list_statistics(occupancy: f64) -> Result<ListStatistics, StudyError> {
    const EQUILIBRATION: u64 = 200;
    const STEPS: u64 = 1000;
    let scene = Overrides::new().set(&COUNT, 1024_u64).set(&PACKING_FRACTION, PI * occupancy);
    let overrides = scene.set(&SEARCH, SearchKind::NeighborList).set(&EXECUTION, "chained");
    let mut method = assemble(&GranularDocument::load("bench", &overrides.texts())?.check()?)?;
    (0..EQUILIBRATION).try_for_each(|_| method.step())?;
    let made = method.lists().map_or(0, |(_, rebuilds)| rebuilds);
    let mut sums = [0; 2];
    for _ in 0..STEPS {
        method.step()?;
        sums[0] += method.length(VectorLength::Candidates);
        sums[1] += method.length(VectorLength::Pairs);
    }
    let made = method.lists().map_or(0, |(_, rebuilds)| rebuilds) - made;
    let discs = method.particles().grain_count() as f64 * STEPS as f64;
    Ok(ListStatistics {
        occupancy,
        candidates: sums[0] as f64 / discs,
        contacts: sums[1] as f64 / discs,
        steps_a_list: STEPS as f64 / made.max(1) as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(occupancy: f64, cost: impl Fn(f64) -> f64) -> CostCurve {
        let costs = [10_usize, 100, 1000, 10_000, 100_000].map(|particles| {
            let counted = cost(particles as f64);
            StepCost { particles, printed: None, counted }
        });
        CostCurve { cells: None, occupancy: Some(occupancy), costs: costs.into() }
    }

    #[test]
    fn the_crossing_is_where_the_logarithms_cross() {
        assert!((crossing(&[(0.8, 2.0), (0.2, 0.5)]).unwrap() - 0.4).abs() < 1e-12);
        assert_eq!(crossing(&[(0.8, 2.0), (0.2, 1.5)]), None);
        assert_eq!(crossing(&[(0.8, 0.9), (0.2, 0.5)]), None);
    }

    /// For a lattice step of NP/ρ and lists of NP² times a power of ρ the powers are recovered.
    #[test]
    fn powers_of_the_density_are_recovered() {
        let densities = [0.05, 0.1, 0.2];
        let lattice = densities.map(|rho| curve(rho, move |np| 50.0 * np / rho));
        for (power, expected, spread) in [(0, -1.0, 1.0), (1, -2.0, 4.0)] {
            let lists = densities.map(|rho| curve(rho, move |np| np * np * (10.0 * rho).powi(power)));
            let found = break_even_power(&lattice, &lists).unwrap();
            assert!((found - expected).abs() < 1e-9, "{found}");
            assert!((spread_by_density(&lists).unwrap() - spread).abs() < 1e-9);
        }
    }
}
