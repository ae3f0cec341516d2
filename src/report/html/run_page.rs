//! Page of a run: its numbers, all pictures and the film in one file, for the screen and for print.

use super::inline::Inline;
use super::item::{data_table, heading};
use super::words::prose;
use super::{SCRIPTS, compact_script, dark_picture_rules, film, head};
use crate::report::FormattedTable;
use crate::report::figure::{Figure, data_file};
use crate::report::section::Film;
use maud::{DOCTYPE, PreEscaped, html};
use std::collections::BTreeSet;

/// Contents of the page.
pub(crate) struct RunPage<'r> {
    /// Name of the run.
    pub(crate) title: String,
    /// Numbers of the observables.
    pub(crate) numbers: FormattedTable,
    /// Figures, each with its SVG and the name of its files without extension.
    pub(crate) pictures: Vec<(&'r Figure, &'r str, &'r str)>,
    /// Film, or the reason why there is none; and notes for its viewer.
    pub(crate) film: Result<&'r Film, String>,
    pub(crate) notes: &'r [String],
    /// The scene as TOML.
    pub(crate) scene: Option<String>,
}

/// Renders the page of a run. It loads nothing.
pub(crate) fn run_page(page: &RunPage<'_>) -> String {
    let RunPage { title, numbers, pictures, film, notes, scene } = page;
    let inline: Vec<Inline> = pictures.iter().map(|(_, svg, _)| Inline::new(svg)).collect();
    let markers: BTreeSet<&str> = inline.iter().flat_map(Inline::definitions).collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                (head(&html! { title { (title) } }))
                style { (PreEscaped(dark_picture_rules())) }
            }
            body {
                nav.contents aria-label="Contents" {
                    p { (title) }
                    ol {
                        li { a href="#numbers" { (numbers.title) } }
                        @if film.is_ok() { li { a href="#film" { "Film" } } }
                        @for (figure, _, file) in pictures { li { a href={ "#" (file) } { (figure.title) } } }
                    }
                }
                svg.markers aria-hidden="true" {
                    @for marker in &markers { (PreEscaped(marker)) }
                }
                main {
                    h1 { (title) }
                    section #numbers {
                        (data_table(numbers, usize::MAX))
                        @for note in &numbers.notes { p.note { (note) } }
                    }
                    @match film {
                        Ok(shown) => section #film {
                            figure {
                                (film::film_element(shown, &html! {}))
                                figcaption { (heading(&shown.title)) @for note in *notes { " " (note) } }
                            }
                        },
                        Err(why) => p.note { "No film: " (why) },
                    }
                    @for ((figure, _, file), picture) in pictures.iter().zip(&inline) {
                        section id=(file) {
                            figure {
                                div.picture {
                                    (picture.element(&format!("{file}-picture"), &format!("{file}-caption"), data_file(figure).is_some()))
                                }
                                figcaption id={ (file) "-caption" } {
                                    (heading(&figure.title)) " " (prose(&figure.caption)) " "
                                    a href={ (file) ".svg" } { "SVG" } ", " a href={ (file) ".png" } { "PNG" } "."
                                }
                            }
                        }
                    }
                    @if let Some(scene) = scene {
                        details { summary { "The scene" } pre tabindex="0" { (scene) } }
                    }
                }
                (film::json_element("shades", &film::shades()))
                @for script in SCRIPTS {
                    script { (PreEscaped(compact_script(script))) }
                }
            }
        }
    };
    page.into_string()
}
