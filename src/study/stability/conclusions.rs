//! What a map says, in plain words.

use super::boundary::Edge;
use super::dataset::{Boundary, Stability, over_seeds};
use super::outcome::Class;
use crate::statistics::median;
use crate::study::work_precision::conclusions::short;

/// Edges over seeds that are farther apart than this many tolerances differ.
const APART: f64 = 2.0;

/// Sentences on a scene.
pub fn sentences(data: &Stability) -> Vec<String> {
    let all =
        [own(data), classes(data), theory(data), repeats(data), silent(data), alarms(data), unjudged(data)];
    all.into_iter()
        .flatten()
        .chain(schemes(data))
        .chain(data.left_out.as_ref().map(|what| format!("Left out: {what}.")))
        .collect()
}

/// Steps as multiples of the scene's own.
fn times(data: &Stability, step: f64) -> String {
    format!("{} times", short(step / data.step))
}

/// The edges over the seeds, or where they are.
fn edges(data: &Stability, edges: &[Edge]) -> String {
    match over_seeds(edges) {
        Some([middle, low, high]) if high > low * (1.0 + APART * data.tolerance) => {
            format!(
                "{} (over the seeds {} to {})",
                times(data, middle),
                short(low / data.step),
                short(high / data.step)
            )
        }
        Some([middle, ..]) => times(data, middle),
        None if edges.iter().all(|edge| *edge == Edge::Above) => {
            format!("more than {}", times(data, data.steps[data.steps.len() - 1]))
        }
        None if edges.iter().all(|edge| *edge == Edge::Below) => {
            format!("less than {}", times(data, data.steps[0]))
        }
        None => "different multiples from seed to seed of".to_owned(),
    }
}

fn own(data: &Stability) -> Option<String> {
    let own = data.schemes.iter().find(|scheme| data.way.split(' ').any(|part| part == scheme.scheme))?;
    Some(format!(
        "As it stands, with {}, the scene works up to {} its own step and comes to an end up to {}.",
        own.scheme,
        edges(data, &own.edges.works),
        edges(data, &own.edges.ends)
    ))
}

/// What the map is made of.
fn classes(data: &Stability) -> Option<String> {
    let all = data.cells().count();
    let count = |class: Class| data.cells().filter(|cell| cell.class == class).count();
    if count(Class::Works) == all {
        return Some(format!("All {all} places of the map work: no failure anywhere."));
    }
    let said = Class::ALL.into_iter().filter(|&class| count(class) > 0);
    let said: Vec<String> = said.map(|class| format!("{} {}", count(class), class.name())).collect();
    Some(format!("Of {all} places of the map over {} and step: {}.", data.parameter.label, said.join(", ")))
}

/// The step at which what works ends over the smallest beyond which theory says that errors grow: middle, lowest and highest over
/// the values.
pub fn of_theory(data: &Stability) -> Option<[f64; 3]> {
    let ratios = |edge: fn(&Boundary) -> &[Edge]| -> Vec<f64> {
        let at = data.values.iter().zip(&data.boundaries);
        let ratio = at.filter_map(|(&value, boundary)| {
            Some(over_seeds(edge(boundary))?[0] / data.unstable_beyond(value)?.0)
        });
        let mut ratios: Vec<f64> = ratio.collect();
        ratios.sort_by(f64::total_cmp);
        ratios
    };
    let works = ratios(|boundary| &boundary.works);
    Some([median(works.iter().copied()), *works.first()?, *works.last()?])
}

/// The longest step of each integrator that works over the step beyond which theory says that its errors grow, at the scene's own
/// values.
pub fn of_schemes(data: &Stability) -> impl Iterator<Item = f64> + '_ {
    data.schemes.iter().filter_map(|scheme| Some(over_seeds(&scheme.edges.works)?[0] / scheme.theory?.0))
}

/// What theory and measurement have to do with each other.
fn theory(data: &Stability) -> Option<String> {
    let [middle, first, last] = of_theory(data)?;
    let mut said = format!(
        "What works ends at {} times the smallest step beyond which theory says that errors grow, {} ({} to {} over the values)",
        short(middle),
        names(data),
        short(first),
        short(last)
    );
    said.push_str(&why(data, middle));
    Some(said + ".")
}

/// The limits that are the smallest at some value.
fn names(data: &Stability) -> String {
    let mut names: Vec<&str> =
        data.values.iter().filter_map(|&value| Some(data.unstable_beyond(value)?.1)).collect();
    names.sort_unstable();
    names.dedup();
    format!("that of {}", names.join(" or "))
}

/// Why measurement and theory differ.
fn why(data: &Stability, ratio: f64) -> String {
    // What is beyond the edge says what ended it.
    let beyond = data.map.iter().filter_map(|cells| {
        let place = cells.iter().position(|cell| cell.class != Class::Works)?;
        Some(cells[place].class).filter(|class| *class != Class::Refused)
    });
    let beyond: Vec<Class> = beyond.collect();
    let Some(most) =
        Class::ALL.into_iter().max_by_key(|class| beyond.iter().filter(|it| *it == class).count())
    else {
        return String::new();
    };
    let share = beyond.iter().filter(|it| **it == most).count();
    let begin = format!("; what comes first beyond is {} at {share} of {} values", most.name(), beyond.len());
    let reason = if ratio > 1.25 {
        ": contacts end before errors have grown, and theory is of a spring that is always as stiff as in the deepest contact"
    } else if ratio < 0.8 && most.is_unseen() {
        ": contacts are followed too badly long before errors grow from step to step, so that accuracy and not stability ends it"
    } else if ratio < 0.8 {
        ": particles are stopped by something else than growing errors"
    } else {
        ": theory and measurement agree within a quarter"
    };
    begin + reason
}

fn repeats(data: &Stability) -> Option<String> {
    let spreads = data.boundaries.iter().filter_map(|boundary| {
        let [_, low, high] = over_seeds(&boundary.works)?;
        Some(high / low - 1.0)
    });
    let spreads: Vec<f64> = spreads.collect();
    let within = spreads.iter().filter(|spread| **spread <= APART * data.tolerance).count();
    (!spreads.is_empty()).then(|| {
        format!(
            "Edges lie within {:.0} % of the step; over {} seeds {within} of {} agree within twice that, and in the middle they \
             are {:.0} % apart.",
            100.0 * data.tolerance,
            data.seeds.len(),
            spreads.len(),
            100.0 * median(spreads.iter().copied())
        )
    })
}

fn silent(data: &Stability) -> Option<String> {
    let said = data.said(Class::is_unseen);
    let share = |part: usize| 100.0 * part as f64 / said.all as f64;
    (said.all > 0).then(|| {
        format!(
            "Of the {} places that come to an end and are wrong, the program refuses {:.0} % and warns of {:.0} % before the run; a \
             check during the run catches {:.0} %; of {:.0} % nothing is said.",
            said.all,
            share(said.refused),
            share(said.warned_before),
            share(said.warned_by_run),
            share(said.unsaid())
        )
    })
}

fn alarms(data: &Stability) -> Option<String> {
    let said = data.said(|class| class == Class::Works);
    let alarms = said.all - said.unsaid();
    (said.all > 0).then(|| {
        format!(
            "Of the {} places that work it refuses {} and warns of {}.",
            said.all,
            said.refused,
            alarms - said.refused
        )
    })
}

fn unjudged(data: &Stability) -> Option<String> {
    let (value, why) = data.unjudged.first()?;
    Some(format!(
        "At {} of {} values the runs with the smallest step break, too, and nothing is known of what is right; at {} = {}: {why}.",
        data.unjudged.len(),
        data.values.len(),
        data.parameter.label,
        short(*value)
    ))
}

fn schemes(data: &Stability) -> Option<String> {
    let said = data.schemes.iter().filter_map(|scheme| {
        let [middle, ..] = over_seeds(&scheme.edges.works)?;
        let theory =
            scheme.theory.map_or(String::new(), |(step, _)| format!(" (theory {})", short(step / data.step)));
        Some(format!("{} {}{theory}", scheme.scheme, short(middle / data.step)))
    });
    let said: Vec<String> = said.collect();
    (!said.is_empty())
        .then(|| format!("Largest step that works, in own steps, by integrator: {}.", said.join(", ")))
}
