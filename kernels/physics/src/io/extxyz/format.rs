//! Formats of other programs, recognised by their first bytes.

use std::fmt;

/// Format that this program does not read as frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForeignFormat {
    /// Trajectory of HOOMD-blue or of this program.
    Gsd,
    /// Positions of CHARMM, NAMD or LAMMPS.
    Dcd,
    /// A file for `read_data`.
    LammpsData,
    /// A dump.
    LammpsDump,
    /// XYZ without `key=value` in its second line.
    PlainXyz,
    /// Spheres of programs for hard particles.
    Sph,
    /// Compressed.
    Gzip,
    /// A container of arrays.
    Hdf5,
    /// A container of arrays.
    NetCdf,
    /// Text with two bytes for each character.
    Utf16,
}

impl fmt::Display for ForeignFormat {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            ForeignFormat::Gsd => "a GSD file",
            ForeignFormat::Dcd => "a DCD file",
            ForeignFormat::LammpsData => "a LAMMPS data file",
            ForeignFormat::LammpsDump => "a LAMMPS dump",
            ForeignFormat::PlainXyz => "plain XYZ, without `key=value` in its second line",
            ForeignFormat::Sph => ".sph, a file of spheres",
            ForeignFormat::Gzip => "compressed (gzip)",
            ForeignFormat::Hdf5 => "an HDF5 file",
            ForeignFormat::NetCdf => "a NetCDF file",
            ForeignFormat::Utf16 => "text in UTF-16",
        })
    }
}

/// Signatures: offset and bytes.
const SIGNATURES: [(usize, &[u8], ForeignFormat); 8] = [
    (0, b"\xdf\x65\xdf\x65\xdf\x65\xdf\x65", ForeignFormat::Gsd),
    (4, b"CORD", ForeignFormat::Dcd),
    (0, b"\x1f\x8b", ForeignFormat::Gzip),
    (0, b"\x89HDF\r\n\x1a\n", ForeignFormat::Hdf5),
    (0, b"CDF", ForeignFormat::NetCdf),
    (0, b"\xff\xfe", ForeignFormat::Utf16),
    (0, b"\xfe\xff", ForeignFormat::Utf16),
    (0, b"ITEM:", ForeignFormat::LammpsDump),
];

impl ForeignFormat {
    /// Format of a file that starts with these bytes; none if it may be XYZ.
    pub(crate) fn of(first: &[u8]) -> Option<ForeignFormat> {
        let begins = |&&(at, bytes, _): &&(usize, &[u8], ForeignFormat)| {
            first.get(at..).is_some_and(|rest| rest.starts_with(bytes))
        };
        if let Some(&(_, _, format)) = SIGNATURES.iter().find(begins) {
            return Some(format);
        }
        // LAMMPS ignores the first line; after it, counts and the box come in any order.
        let mut lines = first.split(|&byte| byte == b'\n').skip(1).take(40);
        let words = |line: &[u8]| {
            String::from_utf8_lossy(line).split_ascii_whitespace().map(str::to_owned).collect::<Vec<_>>()
        };
        let is_data = |line: &[u8]| match words(line).as_slice() {
            [count, what] => what == "atoms" && count.parse::<u64>().is_ok(),
            _ => false,
        };
        lines.any(is_data).then_some(ForeignFormat::LammpsData)
    }

    /// Format of a file whose second line, after a number of discs, is this one; none if it is extended XYZ.
    pub(super) fn of_comment(comment: &str) -> Option<ForeignFormat> {
        if comment.contains('=') {
            return None;
        }
        let sides: Option<Vec<f64>> =
            comment.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        Some(if sides.is_some_and(|sides| sides.len() == 3) {
            ForeignFormat::Sph
        } else {
            ForeignFormat::PlainXyz
        })
    }
}
