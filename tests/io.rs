//! Files in and out: written files are read back to the same bits, and anything else is rejected.

#[path = "io/bad_frames.rs"]
mod bad_frames;
#[path = "io/checkpoint.rs"]
mod checkpoint;
#[path = "io/corrupt_checkpoint.rs"]
mod corrupt_checkpoint;
#[path = "io/frames.rs"]
mod frames;
#[path = "io/growing_files.rs"]
mod growing_files;
#[path = "io/gsd.rs"]
mod gsd;
#[path = "io/lammps.rs"]
mod lammps;
#[path = "io/others.rs"]
mod others;
#[path = "io/start_files.rs"]
mod start_files;

use stripmine_physics::io::extxyz::{ParticleFrame, write};
use stripmine_physics::particles::{Particle, ParticleKind, Particles};

/// A grain and a wall disc with numbers that are hard to print.
fn frame(step: u64) -> ParticleFrame {
    let grain = Particle {
        id: 7,
        kind: ParticleKind::Grain,
        species: 0,
        position: [0.1 + 0.2, -0.0, 0.0],
        velocity: [5e-324, -f64::MAX, 0.0],
        angle: 0.0,
        omega: -1.0 / 3.0,
        radius: 0.5,
        mass: 1e-7,
    };
    let wall =
        Particle { id: u32::MAX, kind: ParticleKind::Wall, position: [1e300, 2.0, 0.0], mass: 1e16, ..grain };
    ParticleFrame {
        particles: Particles::new(vec![grain, wall]),
        cell: [10.0 / 3.0, 8.0],
        origin: [-1.5, 0.1],
        periodic: Some([true, false]),
        time: 0.1 * step as f64,
        step,
        seed: Some(u64::MAX),
        has_raised_ids: false,
    }
}

fn text(frame: &ParticleFrame) -> String {
    let mut bytes = Vec::new();
    write(frame, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// Random bytes for damage: the sequence is the same in every run.
struct Random(u64);

impl Random {
    /// Random index below `limit`.
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % limit as u64) as usize
    }
}
