//! LAMMPS files, compared word for word.

use crate::frame;
use stripmine_physics::io::lammps::{write_data, write_dump};

#[test]
fn a_dump_is_written_word_for_word() {
    let mut out = Vec::new();
    write_dump(&frame(4), &mut out).unwrap();
    let expected = "ITEM: TIMESTEP
4
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp ff ff
-1.5 1.8333333333333335
0.1 8.1
-0.5 0.5
ITEM: ATOMS id type x y z vx vy vz omegaz radius mass
7 1 0.30000000000000004 -0.0 0.0 5e-324 -1.7976931348623157e308 0.0 -0.3333333333333333 0.5 1e-7
4294967295 2 1e300 2.0 0.0 5e-324 -1.7976931348623157e308 0.0 -0.3333333333333333 0.5 1e16
";
    assert_eq!(String::from_utf8(out).unwrap(), expected);
}

/// LAMMPS computes the mass from density and diameter; it is the original one.
#[test]
fn a_data_file_is_written_word_for_word() {
    let mut out = Vec::new();
    write_data(&frame(4), &mut out).unwrap();
    let expected = "LAMMPS data file by stripmine, atom_style sphere, timestep = 4

2 atoms
2 atom types

-1.5 1.8333333333333335 xlo xhi
0.1 8.1 ylo yhi
-0.5 0.5 zlo zhi

Atoms # sphere

7 1 1.0 1.9098593171027442e-7 0.30000000000000004 -0.0 0.0
4294967295 2 1.0 1.9098593171027444e16 1e300 2.0 0.0

Velocities

7 5e-324 -1.7976931348623157e308 0.0 0.0 0.0 -0.3333333333333333
4294967295 5e-324 -1.7976931348623157e308 0.0 0.0 0.0 -0.3333333333333333
";
    assert_eq!(String::from_utf8(out).unwrap(), expected);
    let (density, radius) = (1.9098593171027442e-7, 0.5 * 1.0);
    let mass = density * 4.0 / 3.0 * std::f64::consts::PI * (radius * radius * radius);
    assert!((mass / 1e-7 - 1.0).abs() < 1e-15);
}
