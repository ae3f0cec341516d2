//! Rejection of scenes of format 1, with the change of each key.

use super::general::{FORMAT, FORMAT_VERSION};
use super::values::Vocabulary;
use super::{SceneError, SceneErrors};
use crate::input::{InputText, MistakeKind};
use toml::de::{DeTable, DeValue};

/// Rejects a scene of format 1.
///
/// # Errors
/// A list of the keys that have another meaning or another name in format 2.
pub(super) fn reject_format_1(
    table: &DeTable<'_>,
    text: &InputText<'_>,
    methods: &[&'static Vocabulary],
) -> Result<(), SceneErrors> {
    let Some(format) = table.get(FORMAT.name) else { return Ok(()) };
    let DeValue::Integer(number) = format.get_ref() else { return Ok(()) };
    if number.as_str() != "1" {
        return Ok(());
    }
    let (line, names) = (text.spot(format.span().start), methods.iter().map(|method| method.keys.method));
    let names: Vec<String> = names.map(|name| format!("kind = \"{name}\"")).collect();
    let mut errors: Vec<SceneError> = vec![
        line.error(MistakeKind::Format, "this program reads format 2; the file is of format 1")
            .expecting(format!("format = {}", FORMAT_VERSION))
            .advising(format!("in [method], name the method: {}", names.join(" or "))),
    ];
    for renamed in methods.iter().flat_map(|method| method.renamed) {
        let Some((section, name)) = renamed.old.split_once('.') else { continue };
        let section = table.get(section).and_then(|section| section.get_ref().as_table());
        let Some((key, value)) = section.and_then(|section| section.get_key_value(name)) else { continue };
        let word = value.get_ref().as_str().map(|word| format!(" = \"{}\"", crate::quoted::quoted(word)));
        let message = format!("`{}{}` is of format 1", renamed.old, word.unwrap_or_default());
        errors.push(text.spot(key.span().start).error(MistakeKind::Format, message).expecting(renamed.new));
    }
    SceneErrors::ok_if_empty(errors)
}
