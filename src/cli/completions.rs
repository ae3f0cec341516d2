//! `stripmine completions`: what a shell needs to complete the command.

use super::command;
use crate::console::{Failure, print};
use crate::method::Methods;
use clap::Args;
use clap_complete::{Shell, generate};

/// Shell completion, to standard output
#[derive(Args)]
pub(super) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(super) fn run(&self, methods: Methods) -> Result<(), Failure> {
        let mut text = Vec::new();
        generate(self.shell, &mut command(methods), "stripmine", &mut text);
        print(&String::from_utf8_lossy(&text))
    }
}
