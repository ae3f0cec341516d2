//! Suggestions for wrong arguments: the nearest verb, or the scene key with the name of the option.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::collections::BTreeSet;
use std::ffi::OsString;
use stripmine_physics::method::Methods;
use stripmine_physics::words::nearest;

/// Most keys suggested for one option.
const MOST: usize = 3;

/// Adds a suggestion to an argument error that the parser has none for.
pub(super) fn with_suggestion(
    mut mistake: clap::Error,
    arguments: &[OsString],
    command: &clap::Command,
    methods: Methods,
) -> clap::Error {
    let words: Vec<&str> = arguments.iter().skip(1).filter_map(|word| word.to_str()).collect();
    let verb = innermost_verb(command, &words);
    match mistake.kind() {
        ErrorKind::InvalidSubcommand if mistake.get(ContextKind::SuggestedSubcommand).is_none() => {
            let Some(ContextValue::String(found)) = mistake.get(ContextKind::InvalidSubcommand) else {
                return mistake;
            };
            let known = verb.get_subcommands().map(clap::Command::get_name);
            if let Some(near) = nearest(found, known) {
                let near = ContextValue::Strings(vec![near.to_owned()]);
                mistake.insert(ContextKind::SuggestedSubcommand, near);
            }
        }
        ErrorKind::UnknownArgument if verb.get_arguments().any(|known| known.get_long() == Some("set")) => {
            let Some(ContextValue::String(found)) = mistake.get(ContextKind::InvalidArg) else {
                return mistake;
            };
            if let Some(tip) = key_suggestion(found, &words, methods) {
                mistake.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
                // The parser's similar option is a worse guess.
                mistake.remove(ContextKind::SuggestedArg);
            }
        }
        _ => {}
    }
    mistake
}

/// Innermost verb named by the words.
fn innermost_verb<'c>(command: &'c clap::Command, words: &[&str]) -> &'c clap::Command {
    words.iter().fold(command, |verb, word| verb.find_subcommand(word).unwrap_or(verb))
}

/// Suggestion to set the scene keys whose name is the option's.
fn key_suggestion(found: &str, words: &[&str], methods: Methods) -> Option<String> {
    let name = found.trim_start_matches('-').split('=').next().unwrap_or_default().replace('-', "_");
    let keys = methods.iter().flat_map(|method| method.vocabulary.keys.keys());
    let paths: BTreeSet<String> = keys
        .filter(|key| key.name == name && !key.section.is_empty())
        .map(|key| key.path())
        .take(MOST)
        .collect();
    let after = |word: &str| match word.split_once('=') {
        Some((option, value)) if option == found => Some(value.to_owned()),
        _ => None,
    };
    let at = words.iter().position(|word| *word == found);
    let next = at.and_then(|at| words.get(at + 1)).map(|word| (*word).to_owned());
    let value = words.iter().find_map(|word| after(word)).or(next).unwrap_or_else(|| "VALUE".to_owned());
    let said: Vec<String> = paths.iter().map(|path| format!("--set {path}={value}")).collect();
    (!said.is_empty()).then(|| format!("it is a scene key: {}", said.join(" or ")))
}
