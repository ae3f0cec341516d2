//! What must hold for every picture.

use super::super::sheet::{Mark, Sheet};
use super::super::{Axis, Chart, Drawing, Fault, Figure, Map, Picture, Point, Scale, Style, font, samples};
use super::sheet;

/// Left, upper, right and lower end of every line of words.
fn words(sheet: &Sheet) -> Vec<(String, [f64; 4])> {
    fn of(marks: &[Mark], all: &mut Vec<(String, [f64; 4])>) {
        for mark in marks {
            match mark {
                Mark::Window { marks, .. } => of(marks, all),
                Mark::Words { at: [x, y], anchor, upwards, size, words, .. } => {
                    let width = font::width(words, *size);
                    let [start, end] = [0.0, 1.0].map(|part| (part - anchor.part_before()) * width);
                    let [over, under] = [font::CAPITAL * size, font::DESCENT * size];
                    let extent = if *upwards {
                        [x - over, y - end, x + under, y - start]
                    } else {
                        [x + start, y - over, x + end, y + under]
                    };
                    all.push((words.clone(), extent));
                }
                _ => {}
            }
        }
    }
    let mut all = Vec::new();
    of(&sheet.marks, &mut all);
    all
}

/// The outline of the axes: the only closed lines without a filling and with four corners that are upright.
fn plot(sheet: &Sheet) -> [f64; 4] {
    let outline = sheet.marks.iter().find_map(|mark| match mark {
        Mark::Lines { pieces, closed: true, paint } if paint.fill.is_none() => Some(&pieces[0]),
        _ => None,
    });
    let corners = outline.unwrap();
    [corners[0][0], corners[0][1], corners[2][0], corners[2][1]]
}

fn apart(a: [f64; 4], b: [f64; 4]) -> bool {
    a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1]
}

fn chart_of(picture: &mut Picture) -> &mut Chart {
    match picture {
        Picture::Chart(chart) => chart,
        _ => unreachable!(),
    }
}

/// The samples, and charts that press for room.
fn pressing() -> Vec<Figure> {
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
fn all_words_are_on_the_sheet_and_none_upon_others() {
    for figure in pressing() {
        let sheet = sheet(&figure).unwrap();
        let all = words(&sheet);
        for (i, (words, extent)) in all.iter().enumerate() {
            let [left, top, right, bottom] = *extent;
            assert!(left >= 0.0 && top >= 0.0, "{}: {words} {extent:?}", figure.name);
            assert!(right <= sheet.width && bottom <= sheet.height, "{}: {words} {extent:?}", figure.name);
            for (others, other) in &all[..i] {
                assert!(apart(*extent, *other), "{}: {words} upon {others}", figure.name);
            }
        }
    }
}

#[test]
fn no_words_lie_on_the_data() {
    for figure in pressing() {
        if matches!(figure.picture, Picture::Drawing(_)) {
            continue;
        }
        let sheet = sheet(&figure).unwrap();
        for (words, extent) in words(&sheet) {
            assert!(apart(extent, plot(&sheet)), "{}: {words}", figure.name);
        }
    }
}

#[test]
fn a_very_small_value_is_drawn_where_it_must_be() {
    let mut figure = samples::logarithmic();
    let drawn = chart_of(&mut figure.picture);
    drawn.bands.clear();
    drawn.series.truncate(1);
    drawn.series[0].style = Style::Points;
    drawn.series[0].points = vec![Point::at(10.0, 1e-14)];
    drawn.x.limits = Some([1.0, 1000.0]);
    drawn.y.limits = Some([1e-16, 1e-8]);
    let sheet = sheet(&figure).unwrap();
    let [left, top, right, bottom] = plot(&sheet);
    let is_it = |mark: &Mark| match mark {
        Mark::Disc { centre: [x, y], .. } => {
            (x - (left + (right - left) / 3.0)).abs() < 1e-9
                && (y - (bottom - (bottom - top) / 4.0)).abs() < 1e-9
        }
        _ => false,
    };
    assert_eq!(sheet.marks.iter().filter(|mark| is_it(mark)).count(), 1);
}

#[test]
fn data_outside_of_given_limits_stay_out_of_the_picture() {
    let mut figure = samples::logarithmic();
    let drawn = chart_of(&mut figure.picture);
    drawn.x.limits = Some([10.0, 1000.0]);
    drawn.y.limits = Some([1e-7, 1e-6]);
    drawn.series.iter_mut().for_each(|series| series.points.push(Point::at(1e300, 1e-300)));
    let sheet = sheet(&figure).unwrap();
    for mark in &sheet.marks {
        let Mark::Lines { pieces, .. } = mark else { continue };
        for [x, y] in pieces.iter().flatten() {
            assert!((0.0..=sheet.width).contains(x) && (0.0..=sheet.height).contains(y), "{mark:?}");
        }
    }
}

#[test]
fn a_lone_point_of_a_line_is_seen() {
    let mut figure = samples::linear();
    let drawn = chart_of(&mut figure.picture);
    drawn.series.truncate(1);
    drawn.series[0].points.truncate(1);
    let is_disc = |mark: &Mark| matches!(mark, Mark::Disc { .. });
    assert_eq!(sheet(&figure).unwrap().marks.iter().filter(|mark| is_disc(mark)).count(), 1);
}

#[test]
fn a_narrow_bar_still_says_what_its_ends_mean() {
    let mut figure = samples::pipe();
    if let Picture::Drawing(drawing) = &mut figure.picture {
        drawing.width = 160.0;
    }
    let words: Vec<_> = words(&sheet(&figure).unwrap()).into_iter().map(|(words, _)| words).collect();
    assert!(words.contains(&"−40".to_owned()) && words.contains(&"40".to_owned()), "{words:?}");
}

#[test]
fn a_drawing_is_not_distorted() {
    for figure in [samples::pipe(), samples::long_pipe(), samples::mask()] {
        let Picture::Drawing(drawing) = &figure.picture else { unreachable!() };
        let sheet = sheet(&figure).unwrap();
        let window = sheet.marks.iter().find_map(|mark| match mark {
            Mark::Window { area, .. } => Some(area),
            _ => None,
        });
        let [[left, low], [right, high]] = drawing.window;
        let shape = window.unwrap();
        // The rim about the window is less than two pixels for each 900 of the width.
        let rim = 2.0 * (drawing.width / 900.0).max(1.0);
        assert!((shape.height - shape.width * (high - low) / (right - left)).abs() < rim, "{}", figure.name);
        assert!(sheet.width == drawing.width);
    }
}

#[test]
fn faults_are_named() {
    let fault = |mut figure: Figure, spoil: fn(&mut Picture)| {
        spoil(&mut figure.picture);
        let error = sheet(&figure).unwrap_err();
        assert_eq!(error.figure, figure.name);
        error.to_string()
    };
    let of_chart = |spoil: fn(&mut Picture)| fault(samples::logarithmic(), spoil);
    assert_eq!(
        of_chart(|picture| chart_of(picture).series[1].points[2].y = f64::NAN),
        "figure `logarithmic`: y of point 2 of `CRAY's way, measured` is NaN, which is not finite"
    );
    assert_eq!(
        of_chart(|picture| chart_of(picture).series[1].points[2].x = 0.0),
        "figure `logarithmic`: x of point 2 of `CRAY's way, measured` is 0, but its axis is logarithmic"
    );
    assert!(
        of_chart(|picture| chart_of(picture).series[1].points[0].spread = Some([-1.0, 1.0]))
            .contains("spread")
    );
    assert!(of_chart(|picture| chart_of(picture).series.clear()).ends_with("there is nothing in it"));
    assert!(of_chart(|picture| chart_of(picture).bands[0].ends = [2.0, 1.0]).contains("from 2 to 1"));
    assert!(of_chart(|picture| chart_of(picture).x.limits = Some([-1.0, 1.0])).contains("logarithmic"));

    let of_map = |spoil: fn(&mut Map)| {
        let mut figure = samples::map();
        if let Picture::Map(map) = &mut figure.picture {
            spoil(map);
        }
        sheet(&figure).unwrap_err().fault
    };
    assert_eq!(of_map(|map| map.y.limits = None), Fault::NoLimits { axis: "Time".into() });
    assert_eq!(
        of_map(|map| map.rows[3].truncate(119)),
        Fault::UnevenRows { row: 3, expected: 120, found: 119 }
    );
    assert_eq!(of_map(|map| map.rows.clear()), Fault::Empty);
    assert!(matches!(of_map(|map| map.rows[0][0] = f64::INFINITY), Fault::NotFinite { .. }));
    assert!(matches!(
        of_map(|map| {
            map.value = Axis { scale: Scale::Logarithmic, ..map.value.clone() };
            map.rows[0][0] = 0.0;
        }),
        Fault::NotPositive { .. }
    ));

    let of_drawing = |spoil: fn(&mut Drawing)| {
        let mut figure = samples::pipe();
        if let Picture::Drawing(drawing) = &mut figure.picture {
            spoil(drawing);
        }
        sheet(&figure).unwrap_err().fault
    };
    assert!(matches!(of_drawing(|drawing| drawing.width = 1.0), Fault::Size { .. }));
    assert!(matches!(of_drawing(|drawing| drawing.window[1][1] = -9.0), Fault::NotAnInterval { .. }));
    assert!(matches!(of_drawing(|drawing| drawing.window[0][0] = f64::NAN), Fault::NotAnInterval { .. }));
}
