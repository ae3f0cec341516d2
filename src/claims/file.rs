//! Files of claims.

use serde::Deserialize;
use stripmine_physics::input::{InputErrors, InputText, MistakeKind, Spot};
use toml::Spanned;

/// Source of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub enum ClaimSource {
    /// Buchholtz and Pöschel 1993: the lattice on a vector machine.
    BP93,
    /// Isobe 1999: event-driven hard discs.
    ISO99,
    /// Nazeri 2017: Langevin dynamics with sectors.
    LAN17,
    /// Play with Particles: all-pairs softened gravity.
    PWP,
    /// Theory, and published results of other programs.
    #[serde(rename = "literature")]
    Literature,
    /// Our own aims.
    Stripmine,
}

impl ClaimSource {
    /// All sources, in the order of the report.
    pub const ALL: [ClaimSource; 6] = [
        ClaimSource::BP93,
        ClaimSource::ISO99,
        ClaimSource::LAN17,
        ClaimSource::PWP,
        ClaimSource::Literature,
        ClaimSource::Stripmine,
    ];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            ClaimSource::BP93 => "BP93",
            ClaimSource::ISO99 => "ISO99",
            ClaimSource::LAN17 => "LAN17",
            ClaimSource::PWP => "PWP",
            ClaimSource::Literature => "literature",
            ClaimSource::Stripmine => "Stripmine",
        }
    }

    /// Name of its file of claims.
    pub fn file(self) -> String {
        format!("{}.toml", self.name().to_lowercase())
    }
}

/// A claim.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Claim {
    /// Name: small letters, digits and dashes.
    pub id: String,
    /// Source.
    pub source: ClaimSource,
    /// Location in the source.
    pub place: String,
    /// Report item that tests it; none where no item does.
    pub item: Option<String>,
    /// Statement.
    pub text: String,
    /// Expression over the item's frames that gives the value.
    pub value: Option<String>,
    /// Expression for the value's 95 % half-width.
    pub error: Option<String>,
    /// Limit; its keys are on the same level as the others.
    pub limit: ClaimLimit,
    /// Origin of the expected value: paper and table, program with version and command, or a formula.
    pub(crate) reference: Option<String>,
    /// Note for the reader.
    pub(crate) note: Option<String>,
    /// Verdict of a claim without a value.
    pub verdict: Option<Unjudged>,
    /// Earlier limits, the newest first.
    #[serde(default)]
    pub before: Vec<ClaimLimit>,
    /// Location in its file.
    #[serde(skip)]
    pub at: Spot,
}

/// Limit that decides a claim.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClaimLimit {
    /// Date on which it was set: year-month-day.
    pub since: String,
    /// Expected value.
    pub expected: Option<ExpectedValue>,
    /// Relation of the value to the expected one.
    pub(crate) relation: Option<Relation>,
    /// Absolute tolerance, in the unit of the value.
    pub(crate) tolerance: Option<f64>,
    /// Tolerance relative to the expected value.
    pub(crate) relative: Option<f64>,
}

/// Keys of a [`ClaimLimit`].
const LIMIT: [&str; 5] = ["since", "expected", "relation", "tolerance", "relative"];

/// Expected value.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum ExpectedValue {
    /// Statement that is true or false.
    Truth(bool),
    /// Number.
    Number(f64),
    /// Words.
    Words(String),
    /// Numbers: one for each value, or the ends of a range.
    Numbers(Vec<f64>),
}

/// Relation of a value to the expected one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Relation {
    /// Equal within the tolerance.
    Equals,
    /// Not smaller, within the tolerance.
    AtLeast,
    /// Not larger, within the tolerance.
    AtMost,
    /// Between two numbers.
    Between,
}

/// Verdict of a claim without a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Unjudged {
    /// No study tests it yet.
    #[serde(rename = "not tested yet")]
    NotTested,
    /// The source contradicts itself.
    #[serde(rename = "source contradicts itself")]
    Contradiction,
}

impl Claim {
    /// Error that rejects the claim, with its location.
    pub(super) fn refused(&self, cause: impl Into<String>) -> InputErrors {
        self.at.error(MistakeKind::Contradiction, cause).into()
    }

    fn check(&self) -> Result<(), InputErrors> {
        let ClaimLimit { expected, relation, tolerance, relative, .. } = &self.limit;
        let has_tolerance = tolerance.is_some() || relative.is_some();
        let cause = match (&self.value, self.verdict) {
            (Some(_), Some(_)) => "a claim with a value must not have a `verdict`",
            (None, None) => {
                "a claim without a value needs a verdict: `not tested yet` or `source contradicts itself`"
            }
            (Some(_), None) if self.item.is_none() => {
                "a claim with a value needs the `item` that provides it"
            }
            (_, _) if has_tolerance && relation.is_none() => "a tolerance needs a relation",
            (Some(_), None) if expected.is_none() || relation.is_none() => {
                "a value needs `expected` and `relation`"
            }
            (Some(_), None)
                if self.reference.is_none() && !matches!(expected, Some(ExpectedValue::Truth(_))) =>
            {
                "an expected number needs a `reference`: paper and table, program and version, or the formula"
            }
            _ if tolerance.is_some() && relative.is_some() => "give `tolerance` or `relative`, not both",
            _ => return Ok(()),
        };
        Err(self.refused(cause))
    }
}

/// Parses the claims of a file.
///
/// # Errors
/// [`InputErrors`] with the location of the mistake.
pub fn read(file: &str, text: &str) -> Result<Vec<Claim>, InputErrors> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        #[serde(default)]
        claim: Vec<Spanned<toml::Table>>,
    }
    let file = format!("claims/{file}");
    let text = InputText::new(&file, text);
    let wrong = |cause: &toml::de::Error, spot: &Spot| spot.error(MistakeKind::Type, cause.message());
    let all: File = toml::from_str(text.text)
        .map_err(|cause| wrong(&cause, &text.spot(cause.span().map_or(0, |span| span.start))))?;
    let claim = |it: Spanned<toml::Table>| -> Result<Claim, InputErrors> {
        let at = text.spot(it.span().start);
        let (limit, mut rest): (toml::Table, toml::Table) =
            it.into_inner().into_iter().partition(|(key, _)| LIMIT.contains(&key.as_str()));
        rest.insert("limit".to_owned(), toml::Value::Table(limit));
        let mut claim: Claim = rest.try_into().map_err(|cause| wrong(&cause, &at))?;
        claim.at = at;
        claim.check()?;
        Ok(claim)
    };
    all.claim.into_iter().map(claim).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "[[claim]]\nid = \"a\"\nsource = \"BP93\"\nplace = \"section 3\"\nitem = \"table\"\ntext = \"t\"\n\
                        value = \"x\"\nexpected = 59\nrelation = \"equals\"\nreference = \"table 1\"\nsince = \"2026-11-26\"\n";

    #[test]
    fn claims_have_lines() {
        let claims =
            read("bp93.toml", &format!("# head\n\n{GOOD}\n{}", GOOD.replace("\"a\"", "\"b\""))).unwrap();
        assert_eq!(claims.iter().map(|claim| claim.at.place.unwrap().line).collect::<Vec<_>>(), [3, 15]);
        assert_eq!(claims[1].limit.expected, Some(ExpectedValue::Number(59.0)));
    }

    #[test]
    fn invalid_claims_are_refused_with_line() {
        for (from, to, named) in [
            ("item =", "itme =", "itme"),
            ("relation = \"equals\"", "relation = \"equal\"", "at-least"),
            ("relation = \"equals\"", "tolerance = 0.1", "a tolerance needs a relation"),
            ("expected = 59\n", "", "`expected` and `relation`"),
            ("value = \"x\"\n", "", "needs a verdict"),
            ("item = \"table\"\n", "", "needs the `item`"),
            ("reference = \"table 1\"\n", "", "needs a `reference`"),
            ("since = \"2026-11-26\"\n", "", "since"),
            ("\"BP93\"", "\"BP94\"", "BP93"),
        ] {
            let said = read("bp93.toml", &format!("\n{}", GOOD.replace(from, to))).unwrap_err().to_string();
            assert!(said.starts_with("claims/bp93.toml:2:") && said.contains(named), "{to}: {said}");
        }
    }
}
