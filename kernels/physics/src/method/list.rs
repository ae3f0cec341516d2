//! List of methods. Each is a folder beside this file and a line of this list.

use super::entry::{MethodEntry, ObservedQuantity, Prepared, QuantityKind};
use super::start_temperature::{requested_temperature, start_temperature};
use super::{hard_disks, langevin, lattice_md, nbody};
use crate::number::significant;
use crate::quoted::quoted;
use crate::scene::{
    KeyValue, METHOD, MistakeKind, STRUCTURE, STRUCTURE_RANGE, SceneError, SceneErrors, SceneValues, TARGET,
    Vocabulary,
};
use crate::structure::{self, MOST_SPECIES, SampleData, SamplingKind, StructureObservable, observable};
use crate::words::nearest;

/// Methods that scenes may name.
pub type Methods = &'static [&'static MethodEntry];

/// All methods of this program.
pub static METHODS: Methods = &[&lattice_md::ENTRY, &hard_disks::ENTRY, &langevin::ENTRY, &nbody::ENTRY];

/// Vocabularies of the scenes of some methods.
pub fn vocabularies(methods: Methods) -> Vec<&'static Vocabulary> {
    methods.iter().map(|method| method.vocabulary).collect()
}

/// Returns the method of a name.
pub fn method(methods: Methods, name: &str) -> Option<&'static MethodEntry> {
    methods.iter().copied().find(|method| method.vocabulary.keys.method == name)
}

/// Loads and prepares a scene, given as a preset's name or a file's path, with overrides `section.key=value`; also returns its method.
///
/// # Errors
/// [`SceneErrors`]: every mistake of the file, or every violated precondition.
pub fn load(
    what: &str,
    overrides: &[String],
    methods: Methods,
) -> Result<(Prepared, &'static MethodEntry), SceneErrors> {
    prepare(SceneValues::load(what, overrides, &vocabularies(methods))?, methods)
}

/// Prepares a scene that was read; also returns its method.
///
/// # Errors
/// [`SceneErrors`]: every violated precondition.
pub fn prepare(
    values: SceneValues,
    methods: Methods,
) -> Result<(Prepared, &'static MethodEntry), SceneErrors> {
    // Reading has already restricted the method to those of the list.
    let unlisted = || values.spot(&METHOD).error(MistakeKind::Unknown, "there is no such method");
    let entry = method(methods, values.method()).ok_or_else(unlisted)?;
    let wrong = wrong_target(&values, entry);
    let asked = requested_temperature(&values, &entry.vocabulary.keys);
    let spot = values.spot(&STRUCTURE);
    let target = match values.value(&TARGET) {
        Some(KeyValue::Target(target)) => target.quantity,
        _ => String::new(),
    };
    let prepared = (entry.prepare)(values);
    // A scene may have quantities of its own.
    let is_own = prepared.as_ref().is_ok_and(|it| it.model.own_quantities().contains(&target));
    match (prepared, wrong.filter(|_| !is_own)) {
        (Ok(mut prepared), None) => match missing_precondition(&prepared) {
            Some(why) => Err(spot.error(MistakeKind::Contradiction, why).into()),
            None => {
                prepared.memory.needed += sampling_memory(&prepared);
                prepared.facts.extend(asked.and_then(|asked| start_temperature(asked, &prepared)));
                Ok((prepared, entry))
            }
        },
        (Ok(_), Some(wrong)) => Err(wrong.into()),
        (Err(mistakes), wrong) => Err(SceneErrors(wrong.into_iter().chain(mistakes.0).collect())),
    }
}

/// Memory that sampling the structure takes (bytes).
fn sampling_memory(prepared: &Prepared) -> u64 {
    let asked: Vec<_> = prepared.output.structure.iter().filter_map(|name| observable(name)).collect();
    structure::bytes(&asked, prepared.particles().grain_count(), prepared.schedule.row_count())
}

/// Reason why a requested structure quantity cannot be computed.
fn missing_precondition(prepared: &Prepared) -> Option<String> {
    if prepared.output.structure.is_empty() {
        return None;
    }
    let setting = prepared.structure_setting();
    if let Some(range) = prepared.output.structure_range.filter(|range| *range > setting.longest_reach) {
        let most = significant(setting.longest_reach, 6);
        let path = STRUCTURE_RANGE.path();
        return Some(format!(
            "`{path}` = {range} is beyond {most}, the largest distance that the box allows"
        ));
    }
    let why = |observable: &StructureObservable| match observable.seen {
        _ if observable.species() > 0 && setting.species < 2 => {
            Some("needs two species: particles of two radii, or types in the start file")
        }
        _ if observable.species() > 0 && setting.species > MOST_SPECIES => {
            Some("needs at most four species: the start has more")
        }
        SamplingKind::Once { asks: SampleData::DistancesOfSpecies, .. } if setting.has_open_top => {
            Some("needs a closed or periodic box: this one is open at the top")
        }
        SamplingKind::Once { asks: SampleData::Waves | SampleData::WavesOfSpecies, .. }
            if prepared.domain.periodic() == [false; 2] =>
        {
            Some("needs a periodic side for its waves")
        }
        SamplingKind::Once { asks: SampleData::Distances, .. } if prepared.model.has_segments() => {
            Some("is not known beside plane walls: the area that discs can reach is that of the whole box")
        }
        SamplingKind::Once { asks: SampleData::Forces, .. } if prepared.model.pair_forces().is_none() => {
            Some("needs pair forces that act at any moment: this method has none")
        }
        _ if observable.follows_motion()
            && prepared.domain.periodic() != [false; 2]
            && !prepared.model.follows_crossings() =>
        {
            Some("needs discs tracked across periodic sides: this method does not count their crossings")
        }
        _ => None,
    };
    let asked = prepared.output.structure.iter().filter_map(|name| observable(name));
    let mut reasons = asked.filter_map(|it| Some((it.name, why(it)?)));
    let (name, why) = reasons.next()?;
    Some(format!("\"{name}\" of `{}` {why}", STRUCTURE.path()))
}

/// Error if the run is to end by a quantity that has no mean.
fn wrong_target(values: &SceneValues, entry: &MethodEntry) -> Option<SceneError> {
    let Some(KeyValue::Target(target)) = values.value(&TARGET) else { return None };
    let has_mean =
        |quantity: &&ObservedQuantity| !matches!(quantity.kind, QuantityKind::Time | QuantityKind::Kept);
    let names: Vec<&str> = entry.quantities.iter().filter(has_mean).map(|quantity| quantity.name).collect();
    if names.contains(&target.quantity.as_str()) {
        return None;
    }
    let message =
        format!("`{}` names no quantity that has a mean: \"{}\"", TARGET.path(), quoted(&target.quantity));
    let error = values.spot(&TARGET).error(MistakeKind::Unknown, message).expecting(names.join(", "));
    Some(match nearest(&target.quantity, names.iter().copied()) {
        Some(near) => error.advising(format!("did you mean \"{near}\"?")),
        None => error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two presets have moving walls: a box shaken ten times a second, and a floor with 1.5 vibrations in a unit of time.
    #[test]
    fn only_moving_walls_have_a_period() {
        let presets = METHODS.iter().flat_map(|method| method.vocabulary.presets).map(|preset| preset.name);
        let period = |name| Some((name, load(name, &[], METHODS).unwrap().0.model.period()?));
        let found: Vec<(&str, f64)> = presets.filter_map(period).collect();
        assert_eq!(found, [("shaken-box", 0.1), ("vibrating-floor", 1.0 / 1.5)]);
    }
}
