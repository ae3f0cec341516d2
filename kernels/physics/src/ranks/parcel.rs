//! Messages between ranks as bytes: derived by serde, with a separate form for arrays of numbers.

use super::RankError;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Bytes that a transport moves unread; a message may contain a parcel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parcel(pub Vec<u8>);

impl Parcel {
    /// Serialises a message.
    pub fn of<T: Serialize + ?Sized>(message: &T) -> Parcel {
        Parcel::sent(Ok(message))
    }

    /// Message of a rank that lacks data from another one.
    pub fn lost(error: RankError) -> Parcel {
        Parcel::sent(Err::<(), _>(error))
    }

    fn sent<T: Serialize>(message: Result<T, RankError>) -> Parcel {
        #[expect(
            clippy::disallowed_methods,
            reason = "no message is empty, so opening a message that could not be written names this rank"
        )]
        let bytes = postcard::to_allocvec(&message).unwrap_or_default();
        Parcel(bytes)
    }

    /// Deserialises the message of a rank.
    ///
    /// # Errors
    /// [`RankError`] if these bytes are not such a message, or report the loss of another rank.
    pub fn open<'p, T: Deserialize<'p>>(&'p self, from: usize) -> Result<T, RankError> {
        match postcard::take_from_bytes::<Result<T, RankError>>(&self.0) {
            Ok((message, [])) => message,
            _ => Err(RankError::Unreadable(from)),
        }
    }

    /// Serialises many numbers at once: as a derived message, each of them would take a call.
    pub(crate) fn of_numbers(numbers: impl IntoIterator<Item = f64>) -> Parcel {
        let bytes: Vec<[u8; size_of::<f64>()]> = numbers.into_iter().map(f64::to_le_bytes).collect();
        Parcel(bytes.into_flattened())
    }
}

/// Deserialises the [numbers](Parcel::of_numbers) of a rank.
///
/// # Errors
/// [`RankError`] if their number is not `count`, or these bytes report the loss of another rank.
pub(crate) fn numbers(
    bytes: &[u8],
    from: usize,
    count: usize,
) -> Result<impl Iterator<Item = f64>, RankError> {
    match bytes.as_chunks() {
        (numbers, []) if numbers.len() == count => Ok(numbers.iter().map(|&it| f64::from_le_bytes(it))),
        _ => Err(Parcel(bytes.to_vec()).open::<()>(from).err().unwrap_or(RankError::Unreadable(from))),
    }
}

impl Serialize for Parcel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for Parcel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Parcel, D::Error> {
        <&[u8]>::deserialize(deserializer).map(|bytes| Parcel(bytes.to_vec()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Message = (Option<bool>, Vec<u64>, String, Vec<Parcel>);

    proptest! {
        /// A message is read as it was sent, with numbers exact to the bit. Missing or excess bytes are an error that names the rank.
        #[test]
        fn messages_are_read_whole_or_refused(
            flag: Option<bool>, counts: Vec<u64>, text: String, inner: Vec<Vec<u64>>, cut: prop::sample::Index
        ) {
            let sent = |bits: &Vec<u64>| Parcel::of_numbers(bits.iter().copied().map(f64::from_bits));
            let message: Message = (flag, counts, text, inner.iter().map(sent).collect());
            let parcel = Parcel::of(&message);
            let found: Message = parcel.open(3).unwrap();
            prop_assert_eq!(&found, &message);
            let unreadable = Some(RankError::Unreadable(3));
            for (Parcel(sent), expected) in found.3.iter().zip(&inner) {
                let bits: Vec<u64> = numbers(sent, 3, expected.len()).unwrap().map(f64::to_bits).collect();
                prop_assert_eq!(&bits, expected);
                prop_assert_eq!(numbers(sent, 3, expected.len() + 1).map(drop).err(), unreadable);
                let longer = [sent, &[0][..]].concat();
                prop_assert_eq!(numbers(&longer, 3, expected.len()).map(drop).err(), unreadable);
            }
            let damaged = Parcel(parcel.0[..cut.index(parcel.0.len())].to_vec());
            prop_assert_eq!(damaged.open::<Message>(3).err(), unreadable);
            let damaged = Parcel([parcel.0, vec![0]].concat());
            prop_assert_eq!(damaged.open::<Message>(3).err(), unreadable);
        }
    }

    /// A reported loss of another rank is read as such, whatever message was expected.
    #[test]
    fn losses_are_passed_on() {
        for lost in [RankError::Ended(2), RankError::Unreadable(0)] {
            assert_eq!(Parcel::lost(lost).open::<Message>(1), Err(lost));
            assert_eq!(numbers(&Parcel::lost(lost).0, 1, 7).map(drop), Err(lost));
        }
    }
}
