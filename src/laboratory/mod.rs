//! The laboratory: studies of each method, in a folder of the method's name.
//!
//! A study is a function from parameters to datasets; it becomes an item of the report or a verb. A method runs without a line here.

pub(crate) mod hard_disks;
pub(crate) mod host_table;
pub(crate) mod langevin;
pub(crate) mod lattice_md;
mod mixtures;
pub(crate) mod nbody;
pub(crate) mod programs;
pub(crate) mod rates;
mod running;

use crate::console::{CommandFailure, Common, Verb, print_message};
use crate::provenance::Provenance;
use crate::results::{FinishedItem, Folder, Item};
use std::time::Instant;
use stripmine_physics::method::Methods;
use stripmine_physics::signals;

/// Items, verbs and measured work of one method.
#[derive(Debug)]
pub(crate) struct Laboratory {
    /// The method's name.
    pub method: &'static str,
    /// Items of `reproduce`, in the order of the page.
    pub items: &'static [Item],
    /// Verbs that only this method has.
    pub verbs: &'static [Verb],
    /// Studies that only this method has, as verbs below `chart`.
    pub(crate) charts: &'static [Verb],
    /// Work timed by its studies that is not a run of a scene.
    pub works: &'static [rates::StudyWork],
}

/// One laboratory for every method that is studied.
static LABORATORIES: [&Laboratory; 4] =
    [&lattice_md::LABORATORY, &hard_disks::LABORATORY, &langevin::LABORATORY, &nbody::LABORATORY];

/// Laboratories of some methods, in the order of the methods.
pub(crate) fn laboratories(methods: Methods) -> impl Iterator<Item = &'static Laboratory> {
    methods.iter().flat_map(|method| {
        LABORATORIES.into_iter().filter(|laboratory| laboratory.method == method.vocabulary.keys.method)
    })
}

/// Writes the result of a verb that began at `start` to its folder and reports the path. Returns the paragraphs of its page.
fn write_result(
    folder: &Folder,
    (name, made): (&str, &FinishedItem),
    start: Instant,
    common: &Common,
) -> Result<String, CommandFailure> {
    let provenance = Provenance::here(common.command.clone(), start.elapsed().as_secs_f64());
    let (folder, section) = signals::run_protected(|| folder.write(name, made, &provenance))?;
    if !common.quiet {
        print_message(format_args!("written: {}", folder.display()));
    }
    Ok(section.paragraphs().collect::<Vec<_>>().join(" "))
}
