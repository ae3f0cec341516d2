//! Arrays of numbers as values of keys, without a text in between.

use super::keys::{KeyValue, KeyValueKind, NumberRange};

/// Array of numbers, the last axis first in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberArray {
    /// Length along each axis.
    pub shape: Vec<usize>,
    /// Numbers.
    pub numbers: Vec<f64>,
}

/// Reason why an array is no value of a key.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ArrayFault {
    /// The key takes no array.
    NoList,
    /// Another shape.
    Shape(Vec<usize>),
    /// A number out of range, at an index.
    Number(Vec<usize>, f64),
}

impl NumberArray {
    /// Value of a key of this kind.
    pub(super) fn value(&self, kind: KeyValueKind) -> Result<KeyValue, ArrayFault> {
        let (axes, width, range) = match kind {
            KeyValueKind::Numbers(range) => (1, None, range),
            KeyValueKind::Pair(range) => (1, Some(2), range),
            KeyValueKind::Pairs => (2, Some(2), NumberRange::Finite),
            KeyValueKind::Rows(width) => (2, Some(width), NumberRange::Finite),
            _ => return Err(ArrayFault::NoList),
        };
        let last = self.shape.last().copied();
        if self.shape.len() != axes || width.is_some_and(|width| last != Some(width)) {
            return Err(ArrayFault::Shape(self.shape.clone()));
        }
        if let Some(at) = self.numbers.iter().position(|&number| !range.admit(number)) {
            let columns = if axes == 2 { last.unwrap_or(1) } else { 1 };
            let place = if axes == 2 { vec![at / columns, at % columns] } else { vec![at] };
            return Err(ArrayFault::Number(place, self.numbers[at]));
        }
        // Negative zero becomes zero, as in a text.
        let numbers = self.numbers.iter().map(|number| number + 0.0);
        let pairs = || self.numbers.chunks_exact(2).map(|pair| [pair[0] + 0.0, pair[1] + 0.0]);
        Ok(match kind {
            KeyValueKind::Pair(_) => KeyValue::Pair(pairs().next().unwrap_or_default()),
            KeyValueKind::Pairs => KeyValue::Pairs(pairs().collect()),
            KeyValueKind::Rows(width) => {
                let rows = self.numbers.chunks_exact(width.max(1));
                KeyValue::Rows(rows.map(|row| row.iter().map(|number| number + 0.0).collect()).collect())
            }
            _ => KeyValue::Numbers(numbers.collect()),
        })
    }
}
