//! Columns of checkpoints.

use crate::io::checkpoint::Column;
use stripmine_kernels::isa::{Element, Storage};

/// Stores values in a column of their precision.
pub(crate) fn real_column<T: Element>(values: impl Iterator<Item = T>) -> Column {
    match T::NAME {
        f64::NAME => Column::F64(values.map(|value| value.to_f64()).collect()),
        _ => Column::F32(values.map(|value| value.to_f64() as f32).collect()),
    }
}
