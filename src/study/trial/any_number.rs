//! Serialisation of numbers to JSON, which has neither infinities nor NaN: these are written as words.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number as JSON can store it.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum JsonNumber {
    Finite(f64),
    Word(String),
}

/// Values made of numbers, and their form in a file.
pub(crate) trait JsonNumbers: Sized {
    /// Form of the value in a file, with each number as stored.
    type Held: Serialize + for<'de> Deserialize<'de>;

    fn held(&self) -> Self::Held;

    /// Reads a stored value; none where a word is not a number.
    fn of(held: Self::Held) -> Option<Self>;
}

impl JsonNumbers for f64 {
    type Held = JsonNumber;

    fn held(&self) -> JsonNumber {
        if self.is_finite() { JsonNumber::Finite(*self) } else { JsonNumber::Word(self.to_string()) }
    }

    fn of(held: JsonNumber) -> Option<f64> {
        match held {
            JsonNumber::Finite(value) => Some(value),
            JsonNumber::Word(word) => word.parse().ok(),
        }
    }
}

impl JsonNumbers for [f64; 2] {
    type Held = [JsonNumber; 2];

    fn held(&self) -> [JsonNumber; 2] {
        self.each_ref().map(JsonNumbers::held)
    }

    fn of([first, second]: [JsonNumber; 2]) -> Option<[f64; 2]> {
        Some([f64::of(first)?, f64::of(second)?])
    }
}

impl<T: JsonNumbers> JsonNumbers for Option<T> {
    type Held = Option<T::Held>;

    fn held(&self) -> Option<T::Held> {
        self.as_ref().map(JsonNumbers::held)
    }

    fn of(held: Option<T::Held>) -> Option<Option<T>> {
        match held {
            None => Some(None),
            Some(held) => T::of(held).map(Some),
        }
    }
}

pub(crate) fn serialize<T: JsonNumbers, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
    value.held().serialize(to)
}

pub(crate) fn deserialize<'de, T: JsonNumbers, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    let held = T::Held::deserialize(from)?;
    T::of(held).ok_or_else(|| serde::de::Error::custom("expected a number, inf, -inf or NaN"))
}

#[cfg(test)]
mod tests {
    use serde::{Deserialize, Serialize};

    #[derive(Debug, Serialize, Deserialize)]
    struct NumberRecord {
        #[serde(with = "super")]
        one: f64,
        #[serde(with = "super")]
        two: Option<[f64; 2]>,
    }

    /// Compares bits, as NaN is unequal to itself.
    #[test]
    fn every_number_survives_json() {
        for one in [0.1, -0.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            for two in [None, Some([one, 2.0])] {
                let text = serde_json::to_string(&NumberRecord { one, two }).unwrap();
                let read: NumberRecord = serde_json::from_str(&text).unwrap();
                assert_eq!(read.one.to_bits(), one.to_bits(), "{text}");
                assert_eq!(read.two.map(|it| it.map(f64::to_bits)), two.map(|it| it.map(f64::to_bits)));
            }
        }
        assert!(serde_json::from_str::<NumberRecord>("{\"one\":\"many\",\"two\":null}").is_err());
    }
}
