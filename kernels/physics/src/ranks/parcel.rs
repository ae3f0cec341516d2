//! What is sent from rank to rank: words of 64 bits, which every carrier can carry.

/// Words, one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parcel(pub Vec<u64>);

impl Parcel {
    /// An empty one.
    pub fn new() -> Parcel {
        Parcel::default()
    }

    /// A count.
    pub fn push(&mut self, count: usize) {
        self.0.push(count as u64);
    }

    /// Numbers, as many as the other side knows of.
    pub fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.0.extend(numbers.into_iter().map(f64::to_bits));
    }

    /// Counts with how many they are.
    pub fn counts(&mut self, counts: impl ExactSizeIterator<Item = u64>) {
        self.push(counts.len());
        self.0.extend(counts);
    }

    /// A text.
    pub fn text(&mut self, text: &str) {
        self.push(text.len());
        let words = text.as_bytes().chunks(8).map(|bytes| {
            let mut word = [0; 8];
            word[..bytes.len()].copy_from_slice(bytes);
            u64::from_le_bytes(word)
        });
        self.0.extend(words);
    }

    /// What there is in it, from the beginning.
    pub fn read(&self) -> Reader<'_> {
        Reader(&self.0)
    }
}

/// What is left of a parcel. Ranks are of one program: what one has put in, another takes out in the same order.
#[derive(Clone, Debug)]
pub struct Reader<'p>(&'p [u64]);

impl Reader<'_> {
    fn word(&mut self) -> u64 {
        let (first, left) = self.0.split_first().map_or((0, self.0), |(first, left)| (*first, left));
        self.0 = left;
        first
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A count.
    pub fn count(&mut self) -> usize {
        self.word() as usize
    }

    /// A number.
    pub fn number(&mut self) -> f64 {
        f64::from_bits(self.word())
    }

    /// Some numbers.
    pub fn numbers<const N: usize>(&mut self) -> [f64; N] {
        [(); N].map(|()| self.number())
    }

    /// Counts.
    pub fn counts(&mut self) -> Vec<u64> {
        (0..self.count()).map(|_| self.word()).collect()
    }

    /// A text.
    pub fn text(&mut self) -> String {
        let length = self.count();
        let mut bytes: Vec<u8> = (0..length.div_ceil(8)).flat_map(|_| self.word().to_le_bytes()).collect();
        bytes.truncate(length);
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_in_comes_out() {
        let mut parcel = Parcel::new();
        parcel.push(3);
        parcel.numbers([0.1, f64::NAN, -0.0]);
        parcel.text("größer als 8 bytes");
        parcel.counts([7, u64::MAX].into_iter());
        let mut reader = parcel.read();
        assert_eq!(reader.count(), 3);
        let numbers: [f64; 3] = reader.numbers();
        assert_eq!(numbers.map(f64::to_bits), [0.1, f64::NAN, -0.0].map(f64::to_bits));
        assert_eq!((reader.text().as_str(), reader.counts()), ("größer als 8 bytes", vec![7, u64::MAX]));
        assert!(reader.is_empty());
    }
}
