//! `stripmine completions`: what a shell needs to complete the command.

use super::{CommandLine, Failure, print};
use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

/// Shell completion, to standard output
#[derive(Args)]
pub(super) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let mut text = Vec::new();
        generate(self.shell, &mut CommandLine::command(), "stripmine", &mut text);
        print(&String::from_utf8_lossy(&text))
    }
}
