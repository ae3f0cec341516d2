//! Mutated scenes that are checked and run for a few steps.

use crate::mutation::gentle;
use crate::readers::scenes;
use crate::{cases, fuzz_with};
use std::cell::Cell;
use stripmine_physics::method::lattice_md::{GranularDocument, GranularScene, assemble, memory};
use stripmine_physics::scene::{Amount, DiscStart, GeneratedDiscs, WallLining};

/// True if a scene has few discs and few cells, so that a case takes no noticeable time.
fn is_small(scene: &GranularScene) -> bool {
    const MOST: f64 = 300.0;
    let sides = scene.domain.sides.unwrap_or([1.0; 2]);
    let few = |amount: &Amount, grains: &GeneratedDiscs| match amount {
        Amount::Count(count) | Amount::Both(count, _) => (*count as f64) <= MOST,
        Amount::PackingFraction(fraction) => {
            fraction * sides[0] * sides[1] / (grains.radius * grains.radius * 3.0) <= MOST
        }
    };
    let lined = |lining: &WallLining| sides[0] / lining.spacing <= MOST;
    match &scene.start {
        DiscStart::File(_) | DiscStart::List(_) => true,
        DiscStart::Hexagonal { count, .. } => *count as f64 <= MOST,
        DiscStart::Mesh { amount, grains, .. } => few(amount, grains),
        DiscStart::Random { amount, grains } => few(amount, grains),
        // Compression takes too long.
        DiscStart::Compressed { .. } => false,
        DiscStart::Pipe { amount, grains, lining, .. } | DiscStart::Box { amount, grains, lining, .. } => {
            few(amount, grains) && lined(lining)
        }
    }
}

/// Runs the text if it is a valid scene; returns true if it completed all its steps.
fn run(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let Ok(document) = GranularDocument::parse("scene.toml", &text, &[]) else { return false };
    if !is_small(&document.scene) {
        return false;
    }
    let Ok(checked) = document.check() else { return false };
    let foreseen = memory::foreseen(&checked);
    if foreseen.needed > 100_000_000 {
        return false;
    }
    let Ok(mut method) = assemble(&checked) else { return false };
    for _ in 0..3 {
        if method.step().is_err() {
            return false;
        }
    }
    assert_eq!(method.particles().len(), checked.particles.len());
    true
}

/// Small scenes of every method; presets are too large for thousands of runs.
fn small_scenes() -> Vec<Vec<u8>> {
    let mut scenes = Vec::new();
    for preset in ["pipe-small", "shaken-box", "dense-gas", "two-discs", "bench"] {
        for method in [
            &["machine.engine=fast", "search.by=lattice"][..],
            &["machine.engine=fast", "search.by=lattice", "search.on_conflict=resolve"],
            &["machine.execution=chained"],
            &["machine.execution=eager", "machine.precision=f32"],
            &["search.by=sectors", "machine.engine=fast"],
            &["search.by=neighbor-list", "machine.engine=fast", "machine.precision=mixed"],
            &["search.by=neighbor-list", "search.rebuild=all-pairs"],
        ] {
            let count = if preset == "two-discs" { "run.steps=3" } else { "particles.count=30" };
            let sets: Vec<String> = method.iter().chain(&[count]).map(|set| (*set).to_owned()).collect();
            scenes.push(GranularDocument::load(preset, &sets).unwrap().scene.to_toml().into_bytes());
        }
    }
    scenes
}

#[test]
fn small_scenes_are_run_or_refused() {
    let seeds: Vec<Vec<u8>> = small_scenes().into_iter().chain(scenes()).collect();
    let (cases, ran) = (cases(300), Cell::new(0));
    fuzz_with(gentle(), &seeds, cases, 1 << 32, |bytes| ran.set(ran.get() + u32::from(run(bytes))));
    println!("{} of {cases} took all their steps", ran.get());
    // If all were refused, nothing would be tested.
    assert!(ran.get() > cases / 4);
}
