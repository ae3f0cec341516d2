//! Promises of every method, with every engine, for every file, however often a run is stopped.

mod configurations;
mod few;
mod files;
mod short;
mod table;

use std::process::Command;
use stripmine_physics::method::METHODS;
use table::{Extent, hold};

fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_stripmine"))
}

#[test]
fn every_method_keeps_its_promises() {
    let held = hold(METHODS, command, Extent::Quick);
    println!("{held:?}");
    assert!(held.presets == METHODS.iter().map(|method| method.vocabulary.presets.len()).sum::<usize>());
    assert!(held.engines > held.presets && held.killed > 0, "{held:?}");
}

/// The whole table.
#[test]
#[ignore = "long: cargo test --release --test promises -- --ignored --nocapture"]
fn every_engine_keeps_every_promise() {
    println!("{:?}", hold(METHODS, command, Extent::Full));
}

#[test]
fn runs_of_few_particles_resume() {
    let [runs, resumed] = few::hold(1);
    assert!(runs > 200 && resumed > 3 * runs, "{runs} runs, resumed {resumed} times");
}

/// Resumes many more scenes than [`runs_of_few_particles_resume`].
#[test]
#[ignore = "long: cargo test --release --test promises -- --ignored --nocapture"]
fn many_runs_of_few_particles_resume() {
    println!("{:?}", few::hold(40));
}
