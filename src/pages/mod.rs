//! Pages of items: a template in the folder `pages` has the words, tables and charts of each, and is filled from the item's frames.
//!
//! A template has two parts. Between lines of `+++` there is TOML: title, question, expectation, tables by the name of their frame,
//! figures by expressions over its columns. Below are the paragraphs; the first is the answer. Every text may contain expressions in
//! double braces.

mod figures;

use crate::claims::{self, Claim};
use crate::frame::{ExpressionScope, Expressions, FormattedTable, ResultFrame};
use crate::report::figure::{Figure, Picture, data as figure_data};
use crate::report::section::Film;
use crate::report::{Chapter, Section};
use figures::FigureSpec;
use rust_embed::RustEmbed;
use serde::Deserialize;
use stripmine_physics::input::{InputErrors, InputText, MistakeKind};
use toml::Spanned;

/// Templates: read from the source tree by a development build, embedded in a release.
#[derive(RustEmbed)]
#[folder = "pages"]
struct PageFiles;

/// Line that begins and ends the first part of a template.
const FENCE: &str = "+++\n";

/// A text that may contain expressions, with its location in the file.
type TemplateText = Spanned<String>;

/// A template.
#[derive(Debug)]
pub(crate) struct Page {
    name: String,
    header: PageHeader,
    /// Text of the whole file.
    text: String,
    /// Byte offset of the paragraphs.
    body: usize,
}

/// First part of a template.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PageHeader {
    title: String,
    chapter: Chapter,
    cost: ItemCost,
    question: TemplateText,
    expected: Option<TemplateText>,
    /// Set for results that depend on the host.
    #[serde(default)]
    host: bool,
    /// Position among the results on the report's first screen.
    front: Option<u8>,
    #[serde(default)]
    figure: Vec<FigureSpec>,
    #[serde(default)]
    table: Vec<TableSpec>,
    excerpt: Option<Excerpt>,
    /// Further files of the item.
    #[serde(default)]
    files: Vec<String>,
    film: Option<FilmSpec>,
}

/// Time and memory of an item on the two cores of the report's host.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ItemCost {
    /// False if `reproduce` leaves an item of the first chapter to `--all`, because of its time or memory.
    #[serde(default = "yes")]
    pub default: bool,
    /// Seconds of the quick size; none where the item is only made in full.
    pub quick: Option<f64>,
    /// Seconds in full.
    pub full: f64,
    /// Seconds with `--all`, where it adds to the item.
    pub all: Option<f64>,
    /// Peak memory in full (MiB).
    #[serde(default = "usual_memory")]
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "a test compares it with the memory of the report's host")
    )]
    pub memory: u64,
}

fn yes() -> bool {
    true
}

/// Memory that most items stay below (MiB).
fn usual_memory() -> u64 {
    256
}

/// A table of the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TableSpec {
    from: TemplateText,
    title: Option<TemplateText>,
    /// Columns shown; all of them by default.
    columns: Option<Spanned<Vec<String>>>,
    #[serde(default)]
    notes: Vec<TemplateText>,
}

/// Lines quoted from a file of the item.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Excerpt {
    file: TemplateText,
    caption: TemplateText,
    /// First line, counted from 1.
    #[serde(default = "first")]
    from: usize,
    lines: usize,
}

/// Text beside the item's film.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FilmSpec {
    title: TemplateText,
}

fn first() -> usize {
    1
}

/// Data of an item that its page shows.
pub(crate) struct Shown<'d> {
    pub frames: &'d [ResultFrame],
    /// Pictures that are not charts of frames, by name.
    pub pictures: &'d [(String, Picture)],
    pub(crate) film: Option<&'d Film>,
    /// Further files: name and contents.
    pub files: &'d [(String, String)],
    /// Seeds of the random numbers.
    pub seeds: &'d [u64],
}

impl Page {
    /// Reads the template of an item, if there is one. A development build reads its file.
    ///
    /// # Errors
    /// [`InputErrors`] with the line of the mistake.
    pub(crate) fn of(name: &str) -> Result<Option<Page>, InputErrors> {
        let Some(file) = PageFiles::get(&format!("{name}.md")) else { return Ok(None) };
        Page::read(name, String::from_utf8_lossy(&file.data).into_owned()).map(Some)
    }

    fn read(name: &str, text: String) -> Result<Page, InputErrors> {
        let file = file(name);
        let wrong =
            |at: usize, cause: &str| InputText::new(&file, &text).spot(at).error(MistakeKind::Syntax, cause);
        let header = text.strip_prefix(FENCE).ok_or_else(|| wrong(0, "the first line is not `+++`"))?;
        let end = header.find(&format!("\n{FENCE}")).ok_or_else(|| wrong(0, "no second line of `+++`"))? + 1;
        // The blank first line preserves line numbers of the file.
        let padded = format!("   \n{}", &header[..end]);
        let parsed = toml::from_str(&padded);
        let header: PageHeader =
            parsed.map_err(|cause| wrong(cause.span().map_or(0, |span| span.start), cause.message()))?;
        let body = FENCE.len() + end + FENCE.len();
        Ok(Page { name: name.to_owned(), header, text, body })
    }

    pub(crate) fn title(&self) -> &str {
        &self.header.title
    }

    /// Names of the pictures drawn by the study.
    pub(crate) fn drawn(&self) -> Vec<&str> {
        self.header.figure.iter().filter(|it| it.is_drawn()).map(FigureSpec::name).collect()
    }

    /// Names of files quoted or linked by the page.
    pub(crate) fn files(&self) -> Vec<&str> {
        let quoted = self.header.excerpt.iter().map(|it| it.file.get_ref());
        quoted.chain(&self.header.files).map(String::as_str).collect()
    }

    /// Chapter of the report.
    pub(crate) fn chapter(&self) -> Chapter {
        self.header.chapter
    }

    /// Stated cost.
    pub(crate) fn cost(&self) -> ItemCost {
        self.header.cost
    }

    /// Fills the template and returns the section of the report, with its claims judged as of the day on which the data were made.
    ///
    /// # Errors
    /// [`InputErrors`] if the template or a claim names a table or column that does not exist.
    pub(crate) fn section(
        &self,
        shown: &Shown<'_>,
        claims: &[Claim],
        date: &str,
    ) -> Result<Section, InputErrors> {
        let scope = ExpressionScope::of(shown.frames.iter().cloned());
        let expressions = Expressions::new();
        let fill = TemplateFilling { page: self, scope: &scope, expressions: &expressions };
        let PageHeader {
            title, chapter, question, expected, host, front, figure, table, excerpt, film, ..
        } = &self.header;
        let body = fill.at(&self.text[self.body..], self.body)?;
        let mut paragraphs = body.split("\n\n").map(one_line).filter(|paragraph| !paragraph.is_empty());
        let mut section = Section {
            chapter: *chapter,
            question: fill.text(question)?,
            expected: expected.as_ref().map_or(Ok(String::new()), |expected| fill.text(expected))?,
            answer: paragraphs.next().unwrap_or_default(),
            details: paragraphs.collect(),
            seeds: shown.seeds.to_vec(),
            front: *front,
            depends_on_host: *host,
            ..Section::new(&self.name, title)
        };
        for spec in figure {
            let drawn = figures::figures(spec, &fill, shown)?;
            section.figures.extend(drawn.into_iter().filter(Figure::has_points));
        }
        for spec in table {
            section.tables.extend(Some(fill.table(spec)?).filter(|table| !table.rows.is_empty()));
        }
        if let Some(excerpt) = excerpt {
            section.excerpt = Some((fill.text(&excerpt.caption)?, fill.lines(excerpt, shown.files)?));
        }
        if let (Some(spec), Some(film)) = (film, shown.film) {
            section.film = Some(Film { title: fill.text(&spec.title)?, ..film.clone() });
        }
        // Claims may refer to the points of a chart, too.
        let of_charts = section.figures.iter().filter_map(figure_data).map(|table| ResultFrame::from(&table));
        let scope = ExpressionScope::of(shown.frames.iter().cloned().chain(of_charts));
        let judged = claims::judge_where_possible(claims, &self.name, &scope, date);
        section.claims = judged.iter().map(Into::into).collect();
        Ok(section)
    }
}

/// A template being filled from frames.
#[derive(Clone, Copy)]
struct TemplateFilling<'p> {
    page: &'p Page,
    scope: &'p ExpressionScope,
    expressions: &'p Expressions,
}

impl TemplateFilling<'_> {
    /// Error that rejects the text at a byte offset of the file.
    fn refused(&self, at: usize, cause: impl Into<String>) -> InputErrors {
        let file = file(&self.page.name);
        InputText::new(&file, &self.page.text).spot(at).error(MistakeKind::Contradiction, cause).into()
    }

    /// Fills in the expressions of a text of the file.
    fn at(&self, text: &str, at: usize) -> Result<String, InputErrors> {
        self.expressions.text(text, self.scope).map_err(|(down, cause)| {
            let lines = text.split_inclusive('\n').take(down - 1);
            self.refused(at + lines.map(str::len).sum::<usize>(), cause)
        })
    }

    fn text(&self, text: &TemplateText) -> Result<String, InputErrors> {
        self.at(text.get_ref(), text.span().start).map(|text| one_line(&text))
    }

    fn frame(&self, name: &TemplateText) -> Result<&std::sync::Arc<ResultFrame>, InputErrors> {
        self.scope.frame(name.get_ref()).map_err(|cause| self.refused(name.span().start, cause))
    }

    fn table(&self, spec: &TableSpec) -> Result<FormattedTable, InputErrors> {
        let frame = self.frame(&spec.from)?;
        let mut table = FormattedTable::from(&**frame);
        if let Some(columns) = &spec.columns {
            let wrong = |cause| self.refused(columns.span().start, cause);
            let places = columns.get_ref().iter().map(|column| {
                let heading = &frame.columns[frame.position(column).map_err(wrong)?].doc;
                Ok(table.columns.iter().position(|it| it == heading).unwrap_or_default())
            });
            let places = places.collect::<Result<Vec<usize>, InputErrors>>()?;
            table.columns = places.iter().map(|at| table.columns[*at].clone()).collect();
            for row in &mut table.rows {
                *row = places.iter().map(|at| row[*at].clone()).collect();
            }
        }
        if let Some(title) = &spec.title {
            table.title = self.text(title)?;
        }
        let notes = spec.notes.iter().map(|note| self.text(note)).collect::<Result<Vec<_>, _>>()?;
        Ok(table.notes(notes))
    }

    fn lines(&self, excerpt: &Excerpt, files: &[(String, String)]) -> Result<String, InputErrors> {
        let name = excerpt.file.get_ref();
        let file = files.iter().find(|(known, _)| known == name);
        let names = || files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
        let missing = || format!("the item has no file `{name}`; it has {}", names());
        let (_, text) = file.ok_or_else(|| self.refused(excerpt.file.span().start, missing()))?;
        let lines: Vec<&str> = text.lines().skip(excerpt.from - 1).take(excerpt.lines).collect();
        Ok(lines.join("\n"))
    }
}

/// File of a template, by the name of its item.
fn file(name: &str) -> String {
    format!("pages/{name}.md")
}

/// Joins the lines of a paragraph.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests;
