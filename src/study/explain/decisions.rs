//! Decisions of a plan, each with its reason and its alternatives.

use super::findings::{Findings, MeasuredConfiguration};
use super::lengths::{PlanCandidate, RunLength};
use super::recommended::{Alternative, Decision, NecessityVerdict, SimplerModelReport};
use crate::study::StudyCase;
use stripmine_physics::number::significant;

/// Returns every decision of a plan.
pub(super) fn decisions(
    case: &StudyCase,
    findings: &Findings,
    weighed: &[PlanCandidate<'_>],
    length: &RunLength,
    (wanted, window): (f64, Option<[f64; 2]>),
) -> Vec<Decision> {
    let best = &weighed[0];
    let mut all = vec![];
    for (axis, chosen) in &best.configuration.settings {
        let mut beside: Vec<Alternative> = vec![];
        // The cheapest configuration represents each other setting.
        let known = weighed.iter().map(|it| it.configuration);
        for configuration in known.chain(&findings.configurations) {
            let Some((_, other)) = configuration.settings.iter().find(|(name, _)| name == axis) else {
                continue;
            };
            if other == chosen || beside.iter().any(|it| it.name == *other) {
                continue;
            }
            let own = weighed.iter().find(|it| it.configuration.label == configuration.label);
            let differs = configuration
                .settings
                .iter()
                .filter(|it| !best.configuration.settings.contains(it) && it.0 != *axis);
            let with: Vec<&str> = differs.map(|(_, name)| name.as_str()).collect();
            let with = if with.is_empty() { String::new() } else { format!(" (with {})", with.join(" ")) };
            beside.push(Alternative {
                name: other.clone(),
                cost: own.map(|it| it.optimum.seconds / best.optimum.seconds),
                why: rejection_reason(configuration, own, best) + &with,
            });
        }
        let why = match beside.iter().filter_map(|it| it.cost).reduce(f64::min) {
            Some(next) if next > 1.05 => {
                format!("the next best takes {} times as long", significant(next, 2))
            }
            Some(_) => "another setting is as fast, within the accuracy of the timing".to_owned(),
            None if beside.is_empty() => "the only setting".to_owned(),
            None => "no other setting is usable".to_owned(),
        };
        all.push(Decision { what: axis.clone(), chosen: chosen.clone(), why, beside });
    }
    all.extend(best.configuration.skin.map(|[own, skin, cost]| Decision {
        what: "skin".to_owned(),
        chosen: significant(skin, 3),
        why: format!(
            "a step takes {} times as long as with the scene's own skin of {}",
            significant(cost, 2),
            significant(own, 3)
        ),
        beside: vec![],
    }));
    if let Some(longest) = best.configuration.step {
        all.push(step_decision(case, best, longest, wanted));
    }
    all.push(Decision {
        what: "run length".to_owned(),
        chosen: significant(
            findings.whole.unwrap_or(length.time / length.seeds as f64 + findings.mean.transient),
            4,
        ),
        why: run_length(case, findings, length, window),
        beside: vec![],
    });
    all.push(Decision {
        what: "seeds".to_owned(),
        chosen: length.seeds.to_string(),
        why: length.why.clone(),
        beside: vec![],
    });
    all
}

/// Reason of the length of a run.
fn run_length(case: &StudyCase, findings: &Findings, length: &RunLength, window: Option<[f64; 2]>) -> String {
    if let Some([from, _]) = window {
        return format!("to the end of the requested window, which begins at {}", significant(from, 4));
    }
    if findings.whole.is_some() {
        return "the scene's own: the quantity never becomes stationary, so its mean is taken over the whole run".to_owned();
    }
    let mut why = format!(
        "averages over {}{} for a statistical error of ± {}, after a transient of {}",
        significant(length.time, 3),
        match findings.mean.every {
            0.0 => String::new(),
            every => format!(" in rows {} apart", significant(every, 2)),
        },
        significant(findings.chance().over(length.time), 2),
        significant(findings.mean.transient, 3)
    );
    let apart = findings.mean.apart;
    if let Some(own) = case.duration().filter(|own| apart > *own) {
        why.push_str(&format!(
            "; values stay correlated for a time of {}, longer than the scene's own run of {}, which is one sample",
            significant(apart, 2),
            significant(own, 3)
        ));
    }
    why
}

fn step_decision(case: &StudyCase, best: &PlanCandidate<'_>, longest: f64, wanted: f64) -> Decision {
    let step = best.optimum.part * longest;
    let own = case
        .step()
        .map_or(String::new(), |own| format!("{} times the scene's own; ", significant(step / own, 2)));
    let bound = best.configuration.bound.clone().unwrap_or_else(|| "no theoretical limit".to_owned());
    let mut beside = vec![Alternative {
        name: significant(longest, 3),
        cost: None,
        why: format!("the longest usable step ({bound})"),
    }];
    if best.optimum.part == 1.0 {
        beside.clear();
    }
    let why = match best.configuration.bias {
        Some(bias) => format!(
            "{own}bias {}, of an allowed error of {}; {}",
            match bias.is_significant() {
                true => significant(best.optimum.bias.shift, 2),
                false if best.optimum.bias.below.is_infinite() => "unknown".to_owned(),
                false => format!("below {}", significant(best.optimum.bias.below, 2)),
            },
            significant(wanted, 2),
            bias.in_words()
        ),
        None => own,
    };
    Decision { what: "dt".to_owned(), chosen: significant(step, 4), why, beside }
}

fn rejection_reason(
    configuration: &MeasuredConfiguration,
    own: Option<&PlanCandidate<'_>>,
    best: &PlanCandidate<'_>,
) -> String {
    if let Some(why) = &configuration.dropped {
        return why.clone();
    }
    let costs = |cost: f64| significant(cost / best.configuration.cost.unwrap_or(f64::NAN), 2);
    if let Some(drift) = configuration.drift.as_ref().filter(|_| own.is_none()) {
        return match drift.least() {
            least if least.is_finite() => {
                format!(
                    "changes by {} at the best step tried; steps that reach the error cost more",
                    significant(least, 2)
                )
            }
            _ => "none of its runs finished".to_owned(),
        };
    }
    match (own, configuration.cost) {
        (Some(own), _) if own.optimum.seconds > best.optimum.seconds => {
            "slower for the same error".to_owned()
        }
        (Some(_), _) => "as fast for the same error".to_owned(),
        (None, Some(_)) if configuration.bias.is_some() => "its bias exceeds the target error".to_owned(),
        (None, Some(cost)) => format!(
            "a unit of time costs {} times as much at its longest step; its bias was not measured",
            costs(cost)
        ),
        (None, None) => "not timed".to_owned(),
    }
}

/// Returns the changes of the mean by simpler models, each judged against the target error.
pub(super) fn left_out(findings: &Findings, wanted: f64, mean: f64) -> Vec<SimplerModelReport> {
    let all = findings.without.iter().map(|it| {
        let off = it.difference.map(|[difference, bar]| {
            let parts = [difference, bar].map(|value| significant(value, 2));
            let shares = [difference, bar].map(|value| significant(100.0 * value / mean.abs(), 2));
            format!("by {} ± {} ({} ± {} %)", parts[0], parts[1], shares[0], shares[1])
        });
        let need = match it.difference {
            Some([difference, bar]) if difference.abs() - bar > wanted => NecessityVerdict::Yes,
            Some([difference, bar]) if difference.abs() + bar <= wanted => NecessityVerdict::No,
            Some(_) => NecessityVerdict::Undecided,
            None => NecessityVerdict::NotCompared,
        };
        let off = off.unwrap_or_default();
        let says = match need {
            NecessityVerdict::Yes => format!("needed: without it the mean changes {off}"),
            NecessityVerdict::No => format!("not needed for this error: without it the mean changes {off}"),
            NecessityVerdict::Undecided => format!("undecided: the mean changes {off}"),
            NecessityVerdict::NotCompared => match &it.failed {
                Some(why) => format!("not compared: {why}"),
                None => "not compared".to_owned(),
            },
        };
        SimplerModelReport { name: it.name.clone(), change: it.difference, cost: it.cost, need, says }
    });
    all.chain(precision_comparison(findings)).collect()
}

/// Usual precision and the lower one it is compared with.
const PRECISIONS: [&str; 2] = ["f64", "f32"];

/// Compares single with double precision by the cheapest configuration timed in both.
fn precision_comparison(findings: &Findings) -> Option<SimplerModelReport> {
    let of = |configuration: &MeasuredConfiguration, axis: &str| {
        configuration.settings.iter().find(|(name, _)| name == axis).map(|(_, it)| it.clone())
    };
    let with = |half: &MeasuredConfiguration| {
        let is_twin = |other: &&MeasuredConfiguration| {
            of(other, AXIS).as_deref() == Some(PRECISIONS[0])
                && other.settings.iter().all(|it| it.0 == AXIS || half.settings.contains(it))
        };
        findings.configurations.iter().find(is_twin)
    };
    let mut halves = findings
        .configurations
        .iter()
        .filter(|configuration| of(configuration, AXIS).as_deref() == Some(PRECISIONS[1]));
    let (half, cost) = halves.find_map(|half| {
        let full = with(half)?;
        // The steps of the two may differ.
        let cost = half.cost? * half.step? / (full.cost? * full.step?);
        Some((half, cost))
    })?;
    let (need, says) = match (&half.dropped, half.bias.filter(|bias| bias.bar.is_finite())) {
        (Some(why), _) => (NecessityVerdict::Yes, format!("needed: {why}")),
        (None, Some(bias)) => (
            NecessityVerdict::No,
            format!(
                "not needed: in f32 the mean has a bias of {} ± {} at a step of {}, including the bias of that step",
                significant(bias.shift, 2),
                significant(bias.bar, 2),
                significant(bias.step, 3)
            ),
        ),
        (None, None) => (NecessityVerdict::NotCompared, "not compared".to_owned()),
    };
    Some(SimplerModelReport {
        name: "double precision (f32 for f64)".to_owned(),
        change: None,
        cost: Some(cost),
        need,
        says,
    })
}

/// Name of the precision axis.
const AXIS: &str = "precision";
