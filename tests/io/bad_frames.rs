//! Invalid extended XYZ: each text with the whole error, including its location.

use crate::{frame, text};
use std::fs;
use stripmine_physics::io::extxyz::{FrameChoice, XyzFrames, XyzReadError, read};

const LATTICE: &str = r#"Lattice="4 0 0 0 5 0 0 0 1""#;
const PROPERTIES: &str = "Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";
const ROW: &str = "Si 1 2 0 1 0 0 0 0.5 1 0 0 0";

/// Pairs of a text and its whole error; `LATTICE`, `PROPERTIES` and `ROW` stand for the constants above.
const CASES: &[(&str, &str)] = &[
    // No frames.
    ("", "bad.xyz:1: the file is empty; expected the number of discs"),
    ("\n \n", "bad.xyz:1: the file is empty; expected the number of discs"),
    ("Si 1 2 3\n", "bad.xyz:1: expected the number of discs, which begins a frame, found `Si 1 2 3`"),
    ("-1\n", "bad.xyz:1: expected the number of discs, which begins a frame, found `-1`"),
    ("1.5\n", "bad.xyz:1: expected the number of discs, which begins a frame, found `1.5`"),
    // Wrong counts.
    ("1\n", "bad.xyz:1: truncated: the file ends after 0 of the 1 discs that line 1 announces"),
    (
        "3\nLATTICE PROPERTIES\nROW\n",
        "bad.xyz:3: truncated: the file ends after 1 of the 3 discs that line 1 announces",
    ),
    (
        "1\nLATTICE PROPERTIES\nROW\n1\nLATTICE PROPERTIES\n",
        "bad.xyz:5: truncated: the file ends after 0 of the 1 discs that line 4 announces; the frame before is complete",
    ),
    (
        "18446744073709551615\nLATTICE PROPERTIES\nROW\n",
        "bad.xyz:1: a frame of 18446744073709551615 discs; expected at most 536870911, as searches number them with 29 bits",
    ),
    (
        "1\nLATTICE PROPERTIES\nROW\nROW\n",
        "bad.xyz:4: expected the number of discs, which begins a frame, found `ROW`; does line 1 announce too few?",
    ),
    // Comment lines.
    (
        "1\nPROPERTIES\nROW\n",
        "bad.xyz:2: the comment line has no `Lattice`; expected \"Lx 0 0 0 Ly 0 0 0 Lz\" with positive sides",
    ),
    (
        "1\nLATTICE\nROW\n",
        "bad.xyz:2: the comment line has no `Properties`; \
         expected species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3",
    ),
    (
        "1\nPROPERTIES Lattice=\"4 1 0 0 5 0 0 0 1\"\nROW\n",
        "bad.xyz:2:78: number 2 of Lattice is 1; boxes are rectangles, so expected 0",
    ),
    (
        "1\nLattice=\"4 0 0 0 -5 0 0 0 1\" PROPERTIES\nROW\n",
        "bad.xyz:2:1: Lattice is `4 0 0 0 -5 0 0 0 1`; expected \"Lx 0 0 0 Ly 0 0 0 Lz\" with positive sides",
    ),
    (
        "1\nLattice=\"4 0 0 0 inf 0 0 0 1\" PROPERTIES\nROW\n",
        "bad.xyz:2:1: Lattice is `4 0 0 0 inf 0 0 0 1`; expected \"Lx 0 0 0 Ly 0 0 0 Lz\" with positive sides",
    ),
    ("1\nLattice=\"4 0 0 0 5 0 0 0 1 PROPERTIES\nROW\n", "bad.xyz:2:9: `\"` is never closed"),
    ("1\nLATTICE PROPERTIES v=[1 [2]\nROW\n", "bad.xyz:2:108: `[` is never closed"),
    ("1\nLATTICE PROPERTIES lattice=3\nROW\n", "bad.xyz:2:106: `lattice` is given twice"),
    (
        "1\nLATTICE PROPERTIES Time=soon step=1.5 seed=-1\nROW\n",
        "bad.xyz:2:106: Time is `soon`; expected a finite number\n\
         bad.xyz:2:116: step is `1.5`; expected a whole number from 0\n\
         bad.xyz:2:125: seed is `-1`; expected a whole number from 0",
    ),
    (
        "1\npbc=\"T\" LATTICE Origin=\"0 0\" PROPERTIES\nROW\n",
        "bad.xyz:2:37: Origin is `0 0`; expected \"x y z\"\n\
         bad.xyz:2:1: pbc is `T`; expected \"T F F\" (or \"T F\"), T where the box is periodic along x, y, z",
    ),
    (
        "1\nLATTICE Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:mass:R:1:omega:R:3\nROW\n",
        "bad.xyz:2:29: Properties has no column `radius:R:1`ADD",
    ),
    (
        "1\nLATTICE Properties=species:S:1:pos:R:4:id:R:1\nROW\n",
        "bad.xyz:2:29: Properties has `pos:R:4`; expected `pos:R:3`\n\
         bad.xyz:2:29: Properties has `id:R:1`; expected `id:I:1`\n\
         bad.xyz:2:29: Properties has no column `velo:R:3` (or `velo:R:2`, or `momenta:R:3`, which is divided by the masses)ADD\n\
         bad.xyz:2:29: Properties has no column `radius:R:1`ADD\n\
         bad.xyz:2:29: Properties has no column `mass:R:1` (or `masses:R:1`)ADD",
    ),
    ("1\nLATTICE PROPERTIES:id:I:1\nROW 1\n", "bad.xyz:2:29: Properties names the column `id` twice"),
    (
        "1\nLATTICE PROPERTIES:charge:R\nROW\n",
        "bad.xyz:2:29: Properties has `charge:R`; expected `name:S, I, R or L:width`",
    ),
    (
        "1\nLATTICE PROPERTIES:a:R:18446744073709551615\nROW\n",
        "bad.xyz:2:29: Properties has `a:R:18446744073709551615`; expected `name:S, I, R or L:width`",
    ),
    // Rows.
    ("1\nLATTICE PROPERTIES\nROW 7\n", "bad.xyz:3: the row has 14 fields; Properties asks for 13"),
    ("1\nLATTICE PROPERTIES\n\n", "bad.xyz:3: the row has 0 fields; Properties asks for 13"),
    ("1\nLATTICE PROPERTIES\nSi 1 x 0 1 0 0 0 0.5 1 0 0 0\n", "bad.xyz:3:6: pos is `x`; expected a number"),
    (
        "1\nLATTICE PROPERTIES\nSi nan 2 0 1 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:4: pos is `nan`; expected a finite number",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 1 0 -Inf 0 0.5 1 0 0 0\n",
        "bad.xyz:3:14: velo is `-Inf`; expected a finite number",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 1 0 0 0 0.5 1e999 0 0 0\n",
        "bad.xyz:3:22: mass is `1e999`; expected a finite number",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 1 0 0 0 0 1 0 0 0\n",
        "bad.xyz:3:18: radius is 0; expected a number greater than 0",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 1 0 0 0 -0.5 1 0 0 0\n",
        "bad.xyz:3:18: radius is -0.5; expected a number greater than 0",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 1 0 0 0 0.5 -2 0 0 0\n",
        "bad.xyz:3:22: mass is -2; expected a number greater than 0",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0.1 1 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:8: component z of pos is 0.1; discs lie in the plane, so expected 0",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 1 0 0 0 0.5 1 3 0 0\n",
        "bad.xyz:3:24: component x of omega is 3; discs lie in the plane, so expected 0",
    ),
    (
        "536870912\nLATTICE PROPERTIES\nROW\n",
        "bad.xyz:1: a frame of 536870912 discs; expected at most 536870911, as searches number them with 29 bits",
    ),
    // Ids from 0 are raised by one.
    (
        "3\nLATTICE PROPERTIES\nROW\nSi 1 2 0 4294967295 0 0 0 0.5 1 0 0 0\nSi 1 2 0 0 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:4: id is 4294967295, and another is 0; ids that begin at 0 end at 4294967294",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 -4 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:10: id is `-4`; expected a whole number from 0 to 4294967295",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 4294967296 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:10: id is `4294967296`; expected a whole number from 0 to 4294967295",
    ),
    ("2\nLATTICE PROPERTIES\nROW\nROW\n", "bad.xyz:4: id 1 is taken by the disc in line 3"),
    (
        "2\nLATTICE PROPERTIES\nHé 1 2 0 1 0 0 0 0.5 1 0 0 0\nSi é 2 0 1 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:4:4: pos is `é`; expected a number",
    ),
    // Columns of other programs.
    (
        "1\nLATTICE Properties=pos:R:2:momenta:R:2:radius:R:1:masses:R:1\n1 2 1e300 0 1 1e-300\n",
        "bad.xyz:3:5: momenta is `1e300 over the mass 1e-300`; expected a finite number",
    ),
    (
        "1\nLATTICE Properties=pos:R:2:velo:R:2:radius:R:1:masses:R:1\n1 2 3 4 0.5 0\n",
        "bad.xyz:3:13: masses is 0; expected a number greater than 0",
    ),
    (
        "1\nLATTICE Properties=pos:R:3:momenta:R:3:radius:R:1:mass:R:1\n1 2 0 0 0 1.5D+00 0.5 1\n",
        "bad.xyz:3:11: component z of momenta is 1.5; discs lie in the plane, so expected 0",
    ),
    ("1\nLATTICE PROPERTIES\nSi D 2 0 1 0 0 0 0.5 1 0 0 0\n", "bad.xyz:3:4: pos is `D`; expected a number"),
    // Other formats.
    (
        "2\nAtoms. Timestep: 1000\n1 1 2 0\n1 3 4 0\n",
        "bad.xyz:2: this is plain XYZ, without `key=value` in its second line; FMT",
    ),
    ("2\n20.0 20.0 1.0\na 1 2 0 0.5\na 3 4 0 0.5\n", "bad.xyz:2: this is .sph, a file of spheres; FMT"),
    ("ITEM: TIMESTEP\n0\n", "bad.xyz: this is a LAMMPS dump; FMT"),
    ("LAMMPS data file\n\n16 atoms\n1 atom types\n", "bad.xyz: this is a LAMMPS data file; FMT"),
];

/// `ADD` and `FMT` stand for the ends of two messages.
const ADD: &str = "; add it to the file, for example in OVITO (Compute property, Export File, XYZ) or in ASE (atoms.set_array)";
const FMT: &str = "expected extended XYZ, with columns for positions, velocities, radii and masses: convert it, for example \
                   with OVITO (Export File, XYZ)";

fn write_out(text: &str) -> String {
    text.replace("LATTICE", LATTICE).replace("PROPERTIES", PROPERTIES).replace("ROW", ROW)
}

fn error_of(bytes: &[u8], which: FrameChoice) -> XyzReadError {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.xyz");
    fs::write(&path, bytes).unwrap();
    let mut error = read(&path, which).unwrap_err();
    assert_eq!(error.file, path.display().to_string());
    error.file = "bad.xyz".to_owned();
    error
}

#[test]
fn every_mistake_is_reported_with_its_location() {
    for (bad, expected) in CASES {
        let expected = expected.replace("ROW", ROW).replace("ADD", ADD).replace("FMT", FMT);
        let bad = write_out(bad);
        let error = error_of(bad.as_bytes(), FrameChoice::Last);
        assert_eq!(error.to_string(), expected, "\n{bad}");
        assert!(error.system().is_none());
    }
}

/// The first frame is valid, but the line after it does not begin a frame.
#[test]
fn too_small_counts_are_found_in_first_frames() {
    let error = error_of(write_out("1\nLATTICE PROPERTIES\nROW\nROW\n").as_bytes(), FrameChoice::First);
    assert!(error.to_string().contains("bad.xyz:4: expected the number of discs"), "{error}");
}

#[test]
fn invalid_utf8_is_refused_with_its_location() {
    let whole = text(&frame(0));
    for (line, column, word) in [(1, 1, "2\n"), (2, 1, "Lattice"), (3, 4, "0.30000000000000004"), (4, 1, "W")]
    {
        let at = whole.find(word).unwrap();
        let mut bytes = whole.clone().into_bytes();
        bytes[at] = 0xff;
        let error = error_of(&bytes, FrameChoice::Last);
        assert_eq!(error.to_string(), format!("bad.xyz:{line}:{column}: not UTF-8 text"));
    }
}

#[test]
fn only_the_first_mistakes_are_listed() {
    let rows = (1..=100).map(|id| format!("Si 1 2 0 {id} 0 0 0 -{id} 1 0 0 0\n")).collect::<String>();
    let error =
        error_of(write_out(&format!("100\nLATTICE PROPERTIES\n{rows}")).as_bytes(), FrameChoice::First);
    assert_eq!((error.mistakes.len(), error.more), (20, 80));
    let lines: Vec<usize> = error.mistakes.iter().filter_map(|mistake| mistake.line).collect();
    assert_eq!(lines, (3..23).collect::<Vec<_>>());
    assert!(error.to_string().ends_with("bad.xyz: 80 more mistakes"));
}

#[test]
fn invalid_frame_ends_the_sequence() {
    let text = [text(&frame(0)), text(&frame(1)).replace(" 0.5 ", " -0.5 "), text(&frame(2))].concat();
    let frames: Vec<_> = XyzFrames::new(text.as_bytes(), "text").collect();
    assert!(frames.len() == 2 && frames[0].is_ok());
    assert!(frames[1].as_ref().unwrap_err().to_string().starts_with("text:7:"));
}

#[test]
fn missing_file_is_a_system_error() {
    let error = read("/no/such/file.xyz", FrameChoice::Last).unwrap_err();
    assert_eq!(error.system().unwrap().kind(), std::io::ErrorKind::NotFound);
    assert!(error.to_string().starts_with("/no/such/file.xyz: cannot be read: "));
}

/// Binary formats are recognised by their first bytes.
#[test]
fn binary_formats_are_named() {
    for (bytes, name) in [
        (&b"\xdf\x65\xdf\x65\xdf\x65\xdf\x65\0\x01"[..], "a GSD file"),
        (b"\x54\0\0\0CORD\0\0", "a DCD file"),
        (b"\x1f\x8b\x08\0", "compressed (gzip)"),
        (b"\x89HDF\r\n\x1a\n\0", "an HDF5 file"),
        (b"CDF\x01\0\0", "a NetCDF file"),
        (b"\xff\xfe1\x000\0", "text in UTF-16"),
    ] {
        assert_eq!(error_of(bytes, FrameChoice::Last).to_string(), format!("bad.xyz: this is {name}; {FMT}"));
    }
}
