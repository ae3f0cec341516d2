//! Runs of different scenes, grouped by the keys in which the scenes differ.

use super::finished::{FinishedError, FinishedRun, averages_of};
use crate::averages::RunAverages;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use toml::Value;

/// Means over the keys in which some scenes differ.
#[derive(Clone, Debug)]
pub struct ScenePoints {
    /// Keys in which the scenes differ, as `section.key`; empty if all are one scene.
    pub keys: Vec<String>,
    /// Points in the order of their values, numbers by size.
    pub points: Vec<ScenePoint>,
}

/// Runs of one scene among others.
#[derive(Clone, Debug)]
pub struct ScenePoint {
    /// Value of each key; none where the scene does not have the key.
    pub values: Vec<Option<Value>>,
    /// Indices of its runs.
    pub runs: Vec<usize>,
    /// Joined means of its runs.
    pub averages: RunAverages,
}

/// Sections whose choices do not change the physics, the precision excepted.
const CHOICES: [&str; 2] = ["search.", "machine."];

/// Groups runs by their scenes. Seeds, `[run]` and `[output]` may differ within a point. Choices of the search and of the machine are no keys where
/// others distinguish the scenes.
///
/// # Errors
/// If methods, units or discs of start files differ, or two runs of a point are the same run.
pub fn points_of(runs: &[FinishedRun]) -> Result<ScenePoints, FinishedError> {
    let scenes: Vec<BTreeMap<String, Value>> = runs.iter().map(scene_values).collect();
    for (place, scene) in scenes.iter().enumerate() {
        if ["method.kind", "units", "particles.file"].iter().any(|key| scene.get(*key) != scenes[0].get(*key))
        {
            runs[0].check_joinable(&runs[place])?;
        }
    }
    let mut keys: Vec<String> = scenes.iter().flat_map(BTreeMap::keys).cloned().collect();
    keys.sort_unstable();
    keys.dedup();
    keys.retain(|key| scenes.iter().any(|scene| scene.get(key) != scenes[0].get(key)));
    let values = |scene: &BTreeMap<String, Value>, keys: &[String]| -> Vec<Option<Value>> {
        keys.iter().map(|key| scene.get(key).cloned()).collect()
    };
    let classes = |keys: &[String]| -> Vec<usize> {
        let all: Vec<_> = scenes.iter().map(|scene| values(scene, keys)).collect();
        all.iter().map(|own| all.iter().position(|other| other == own).unwrap_or_default()).collect()
    };
    let whole = classes(&keys);
    let choices = CHOICES.iter().flat_map(|section| keys.iter().filter(move |key| key.starts_with(section)));
    for key in choices.cloned().collect::<Vec<_>>() {
        let rest: Vec<String> = keys.iter().filter(|other| **other != key).cloned().collect();
        if classes(&rest) == whole {
            keys = rest;
        }
    }
    let mut points = vec![];
    for (place, _) in whole.iter().enumerate().filter(|&(place, class)| place == *class) {
        let own: Vec<usize> = (0..runs.len()).filter(|&run| whole[run] == place).collect();
        let averages = averages_of(&own.iter().map(|&run| runs[run].clone()).collect::<Vec<_>>())?;
        points.push(ScenePoint { values: values(&scenes[place], &keys), runs: own, averages });
    }
    points.sort_by(|a, b| {
        let pairs = a.values.iter().zip(&b.values);
        pairs.map(|(a, b)| order(a.as_ref(), b.as_ref())).find(|it| it.is_ne()).unwrap_or(Ordering::Equal)
    });
    Ok(ScenePoints { keys, points })
}

/// Order of two values of a key: numbers by size, others by their text.
fn order(a: Option<&Value>, b: Option<&Value>) -> Ordering {
    let number = |value: Option<&Value>| {
        value.and_then(|it| it.as_float().or(it.as_integer().map(|number| number as f64)))
    };
    match (number(a), number(b)) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        _ => a.map(Value::to_string).cmp(&b.map(Value::to_string)),
    }
}

/// Values of a resolved scene that determine its physics, seeds excepted, by `section.key`. The discs of a start file are represented by their
/// digest.
fn scene_values(run: &FinishedRun) -> BTreeMap<String, Value> {
    let mut values = BTreeMap::new();
    let (mut section, mut tables) = (String::new(), BTreeMap::new());
    for line in run.physics() {
        if let Some(name) = line.strip_prefix("[[") {
            // Tables of a list have numbers.
            let name = name.trim_end_matches(']');
            let number = tables.entry(name).and_modify(|number| *number += 1).or_insert(1);
            section = format!("{name}.{number}.");
            continue;
        }
        if let Some(name) = line.strip_prefix('[') {
            section = format!("{}.", name.trim_end_matches(']'));
        } else if let Some((_, digest)) = line.strip_prefix('#').and_then(|comment| comment.rsplit_once(' '))
        {
            values.insert(format!("{section}file"), Value::String(digest.to_owned()));
        }
        for (key, value) in line.parse::<toml::Table>().into_iter().flatten() {
            if key != "seed" && !key.ends_with("_seed") && !value.is_table() {
                values.insert(format!("{section}{key}"), value);
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_ordered_by_size() {
        let [small, large, word] =
            [Value::Float(2.0), Value::Integer(10), Value::String("auto".to_owned())].map(Some);
        assert!(
            order(small.as_ref(), large.as_ref()).is_lt() && order(large.as_ref(), small.as_ref()).is_gt()
        );
        assert!(order(None, word.as_ref()).is_lt());
    }
}
