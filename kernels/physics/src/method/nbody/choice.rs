//! What `auto` becomes, and what else a scene is told of the ways it runs.
//!
//! The choice depends on the scene alone, never on the machine or its threads, so that a run is the same everywhere.

use super::options::{ArithmeticKind, Engine};
use super::scene::Scene;
use super::schemes::SchemeName;
use crate::scene::Precision;
use crate::words::Words;

/// Bodies up to which the sum as it is written is the cheaper. It takes N (N − 1) scalar terms of some 12 clock periods; the
/// sweep fills up its groups of 16 and takes about 2000 for one, most of them 256 terms by registers.
const FEW: usize = 12;

/// Decides the engine where the scene leaves it open. Gives the reasons, and what is slower than one would think.
pub(super) fn choose(scene: &mut Scene, bodies: usize) -> Vec<String> {
    let mut said = vec![];
    if scene.engine == Engine::Auto {
        let is_plain = scene.precision == Precision::F64 && scene.arithmetic == ArithmeticKind::Exact;
        let (engine, reason) = match (is_plain, bodies <= FEW) {
            (false, _) => (Engine::Fast, "only it has single precision and estimated roots".to_owned()),
            (_, true) => {
                (Engine::Reference, format!("of {bodies} bodies, and up to {FEW}, it is the cheaper"))
            }
            (_, false) => (
                Engine::Fast,
                format!("{bodies} bodies are more than the {FEW} up to which the reference is the cheaper"),
            ),
        };
        scene.engine = engine;
        said.push(format!("machine.engine = \"{}\": {reason}", engine.word()));
    }
    if scene.scheme == SchemeName::Gear6 && scene.engine != Engine::Reference {
        said.push(format!(
            "integrator.kind = \"{}\" starts with derivatives that no sweep sums up: once, in double precision, pair by pair, as \
             long as some hundred steps",
            scene.scheme.word()
        ));
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_bodies_are_summed_as_it_is_written() {
        let engine = |bodies, precision, arithmetic| {
            let mut scene = Scene { engine: Engine::Auto, precision, arithmetic, ..Scene::default() };
            let said = choose(&mut scene, bodies);
            assert!(said[0].contains(scene.engine.word()), "{said:?}");
            scene.engine
        };
        use ArithmeticKind::{Estimated, Exact};
        for (bodies, precision, arithmetic, expected) in [
            (2, Precision::F64, Exact, Engine::Reference),
            (FEW, Precision::F64, Exact, Engine::Reference),
            (FEW + 1, Precision::F64, Exact, Engine::Fast),
            (2, Precision::Mixed, Exact, Engine::Fast),
            (2, Precision::F64, Estimated, Engine::Fast),
        ] {
            assert_eq!(
                engine(bodies, precision, arithmetic),
                expected,
                "{bodies} {precision:?} {arithmetic:?}"
            );
        }
    }

    /// What is slower than it looks is said, and what was asked for stays.
    #[test]
    fn a_slow_start_is_said() {
        let said = |scheme, engine| {
            let mut scene = Scene { scheme, engine, ..Scene::default() };
            let said = choose(&mut scene, 100);
            assert_eq!(scene.engine, engine);
            said
        };
        assert!(said(SchemeName::Gear6, Engine::Fast)[0].contains("derivatives"));
        assert!(said(SchemeName::Gear6, Engine::Reference).is_empty());
        assert!(said(SchemeName::Hermite4, Engine::Fast).is_empty());
    }
}
