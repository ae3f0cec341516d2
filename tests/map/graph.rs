//! Algorithms on arrows between any names.

use std::collections::{BTreeMap, BTreeSet};

/// All names reachable from each name; a name reaches itself only through a circle.
pub fn reached<'a>(
    arrows: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> BTreeMap<&'a str, BTreeSet<&'a str>> {
    let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (from, to) in arrows {
        next.entry(from).or_default().insert(to);
    }
    let from = |&start: &&'a str| {
        let mut found = BTreeSet::new();
        let mut open = vec![start];
        while let Some(name) = open.pop() {
            open.extend(next.get(name).into_iter().flatten().filter(|&&to| found.insert(to)));
        }
        (start, found)
    };
    next.keys().map(from).collect()
}

/// Circles: names that reach each other, in order, each circle once.
pub fn circles<'a>(arrows: impl IntoIterator<Item = (&'a str, &'a str)>) -> BTreeSet<Vec<&'a str>> {
    let reached = reached(arrows);
    let reaches = |from: &str, to: &str| reached.get(from).is_some_and(|found| found.contains(to));
    let of = |&start: &&'a str| {
        let all = reached[start].iter().copied();
        all.filter(|other| reaches(other, start)).collect::<Vec<_>>()
    };
    reached.keys().map(of).filter(|circle| !circle.is_empty()).collect()
}

#[test]
fn circles_are_found_once() {
    let arrows = [("a", "b"), ("b", "c"), ("c", "b"), ("d", "d"), ("c", "e")];
    assert_eq!(circles(arrows), BTreeSet::from([vec!["b", "c"], vec!["d"]]));
    assert!(reached(arrows)["a"].contains("e"));
}
