//! Valid extended XYZ.

use crate::{Random, frame, text};
use std::fs;
use stripmine_physics::io::extxyz::{FrameChoice, ParticleFrame, XyzFrames, XyzReadError, read};
use stripmine_physics::particles::{Particle, ParticleKind, Particles};

fn frames(text: &str) -> Result<Vec<ParticleFrame>, XyzReadError> {
    XyzFrames::new(text.as_bytes(), "text").collect()
}

fn bits(frame: &ParticleFrame) -> Vec<u64> {
    let ParticleFrame { particles, cell, origin, periodic, time, step, seed, .. } = frame;
    let disc = |disc: &Particle| {
        let Particle {
            id,
            kind,
            species,
            position: [x, y, z],
            velocity: [u, v, w],
            angle,
            omega,
            radius,
            mass,
        } = *disc;
        let numbers = [x, y, z, u, v, w, angle, omega, radius, mass].map(f64::to_bits);
        [vec![u64::from(id), u64::from(kind == ParticleKind::Wall), u64::from(species)], numbers.to_vec()]
            .concat()
    };
    let numbers = [cell[0], cell[1], origin[0], origin[1], *time].map(f64::to_bits);
    let words = [*step, seed.unwrap_or(0), u64::from(seed.is_some())];
    let mut all =
        [numbers.to_vec(), words.to_vec(), periodic.map_or([2, 2], |axes| axes.map(u64::from)).to_vec()]
            .concat();
    all.extend(particles.all().iter().flat_map(disc));
    all
}

/// The format as documented in the help of the command.
#[test]
fn frame_is_written_as_documented() {
    let expected = "2
Lattice=\"3.3333333333333335 0.0 0.0 0.0 8.0 0.0 0.0 0.0 1.0\" Origin=\"-1.5 0.1 -0.5\" pbc=\"T F F\" \
Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3:masses:R:1:momenta:R:3 Time=0.4 step=4 seed=18446744073709551615
Si 0.30000000000000004 -0.0 0.0 7 5e-324 -1.7976931348623157e+308 0.0 0.5 1e-7 0.0 0.0 -0.3333333333333333 1e-7 0.0 -1.7976931348623156e+301 0.0
W 1e+300 2.0 0.0 4294967295 5e-324 -1.7976931348623157e+308 0.0 0.5 1e+16 0.0 0.0 -0.3333333333333333 1e+16 4.940656458412465e-308 -inf 0.0
";
    assert_eq!(text(&frame(4)), expected);
}

/// Each program finds its columns by name: `pos` second for MDAnalysis, `velo` and `mass` for OVITO, `masses` and `momenta`, their
/// product, for ASE. Files from before the latter two existed are still read.
#[test]
fn every_program_finds_its_columns() {
    let written = text(&frame(3));
    let head = written.lines().nth(1).unwrap();
    let properties = head.split("Properties=").nth(1).unwrap().split(' ').next().unwrap();
    let parts: Vec<&str> = properties.split(':').collect();
    let names: Vec<&str> = parts.chunks(3).map(|column| column[0]).collect();
    assert_eq!(names, ["species", "pos", "id", "velo", "radius", "mass", "omega", "masses", "momenta"]);
    let fields: usize = parts.chunks(3).map(|column| column[2].parse::<usize>().unwrap()).sum();
    for row in written.lines().skip(2) {
        let row: Vec<&str> = row.split(' ').collect();
        assert_eq!(row.len(), fields);
        let number = |at: usize| row[at].parse::<f64>().unwrap();
        assert_eq!(row[9], row[13], "masses are the mass");
        (0..3).for_each(|axis| assert_eq!(number(14 + axis), number(9) * number(5 + axis)));
    }
    let cut = |row: &str| row.split(' ').take(13).collect::<Vec<_>>().join(" ");
    let before: Vec<String> = written
        .lines()
        .enumerate()
        .map(|(at, line)| match at {
            0 => line.to_owned(),
            1 => line.replace(":masses:R:1:momenta:R:3", ""),
            _ => cut(line),
        })
        .collect();
    assert_eq!(frames(&before.join("\n")).unwrap(), frames(&written).unwrap());
}

#[test]
fn every_bit_of_a_frame_is_read_back() {
    let mut random = Random(1);
    let mut any = || loop {
        let number = f64::from_bits(((random.below(1 << 32) as u64) << 32) | random.below(1 << 32) as u64);
        if number.is_finite() {
            return number;
        }
    };
    let mut written = frame(3);
    let discs = (1..=2000).map(|id| Particle {
        id,
        kind: if id > 1900 { ParticleKind::Wall } else { ParticleKind::Grain },
        species: 0,
        position: [any(), any(), 0.0],
        velocity: [any(), any(), 0.0],
        angle: 0.0,
        omega: any(),
        radius: any().abs().max(f64::MIN_POSITIVE),
        mass: any().abs().max(5e-324),
    });
    written.particles = Particles::new(discs.collect());
    written.seed = None;
    for frame in [written, frame(0)] {
        assert_eq!(bits(&frames(&text(&frame)).unwrap()[0]), bits(&frame));
    }
}

#[test]
fn first_last_or_all_frames_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trajectory.xyz");
    let all: Vec<ParticleFrame> = (0..3).map(frame).collect();
    fs::write(&path, all.iter().map(text).collect::<String>() + "\n \n").unwrap();
    assert_eq!(read(&path, FrameChoice::First).unwrap(), all[0]);
    assert_eq!(read(&path, FrameChoice::Last).unwrap(), all[2]);
    assert_eq!(XyzFrames::open(&path).unwrap().collect::<Result<Vec<_>, _>>().unwrap(), all);
}

/// Columns in any order, unknown columns, unknown keys, other line ends.
#[test]
fn columns_are_read_in_any_order() {
    let ours = "1\nProperties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3 \
                Lattice=\"4 0 0 0 5 0 0 0 1\" Time=2\nW 1 2 0 9 3 4 0 0.5 6 0 0 7";
    let other = "\r\n1\r\nfrozen config_type = \"a \\\"b\\\" c\" Time=2 stress={{1 0} {0 1}} \
                 Lattice=[[4,0,0],[0,5,0],[0,0,1]] virial=[[1, 2], [3, 4]] \
                 Properties=omega:R:3:mass:R:1:move:L:2:id:I:1:forces:R:3:radius:R:1:velo:R:3:species:S:1:pos:R:3 \
                 \r\n0 0 7 6 T F 9 .1 .2 .3 5e-1 3 4 0 W 1 2 0  \r\n\r\n";
    assert_eq!(frames(other).unwrap(), frames(ours).unwrap());
    let frame = &frames(ours).unwrap()[0];
    assert_eq!((frame.cell, frame.origin, frame.time, frame.step), ([4.0, 5.0], [0.0; 2], 2.0, 0));
    assert_eq!((frame.seed, frame.particles.all()[0].kind), (None, ParticleKind::Wall));
}

#[test]
fn all_spellings_of_boundaries_are_read() {
    let spellings = [
        ("", None),
        ("pbc=\"F T F\"", Some([false, true])),
        ("PBC='f t f'", Some([false, true])),
        ("pbc=[False, True, False]", Some([false, true])),
        ("pbc=\"FALSE TRUE FALSE\"", Some([false, true])),
        ("pbc=\"1 0 0\"", Some([true, false])),
        ("\"pbc\"={true false true}", Some([true, false])),
    ];
    for (pbc, expected) in spellings {
        let text = text(&frame(0)).replace("pbc=\"T F F\"", pbc);
        assert_eq!(frames(&text).unwrap()[0].periodic, expected, "{pbc}");
    }
}

/// A file without species, as the documentation of start files allows.
#[test]
fn particles_without_species_are_grains() {
    let text = text(&frame(0)).replace("species:S:1:", "").replace("\nSi ", "\n").replace("\nW ", "\n");
    assert_eq!(frames(&text).unwrap()[0].particles.grain_count(), 2);
}

#[test]
fn grains_are_sorted_before_wall_discs() {
    let text = text(&frame(0));
    let lines: Vec<&str> = text.lines().collect();
    let swapped = [lines[0], lines[1], lines[3], lines[2]].join("\n");
    assert_eq!(frames(&swapped).unwrap()[0], frame(0));
}

/// Any bytes give an error with a location, or frames with valid numbers.
#[test]
fn no_bytes_make_the_reader_panic() {
    let whole = [text(&frame(1)), text(&frame(2))].concat().into_bytes();
    let words: [&[u8]; 16] = [
        b"\n",
        b" ",
        b"\"",
        b"[",
        b"}",
        b"\\",
        b"=",
        b":",
        b"-",
        b"nan",
        b"1e999",
        b"0",
        b"\xff",
        b"\xc3\xa9",
        b"18446744073709551616",
        b"Properties=",
    ];
    let mut random = Random(2);
    let mut read = 0;
    for _ in 0..30_000 {
        let mut bytes = whole.clone();
        for _ in 0..=random.below(3) {
            let from = random.below(bytes.len().max(1));
            match random.below(5) {
                0 => bytes.truncate(from),
                1 if !bytes.is_empty() => bytes[from] ^= 1 << random.below(8),
                2 => drop(bytes.drain(from..(from + random.below(20)).min(bytes.len()).max(from))),
                _ => drop(bytes.splice(from..from, words[random.below(words.len())].iter().copied())),
            }
        }
        for frame in XyzFrames::new(bytes.as_slice(), "text") {
            match frame {
                Err(error) => assert!(error.to_string().starts_with("text:"), "{error}"),
                Ok(frame) => {
                    read += 1;
                    for disc in frame.particles.all() {
                        assert!(disc.id > 0 && disc.radius > 0.0 && disc.mass > 0.0);
                        assert!(disc.position.iter().chain(&disc.velocity).all(|number| number.is_finite()));
                    }
                }
            }
        }
    }
    assert!(read > 1000);
}

/// Bodies in space have no box, and a depth; they are read back to the bit on request, and rejected otherwise.
#[test]
fn bodies_without_a_box_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("space.xyz");
    let text = "1\npbc=\"F F F\" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3 Time=0.5 step=9\n\
                Si 0.5 0.25 -3.0 1 0.0 -0.1 7.0 0.5 1.0 0.0 0.0 0.0\n";
    std::fs::write(&path, text).unwrap();
    let frame = XyzFrames::open(&path).unwrap().in_space().next().unwrap().unwrap();
    assert_eq!(frame.cell, [f64::INFINITY; 2]);
    let body = frame.particles.all()[0];
    assert_eq!((body.position, body.velocity), ([0.5, 0.25, -3.0], [0.0, -0.1, 7.0]));
    assert!(read(&path, FrameChoice::Last).unwrap_err().to_string().contains("Lattice"));
}
