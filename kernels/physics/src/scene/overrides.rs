//! What a scene is to say otherwise, key by key.

use super::keys::{Key, Value};
use crate::words::Words;
use serde::Serialize;
use std::ops::Deref;

/// Overrides of a scene, by their keys: a key that there is not does not compile. They come to texts `section.key=value`, as a command
/// line gives them; a number reads back to the same bits.
///
/// ```
/// use stripmine_physics::method::{METHODS, load};
/// use stripmine_physics::scene::{COUNT, DT, Overrides};
///
/// let overrides = Overrides::new().set(&COUNT, 100_u64).set(&DT, 5e-5);
/// assert_eq!(*overrides, ["particles.count=100", "integrator.dt=5e-5"]);
/// let (prepared, _) = load("dense-gas", &overrides, METHODS)?;
/// assert_eq!(prepared.particles().len(), 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Overrides(Vec<String>);

impl Overrides {
    /// None.
    pub fn new() -> Overrides {
        Overrides::default()
    }

    /// One more. Of two for the same key the later one holds.
    #[must_use]
    pub fn set(mut self, key: &Key, value: impl Into<Value>) -> Overrides {
        let value = value.into().to_toml();
        // A whole number stands without a point, as one types it.
        self.0.push(format!("{}={}", key.path(), value.strip_suffix(".0").unwrap_or(&value)));
        self
    }
}

impl Deref for Overrides {
    type Target = [String];

    fn deref(&self) -> &[String] {
        &self.0
    }
}

macro_rules! values_from {
    ($($ty:ty => $variant:ident,)*) => {
        $(
            impl From<$ty> for Value {
                fn from(value: $ty) -> Value {
                    Value::$variant(value)
                }
            }
        )*
    };
}

values_from! {
    f64 => Number,
    u64 => Whole,
    bool => Switch,
    [f64; 2] => Pair,
    Vec<[f64; 2]> => Pairs,
}

impl From<usize> for Value {
    fn from(count: usize) -> Value {
        Value::Whole(count as u64)
    }
}

impl From<&str> for Value {
    fn from(word: &str) -> Value {
        Value::Word(word.to_owned())
    }
}

impl<W: Words> From<W> for Value {
    fn from(word: W) -> Value {
        word.word().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, vocabularies};
    use crate::scene::{DT, PRECISION, Precision, VELOCITIES, Values};

    /// What is set is what is read, to the bit.
    #[test]
    fn values_come_back_as_they_were_set() {
        let velocities = vec![[0.1, -1e-300], [2.0, 1.0 / 3.0]];
        for dt in [1.0, 0.1 + 0.2, 1e-9 / 3.0] {
            let overrides = Overrides::new()
                .set(&DT, dt)
                .set(&VELOCITIES, velocities.clone())
                .set(&PRECISION, Precision::Mixed);
            let values = Values::load("two-discs", &overrides, &vocabularies(METHODS)).unwrap();
            assert_eq!(values.given(&DT), Some(&Value::Number(dt)));
            assert_eq!(values.given(&VELOCITIES), Some(&Value::Pairs(velocities.clone())));
            assert_eq!(values.choice(&PRECISION).as_deref(), Some("mixed"));
        }
    }
}
