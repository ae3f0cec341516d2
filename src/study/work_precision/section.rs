//! The page of speed against accuracy.

mod figures;
mod tables;

use super::conclusions::{WORTH, as_good, multiple, sentences};
use super::dataset::WorkPrecision;
use crate::console::Failure;
use crate::report::Section;
use crate::results::Made;
use stripmine_physics::number::counted;

/// What an item of it is called.
pub const NAME: &str = "work-precision";

/// In how many scenes something else than the scene's own way is as accurate for less.
fn answer(scenes: &[(String, WorkPrecision)]) -> String {
    let undecided: Vec<&str> =
        scenes.iter().filter(|(_, data)| data.undecided.is_some()).map(|(name, _)| name.as_str()).collect();
    let open = match undecided.as_slice() {
        [] => String::new(),
        names => format!(
            " Not decided, because too little happens in the time that is compared: {}.",
            names.join(", ")
        ),
    };
    let decided = scenes.len() - undecided.len();
    let cheaper = scenes.iter().filter_map(|(name, data)| Some((name, as_good(data)?)));
    let mut cheaper: Vec<_> = cheaper.filter(|(_, found)| found.of_own < WORTH).collect();
    cheaper.sort_by(|a, b| a.1.of_own.total_cmp(&b.1.of_own));
    let said = match (cheaper.first(), scenes, decided) {
        (_, _, 0) => return open.trim_start().to_owned(),
        (None, [(name, _)], _) => {
            format!("In {name} nothing is as accurate as the scene's own way and cheaper.")
        }
        (None, ..) => {
            "In none of the scenes that are decided is anything as accurate as the scene's own way and cheaper."
                .to_owned()
        }
        (Some((name, best)), all, _) => {
            let begin = match all {
                [_] => format!(
                    "In {name} another way or step is at least as accurate as the scene's own and cheaper:"
                ),
                _ => format!(
                    "In {} of {} that {} decided another way or step is at least as accurate as the scene's own and cheaper; most in \
                     {name},",
                    cheaper.len(),
                    counted(decided, "scene", "scenes"),
                    if decided == 1 { "is" } else { "are" }
                ),
            };
            format!(
                "{begin} {} at {} for {:.0} % of the cost.",
                best.way,
                multiple(best.power),
                100.0 * best.of_own
            )
        }
    };
    said + &open
}

/// The page over scenes, each with a name for its files, and `again`, the command that makes it.
///
/// # Errors
/// If the dataset is none that JSON can hold.
pub fn made(scenes: &[(String, WorkPrecision)], again: String) -> Result<Made, Failure> {
    let said = scenes.iter().map(|(name, data)| format!("`{name}`: {}", sentences(data).join(" ")));
    let mut seeds: Vec<u64> = scenes.iter().flat_map(|(_, data)| data.seeds.clone()).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let section = Section::new(NAME, "Speed against accuracy")
        .asks("Which integrator, step and precision is the cheapest for a wished accuracy?")
        .expects("The sources state a scheme and a step, and no error.")
        .answers(answer(scenes))
        .details(said)
        .figures(scenes.iter().flat_map(|(name, data)| figures::of(name, data)))
        .tables(tables::of(scenes))
        .again(again)
        .seeds(seeds)
        .depends_on_host();
    Ok(Made::by_name(section, scenes)?.with_tables([tables::runs(scenes), tables::all_means(scenes)]))
}
