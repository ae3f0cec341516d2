//! Constants and moments of a run, for its files.

use crate::averages::AveragedRows;
use crate::io::run_moment::{FramesEvery, RunHeader, RunMoment};
use crate::method::{Every, ObservedQuantity, Prepared, QuantityKind, Simulation};

/// Returns the constants of a run.
pub(super) fn header_of(
    prepared: &Prepared,
    quantities: &'static [ObservedQuantity],
    simulation: &dyn Simulation,
) -> RunHeader {
    let domain = prepared.domain;
    let of_frames = |(_, quantity): &(usize, &ObservedQuantity)| quantity.kind != QuantityKind::Time;
    RunHeader {
        cell: domain.lengths(),
        origin: domain.corner(),
        periodic: domain.periodic(),
        seed: prepared.seed,
        frames: match prepared.schedule.snapshots {
            Every::Never | Every::Seconds(_) => FramesEvery::Never,
            Every::Steps(steps) => FramesEvery::Steps(steps),
            Every::Time(time) => FramesEvery::Time(time),
        },
        time_step: simulation.time_step(),
        columns: quantities.iter().map(|quantity| quantity.name).collect(),
        logged: quantities.iter().enumerate().filter(of_frames).map(|(place, _)| place).collect(),
        event_columns: prepared.event_columns,
    }
}

/// Returns the present moment of a simulation, with its row, if there is one.
pub(super) fn moment_of<'m>(
    simulation: &'m dyn Simulation,
    header: &'m RunHeader,
    rows: &'m AveragedRows,
) -> RunMoment<'m> {
    let clock = simulation.clock();
    let numbers = (clock.steps, clock.number(), clock.time);
    let mut moment = RunMoment::new(header, simulation.per_particle(), numbers);
    moment.row = rows.row_at(clock.time);
    moment
}
