//! Predicted against measured: the errors, the worst cases, measured over predicted.

use crate::laboratory::lattice_md::study::model_validation::{
    Calibrated, Errors, ModelValidation, PHASES, PHASES_OF_DATA, STEP, STEPS, STEPS_OF_DATA, STRANGERS,
};
use crate::report::figure::{Axis, Band, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};

/// How many of the worst cases are named.
const NAMED: usize = 12;

/// What came out.
pub fn section(data: &ModelValidation) -> Section {
    let group = |what: &str| data.errors.iter().find(|errors| errors.what == what);
    let within = |what: &str, [median, ninth]: [f64; 2]| {
        group(what).is_none_or(|errors| errors.median <= median && errors.ninth_tenth <= ninth)
    };
    let reached = within(STEPS, [0.06, 0.15])
        && within(STEPS_OF_DATA, [0.06, 0.15])
        && within(PHASES, [0.1, 0.25])
        && within(PHASES_OF_DATA, [0.1, 0.25])
        && within(STRANGERS, [0.12, f64::INFINITY]);
    let again = match data.calibrated {
        Calibrated::Now => "stripmine validate-model --calibrate --out reports",
        Calibrated::Shipped => "stripmine validate-model --out reports",
        Calibrated::Before | Calibrated::Elsewhere => {
            "stripmine calibrate --out host.toml, then stripmine validate-model --host host.toml --out reports"
        }
    };
    Section::new("validation", "The timing model against wall time")
        .asks("How well does the timing model predict runs that nothing was fitted to?")
        .expects("BP93 predicts times and checks none of them. Our aim: whole steps to 6 % in the median and nine of ten to 15 %, phases to 10 % \
                  and 25 %, laws that were not calibrated for to 12 % in the median.")
        .answers(format!(
            "By {} the errors are {}.",
            data.calibrated.model_of(&data.host),
            [STEPS, STEPS_OF_DATA].into_iter().filter_map(group).map(in_short).collect::<Vec<_>>().join(", and ")
        ))
        .details([STEPS, STEPS_OF_DATA, PHASES, PHASES_OF_DATA, STRANGERS].into_iter().filter_map(group).map(said))
        .verdict(Verdict::aim(reached))
        .again(again)
        .figures([over_predicted(data), histogram(data)])
        .tables(tables(data))
        .seeds([1])
        .depends_on_host()
}

fn in_short(errors: &Errors) -> String {
    format!(
        "{:.1} % in the median and below {:.1} % for nine of ten of {} cases of {}",
        100.0 * errors.median,
        100.0 * errors.ninth_tenth,
        errors.cases,
        errors.what
    )
}

fn said(errors: &Errors) -> String {
    let Errors { what, cases, median, ninth_tenth, baseline_median, repeated, .. } = errors;
    let baseline = baseline_median.map_or(String::new(), |median| {
        format!("; time in proportion to operations errs by {:.0} %", 100.0 * median)
    });
    let repeated = repeated.map_or(String::new(), |median| {
        format!("; the halves of the measurement differ by {:.1} %", 100.0 * median)
    });
    format!(
        "{what}: median error {:.1} %, nine of ten below {:.1} % ({cases} cases{baseline}{repeated}).",
        100.0 * median,
        100.0 * ninth_tenth
    )
}

/// Errors by group, and the worst cases.
pub fn tables(data: &ModelValidation) -> Vec<Table> {
    vec![errors(data), worst(data)]
}

fn errors(data: &ModelValidation) -> Table {
    let from = match data.calibrated {
        Calibrated::Shipped => {
            "This is the model that comes with the program, not one of this host: calibrate first."
        }
        Calibrated::Before => "The model was calibrated at another time.",
        Calibrated::Elsewhere => {
            "It is a model of another processor, or of other instructions than this host measures by: errors are those of a wrong model."
        }
        Calibrated::Now => "The model was calibrated just before, on other numbers of discs and densities.",
    };
    Rows::of(&data.errors)
        .text("cases of", |it| &it.what)
        .count("cases", |it| it.cases)
        .number("median (%)", 1, |it| 100.0 * it.median)
        .number("90 % below (%)", 1, |it| 100.0 * it.ninth_tenth)
        .number("worst (%)", 1, |it| 100.0 * it.worst)
        .number("baseline (%)", 1, |it| it.baseline_median.map(|it| 100.0 * it))
        .number("halves differ (%)", 1, |it| it.repeated.map(|it| 100.0 * it))
        .table("errors", "Errors of the predictions")
        .note(format!(
            "Host model: {}, {}; the machine was {} when it was calibrated. {from}",
            data.host, data.instruction_set, data.state
        ))
        .note(format!(
            "Measured: the middle of the samples of {} rounds, as runs time themselves. Halves: how far every second sample and the \
             others lie apart. Baseline: operations times elements, at the cost of a sum in the cache.",
            data.rounds
        ))
        .note("Fast and lists: predicted from the numbers of candidates and contacts that the run itself had.")
        .note("The model is a sum: start-ups, operations and bytes, none of which hides behind another. It cannot be right where computing and \
               waiting overlap, where branches depend on the data (a list's candidates are charged alike, near or far), where what is met \
               again is nearer than all that its program goes over, where pages are large (its levels know no translation of addresses), and \
               where threads share a core or its frequency changes.")
}

fn worst(data: &ModelValidation) -> Table {
    Rows::of(data.worst().into_iter().take(NAMED))
        .text("case", |case| case.name())
        .number("predicted (ns)", 0, |case| case.predicted)
        .number("measured (ns)", 0, |case| case.measured)
        .number("error (%)", 1, |case| 100.0 * (case.predicted / case.measured - 1.0))
        .table("worst", "The worst cases")
}

/// Phases and laws, by execution.
fn over_predicted(data: &ModelValidation) -> Figure {
    let cases = data.cases.iter().filter(|case| case.phase != STEP);
    let points = cases.map(|case| (case.execution, (1e-3 * case.predicted, case.measured / case.predicted)));
    Chart::of(
        Axis::logarithmic("predicted time", Some("µs")),
        Axis::logarithmic("measured over predicted", None),
    )
    .with(Series::by_name(Style::Points, points))
    .band(Band::of_y("", [1.0 / 1.15, 1.15]))
    .band(Band::of_y("", [1.0 / 1.05, 1.05]))
    .figure("measured_over_predicted", "Measured over predicted")
    .caption("Each point is a phase of a step of one run, or a program. 1 is right. Grounds: within 5 % and within 15 %.")
}

fn histogram(data: &ModelValidation) -> Figure {
    const BIN: f64 = 2.5;
    const BINS: i32 = 14;
    let kinds = [("eager, strip-mined, chained", false), ("fast and lists", true)];
    let series = kinds.into_iter().enumerate().map(|(hue, (name, depends_on_data))| {
        let cases = data.cases.iter().filter(|case| case.depends_on_data() == depends_on_data);
        let errors: Vec<f64> = cases.map(|case| 100.0 * (case.predicted / case.measured - 1.0)).collect();
        let points = (-BINS..=BINS).map(|bin| {
            let centre = BIN * f64::from(bin);
            // What lies beyond the ends is counted there.
            let last = |error: f64| error.clamp(-BIN * f64::from(BINS), BIN * f64::from(BINS));
            let count = errors.iter().filter(|&&error| (last(error) - centre).abs() <= 0.5 * BIN).count();
            (centre, count as f64)
        });
        Series::new(name, Style::Steps, hue, points)
    });
    Chart::of(Axis::linear("predicted over measured - 1", Some("%")), Axis::linear("cases", None))
        .with(series)
        .figure("histogram", "Errors of the predictions")
        .caption("Cases in bins of 2.5 %; negative: predicted too short. The outermost bins hold all beyond.")
}
