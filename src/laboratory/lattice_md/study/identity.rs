//! Comparison of lattice and neighbour lists along trajectories: BP93, section 5, "no differences in the results".

use super::StudyError;
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use stripmine_physics::method::lattice_md::keys::{EXECUTION, NORMAL_DAMPING, SEARCH};
use stripmine_physics::method::lattice_md::options::SearchKind;
use stripmine_physics::method::lattice_md::{GranularDocument, assemble};
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Name, preset, overrides, and number of steps.
type ComparedScene = (&'static str, &'static str, Overrides, u64);

/// Steps between two comparisons.
const STRIDE: u64 = 1000;

/// Runs each scene with both methods.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let few = Overrides::new().set(&COUNT, 400_u64);
    let dense = few.clone().set(&PACKING_FRACTION, 0.84).set(&NORMAL_DAMPING, 0.5);
    let scenes = [
        ("dense gas with friction", "bench", dense, 2000),
        ("density waves", "pipe-small", Overrides::new(), 4000),
        ("elastic gas", "dense-gas", few, 2000),
    ];
    let states = ProgressMeter::new(scenes.len() as f64, lab.progress).run_cases(&scenes, compare_states)?;
    let rows =
        scenes.iter().zip(&states).flat_map(|(scene, states)| states.iter().map(move |it| (scene.0, it)));
    Ok(FinishedItem::of([FrameBuilder::of(rows)
        .text("scene", |(name, _)| *name)
        .count("grains", |(_, (_, [lattice, _]))| lattice.grain_count())
        .count("step", |(_, (step, _))| *step)
        .text("lattice, CRC-32", |(_, (_, [lattice, _]))| format!("0x{}", lattice.checksum()))
        .text("lists, CRC-32", |(_, (_, [_, lists]))| format!("0x{}", lists.checksum()))
        .number("farthest apart (length)", 1, |(_, (_, [lattice, lists]))| {
            let apart = lattice.all().iter().zip(lists.all());
            let apart =
                apart.map(|(a, b)| (a.position[0] - b.position[0]).hypot(a.position[1] - b.position[1]));
            apart.fold(0.0, f64::max)
        })
        .frame("states", "States compared")])
    .with_seeds([1]))
}

/// Steps, and the particles with the lattice and with lists.
fn compare_states(
    (_, preset, overrides, steps): &ComparedScene,
) -> Result<Vec<(u64, [Particles; 2])>, StudyError> {
    let start = |search: SearchKind| {
        let overrides = overrides.clone().set(&SEARCH, search).set(&EXECUTION, "chained");
        Ok::<_, StudyError>(assemble(&GranularDocument::load(preset, &overrides.texts())?.check()?)?)
    };
    let (mut lattice, mut lists) = (start(SearchKind::Lattice)?, start(SearchKind::NeighborList)?);
    let mut states = vec![];
    for step in 1..=*steps {
        lattice.step()?;
        lists.step()?;
        if step % STRIDE == 0 {
            states.push((step, [lattice.particles(), lists.particles()]));
        }
    }
    Ok(states)
}
