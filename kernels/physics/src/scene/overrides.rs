//! Overrides of a scene's values, key by key.

use super::keys::{Key, KeyValue};
use crate::words::Words;
use serde::{Serialize, Serializer};
use toml::Spanned;
use toml::de::DeValue;

/// Overrides of a scene by their keys, so that an unknown key does not compile. [`SceneValues::with`](super::SceneValues::with) applies them;
/// [`texts`](Overrides::texts) formats them for a command line.
///
/// ```
/// use stripmine_physics::method::{METHODS, prepare, vocabularies};
/// use stripmine_physics::scene::{COUNT, DT, Overrides, SceneValues};
///
/// let overrides = Overrides::new().set(&COUNT, 100_u64).set(&DT, 5e-5);
/// assert_eq!(overrides.texts(), ["particles.count=100", "integrator.dt=5e-5"]);
/// let values = SceneValues::load("dense-gas", &[], &vocabularies(METHODS))?;
/// let (prepared, _) = prepare(values.with(&overrides)?, METHODS)?;
/// assert_eq!(prepared.particles().len(), 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides(Vec<(&'static Key, KeyValue)>);

impl Overrides {
    /// Creates an empty list of overrides.
    pub fn new() -> Overrides {
        Overrides::default()
    }

    /// Adds an override; the last one for a key applies.
    #[must_use]
    pub fn set(mut self, key: &'static Key, value: impl Into<KeyValue>) -> Overrides {
        self.0.push((key, value.into()));
        self
    }

    /// Adds overrides after these.
    #[must_use]
    pub fn and(mut self, later: &Overrides) -> Overrides {
        self.0.extend_from_slice(&later.0);
        self
    }

    /// True if nothing is overridden.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Keys and values, in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Key, &KeyValue)> {
        self.0.iter().map(|(key, value)| (*key, value))
    }

    /// Texts `section.key=value`, as a command line gives them; a number reads back to the same bits.
    pub fn texts(&self) -> Vec<String> {
        self.iter().map(|(key, value)| format!("{}={}", key.path(), typed(value))).collect()
    }
}

/// Value as a user types it: whole numbers without a point, words without quotes where possible.
pub(super) fn typed(value: &KeyValue) -> String {
    let toml = value.to_toml();
    match value {
        KeyValue::Word(word) if as_typed(word.trim()).get_ref().as_str() == Some(word) => word.clone(),
        _ => toml.strip_suffix(".0").unwrap_or(&toml).to_owned(),
    }
}

/// Parses a value typed on a command line, where a word needs no quotes.
pub(super) fn as_typed(text: &str) -> Spanned<DeValue<'_>> {
    Spanned::new(0..0, DeValue::parse(text).map_or(DeValue::String(text.into()), Spanned::into_inner))
}

impl FromIterator<(&'static Key, KeyValue)> for Overrides {
    fn from_iter<I: IntoIterator<Item = (&'static Key, KeyValue)>>(overrides: I) -> Overrides {
        Overrides(overrides.into_iter().collect())
    }
}

impl Serialize for Overrides {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.texts().serialize(serializer)
    }
}

macro_rules! values_from {
    ($($ty:ty => $variant:ident,)*) => {
        $(
            impl From<$ty> for KeyValue {
                fn from(value: $ty) -> KeyValue {
                    KeyValue::$variant(value)
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

impl From<usize> for KeyValue {
    fn from(count: usize) -> KeyValue {
        KeyValue::Whole(count as u64)
    }
}

impl From<&str> for KeyValue {
    fn from(word: &str) -> KeyValue {
        KeyValue::Word(word.to_owned())
    }
}

impl<W: Words> From<W> for KeyValue {
    fn from(word: W) -> KeyValue {
        word.word().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, vocabularies};
    use crate::scene::{DT, FILE, PRECISION, Precision, SceneValues, VELOCITIES};

    /// Overrides given as values and as texts read back exactly.
    #[test]
    fn overrides_read_back_exactly() {
        let known = vocabularies(METHODS);
        let velocities = vec![[0.1, -1e-300], [2.0, 1.0 / 3.0]];
        for dt in [1.0, 0.1 + 0.2, 1e-9 / 3.0] {
            let overrides = Overrides::new()
                .set(&DT, dt)
                .set(&VELOCITIES, velocities.clone())
                .set(&PRECISION, Precision::Mixed);
            let typed = SceneValues::load("two-discs", &[], &known).unwrap().with(&overrides).unwrap();
            for values in [typed, SceneValues::load("two-discs", &overrides.texts(), &known).unwrap()] {
                assert_eq!(values.given(&DT), Some(&KeyValue::Number(dt)));
                assert_eq!(values.given(&VELOCITIES), Some(&KeyValue::Pairs(velocities.clone())));
                assert_eq!(values.choice(&PRECISION).as_deref(), Some("mixed"));
            }
        }
    }

    /// Words that read back as themselves need no quotes; `2024-01-01`, `12` and a word with outer blanks do.
    #[test]
    fn words_are_quoted_where_they_must_be() {
        for (word, text) in
            [("a b.xyz", "a b.xyz"), ("12", "\"12\""), (" a", "\" a\""), ("2024-01-01", "\"2024-01-01\"")]
        {
            let overrides = Overrides::new().set(&FILE, word);
            assert_eq!(overrides.texts(), [format!("particles.file={text}")]);
        }
    }
}
