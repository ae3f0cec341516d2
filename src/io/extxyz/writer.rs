//! Writing a frame.

use super::{DEPTH, Frame, PROPERTIES};
use crate::particles::Kind;
use std::io::{self, Write};

/// Writes a frame, numbers in the shortest form that reads back to the same bits.
///
/// # Errors
/// Those of the writer.
pub fn write(frame: &Frame, out: &mut impl Write) -> io::Result<()> {
    let Frame { particles, cell: [lx, ly], origin: [x, y], periodic, time, step, seed } = frame;
    let [bottom, top] = DEPTH;
    writeln!(out, "{}", particles.len())?;
    // Space without end has no cell.
    let is_open = lx.is_infinite() || ly.is_infinite();
    if is_open {
        write!(out, "pbc=\"F F F\" ")?;
    } else {
        write!(out, "Lattice=\"{lx:?} 0.0 0.0 0.0 {ly:?} 0.0 0.0 0.0 {:?}\" ", top - bottom)?;
        write!(out, "Origin=\"{x:?} {y:?} {bottom:?}\" ")?;
    }
    if let Some([px, py]) =
        periodic.filter(|_| !is_open).map(|axes| axes.map(|yes| if yes { 'T' } else { 'F' }))
    {
        write!(out, "pbc=\"{px} {py} F\" ")?;
    }
    write!(out, "Properties={PROPERTIES} Time={time:?} step={step}")?;
    if let Some(seed) = seed {
        write!(out, " seed={seed}")?;
    }
    writeln!(out)?;
    for disc in particles.all() {
        let species = match disc.kind {
            Kind::Grain => "Si",
            Kind::Wall => "W",
        };
        let ([x, y, z], [u, v, w]) = (disc.position, disc.velocity);
        write!(out, "{species} {x:?} {y:?} {z:?} {} {u:?} {v:?} {w:?} ", disc.id)?;
        writeln!(out, "{:?} {:?} 0.0 0.0 {:?}", disc.radius, disc.mass, disc.omega)?;
    }
    Ok(())
}
