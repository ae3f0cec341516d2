//! What ranks tell each other, as words.

use crate::io::checkpoint::Column;
use crate::method::{Clock, Culprit, Failure, FailureKind};
use crate::ranks::{Gone, Parcel, Reader};
use stripmine_kernels::sweep::fast::OfBand;

/// Ranks that have ended.
const RANK_ENDED: FailureKind = FailureKind::new("rank-ended");

/// A disc as failures and checks know it, whichever rank has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Record {
    pub(super) number: usize,
    pub(super) is_grain: bool,
    pub(super) id: u32,
    pub(super) position: [f64; 2],
    pub(super) velocity: [f64; 2],
    pub(super) radius: f64,
}

impl Record {
    pub(super) fn put(&self, parcel: &mut Parcel) {
        let &Record { number, is_grain, id, position: [x, y], velocity: [u, v], radius } = self;
        [number, usize::from(is_grain), id as usize].into_iter().for_each(|count| parcel.push(count));
        parcel.numbers([x, y, u, v, radius]);
    }

    pub(super) fn take(reader: &mut Reader<'_>) -> Record {
        let [number, is_grain, id] = [(); 3].map(|()| reader.count());
        let [x, y, u, v, radius] = reader.numbers();
        let (position, velocity) = ([x, y], [u, v]);
        Record { number, is_grain: is_grain > 0, id: id as u32, position, velocity, radius }
    }
}

pub(super) fn put_band(band: &OfBand, parcel: &mut Parcel) {
    let &OfBand { pairs, dissipated, energy, contacts, deepest } = band;
    parcel.0.extend([pairs, contacts]);
    parcel.numbers([dissipated, energy[0], energy[1], deepest]);
}

pub(super) fn take_band(reader: &mut Reader<'_>) -> OfBand {
    let [pairs, contacts] = [(); 2].map(|()| reader.count() as u64);
    let [dissipated, potential, virial, deepest] = reader.numbers();
    OfBand { pairs, dissipated, energy: [potential, virial], contacts, deepest }
}

/// What the engine may fail by, and what its failures hold.
const KINDS: [FailureKind; 4] =
    [FailureKind::NOT_FINITE, FailureKind::OUT_OF_BOX, FailureKind::CONFLICT, FailureKind::NO_SECTORS];
const VALUES: [&str; 1] = ["distance"];

/// A failure, or none.
pub(super) fn put_failure(failure: Option<&Failure>, parcel: &mut Parcel) {
    parcel.push(usize::from(failure.is_some()));
    let Some(failure) = failure else { return };
    parcel.text(failure.kind.name());
    parcel.push(failure.at.map_or(0, |at| at.steps as usize));
    parcel.numbers([failure.at.map_or(0.0, |at| at.time)]);
    parcel.push(failure.count as usize);
    parcel.push(failure.culprits.len());
    for culprit in &failure.culprits {
        parcel.push(culprit.id as usize);
        parcel.numbers(culprit.position.into_iter().chain(culprit.velocity));
    }
    parcel.numbers(VALUES.map(|name| failure.value(name).unwrap_or(f64::NAN)));
    parcel.text(&failure.message);
    parcel.text(&failure.remedy);
}

pub(super) fn take_failure(reader: &mut Reader<'_>) -> Option<Failure> {
    (reader.count() > 0).then(|| {
        let name = reader.text();
        let kind = KINDS.into_iter().find(|kind| kind.name() == name).unwrap_or(FailureKind::MACHINE);
        let (steps, time) = (reader.count() as u64, reader.number());
        let count = reader.count() as u64;
        let culprits = (0..reader.count()).map(|_| {
            let id = reader.count() as u32;
            let [x, y, z, u, v, w] = reader.numbers();
            Culprit { called: "disc", id, position: [x, y, z], velocity: [u, v, w] }
        });
        let culprits: Vec<Culprit> = culprits.collect();
        let values: Vec<(&'static str, f64)> = VALUES
            .map(|name| (name, reader.number()))
            .into_iter()
            .filter(|(_, value)| !value.is_nan())
            .collect();
        let (message, remedy) = (reader.text(), reader.text());
        let failure = Failure::new(kind, message, remedy).at(Clock { steps, time, events: 0 });
        failure.of(count, culprits).with(values)
    })
}

/// What a rank that has ended means for the others.
pub(super) fn ended(gone: Gone, at: Clock) -> Failure {
    let remedy =
        "see what it said last; the last checkpoint is whole: go on with --resume, on any number of ranks";
    Failure::new(RANK_ENDED, gone.to_string(), remedy).at(at)
}

/// The entries of a column as numbers. Counts are below 2⁵³.
pub(super) fn entries(column: &Column) -> Vec<f64> {
    match column {
        Column::F64(values) => values.clone(),
        Column::F32(values) => values.iter().map(|&value| value.into()).collect(),
        Column::U32(values) => values.iter().map(|&value| value.into()).collect(),
        Column::U64(values) => values.iter().map(|&value| value as f64).collect(),
    }
}

/// A column of the type of another one.
pub(super) fn column_like(like: &Column, values: Vec<f64>) -> Column {
    match like {
        Column::F64(_) => Column::F64(values),
        Column::F32(_) => Column::F32(values.into_iter().map(|value| value as f32).collect()),
        Column::U32(_) => Column::U32(values.into_iter().map(|value| value as u32).collect()),
        Column::U64(_) => Column::U64(values.into_iter().map(|value| value as u64).collect()),
    }
}

/// Columns with their names and types.
pub(super) fn put_columns(columns: &[(String, Column)], parcel: &mut Parcel) {
    parcel.push(columns.len());
    for (name, column) in columns {
        parcel.text(name);
        let kind = match column {
            Column::F64(_) => 0,
            Column::F32(_) => 1,
            Column::U32(_) => 2,
            Column::U64(_) => 3,
        };
        parcel.push(kind);
        parcel.push(column.len());
        parcel.numbers(entries(column));
    }
}

pub(super) fn take_columns(reader: &mut Reader<'_>) -> Vec<(String, Column)> {
    let count = reader.count();
    let one = |_| {
        let (name, kind, length) = (reader.text(), reader.count(), reader.count());
        let values = (0..length).map(|_| reader.number()).collect();
        let like = match kind {
            0 => Column::F64(vec![]),
            1 => Column::F32(vec![]),
            2 => Column::U32(vec![]),
            _ => Column::U64(vec![]),
        };
        (name, column_like(&like, values))
    };
    (0..count).map(one).collect()
}
