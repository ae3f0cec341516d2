//! Data of a film for the player.

use super::quantised::Quantised;
use crate::report::figure::style;
use crate::report::section::{Film, FilmFrame};
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

/// Element with JSON data that cannot be interpreted as a script or style: in JSON, `<` only occurs in strings.
pub(crate) fn json_element(id: &str, data: &Value) -> Markup {
    let text = data.to_string().replace('<', "\\u003c");
    html! { script type="application/json" id=[Some(id).filter(|id| !id.is_empty())] { (PreEscaped(text)) } }
}

/// Element for the player of a film; `instead` is shown without JavaScript.
pub(crate) fn film_element(film: &Film, instead: &Markup) -> Markup {
    html! {
        div.film data-label=(film.title) {
            (json_element("", &data(film)))
            noscript { p { "The film needs JavaScript. " (instead) } }
        }
    }
}

/// Colours of magnitudes and of signed quantities, from the lowest to the highest.
pub(crate) fn shades() -> Value {
    let colours =
        |signed| style::levels(signed).map(|level| style::shade(level).to_string()).collect::<Vec<_>>();
    json!([colours(false), colours(true)])
}

/// Ratio of length to width above which a window is cut into strips.
const LONG: f64 = 6.0;

/// Maximum pixels along a film: six strips on a screen with two dots per pixel.
const PIXELS: f64 = 6.0 * 2200.0;

/// Data of a film, with all frames of a quantity in one array. Every frame has an entry for each radius; it is NaN for an absent disc.
pub(crate) fn data(film: &Film) -> Value {
    let Film { units, window, sides, falls, radii, fixed, frames, shade, shades, .. } = film;
    let still =
        |number: fn(&([f64; 2], f64)) -> f64| Quantised::of(&fixed.iter().map(number).collect::<Vec<_>>());
    let [width, height] = [window[1][0] - window[0][0], window[1][1] - window[0][1]];
    let half_a_pixel = 0.5 * width.max(height) / PIXELS;
    let half_a_shade = 0.5 * (shades[1] - shades[0]) / f64::from(style::SHADES);
    let mut data = json!({
        "units": units,
        "window": window,
        "sides": sides,
        "falls": falls,
        "long": width > LONG * height || height > LONG * width,
        "shade": { "label": shade, "ends": shades },
        "radii": Quantised::of(radii),
        "fixed": { "x": still(|disc| disc.0[0]), "y": still(|disc| disc.0[1]), "radii": still(|disc| disc.1) },
        "times": frames.iter().map(|frame| frame.time).collect::<Vec<_>>(),
        "x": column(film, |disc| disc.0[0], half_a_pixel),
        "y": column(film, |disc| disc.0[1], half_a_pixel),
        // Shades beyond an end look like the end.
        "shades": column(film, |disc| disc.1.clamp(shades[0], shades[1]), half_a_shade),
    });
    if frames.iter().any(|frame| !frame.walls.is_empty()) {
        let walls = frames.iter().map(|frame| rounded(&frame.walls, half_a_pixel));
        data["walls"] = json!(walls.collect::<Vec<_>>());
    }
    data
}

/// Ends of walls, rounded to a step (length).
fn rounded(walls: &[[[f64; 2]; 2]], step: f64) -> Vec<[[f64; 2]; 2]> {
    // Half a power of ten keeps the decimals few.
    let step = 10f64.powf(step.log10().floor());
    walls.iter().map(|ends| ends.map(|end| end.map(|at| (at / step).round() * step))).collect()
}

/// Encodes a number of every disc in every frame with an error of at most `tolerance`, if two bytes suffice.
fn column(film: &Film, number: impl Fn(&([f64; 2], f64)) -> f64, tolerance: f64) -> Quantised {
    let of_frame = |frame: &FilmFrame| -> Vec<f64> {
        (0..film.radii.len()).map(|i| frame.discs.get(i).map_or(f64::NAN, &number)).collect()
    };
    Quantised::within(&film.frames.iter().flat_map(of_frame).collect::<Vec<_>>(), tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pipe(frames: usize, discs: usize) -> Film {
        let place = |frame: usize, disc: usize| {
            let turn = (disc * 7919 + frame * 31) as f64 * 0.618;
            ([8.1 * turn.fract(), 0.055 * (turn * 1.7).fract() - 0.0275], 3.0 * (turn * 0.3).fract())
        };
        Film {
            title: "Grains".to_owned(),
            units: ["m", "s"].map(str::to_owned),
            window: [[0.0, -0.0275], [8.1, 0.0275]],
            sides: vec![],
            falls: true,
            radii: (0..discs).map(|disc| 0.01 + 1e-5 * disc as f64).collect(),
            fixed: (0..600).map(|i| ([0.027 * f64::from(i / 2), 0.0275], 0.009)).collect(),
            frames: (0..frames)
                .map(|frame| FilmFrame {
                    time: 0.05 * frame as f64,
                    walls: vec![],
                    discs: (0..discs).map(|disc| place(frame, disc)).collect(),
                })
                .collect(),
            shade: "speed (m/s)".to_owned(),
            shades: [0.0, 3.0],
        }
    }

    fn read(value: &Value) -> Vec<f64> {
        let quantised = serde_json::from_value(value.clone()).unwrap();
        super::super::quantised::tests::read(&quantised)
    }

    #[test]
    fn positions_are_recovered_within_half_a_pixel() {
        let film = pipe(40, 300);
        let data = data(&film);
        let (x, y) = (read(&data["x"]), read(&data["y"]));
        let pixel = 8.1 / PIXELS;
        for (i, disc) in film.frames.iter().flat_map(|frame| &frame.discs).enumerate() {
            assert!((disc.0[0] - x[i]).abs() < 0.5 * pixel, "x of disc {i}");
            assert!((disc.0[1] - y[i]).abs() < 0.5 * pixel, "y of disc {i}");
        }
    }

    #[test]
    fn forty_frames_of_six_hundred_discs_are_small() {
        let letters = data(&pipe(40, 600)).to_string().len();
        assert!(letters < 200_000, "{letters} bytes");
    }

    #[test]
    fn an_absent_disc_is_nan() {
        let mut film = pipe(2, 3);
        film.frames[0].discs.truncate(2);
        let x = read(&data(&film)["x"]);
        assert_eq!(x.len(), 6);
        assert!(x[2].is_nan() && x[5].is_finite());
    }

    #[test]
    fn film_data_cannot_end_their_element() {
        let text = json_element("x", &json!({ "name": "</script><script>alert(1)</script>", "less": "a<b" }))
            .into_string();
        assert_eq!(text.matches("</script").count(), 1, "{text}");
        assert!(text.contains("\\u003c/script>"));
    }

    #[test]
    fn only_long_windows_are_cut_into_strips() {
        let mut film = pipe(1, 1);
        assert_eq!(data(&film)["long"], true);
        film.window = [[0.0, 0.0], [2.0, 1.0]];
        assert_eq!(data(&film)["long"], false);
    }
}
