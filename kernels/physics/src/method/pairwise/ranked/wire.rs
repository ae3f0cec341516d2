//! Messages between ranks that step discs.

use crate::io::checkpoint::CheckpointColumn;
use crate::method::PhysicsFailure;
use crate::ranks::{Parcel, RankError, numbers};
use serde::{Deserialize, Serialize};
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::sweep::fast::BandReport;

/// Columns by name.
pub(super) type NamedColumns = Vec<(String, CheckpointColumn)>;

/// Disc with the periods that it has crossed.
pub(super) type CrossedPeriods = (usize, [f64; 2]);

/// Order of the first rank to all ranks. None ends the simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RankOrder {
    /// Discs that have crossed periods, with the ranks that reported them.
    pub(super) crossed: Vec<(usize, CrossedPeriods)>,
    /// True if discs are redistributed first.
    pub(super) is_to_migrate: bool,
    pub(super) what: Do,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Do {
    Advance,
    Forces(ObservationRequest),
    SkipForces,
    Look(RankSample),
    Settle,
    Restore { steps: u64, columns: NamedColumns },
}

/// Sample that a rank takes; it changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum RankSample {
    /// Position, angle and their rates of each disc at the end of the step.
    Standing,
    /// Column of the state by its index. With all columns at once, the first rank would hold them three times.
    Column(usize),
    /// Force along x and y and torque on each disc.
    Forces,
    /// Velocity of each disc left by the last predictor.
    Velocities,
    /// Sums over the contacts of each band at the end of the step.
    Contacts,
    /// The number of listed pairs.
    Listed,
    /// Discs that belong to no cell or have a value that is not finite.
    Unfit,
}

impl From<Do> for RankOrder {
    /// Order without news.
    fn from(what: Do) -> RankOrder {
        RankOrder { crossed: vec![], is_to_migrate: false, what }
    }
}

/// Report of a rank after a step: its failure and the discs that the first rank needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct StepReport {
    pub(super) failure: Option<PhysicsFailure>,
    /// Discs that moved far.
    pub(super) far: Vec<DiscRecord>,
    pub(super) crossed: Vec<CrossedPeriods>,
    /// True if a disc has moved farther than the margin.
    pub(super) has_strayed: bool,
    pub(super) shared_cells: usize,
}

/// Report of a rank's forces: sums over the pairs of each of its bands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ForcesReport {
    /// Result of the redistribution, or the reason why it failed.
    pub(super) distributed: Result<(), String>,
    pub(super) failure: Option<PhysicsFailure>,
    pub(super) bands: Vec<BandReport>,
    pub(super) deep: Vec<[DiscRecord; 2]>,
}

/// Description of a disc for failures and checks on other ranks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct DiscRecord {
    pub(super) number: usize,
    pub(super) is_grain: bool,
    pub(super) id: u32,
    pub(super) position: [f64; 2],
    pub(super) velocity: [f64; 2],
    pub(super) radius: f64,
}

/// Stores the values of a rank's discs at their indices.
///
/// # Errors
/// [`RankError`] if there are not `N` of each, or a disc does not exist in the scene.
pub(super) fn store_rank_values<const N: usize>(
    parcel: &Parcel,
    rank: usize,
    all: &mut [[f64; N]],
) -> Result<(), RankError> {
    let (discs, bytes): (Vec<u32>, &[u8]) = parcel.open(rank)?;
    let mut numbers = numbers(bytes, rank, N * discs.len())?;
    for disc in discs {
        let place = all.get_mut(disc as usize).ok_or(RankError::Unreadable(rank))?;
        place.iter_mut().zip(numbers.by_ref()).for_each(|(to, number)| *to = number);
    }
    Ok(())
}

/// Returns the entries of a column as doubles. Counts are below 2⁵³.
pub(super) fn entries(column: &CheckpointColumn) -> Vec<f64> {
    match column {
        CheckpointColumn::F64(values) => values.clone(),
        CheckpointColumn::F32(values) => values.iter().map(|&value| value.into()).collect(),
        CheckpointColumn::U32(values) => values.iter().map(|&value| value.into()).collect(),
        CheckpointColumn::U64(values) => values.iter().map(|&value| value as f64).collect(),
    }
}

/// Builds a column of the same type as another one.
pub(super) fn column_like(like: &CheckpointColumn, values: Vec<f64>) -> CheckpointColumn {
    match like {
        CheckpointColumn::F64(_) => CheckpointColumn::F64(values),
        CheckpointColumn::F32(_) => {
            CheckpointColumn::F32(values.into_iter().map(|value| value as f32).collect())
        }
        CheckpointColumn::U32(_) => {
            CheckpointColumn::U32(values.into_iter().map(|value| value as u32).collect())
        }
        CheckpointColumn::U64(_) => {
            CheckpointColumn::U64(values.into_iter().map(|value| value as u64).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::pairwise::{conflict, not_finite};
    use crate::method::{Clock, Culprit, FailureKind};
    use proptest::prelude::*;
    use serde::de::DeserializeOwned;
    use std::fmt::Debug;
    use stripmine_kernels::isa::ProgramError;

    fn number() -> impl Strategy<Value = f64> {
        any::<u64>().prop_map(f64::from_bits)
    }

    fn pair() -> impl Strategy<Value = [f64; 2]> {
        prop::array::uniform2(number())
    }

    fn place() -> impl Strategy<Value = [f64; 3]> {
        prop::array::uniform3(number())
    }

    fn record() -> impl Strategy<Value = DiscRecord> {
        (any::<usize>(), any::<bool>(), any::<u32>(), pair(), pair(), number()).prop_map(
            |(number, is_grain, id, position, velocity, radius)| DiscRecord {
                number,
                is_grain,
                id,
                position,
                velocity,
                radius,
            },
        )
    }

    fn failure() -> impl Strategy<Value = Option<PhysicsFailure>> {
        let clock = (any::<u64>(), number(), any::<u64>());
        let clock = prop::option::of(clock.prop_map(|(steps, time, events)| Clock { steps, time, events }));
        let name = || prop::sample::select(vec!["disc", "body", "not-finite"]);
        let culprit = (name(), any::<u32>(), [place(), place()])
            .prop_map(|(called, id, [position, velocity])| Culprit { called, id, position, velocity });
        let (culprits, values) =
            (prop::collection::vec(culprit, 0..3), prop::collection::vec((name(), number()), 0..3));
        let sent = (name(), clock, culprits, any::<u64>(), values, any::<[String; 2]>());
        prop::option::of(sent.prop_map(|(kind, at, culprits, count, values, [message, remedy])| {
            PhysicsFailure { kind: FailureKind::new(kind), at, culprits, count, values, message, remedy }
        }))
    }

    fn crossed() -> impl Strategy<Value = CrossedPeriods> {
        (any::<usize>(), pair())
    }

    fn column() -> impl Strategy<Value = CheckpointColumn> {
        use prop::collection::vec;
        prop_oneof![
            vec(number(), 0..5).prop_map(CheckpointColumn::F64),
            vec(any::<u32>().prop_map(f32::from_bits), 0..5).prop_map(CheckpointColumn::F32),
            any::<Vec<u32>>().prop_map(CheckpointColumn::U32),
            any::<Vec<u64>>().prop_map(CheckpointColumn::U64),
        ]
    }

    fn what() -> impl Strategy<Value = Do> {
        let asked = (prop::option::of(number()), any::<bool>(), any::<bool>());
        let asked = asked.prop_map(|(watched, dissipation, energy)| ObservationRequest {
            watched,
            dissipation,
            energy,
        });
        let look = prop_oneof![
            Just(RankSample::Standing),
            any::<usize>().prop_map(RankSample::Column),
            Just(RankSample::Forces),
            Just(RankSample::Velocities),
            Just(RankSample::Contacts),
            Just(RankSample::Listed),
            Just(RankSample::Unfit),
        ];
        let columns = prop::collection::vec((any::<String>(), column()), 0..3);
        prop_oneof![
            Just(Do::Advance),
            asked.prop_map(Do::Forces),
            Just(Do::SkipForces),
            look.prop_map(Do::Look),
            Just(Do::Settle),
            (any::<u64>(), columns).prop_map(|(steps, columns)| Do::Restore { steps, columns }),
        ]
    }

    fn band() -> impl Strategy<Value = BandReport> {
        (any::<u64>(), number(), pair(), any::<u64>(), number()).prop_map(
            |(pairs, dissipated, energy, contacts, deepest)| BandReport {
                pairs,
                dissipated,
                energy,
                contacts,
                deepest,
            },
        )
    }

    /// Checks that a message arrives bit by bit, and that a truncated one names the rank that it comes from.
    fn returns<T: Serialize + DeserializeOwned + Debug>(message: &T) {
        let parcel = Parcel::of(message);
        let opened: T = parcel.open(4).unwrap();
        assert_eq!((Parcel::of(&opened), format!("{opened:?}")), (parcel.clone(), format!("{message:?}")));
        let cut = Parcel(parcel.0[..parcel.0.len() - 1].to_vec());
        assert_eq!(cut.open::<T>(4).err(), Some(RankError::Unreadable(4)));
    }

    proptest! {
        #[test]
        fn messages_survive_the_round_trip(
            crossed in prop::collection::vec((any::<usize>(), crossed()), 0..3),
            is_to_migrate: bool,
            what in what(),
            failure in failure(),
            records in prop::collection::vec([record(), record()], 0..3),
            counts: [usize; 2],
            distributed: Result<(), String>,
            bands in prop::collection::vec(band(), 0..3),
        ) {
            let order = RankOrder { crossed, is_to_migrate, what };
            let crossed = order.crossed.iter().map(|it| it.1).collect();
            returns(&Some(order));
            returns(&StepReport {
                failure: failure.clone(),
                far: records.concat(),
                crossed,
                has_strayed: is_to_migrate,
                shared_cells: counts[0],
            });
            returns(&ForcesReport { distributed, failure: failure.clone(), bands: bands.clone(), deep: records });
            returns(&failure);
            returns(&bands);
            returns(&counts.to_vec());
        }
    }

    /// A failure keeps its content and kind on the first rank.
    #[test]
    fn failures_survive_the_round_trip() {
        let clock = Clock { steps: 7, time: 0.7, events: 0 };
        let disc = |id| Culprit::in_plane("disc", id, [1.0, 2.0], [3.0, 4.0]);
        let domain = crate::domain::Domain::planar([0.0; 2], [9.0; 2], [true; 2]);
        for failure in [
            not_finite(clock, 3, disc(5)),
            conflict(clock, domain, [disc(1), disc(2)]),
            ProgramError::NoSuchInstructionSet("avx512").into(),
        ] {
            assert_eq!(Parcel::of(&failure).open(0), Ok(failure));
        }
    }

    /// Values of discs that the scene does not have, or not as many as expected, are rejected with the number of the rank.
    #[test]
    fn rank_values_are_stored_by_number() {
        let sent = Parcel::of(&(vec![2_u32, 0], Parcel::of_numbers([1.0, 2.0, 3.0, 4.0])));
        let put = |discs: usize| {
            let mut all = vec![[0.0; 2]; discs];
            store_rank_values(&sent, 6, &mut all).map(|()| all)
        };
        assert_eq!(put(3), Ok(vec![[3.0, 4.0], [0.0; 2], [1.0, 2.0]]));
        assert_eq!(put(2), Err(RankError::Unreadable(6)));
        assert_eq!(store_rank_values(&sent, 6, &mut [[0.0; 3]; 3]), Err(RankError::Unreadable(6)));
    }
}
