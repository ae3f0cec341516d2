//! The laboratory: what is studied of each method beside a run, in a folder of the method's name: studies as functions from
//! parameters to datasets, sections of the report, verbs. A method runs without a line here.

pub(crate) mod hard_disks;
pub(crate) mod langevin;
pub(crate) mod lattice_md;
pub(crate) mod nbody;
pub(crate) mod programs;
pub(crate) mod rates;
mod running;

use crate::console::{Common, Failure, Verb, say};
use crate::provenance::Provenance;
use crate::results::{Folder, Item, Made};
use std::time::Instant;
use stripmine_physics::method::Methods;
use stripmine_physics::signals;

/// What the laboratory has of a method.
#[derive(Debug)]
pub(crate) struct Laboratory {
    /// The method's name.
    pub method: &'static str,
    /// What `reproduce` makes of it, in the order of the page.
    pub items: &'static [Item],
    /// Verbs of its own.
    pub verbs: &'static [Verb],
    /// Studies of its own, as verbs below `chart`.
    pub(crate) charts: &'static [Verb],
    /// Work that its studies time and that is no run of a scene.
    pub works: &'static [rates::Own],
}

/// Of every method that is studied.
static LABORATORIES: [&Laboratory; 4] =
    [&lattice_md::LABORATORY, &hard_disks::LABORATORY, &langevin::LABORATORY, &nbody::LABORATORY];

/// Those of some methods, in the order of these.
pub(crate) fn laboratories(methods: Methods) -> impl Iterator<Item = &'static Laboratory> {
    methods.iter().flat_map(|method| {
        LABORATORIES.into_iter().filter(|laboratory| laboratory.method == method.vocabulary.keys.method)
    })
}

/// Writes a result of a verb that began at `start` to its folder, and says where. Returns the words of its page.
fn written(
    folder: &Folder,
    (name, made): (&str, &Made),
    start: Instant,
    common: &Common,
) -> Result<String, Failure> {
    let provenance = Provenance::here(common.command.clone(), start.elapsed().as_secs_f64());
    let (folder, section) = signals::whole(|| folder.write(name, made, &provenance))?;
    if !common.quiet {
        say(format_args!("written: {}", folder.display()));
    }
    Ok(section.paragraphs().collect::<Vec<_>>().join(" "))
}
