//! Names of species in files: symbols of elements, which readers of trajectories know.

use crate::particles::{Particle, ParticleKind};
use std::sync::LazyLock;

/// Elements in the order of the species, without tungsten, the name of a wall disc.
const ELEMENTS: &str = "Si Ge Sn C Pb H He Li Be B N O F Ne Na Mg Al P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga As Se Br Kr Rb Sr Y Zr Nb \
    Mo Tc Ru Rh Pd Ag Cd In Sb Te I Xe Cs Ba La Ce Pr Nd Pm Sm Eu Gd Tb Dy Ho Er Tm Yb Lu Hf Ta Re Os Ir Pt Au Hg Tl Bi Po \
    At Rn Fr Ra Ac Th Pa U Np Pu Am Cm Bk Cf Es Fm Md No Lr Rf Db Sg Bh Hs Mt Ds Rg Cn Nh Fl Mc Lv Ts Og";

/// First letters of names beyond the elements; no element has a digit or a second capital.
const BEYOND: &[u8; 4] = b"XQJZ";
const SECOND: &[u8; 36] = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// Names of all species.
static NAMES: LazyLock<[[u8; 2]; 256]> = LazyLock::new(|| {
    let elements = ELEMENTS.split_whitespace().map(|name| match name.as_bytes() {
        [first, second] => [*first, *second],
        [first, ..] => [*first, 0],
        [] => [0; 2],
    });
    let beyond = BEYOND.iter().flat_map(|&first| SECOND.iter().map(move |&second| [first, second]));
    let mut names = [[0; 2]; 256];
    names.iter_mut().zip(elements.chain(beyond)).for_each(|(name, given)| *name = given);
    names
});

/// Name of a species, of one or two letters; a missing second one is 0.
pub(crate) fn symbol(species: u8) -> [u8; 2] {
    NAMES[usize::from(species)]
}

/// Number of the type of a particle, from 0: the other species follow the grains of the first and the wall discs.
pub(crate) fn type_of(particle: &Particle) -> u32 {
    match (particle.kind, particle.species) {
        (ParticleKind::Wall, _) => 1,
        (ParticleKind::Grain, 0) => 0,
        (ParticleKind::Grain, species) => u32::from(species) + 1,
    }
}

/// Kind and species of a type.
pub(crate) fn kind_and_species(of_type: u32) -> (ParticleKind, u8) {
    match of_type {
        0 => (ParticleKind::Grain, 0),
        1 => (ParticleKind::Wall, 0),
        _ => (ParticleKind::Grain, (of_type - 1).min(u8::MAX.into()) as u8),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// All names differ, none is that of a wall disc, and the first is silicon.
    #[test]
    fn species_have_names_of_their_own() {
        let names: HashSet<[u8; 2]> = (0..=u8::MAX).map(symbol).collect();
        assert!(names.len() == 256 && !names.contains(&[b'W', 0]) && symbol(0) == *b"Si");
        assert!(names.iter().all(|name| name[0].is_ascii_uppercase()));
    }
}
