//! Extended XYZ that is wrong: each text carries the places and the words of its error.

use crate::{frame, text};
use std::fs;
use stripmine_physics::io::extxyz::{Frames, ReadError, Which, read};

const LATTICE: &str = r#"Lattice="4 0 0 0 5 0 0 0 1""#;
const PROPERTIES: &str = "Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";
const ROW: &str = "Si 1 2 0 1 0 0 0 0.5 1 0 0 0";

/// `LATTICE`, `PROPERTIES` and `ROW` stand for those above; the second is the whole error.
const CASES: &[(&str, &str)] = &[
    // No frames.
    ("", "bad.xyz:1: the file is empty; expected the number of discs"),
    ("\n \n", "bad.xyz:1: the file is empty; expected the number of discs"),
    ("Si 1 2 3\n", "bad.xyz:1: expected the number of discs, which begins a frame, found `Si 1 2 3`"),
    ("-1\n", "bad.xyz:1: expected the number of discs, which begins a frame, found `-1`"),
    ("1.5\n", "bad.xyz:1: expected the number of discs, which begins a frame, found `1.5`"),
    // Wrong counts.
    ("1\n", "bad.xyz:1: truncated: the file ends after 0 of the 1 discs that line 1 promises"),
    (
        "3\nLATTICE PROPERTIES\nROW\n",
        "bad.xyz:3: truncated: the file ends after 1 of the 3 discs that line 1 promises",
    ),
    (
        "1\nLATTICE PROPERTIES\nROW\n1\nLATTICE PROPERTIES\n",
        "bad.xyz:5: truncated: the file ends after 0 of the 1 discs that line 4 promises; the frame before is whole",
    ),
    (
        "18446744073709551615\nLATTICE PROPERTIES\nROW\n",
        "bad.xyz:3: truncated: the file ends after 1 of the 18446744073709551615 discs that line 1 promises",
    ),
    (
        "1\nLATTICE PROPERTIES\nROW\nROW\n",
        "bad.xyz:4: expected the number of discs, which begins a frame, found `ROW`; does line 1 promise too few?",
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
        "bad.xyz:2:78: Lattice is `4 1 0 0 5 0 0 0 1`; expected \"Lx 0 0 0 Ly 0 0 0 Lz\" with positive sides",
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
        "1\npbc=\"T F\" LATTICE Origin=\"0 0\" PROPERTIES\nROW\n",
        "bad.xyz:2:39: Origin is `0 0`; expected \"x y z\"\n\
         bad.xyz:2:1: pbc is `T F`; expected \"T F F\", T where the box repeats along x, y, z",
    ),
    (
        "1\nLATTICE Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:mass:R:1:omega:R:3\nROW\n",
        "bad.xyz:2:29: Properties has no column `radius:R:1`",
    ),
    (
        "1\nLATTICE Properties=species:S:1:pos:R:2:id:R:1\nROW\n",
        "bad.xyz:2:29: Properties has `pos:R:2`; expected `pos:R:3`\n\
         bad.xyz:2:29: Properties has `id:R:1`; expected `id:I:1`\n\
         bad.xyz:2:29: Properties has no column `velo:R:3`\n\
         bad.xyz:2:29: Properties has no column `radius:R:1`\n\
         bad.xyz:2:29: Properties has no column `mass:R:1`\n\
         bad.xyz:2:29: Properties has no column `omega:R:3`",
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
        "1\nLATTICE PROPERTIES\nSi 1 2 0 0 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:10: id is `0`; expected a whole number from 1 to 4294967295",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 -4 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:10: id is `-4`; expected a whole number from 1 to 4294967295",
    ),
    (
        "1\nLATTICE PROPERTIES\nSi 1 2 0 4294967296 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:10: id is `4294967296`; expected a whole number from 1 to 4294967295",
    ),
    ("2\nLATTICE PROPERTIES\nROW\nROW\n", "bad.xyz:4: id 1 is taken by the disc in line 3"),
    (
        "1\nLATTICE PROPERTIES\nHe 1 2 0 1 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:1: unknown species `He`; expected `Si` (a grain) or `W` (a wall disc)",
    ),
    (
        "2\nLATTICE PROPERTIES\nHé 1 2 0 1 0 0 0 0.5 1 0 0 0\nSi é 2 0 1 0 0 0 0.5 1 0 0 0\n",
        "bad.xyz:3:1: unknown species `Hé`; expected `Si` (a grain) or `W` (a wall disc)\n\
         bad.xyz:4:4: pos is `é`; expected a number",
    ),
];

fn write_out(text: &str) -> String {
    text.replace("LATTICE", LATTICE).replace("PROPERTIES", PROPERTIES).replace("ROW", ROW)
}

fn error_of(bytes: &[u8], which: Which) -> ReadError {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.xyz");
    fs::write(&path, bytes).unwrap();
    let mut error = read(&path, which).unwrap_err();
    assert_eq!(error.file, path.display().to_string());
    error.file = "bad.xyz".to_owned();
    error
}

#[test]
fn every_mistake_is_named_with_its_place() {
    for (bad, expected) in CASES {
        let (bad, expected) = (write_out(bad), expected.replace("ROW", ROW));
        let error = error_of(bad.as_bytes(), Which::Last);
        assert_eq!(error.to_string(), expected, "\n{bad}");
        assert!(error.system().is_none());
    }
}

/// The first frame is right, but the line after it begins none.
#[test]
fn a_count_that_is_too_small_is_seen_with_the_first_frame_too() {
    let error = error_of(write_out("1\nLATTICE PROPERTIES\nROW\nROW\n").as_bytes(), Which::First);
    assert!(error.to_string().contains("bad.xyz:4: expected the number of discs"), "{error}");
}

#[test]
fn bytes_that_are_no_text_are_refused_where_they_stand() {
    let whole = text(&frame(0));
    for (line, column, word) in [(1, 1, "2\n"), (2, 1, "Lattice"), (3, 4, "0.30000000000000004"), (4, 1, "W")]
    {
        let at = whole.find(word).unwrap();
        let mut bytes = whole.clone().into_bytes();
        bytes[at] = 0xff;
        let error = error_of(&bytes, Which::Last);
        assert_eq!(error.to_string(), format!("bad.xyz:{line}:{column}: not UTF-8 text"));
    }
}

#[test]
fn all_mistakes_are_found_but_only_the_first_are_listed() {
    let rows = (1..=100).map(|id| format!("Si 1 2 0 {id} 0 0 0 -{id} 1 0 0 0\n")).collect::<String>();
    let error = error_of(write_out(&format!("100\nLATTICE PROPERTIES\n{rows}")).as_bytes(), Which::First);
    assert_eq!((error.mistakes.len(), error.more), (20, 80));
    let lines: Vec<usize> = error.mistakes.iter().filter_map(|mistake| mistake.line).collect();
    assert_eq!(lines, (3..23).collect::<Vec<_>>());
    assert!(error.to_string().ends_with("bad.xyz: 80 more mistakes"));
}

#[test]
fn a_wrong_frame_ends_the_sequence() {
    let text = [text(&frame(0)), text(&frame(1)).replace("Si", "Xx"), text(&frame(2))].concat();
    let frames: Vec<_> = Frames::new(text.as_bytes(), "text").collect();
    assert!(frames.len() == 2 && frames[0].is_ok());
    assert!(frames[1].as_ref().unwrap_err().to_string().starts_with("text:7:1: unknown species `Xx`"));
}

#[test]
fn a_missing_file_is_a_matter_of_the_system() {
    let error = read("/no/such/file.xyz", Which::Last).unwrap_err();
    assert_eq!(error.system().unwrap().kind(), std::io::ErrorKind::NotFound);
    assert!(error.to_string().starts_with("/no/such/file.xyz: cannot be read: "));
}
