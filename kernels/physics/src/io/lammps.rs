//! LAMMPS files for its users and their tools: a data file (`atom_style sphere`) and a text dump.
//!
//! Grains are of type 1, wall discs of type 2, grains of further species of the next types. The box extends from −1/2 to 1/2 in z.

use super::extxyz::{DEPTH, ParticleFrame};
use super::growing_file::GrowingFile;
use super::open_sinks::SinkKind;
use super::output_format::{FrameWriting, OutputFormat};
use super::run_moment::RunMoment;
use super::sink::{TextFormat, TextSink};
use super::species::type_of;
use super::trajectory::FrameReading;
use std::f64::consts::PI;
use std::io::{self, Write};
use std::sync::Arc;

/// Format of a dump.
pub(crate) const DUMP: OutputFormat = OutputFormat {
    key: "lammps_dump",
    doc: "Snapshots as a LAMMPS dump.",
    is_default: false,
    needs_box: true,
    file: "dump.lammpstrj",
    writing: FrameWriting::Growing(SinkKind::of::<TextSink<LammpsSnapshots>>()),
    reading: FrameReading::Never,
};

/// Format of a data file.
pub(crate) const DATA: OutputFormat = OutputFormat {
    key: "lammps_data",
    doc: "Final state as a LAMMPS data file.",
    is_default: false,
    needs_box: true,
    file: "final.data",
    writing: FrameWriting::Last(|frame, out| write_data(frame, out)),
    reading: FrameReading::Never,
};

/// First words of a data file of this program.
pub(super) const DATA_HEADING: &str = "LAMMPS data file by stripmine";
/// Columns of a dump of this program.
pub(super) const DUMP_COLUMNS: &str = "id type x y z vx vy vz omegaz radius mass";

/// Mass of a ball of a density and radius, as LAMMPS computes it in two dimensions too.
pub(super) fn mass_of_sphere(density: f64, radius: f64) -> f64 {
    density * VOLUME * (radius * radius * radius)
}

/// Volume of a ball of radius 1.
const VOLUME: f64 = 4.0 / 3.0 * PI;

struct LammpsSnapshots;

impl TextFormat for LammpsSnapshots {
    type Entry = Arc<ParticleFrame>;

    fn entry(moment: &RunMoment<'_>) -> Option<Arc<ParticleFrame>> {
        Some(moment.frame().clone())
    }

    fn write(frame: Arc<ParticleFrame>, out: &mut GrowingFile) -> io::Result<()> {
        write_dump(&frame, out)
    }
}

/// Lower and upper bounds of the box along x, y and z (length).
fn bounds(frame: &ParticleFrame) -> [[f64; 2]; 3] {
    let [x, y] = [0, 1].map(|axis| [frame.origin[axis], frame.origin[axis] + frame.cell[axis]]);
    [x, y, DEPTH]
}

/// Writes a data file for `read_data`: `Atoms # sphere` with id, type, diameter, density and position, then
/// `Velocities` with velocity and angular velocity.
///
/// The density is that of a ball, m / (4/3 π r³), because LAMMPS computes the mass of a sphere from it in two dimensions too.
///
/// # Errors
/// Errors of the writer.
pub fn write_data(frame: &ParticleFrame, out: &mut impl Write) -> io::Result<()> {
    let discs = frame.particles.all();
    writeln!(out, "{DATA_HEADING}, atom_style sphere, timestep = {}\n", frame.step)?;
    let types = discs.iter().map(|disc| type_of(disc) + 1).max().unwrap_or(0).max(2);
    writeln!(out, "{} atoms\n{types} atom types\n", discs.len())?;
    for (axis, [low, high]) in ['x', 'y', 'z'].into_iter().zip(bounds(frame)) {
        writeln!(out, "{low:?} {high:?} {axis}lo {axis}hi")?;
    }
    if discs.is_empty() {
        return Ok(());
    }
    writeln!(out, "\nAtoms # sphere\n")?;
    for disc in discs {
        let density = disc.mass / (VOLUME * (disc.radius * disc.radius * disc.radius));
        let ([x, y, z], diameter) = (disc.position, 2.0 * disc.radius);
        writeln!(out, "{} {} {diameter:?} {density:?} {x:?} {y:?} {z:?}", disc.id, type_of(disc) + 1)?;
    }
    writeln!(out, "\nVelocities\n")?;
    for disc in discs {
        let [u, v, w] = disc.velocity;
        writeln!(out, "{} {u:?} {v:?} {w:?} 0.0 0.0 {:?}", disc.id, disc.omega)?;
    }
    Ok(())
}

/// Writes a frame of a text dump with id, type, position, velocity, angular velocity, radius and mass. Consecutive frames form a trajectory.
///
/// # Errors
/// Errors of the writer.
pub fn write_dump(frame: &ParticleFrame, out: &mut impl Write) -> io::Result<()> {
    let flag = |periodic| if periodic { "pp" } else { "ff" };
    let [x, y] = frame.periodic.unwrap_or([true; 2]).map(flag);
    writeln!(out, "ITEM: TIMESTEP\n{}", frame.step)?;
    writeln!(out, "ITEM: NUMBER OF ATOMS\n{}", frame.particles.len())?;
    writeln!(out, "ITEM: BOX BOUNDS {x} {y} ff")?;
    for [low, high] in bounds(frame) {
        writeln!(out, "{low:?} {high:?}")?;
    }
    writeln!(out, "ITEM: ATOMS {DUMP_COLUMNS}")?;
    for disc in frame.particles.all() {
        let ([x, y, z], [u, v, w]) = (disc.position, disc.velocity);
        write!(out, "{} {} {x:?} {y:?} {z:?} {u:?} {v:?} {w:?} ", disc.id, type_of(disc) + 1)?;
        writeln!(out, "{:?} {:?} {:?}", disc.omega, disc.radius, disc.mass)?;
    }
    Ok(())
}
