//! Density waves against dissipation: the pipe at several γ_N, and a control that must stay homogeneous.

use super::pipe_flow::{Flow, elastic_gas, late_mean, run_pipe};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::RunSpread;
use stripmine_physics::method::lattice_md::keys::NORMAL_DAMPING;
use stripmine_physics::scene::Overrides;

/// γ_N of the scan (1/s).
const SCAN: [f64; 5] = [100.0, 200.0, 400.0, 700.0, 1000.0];
/// Starts of every case.
const SEEDS: [u64; 6] = [1, 2, 3, 4, 5, 6];

/// Runs every case with every seed.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let scan = SCAN.map(|damping| {
        let name = format!("γ_N = {damping:.0} 1/s");
        (name, Some(damping), Overrides::new().set(&NORMAL_DAMPING, damping))
    });
    let control = ("elastic gas without gravity".to_owned(), None, elastic_gas(&Overrides::new()));
    let cases: Vec<_> = scan.into_iter().chain([control]).collect();
    let runs: Vec<(&Overrides, u64)> =
        cases.iter().flat_map(|(.., overrides)| SEEDS.map(|seed| (overrides, seed))).collect();
    let flows = ProgressMeter::new(runs.len() as f64, lab.progress)
        .run_cases(&runs, |&(overrides, seed)| run_pipe("pipe-small", overrides, seed, false, |_| {}))?;
    // Fano factor at the start and late, strongest mode at the start and late, late mean velocity (m/s).
    let spreads = |flows: &[Flow]| {
        let over = |of: fn(&Flow) -> f64| RunSpread::of(&flows.iter().map(of).collect::<Vec<_>>());
        [
            over(|flow| flow.fano[0]),
            over(|flow| late_mean(&flow.fano).value),
            over(|flow| flow.strongest_mode[0]),
            over(|flow| late_mean(&flow.strongest_mode).value),
            over(|flow| late_mean(&flow.flow).value),
        ]
    };
    let cases: Vec<_> = cases.iter().zip(flows.chunks(SEEDS.len()).map(spreads)).collect();
    let with_error = |it: RunSpread, decimals: usize| TableCell::with_error(it.mean, it.error, decimals);
    let drawn = |it: RunSpread| {
        let error = it.error.unwrap_or(0.0);
        [it.mean, it.mean - error, it.mean + error].map(|value| TableCell::Number(value, 3))
    };
    let [late, start] =
        ["late", "start"].map(|name| [name.into(), format!("{name} low"), format!("{name} high")]);
    Ok(FinishedItem::of([
        FrameBuilder::of(&cases)
            .text("case", |((name, ..), _)| name)
            .cell("Fano at the start", |(_, spreads)| with_error(spreads[0], 2))
            .cell("Fano late", |(_, spreads)| with_error(spreads[1], 2))
            .cell("single seeds", |(_, spreads)| TableCell::Range([spreads[1].lowest, spreads[1].highest], 2))
            .cell("strongest mode at the start", |(_, spreads)| with_error(spreads[2], 3))
            .cell("strongest mode late", |(_, spreads)| with_error(spreads[3], 3))
            .cell("mean velocity late (m/s)", |(_, spreads)| with_error(spreads[4], 3))
            .frame("cases", "Every case"),
        FrameBuilder::of(cases.iter().filter(|((_, damping, _), _)| damping.is_some()))
            .number("γ_N (1/s)", 0, |((_, damping, _), _)| *damping)
            .cells(late, |(_, spreads)| drawn(spreads[1]))
            .cells(start, |(_, spreads)| drawn(spreads[0]))
            .frame("scan", "Fano factors over the damping, with the ends of their standard errors"),
    ])
    .with_seeds(SEEDS))
}
