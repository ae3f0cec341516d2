//! The identity of lattice and lists: tables, figures and what came out.

use crate::laboratory::lattice_md::study::identity::Identity;
use crate::report::{Rows, Section, Verdict};
use stripmine_physics::number::counted;

/// What came out.
pub fn section(data: &Identity) -> Section {
    let states = data.pairs.iter().flat_map(|pair| pair.states.iter().map(move |state| (pair, state)));
    let equal = states.clone().filter(|(_, state)| state.lattice == state.lists).count();
    let table = Rows::of(states.clone())
        .text("scene", |(pair, _)| pair.name)
        .count("grains", |(pair, _)| pair.grains)
        .count("step", |(_, state)| state.step)
        .text("lattice, CRC-32", |(_, state)| format!("0x{}", state.lattice))
        .text("lists, CRC-32", |(_, state)| format!("0x{}", state.lists))
        .number("farthest apart (length)", 1, |(_, state)| state.farthest)
        .table("states", "States compared")
        .note("Both methods use the same images of the discs and sum contacts in the mask's order, so not even rounding differs. Seeds are those \
               of the presets.");
    Section::new("identity", "Lattice and neighbour lists give the same")
        .asks("Do the lattice and neighbour lists give the same motion?")
        .expects(
            "BP93, section 4: no differences in the results compared to simulations with neighbour lists.",
        )
        .answers(format!(
            "{equal} of {} states along {} are the same to the last bit: positions, velocities and spins.",
            states.count(),
            counted(data.pairs.len(), "trajectory", "trajectories")
        ))
        .verdict(if data.holds() { Verdict::Reproduced } else { Verdict::NotReproduced })
        .tables([table])
        .seeds([1])
}
