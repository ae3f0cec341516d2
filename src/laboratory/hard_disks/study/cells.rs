//! ISO99's cells apart from its engine: registration of neighbours, look-ups and memory, over the density and the number of discs.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::rates::{CaseReading, RateCase, StudyWork, measure_rates, parse_parameters};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::study::StudyError;
use serde_json::json;
use std::collections::BTreeMap;
use std::time::Instant;
use stripmine_kernels::mask::Mask;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::hard_disks::reference::trial::{CellKind, TrialCells};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Kinds of cells, and their names.
const KINDS: [(CellKind, &str); 4] = [
    (CellKind::Plain, "all cells"),
    (CellKind::Hashing, "occupied cells by hashing"),
    (CellKind::Linear, "occupied cells by linear search"),
    (CellKind::LinkedLists, "linked cells and lists"),
];
/// Discs and packing fractions: over the density, then over the number.
const SYSTEMS: [(u64, f64); 7] =
    [(2500, 0.001), (2500, 0.01), (2500, 0.1), (2500, 0.5), (2500, 0.7), (40_000, 0.5), (640_000, 0.5)];
/// Most discs of a linear search.
const MOST_BY_SEARCH: u64 = 2500;
/// Seconds that a case takes at least.
const SECONDS: f64 = 0.02;

/// Measured work: registration and look-ups.
pub(in crate::laboratory::hard_disks) static WORKS: [StudyWork; 1] = [StudyWork {
    name: "hard-disks-cells",
    measure: |parameters| measure_cells(&parse_parameters(parameters)?),
}];

/// Registers the neighbours of a fluid's discs and visits them, again and again.
fn measure_cells(&(kind, discs, packing): &(usize, u64, f64)) -> Result<CaseReading, StudyError> {
    let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, packing);
    let mut fluid = RunningScene::begin_timed("hard-disks", &scene)?;
    // A few collisions for each disc destroy the lattice.
    fluid.advance_events(2 * discs)?;
    let particles = fluid.simulation.particles();
    let places: Vec<[f64; 2]> = particles.all().iter().map(|disc| disc.planar_position()).collect();
    // Hashing knows no periodic second side.
    let domain = Domain::planar(fluid.domain.corner(), fluid.domain.lengths(), [true, false]);
    let mask = Mask::square(2);
    let mut cells = TrialCells::new(KINDS[kind].0, &domain, particles.all()[0].radius, &mask);
    let mut timed = |task: &mut dyn FnMut(&mut TrialCells)| {
        let (begun, mut times) = (Instant::now(), 0);
        while begun.elapsed().as_secs_f64() < SECONDS {
            task(&mut cells);
            times += 1;
        }
        begun.elapsed().as_secs_f64() / f64::from(times) / places.len() as f64
    };
    let registered = timed(&mut |cells| {
        cells.register(&places);
    });
    let mut found = [0; 2];
    let visited = timed(&mut |cells| found = std::hint::black_box(cells.visit_all()));
    let named = |(name, value): (&str, f64)| (name.to_owned(), value);
    let count = places.len() as f64;
    Ok(CaseReading {
        work: 1.0,
        seconds: registered + visited,
        parts: BTreeMap::from([("registration", registered), ("visits", visited)].map(named)),
        counts: BTreeMap::from(
            [("bytes", cells.bytes() as f64 / count), ("neighbours", found[0] as f64 / count)].map(named),
        ),
        ..CaseReading::default()
    })
}

/// Measures every kind of cells.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let most = if size == StudySize::Quick { 2500 } else { u64::MAX };
    let systems = SYSTEMS.into_iter().filter(|(discs, _)| *discs <= most);
    let cases: Vec<(usize, u64, f64)> = systems
        .flat_map(|(discs, packing)| (0..KINDS.len()).map(move |kind| (kind, discs, packing)))
        .filter(|&(kind, discs, _)| KINDS[kind].0 != CellKind::Linear || discs <= MOST_BY_SEARCH)
        .collect();
    let measured = cases.iter().map(|case| {
        let (kind, discs, packing) = case;
        let case = RateCase::own(&WORKS[0], json!(case)).label("cells", KINDS[*kind].1);
        case.label("discs", *discs).label("ν", packing.to_string())
    });
    let measured = measure_rates(lab, &measured.collect::<Vec<_>>())?;
    Ok(FinishedItem::of([FrameBuilder::of(cases.iter().zip(&measured))
        .text("cells", |((kind, ..), _)| KINDS[*kind].1)
        .count("discs", |((_, discs, _), _)| *discs)
        .number("ν", 3, |((.., packing), _)| *packing)
        .cell("registration of a disc (ns)", |(_, it)| it.part("registration").cell(1e9, 1))
        .cell("visits around a disc (ns)", |(_, it)| it.part("visits").cell(1e9, 1))
        .number("neighbours", 2, |(_, it)| it.count("neighbours"))
        .number("bytes of a disc", 1, |(_, it)| it.count("bytes"))
        .frame("cells", "Registration and visits of the neighbours in 5 × 5 cells, for each disc")])
    .with_seeds([1]))
}
