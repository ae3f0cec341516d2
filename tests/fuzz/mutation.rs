//! Small changes to an input, of the kinds that break readers.

use proptest::collection::vec;
use proptest::prelude::{Strategy, prop_oneof};

/// Change of an input. Positions are fractions of the length, so that they are valid in any input.
#[derive(Clone, Debug)]
pub(crate) enum Mutation {
    Flip {
        at: u16,
        bit: u8,
    },
    Cut {
        at: u16,
    },
    Delete {
        at: u16,
        length: u8,
    },
    Insert {
        at: u16,
        what: usize,
    },
    /// Replaces the number at or after a position.
    Number {
        at: u16,
        what: usize,
    },
    /// Replaces a number by its product with a factor.
    Scale {
        at: u16,
        by: usize,
    },
    Word {
        at: u16,
        with: u16,
    },
    DoubleLine {
        at: u16,
        to: u16,
    },
    DeleteLine {
        at: u16,
    },
    Repeat {
        at: u16,
        length: u8,
        times: u16,
    },
    Splice {
        at: u16,
        seed: usize,
        from: u16,
        length: u16,
    },
}

const NUMBERS: &[&str] = &[
    "0",
    "-0.0",
    "1",
    "-1",
    "0.5",
    "1e308",
    "-1e308",
    "5e-324",
    "1e-30",
    "1e20",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "4294967295",
    "4294967296",
    "2147483647",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "1e15",
    "1e6",
    "0x10",
    "0b1",
    "1_000",
    "1.",
    ".5",
    "+1",
    "1e",
    "3",
    "7",
    "100000000",
];

const PIECES: &[&str] = &[
    "\0",
    "\u{1b}[31m",
    "\u{202e}",
    "\u{feff}",
    "\u{2028}",
    "\r",
    "\r\n",
    "\n",
    "\n\n",
    "\"",
    "'",
    "\"\"\"",
    "[",
    "]",
    "{",
    "}",
    "[[",
    "[[[[[[[[[[[[[[[[",
    "{{{{{{{{",
    "=",
    ":",
    ".",
    ",",
    "#",
    "\\",
    "\\u0000",
    "é",
    "数",
    "-",
    "a.b.c = 1\n",
    "[law]\n",
    "[[law]]\n",
    "x = [",
    "1979-05-27T07:32:00Z",
    "true",
    " = ",
    "\t",
    "1 2 3 ",
    "Si ",
    "W ",
    "Lattice=\"",
    "Properties=",
    ":R:3",
    ":I:18446744073709551615",
    ":S:1",
    "5\n",
];

/// Factors that leave most numbers in their range.
const FACTORS: [f64; 8] = [0.5, 2.0, 0.9, 1.1, 0.1, 10.0, 1.7, -1.0];

/// A few changes of any kind.
pub(crate) fn some() -> impl Strategy<Value = Vec<Mutation>> {
    vec(any(), 1..6)
}

/// One to three changes that leave most inputs valid.
pub(crate) fn gentle() -> impl Strategy<Value = Vec<Mutation>> {
    let at = || proptest::prelude::any::<u16>();
    let scale = || (at(), 0..FACTORS.len()).prop_map(|(at, by)| Mutation::Scale { at, by });
    vec(prop_oneof![scale(), scale(), scale(), scale(), any()], 1..4)
}

fn any() -> impl Strategy<Value = Mutation> {
    let at = || proptest::prelude::any::<u16>();
    let number = || (at(), 0..NUMBERS.len()).prop_map(|(at, what)| Mutation::Number { at, what });
    prop_oneof![
        number(),
        number(),
        (at(), 0u8..8).prop_map(|(at, bit)| Mutation::Flip { at, bit }),
        at().prop_map(|at| Mutation::Cut { at }),
        (at(), proptest::prelude::any::<u8>()).prop_map(|(at, length)| Mutation::Delete { at, length }),
        (at(), 0..PIECES.len()).prop_map(|(at, what)| Mutation::Insert { at, what }),
        (at(), 0..NUMBERS.len()).prop_map(|(at, what)| Mutation::Number { at, what }),
        (at(), at()).prop_map(|(at, with)| Mutation::Word { at, with }),
        (at(), at()).prop_map(|(at, to)| Mutation::DoubleLine { at, to }),
        at().prop_map(|at| Mutation::DeleteLine { at }),
        (at(), proptest::prelude::any::<u8>(), 0u16..300).prop_map(|(at, length, times)| Mutation::Repeat {
            at,
            length,
            times
        }),
        (at(), 0usize..64, at(), at()).prop_map(|(at, seed, from, length)| Mutation::Splice {
            at,
            seed,
            from,
            length
        }),
    ]
}

fn place(part: u16, length: usize) -> usize {
    part as usize * (length + 1) / (usize::from(u16::MAX) + 1)
}

fn run(input: &[u8], at: usize, belongs: impl Fn(u8) -> bool) -> std::ops::Range<usize> {
    let Some(first) = (at..input.len()).find(|&at| belongs(input[at])) else { return at..at };
    let start = (0..first).rev().find(|&at| !belongs(input[at])).map_or(0, |at| at + 1);
    let end = (first..input.len()).find(|&at| !belongs(input[at])).unwrap_or(input.len());
    start..end
}

impl Mutation {
    pub(crate) fn apply(&self, input: &mut Vec<u8>, seeds: &[Vec<u8>]) {
        let length = input.len();
        let line = |at: u16| run(input, place(at, length), |byte| byte != b'\n');
        let word =
            |at: u16| run(input, place(at, length), |byte| byte.is_ascii_alphanumeric() || byte == b'_');
        match *self {
            Mutation::Flip { at, bit } => {
                if let Some(byte) = input.get_mut(place(at, length)) {
                    *byte ^= 1 << bit;
                }
            }
            Mutation::Cut { at } => input.truncate(place(at, length)),
            Mutation::Delete { at, length: count } => {
                let at = place(at, length);
                input.drain(at..(at + usize::from(count)).min(length));
            }
            Mutation::Insert { at, what } => {
                let at = place(at, length);
                input.splice(at..at, PIECES[what].bytes());
            }
            Mutation::Number { at, what } => {
                let number = run(input, place(at, length), |byte| {
                    byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+')
                });
                input.splice(number, NUMBERS[what].bytes());
            }
            Mutation::Scale { at, by } => {
                let digits = run(input, place(at, length), |byte| byte.is_ascii_digit() || byte == b'.');
                if let Ok(number) = String::from_utf8_lossy(&input[digits.clone()]).parse::<f64>() {
                    let scaled = number * FACTORS[by];
                    let whole = !input[digits.clone()].contains(&b'.');
                    let text = if whole { format!("{scaled:.0}") } else { format!("{scaled:?}") };
                    input.splice(digits, text.into_bytes());
                }
            }
            Mutation::Word { at, with } => {
                let other = input[word(with)].to_vec();
                let own = word(at);
                input.splice(own, other);
            }
            Mutation::DoubleLine { at, to } => {
                let mut copy = input[line(at)].to_vec();
                copy.push(b'\n');
                let to = line(to).start;
                input.splice(to..to, copy);
            }
            Mutation::DeleteLine { at } => {
                let gone = line(at);
                input.drain(gone);
            }
            Mutation::Repeat { at, length: count, times } => {
                let at = place(at, length);
                let piece = input[at..(at + usize::from(count)).min(length)].repeat(usize::from(times));
                input.splice(at..at, piece);
            }
            Mutation::Splice { at, seed, from, length: count } => {
                let other = &seeds[seed % seeds.len()];
                let from = place(from, other.len());
                let piece = other[from..(from + usize::from(count)).min(other.len())].to_vec();
                let at = place(at, length);
                let end = (at + piece.len()).min(length);
                input.splice(at..end, piece);
            }
        }
    }
}
