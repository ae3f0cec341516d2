//! Expressions over frames, in the language of the page templates: values of claims and numbers in sentences.

use super::{FrameValue as Content, ResultFrame};
use crate::statistics::median;
use minijinja::value::{Enumerator, Kwargs, Object, ObjectRepr, Value, from_args};
use minijinja::{AutoEscape, Environment, Error, ErrorKind, State, UndefinedBehavior};
use std::collections::BTreeMap;
use std::sync::Arc;
use stripmine_physics::number::{count_with_noun, range, significant, with_error_bar, with_power_of_ten};

/// Names available to an expression: the frames of an item.
#[derive(Clone, Debug)]
pub struct ExpressionScope(Arc<ScopeNames>);

/// Frames by name, and the element of a repeated figure.
#[derive(Clone, Debug)]
struct ScopeNames(BTreeMap<String, Arc<ResultFrame>>, Option<Value>);

/// Name of the element of a repeated figure.
const EACH: &str = "it";
/// Name of a row among its own cells, for columns whose names begin with a digit: `row['1_thread']`.
const ROW: &str = "row";

impl ExpressionScope {
    /// Collects frames by their names, with `_` for `-` and `.`.
    pub fn of(frames: impl IntoIterator<Item = ResultFrame>) -> ExpressionScope {
        let named = |frame: ResultFrame| (frame.name.replace(['-', '.'], "_"), Arc::new(frame));
        ExpressionScope(Arc::new(ScopeNames(frames.into_iter().map(named).collect(), None)))
    }

    /// Adds an element that expressions call `it`.
    pub(crate) fn with_it(&self, it: &Value) -> ExpressionScope {
        ExpressionScope(Arc::new(ScopeNames(self.0.0.clone(), Some(it.clone()))))
    }

    /// Returns the frame with a name.
    ///
    /// # Errors
    /// A sentence with the existing names.
    pub fn frame(&self, name: &str) -> Result<&Arc<ResultFrame>, String> {
        self.0.0.get(name).ok_or_else(|| self.0.missing(name))
    }

    fn value(&self) -> Value {
        Value::from_dyn_object(Arc::clone(&self.0))
    }
}

impl ScopeNames {
    fn missing(&self, name: &str) -> String {
        let names: Vec<&str> = self.0.keys().map(String::as_str).collect();
        format!("there is no table `{name}`; there are {}", names.join(", "))
    }
}

impl Object for ScopeNames {
    fn get_value(self: &Arc<Self>, key: &Value) -> Option<Value> {
        let name = key.as_str()?;
        if name == EACH {
            return self.1.clone();
        }
        self.0.get(name).map(|frame| Value::from_dyn_object(Arc::clone(frame)))
    }
}

/// A row of a frame, and the element of a repeated figure.
#[derive(Debug)]
struct FrameRow(Arc<ResultFrame>, usize, Option<Value>);

impl FrameRow {
    fn cell(&self, column: &str) -> Result<Value, Error> {
        let at = self.0.position(column).map_err(failure)?;
        Ok(shown(&self.0.rows[self.1][at]))
    }
}

fn shown(content: &Content) -> Value {
    match content {
        Content::Nothing => Value::from(()),
        Content::Words(words) => Value::from(words.as_str()),
        Content::Count(count) => Value::from(*count),
        Content::Number(number) => Value::from(*number),
    }
}

fn failure(cause: String) -> Error {
    Error::new(ErrorKind::InvalidOperation, cause)
}

impl Object for FrameRow {
    fn get_value(self: &Arc<Self>, key: &Value) -> Option<Value> {
        match (key.as_str()?, &self.2) {
            (EACH, Some(it)) => Some(it.clone()),
            (ROW, _) => Some(Value::from_dyn_object(Arc::clone(self))),
            (column, _) => Some(self.cell(column).unwrap_or_else(Value::from)),
        }
    }
}

/// Exposes a frame as the list of its rows; a frame with a single row also exposes its cells by name.
impl Object for ResultFrame {
    fn repr(self: &Arc<Self>) -> ObjectRepr {
        ObjectRepr::Seq
    }

    fn get_value(self: &Arc<Self>, key: &Value) -> Option<Value> {
        if let Some(column) = key.as_str() {
            return match self.rows.len() {
                1 => Some(FrameRow(Arc::clone(self), 0, None).cell(column).unwrap_or_else(Value::from)),
                rows => Some(Value::from(failure(format!(
                    "table `{}` has {rows} rows: `{column}` needs `.at(…)` or `.column('…')`",
                    self.name
                )))),
            };
        }
        let row = key.as_usize().filter(|row| *row < self.rows.len())?;
        Some(Value::from_object(FrameRow(Arc::clone(self), row, None)))
    }

    fn enumerate(self: &Arc<Self>) -> Enumerator {
        Enumerator::Seq(self.rows.len())
    }

    fn call_method(
        self: &Arc<Self>,
        _: &mut State<'_, '_>,
        method: &str,
        args: &[Value],
    ) -> Result<Value, Error> {
        match method {
            "at" | "where" => {
                let (wanted,): (Kwargs,) = from_args(args)?;
                let rows = self.rows_where(&wanted)?;
                match (method, rows.as_slice()) {
                    ("where", _) => {
                        let rows = rows.iter().map(|row| self.rows[*row].clone()).collect();
                        Ok(Value::from_object(ResultFrame { rows, ..ResultFrame::clone(self) }))
                    }
                    (_, [row]) => Ok(Value::from_object(FrameRow(Arc::clone(self), *row, None))),
                    (_, rows) => {
                        let wanted: Vec<String> = wanted
                            .args()
                            .map(|name| Ok(format!("{name} = {}", wanted.peek::<Value>(name)?)))
                            .collect::<Result<_, Error>>()?;
                        let found = count_with_noun(rows.len(), "row", "rows");
                        Err(failure(format!("table `{}` has {found} with {}", self.name, wanted.join(", "))))
                    }
                }
            }
            "column" => {
                let (name,): (&str,) = from_args(args)?;
                let at = self.position(name).map_err(failure)?;
                let there = self.rows.iter().map(|row| &row[at]).filter(|it| **it != Content::Nothing);
                Ok(there.map(shown).collect::<Vec<Value>>().into())
            }
            _ => Err(failure(format!("a table has no `{method}`; it has `at`, `where`, `column`"))),
        }
    }
}

impl ResultFrame {
    fn rows_where(&self, wanted: &Kwargs) -> Result<Vec<usize>, Error> {
        let mut rows: Vec<usize> = (0..self.rows.len()).collect();
        for name in wanted.args() {
            let (at, wanted) = (self.position(name).map_err(failure)?, wanted.get::<Value>(name)?);
            rows.retain(|row| shown(&self.rows[*row][at]) == wanted);
        }
        Ok(rows)
    }
}

/// Evaluates expressions and fills templates.
pub struct Expressions(Environment<'static>);

impl Default for Expressions {
    fn default() -> Expressions {
        Expressions::new()
    }
}

fn numbers(values: &Value) -> Result<Vec<f64>, Error> {
    values.try_iter()?.map(f64::try_from).collect()
}

impl Expressions {
    /// Creates the language with its functions `median`, `all`, `any`, `ln`, `sqrt`, and filters that format numbers.
    pub fn new() -> Expressions {
        let mut all = Environment::new();
        all.set_undefined_behavior(UndefinedBehavior::Strict);
        all.set_auto_escape_callback(|_| AutoEscape::None);
        all.add_function("median", |values: Value| Ok::<_, Error>(median(numbers(&values)?.into_iter())));
        all.add_function("all", |values: Value| Ok::<_, Error>(values.try_iter()?.all(|it| it.is_true())));
        all.add_function("any", |values: Value| Ok::<_, Error>(values.try_iter()?.any(|it| it.is_true())));
        all.add_function("ln", f64::ln);
        all.add_function("sqrt", f64::sqrt);
        all.add_function("with_bar", with_error_bar);
        all.add_function("range", |values: Value, digits: usize| {
            Ok::<_, Error>(range(numbers(&values)?, digits))
        });
        all.add_filter("digits", significant);
        all.add_filter("tens", with_power_of_ten);
        all.add_filter("fixed", |value: f64, decimals: usize| {
            super::TableCell::Number(value, decimals).formatted_text()
        });
        all.add_filter("count", |value: u64| super::TableCell::Count(value).formatted_text());
        all.add_filter("of", |count: u64, one: &str, many: &str| count_with_noun(count, one, many));
        Expressions(all)
    }

    /// Evaluates an expression over frames.
    ///
    /// # Errors
    /// A sentence with the missing table or column, and the existing ones.
    pub fn value(&self, expression: &str, scope: &ExpressionScope) -> Result<Value, String> {
        let compiled = self.0.compile_expression(expression).map_err(|cause| error_message(&cause, scope))?;
        let value = compiled.eval(scope.value()).map_err(|cause| error_message(&cause, scope))?;
        match value.is_undefined() {
            true => Err(format!("`{expression}` does not exist; {}", scope.0.missing(expression))),
            false => Ok(value),
        }
    }

    /// Evaluates an expression over the cells of a row, by the names of its columns.
    ///
    /// # Errors
    /// A sentence with the missing column, and the existing ones.
    pub(crate) fn of_row(
        &self,
        expression: &str,
        scope: &ExpressionScope,
        frame: &Arc<ResultFrame>,
        row: usize,
    ) -> Result<Value, String> {
        let compiled = self.0.compile_expression(expression).map_err(|cause| cause.to_string())?;
        let value = compiled.eval(Value::from_object(FrameRow(Arc::clone(frame), row, scope.0.1.clone())));
        value.map_err(|cause| cause.detail().map_or_else(|| cause.to_string(), str::to_owned))
    }

    /// Fills in the expressions of a text.
    ///
    /// # Errors
    /// The line within the text, and a sentence with the missing table or column, and the existing ones.
    pub fn text(&self, template: &str, scope: &ExpressionScope) -> Result<String, (usize, String)> {
        let filled = self.0.render_str(template, scope.value());
        filled.map_err(|cause| (cause.line().unwrap_or(1), error_message(&cause, scope)))
    }
}

/// Describes an error in a sentence, with the existing names where one is missing.
fn error_message(cause: &Error, scope: &ExpressionScope) -> String {
    let inner = std::error::Error::source(cause).map(ToString::to_string);
    let detail = cause.detail().map(str::to_owned).or(inner).unwrap_or_default();
    match cause.kind() {
        ErrorKind::UndefinedError => {
            let names: Vec<&str> = scope.0.0.keys().map(String::as_str).collect();
            format!("{cause}; there are the tables {}", names.join(", "))
        }
        _ if detail.is_empty() => cause.to_string(),
        _ => detail,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameBuilder;

    fn scope() -> ExpressionScope {
        let errors =
            FrameBuilder::of([("leapfrog", 64u64, 0.5), ("leapfrog", 128, 0.125), ("euler", 64, 2.0)])
                .text("scheme", |it| it.0)
                .count("steps", |it| it.1)
                .number("error", 3, |it| it.2)
                .frame("look-up", "Errors");
        let summary = FrameBuilder::of([()]).number("worst", 2, |()| 2.5e-7).frame("summary", "Summary");
        ExpressionScope::of([errors, summary])
    }

    #[test]
    fn cells_columns_and_sums_have_expressions() {
        let (all, scope) = (Expressions::new(), scope());
        let number = |text: &str| f64::try_from(all.value(text, &scope).unwrap()).unwrap();
        assert_eq!(number("look_up.at(scheme='euler').error"), 2.0);
        assert_eq!(number("look_up.at(scheme='leapfrog', steps=128).error * 4"), 0.5);
        assert_eq!(number("look_up.where(scheme='leapfrog').column('error')|max"), 0.5);
        assert_eq!(number("look_up|length"), 3.0);
        assert_eq!(number("median(look_up.column('error'))"), 0.5);
        assert_eq!(number("summary.worst"), 2.5e-7);
        assert_eq!(number("look_up[2].error"), 2.0);
        assert_eq!(number("look_up|selectattr('steps', 'gt', 100)|map(attribute='error')|sum"), 0.125);
        let said = "{{ summary.worst|tens(2) }}, {{ look_up[1].steps|count }}, {{ range(look_up.column('error'), 2) }}";
        assert_eq!(all.text(said, &scope).unwrap(), "2.5·10⁻⁷, 128, 0.12 to 2");
        let of_row = all.of_row("row['steps'] / 2", &scope, scope.frame("look_up").unwrap(), 1).unwrap();
        assert_eq!(f64::try_from(of_row).unwrap(), 64.0);
    }

    #[test]
    fn errors_name_what_exists() {
        let (all, scope) = (Expressions::new(), scope());
        let refused = |text: &str| all.value(text, &scope).unwrap_err();
        for (text, named) in [
            ("look_up.at(scheme='euler').eror", "has no column `eror`; it has scheme, steps, error"),
            ("look_up.at(scheem='euler').error", "has no column `scheem`"),
            ("look_up.column('x')", "has no column `x`"),
            ("look_up.at(scheme='leapfrog').error", "has 2 rows with scheme = leapfrog"),
            ("look_up.error", "has 3 rows: `error` needs `.at(…)`"),
            ("lookup.error", "look_up, summary"),
            ("nothing", "look_up, summary"),
        ] {
            let said = refused(text);
            assert!(said.contains(named), "{text}: {said}");
        }
        let (line, said) = all.text("a\nb {{ summary.wort }}", &scope).unwrap_err();
        assert_eq!(line, 2);
        assert!(said.contains("has no column `wort`; it has worst"), "{said}");
    }
}
