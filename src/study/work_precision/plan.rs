//! Selection of the runs of a diagram that fit into the available time.

use crate::study::choice::SettingChoice;
use stripmine_physics::method::ChoiceEffect;

/// Largest step: this power of two times the scene's own.
pub(crate) const COARSEST: i32 = 4;
/// Step of the reference: this power of two below the smallest step tried.
pub(crate) const BELOW: i32 = 3;
/// Share of the time for the runs of the ladder and their references; the rest is for the growth of a disturbance and for collisions.
const SHARE: f64 = 0.6;

/// Selection of configurations and steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct DiagramScope {
    /// True if configurations that differ in cost alone are run in every scheme and precision.
    every_cost: bool,
    /// True if every scheme is run in every precision.
    every_precision: bool,
    /// Smallest step: this power of two below the scene's own.
    finest: i32,
}

/// Scopes from the largest to the smallest.
const SCOPES: [DiagramScope; 6] = [
    DiagramScope { every_cost: true, every_precision: true, finest: 4 },
    DiagramScope { every_cost: false, every_precision: true, finest: 4 },
    DiagramScope { every_cost: false, every_precision: true, finest: 3 },
    DiagramScope { every_cost: false, every_precision: true, finest: 2 },
    DiagramScope { every_cost: false, every_precision: false, finest: 2 },
    SMALLEST,
];
const SMALLEST: DiagramScope = DiagramScope { every_cost: false, every_precision: false, finest: 1 };

/// Runs of a diagram.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DiagramPlan {
    /// Length of the runs in steps of the scene's own, a multiple of the coarsest step.
    pub(crate) own_steps: u64,
    /// Smallest step: this power of two below the scene's own.
    pub(crate) finest: i32,
    /// Indices of the configurations that are run.
    pub choices: Vec<usize>,
    /// Approximate total seconds.
    pub seconds: f64,
    /// Omitted parts, in words.
    pub left_out: Vec<String>,
}

/// Plans the runs: `rates` are seconds of a step by index of the choice, none where it is refused; `own_steps` is the number of steps of the
/// scene's own for which trajectories are comparable; `repeats` is the number of timed runs of each.
pub(crate) fn plan(
    choices: &[SettingChoice],
    rates: &[Option<f64>],
    own: &SettingChoice,
    own_steps: u64,
    budget: f64,
    repeats: usize,
) -> DiagramPlan {
    let multiple = 1 << COARSEST;
    let own_rate = choices.iter().position(|choice| choice == own).and_then(|place| rates[place]);
    // Configurations, seconds for each step of the scene's own, and the steps that fit.
    let sized = |scope: DiagramScope| {
        let is_meant = |place: &usize| rates[*place].is_some() && is_run(&choices[*place], own, scope);
        let places: Vec<usize> = (0..choices.len()).filter(is_meant).collect();
        let ladder: f64 = (-scope.finest..=COARSEST).map(|power| 0.5f64.powi(power)).sum();
        let runs: f64 = places.iter().filter_map(|place| rates[*place]).sum::<f64>() * (1 + repeats) as f64;
        let reference = own_rate.unwrap_or(0.0) * 2.5 * 2f64.powi(scope.finest + BELOW);
        let each = runs * ladder + reference;
        (places, each, (SHARE * budget / each.max(1e-12)) as u64)
    };
    let is_whole = |scope: &DiagramScope| sized(*scope).2 >= own_steps;
    let scope = SCOPES.into_iter().find(is_whole).unwrap_or(SMALLEST);
    let (places, each, affordable) = sized(scope);
    let steps = (own_steps.min(affordable) / multiple * multiple).max(multiple);
    let mut left_out = vec![];
    if !scope.every_cost {
        left_out.push(
            "configurations that differ in cost alone, in other integrators and precisions than the scene's own"
                .to_owned(),
        );
    }
    if !scope.every_precision {
        left_out.push("integrators other than the scene's own in precisions other than its own".to_owned());
    }
    if scope.finest < SCOPES[0].finest {
        left_out.push(format!("steps below 1/{} of the scene's own", 1 << scope.finest));
    }
    if affordable < own_steps {
        left_out.push(format!(
            "the time after {steps} of the {own_steps} own steps for which trajectories are comparable"
        ));
    }
    DiagramPlan {
        own_steps: steps,
        finest: scope.finest,
        choices: places,
        seconds: each * steps as f64,
        left_out,
    }
}

fn is_run(choice: &SettingChoice, own: &SettingChoice, scope: DiagramScope) -> bool {
    let same = |decides| choice.agrees_on(own, decides);
    let [order, precision, cost] =
        [ChoiceEffect::Order, ChoiceEffect::Precision, ChoiceEffect::Cost].map(same);
    match scope {
        DiagramScope { every_cost: true, .. } => true,
        DiagramScope { every_precision: true, .. } => cost || order && precision,
        // At most one setting differs.
        _ => [order, precision, cost].into_iter().filter(|same| !same).count() < 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::METHODS;

    #[test]
    fn smaller_budget_omits_more_and_reports_it() {
        let axes = METHODS[0].axes;
        let choices = SettingChoice::all(axes);
        let own = choices[0].clone();
        let mut rates = vec![Some(1e-6); choices.len()];
        rates[1] = None;
        let [rich, poor] = [1e4, 0.5].map(|budget| plan(&choices, &rates, &own, 10_000, budget, 3));
        assert_eq!((rich.choices.len(), rich.finest, rich.left_out.len()), (choices.len() - 1, 4, 0));
        assert!(poor.choices.len() < rich.choices.len() && poor.finest == 1 && poor.left_out.len() == 4);
        assert!(poor.own_steps < rich.own_steps && poor.own_steps.is_multiple_of(16));
        assert!(poor.seconds <= 0.5, "{}", poor.seconds);
    }
}
