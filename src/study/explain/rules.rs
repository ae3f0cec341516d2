//! Rules of plans, on findings that are made up.

use super::as_it_stands::AS_IT_STANDS;
use super::bias::Bias;
use super::findings::{Findings, Way};
use super::plan::plan;
use super::sample::Known;
use super::seen::planned;
use super::{ExplainError, Target, page};
use crate::study::{Case, Choice};
use stripmine_physics::method::METHODS;
use stripmine_physics::scene::Width;

/// Wall seconds of a unit of time, and the bias.
type Made<'m> = (&'m Choice, f64, Option<Bias>);

fn gas() -> Case {
    Case::load("dense-gas", &["particles.count=100".to_owned()], METHODS).unwrap()
}

fn asking(case: &Case, error: f64) -> Target {
    Target::of(case, Some("pressure"), Some(Width::Absolute(error))).unwrap()
}

/// Configurations at the scene's own step, and a reference of mean 1.
fn findings(case: &Case, ways: &[Made<'_>], reference: Known) -> Findings {
    let way = |(choice, cost, bias): &Made<'_>| Way {
        label: choice.label(),
        settings: choice.settings().map(|(axis, name)| (axis.to_owned(), name.to_owned())).collect(),
        overrides: choice.overrides(),
        cost: Some(*cost),
        step: case.step(),
        bound: None,
        skin: None,
        phases: vec![("forces".to_owned(), 0.5 * cost)],
        bias: *bias,
        drift: None,
        dropped: None,
    };
    Findings {
        ways: ways.iter().map(way).collect(),
        reference,
        reference_way: String::new(),
        reference_step: case.step().map(|step| 0.25 * step),
        whole: None,
        starts_differ: None,
        start: 0.0,
        row: 0.0,
        one_thread: 1.0,
        threads: 1,
        without: vec![],
    }
}

fn reference(square: f64, freedoms: f64) -> Known {
    Known { mean: 1.0, bar: square.sqrt(), square, transient: 0.0, apart: 1e-6, freedoms }
}

fn biased(case: &Case, difference: f64, bar: f64) -> Option<Bias> {
    Some(Bias { step: case.step().unwrap(), difference, bar, power: 2.0 })
}

/// The scene's own configuration, which was not compared, reaches its error in less time than another: then the scene is left as it stands. Where the
/// other takes less time, it is the plan.
#[test]
fn a_plan_that_is_worse_than_the_scene_is_not_printed() {
    let case = gas();
    let all = Choice::all(case.entry.axes);
    let order = |choice: &&Choice| choice.scheme().map(|it| it.name) == case.own.scheme().map(|it| it.name);
    let other = all.iter().filter(order).find(|choice| **choice != case.own).unwrap();
    let time = case.duration().unwrap();
    // By chance alone the scene itself reaches an error of this.
    let known = reference(1e-4 * time, 16.0);
    let error = known.bars().over(time);
    for (cost, is_better) in [(3.0, false), (1.01, false), (0.5, true)] {
        let found = findings(&case, &[(&case.own, 1.0, None), (other, cost, biased(&case, 0.0, 0.0))], known);
        let plan = planned(&case, &asking(&case, error), &found, "trials").unwrap();
        let page = page(&plan);
        let expected = if is_better { other.label() } else { case.own.label() };
        assert_eq!(plan.way, expected, "{page}");
        let seconds = if is_better { cost * time } else { time };
        assert!((plan.seconds.likely / seconds - 1.0).abs() < 1e-6, "{page}");
        assert!(plan.expected.most <= error * (1.0 + 1e-12), "{page}");
        assert_eq!(plan.overrides.is_empty(), !is_better, "{page}");
        assert_eq!(plan.decisions[0].what == AS_IT_STANDS, !is_better, "{page}");
        assert_eq!(page.contains(other.label().as_str()), is_better, "{page}");
        // A time for each phase, of either.
        let [(phase, spent)] = plan.phases.as_slice() else { panic!("{page}") };
        assert!(phase == "forces" && (spent / (0.5 * seconds) - 1.0).abs() < 1e-6, "{spent}");
    }
}

/// A plan of hours that rests on a bias within its bar is refused with the best error that was seen: (0.001 + 0.05) 16/15, what the reference has itself among it. A
/// short one, and one whose bias was seen, are made.
#[test]
fn a_plan_of_hours_whose_bias_was_not_seen_is_refused() {
    let case = gas();
    let wanted = 0.02;
    for (cost, difference, is_made) in [(1e7, 0.001, false), (1e-3, 0.001, true), (1e7, 0.06, true)] {
        let ways = [(&case.own, cost, biased(&case, difference, 0.05))];
        let found = findings(&case, &ways, reference(1e-6, 16.0));
        match plan(&case, &asking(&case, wanted), &found, "trials") {
            Ok(plan) => assert!(is_made && plan.expected.most <= wanted * (1.0 + 1e-12), "{}", page(&plan)),
            Err(refused) => {
                assert!(!is_made && refused.takes.is_some_and(|seconds| seconds > 3600.0), "{refused}");
                assert!((refused.least - 0.051 * 16.0 / 15.0).abs() < 1e-12, "{refused}");
                assert!(refused.to_string().ends_with("the best error that is known is 0.054"), "{refused}");
            }
        }
    }
}

/// Where no bias was seen the refusal has the seconds of trials that should be enough, by hand: a transient of 2 and 40 samples 0.05 apart at 3 s, for four
/// configurations, of which the comparison is an eighth of the trials.
#[test]
fn trials_that_saw_no_bias_say_how_long_would_be_enough() {
    let case = gas();
    let known = Known { transient: 2.0, apart: 0.05, ..reference(1e-6, 16.0) };
    let found = findings(&case, &[(&case.own, 3.0, None)], known);
    let refused = plan(&case, &asking(&case, 0.01), &found, "trials").err().unwrap();
    assert!((refused.enough.unwrap() - 3.0 * 4.0 * 4.0 * 8.0).abs() < 1e-9, "{refused:?}");
    let said = ExplainError::OutOfReach { quantity: "pressure", unreached: refused }.to_string();
    assert!(said.contains("trials of about 384 s should be enough: --seconds 384"), "{said}");
}

/// However the reference scatters: what a plan expects is no more than what was asked for, and the run that is printed is no shorter than planned; in stretches,
/// and in whole runs.
#[test]
fn a_plan_expects_no_more_than_the_error_asked_for() {
    let case = gas();
    for square in [1e-12, 3.7e-5, 0.2] {
        for freedoms in [2.0, 6.0, 9.4, 15.0, 16.0] {
            for bias in [biased(&case, 0.0, 0.0), biased(&case, 0.01, 0.004)] {
                for whole in [None, case.duration()] {
                    let mut found = findings(&case, &[(&case.own, 1e-9, bias)], reference(square, freedoms));
                    found.whole = whole;
                    for error in (0..40).map(|step| 1e-4 * libm::pow(1.3, f64::from(step))) {
                        let what = format!("{square} {freedoms} {bias:?} {whole:?} {error}");
                        let made = plan(&case, &asking(&case, error), &found, "trials").unwrap();
                        assert!(made.expected.most <= error * (1.0 + 1e-12), "{what}: {:?}", made.expected);
                        let given = |key: &str| {
                            let texts = made.overrides.texts();
                            let text = texts.iter().find_map(|it| it.strip_prefix(key));
                            text.map(|text| text.parse::<f64>().unwrap())
                        };
                        let steps = given("run.steps=").zip(given("integrator.dt="));
                        let time = given("run.time=").or(steps.map(|(steps, step)| steps * step)).unwrap();
                        assert!(time >= made.time * (1.0 - 1e-12), "{what}: {time} of {}", made.time);
                        assert!(time <= made.time * (1.0 + 1e-4) + case.step().unwrap(), "{what}: {time}");
                    }
                }
            }
        }
    }
}
