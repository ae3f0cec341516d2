//! The command `stripmine`.

use std::process::ExitCode;

fn main() -> ExitCode {
    stripmine::cli::run(std::env::args_os())
}
