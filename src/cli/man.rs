//! `stripmine man`: the manual page in roff.

use super::{command, manual};
use crate::console::{CommandFailure, print};
use clap::Args;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};
use stripmine_physics::method::Methods;

/// Prints the manual page: stripmine man | man -l -
#[derive(Args)]
pub(super) struct ManVerb {
    /// Verb whose page is printed; default: the overview
    verb: Option<String>,
}

impl ManVerb {
    pub(super) fn run(&self, methods: Methods) -> Result<(), CommandFailure> {
        // Propagates the global options to every verb.
        let mut command = command(methods);
        command.build();
        let page = match &self.verb {
            None => command,
            Some(verb) => {
                let found = command.find_subcommand(verb).cloned();
                found.ok_or_else(|| CommandFailure::UnknownVerb {
                    verb: verb.clone(),
                    verbs: command.get_subcommands().map(|known| known.get_name().to_owned()).collect(),
                })?
            }
        };
        let parts = manual::parts(self.verb.as_deref().unwrap_or_default());
        let mut text = Vec::new();
        // The text that help shows below the options is added as sections.
        let page = Man::new(page.after_help(None::<&str>).after_long_help(None::<&str>));
        page.render(&mut text)
            .and_then(|()| extra_sections(parts).to_writer(&mut text))
            .map_err(CommandFailure::writing("the manual page"))?;
        print(&String::from_utf8_lossy(&text))
    }
}

/// Sections below the options: examples, exit codes, environment.
fn extra_sections(parts: Vec<manual::HelpSection>) -> Roff {
    let mut page = Roff::new();
    for (heading, entries) in parts {
        page.control("SH", [heading.to_uppercase().as_str()]);
        for (what, meaning) in entries {
            page.control("TP", []);
            page.text([bold(what)]);
            page.text([roman(meaning)]);
        }
    }
    page
}
