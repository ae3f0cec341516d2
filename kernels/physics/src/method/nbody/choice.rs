//! Choice of the engine for `auto`, and notes on the chosen configuration.
//!
//! The choice depends on the scene alone, never on the machine or its threads, so runs are the same everywhere.

use super::options::{ArithmeticKind, ForceEngine};
use super::scene::NbodyScene;
use super::schemes::SchemeName;
use crate::scene::Precision;
use crate::words::Words;

/// Number of bodies up to which the direct sum is cheaper. It takes N (N − 1) scalar terms of some 12 clock periods. The
/// sweep pads its groups to 16 and takes about 2000 clock periods for one, mostly for its 256 terms in registers.
const FEW: usize = 12;

/// Chooses the engine if the scene leaves it open. Returns the reasons, and notes on unexpectedly slow parts.
pub(super) fn resolve_engine(scene: &mut NbodyScene, bodies: usize) -> Vec<String> {
    let mut said = vec![];
    if scene.engine == ForceEngine::Auto {
        let is_plain = scene.precision == Precision::F64 && scene.arithmetic == ArithmeticKind::Exact;
        let (engine, reason) = match (is_plain, bodies <= FEW) {
            _ if scene.scheme.is_adaptive() => (
                ForceEngine::Reference,
                "the only engine that sums positions beyond double precision, as encounters need".to_owned(),
            ),
            (false, _) => {
                (ForceEngine::Fast, "only this engine has single precision and estimated roots".to_owned())
            }
            (_, true) => {
                (ForceEngine::Reference, format!("the cheapest for {bodies} bodies, and for up to {FEW}"))
            }
            (_, false) => (
                ForceEngine::Fast,
                format!("the cheapest for {bodies} bodies; up to {FEW}, the reference is cheaper"),
            ),
        };
        scene.engine = engine;
        said.push(format!("machine.engine = \"{}\": {reason}", engine.word()));
    }
    if scene.scheme == SchemeName::Gear6 && scene.engine != ForceEngine::Reference {
        said.push(format!(
            "integrator.kind = \"{}\" starts with derivatives that no sweep calculates: they are summed pair by pair in \
             double precision, once, which takes as long as some hundred steps",
            scene.scheme.word()
        ));
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_bodies_use_the_direct_sum() {
        let engine = |bodies, precision, arithmetic| {
            let mut scene =
                NbodyScene { engine: ForceEngine::Auto, precision, arithmetic, ..NbodyScene::default() };
            let said = resolve_engine(&mut scene, bodies);
            assert!(said[0].contains(scene.engine.word()), "{said:?}");
            scene.engine
        };
        use ArithmeticKind::{Estimated, Exact};
        for (bodies, precision, arithmetic, expected) in [
            (2, Precision::F64, Exact, ForceEngine::Reference),
            (FEW, Precision::F64, Exact, ForceEngine::Reference),
            (FEW + 1, Precision::F64, Exact, ForceEngine::Fast),
            (2, Precision::Mixed, Exact, ForceEngine::Fast),
            (2, Precision::F64, Estimated, ForceEngine::Fast),
        ] {
            assert_eq!(
                engine(bodies, precision, arithmetic),
                expected,
                "{bodies} {precision:?} {arithmetic:?}"
            );
        }
    }

    /// A slow start is reported, and the requested engine stays.
    #[test]
    fn slow_starts_are_reported() {
        let said = |scheme, engine| {
            let mut scene = NbodyScene { scheme, engine, ..NbodyScene::default() };
            let said = resolve_engine(&mut scene, 100);
            assert_eq!(scene.engine, engine);
            said
        };
        assert!(said(SchemeName::Gear6, ForceEngine::Fast)[0].contains("derivatives"));
        assert!(said(SchemeName::Gear6, ForceEngine::Reference).is_empty());
        assert!(said(SchemeName::Hermite4, ForceEngine::Fast).is_empty());
    }
}
