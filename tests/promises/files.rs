//! Independent readers for the files of a run: they share no code with the program.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Positions of particles, by id.
pub type Places = BTreeMap<u32, [f64; 3]>;

/// A frame of a text format: its number, its time if the format has one, and its particles.
pub struct TextFrame {
    pub number: u64,
    pub time: Option<f64>,
    pub places: Places,
}

impl TextFrame {
    /// Number, bits of the time, and positions.
    pub fn text(&self) -> (u64, u64, Places) {
        (self.number, self.time.expect("it has one").to_bits(), self.places.clone())
    }
}

/// A frame of GSD.
pub struct GsdFrame {
    number: u64,
    time: f64,
    dimensions: u8,
    sides: [f32; 3],
    /// Lengths of the box, in double precision.
    pub exact_sides: [f64; 2],
    /// The centre of the box.
    centre: [f64; 3],
    ids: Vec<u32>,
    /// Positions as in the schema, relative to the centre of the box.
    single: Vec<[f32; 3]>,
    double: Vec<[f64; 3]>,
    /// Periods moved, if they are tracked.
    images: Option<Vec<[i32; 3]>>,
    /// Logged quantities of the frame itself.
    pub logged: BTreeMap<String, f64>,
}

impl GsdFrame {
    /// Number, bits of the time, and positions, as of a [`TextFrame`].
    pub fn text(&self) -> (u64, u64, Places) {
        (
            self.number,
            self.time.to_bits(),
            self.ids.iter().copied().zip(self.double.iter().copied()).collect(),
        )
    }

    /// The mean square displacement since another frame, computed from images as other programs do.
    pub fn displacement_since(&self, start: &GsdFrame) -> Option<f64> {
        let images = self.images.as_ref().filter(|_| self.ids == start.ids)?;
        let square_displacement = |(number, image): (usize, &[i32; 3])| -> f64 {
            let along = |axis: usize| {
                let moved = self.double[number][axis] - start.double[number][axis];
                moved + f64::from(image[axis]) * self.exact_sides[axis]
            };
            along(0).powi(2) + along(1).powi(2)
        };
        Some(images.iter().enumerate().map(square_displacement).sum::<f64>() / images.len() as f64)
    }

    /// Checks that positions in single precision equal those in double precision and are inside the box.
    pub fn single_is_as_double(&self, label: &str) {
        assert!(
            self.sides[2] == 0.0 && self.dimensions == 2 || self.sides[2] > 0.0 && self.dimensions == 3,
            "{label}"
        );
        assert_eq!(self.single.len(), self.double.len(), "{label}");
        for (single, double) in self.single.iter().zip(&self.double) {
            for axis in 0..3 {
                let from_centre = (double[axis] - self.centre[axis]) as f32;
                assert_eq!(single[axis].to_bits(), from_centre.to_bits(), "{label}");
                assert!(
                    single[axis].abs() <= 0.5 * self.sides[axis],
                    "{label}: {single:?} is out of the box"
                );
            }
        }
    }
}

/// Frames of a GSD file, read by the description of the format.
pub fn gsd(path: &Path) -> Vec<GsdFrame> {
    let bytes = fs::read(path).expect("it is there");
    let wide = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes")) as usize;
    assert_eq!(bytes[..8], [0xdf, 0x65].repeat(4), "it is GSD");
    let (index, capacity, names, blocks) = (wide(8), wide(16), wide(24), wide(32));
    let names = std::str::from_utf8(&bytes[names..names + 64 * blocks]).expect("text");
    let names: Vec<&str> = names.split('\0').take_while(|name| !name.is_empty()).collect();
    // By frame and name: the type, the columns and the bytes.
    let mut chunks: BTreeMap<(usize, &str), (u8, usize, &[u8])> = BTreeMap::new();
    let mut count = 0;
    for entry in (0..capacity).map(|entry| index + 32 * entry).take_while(|entry| wide(entry + 16) != 0) {
        let (frame, rows, at) = (wide(entry), wide(entry + 8), wide(entry + 16));
        let columns =
            u32::from_le_bytes(bytes[entry + 24..entry + 28].try_into().expect("four bytes")) as usize;
        let name = names[usize::from(u16::from_le_bytes([bytes[entry + 28], bytes[entry + 29]]))];
        let (code, flags) = (bytes[entry + 30], bytes[entry + 31]);
        let size = [0, 1, 2, 4, 8, 1, 2, 4, 8, 4, 8][usize::from(code)];
        assert!(flags == 0 && (frame == count || frame + 1 == count), "entries are in order");
        chunks.insert((frame, name), (code, columns, &bytes[at..at + rows * columns * size]));
        count = frame + 1;
    }
    let find =
        |frame: usize, name: &'static str| chunks.get(&(frame, name)).or_else(|| chunks.get(&(0, name)));
    let singles = |frame: usize, name: &'static str| -> Vec<f32> {
        let (code, _, bytes) = *find(frame, name).expect(name);
        assert_eq!(code, 9, "{name} is in single precision");
        bytes.chunks(4).map(|it| f32::from_le_bytes(it.try_into().expect("four bytes"))).collect()
    };
    let doubles = |(code, columns, bytes): (u8, usize, &[u8])| -> (usize, Vec<f64>) {
        assert_eq!(code, 10, "in double precision");
        (columns, bytes.chunks(8).map(|it| f64::from_le_bytes(it.try_into().expect("eight bytes"))).collect())
    };
    let frame = |frame: usize| {
        let bytes = |name| find(frame, name).expect(name).2;
        let (columns, double) = doubles(*find(frame, "log/particles/position").expect("positions"));
        let exact = |name| doubles(*find(frame, name).expect(name)).1;
        let (corner, sides) = (exact("log/box/corner"), exact("log/box/sides"));
        // Without a box positions are relative to the origin.
        let centre =
            |axis: usize| if sides[axis].is_finite() { corner[axis] + 0.5 * sides[axis] } else { 0.0 };
        let own = chunks.range((frame, "log/")..(frame, "log0")).filter(|(_, (code, ..))| *code == 10);
        let value = |(&(_, name), &chunk): (&(usize, &str), &(u8, usize, &[u8]))| {
            let values = doubles(chunk).1;
            (values.len() == 1).then(|| (name["log/".len()..].to_owned(), values[0]))
        };
        GsdFrame {
            number: u64::from_le_bytes(bytes("configuration/step").try_into().expect("eight bytes")),
            time: doubles(*find(frame, "log/time").expect("a time")).1[0],
            dimensions: bytes("configuration/dimensions")[0],
            sides: singles(frame, "configuration/box")[..3].try_into().expect("three"),
            exact_sides: [sides[0], sides[1]],
            images: chunks.get(&(frame, "particles/image")).map(|&(code, columns, bytes)| {
                assert_eq!((code, columns), (7, 3));
                let numbers =
                    bytes.chunks(4).map(|it| i32::from_le_bytes(it.try_into().expect("four bytes")));
                numbers.collect::<Vec<i32>>().chunks(3).map(|it| [it[0], it[1], it[2]]).collect()
            }),
            centre: [centre(0), centre(1), 0.0],
            ids: bytes("log/particles/id")
                .chunks(4)
                .map(|it| u32::from_le_bytes(it.try_into().expect("four")))
                .collect(),
            single: singles(frame, "particles/position").chunks(3).map(|it| [it[0], it[1], it[2]]).collect(),
            double: double
                .chunks(columns)
                .map(|it| [it[0], it[1], it.get(2).copied().unwrap_or(0.0)])
                .collect(),
            logged: own.filter_map(value).collect(),
        }
    };
    (0..count).map(frame).collect()
}

fn number<T: std::str::FromStr>(text: &str) -> T
where
    T::Err: std::fmt::Debug,
{
    text.parse().unwrap_or_else(|error| panic!("`{text}` is not a number: {error:?}"))
}

/// Columns and rows of a table.
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
