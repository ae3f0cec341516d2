//! Templates are filled from frames, and errors name missing parts.

use super::*;
use crate::frame::FrameBuilder;
use crate::report::figure::{Chart, ChartAxis, Figure};

const TEMPLATE: &str = r#"+++
title = "Errors"
chapter = "host"
cost = { full = 1.0 }
question = "How large in {{ errors|length }} runs?"
expected = "Small."

[[figure]]
name = "over-steps"
title = "Error over steps"
caption = "Worst {{ errors.column('error')|max|digits(2) }}."
x = { label = "steps", log = true }
y = { label = "error", unit = "J" }
series = [{ from = "errors", x = "steps", y = "error", error = "error / 2", by = "scheme", style = "Joined", sorted = true }]
band = [{ label = "small", y = [0, "errors.at(scheme='a', steps=1).error"] }]

[[table]]
from = "errors"
columns = ["error", "scheme"]
notes = ["All {{ errors|length }}."]
+++
The first error is {{ errors[0].error|fixed(2) }}.

More
words.
"#;

fn frames() -> [ResultFrame; 1] {
    let frame = FrameBuilder::of([("a", 2u64, 0.5), ("b", 4, 0.25), ("a", 1, 1.0)])
        .text("scheme", |it| it.0)
        .count("steps", |it| it.1)
        .number("error", 2, |it| it.2)
        .frame("errors", "Errors");
    [frame]
}

fn filled(template: &str) -> Result<Section, String> {
    let frames = frames();
    let shown = Shown { frames: &frames, pictures: &[], film: None, files: &[], seeds: &[1] };
    let page = Page::read("x", template.to_owned()).map_err(|cause| cause.to_string())?;
    page.section(&shown, &[], "2026-11-26").map_err(|cause| cause.to_string())
}

fn chart_of(figure: &Figure) -> &Chart {
    let Picture::Charts(panels) = &figure.picture else { panic!("{figure:?}") };
    &panels[0].1
}

#[test]
fn a_page_is_filled_from_frames() {
    let section = filled(TEMPLATE).unwrap();
    assert_eq!(section.question, "How large in 3 runs?");
    assert_eq!([section.answer.as_str(), &section.details[0]], ["The first error is 0.50.", "More words."]);
    let figure = &section.figures[0];
    assert_eq!(figure.caption, "Worst 1.");
    let chart = chart_of(figure);
    let [a, b] = chart.series.as_slice() else { panic!("{chart:?}") };
    assert_eq!((a.name.as_str(), a.hue, b.name.as_str(), b.hue), ("a", 0, "b", 1));
    assert_eq!(a.points.iter().map(|it| it.x).collect::<Vec<_>>(), [1.0, 2.0]);
    assert_eq!(a.points[1].spread, Some([0.25, 0.75]));
    assert_eq!(chart.bands[0].ends, [0.0, 1.0]);
    let table = &section.tables[0];
    assert_eq!(table.columns, ["error", "scheme"]);
    assert_eq!(table.notes, ["All 3."]);
}

/// Words as coordinates are names on the axis, from the left or from above.
#[test]
fn words_are_names_on_an_axis() {
    let chart = |x: &str, y: &str| {
        let template = TEMPLATE.replace(
            "x = \"steps\", y = \"error\", error = \"error / 2\", by = \"scheme\"",
            &format!("x = \"{x}\", y = \"{y}\", spread = [\"steps\", \"2 * steps\"]"),
        );
        let section =
            filled(&template.replace(", unit = \"J\" }\nseries", " }\nseries").replace("band = ", "#"))
                .unwrap();
        let chart = chart_of(&section.figures[0]).clone();
        crate::report::figure::svg(&chart.clone().figure("x", "X")).unwrap();
        chart
    };
    let across = chart("scheme", "error");
    assert_eq!(across.x, ChartAxis::names("steps", ["a", "b"]));
    assert_eq!(across.series[0].points.iter().map(|it| it.x).collect::<Vec<_>>(), [0.0, 0.0, 1.0]);
    let down = chart("steps", "scheme");
    assert_eq!(down.y, ChartAxis::names("error", ["b", "a"]));
    let points: Vec<_> = down.series[0].points.iter().map(|it| (it.x, it.y, it.spread)).collect();
    let expected = [(1.0, 1.0), (2.0, 1.0), (4.0, 0.0)].map(|(x, y)| (x, y, Some([x, 2.0 * x])));
    assert_eq!(points, expected);
}

/// A figure is repeated for each element of a list, which its texts and expressions call `it`.
#[test]
fn a_figure_is_repeated() {
    let each = "name = \"over-steps-{{ it }}\"\neach = \"['a', 'b']\"";
    let template = TEMPLATE.replace("name = \"over-steps\"", each);
    let template = template.replace("x = \"steps\"", "only = \"scheme == it\", x = \"steps\"");
    let section = filled(&template.replace("log = true", "log = \"it == 'b'\"")).unwrap();
    let [a, b] = section.figures.as_slice() else { panic!("{:?}", section.figures) };
    assert_eq!([&a.name, &b.name], ["over-steps-a", "over-steps-b"]);
    let [a, b] = [a, b].map(chart_of);
    assert_eq!((a.series.len(), a.series[0].points.len(), b.series[0].points.len()), (1, 2, 1));
    assert_ne!(a.x.scale, b.x.scale);
}

/// Coordinates of a map are rising numbers, or words in the order of the rows; a point without a row is empty.
#[test]
fn a_map_has_a_cell_for_each_row() {
    let map = "map = { from = \"errors\", x = \"steps\", y = \"scheme\", value = \"error\", shade = { label = \"error\" } }";
    let from = TEMPLATE.find("series = [").unwrap();
    let to = TEMPLATE.find("\n[[table]]").unwrap();
    let section = filled(&TEMPLATE.replace(&TEMPLATE[from..to], &format!("{map}\n"))).unwrap();
    let Picture::Map(map) = &section.figures[0].picture else { panic!("no map") };
    assert_eq!(map.y, ChartAxis::names("error", ["a", "b"]));
    assert_eq!(map.rows[0][..2], [1.0, 0.5]);
    assert!(map.rows[0][2].is_nan() && map.rows[1][2] == 0.25);
}

/// Panels for the elements of a list, with a line for each row of a table.
#[test]
fn a_chart_has_panels_and_lines() {
    let panels = "name = \"over-steps\"\npanels = \"['a', 'b']\"\npanel = \"scheme {{ it }}\"";
    let template = TEMPLATE.replace("name = \"over-steps\"", panels);
    let template = template.replace("x = \"steps\"", "only = \"scheme == it\", x = \"steps\"");
    let lines =
        "band = [{ each = \"errors\", label = \"{{ it.steps }}\", x = [\"it.steps\", \"it.steps\"] }]";
    let (before, after) = template.split_once("band = ").unwrap();
    let (_, after) = after.split_once('\n').unwrap();
    let section = filled(&format!("{before}{lines}\n{after}")).unwrap();
    let Picture::Charts(panels) = &section.figures[0].picture else { panic!("{:?}", section.figures) };
    let [(a, of_a), (b, of_b)] = panels.as_slice() else { panic!("{panels:?}") };
    assert_eq!([a, b], ["scheme a", "scheme b"]);
    assert_eq!([&of_a.series[0].points, &of_b.series[0].points].map(Vec::len), [2, 1]);
    assert_eq!(of_b.bands.iter().map(|it| it.ends[0]).collect::<Vec<_>>(), [2.0, 4.0, 1.0]);
}

#[test]
fn template_errors_name_line_and_alternatives() {
    for (from, to, line, named) in [
        ("errors[0].error", "errors[0].eror", 22, "it has scheme, steps, error"),
        ("errors|length }} runs", "erors|length }} runs", 5, "errors"),
        ("y = \"error\"", "y = \"eror\"", 14, "it has scheme, steps, error"),
        ("from = \"errors\"\ncol", "from = \"error\"\ncol", 18, "there are errors"),
        ("columns = [\"error\"", "columns = [\"err\"", 19, "it has scheme, steps, error"),
        ("style = \"Joined\"", "style = \"line up\"", 14, "Joined"),
        ("question", "qestion", 5, "qestion"),
        ("x = { label = \"steps\", log = true }\n", "", 9, "drew no picture `over-steps`"),
    ] {
        let said = filled(&TEMPLATE.replacen(from, to, 1)).unwrap_err();
        assert!(said.starts_with(&format!("pages/x.md:{line}:")), "{from}: {said}");
        assert!(said.contains(named), "{from}: {said}");
    }
}

/// Every template of the folder can be read.
#[test]
fn templates_are_understood() {
    for file in PageFiles::iter() {
        let name = file.strip_suffix(".md").unwrap();
        Page::of(name).unwrap().unwrap();
    }
}
