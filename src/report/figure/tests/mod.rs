//! Properties of every picture, as rendered by `resvg`.

pub(crate) mod samples;

use super::output::tree;
use super::{Chart, ChartAxis, Drawing, Figure, HeatMap, Picture, Scale, SeriesPoint, Style, svg};
use resvg::usvg::{Group, Node};

/// Every line of words with its left, upper, right and lower end.
fn words(figure: &Figure) -> Vec<(String, [f32; 4])> {
    fn of(group: &Group, all: &mut Vec<(String, [f32; 4])>) {
        for node in group.children() {
            match node {
                Node::Group(group) => of(group, all),
                Node::Text(text) => {
                    let words = text.chunks().iter().map(|chunk| chunk.text()).collect();
                    let extent = text.abs_bounding_box();
                    all.push((words, [extent.left(), extent.top(), extent.right(), extent.bottom()]));
                }
                _ => {}
            }
        }
    }
    let mut all = Vec::new();
    of(tree(&svg(figure).unwrap()).unwrap().root(), &mut all);
    all
}

/// Boxes between the ends of the axes, or the window of a drawing.
fn plots(figure: &Figure) -> Vec<[f64; 4]> {
    let text = svg(figure).unwrap();
    let of = |part: &str| {
        let side = |name: &str| -> f64 {
            let rest = part.split_once(&format!(" {name}=\"")).unwrap().1;
            rest.split('"').next().unwrap().parse().unwrap()
        };
        let [x, y] = [side("x"), side("y")];
        [x, y, x + side("width"), y + side("height")]
    };
    text.split("<svg").skip(2).map(of).collect()
}

fn plot(figure: &Figure) -> [f64; 4] {
    plots(figure)[0]
}

/// Positions of the markers on the plane between the axes, as drawn by `resvg`.
fn marked(figure: &Figure) -> Vec<[f64; 2]> {
    fn of(group: &Group, all: &mut Vec<[f64; 2]>) {
        for node in group.children() {
            match node {
                Node::Group(group) => of(group, all),
                // Only markers are positioned by a translation.
                Node::Path(path) if path.abs_transform().tx > 1.0 => {
                    let at = path.abs_transform();
                    all.push([at.tx, at.ty].map(f64::from));
                }
                _ => {}
            }
        }
    }
    let mut all = Vec::new();
    of(tree(&svg(figure).unwrap()).unwrap().root(), &mut all);
    // Legend markers are below the plane; the marker of a single point is drawn at both ends of its line.
    let bottom = plot(figure)[3];
    all.retain(|[_, y]| *y <= bottom);
    all.dedup();
    all
}

fn apart(a: [f32; 4], b: [f32; 4]) -> bool {
    a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1]
}

fn chart_of(picture: &mut Picture) -> &mut Chart {
    match picture {
        Picture::Charts(panels) => &mut panels[0].1,
        _ => unreachable!(),
    }
}

/// Samples and crowded charts.
fn crowded_samples() -> Vec<Figure> {
    let mut all = samples::all();
    let mut crowded = samples::logarithmic();
    crowded.title =
        "A title that is much too long for one line of a picture of the usual width, and goes on".into();
    let many = chart_of(&mut crowded.picture);
    for i in 0..14 {
        let mut more = many.series[i % 6].clone();
        more.name = format!("series {i} whose name is long and has incomprehensibilities");
        more.hue = i;
        many.series.push(more);
    }
    many.y.label =
        "An axis with a heading that is longer than the axis itself, so that it needs two lines".into();
    all.push(crowded);
    let mut wide = samples::linear();
    chart_of(&mut wide.picture).series[0].name = "an_identifier_that_cannot_be_broken_anywhere_at_all".into();
    chart_of(&mut wide.picture).y.limits = Some([-123_456.75, 7e5]);
    all.push(wide);
    all
}

#[test]
fn words_are_on_the_picture_without_overlaps() {
    for figure in crowded_samples() {
        let size = tree(&svg(&figure).unwrap()).unwrap().size();
        let all = words(&figure);
        assert!(all.len() > 2, "{}", figure.name);
        for (i, (words, extent)) in all.iter().enumerate() {
            let [left, top, right, bottom] = *extent;
            let within = left >= 0.0 && top >= 0.0 && right <= size.width() && bottom <= size.height();
            assert!(within, "{}: {words} {extent:?} {size:?}", figure.name);
            for (others, other) in &all[..i] {
                assert!(apart(*extent, *other), "{}: {words} upon {others}", figure.name);
            }
        }
    }
}

#[test]
fn no_words_cover_the_data() {
    for figure in crowded_samples() {
        // Drawings and the cells of small maps contain words themselves.
        if matches!(figure.picture, Picture::Drawing(_)) || figure.name == "few-cells" {
            continue;
        }
        for plot in plots(&figure) {
            let plot = plot.map(|end| end as f32);
            for (words, extent) in words(&figure) {
                assert!(apart(extent, plot), "{}: {words}", figure.name);
            }
        }
    }
}

#[test]
fn very_small_values_are_drawn_correctly() {
    let mut figure = samples::logarithmic();
    let drawn = chart_of(&mut figure.picture);
    drawn.bands.clear();
    drawn.series.truncate(1);
    drawn.series[0].style = Style::Points;
    drawn.series[0].points = vec![SeriesPoint::at(10.0, 1e-14)];
    drawn.x.limits = Some([1.0, 1000.0]);
    drawn.y.limits = Some([1e-16, 1e-8]);
    let [left, top, right, bottom] = plot(&figure);
    let (x, y) = (left + (right - left) / 3.0, bottom - (bottom - top) / 4.0);
    let [[right, down]] = <[_; 1]>::try_from(marked(&figure)).unwrap();
    assert!((right - x).abs() < 0.01 && (down - y).abs() < 0.01, "{right} {down}");
    assert!(words(&figure).iter().any(|(words, _)| words == "10⁻¹⁴"));
}

#[test]
fn data_beyond_the_limits_are_clipped() {
    let mut figure = samples::logarithmic();
    let drawn = chart_of(&mut figure.picture);
    drawn.x.limits = Some([10.0, 1000.0]);
    drawn.y.limits = Some([1e-7, 1e-6]);
    drawn.series.iter_mut().for_each(|series| series.points.push(SeriesPoint::at(1e300, 1e-300)));
    // Curves may leave the window that clips them; markers may not, because half a marker is misleading.
    let [left, top, right, bottom] = plot(&figure);
    let all = marked(&figure);
    assert!(!all.is_empty());
    assert!(all.iter().all(|[x, y]| (left..=right).contains(x) && (top..=bottom).contains(y)), "{all:?}");
}

#[test]
fn single_points_of_lines_have_markers() {
    let mut figure = samples::linear();
    let drawn = chart_of(&mut figure.picture);
    drawn.series.truncate(1);
    drawn.series[0].points.truncate(1);
    drawn.bands.clear();
    assert_eq!(marked(&figure).len(), 1);
}

#[test]
fn a_narrow_colour_bar_labels_its_ends() {
    let mut figure = samples::pipe();
    if let Picture::Drawing(drawing) = &mut figure.picture {
        drawing.width = 160.0;
    }
    let words: Vec<_> = words(&figure).into_iter().map(|(words, _)| words).collect();
    assert!(words.contains(&"−40".to_owned()) && words.contains(&"40".to_owned()), "{words:?}");
}

#[test]
fn a_drawing_is_not_distorted() {
    for figure in [samples::pipe(), samples::long_pipe(), samples::mask()] {
        let Picture::Drawing(drawing) = &figure.picture else { unreachable!() };
        let [left, top, right, bottom] = plot(&figure);
        let [[west, south], [east, north]] = drawing.window;
        // The rim around the window is less than two pixels per 900 pixels of the width.
        let rim = 2.0 * (drawing.width / 900.0).max(1.0);
        let height = (right - left) * (north - south) / (east - west);
        assert!((bottom - top - height).abs() < rim, "{}", figure.name);
        assert!(svg(&figure).unwrap().contains(&format!(" width=\"{}\"", drawing.width)));
    }
}

#[test]
fn cells_are_drawn_at_their_positions() {
    let mut figure = samples::map();
    if let Picture::Map(map) = &mut figure.picture {
        map.rows = vec![vec![0.0, 0.0, 1.0], vec![1.0, 0.0, 0.0]];
    }
    let text = svg(&figure).unwrap();
    // The first row is the lowest.
    assert!(text.contains("d=\"M1 0h2m-3 1h2\"") && text.contains("d=\"M0 0h1m1 1h1\""), "{text}");
}

#[test]
fn error_messages_name_the_fault() {
    let fault = |mut figure: Figure, spoil: fn(&mut Picture)| {
        spoil(&mut figure.picture);
        let error = svg(&figure).unwrap_err();
        assert_eq!(error.figure, figure.name);
        error.to_string()
    };
    let of_chart = |spoil: fn(&mut Picture)| fault(samples::logarithmic(), spoil);
    assert_eq!(
        of_chart(|picture| chart_of(picture).series[1].points[2].y = f64::NAN),
        "figure `logarithmic`: y of point 2 of `CRAY's way, measured` is NaN; expected a finite number"
    );
    assert_eq!(
        of_chart(|picture| chart_of(picture).series[1].points[2].x = 0.0),
        "figure `logarithmic`: x of point 2 of `CRAY's way, measured` is 0, but a logarithmic axis needs positive numbers"
    );
    assert!(
        of_chart(|picture| chart_of(picture).series[1].points[0].spread = Some([-1.0, 1.0]))
            .contains("spread")
    );
    assert!(of_chart(|picture| chart_of(picture).series.clear()).ends_with("it has no data to draw"));
    assert!(of_chart(|picture| chart_of(picture).bands[0].ends = [2.0, 1.0]).contains("from 2 to 1"));
    assert!(of_chart(|picture| chart_of(picture).x.limits = Some([-1.0, 1.0])).contains("logarithmic"));

    let of_map = |spoil: fn(&mut HeatMap)| {
        let mut figure = samples::map();
        if let Picture::Map(map) = &mut figure.picture {
            spoil(map);
        }
        svg(&figure).unwrap_err().problem
    };
    assert_eq!(of_map(|map| map.y.limits = None), "the axis `Time` of a map has no limits; expected two");
    assert_eq!(
        of_map(|map| map.rows[3].truncate(119)),
        "row 3 has 119 values; expected 120 as in the previous rows"
    );
    assert_eq!(of_map(|map| map.rows.clear()), "it has no data to draw");
    assert!(of_map(|map| map.rows[0][0] = f64::INFINITY).ends_with("is inf; expected a finite number"));
    assert!(
        of_map(|map| map.x = ChartAxis::names("x", ["a", "b"]))
            .ends_with("has 2 names; expected one for each of 120 cells")
    );
    assert!(
        of_map(|map| {
            map.value = ChartAxis { scale: Scale::Logarithmic, ..map.value.clone() };
            map.rows[0][0] = 0.0;
        })
        .contains("logarithmic")
    );

    let of_drawing = |spoil: fn(&mut Drawing)| {
        let mut figure = samples::pipe();
        if let Picture::Drawing(drawing) = &mut figure.picture {
            spoil(drawing);
        }
        svg(&figure).unwrap_err().problem
    };
    assert!(of_drawing(|drawing| drawing.width = 1.0).starts_with("a picture of 1 by"));
    assert!(of_drawing(|drawing| drawing.window[1][1] = -9.0).contains("expected increasing ends"));
    assert!(of_drawing(|drawing| drawing.window[0][0] = f64::NAN).contains("expected increasing ends"));

    let of_panels = |spoil: fn(&mut Vec<(String, Chart)>)| {
        let mut figure = samples::panels();
        if let Picture::Charts(panels) = &mut figure.picture {
            spoil(panels);
        }
        svg(&figure).unwrap_err().problem
    };
    assert_eq!(of_panels(Vec::clear), "it has no data to draw");
    assert_eq!(
        of_panels(|panels| panels[1].1.x.unit = Some("m".into())),
        "the axes of panel `7×7` differ from those of the first panel"
    );
    let of_names = fault(samples::names(), |picture| chart_of(picture).series[0].points[0].x = 7.0);
    assert!(of_names.ends_with("x of point 0 of `measured` is 7, but its axis has 7 names"), "{of_names}");
}

#[test]
fn panels_share_axes_and_one_legend() {
    let figure = samples::panels();
    let all: Vec<String> = words(&figure).into_iter().map(|(words, _)| words).collect();
    for once in ["Time of a collision (µs)", "discs", "list and queue", "as it stands"] {
        assert_eq!(all.iter().filter(|words| *words == once).count(), 1, "{once}");
    }
    assert_eq!(all.iter().filter(|words| *words == "L2").count(), 3);
    let plots = plots(&figure);
    assert!(plots.len() == 3 && plots.windows(2).all(|pair| pair[0][1] == pair[1][1]), "{plots:?}");
}

#[test]
fn large_cells_show_their_values() {
    let of = |figure: &Figure| words(figure).iter().filter(|(words, _)| words == "5.2").count();
    assert_eq!(of(&samples::few_cells()), 2);
    assert_eq!(of(&samples::map()), 0);
}
