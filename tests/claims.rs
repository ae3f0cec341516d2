//! Claims of the papers compared with the committed report: the report decides each claim, and no limit is newer than its result.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use stripmine::claims::{self, Claim};
use stripmine::results::Folder;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn judged(claim: &Claim) -> Option<(&str, &Claim)> {
    claim.value.as_ref()?;
    Some((claim.item.as_deref()?, claim))
}

/// Tables and columns named by claims exist in the committed report.
#[test]
fn committed_report_decides_every_claim() {
    let (all, folder) = (claims::all().unwrap(), Folder::opened_elsewhere(&root().join("reports")));
    assert!(all.len() >= 90, "{} claims", all.len());
    let items: BTreeSet<&str> = all.iter().filter_map(judged).map(|(item, _)| item).collect();
    let mut wrong = vec![];
    for item in items {
        let scope = folder.scope(item).unwrap().unwrap_or_else(|| panic!("the report has no item {item}"));
        for claim in all.iter().filter(|claim| judged(claim).is_some_and(|(own, _)| own == item)) {
            if let Err(cause) = claims::judge(std::slice::from_ref(claim), item, &scope, "9999-12-31") {
                wrong.push(format!("{}: {cause}", claim.id));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Limits are set before the result they judge: by the dates of both and, where git has the result's commit, by the claims of that
/// commit.
#[test]
fn no_limit_is_newer_than_its_result() {
    let (all, folder) = (claims::all().unwrap(), Folder::opened_elsewhere(&root().join("reports")));
    let mut newer = vec![];
    for (item, claim) in all.iter().filter_map(judged) {
        let Some(provenance) = folder.provenance(item).unwrap() else { continue };
        let measured = provenance.measured_on();
        if claim.limit.since.as_str() > measured {
            newer.push(format!("{}: limit of {}, result of {measured}", claim.id, claim.limit.since));
        }
        if provenance.repeated.is_empty() {
            let of_then = then(&provenance.origin.commit, &claim.source.file());
            let known = of_then.iter().flatten().find(|it| it.id == claim.id);
            if of_then.is_some() && known.is_none_or(|known| known.limit != claim.limit) {
                newer.push(format!("{}: its limit is not in commit {}", claim.id, provenance.origin.commit));
            }
        }
    }
    assert!(newer.is_empty(), "{}", newer.join("\n"));
}

/// Claims of a file at a commit; `None` if git lacks it.
fn then(commit: &str, file: &str) -> Option<Vec<Claim>> {
    let path = format!("{commit}:claims/{file}");
    let shown = Command::new("git").arg("-C").arg(root()).args(["show", &path]).output().ok()?;
    let text = String::from_utf8(shown.stdout).ok().filter(|_| shown.status.success())?;
    claims::read(file, &text).ok()
}

/// A changed claim keeps its earlier limit: its text in the file grows, and nothing is edited away.
#[test]
fn changed_limits_keep_their_history() {
    for claim in claims::all().unwrap() {
        let mut days: Vec<&str> = claim.before.iter().map(|limit| limit.since.as_str()).collect();
        days.insert(0, &claim.limit.since);
        assert!(days.is_sorted_by(|a, b| a >= b), "{}: {days:?}", claim.id);
        assert!(claim.before.iter().all(|limit| *limit != claim.limit), "{}", claim.id);
    }
}
