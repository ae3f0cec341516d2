//! Items of the HTML page.

use super::film;
use super::inline::Inline;
use super::words::{badge, badges, prose};
use crate::claims::ClaimVerdict;
use crate::report::figure::{Figure, data_file};
use crate::report::section::Film;
use crate::report::{FormattedTable, Section, TableCell};
use maud::{Markup, html};
use stripmine_physics::number::count_with_noun;

/// Maximum pictures of an item on the page; further pictures are linked.
const FIGURES: usize = 4;

/// Pictures of an item on the page.
pub(crate) fn pictures(section: &Section, drawn: &dyn Fn(&Section, &Figure) -> String) -> Vec<Inline> {
    section.figures.iter().take(FIGURES).map(|each| Inline::new(&drawn(section, each))).collect()
}

/// Renders an item: the answer, the first picture and table, the question; all else is folded.
pub(crate) fn render(section: &Section, pictures: &[Inline]) -> Markup {
    let name = section.name.as_str();
    let mut figures = section.figures.iter().zip(pictures);
    let mut tables = section.tables.iter();
    html! {
        section id=(name) aria-labelledby={ (name) "-title" } {
            h2 id={ (name) "-title" } { a href={ "#" (name) } { (section.title) } }
            p.answer { (badges(section)) (prose(&section.answer)) }
            (claims(section))
            @if let Some((each, picture)) = figures.next() {
                (figure(section, each, picture))
            }
            @if let Some(each) = tables.next() {
                (table(each, &section.folder()))
            }
            @if let Some((what, lines)) = &section.excerpt {
                figure.excerpt {
                    figcaption { (prose(what)) }
                    pre tabindex="0" { (lines) }
                }
            }
            dl.verdict {
                dt { "Question" }
                dd { (prose(&section.question)) }
                dt { "Expected" }
                dd { (prose(&section.expected)) }
            }
            @if let Some(what) = folded_content(section) {
                details {
                    summary { "More: " (what) }
                    @for paragraph in &section.details {
                        p { (prose(paragraph)) }
                    }
                    @for (each, picture) in figures {
                        (figure(section, each, picture))
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
                    @for each in tables {
                        (table(each, &section.folder()))
                    }
                }
            }
            @if let Some(shown) = &section.film {
                (film_figure(section, shown))
            }
            (reproduction_notes(section))
        }
    }
}

/// Table of the claims of the item.
fn claims(section: &Section) -> Markup {
    let verdict = |words: &str| ClaimVerdict::ALL.into_iter().find(|verdict| verdict.words() == words);
    html! {
        @if !section.claims.is_empty() {
            div.scroll tabindex="0" role="group" aria-label="Claims" {
                table.data.claims {
                    thead {
                        tr {
                            @for heading in ["claim", "expected", "value", "verdict"] {
                                th scope="col" { (heading) }
                            }
                        }
                    }
                    tbody {
                        @for claim in &section.claims {
                            tr {
                                td.words {
                                    (prose(&claim.text)) " "
                                    span.note { (claim.place.join(", ")) @for note in &claim.notes { "; " (note) } }
                                }
                                td.words { (claim.expected) }
                                td.words { (claim.value) }
                                td.words { @if let Some(verdict) = verdict(&claim.verdict) { (badge(verdict)) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Description of the folded content; `None` if nothing is folded.
fn folded_content(section: &Section) -> Option<String> {
    let words: usize = section.details.iter().map(|paragraph| paragraph.split_whitespace().count()).sum();
    let what = [
        (words, "word", "words"),
        (section.figures.len().saturating_sub(1), "picture", "pictures"),
        (section.tables.len().saturating_sub(1), "table", "tables"),
    ];
    let what = what.into_iter().filter(|(count, ..)| *count > 0);
    let what: Vec<String> = what.map(|(count, one, many)| count_with_noun(count, one, many)).collect();
    (!what.is_empty()).then(|| what.join(", "))
}

/// Picture of a figure with its caption.
fn figure(section: &Section, figure: &Figure, picture: &Inline) -> Markup {
    let id = format!("{}-{}", section.name, figure.name);
    let caption = format!("{id}-caption");
    let (folder, data) = (section.folder(), data_file(figure));
    html! {
        figure id=(id) {
            div.picture { (picture.element(&picture_id(section, figure), &caption, data.is_some())) }
            figcaption id=(caption) {
                (heading(&figure.title)) " " (prose(&figure.caption)) " "
                @if let Some(file) = data {
                    a href={ (folder) "/" (file) } { "Data (CSV)" } ", "
                }
                a href={ (folder) "/" (figure.name) ".svg" } { "SVG" } "."
            }
        }
    }
}

/// Id of a figure's picture in the page.
pub(crate) fn picture_id(section: &Section, figure: &Figure) -> String {
    format!("{}-{}-picture", section.name, figure.name)
}

/// Title at the beginning of a caption.
pub(super) fn heading(title: &str) -> Markup {
    let ends_itself = title.ends_with(['.', '?', '!']);
    html! { strong { (title) @if !ends_itself { "." } } }
}

fn film_figure(section: &Section, shown: &Film) -> Markup {
    let instead = html! { "Its frames are in the folder " (folder(&section.folder())) "." };
    html! {
        figure id={ (section.name) "-film" } {
            (film::film_element(shown, &instead))
            figcaption { (heading(&shown.title)) }
        }
    }
}

/// Maximum rows of a table on the page; all rows are in its file.
const ROWS: usize = 10;

/// Table in a box that scrolls if the table is wider than the page: a group, since landmarks of one page need different names. A long table is cut and its file is linked.
fn table(table: &FormattedTable, folder: &str) -> Markup {
    html! {
        (data_table(table, ROWS))
        @if table.rows.len() > ROWS {
            @let file = format!("{folder}/{}.csv", table.name);
            p.note {
                "First " (ROWS) " of " (TableCell::Count(table.rows.len() as u64).formatted_text()) " rows; all rows: "
                a href=(file) { code { (file) } } "."
            }
        }
        @for note in &table.notes {
            p.note { (prose(note)) }
        }
    }
}

/// First rows of a table.
pub(super) fn data_table(table: &FormattedTable, rows: usize) -> Markup {
    let numeric = |i: usize| table.rows.iter().all(|row| row.get(i).is_some_and(TableCell::is_number));
    html! {
        div.scroll tabindex="0" role="group" aria-label=(table.title) {
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
                    @for row in table.rows.iter().take(rows) {
                        tr {
                            @for cell in row {
                                td class=[(!cell.is_number()).then_some("words")] { (cell.formatted_text()) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Command, data, seeds and provenance of an item.
fn reproduction_notes(section: &Section) -> Markup {
    let seeds: Vec<String> = section.seeds.iter().map(u64::to_string).collect();
    html! {
        div.again {
            h3 { "How to reproduce" }
            div.command {
                code tabindex="0" { (section.reproduce_command()) }
                button type="button" data-copy="" { "Copy" }
            }
            p {
                "Data: " (folder(&section.folder())) "."
                @if !seeds.is_empty() {
                    @if seeds.len() == 1 { " Seed: " } @else { " Seeds: " }
                    (seeds.join(", ")) "."
                }
                @if section.depends_on_host {
                    " Times were measured on the host of this report and differ on other hosts."
                }
            }
            @if let Some(provenance) = &section.provenance {
                p.provenance { (prose(&provenance.sentence())) }
            }
        }
    }
}

/// Link to the folder with an item's files.
fn folder(path: &str) -> Markup {
    html! { a href={ (path) "/" } { code { (path) "/" } } }
}
