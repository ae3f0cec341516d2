//! `stripmine completions`: completion scripts for shells.

use super::{command, scene};
use crate::console::{CommandFailure, print};
use crate::model::machines;
use clap::builder::PossibleValuesParser;
use clap::{Args, Command};
use clap_complete::{Shell, generate};
use stripmine_physics::method::Methods;

/// Prints a shell completion script
#[derive(Args)]
pub(super) struct Completions {
    /// Shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(super) fn run(&self, methods: Methods) -> Result<(), CommandFailure> {
        let mut text = Vec::new();
        generate(self.shell, &mut with_known_values(command(methods), methods), "stripmine", &mut text);
        print(&String::from_utf8_lossy(&text))
    }
}

/// The command with the values that its arguments can name: presets, machines, keys. Shells offer files where none of these fits; fish
/// completes verbs and options only.
fn with_known_values(command: Command, methods: Methods) -> Command {
    let presets: Vec<String> = scene::presets(methods).map(|preset| preset.name.to_owned()).collect();
    let machines: Vec<String> = machines::names().map(str::to_owned).collect();
    let mut keys: Vec<String> = methods
        .iter()
        .flat_map(|method| method.vocabulary.keys.keys())
        .filter(|key| !key.section.is_empty())
        .map(|key| format!("{}.{}=", key.section, key.name))
        .collect();
    keys.sort();
    keys.dedup();
    with_values(
        command,
        &[("scene", &presets), ("machine", &machines), ("overrides", &keys), ("against", &keys)],
    )
}

/// Adds values to the arguments of the given names, in the command and all its subcommands.
fn with_values(command: Command, values: &[(&str, &Vec<String>)]) -> Command {
    command.mut_subcommands(|below| with_values(below, values)).mut_args(|arg| {
        match values.iter().find(|(name, _)| arg.get_id() == *name && arg.get_action().takes_values()) {
            Some((_, values)) => arg.value_parser(PossibleValuesParser::new(values.iter().cloned())),
            None => arg,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::METHODS;

    #[test]
    fn shells_know_presets_machines_and_keys() {
        for shell in [Shell::Bash, Shell::Zsh] {
            let mut text = Vec::new();
            generate(shell, &mut with_known_values(command(METHODS), METHODS), "stripmine", &mut text);
            let text = String::from_utf8(text).unwrap();
            for word in
                ["pipe-small", "cold-collapse", "cray-y-mp-el", "particles.packing_fraction=", "run.steps="]
            {
                assert!(text.contains(word), "{shell} does not know {word}");
            }
        }
    }
}
