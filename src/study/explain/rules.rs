//! Rules of plans, tested on synthetic findings.

use super::as_it_stands::AS_IT_STANDS;
use super::bias::{Bias, StepDifference};
use super::drift::{DeviationRun, RunCosts};
use super::findings::{Findings, MeasuredConfiguration};
use super::plan::plan;
use super::recommended::LikelyRange;
use super::trial_runs::{measure_findings, plan_or_scene};
use super::{ExplainError, PlanTarget, page};
use crate::results::Journal;
use crate::study::trial::MeanEstimate;
use crate::study::trial::{PairedConfigurations, Stopwatch, TrialControl, run_pairs, shown_part};
use crate::study::{SettingChoice, StudyCase};
use std::sync::atomic::AtomicBool;
use stripmine_physics::method::{METHODS, StartPurpose};
use stripmine_physics::scene::{DT, Overrides, SEED, Width};

/// A configuration, wall seconds of a unit of time, and the bias.
type ConfigurationCase<'m> = (&'m SettingChoice, f64, Option<Bias>);

fn gas() -> StudyCase {
    StudyCase::load("dense-gas", &["particles.count=100".to_owned()], METHODS).unwrap()
}

fn asking(case: &StudyCase, error: f64) -> PlanTarget {
    PlanTarget::of(case, Some("pressure"), Some(Width::Absolute(error))).unwrap()
}

/// Configurations at the scene's own step, and a mean of 1.
fn findings(case: &StudyCase, configurations: &[ConfigurationCase<'_>], mean: MeanEstimate) -> Findings {
    let configuration = |(choice, cost, bias): &ConfigurationCase<'_>| MeasuredConfiguration {
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
        configurations: configurations.iter().map(configuration).collect(),
        mean,
        own_run: None,
        mean_configuration: String::new(),
        whole: None,
        starts_differ: None,
        start: 0.0,
        row: 0.0,
        one_thread: 1.0,
        threads: 1,
        without: vec![],
    }
}

fn known(square: f64, freedoms: f64) -> MeanEstimate {
    MeanEstimate {
        bar: square.sqrt(),
        square,
        span: 1.0,
        waves: freedoms,
        apart: 1e-6,
        freedoms,
        ..MeanEstimate::exactly(1.0)
    }
}

fn biased(case: &StudyCase, shift: f64, bar: f64) -> Option<Bias> {
    let step = case.step().unwrap();
    Some(Bias { shift, bar, part: 1.0, pairs: Some([shift, bar]), ..Bias::unknown(step, 2.0) })
}

/// The scene's own configuration, whose bias is unknown, reaches its error in less time than another: then the scene is left as it stands. Where the
/// other takes less time, it is the plan.
#[test]
fn plan_is_never_worse_than_the_scene() {
    let case = gas();
    let all = SettingChoice::all(case.entry.axes);
    let order =
        |choice: &&SettingChoice| choice.scheme().map(|it| it.name) == case.own.scheme().map(|it| it.name);
    let other = all.iter().filter(order).find(|choice| **choice != case.own).unwrap();
    let time = case.duration().unwrap();
    // Statistical error alone of the scene itself.
    let known = known(1e-4 * time, 16.0);
    let error = known.bars().over(time);
    for (cost, is_better) in [(3.0, false), (1.01, false), (0.5, true)] {
        let found = findings(&case, &[(&case.own, 1.0, None), (other, cost, biased(&case, 0.0, 0.0))], known);
        let plan = plan_or_scene(&case, &asking(&case, error), &found, "trials").unwrap();
        let page = page(&plan);
        let expected = if is_better { other.label() } else { case.own.label() };
        assert_eq!(plan.configuration, expected, "{page}");
        let seconds = if is_better { cost * time } else { time };
        assert!((plan.seconds.likely / seconds - 1.0).abs() < 1e-6, "{page}");
        assert!(plan.expected.most <= error * (1.0 + 1e-12), "{page}");
        assert_eq!(plan.overrides.is_empty(), !is_better, "{page}");
        assert_eq!(plan.decisions[0].what == AS_IT_STANDS, !is_better, "{page}");
        // Each phase has a time, in either plan.
        let [(phase, spent)] = plan.phases.as_slice() else { panic!("{page}") };
        assert!(phase == "forces" && (spent / (0.5 * seconds) - 1.0).abs() < 1e-6, "{spent}");
    }
}

/// By hand: two bodies keep their energy to 10⁻⁴ as they stand, in 1 s a unit of time. Another integrator is the plan if its error is no larger and it
/// takes less time; else the scene is kept. With a target of 10⁻⁵ the scene is no candidate; if it fails, or warns, the plan has to reach 10⁻³.
#[test]
fn conserved_plans_are_no_worse_than_scenes() {
    let case = StudyCase::load("kepler", &[], METHODS).unwrap();
    let all = SettingChoice::all(case.entry.axes);
    let other = all.iter().find(|choice| choice.scheme().map(|it| it.name) == Some("yoshida-4")).unwrap();
    let (time, step) = (case.duration().unwrap(), case.step().unwrap());
    let none = MeanEstimate::exactly(0.0);
    for (cost, error, fails, target, chosen) in [
        (0.5, 1e-5, false, None, Some(other)),
        (0.5, 2e-4, false, None, Some(&case.own)),
        (1.5, 1e-9, false, None, Some(&case.own)),
        (1.01, 1e-9, false, None, Some(&case.own)),
        (1.5, 1e-9, false, Some(1e-5), Some(other)),
        (1.5, 1e-9, false, Some(1e-3), Some(&case.own)),
        (1.5, 1e-4, false, Some(1e-5), None),
        (1.5, 1e-4, true, None, Some(other)),
        (1.5, 1e-2, true, None, None),
    ] {
        let mut found = findings(&case, &[(&case.own, 1.0, None), (other, cost, None)], none);
        found.configurations[1].drift.get_or_insert_default().add(step, LikelyRange::exactly(error));
        let costs = RunCosts { start: 0.0, row: 0.0, unit: 1.0, phases: vec![] };
        let deviation = LikelyRange { least: 1e-6, ..LikelyRange::exactly(1e-4) };
        found.own_run = Some(match fails {
            false => DeviationRun { deviation, costs: Some(costs), faults: String::new() },
            true => DeviationRun {
                deviation: LikelyRange::exactly(f64::INFINITY),
                costs: None,
                faults: "unbound".to_owned(),
            },
        });
        let target = PlanTarget::of(&case, None, target.map(Width::Absolute)).unwrap();
        assert_eq!(target.quantity.name, "energy_error");
        let plan = plan_or_scene(&case, &target, &found, "trials").ok();
        let what = format!("{cost} {error} {fails} {:?}: {plan:?}", target.error);
        assert_eq!(
            plan.as_ref().map(|it| &it.configuration),
            chosen.map(SettingChoice::label).as_ref(),
            "{what}"
        );
        let Some(plan) = plan else { continue };
        let is_own = plan.overrides.is_empty();
        assert_eq!(is_own, chosen == Some(&case.own), "{what}");
        let (seconds, most) = if is_own { (time, 1e-4) } else { (cost * time, error) };
        assert!((plan.seconds.likely / seconds - 1.0).abs() < 1e-9 && plan.expected.most == most, "{what}");
        assert_eq!(plan.deviation.map(|it| it.least), Some(if is_own { 1e-6 } else { error }), "{what}");
        let page = page(&plan);
        assert_eq!(page.contains("the scene: keep it as it stands"), is_own, "{page}");
        assert_eq!(page.contains("(1e-6 at the rows that it writes)"), is_own, "{page}");
        assert_eq!(page.contains("it fails: unbound"), fails, "{page}");
    }
}

/// LAN17's scheme as printed heats free particles to kT/(1 − γ dt/2m): at steps of 0.2 and 0.1 (γ, m and kT are 1) by 0.1111 and 0.0526, which a line
/// through the reference fits with 0.1099 at the longer one. Short and long windows agree.
#[test]
fn pairs_measure_heating_of_the_printed_scheme() {
    let sets = ["particles.count=4000", "domain.sides=[100.0, 50.0]"].map(str::to_owned);
    let case = StudyCase::load("langevin-free", &sets, METHODS).unwrap();
    let place = case.entry.quantities.iter().position(|it| it.name == "temperature").unwrap();
    let integrator = case.entry.vocabulary.keys.key("integrator", "kind").unwrap();
    let kinds = [("baoab", 0.025), ("as-printed", 0.2), ("as-printed", 0.1)];
    let begin = |at: usize, start: usize| {
        let (kind, step) = kinds[at];
        let more = Overrides::new().set(integrator, kind).set(&DT, step).set(&SEED, start as u64 + 1);
        Ok(case.prepared_with(&more).unwrap().start(StartPurpose::Run).unwrap())
    };
    let compared = PairedConfigurations { steps: &[8, 1, 2], first: 2, starts: 24, begin: &begin };
    let (watch, stop) = (Stopwatch::with_synthetic_time(1.0), AtomicBool::new(false));
    let trial = TrialControl { watch: &watch, stop: &stop };
    let paired = run_pairs(&trial, &compared, (case.entry.quantities, place), 0.1).unwrap();
    assert!(paired.windows.len() > 3, "{:?}", paired.windows);
    // Temperatures decorrelate at the rate 2 γ/m.
    const MEMORY: f64 = 0.5;
    for both in paired.windows.windows(2) {
        let seen = |place: usize| {
            StepDifference::of([&both[0], &both[1]], place, (MEMORY, 1.0), (kinds[1 + place].1, 0.0))
        };
        let shown = shown_part(both[1].time, MEMORY);
        let bias = Bias::of(&[seen(0), seen(1)], 1.0, both[1].time, shown, paired.starts);
        let said = format!("{}: {bias:?}", both[1].time);
        assert!(bias.is_significant() && (bias.shift - 0.1099).abs() < bias.bar, "{said}");
        assert!(bias.bar < 0.05, "{said}");
    }
}

/// Trials on a synthetic clock are reproducible: steps, biases and plans do not depend on the speed of the machine.
#[test]
fn trials_on_a_synthetic_clock_are_reproducible() {
    // Nanoseconds per particle and step.
    for (preset, sets, quantity, each) in [
        ("pipe-small", &["domain.sides=[0.81, 0.088]", "run.time=0.5"][..], "flow", 400.0),
        ("langevin-dense", &["particles.count=64", "domain.sides=[12.0, 9.0]"], "potential", 2000.0),
    ] {
        let sets: Vec<String> = sets.iter().map(|&text| text.to_owned()).collect();
        let case = StudyCase::load(preset, &sets, METHODS).unwrap();
        let target = PlanTarget::of(&case, Some(quantity), Some(Width::Percent(10.0))).unwrap();
        let stop = AtomicBool::new(false);
        let made = || {
            let watch = Stopwatch::with_synthetic_time(each);
            let mut found = measure_findings(
                &case,
                &target,
                6.0,
                TrialControl { watch: &watch, stop: &stop },
                (&|_| {}, &Journal::none()),
            )
            .unwrap();
            found.configurations.iter_mut().for_each(|configuration| configuration.phases.clear());
            serde_json::to_string(&found).unwrap()
        };
        let first = made();
        assert!(first.contains("\"bias\":{\"step\""), "{preset}: {first}");
        assert_eq!(first, made(), "{preset}");
    }
}

/// By hand: the square of an error bar is 16 in a unit of time and well known, so an error of 0.01 takes 160 000 units of time at 1 s each; the error
/// within the limit of an hour is 4/√3600 = 0.0667.
#[test]
fn refused_plan_reports_error_within_the_limit() {
    let case = gas();
    let found = findings(&case, &[(&case.own, 1.0, biased(&case, 0.0, 0.0))], known(16.0, f64::INFINITY));
    let refused = plan(&case, &asking(&case, 0.01), &found, "trials").err().unwrap();
    let [takes, limit] = refused.takes.unwrap();
    assert!((takes / 160_000.0 - 1.0).abs() < 1e-6 && limit == 3600.0, "{refused:?}");
    assert!((refused.least - 4.0 / 60.0).abs() < 1e-6, "{refused:?}");
    let said = ExplainError::OutOfReach { quantity: "pressure", unreached: refused }.to_string();
    assert!(said.contains("44 h") && said.contains("60 min") && said.contains("0.067"), "{said}");
    // A sufficient limit.
    let patient = PlanTarget { limit: 200_000.0, ..asking(&case, 0.01) };
    assert!(plan(&case, &patient, &found, "trials").is_ok());
}

/// An insignificant bias keeps the step within a quarter of the longest, however large its error bar; a significant one does not.
#[test]
fn insignificant_bias_keeps_the_step_long() {
    let case = gas();
    let own = case.step().unwrap();
    for (shift, bar, part) in [(0.001, 0.5, 1.0), (0.2, 0.3, 0.25), (0.3, 0.01, 0.0816)] {
        let found = findings(&case, &[(&case.own, 1e-9, biased(&case, shift, bar))], known(1e-6, 16.0));
        let made = plan(&case, &asking(&case, 0.01), &found, "trials");
        let step = made.unwrap().step.unwrap();
        // Significant bias: with power 2 a fifth of the error is bias, at √(0.01/(5·0.3)) of the step.
        assert!(
            step > 0.99 * part * own && step < 1.01 * f64::max(part, 0.18) * own,
            "{part}: {step} of {own}"
        );
    }
}

/// For any scatter of the mean, the expected error is at most the requested one, and the printed run is no shorter than planned; in stretches and
/// in whole runs.
#[test]
fn plan_stays_within_the_target_error() {
    let case = gas();
    for square in [1e-12, 3.7e-5, 0.2] {
        for freedoms in [2.0, 6.0, 9.4, 15.0, 16.0] {
            for bias in [biased(&case, 0.0, 0.0), biased(&case, 0.01, 0.004)] {
                for whole in [None, case.duration()] {
                    let mut found = findings(&case, &[(&case.own, 1e-9, bias)], known(square, freedoms));
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
