//! Predicted against measured: the errors, the worst cases, measured over predicted.

use crate::laboratory::lattice_md::study::model_validation::{
    Calibrated, Errors, ModelValidation, PHASES, PHASES_OF_DATA, STEP, STEPS, STEPS_OF_DATA, STRANGERS,
};
use crate::report::figure::{Axis, Band, Chart, Figure, Picture, Point, Series, Style};
use crate::report::{Cell, Part, Section, Table, Verdict};

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
    Section {
        name: "validation".into(),
        title: "The timing model against wall time".into(),
        part: Part::Host,
        question: "How well does the timing model predict runs that nothing was fitted to?".into(),
        expected: "BP93 predicts times and checks none of them. Our aim, against the middle of the samples: whole steps to 6 % in the \
                   median and nine of ten to 15 %, phases to 10 % and 25 %, laws that were not calibrated for to 12 % in the median."
            .into(),
        answer: format!(
            "By {}: {}",
            data.calibrated.model_of(&data.host),
            [STEPS, STEPS_OF_DATA].into_iter().filter_map(group).map(said).collect::<Vec<_>>().join(" ")
        ),
        details: [PHASES, PHASES_OF_DATA, STRANGERS].into_iter().filter_map(group).map(said).collect(),
        verdict: Verdict::aim(reached),
        again: match data.calibrated {
            Calibrated::Now => "stripmine validate-model --calibrate --out reports".into(),
            Calibrated::Shipped => "stripmine validate-model --out reports".into(),
            Calibrated::Before => {
                "stripmine calibrate --out host.toml, then stripmine validate-model --host host.toml --out reports".into()
            }
        },
        figures: vec![over_predicted(data), histogram(data)],
        tables: tables(data),
        excerpt: None,
        film: None,
        seeds: vec![1],
        depends_on_host: true,
        provenance: None,
    }
}

fn percent(share: f64) -> Cell {
    Cell::Number(100.0 * share, 1)
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

fn headings(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

fn errors(data: &ModelValidation) -> Table {
    let rows = data.errors.iter().map(|errors| {
        vec![
            Cell::Text(errors.what.clone()),
            Cell::Count(errors.cases as u64),
            percent(errors.median),
            percent(errors.ninth_tenth),
            percent(errors.worst),
            errors.baseline_median.map_or(Cell::Nothing, percent),
            errors.repeated.map_or(Cell::Nothing, percent),
        ]
    });
    let from = match data.calibrated {
        Calibrated::Shipped => {
            "This is the model that comes with the program, not one of this host: calibrate first."
        }
        Calibrated::Before => "The model was calibrated at another time.",
        Calibrated::Now => "The model was calibrated just before, on other numbers of discs and densities.",
    };
    let notes = vec![
        format!(
            "Host model: {}, {}; the machine was {} when it was calibrated. {from}",
            data.host, data.instruction_set, data.state
        ),
        format!(
            "Measured: the middle of the samples of {} rounds, as runs time themselves. Halves: how far every second sample and the \
             others lie apart. Baseline: operations times elements, at the cost of a sum in the cache.",
            data.rounds
        ),
        "Fast and lists: predicted from the numbers of candidates and contacts that the run itself had.".to_owned(),
        "The model is a sum: start-ups, operations and bytes, none of which hides behind another. It cannot be right where computing and \
         waiting overlap, where branches depend on the data (a list's candidates are charged alike, near or far), where what is met \
         again is nearer than all that its program goes over, where pages are large (its levels know no translation of addresses), and \
         where threads share a core or its frequency changes."
            .to_owned(),
    ];
    Table {
        name: "errors".into(),
        title: "Errors of the predictions".into(),
        columns: headings(&[
            "cases of",
            "cases",
            "median (%)",
            "90 % below (%)",
            "worst (%)",
            "baseline (%)",
            "halves differ (%)",
        ]),
        rows: rows.collect(),
        notes,
    }
}

fn worst(data: &ModelValidation) -> Table {
    let rows = data.worst().into_iter().take(NAMED).map(|case| {
        vec![
            Cell::Text(case.name()),
            Cell::Number(case.predicted, 0),
            Cell::Number(case.measured, 0),
            Cell::Number(100.0 * (case.predicted / case.measured - 1.0), 1),
        ]
    });
    Table {
        name: "worst".into(),
        title: "The worst cases".into(),
        columns: headings(&["case", "predicted (ns)", "measured (ns)", "error (%)"]),
        rows: rows.collect(),
        notes: vec![],
    }
}

/// The names of the executions, in the order in which they were run.
fn executions(data: &ModelValidation) -> Vec<&'static str> {
    let mut names = vec![];
    for case in &data.cases {
        if !names.contains(&case.execution) {
            names.push(case.execution);
        }
    }
    names
}

/// Phases and laws, by execution.
fn over_predicted(data: &ModelValidation) -> Figure {
    let series = executions(data).into_iter().enumerate().map(|(hue, execution)| {
        let cases = data.cases.iter().filter(|case| case.execution == execution && case.phase != STEP);
        let points = cases.map(|case| Point::at(1e-3 * case.predicted, case.measured / case.predicted));
        Series { name: execution.into(), style: Style::Points, hue, points: points.collect() }
    });
    Figure {
        name: "measured_over_predicted".into(),
        title: "Measured over predicted".into(),
        caption: "Each point is a phase of a step of one run, or a program. 1 is right. Grounds: within 5 % and within 15 %.".into(),
        picture: Picture::Chart(Chart {
            x: Axis::logarithmic("predicted time", Some("µs")),
            y: Axis::logarithmic("measured over predicted", None),
            series: series.collect(),
            bands: vec![
                Band::of_y("within 15 %", [1.0 / 1.15, 1.15]),
                Band::of_y("within 5 %", [1.0 / 1.05, 1.05]),
            ],
        }),
    }
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
            Point::at(centre, count as f64)
        });
        Series { name: name.into(), style: Style::Steps, hue, points: points.collect() }
    });
    Figure {
        name: "histogram".into(),
        title: "Errors of the predictions".into(),
        caption: "Cases in bins of 2.5 %; negative: predicted too short. The outermost bins hold all beyond."
            .into(),
        picture: Picture::Chart(Chart {
            x: Axis::linear("predicted over measured - 1", Some("%")),
            y: Axis::linear("cases", None),
            series: series.collect(),
            bands: vec![],
        }),
    }
}
