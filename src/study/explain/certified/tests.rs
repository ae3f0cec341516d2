//! Judged plans, synthetic and carried out.

use super::grid::RelativeCosts;
use super::runs::side_by_side;
use super::*;
use crate::frame::ExpressionScope;
use crate::study::trial::MeanEstimate;
use std::sync::atomic::AtomicBool;
use stripmine_physics::method::METHODS;

fn plan(class: SceneClass, outcome: Result<CarriedPlan, String>) -> JudgedPlan {
    JudgedPlan { class, scene: "a".to_owned(), quantity: "flow", asked: "1%", trials: 10.0, outcome }
}

fn carried(runs: &[f64], bar: f64, costs: Option<RelativeCosts>) -> CarriedPlan {
    let runs: Vec<Result<f64, String>> = runs.iter().copied().map(Ok).collect();
    let known = MeanEstimate { bar, ..MeanEstimate::exactly(10.0) };
    CarriedPlan {
        plan: String::new(),
        error: 1.0,
        reference: Ok(ReferenceMean { known, step: None }),
        verdict: Some(PlanVerdict::of(&runs, [10.0, bar], 1.0)),
        seconds: [1.0, 1.6],
        costs,
    }
}

/// By hand: 8 runs of the decided plans, 6 of them within; refused and undecided plans have no runs. Wilson's interval of 6 of 8 is 40.93 to 92.85 %.
#[test]
fn runs_and_plans_are_counted_once() {
    let costs = RelativeCosts {
        plan: 1.2,
        choice: Some(1.0),
        baselines: [Some(1.5), None, Some(1.0)],
        best: String::new(),
        seconds: 1.0,
    };
    let plans = vec![
        plan(SceneClass::Driven, Ok(carried(&[10.0, 10.9, 9.1, 11.1], 0.1, Some(costs)))),
        plan(SceneClass::Driven, Err("it would take an hour".to_owned())),
        plan(SceneClass::Driven, Ok(carried(&[10.0, 20.0], 0.5, None))),
        plan(
            SceneClass::Bodies,
            Ok(CarriedPlan { seconds: [1.0, 0.7], ..carried(&[10.6, 10.6, 10.6, 12.0], 0.1, None) }),
        ),
    ];
    let effort =
        PlanTestEffort { trials: [10.0, 60.0], limit: 10.0, estimates: 4, reference: 1.0, grid: 1.0 };
    let scope = ExpressionScope::of(made(&TestedPlans { plans, effort }).frames);
    let expressions = crate::frame::Expressions::new();
    for (expression, expected) in [
        ("within.at(class='all').plans_asked_for", "4"),
        ("within.at(class='all').refused", "1"),
        ("within.at(class='all').undecided", "1"),
        ("within.at(class='all').runs", "8"),
        ("within.at(class='all').within_the_error", "6"),
        ("within.at(class='all').share_within", "0.75"),
        ("within.at(class='all').lower_end_95|digits(4)", "0.4093"),
        ("within.at(class='all').upper_end_95|digits(4)", "0.9285"),
        ("within.at(class='driven granular').missed_by_statistics", "1"),
        ("within.at(class='bodies').missed_by_bias", "1"),
        ("summary.carried_out", "3"),
        ("summary.within_the_time_foreseen", "1"),
        ("costs.column('plan')|max", "1.2"),
        ("costs.column('plan_over_the_scene_s_own_values')|max|digits(3)", "0.8"),
        ("plans.where(outcome='refused').column('runs')|length", "0"),
        ("plans.where(outcome='judged')[0].because", "statistics"),
    ] {
        assert_eq!(expressions.value(expression, &scope).unwrap().to_string(), expected, "{expression}");
    }
}

/// Free particles in a heat bath have its temperature, 1, at any step of BAOAB. Time is synthetic.
#[test]
fn runs_and_reference_have_the_bath_temperature() {
    let sets = ["particles.count=200".to_owned()];
    let case = StudyCase::load("langevin-free", &sets, METHODS).unwrap();
    let (watch, stop) = (Stopwatch::with_synthetic_time(100.0), AtomicBool::new(false));
    let trial = TrialControl { watch: &watch, stop: &stop };
    let error = Width::Percent(6.0);
    let target = PlanTarget::of(&case, Some("temperature"), Some(error)).unwrap();
    let plan = by_trials(&case, &target, 2.0, trial).unwrap();
    let ensemble = StartEnsemble { case: &case, target: &target, trial, asking: EstimatedMean::from(&plan) };
    let reference = ensemble.reference(error, 20.0).unwrap();
    let [mean, bar] = reference.mean();
    assert!((mean - 1.0).abs() < 1.5 * bar && bar < 0.02, "{mean} ± {bar}");
    assert!((reference.step.unwrap() / case.step().unwrap() - 0.25).abs() < 1e-12);
    let (runs, seconds) = ensemble.estimates(&plan, 12).unwrap();
    let verdict = PlanVerdict::of(&runs, reference.mean(), 0.06);
    assert!(verdict.is_decided && verdict.within >= 10 && verdict.broken == 0, "{runs:?}");
    assert!(seconds > 0.0);
    // Each estimate has its own start, and the first is not one of the trials'.
    let mut values: Vec<f64> = runs.into_iter().flatten().collect();
    values.sort_by(f64::total_cmp);
    assert!(values.windows(2).all(|pair| pair[0] < pair[1]), "{values:?}");
}

#[test]
fn parallel_results_return_in_order() {
    let threads = side_by_side(9, |at| (at, rayon::current_num_threads())).unwrap();
    assert_eq!(threads, (0..9).map(|at| (at, 1)).collect::<Vec<_>>());
}
