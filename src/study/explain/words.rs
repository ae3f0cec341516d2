//! A plan as a page that is read in a minute.

use super::recommended::{Beside, Decision, Expected, Interval, LeftOut, Plan};
use stripmine_physics::memory::in_words;
use stripmine_physics::number::{significant, with_bar};

/// A number with its unit.
pub(crate) fn with_unit(value: &str, unit: &str) -> String {
    if unit.is_empty() { value.to_owned() } else { format!("{value} {unit}") }
}

/// The page: what is recommended and what it gives, then every choice with its reason and what stands beside it.
pub(crate) fn page(plan: &Plan) -> String {
    let mut page = vec![answer(plan), expected(plan)];
    page.extend(plan.own.as_ref().map(|own| {
        let takes = seconds(own.seconds);
        // A step that is dearer than the plan was not tried.
        match own.error.most.is_nan() && plan.mean.is_none() {
            true => format!("as it stands: {takes}, for an error that was not tried"),
            false => format!("as it stands: {takes} for an error of at most {}", parts(plan, own.error)),
        }
    }));
    page.push(String::new());
    page.extend(plan.decisions.iter().flat_map(decision));
    if !plan.left_out.is_empty() {
        page.push("what the scene may do without:".to_owned());
        page.extend(plan.left_out.iter().map(left_out));
    }
    page.push(format!("from: {}", plan.origin));
    page.join("\n") + "\n"
}

/// Overrides that say the same as the scene itself are no news, but none is left out: the plan is the same where the scene changes.
fn answer(plan: &Plan) -> String {
    let set: String = plan.overrides.texts().iter().map(|text| format!(" \\\n    --set {text}")).collect();
    let seeds = if plan.seeds > 1 { format!(" --seeds {}", plan.seeds) } else { String::new() };
    format!("stripmine run {}{seeds}{set}", plan.scene)
}

fn expected(plan: &Plan) -> String {
    let mean = plan
        .mean
        .map_or(String::new(), |[mean, bar]| format!(" {}", with_unit(&with_bar(mean, bar), plan.unit)));
    let asked = match plan.error {
        Some(error) => format!(" (asked: {})", share(plan, error)),
        None => String::new(),
    };
    format!(
        "expected: {}{mean}, error at most {}{asked}, in {}; {} of memory",
        plan.quantity,
        parts(plan, plan.expected),
        interval(plan.seconds),
        in_words(plan.memory)
    )
}

/// An error with its parts, in parts of the mean where there is one.
fn parts(plan: &Plan, error: Expected) -> String {
    let Expected { bias, chance, most } = error;
    match plan.mean {
        Some(_) if bias.below.is_infinite() => {
            format!("{} by chance; the bias of the step is not known", share(plan, chance))
        }
        Some(_) => format!(
            "{} (by the step {}, known to be below {}; by chance {})",
            share(plan, most),
            share(plan, bias.shift),
            share(plan, bias.below),
            share(plan, chance)
        ),
        None => share(plan, most),
    }
}

fn share(plan: &Plan, error: f64) -> String {
    if !error.is_finite() {
        return "unknown".to_owned();
    }
    // A part of a mean means nothing where that is about zero.
    match plan.mean {
        Some([mean, bar]) if mean.abs() > bar => format!("{} %", significant(100.0 * error / mean.abs(), 2)),
        _ => with_unit(&significant(error, 2), plan.unit),
    }
}

/// A wall time.
pub(crate) fn seconds(seconds: f64) -> String {
    match seconds {
        _ if seconds < 120.0 => format!("{} s", significant(seconds, 2)),
        _ if seconds < 7200.0 => format!("{} min", significant(seconds / 60.0, 2)),
        _ => format!("{} h", significant(seconds / 3600.0, 2)),
    }
}

fn interval(it: Interval) -> String {
    format!("{} ({} to {})", seconds(it.likely), seconds(it.least), seconds(it.most))
}

fn decision(it: &Decision) -> Vec<String> {
    let mut lines = vec![format!("{}: {}", it.what, it.chosen)];
    if !it.why.is_empty() {
        lines[0].push_str(&format!(" – {}", it.why));
    }
    lines.extend(it.beside.iter().map(beside));
    lines
}

fn beside(it: &Beside) -> String {
    let cost = it.cost.map_or(String::new(), |cost| format!(" {}×", significant(cost, 2)));
    format!("    {}{cost}: {}", it.name, it.why)
}

fn left_out(it: &LeftOut) -> String {
    let cost = match it.cost {
        Some(cost) if cost < 1.0 => {
            format!(" (saves {} % of the time)", significant(100.0 * (1.0 - cost), 2))
        }
        Some(cost) => format!(" (takes {} times as long)", significant(cost, 2)),
        None => String::new(),
    };
    format!("    {}{cost}: {}", it.name, it.says)
}
