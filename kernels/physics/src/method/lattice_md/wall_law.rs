//! Law between discs and plane walls.

use crate::method::pairwise::LawTask;
use stripmine_kernels::law::granular::{Contact, EqualDiscs, Granular};

/// Applies a task to the law between discs and plane walls, which reads radius and mass of each disc.
pub(super) fn with_wall_law<W: LawTask>((contact, friction): (Contact, bool), task: W) -> W::Output {
    let any = EqualDiscs { radius: f64::NAN, inverse_mass: f64::NAN };
    match friction {
        true => task.with(Granular::<true, false> { contact, disc: any }),
        false => task.with(Granular::<false, false> { contact, disc: any }),
    }
}
