//! Columns of checkpoints.

use crate::io::checkpoint::Column;
use stripmine_kernels::isa::{Element, Storage};

/// A column in its precision.
pub fn real_column<T: Element>(values: impl Iterator<Item = T>) -> Column {
    match T::NAME {
        f64::NAME => Column::F64(values.map(|value| value.to_f64()).collect()),
        _ => Column::F32(values.map(|value| value.to_f64() as f32).collect()),
    }
}

/// The entries of the column of a name, if it has the precision `T` and that length.
///
/// # Errors
/// A sentence that says what is missing.
pub fn find_column<T: Element>(
    columns: &[(String, Column)],
    name: &str,
    length: usize,
) -> Result<Vec<T>, String> {
    let (_, column) = columns
        .iter()
        .find(|(there, _)| there == name)
        .ok_or_else(|| format!("the column {name} is missing"))?;
    let values: Vec<T> = match column {
        Column::F64(values) if T::NAME == f64::NAME => values.iter().map(|&x| T::from_f64(x)).collect(),
        Column::F32(values) if T::NAME == f32::NAME => {
            values.iter().map(|&x| T::from_f64(x.into())).collect()
        }
        _ => return Err(format!("the column {name} has another precision")),
    };
    if values.len() != length {
        return Err(format!("the column {name} has {} entries, not {length}", values.len()));
    }
    Ok(values)
}
