//! Report page as one HTML file with interactive charts and films. It loads nothing from elsewhere.

mod film;
mod film_page;
mod inline;
mod item;
mod quantised;
mod run_page;
mod words;

pub(crate) use film_page::film_page;
pub(crate) use run_page::{RunPage, run_page};

use super::figure::{Figure, style};
use super::tally::Tally;
use super::{Chapter, Section};
use crate::claims::ClaimVerdict;
use inline::Inline;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::collections::BTreeSet;
use words::{badge, badges, prose, verdict_class, verdict_sign};

const STYLE: &str = include_str!("page.css");

/// Scripts of the page; each may use the previous ones.
const SCRIPTS: [&str; 4] = [PAGE, include_str!("tips.js"), STRIPS, PLAYER];
const PAGE: &str = include_str!("page.js");
const STRIPS: &str = include_str!("strips.js");
const PLAYER: &str = include_str!("player.js");

/// Content policy for the browser: only the file itself.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

/// Text near the beginning of every such page, by which our pages are recognised.
pub(crate) const MARK: &str = "<title>Stripmine: ";

/// Renders the page. `left_out` names items made by another version of the program. `drawn` returns the SVG of a figure.
pub(crate) fn render(
    sections: &[Section],
    left_out: &[String],
    tally: &Tally,
    drawn: &dyn Fn(&Section, &Figure) -> String,
) -> String {
    let pictures: Vec<Vec<Inline>> = sections.iter().map(|section| item::pictures(section, drawn)).collect();
    // Pictures share their markers, each of which is in the page once.
    let markers: BTreeSet<&str> = pictures.iter().flatten().flat_map(Inline::definitions).collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                (head(&PreEscaped(format!("{MARK}results</title>"))))
                style { (PreEscaped(dark_picture_rules())) }
            }
            body {
                a.skip href="#summary" { "To the summary" }
                (contents(sections))
                svg.markers aria-hidden="true" {
                    @for marker in markers { (PreEscaped(marker)) }
                }
                main {
                    (summary(sections, &pictures, tally))
                    @for (section, pictures) in sections.iter().zip(&pictures) {
                        (item::render(section, pictures))
                    }
                    @if !left_out.is_empty() {
                        p.note { "Omitted, because another version of the program made them: " (left_out.join(", ")) "." }
                    }
                    (footer())
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

/// Removes indentation and comment lines from a script.
fn compact_script(script: &str) -> String {
    let is_comment = |line: &str| line.starts_with("//") || line.starts_with("/**") && line.ends_with("*/");
    let lines = script.lines().map(str::trim_start).filter(|line| !line.is_empty() && !is_comment(line));
    lines.collect::<Vec<_>>().join("\n")
}

/// Head of every page, with the title element.
fn head(title: &Markup) -> Markup {
    html! {
        meta charset="utf-8";
        meta name="viewport" content="width=device-width, initial-scale=1";
        meta http-equiv="Content-Security-Policy" content=(POLICY);
        (title)
        link rel="icon" href="data:,";
        style { (PreEscaped(STYLE)) }
    }
}

/// Style rules of pictures on a dark screen. The class is that of the picture itself: rules do not see beyond it where it is shown a second time.
fn dark_picture_rules() -> String {
    format!("@media screen and (prefers-color-scheme:dark){{{}}}\n", style::dark_rules(".drawn "))
}

fn chapter_sections(chapter: Chapter, sections: &[Section]) -> Vec<&Section> {
    sections.iter().filter(|section| section.chapter == chapter).collect()
}

/// Table of contents, at the side of a wide screen.
fn contents(sections: &[Section]) -> Markup {
    html! {
        nav.contents aria-label="Contents" {
            p { a href="#summary" { "Results" } }
            @for (chapter, items) in Chapter::ALL.map(|chapter| (chapter, chapter_sections(chapter, sections))) {
                @if !items.is_empty() {
                    p { (chapter.title()) }
                    ol {
                        @for section in items {
                            li {
                                a href={ "#" (section.name) } { (section.title) }
                                @for (verdict, count) in section.counts() {
                                    "\u{a0}" span class={ "mark " (verdict_class(verdict)) } title=(verdict.words()) {
                                        (verdict_sign(verdict)) (count)
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Head of the page: verdicts of all claims, and one line for every item.
fn summary(sections: &[Section], pictures: &[Vec<Inline>], tally: &Tally) -> Markup {
    html! {
        header #summary {
            h1 { "Results" }
            p {
                "Stripmine simulates particle systems in two dimensions and counts every vector operation of a step. This page compares its \
                results with the four papers that it implements, with theory, and with other programs. The limit of each claim was set before \
                the result. Written by "
                code { "stripmine reproduce" } "."
            }
            (front(sections, pictures))
            (claims(tally))
            details {
                summary { "Programs, hosts and dates of these results" }
                @for made in super::origin_sentences(sections) {
                    p.note { (made) }
                }
            }
        }
        @for (chapter, items) in Chapter::ALL.map(|chapter| (chapter, chapter_sections(chapter, sections))) {
            @if !items.is_empty() {
                div.scroll tabindex="0" role="region" aria-label={ "Summary: " (chapter.title()) } {
                    table.summary {
                        caption { (chapter.title()) }
                        thead {
                            tr {
                                th scope="col" { "Item" }
                                th scope="col" { "Answer" }
                                th scope="col" { "Claims" }
                            }
                        }
                        tbody {
                            @for section in items {
                                tr {
                                    th scope="row" { a href={ "#" (section.name) } { (section.title) } }
                                    td { (prose(&section.answer)) }
                                    td { (badges(section)) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Results of the first screen: answer and first picture of each.
fn front(sections: &[Section], pictures: &[Vec<Inline>]) -> Markup {
    let mut shown: Vec<(&Section, &Vec<Inline>)> =
        sections.iter().zip(pictures).filter(|(section, _)| section.front.is_some()).collect();
    shown.sort_by_key(|(section, _)| section.front);
    html! {
        @if !shown.is_empty() {
            div.front {
                @for (section, pictures) in shown {
                    article {
                        h2 { a href={ "#" (section.name) } { (section.title) } }
                        @if let (Some(picture), Some(figure)) = (pictures.first(), section.figures.first()) {
                            div.picture { (picture.reused_picture(&item::picture_id(section, figure), &figure.title)) }
                        }
                        p { (prose(&section.answer)) }
                    }
                }
            }
        }
    }
}

/// Table of claims by source and verdict, and the claims that failed.
fn claims(tally: &Tally) -> Markup {
    html! {
        @if !tally.is_empty() {
            div.scroll tabindex="0" role="region" aria-label="Claims by source and verdict" {
                table.data {
                    caption { "Claims by source and verdict" }
                    thead {
                        tr {
                            th scope="col" { "source" }
                            @for verdict in ClaimVerdict::ALL {
                                th.number scope="col" { (badge(verdict)) }
                            }
                        }
                    }
                    tbody {
                        @for (source, counts) in tally.rows() {
                            tr {
                                th scope="row" { (source) }
                                @for count in counts { td { (count) } }
                            }
                        }
                    }
                }
            }
            @if tally.failed().next().is_some() {
                h2 { "Not reproduced" }
                ul {
                    @for ((item, _), claim) in tally.failed() {
                        li {
                            a href={ "#" (item) } { (claim.text) }
                            " (" (claim.place.join(", ")) "): expected " (claim.expected) ", value " (claim.value) "."
                        }
                    }
                }
            }
        }
    }
}

/// Footer of the page.
fn footer() -> Markup {
    html! {
        footer {
            p {
                "Results under " code { "host/" } " depend on the host. All other files except the pages and "
                code { "provenance.json" } " are byte-identical on every host."
            }
        }
    }
}

#[cfg(test)]
mod tests;
