//! Pair laws of scenes: one list from which words, keys, help, potentials and simpler models follow.
//!
//! A law is a [`PairPotential`] with a cut-off. Everything else, such as limits of the step, the smallest distance at the start and
//! the suitable searches, follows from the potential.

use super::pair_table::PairTable;
use crate::method::pairwise::LawTask;
use crate::method::{SimplifiedModel, Twin};
use crate::scene::{Binding, Fallback, Key, KeyValueKind, NumberRange, Overrides, SceneValues, Use};
use crate::words::{Words, define_words};
use stripmine_kernels::isa::{Memory, Slot};
use stripmine_kernels::law::LawTable;
use stripmine_kernels::law::lennard_jones::LennardJones;
use stripmine_kernels::law::potential::{CutOff, PairPotential};
use stripmine_kernels::law::tabulated::Tabulated;
use stripmine_kernels::law::yukawa::Yukawa;

/// Defines the pair laws: a list of potentials, each with its laws. An entry has a word, a help text, and its own keys. Each key gives a
/// static, a field of `Parameters`, a default, bounds, unit and help. Then follow the part that a simpler law omits, and the law as a function
/// of parameters and the particles' diameter (length).
macro_rules! define_pair_laws {
    ($($potential:ident {
        $($law:ident = $word:literal, $help:literal,
            keys [$($key:ident $name:ident = $default:literal, $bounds:expr, $unit:literal, $doc:literal)*],
            simpler [$($lacks:literal, $simpler:ident)?],
            $of:expr;)+
    })+) => {
        define_words! {
            /// Pair law of the particles.
            pub enum PairLaw {
                /// No pair forces.
                None = "none",
                $($(#[doc = $help] $law = $word,)+)+
            }
        }

        /// Words of the laws with pair forces.
        const WORDS: &[&str] = &[$($($word),+),+];

        /// Key of the pair law.
        pub static LAW: Key = key("kind", KeyValueKind::Choice(PairLaw::WORDS), "", "\"wca\"", None, concat!(
            "Pair law: none" $($(, "; ", $word, ", ", $help)+)+, ". The diameter σ is twice particles.radius."
        ));
        /// Key of the energy scale of the pair potential.
        pub static STRENGTH: Key = key("strength", KeyValueKind::Number(NumberRange::Positive), "energy", "1.0", Some((&LAW, WORDS)),
            "Energy ε of the pair potential; the well depth of Lennard-Jones; a factor of the energies of a table.");
        $($($(
            #[doc = $doc]
            pub static $key: Key = key(stringify!($name), KeyValueKind::Number($bounds), $unit, stringify!($default),
                Some((&LAW, &[$word])), $doc);
        )*)+)+

        /// Keys of the pair law, in the order in which they are written.
        pub(super) static KEYS: &[&Key] = &[&LAW, &TABLE_FILE, &STRENGTH, $($($(&$key,)*)+)+];

        /// Parameters of the pair law.
        #[derive(Clone, Debug, PartialEq)]
        pub(super) struct Parameters {
            /// ε (energy).
            pub(super) strength: f64,
            /// Table of the potential.
            pub(super) table: PairTable,
            $($($(#[doc = $doc] $name: f64,)*)+)+
        }

        impl Default for Parameters {
            fn default() -> Self {
                Parameters { strength: 1.0, table: PairTable::default(), $($($($name: $default,)*)+)+ }
            }
        }

        impl Parameters {
            /// Binds the keys of a law.
            pub(super) fn bind(&mut self, law: PairLaw, binding: &mut dyn Binding) {
                match law {
                    PairLaw::None => {}
                    $($(PairLaw::$law => {
                        if law == PairLaw::Table {
                            let mut path = self.table.path().to_string_lossy().into_owned();
                            binding.word(&TABLE_FILE, &mut path);
                            self.table = PairTable::at(binding.file(), &path);
                        }
                        binding.number(&STRENGTH, &mut self.strength);
                        $(binding.number(&$key, &mut self.$name);)*
                    })+)+
                }
            }
        }

        /// Law with its parameters, as sweeps are compiled for it: one variant per potential.
        #[derive(Clone, Debug)]
        pub(super) enum SweptLaw {
            $($potential(CutOff<$potential>),)+
        }

        impl SweptLaw {
            /// Calls `work` with the concrete law.
            pub(super) fn with<W: LawTask>(self, work: W) -> W::Output {
                match self { $(SweptLaw::$potential(law) => work.with(law),)+ }
            }

            /// Potential without cut-off and shift.
            pub(super) fn potential(&self) -> &dyn PairPotential {
                match self { $(SweptLaw::$potential(law) => law.potential(),)+ }
            }

            /// Cut-off (length).
            pub(super) fn cutoff(&self) -> f64 {
                match self { $(SweptLaw::$potential(law) => law.cutoff(),)+ }
            }
        }

        impl PairLaw {
            /// Law between particles of a diameter (length). Without pairs its strength is 0 and it ends at the diameter.
            pub(super) fn of(self, parameters: &Parameters, diameter: f64) -> SweptLaw {
                match self {
                    PairLaw::None => SweptLaw::LennardJones(CutOff::new(LennardJones::new(0.0, diameter), diameter)),
                    $($(PairLaw::$law => {
                        let of: fn(&Parameters, f64) -> CutOff<$potential> = $of;
                        SweptLaw::$potential(of(parameters, diameter))
                    })+)+
                }
            }
        }

        /// Simplifications of a scene.
        pub(super) const TWINS: &[Twin] = &[
            $($($(Twin {
                name: $lacks,
                becomes: SimplifiedModel::Overridden(|values| {
                    (law_of(values)? == PairLaw::$law).then(|| Overrides::new().set(&LAW, PairLaw::$simpler))
                }),
            },)?)+)+
            Twin {
                name: "pairs: free particles in the bath",
                becomes: SimplifiedModel::Overridden(|values| {
                    law_of(values)?.has_pairs().then(|| Overrides::new().set(&LAW, PairLaw::None))
                }),
            },
        ];
    };
}

define_pair_laws! {
    LennardJones {
        Wca = "wca", "Lennard-Jones cut off at its minimum, which only repels",
            keys [], simpler [],
            |of, diameter| CutOff::new(LennardJones::new(of.strength, diameter), 1.122_462_048_309_373 * diameter);
        LennardJones = "lennard-jones", "Lennard-Jones cut off at 2.5 diameters and shifted",
            keys [], simpler ["attraction between pairs (wca instead of lennard-jones)", Wca],
            |of, diameter| CutOff::new(LennardJones::new(of.strength, diameter), 2.5 * diameter);
    }
    Yukawa {
        Yukawa = "yukawa", "the screened repulsion ε (σ/r) exp(−κ (r − σ)), cut off at κ (r − σ) = 7.5 and shifted",
            keys [SCREENING screening = 5.0, NumberRange::AtMost(50.0), "", "Screening κσ of yukawa: σ over the screening length."],
            simpler [],
            |of, diameter| {
                let potential = Yukawa::new(of.strength, diameter, of.screening / diameter);
                CutOff::new(potential, (1.0 + 7.5 / of.screening) * diameter)
            };
    }
    Tabulated {
        Table = "table", "the potential through the rows of `law.file`, cut off at the last and shifted to 0 there",
            keys [], simpler [],
            |of, _| {
                let potential = of.table.potential.clone();
                let end = potential.ends()[1];
                CutOff::new(potential, end)
            };
    }
}

/// Key of the table of a pair potential.
pub static TABLE_FILE: Key = Key {
    fallback: Fallback::Required,
    ..key(
        "file",
        KeyValueKind::Text,
        "",
        "",
        Some((&LAW, &["table"])),
        "Table of the pair potential: rows of r (length), U (energy) and perhaps F = −dU/dr, which is compared with the rows; relative to the scene file. U is cubic between rows; pairs nearer than the first row end the run.",
    )
};

/// Binds the columns of a law's table to the arrays of a program.
pub(super) fn bind_table<'c>(memory: Memory<'c>, columns: &'c [Vec<f64>]) -> Memory<'c> {
    let columns = LawTable::ARRAYS.into_iter().zip(columns);
    columns.fold(memory, |memory, (array, column)| memory.read(Slot::new(array), column))
}

/// Creates a key of the pair law with a default.
const fn key(
    name: &'static str,
    kind: KeyValueKind,
    unit: &'static str,
    default: &'static str,
    used: Use,
    doc: &'static str,
) -> Key {
    Key { section: "law", name, kind, unit, fallback: Fallback::Is(default), used, implies: None, doc }
}

/// Pair law in the values of a scene.
fn law_of(values: &SceneValues) -> Option<PairLaw> {
    PairLaw::parse(&values.choice(&LAW)?)
}

impl PairLaw {
    /// True if particles exert pair forces.
    pub(super) fn has_pairs(self) -> bool {
        self != PairLaw::None
    }

    /// Distance at which the pair potential between particles of a diameter (length) is `energies` ε, in diameters, to two decimals.
    pub(super) fn nearest(self, parameters: &Parameters, diameter: f64, energies: f64) -> f64 {
        let closest = self.of(parameters, diameter).potential().closest(energies * parameters.strength);
        (100.0 * (closest / diameter)).round() / 100.0
    }
}

impl SweptLaw {
    /// Columns of the law's table, for programs; empty without one.
    pub(super) fn table_columns(&self) -> Vec<Vec<f64>> {
        self.potential().table().map(|table| table.columns().into()).unwrap_or_default()
    }

    /// True if particles attract each other anywhere up to the cut-off, sampled at a hundred distances.
    pub(super) fn is_attractive(&self) -> bool {
        (1..100).any(|place| self.potential().force(0.01 * f64::from(place) * self.cutoff()) < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, load};
    use std::marker::PhantomData;
    use stripmine_kernels::backend::Precision;
    use stripmine_kernels::isa::Array;
    use stripmine_kernels::law::{Law, ObservationRequest};
    use stripmine_kernels::mask::Mask;
    use stripmine_kernels::sweep::lattice::forces::Forces;
    use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};
    use stripmine_kernels::{Execution, InstructionSet, Program};

    const DIAMETER: f64 = 0.7;

    /// Every law with pair forces, with ε = 1 and its word. The table has the repulsion of Lennard-Jones from 0.6 to 1.1 σ.
    fn laws() -> impl Iterator<Item = (&'static str, SweptLaw)> {
        let steep = LennardJones::new(1.0, DIAMETER);
        let rows: Vec<[f64; 2]> =
            (60..=110).map(|row| 0.01 * DIAMETER * f64::from(row)).map(|r| [r, steep.energy(r)]).collect();
        let mut parameters = Parameters::default();
        parameters.table.potential = Tabulated::new(&rows).unwrap();
        let all = PairLaw::ALL.iter().filter(|(law, _)| law.has_pairs());
        all.map(move |(law, word)| (*word, law.of(&parameters, DIAMETER)))
    }

    /// For every law F = −dU/dr and U″ = −dF/dr, by central differences to 10⁻⁷, from 300 ε to the cut-off. Particles repel each other at σ.
    /// Collisions of higher energy end nearer, where the potential equals that energy and is steeper.
    #[test]
    fn force_and_curvature_are_slopes_of_the_energy() {
        for (word, law) in laws() {
            let potential = law.potential();
            let (near, far) = (potential.closest(300.0), law.cutoff());
            for step in 0..400 {
                let distance = near + (far - near) * f64::from(step) / 400.0;
                let h = 1e-6 * distance;
                let slope = |of: &dyn Fn(f64) -> f64| (of(distance - h) - of(distance + h)) / (2.0 * h);
                let (force, curvature) = (potential.force(distance), potential.curvature(distance));
                let off = slope(&|r| potential.energy(r)) - force;
                assert!(off.abs() < 1e-7 * (force.abs() + 1.0 / distance), "{word} at {distance}: {off}");
                let off = slope(&|r| potential.force(r)) - curvature;
                assert!(off.abs() < 1e-7 * (curvature.abs() + 1.0 / distance.powi(2)), "{word}: {off}");
            }
            assert!(potential.force(DIAMETER) > 0.0, "{word}");
            let (mut before, mut steepest) = (far, 0.0);
            for energy in [1.0, 10.0, 30.0, 100.0, 300.0] {
                let closest = potential.closest(energy);
                assert!((potential.energy(closest) / energy - 1.0).abs() < 1e-13, "{word}: {closest}");
                assert!(closest < before && potential.curvature(closest) > steepest, "{word}: {closest}");
                (before, steepest) = (closest, potential.curvature(closest));
            }
        }
    }

    /// Execution and instruction set of a sweep.
    type SweepExecution = (Execution, InstructionSet);

    /// Pairs at given distances on a lattice, swept in one precision: repulsive force, energy and virial of each pair.
    struct SweptPairs<'d, P>(&'d [f64], &'d [Vec<f64>], SweepExecution, PhantomData<P>);

    impl<P: Precision> LawTask for SweptPairs<'_, P> {
        type Output = Vec<[f64; 3]>;

        fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Vec<[f64; 3]> {
            let SweptPairs(distances, columns, (execution, set), _) = self;
            let (mask, (sine, cosine)) = (Mask::square(2), 0.4f64.sin_cos());
            // Pairs are farther apart than the mask reaches.
            let shape = LatticeShape::new(5 * distances.len(), 5, &mask, [false; 2]).unwrap();
            let frame = LatticeFrame { origin: [0.0; 2], edge: [DIAMETER; 2] };
            let cells = (0..distances.len() as isize).map(|pair| shape.position(5 * pair + 1, 2));
            let column = |value: f64| vec![P::from_f64(value); shape.padded()];
            let [mut x, mut y] = [1e30; 2].map(column);
            for (own, distance) in cells.clone().zip(distances) {
                (x[own], y[own]) = (P::from_f64(0.0), P::from_f64(0.0));
                let displacement = [distance * cosine - DIAMETER, distance * sine];
                [x[own + 1], y[own + 1]] = displacement.map(P::from_f64);
            }
            let [mut fx, mut fy, mut energy, mut virial] = [0.0; 4].map(column);
            let memory = Memory::new()
                .read(Slot::new(Array::X), &x)
                .read(Slot::new(Array::Y), &y)
                .write(Slot::new(Array::Fx), &mut fx)
                .write(Slot::new(Array::Fy), &mut fy)
                .write(Slot::new(Array::Energy), &mut energy)
                .write(Slot::new(Array::Virial), &mut virial);
            let memory = bind_table(memory, columns);
            let forces = Forces::<P, L>::new(law, &mask, shape, frame, Coordinates::CellRelative);
            let program = Program::new(
                forces.asked(ObservationRequest { energy: true, ..ObservationRequest::default() }),
            );
            program.run(&memory, shape.swept(), execution, set).unwrap();
            let pair = |cell: usize| {
                let [fx, fy, energy, virial] = [&fx, &fy, &energy, &virial].map(|it| it[cell].to_f64());
                [-(fx * cosine + fy * sine), 2.0 * energy, 2.0 * virial]
            };
            cells.map(pair).collect()
        }
    }

    /// In both precisions, every execution on every instruction set gives the same bits. They match the shifted potential to rounding, and vanish
    /// beyond the cut-off.
    #[test]
    fn sweeps_match_the_shifted_potential() {
        for (word, law) in laws() {
            let (potential, cutoff, columns) = (law.potential(), law.cutoff(), law.table_columns());
            let near = potential.closest(300.0);
            let distances: Vec<f64> =
                (0..200).map(|step| near + (1.1 * cutoff - near) * f64::from(step) / 200.0).collect();
            let swept = |how| {
                let double = law.clone().with(SweptPairs::<f64>(&distances, &columns, how, PhantomData));
                [double, law.clone().with(SweptPairs::<f32>(&distances, &columns, how, PhantomData))]
            };
            let oracle = swept((Execution::Chained, InstructionSet::Scalar));
            for execution in [Execution::Eager, Execution::Strip(64), Execution::Chained] {
                for set in InstructionSet::available() {
                    assert!(swept((execution, set)) == oracle, "{word}: {execution:?} on {set:?}");
                }
            }
            for (found, bound) in oracle.iter().zip([1e-12, 2e-5]) {
                for (&distance, found) in distances.iter().zip(found) {
                    let force = potential.force(distance);
                    let energy = potential.energy(distance) - potential.energy(cutoff);
                    let stated =
                        [force, energy, force * distance].map(|it| if distance < cutoff { it } else { 0.0 });
                    for (found, stated) in found.iter().zip(stated) {
                        let off = (found - stated).abs();
                        assert!(
                            off < bound * (stated.abs() + 20.0),
                            "{word} at {distance}: {found} {stated}"
                        );
                    }
                }
            }
        }
    }

    /// Values calculated earlier from the Lennard-Jones formula: lattice cells for pairs as near as 0.82 σ, and starts with overlaps of up to
    /// 0.25 σ. Only the longer cut-off leaves attraction.
    #[test]
    fn scene_bounds_follow_from_the_potential() {
        let parameters = Parameters::default();
        for (law, attracts) in [(PairLaw::Wca, false), (PairLaw::LennardJones, true)] {
            assert_eq!([30.0, 100.0].map(|energies| law.nearest(&parameters, 1.0, energies)), [0.82, 0.75]);
            assert_eq!(law.of(&parameters, DIAMETER).is_attractive(), attracts);
        }
        assert_eq!(PairLaw::None.nearest(&parameters, 1.0, 30.0), 0.0);
    }

    /// Calculated by hand, as for Lennard-Jones in `limits`: the hardest collision of 1000 particles of density 1 in a time of 1000 has 14.388 kT. With
    /// ε = kT and κσ = 5 it ends at 0.57678, where exp(5 (1 − r))/r = 14.388 and U″ = U (25 + 10/r + 2/r²) = 695.65: the step is
    /// 2 √(1/(2 U″)) = 0.053619. LAN17's bound, with r_c = 2.5 and F = 6, is √(2 · 2.5/6) = 0.91287.
    #[test]
    fn limits_of_yukawa_follow_from_its_potential() {
        let sets = [
            "law.kind=yukawa",
            "particles.count=1000",
            "particles.spacing=0.9",
            "domain.sides=[40.0, 25.0]",
            "integrator.dt=0.01",
            "run.time=1000",
        ];
        let (prepared, _) = load("langevin-dense", &sets.map(str::to_owned), METHODS).unwrap();
        let [source, hardest] = [0, 1].map(|limit| prepared.step_limits[limit].step);
        assert!((source - 0.912_87).abs() < 1e-5 && (hardest - 0.053_619).abs() < 1e-6, "{source} {hardest}");
        assert_eq!(prepared.left_out, ["attraction: law.kind is yukawa"]);
        assert!(prepared.scene.contains("strength = 1.0 # energy\nscreening = 5.0\n"), "{}", prepared.scene);
    }
}
