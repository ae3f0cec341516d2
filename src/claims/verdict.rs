//! Verdicts: one function of value, error, expectation and tolerance.

use super::file::{Claim, ClaimLimit, ExpectedValue, Relation, Unjudged};
use crate::frame::{ExpressionScope, Expressions};
use minijinja::value::{Value, ValueKind};
use stripmine_physics::input::InputErrors;
use stripmine_physics::number::{significant, with_error_bar};

/// Verdict of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ClaimVerdict {
    /// The value is within the limit, including its error.
    Reproduced,
    /// The value is outside the limit, including its error.
    NotReproduced,
    /// The value's error crosses the limit.
    Undecided,
    /// The source contradicts itself.
    Contradiction,
    /// No study tests the claim yet.
    NotTested,
}

impl ClaimVerdict {
    /// All verdicts, in the order of tables.
    pub const ALL: [ClaimVerdict; 5] = [
        ClaimVerdict::Reproduced,
        ClaimVerdict::NotReproduced,
        ClaimVerdict::Undecided,
        ClaimVerdict::Contradiction,
        ClaimVerdict::NotTested,
    ];

    /// Verdict in words.
    pub const fn words(self) -> &'static str {
        match self {
            ClaimVerdict::Reproduced => "reproduced",
            ClaimVerdict::NotReproduced => "not reproduced",
            ClaimVerdict::Undecided => "undecided",
            ClaimVerdict::Contradiction => "source contradicts itself",
            ClaimVerdict::NotTested => "not tested yet",
        }
    }
}

/// A claim with its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimJudgement<'c> {
    /// The claim.
    pub claim: &'c Claim,
    /// Its verdict.
    pub verdict: ClaimVerdict,
    /// Formatted value; empty where there is none.
    pub value: String,
    /// Set if the limit is newer than the result.
    pub(crate) is_too_new: bool,
}

impl PartialEq for Claim {
    fn eq(&self, other: &Claim) -> bool {
        self.id == other.id
    }
}

impl ClaimJudgement<'_> {
    /// Judgement of a claim that no item tests.
    pub(crate) fn unjudged(claim: &Claim) -> ClaimJudgement<'_> {
        let verdict = match claim.verdict {
            Some(Unjudged::Contradiction) => ClaimVerdict::Contradiction,
            _ => ClaimVerdict::NotTested,
        };
        ClaimJudgement { claim, verdict, value: String::new(), is_too_new: false }
    }

    /// Formatted expectation.
    pub fn expected(&self) -> String {
        let ClaimLimit { expected, relation, tolerance, relative, .. } = &self.claim.limit;
        let number = |value: &f64| significant(*value, 8);
        let numbers = |values: &[f64]| values.iter().map(number).collect::<Vec<_>>().join(", ");
        let within = match (tolerance, relative) {
            (Some(tolerance), _) if *tolerance > 0.0 => format!(" ± {}", significant(*tolerance, 3)),
            (_, Some(relative)) if *relative > 0.0 => format!(" ± {} %", significant(100.0 * relative, 3)),
            _ => String::new(),
        };
        match (expected, relation) {
            (Some(ExpectedValue::Numbers(ends)), Some(Relation::Between)) if ends.len() == 2 => {
                format!("{} to {}", number(&ends[0]), number(&ends[1]))
            }
            (Some(ExpectedValue::Truth(truth)), _) => if *truth { "yes" } else { "no" }.to_owned(),
            (Some(ExpectedValue::Words(words)), _) => words.clone(),
            (Some(expected), Some(relation)) => {
                let sign = match relation {
                    Relation::AtLeast => "≥ ",
                    Relation::AtMost => "≤ ",
                    Relation::Equals | Relation::Between => "",
                };
                let values = match expected {
                    ExpectedValue::Number(value) => number(value),
                    ExpectedValue::Numbers(values) => numbers(values),
                    ExpectedValue::Truth(_) | ExpectedValue::Words(_) => String::new(),
                };
                format!("{sign}{values}{within}")
            }
            _ => String::new(),
        }
    }
}

/// Judges a claim.
pub(super) fn judge<'c>(
    claim: &'c Claim,
    expressions: &Expressions,
    scope: &ExpressionScope,
    date: &str,
) -> Result<ClaimJudgement<'c>, InputErrors> {
    let (Some(value), Some(expected), Some(relation)) =
        (&claim.value, &claim.limit.expected, claim.limit.relation)
    else {
        return Ok(ClaimJudgement::unjudged(claim));
    };
    let of = |text: &str| expressions.value(text, scope).map_err(|cause| claim.refused(cause));
    let (value, error) = (of(value)?, claim.error.as_deref().map(of).transpose()?);
    let is_too_new = claim.limit.since.as_str() > date;
    let judged = |verdict, value| ClaimJudgement { claim, verdict, value, is_too_new };
    let is = |holds: bool| if holds { ClaimVerdict::Reproduced } else { ClaimVerdict::NotReproduced };
    match expected {
        ExpectedValue::Truth(truth) if value.kind() == ValueKind::Bool => {
            let said = if value.is_true() { "yes" } else { "no" };
            Ok(judged(is(value.is_true() == *truth), said.to_owned()))
        }
        ExpectedValue::Words(words) if value.as_str().is_some() => {
            Ok(judged(is(value.as_str() == Some(words)), value.to_string()))
        }
        _ => {
            let wrong = |cause: String| claim.refused(cause);
            let values = numbers(&value).map_err(wrong)?;
            let errors = error.as_ref().map_or(Ok(vec![0.0; values.len()]), numbers).map_err(wrong)?;
            let limits = limits(&claim.limit, expected, relation, values.len()).map_err(wrong)?;
            if errors.len() != values.len() {
                return Err(claim.refused(format!("{} errors of {} values", errors.len(), values.len())));
            }
            let verdicts = values.iter().zip(&errors).zip(limits).map(|((v, e), ends)| verdict(*v, *e, ends));
            let verdict = verdicts.fold(ClaimVerdict::Reproduced, worse);
            let said = values.iter().zip(&errors).map(|(value, error)| match *error > 0.0 {
                // Cells without a value are read as NaN.
                _ if value.is_nan() => "none".to_owned(),
                true => with_error_bar(*value, *error),
                false => significant(*value, 5),
            });
            Ok(judged(verdict, said.collect::<Vec<_>>().join(", ")))
        }
    }
}

/// Verdict on a value, from the ends of the allowed range.
fn verdict(value: f64, error: f64, [low, high]: [f64; 2]) -> ClaimVerdict {
    match [value - error, value + error] {
        [least, most] if least >= low && most <= high => ClaimVerdict::Reproduced,
        [least, most] if most < low || least > high => ClaimVerdict::NotReproduced,
        _ => ClaimVerdict::Undecided,
    }
}

/// Verdict on two values together: one failure decides.
fn worse(one: ClaimVerdict, other: ClaimVerdict) -> ClaimVerdict {
    match (one, other) {
        (ClaimVerdict::NotReproduced, _) | (_, ClaimVerdict::NotReproduced) => ClaimVerdict::NotReproduced,
        (ClaimVerdict::Undecided, _) | (_, ClaimVerdict::Undecided) => ClaimVerdict::Undecided,
        _ => ClaimVerdict::Reproduced,
    }
}

/// Lowest and highest allowed value of each of `count` values.
fn limits(
    limit: &ClaimLimit,
    expected: &ExpectedValue,
    relation: Relation,
    count: usize,
) -> Result<Vec<[f64; 2]>, String> {
    let ends = |expected: f64| {
        let share = limit.relative.map_or(0.0, |share| share * expected.abs());
        let tolerance = limit.tolerance.unwrap_or(share);
        match relation {
            Relation::AtLeast => [expected - tolerance, f64::INFINITY],
            Relation::AtMost => [f64::NEG_INFINITY, expected + tolerance],
            Relation::Equals | Relation::Between => [expected - tolerance, expected + tolerance],
        }
    };
    match (expected, relation) {
        (ExpectedValue::Numbers(range), Relation::Between) if range.len() == 2 => {
            Ok(vec![[range[0], range[1]]; count])
        }
        (_, Relation::Between) => Err("`between` needs expected = [lowest, highest]".to_owned()),
        (ExpectedValue::Number(expected), _) => Ok(vec![ends(*expected); count]),
        (ExpectedValue::Numbers(all), _) if all.len() == count => {
            Ok(all.iter().map(|one| ends(*one)).collect())
        }
        (ExpectedValue::Numbers(all), _) => Err(format!("{} expected numbers for {count} values", all.len())),
        (ExpectedValue::Truth(_) | ExpectedValue::Words(_), _) => Err("the value is a number".to_owned()),
    }
}

/// Numbers of a value: one, or those of a list; a truth value is 1 or 0.
fn numbers(value: &Value) -> Result<Vec<f64>, String> {
    let one = |value: Value| match value.kind() {
        ValueKind::None => Ok(f64::NAN),
        _ => f64::try_from(value.clone()).map_err(|_| format!("`{value}` is not a number")),
    };
    match value.kind() {
        ValueKind::Seq | ValueKind::Iterable => {
            let all: Vec<f64> =
                value.try_iter().map_err(|cause| cause.to_string())?.map(one).collect::<Result<_, _>>()?;
            if all.is_empty() { Err("the value is an empty list".to_owned()) } else { Ok(all) }
        }
        _ => Ok(vec![one(value.clone())?]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::file::read;
    use crate::frame::FrameBuilder;

    fn judged(lines: &str) -> Result<(ClaimVerdict, String, String), String> {
        let text = format!(
            "[[claim]]\nid = \"a\"\nsource = \"BP93\"\nplace = \"p\"\nitem = \"i\"\ntext = \"t\"\nreference = \"r\"\n\
             since = \"2026-11-26\"\n{lines}"
        );
        let frame = FrameBuilder::of([(0.5, 0.2, "a"), (1.5, 0.1, "b")])
            .text("name", |it| it.2)
            .cell("x", |it| crate::frame::TableCell::with_error(it.0, Some(it.1), 2))
            .frame("t", "T");
        let claims = read("bp93.toml", &text).map_err(|cause| cause.to_string())?;
        let judged = judge(&claims[0], &Expressions::new(), &ExpressionScope::of([frame]), "2026-11-26");
        let judged = judged.map_err(|cause| cause.to_string())?;
        Ok((judged.verdict, judged.value.clone(), judged.expected()))
    }

    #[test]
    fn a_verdict_follows_from_value_error_and_tolerance() {
        use ClaimVerdict::{NotReproduced, Reproduced, Undecided};
        let a = "value = \"t.at(name='a').x\"\n";
        let with_error = "value = \"t.at(name='a').x\"\nerror = \"t.at(name='a').x_error\"\n";
        let both = "value = \"t.column('x')\"\nerror = \"t.column('x_error')\"\n";
        for (value, limit, verdict) in [
            (a, "expected = 0.5\nrelation = \"equals\"", Reproduced),
            (a, "expected = 0.6\nrelation = \"equals\"\ntolerance = 0.05", NotReproduced),
            (a, "expected = 0.6\nrelation = \"equals\"\nrelative = 0.2", Reproduced),
            (a, "expected = 0.4\nrelation = \"at-least\"", Reproduced),
            (a, "expected = 0.4\nrelation = \"at-most\"", NotReproduced),
            (a, "expected = [0.4, 0.6]\nrelation = \"between\"", Reproduced),
            (with_error, "expected = 0.6\nrelation = \"at-most\"", Undecided),
            (with_error, "expected = 0.7\nrelation = \"at-most\"", Reproduced),
            (with_error, "expected = 0.2\nrelation = \"at-most\"", NotReproduced),
            (both, "expected = [0.5, 1.5]\nrelation = \"equals\"\ntolerance = 0.2", Reproduced),
            (both, "expected = [0.5, 1.2]\nrelation = \"equals\"\ntolerance = 0.15", NotReproduced),
            (both, "expected = [0.5, 1.5]\nrelation = \"equals\"\ntolerance = 0.15", Undecided),
            ("value = \"t.at(name='a').x < 1\"\n", "expected = true\nrelation = \"equals\"", Reproduced),
            ("value = \"t[1].name\"\n", "expected = \"a\"\nrelation = \"equals\"", NotReproduced),
        ] {
            assert_eq!(judged(&format!("{value}{limit}")).unwrap().0, verdict, "{value}{limit}");
        }
        let (_, value, expected) =
            judged(&format!("{with_error}expected = 0.6\nrelation = \"at-least\"\nrelative = 0.5")).unwrap();
        assert_eq!([value, expected], ["0.50 ± 0.20", "≥ 0.6 ± 50 %"]);
    }

    #[test]
    fn missing_values_are_refused_with_known_names() {
        let limit = "expected = 1\nrelation = \"equals\"";
        for (value, named) in [
            ("value = \"u.x\"\n", "t"),
            ("value = \"t.at(name='a').y\"\n", "it has name, x, x_error"),
            ("value = \"t[0].name\"\n", "`a` is not a number"),
            ("value = \"t.where(name='c').column('x')\"\n", "empty list"),
        ] {
            let said = judged(&format!("{value}{limit}")).unwrap_err();
            assert!(said.starts_with("claims/bp93.toml:1:") && said.contains(named), "{said}");
        }
    }
}
