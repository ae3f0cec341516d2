//! Claims of all items, counted by source and verdict.

use super::Section;
use super::section::JudgedClaim;
use crate::claims::{Claim, ClaimJudgement, ClaimSource, ClaimVerdict};

/// Claims of a report with their verdicts.
#[derive(Debug, Default)]
pub struct Tally {
    /// Claims with the name and title of their item; `None` for claims without an item.
    claims: Vec<(Option<(String, String)>, JudgedClaim)>,
}

impl Tally {
    /// Collects the claims of the items of a report, and claims without an item.
    pub fn of(sections: &[Section], all: &[Claim]) -> Tally {
        let judged = sections.iter().flat_map(|section| {
            let item = (section.name.clone(), section.title.clone());
            section.claims.iter().map(move |claim| (Some(item.clone()), claim.clone()))
        });
        let open = all.iter().filter(|claim| claim.item.is_none());
        Tally {
            claims: judged
                .chain(open.map(|claim| (None, (&ClaimJudgement::unjudged(claim)).into())))
                .collect(),
        }
    }

    /// Returns true if there are no claims.
    pub fn is_empty(&self) -> bool {
        self.claims.is_empty()
    }

    /// Rows of the table of claims: the name of each source with claims, then `all`, with the number of claims by verdict.
    pub fn rows(&self) -> Vec<(&'static str, [usize; 5])> {
        let count = |source: Option<&str>| {
            ClaimVerdict::ALL.map(|verdict| {
                let is_of = |claim: &JudgedClaim| source.is_none_or(|source| claim.place[0] == source);
                let own = self.claims.iter().map(|(_, claim)| claim);
                own.filter(|claim| is_of(claim) && claim.verdict == verdict.words()).count()
            })
        };
        let sources = ClaimSource::ALL.map(|source| (source.name(), count(Some(source.name()))));
        let there = sources.into_iter().filter(|(_, counts)| counts.iter().sum::<usize>() > 0);
        there.chain([("all", count(None))]).collect()
    }

    /// Claims that were not reproduced, with the name and title of their item.
    pub(crate) fn failed(&self) -> impl Iterator<Item = (&(String, String), &JudgedClaim)> {
        let failed = |claim: &JudgedClaim| claim.verdict == ClaimVerdict::NotReproduced.words();
        let of_items = self.claims.iter().filter_map(|(item, claim)| Some((item.as_ref()?, claim)));
        of_items.filter(move |(_, claim)| failed(claim))
    }
}
