//! The identity of lattice and lists: tables, figures and what came out.

use crate::laboratory::lattice_md::study::identity::Identity;
use crate::report::{Cell, Part, Section, Table, Verdict};
use stripmine_physics::number::counted;

/// What came out.
pub fn section(data: &Identity) -> Section {
    let states = data.pairs.iter().map(|pair| pair.states.len()).sum::<usize>();
    let equal =
        data.pairs.iter().flat_map(|pair| &pair.states).filter(|state| state.lattice == state.lists).count();
    let rows = data.pairs.iter().flat_map(|pair| {
        pair.states.iter().map(|state| {
            vec![
                pair.name.into(),
                Cell::Count(pair.grains as u64),
                Cell::Count(state.step),
                state.lattice.as_str().into(),
                state.lists.as_str().into(),
                Cell::Number(state.farthest, 1),
            ]
        })
    });
    Section::new("identity", "Lattice and neighbour lists give the same", Part::Physics)
        .asks("Do the lattice and neighbour lists give the same motion?")
        .expects("BP93, section 4: no differences in the results compared to simulations with neighbour lists.")
        .answers(format!(
            "{equal} of {states} states along {} are the same to the last bit: positions, velocities and spins.",
            counted(data.pairs.len(), "trajectory", "trajectories")
        ))
        .verdict(if data.holds() { Verdict::Reproduced } else { Verdict::NotReproduced })
        .tables([Table {
            name: "states".into(),
            title: "States compared".into(),
            columns: [
                "scene",
                "grains",
                "step",
                "lattice (CRC-32)",
                "lists (CRC-32)",
                "farthest apart (length)",
            ]
            .map(str::to_owned)
            .to_vec(),
            rows: rows.collect(),
            notes: vec![
                "Both methods use the same images of the discs and sum contacts in the mask's order, so not even rounding differs. Seeds are \
                 those of the presets.".into(),
            ],
        }])
        .seeds([1])
}
