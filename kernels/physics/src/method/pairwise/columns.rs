//! Columns of checkpoints.

use crate::io::checkpoint::CheckpointColumn;
use stripmine_kernels::isa::{Element, Storage};

/// Stores values in a column of their precision.
pub(crate) fn real_column<T: Element>(values: impl Iterator<Item = T>) -> CheckpointColumn {
    match T::NAME {
        f64::NAME => CheckpointColumn::F64(values.map(|value| value.to_f64()).collect()),
        _ => CheckpointColumn::F32(values.map(|value| value.to_f64() as f32).collect()),
    }
}
