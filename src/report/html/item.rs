//! One item of the page.

use super::words::{badge, prose};
use super::{data, film};
use crate::report::figure::{Figure, Picture, data_file};
use crate::report::section::Film;
use crate::report::{Cell, Section, Table};
use maud::{Markup, PreEscaped, html};

/// Pictures of an item that the page shows; further ones are linked.
const FIGURES: usize = 6;

/// The item with everything that belongs to it.
pub fn render(section: &Section, drawn: &dyn Fn(&Section, &Figure) -> String) -> Markup {
    let name = section.name.as_str();
    html! {
        section id=(name) aria-labelledby={ (name) "-title" } {
            h2 id={ (name) "-title" } { a href={ "#" (name) } { (section.title) } }
            dl.verdict {
                dt { "Question" }
                dd { (prose(&section.question)) }
                dt { "Expected" }
                dd { (prose(&section.expected)) }
                dt { "Answer" }
                dd { (badge(section.verdict)) " " (prose(&section.answer)) }
            }
            @for paragraph in &section.details {
                p { (prose(paragraph)) }
            }
            @for each in section.figures.iter().take(FIGURES) {
                (figure(section, each, drawn))
            }
            @if section.figures.len() > FIGURES {
                p.note {
                    "Further pictures: "
                    @for (at, each) in section.figures.iter().skip(FIGURES).enumerate() {
                        @if at > 0 { "; " }
                        a href={ (section.folder()) "/" (each.name) ".svg" } { (each.title) }
                    }
                    "."
                }
            }
            @if let Some(shown) = &section.film {
                (moving(section, shown))
            }
            @for each in &section.tables {
                (table(each, &section.folder()))
            }
            @if let Some((what, lines)) = &section.excerpt {
                figure.excerpt {
                    figcaption { (prose(what)) }
                    pre tabindex="0" { (lines) }
                }
            }
            (again(section))
        }
    }
}

/// A figure: its picture, and below it what a reader must know.
fn figure(section: &Section, figure: &Figure, drawn: &dyn Fn(&Section, &Figure) -> String) -> Markup {
    let svg = drawn(section, figure);
    // What stands before the element itself belongs to a file of its own.
    let svg = PreEscaped(svg.find("<svg").map_or("", |start| &svg[start..]));
    let file = format!("{}/{}.svg", section.folder(), figure.name);
    // Charts and maps are drawn by a script from their data: the page carries no picture twice. The file is read where no script
    // runs, and on paper.
    let instead = html! { img.on-paper loading="lazy" src=(file) alt=(figure.title); };
    let label = format!("{}. {}", figure.title, figure.caption);
    html! {
        figure id={ (section.name) "-" (figure.name) } {
            @match &figure.picture {
                Picture::Drawing(_) => div.drawing role="img" aria-label=(label) { (svg) },
                Picture::Chart(chart) => (live("chart", &label, &data::chart(chart), &instead)),
                Picture::Map(map) => (live("map", &label, &data::map(map), &instead)),
            }
            figcaption {
                (heading(&figure.title)) " " (prose(&figure.caption))
                @let folder = section.folder();
                @if let Some(file) = data_file(figure) {
                    " " a href={ (folder) "/" (file) } { "Data (CSV)" } ","
                }
                " " a href={ (folder) "/" (figure.name) ".svg" } { "SVG" } ", "
                a href={ (folder) "/" (figure.name) ".png" } { "PNG" } "."
            }
        }
    }
}

/// A title that begins a caption.
fn heading(title: &str) -> Markup {
    let ends_itself = title.ends_with(['.', '?', '!']);
    html! { strong { (title) @if !ends_itself { "." } } }
}

/// A picture that a script draws from its data, and what stands for it where no script runs.
fn live(kind: &str, label: &str, data: &serde_json::Value, instead: &Markup) -> Markup {
    html! {
        div.picture data-kind=(kind) data-label=(label) {
            (data::embedded("", data))
            (instead)
        }
    }
}

fn moving(section: &Section, shown: &Film) -> Markup {
    let instead = html! { noscript { p { "The film needs JavaScript. Its frames are in the folder " (folder(&section.folder())) "." } } };
    html! {
        figure id={ (section.name) "-film" } {
            (live("film", &shown.title, &film::data(shown), &instead))
            figcaption { (heading(&shown.title)) }
        }
    }
}

/// Rows of a table that a page shows; a longer one is for programs.
const ROWS: usize = 10;

/// A table in a box of its own, which scrolls where the table is wider than the page. The page has the first rows of a long
/// one, and says where all are: in the item's folder.
fn table(table: &Table, folder: &str) -> Markup {
    let numeric = |i: usize| table.rows.iter().all(|row| row.get(i).is_some_and(Cell::is_number));
    html! {
        div.scroll tabindex="0" role="region" aria-label=(table.title) {
            table.data {
                caption { (table.title) }
                thead {
                    tr {
                        @for (i, column) in table.columns.iter().enumerate() {
                            th class=[numeric(i).then_some("number")] scope="col" { (column) }
                        }
                    }
                }
                tbody {
                    @for row in table.rows.iter().take(ROWS) {
                        tr {
                            @for cell in row {
                                td class=[(!cell.is_number()).then_some("words")] { (cell.for_reading()) }
                            }
                        }
                    }
                }
            }
        }
        @if table.rows.len() > ROWS {
            @let file = format!("{folder}/{}.csv", table.name);
            p.note {
                "The first " (ROWS) " of " (Cell::Count(table.rows.len() as u64).for_reading()) " rows; all are in "
                a href=(file) { code { (file) } } "."
            }
        }
        @for note in &table.notes {
            p.note { (prose(note)) }
        }
    }
}

/// What a reader needs to get the item again.
fn again(section: &Section) -> Markup {
    let seeds: Vec<String> = section.seeds.iter().map(u64::to_string).collect();
    html! {
        div.again {
            h3 { "To get it again" }
            div.command {
                code { (section.again) }
                button type="button" data-copy="" { "Copy" }
            }
            p {
                "Data: " (folder(&section.folder())) "."
                @if !seeds.is_empty() {
                    @if seeds.len() == 1 { " Seed: " } @else { " Seeds: " }
                    (seeds.join(", ")) "."
                }
                @if section.depends_on_host {
                    " Times are of the host that made it; elsewhere they differ."
                }
            }
            @if let Some(provenance) = &section.provenance {
                p.provenance { (prose(&provenance.sentence())) }
            }
        }
    }
}

/// The folder with an item's files, which lies beside the page.
fn folder(path: &str) -> Markup {
    html! { a href={ (path) "/" } { code { (path) "/" } } }
}
