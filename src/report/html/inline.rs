//! SVG pictures as inline parts of a page.

use maud::{Markup, PreEscaped, html};

/// Width from which a picture scrolls on a narrower page instead of becoming illegibly small (pixels).
const WIDE: f64 = 700.0;

/// Parts of a picture.
pub(crate) struct Inline {
    size: String,
    definitions: String,
    body: String,
}

impl Inline {
    /// Splits one of our SVG files, which has one element per line. Title and description are removed: they are printed below the picture, and
    /// a browser would show the title as a tooltip everywhere. A missing file gives an empty picture.
    pub(super) fn new(svg: &str) -> Inline {
        let between = |start: &str, end: &str| {
            svg.split_once(start).and_then(|(_, rest)| rest.split_once(end)).map_or("", |(part, _)| part)
        };
        let body = svg.split_once("</desc>\n").map_or("", |(_, rest)| rest);
        let body = body.split_once("</defs>\n").map_or(body, |(_, rest)| rest);
        Inline {
            size: between("viewBox=\"", "\"").to_owned(),
            definitions: between("<defs>\n", "</defs>").to_owned(),
            body: compact_paths(body.trim_end().trim_end_matches("</svg>")),
        }
    }

    /// Repeats the picture of the element `id`, scaled to the available width.
    pub(crate) fn reused_picture(&self, id: &str, title: &str) -> Markup {
        let sides: Vec<&str> = self.size.split(' ').skip(2).collect();
        let [width, height] = [0, 1].map(|at| sides.get(at).copied().unwrap_or("0"));
        html! {
            svg viewBox=(self.size) role="img" aria-label=(title) {
                use href={ "#" (id) } width=(width) height=(height) {}
            }
        }
    }

    /// Definitions used by the picture, one per line.
    pub(crate) fn definitions(&self) -> impl Iterator<Item = &str> {
        self.definitions.lines()
    }

    /// Element of the picture, described by another element. `is_read` is true if the page's script reads values from it.
    pub(crate) fn element(&self, id: &str, described_by: &str, is_read: bool) -> Markup {
        let width: f64 = self.size.split(' ').nth(2).and_then(|width| width.parse().ok()).unwrap_or(0.0);
        html! {
            svg id=(id) class=(if width >= WIDE { "drawn wide" } else { "drawn" }) viewBox=(self.size) width=(width) role="img" aria-labelledby=(described_by) tabindex=[(is_read || width >= WIDE).then_some(0)] {
                (PreEscaped(&self.body))
            }
        }
    }
}

/// Joins all lines, and removes blanks before minus signs in the data of paths, where the sign already separates numbers. Thousands of discs
/// are drawn as relative steps.
fn compact_paths(body: &str) -> String {
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
    use super::compact_paths;

    #[test]
    fn only_path_data_is_compacted() {
        let body =
            "<path fill=\"none\" d=\"M1 -2h1m-3 -4h1\"/><text x=\"1\">a - b -c</text><path d=\"M0 0\"/>";
        let expected =
            "<path fill=\"none\" d=\"M1-2h1m-3-4h1\"/><text x=\"1\">a - b -c</text><path d=\"M0 0\"/>";
        assert_eq!(compact_paths(body), expected);
    }
}
