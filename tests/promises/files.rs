//! Readers of their own for the files of a run: nothing of the program that wrote them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Where particles are, by id.
pub type Places = BTreeMap<u32, [f64; 3]>;

/// A frame of a text format: its number, its time where the format has one, and its particles.
pub struct TextFrame {
    pub number: u64,
    pub time: Option<f64>,
    pub places: Places,
}

fn number<T: std::str::FromStr>(text: &str) -> T
where
    T::Err: std::fmt::Debug,
{
    text.parse().unwrap_or_else(|error| panic!("`{text}` is no number: {error:?}"))
}

/// The columns and rows of a table.
pub fn table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).expect("it is there");
    let mut lines = text.lines();
    let columns = lines.next().expect("it has a heading").split(',').map(str::to_owned).collect();
    (columns, lines.map(|line| line.split(',').map(number).collect()).collect())
}

pub fn extended_xyz(path: &Path) -> Vec<TextFrame> {
    let text = fs::read_to_string(path).expect("it is there");
    let mut lines = text.lines();
    let mut frames = vec![];
    while let Some(count) = lines.next() {
        let heading = lines.next().expect("a frame has a heading");
        let value =
            |key: &str| heading.split(key).nth(1).and_then(|rest| rest.split(' ').next()).map(str::to_owned);
        let place = |line: &str| {
            let words: Vec<&str> = line.split(' ').collect();
            (number(words[4]), [number(words[1]), number(words[2]), number(words[3])])
        };
        frames.push(TextFrame {
            number: number(&value(" step=").expect("a frame has a number")),
            time: Some(number(&value(" Time=").expect("a frame has a time"))),
            places: lines.by_ref().take(number(count)).map(place).collect(),
        });
    }
    frames
}

pub fn lammps_dump(path: &Path) -> Vec<TextFrame> {
    let text = fs::read_to_string(path).expect("it is there");
    let frames = text.split("ITEM: TIMESTEP\n").skip(1);
    let frame = |text: &str| {
        let (head, rows) = text.split_once("radius mass\n").expect("a frame has rows");
        let place = |line: &str| {
            let words: Vec<&str> = line.split(' ').collect();
            (number(words[0]), [number(words[2]), number(words[3]), number(words[4])])
        };
        let number = number(head.lines().next().expect("a frame has a number"));
        TextFrame { number, time: None, places: rows.lines().map(place).collect() }
    };
    frames.map(frame).collect()
}

/// Frames of positions in single precision, in the order of the start.
pub fn dcd(path: &Path) -> Vec<Vec<[f32; 3]>> {
    let bytes = fs::read(path).expect("it is there");
    let (mut rest, mut records) = (&bytes[..], vec![]);
    while !rest.is_empty() {
        let length = u32::from_le_bytes(rest[..4].try_into().expect("four bytes")) as usize;
        records.push(&rest[4..4 + length]);
        assert_eq!(rest[..4], rest[4 + length..8 + length], "both lengths of a record agree");
        rest = &rest[8 + length..];
    }
    let count = u32::from_le_bytes(records[2].try_into().expect("four bytes")) as usize;
    let has_box = records[3].len() == 48 && (count != 12 || (records.len() - 3).is_multiple_of(4));
    let of_a_frame = if has_box { 4 } else { 3 };
    assert!((records.len() - 3).is_multiple_of(of_a_frame), "frames are whole");
    let along = |record: &[u8], of: usize| {
        f32::from_le_bytes(record[4 * of..4 * of + 4].try_into().expect("four bytes"))
    };
    let frame = |records: &[&[u8]]| {
        let [x, y, z] = [0, 1, 2].map(|axis| records[of_a_frame - 3 + axis]);
        (0..count).map(|of| [along(x, of), along(y, of), along(z, of)]).collect()
    };
    records[3..].chunks(of_a_frame).map(frame).collect()
}
