//! A picture's file as a part of a page.

use maud::{Markup, PreEscaped, html};

/// Where a page is narrower than such a picture, it scrolls rather than become too small to be read (pixels).
const WIDE: f64 = 700.0;

/// A picture cut to its parts.
pub(crate) struct Inline {
    size: String,
    definitions: String,
    body: String,
}

impl Inline {
    /// The parts of a picture as our files have it: an element a line. Title and description are left out, for they stand below the
    /// picture, and a browser would show the title wherever one points. A picture that is not there is empty.
    pub(super) fn new(svg: &str) -> Inline {
        let between = |start: &str, end: &str| {
            svg.split_once(start).and_then(|(_, rest)| rest.split_once(end)).map_or("", |(part, _)| part)
        };
        let body = svg.split_once("</desc>\n").map_or("", |(_, rest)| rest);
        let body = body.split_once("</defs>\n").map_or(body, |(_, rest)| rest);
        Inline {
            size: between("viewBox=\"", "\"").to_owned(),
            definitions: between("<defs>\n", "</defs>").to_owned(),
            body: tight(body.trim_end().trim_end_matches("</svg>")),
        }
    }

    /// The picture of an element of this id once more, as wide as there is room.
    pub(crate) fn again(&self, id: &str, title: &str) -> Markup {
        let sides: Vec<&str> = self.size.split(' ').skip(2).collect();
        let [width, height] = [0, 1].map(|at| sides.get(at).copied().unwrap_or("0"));
        html! {
            svg viewBox=(self.size) role="img" aria-label=(title) {
                use href={ "#" (id) } width=(width) height=(height) {}
            }
        }
    }

    /// What it uses by name, each in a line.
    pub(crate) fn definitions(&self) -> impl Iterator<Item = &str> {
        self.definitions.lines()
    }

    /// The picture, which an element of the page describes; `is_read` if the page's script tells values of it.
    pub(crate) fn element(&self, id: &str, described_by: &str, is_read: bool) -> Markup {
        let width: f64 = self.size.split(' ').nth(2).and_then(|width| width.parse().ok()).unwrap_or(0.0);
        html! {
            svg id=(id) class=[(width >= WIDE).then_some("wide")] viewBox=(self.size) width=(width) role="img" aria-labelledby=(described_by) tabindex=[is_read.then_some(0)] {
                (PreEscaped(&self.body))
            }
        }
    }
}

/// The same with no blank before a sign in the data of a path, where a sign begins a number as well: thousands of discs are drawn by
/// steps; and all in one line.
fn tight(body: &str) -> String {
    const DATA: &str = " d=\"";
    let mut paths = body.split(DATA);
    let mut all = paths.next().unwrap_or_default().to_owned();
    for path in paths {
        let (data, rest) = path.split_once('"').unwrap_or((path, ""));
        all.extend([DATA, &data.replace(" -", "-"), "\"", rest]);
    }
    all.replace(">\n<", "><")
}

#[cfg(test)]
mod tests {
    use super::tight;

    #[test]
    fn only_the_data_of_paths_is_tightened() {
        let body =
            "<path fill=\"none\" d=\"M1 -2h1m-3 -4h1\"/><text x=\"1\">a - b -c</text><path d=\"M0 0\"/>";
        let expected =
            "<path fill=\"none\" d=\"M1-2h1m-3-4h1\"/><text x=\"1\">a - b -c</text><path d=\"M0 0\"/>";
        assert_eq!(tight(body), expected);
    }
}
