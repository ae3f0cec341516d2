//! The page of where methods work.

mod figures;
mod tables;

use super::conclusions::{of_schemes, of_theory, sentences};
use super::dataset::Stability;
use super::outcome::Class;
use crate::console::Failure;
use crate::report::Section;
use crate::results::Made;
use stripmine_physics::number::{counted, range};

/// What an item of it is called.
pub const NAME: &str = "stability";

/// How theory does over all maps, and how much fails in silence.
fn answer(maps: &[(String, Stability)]) -> String {
    let middles: Vec<f64> =
        maps.iter().filter_map(|(_, data)| of_theory(data)).map(|[middle, ..]| middle).collect();
    let pairs: Vec<f64> = maps.iter().flat_map(|(_, data)| of_schemes(data)).collect();
    let (mut wrong, mut unsaid) = (0, 0);
    for (_, data) in maps {
        let said = data.said(Class::is_unseen);
        wrong += said.all;
        unsaid += said.unsaid();
    }
    let theory = match pairs.as_slice() {
        [] => String::new(),
        _ => format!(
            "The longest step that works is {} times the step beyond which theory says that errors grow, over {} of scene and integrator; \
             the median over a map is {} times ({}). ",
            range(pairs.iter().copied(), 3),
            counted(pairs.len(), "pair", "pairs"),
            range(middles.iter().copied(), 3),
            counted(middles.len(), "map", "maps")
        ),
    };
    let silent = match wrong {
        0 => "No run comes to an end and is wrong.".to_owned(),
        _ if unsaid == 0 => format!(
            "The program says so of {}.",
            counted(wrong, "run that comes to an end and is wrong", "runs that come to an end and are wrong")
        ),
        _ => format!(
            "Of {} to an end and {} wrong the program says nothing of {:.1} %.",
            counted(wrong, "run that comes", "runs that come"),
            if wrong == 1 { "is" } else { "are" },
            100.0 * unsaid as f64 / wrong as f64
        ),
    };
    theory + &silent
}

/// The page over maps, each with a name for its files, and `again`, the command that makes it.
///
/// # Errors
/// If the dataset is none that JSON can hold.
pub fn made(maps: &[(String, Stability)], again: String) -> Result<Made, Failure> {
    let said = maps.iter().map(|(name, data)| format!("`{name}`: {}", sentences(data).join(" ")));
    let section = Section::new(NAME, "Where the method works")
        .asks("From which step on does a method fail, how, and does theory or the program say so beforehand?")
        .expects("The sources state a step, and not how far it is from one that fails. Theory names steps beyond which errors grow.")
        .answers(answer(maps))
        .details(said)
        .figures(figures::summary(maps))
        .figures(maps.iter().map(|(name, data)| figures::map(name, data)))
        .tables(tables::of(maps))
        .again(again)
        .seeds(maps.first().map_or(vec![], |(_, data)| data.seeds.clone()))
        .depends_on_host();
    Ok(Made::by_name(section, maps)?.with_tables([tables::cells(maps), tables::boundaries(maps)]))
}
