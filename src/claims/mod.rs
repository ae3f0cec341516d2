//! Claims of the sources and our own aims as data: a text, the value of a result that tests it, and the expected value.
//!
//! Each source has a file in the folder `claims`. The verdict on a claim follows from its value, the value's error, the expected value and
//! the tolerance; no sentence of a page decides it.

mod file;
mod verdict;

pub use file::{Claim, ClaimLimit, ClaimSource, ExpectedValue, read};
pub use verdict::{ClaimJudgement, ClaimVerdict};

use crate::frame::{ExpressionScope, Expressions};
use rust_embed::RustEmbed;
use stripmine_physics::input::InputErrors;

/// Files of claims: read from the source tree by a development build, embedded in a release.
#[derive(RustEmbed)]
#[folder = "claims"]
struct ClaimFiles;

/// Reads all claims, source by source, in the order of the files.
///
/// # Errors
/// [`InputErrors`] with the file and line of the mistake.
pub fn all() -> Result<Vec<Claim>, InputErrors> {
    let mut claims = vec![];
    for source in ClaimSource::ALL {
        let name = source.file();
        let text =
            ClaimFiles::get(&name).map_or(String::new(), |it| String::from_utf8_lossy(&it.data).into_owned());
        claims.extend(file::read(&name, &text)?);
    }
    for (at, claim) in claims.iter().enumerate() {
        if claims[..at].iter().any(|other| other.id == claim.id) {
            return Err(claim.refused(format!("the id `{}` occurs twice", claim.id)));
        }
    }
    Ok(claims)
}

/// Judges the claims of an item by its frames. A quick study may lack the data for some: these count as not tested.
pub(crate) fn judge_where_possible<'c>(
    claims: &'c [Claim],
    item: &str,
    scope: &ExpressionScope,
    date: &str,
) -> Vec<ClaimJudgement<'c>> {
    let expressions = Expressions::new();
    let own = claims.iter().filter(|claim| claim.item.as_deref() == Some(item));
    let one = |claim| {
        verdict::judge(claim, &expressions, scope, date).unwrap_or_else(|_| ClaimJudgement::unjudged(claim))
    };
    own.map(one).collect()
}

/// Judges the claims of an item by its frames, which were made on a day (year-month-day).
///
/// # Errors
/// [`InputErrors`] if an expression names a table or column that does not exist.
pub fn judge<'c>(
    claims: &'c [Claim],
    item: &str,
    scope: &ExpressionScope,
    date: &str,
) -> Result<Vec<ClaimJudgement<'c>>, InputErrors> {
    let expressions = Expressions::new();
    let own = claims.iter().filter(|claim| claim.item.as_deref() == Some(item));
    own.map(|claim| verdict::judge(claim, &expressions, scope, date)).collect()
}
