//! The plan as a page of text.

use super::recommended::{Alternative, Decision, ExpectedError, LikelyRange, RunPlan, SimplerModelReport};
use stripmine_physics::memory::in_words;
use stripmine_physics::number::{significant, with_error_bar};

/// Formats a number with its unit.
pub(crate) fn with_unit(value: &str, unit: &str) -> String {
    if unit.is_empty() { value.to_owned() } else { format!("{value} {unit}") }
}

/// Returns the page: command and expected result, then every choice with its reason and the alternatives.
pub(crate) fn page(plan: &RunPlan) -> String {
    let mut page = vec![answer(plan), expected(plan)];
    page.extend(plan.own.as_ref().map(|own| {
        let takes = seconds(own.seconds);
        let most = own.error.most;
        match plan.mean {
            None if most.is_nan() => format!("scene as it stands: {takes}; its error was not measured"),
            None if most.is_infinite() => format!("scene as it stands: it fails: {}", own.faults),
            _ => format!("scene as it stands: {takes} for an error of at most {}", parts(plan, own.error)),
        }
    }));
    page.push(String::new());
    page.extend(plan.decisions.iter().flat_map(decision));
    if !plan.left_out.is_empty() {
        page.push("simpler models:".to_owned());
        page.extend(plan.left_out.iter().map(left_out));
    }
    page.push(format!("based on: {}", plan.origin));
    page.join("\n") + "\n"
}

/// Overrides equal to the scene's own values are printed too: the plan then stays the same if the scene changes.
fn answer(plan: &RunPlan) -> String {
    let set: String = plan.overrides.texts().iter().map(|text| format!(" \\\n    --set {text}")).collect();
    let seeds = if plan.seeds > 1 { format!(" --seeds {}", plan.seeds) } else { String::new() };
    format!("stripmine run {}{seeds}{set}", plan.scene)
}

fn expected(plan: &RunPlan) -> String {
    let mean = plan.mean.map_or(String::new(), |[mean, bar]| {
        format!(" {}", with_unit(&with_error_bar(mean, bar), plan.unit))
    });
    let asked = match plan.error {
        Some(error) => format!(" (asked: {})", share(plan, error)),
        None => String::new(),
    };
    format!(
        "expected: {}{mean}, error at most {}{}{asked}, in {}; {} of memory",
        plan.quantity,
        parts(plan, plan.expected),
        plan.deviation.map_or(String::new(), |range| deviations(plan, range)),
        interval(plan.seconds),
        in_words(plan.memory)
    )
}

/// Formats an error and its parts, relative to the mean where there is one.
fn parts(plan: &RunPlan, error: ExpectedError) -> String {
    let ExpectedError { bias, chance, most } = error;
    match plan.mean {
        Some(_) if bias.below.is_infinite() => {
            format!("{} of statistical error; the step bias is unknown", share(plan, chance))
        }
        Some(_) => format!(
            "{} (step bias {}, at most {}; statistical error {})",
            share(plan, most),
            share(plan, bias.shift),
            share(plan, bias.below),
            share(plan, chance)
        ),
        None => share(plan, most),
    }
}

/// Formats the smaller deviations beside the bound: that of the rows, which see less than every step, and the likely one of another start.
fn deviations(plan: &RunPlan, LikelyRange { least, likely, most }: LikelyRange) -> String {
    let [of_rows, likely_text, bound] = [least, likely, most].map(|it| share(plan, it));
    match (likely < most, of_rows == bound) {
        (true, _) => format!(" ({of_rows} or more, likely {likely_text})"),
        (false, false) => format!(" ({of_rows} at the rows that it writes)"),
        (false, true) => String::new(),
    }
}

fn share(plan: &RunPlan, error: f64) -> String {
    if !error.is_finite() {
        return "unknown".to_owned();
    }
    // A relative error is meaningless for a mean consistent with zero.
    match plan.mean {
        Some([mean, bar]) if mean.abs() > bar => format!("{} %", significant(100.0 * error / mean.abs(), 2)),
        _ => with_unit(&significant(error, 2), plan.unit),
    }
}

/// Formats a wall time.
pub(crate) fn seconds(seconds: f64) -> String {
    match seconds {
        _ if seconds < 120.0 => format!("{} s", significant(seconds, 2)),
        _ if seconds < 7200.0 => format!("{} min", significant(seconds / 60.0, 2)),
        _ => format!("{} h", significant(seconds / 3600.0, 2)),
    }
}

fn interval(it: LikelyRange) -> String {
    format!("{} ({} to {})", seconds(it.likely), seconds(it.least), seconds(it.most))
}

fn decision(it: &Decision) -> Vec<String> {
    let mut lines = vec![format!("{}: {}", it.what, it.chosen)];
    if !it.why.is_empty() {
        lines[0].push_str(&format!(" – {}", it.why));
    }
    lines.extend(it.beside.iter().map(alternative_line));
    lines
}

fn alternative_line(it: &Alternative) -> String {
    let cost = it.cost.map_or(String::new(), |cost| format!(" {}×", significant(cost, 2)));
    format!("    {}{cost}: {}", it.name, it.why)
}

fn left_out(it: &SimplerModelReport) -> String {
    let cost = match it.cost {
        Some(cost) if cost < 1.0 => {
            format!(" (saves {} % of the time)", significant(100.0 * (1.0 - cost), 2))
        }
        Some(cost) => format!(" (takes {} times as long)", significant(cost, 2)),
        None => String::new(),
    };
    format!("    {}{cost}: {}", it.name, it.says)
}
