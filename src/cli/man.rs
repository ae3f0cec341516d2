//! `stripmine man`: the manual page.

use super::command;
use crate::console::{Failure, print};
use crate::method::Methods;
use clap::Args;
use clap_mangen::Man;

/// The manual page, in roff, to standard output: stripmine man | man -l -
#[derive(Args)]
pub(super) struct ManVerb {
    /// The page of this verb instead of the overview
    verb: Option<String>,
}

impl ManVerb {
    pub(super) fn run(&self, methods: Methods) -> Result<(), Failure> {
        // Built, so that every verb knows the options that all share.
        let mut command = command(methods);
        command.build();
        let page = match &self.verb {
            None => command,
            Some(verb) => {
                let found = command.find_subcommand(verb).cloned();
                found.ok_or_else(|| Failure::UnknownVerb {
                    verb: verb.clone(),
                    verbs: command.get_subcommands().map(|known| known.get_name().to_owned()).collect(),
                })?
            }
        };
        let mut text = Vec::new();
        Man::new(page).render(&mut text).map_err(Failure::writing("the manual page"))?;
        print(&String::from_utf8_lossy(&text))
    }
}
