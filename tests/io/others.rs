//! Two discs as different programs write them: every unambiguous spelling is read.

use stripmine_physics::io::extxyz::{ParticleFrame, XyzFrames};
use stripmine_physics::particles::{Particle, Particles};

const LATTICE: &str = r#"Lattice="20.0 0.0 0.0 0.0 20.0 0.0 0.0 0.0 1.0" pbc="T T F""#;
const OURS: &str = "Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";

/// Program, comment line and rows of the same two discs.
const CASES: [(&str, &str, &str); 12] = [
    (
        "as this program writes it",
        "LATTICE OURS",
        "Si 1.5 2 0 1 -0.25 1 0 0.5 2 0 0 0\nSi 5 2 0 2 3 0 0 0.5 2 0 0 0",
    ),
    (
        "planar programs",
        "LATTICE Properties=id:I:1:pos:R:2:velo:R:2:radius:R:1:mass:R:1:omega:R:1",
        "1 1.5 2 -0.25 1 0.5 2 0\n2 5 2 3 0 0.5 2 0",
    ),
    (
        "ASE: momenta and masses, no ids",
        "LATTICE Properties=species:S:1:pos:R:3:momenta:R:3:masses:R:1:radius:R:1",
        "Ar 1.5 2.0 0.0 -0.5 2.0 0.0 2.0 0.5\nAr 5.0 2.0 0.0 6.0 0.0 0.0 2.0 0.5",
    ),
    (
        "columns of both",
        "LATTICE OURS:masses:R:1:momenta:R:3",
        "Si 1.5 2 0 1 -0.25 1 0 0.5 2 0 0 0 2 inf 0 0\nSi 5 2 0 2 3 0 0 0.5 2 0 0 0 2 0 0 0",
    ),
    (
        "no spin, another column",
        "LATTICE Properties=id:I:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1:state:I:1 Time=0.000000",
        "1 1.5 2 0.0 -0.25 1 0.0 0.5 2 0\n2 5 2 0.0 3 0 0.0 0.5 2 1",
    ),
    ("any species", "LATTICE OURS", "Ar 1.5 2 0 1 -0.25 1 0 0.5 2 0 0 0\nC60 5 2 0 2 3 0 0 0.5 2 0 0 0"),
    (
        "angles of 90 degrees",
        "Lattice=\"20.0 0.0 0.0 1.2246467991473532e-15 20.0 0.0 -1.2e-15 0.0 1.0\" pbc=\"T T F\" OURS",
        "Si 1.5 2 0 1 -0.25 1 0 0.5 2 0 0 0\nSi 5 2 0 2 3 0 0 0.5 2 0 0 0",
    ),
    ("byte-order mark", "LATTICE OURS", "Si 1.5 2 0 1 -0.25 1 0 0.5 2 0 0 0\nSi 5 2 0 2 3 0 0 0.5 2 0 0 0"),
    ("ids from 0", "LATTICE OURS", "Si 1.5 2 0 0 -0.25 1 0 0.5 2 0 0 0\nSi 5 2 0 1 3 0 0 0.5 2 0 0 0"),
    (
        "two axes",
        "Lattice=\"20 0 0 0 20 0 0 0 1\" pbc=\"T T\" OURS",
        "Si 1.5 2 0 1 -0.25 1 0 0.5 2 0 0 0\nSi 5 2 0 2 3 0 0 0.5 2 0 0 0",
    ),
    (
        "Fortran",
        "Lattice=\"0.2D+02 0 0 0 2d1 0 0 0 1\" pbc=\"T T F\" OURS",
        "Si 1.5D+00 2 0 1 -0.25D+00 1.0D0 0 5d-1 2 0 0 0\nSi 0.5D01 2 0 2 3 0 0 0.5D+00 2 0 0 0",
    ),
    (
        "line ends of Windows",
        "LATTICE OURS\r",
        "Si 1.5 2 0 1 -0.25 1 0 0.5 2 0 0 0\r\nSi 5 2 0 2 3 0 0 0.5 2 0 0 0\r",
    ),
];

fn read(program: &str, comment: &str, rows: &str) -> ParticleFrame {
    let mark = if program == "byte-order mark" { "\u{feff}" } else { "" };
    let comment = comment.replace("LATTICE", LATTICE).replace("OURS", OURS);
    let text = format!("{mark}2\n{comment}\n{rows}\n");
    let mut frames = XyzFrames::new(text.as_bytes(), program);
    let frame = frames.next().unwrap().unwrap_or_else(|error| panic!("{program}: {error}"));
    assert!(frames.next().is_none());
    frame
}

#[test]
fn frames_of_other_programs_are_read() {
    let (first, comment, rows) = CASES[0];
    let ours = read(first, comment, rows);
    let [one, other] = ours.particles.all() else { panic!("two discs") };
    assert_eq!((one.id, one.position, one.velocity), (1, [1.5, 2.0, 0.0], [-0.25, 1.0, 0.0]));
    assert_eq!((other.id, other.radius, other.mass, other.omega), (2, 0.5, 2.0, 0.0));
    assert_eq!((ours.cell, ours.periodic), ([20.0; 2], Some([true; 2])));
    for (program, comment, rows) in CASES {
        let frame = read(program, comment, rows);
        assert_eq!(frame.has_raised_ids, program == "ids from 0", "{program}");
        // Names of other species are numbered as they appear; all else is alike.
        let species: Vec<u8> = frame.particles.all().iter().map(|it| it.species).collect();
        assert_eq!(species, if program == "any species" { [0, 1] } else { [0, 0] }, "{program}");
        let all = frame.particles.all().iter().map(|it| Particle { species: 0, ..*it }).collect();
        let frame = ParticleFrame { has_raised_ids: false, particles: Particles::new(all), ..frame };
        assert_eq!(frame, ours, "{program}");
    }
}
