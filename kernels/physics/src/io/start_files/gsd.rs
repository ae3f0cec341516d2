//! GSD of HOOMD-blue, the package `gsd` and others. Files of this program have their own chunks in double precision, which are read exactly.

use super::{QuantitySource, StartBox, StartFileError, StartFormat, StartFrame, StartRequest};
use crate::io::extxyz::ParticleFrame;
use crate::io::gsd::{ForeignFrame, GsdErrorKind, GsdFrames, GsdLocation, GsdReadError, SIGNATURE};
use crate::io::plane::move_into_plane;
use crate::particles::Particles;
use std::path::Path;

pub(super) static FORMAT: StartFormat = StartFormat {
    name: "GSD",
    recognises: |head| head.starts_with(&SIGNATURE),
    read,
    columns: ["particles/velocity", "particles/diameter", "particles/mass"],
};

/// Values that the schema defines for velocities, diameters and masses without a chunk; radii are half of a diameter.
const DEFAULTS: [f64; 3] = [0.0, 0.5, 1.0];

fn read(path: &Path, request: StartRequest) -> Result<StartFrame, StartFileError> {
    let mut frames = GsdFrames::open_foreign(path)?;
    let count = frames.frame_count();
    let number = request.frame.unwrap_or(count.saturating_sub(1));
    let common = |particles, cell, sources, periodic| StartFrame {
        particles,
        cell,
        periodic,
        sources,
        has_momenta: false,
        line: None,
        columns: FORMAT.columns,
        has_raised_ids: false,
    };
    if number >= count {
        return Err(StartFileError::beyond(path, request, count));
    }
    if frames.is_own() {
        let Some(ParticleFrame { mut particles, cell, origin, periodic, .. }) = frames.frame(number)? else {
            return Err(StartFileError::beyond(path, request, count));
        };
        check_plane(path, number, particles.all_mut(), request)?;
        let own = StartBox { corner: origin, sides: cell, is_movable: false, precision: StartBox::DOUBLE };
        let cell = cell.iter().all(|side| side.is_finite()).then_some(own);
        return Ok(common(particles, cell, [QuantitySource::Stated; 3], periodic));
    }
    let ForeignFrame { mut particles, sides, has } = frames.foreign_frame(number, request.is_planar)?;
    check_plane(path, number, &mut particles, request)?;
    let sides = [sides[0], sides[1]];
    let corner = sides.map(|side| -0.5 * side);
    let cell = StartBox { corner, sides, is_movable: true, precision: StartBox::SINGLE };
    let sources = std::array::from_fn(|at| match has[at] {
        true => QuantitySource::Stated,
        false => QuantitySource::Default(DEFAULTS[at]),
    });
    Ok(common(Particles::new(particles), Some(cell), sources, None))
}

/// Checks that particles are in a plane if they must be, and moves it to z = 0.
fn check_plane(
    path: &Path,
    frame: u64,
    particles: &mut [crate::particles::Particle],
    request: StartRequest,
) -> Result<(), GsdReadError> {
    if !request.is_planar || move_into_plane(particles) {
        return Ok(());
    }
    let first = particles.first().map_or(0.0, |first| first.position[2]);
    let row = particles.iter().position(|it| it.position[2] != first).unwrap_or(0);
    let found = particles.get(row).map_or(first, |it| it.position[2]).to_string();
    let expected = "one z for all particles, as discs lie in a plane";
    Err(GsdReadError {
        file: path.to_owned(),
        place: GsdLocation::Chunk { frame, chunk: "particles/position" },
        reason: GsdErrorKind::Number { row, found, expected },
    })
}
