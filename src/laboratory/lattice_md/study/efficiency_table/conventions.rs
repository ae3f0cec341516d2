//! Which way of counting gives the source's four numbers? Every combination of what may be counted and how Gear's scheme may be
//! written, on recorded programs.
//!
//! The source prints 59, 12, 1656 = 24 · 69 and 54, and neither a program nor a rule of counting. Changes between numbers and index
//! vectors are counted by none of the rules: a word of a CRAY is both.

use super::question::{Question, QuestionError, model_of, step};
use serde::Serialize;
use stripmine_kernels::backend::Tape;
use stripmine_kernels::integrator::gear::{Acceleration, STATE, coefficients};
use stripmine_kernels::isa::{Array, Machine, Op, OpClass, OpCounts, Slot, Text, Vector};
use stripmine_kernels::ledger::Length;
use stripmine_kernels::mask::Mask;
use stripmine_physics::method::lattice_md::{Part, StepProgram, programs};
use stripmine_physics::scene::Precision;

/// A way of counting, and of writing what is counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Convention {
    /// Derivatives that Gear's scheme carries.
    pub gear_values: usize,
    /// Whether they are scaled by δt^k/k!.
    pub scaled: bool,
    /// Whether the rotation's row begins with the angle; else with the angular velocity.
    pub angle: bool,
    /// Whether constants are folded into one: a factor for each term; cells numbered from the corner; no change of scale.
    pub folded: bool,
    /// Whether loads are counted.
    pub loads: bool,
    /// Whether stores are counted, of the sums of the forces at every place.
    pub stores: bool,
    /// Whether gathers and scatters are counted.
    pub gathers: bool,
    /// Whether shifted copies are counted.
    pub shifts: bool,
    /// Whether gravity is counted.
    pub gravity: bool,
}

impl Convention {
    /// In words, what is counted first.
    pub fn words(&self) -> String {
        let counted: Vec<&str> = [
            (self.loads, "loads"),
            (self.stores, "stores"),
            (self.gathers, "gathers and scatters"),
            (self.shifts, "shifted copies"),
            (self.gravity, "gravity"),
        ]
        .into_iter()
        .filter_map(|(is_counted, what)| is_counted.then_some(what))
        .collect();
        let counted = if counted.is_empty() { String::new() } else { format!(", {}", counted.join(", ")) };
        format!(
            "arithmetic{counted}; {} {} values, constants {}, rotation {} its angle",
            self.gear_values,
            if self.scaled { "scaled" } else { "unscaled" },
            if self.folded { "folded" } else { "apart" },
            if self.angle { "with" } else { "without" }
        )
    }
}

/// What a way of counting makes of predictor, index, a place of the forces, corrector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counted {
    /// The way.
    pub convention: Convention,
    /// Operations of predictor, index, a place of the mask, corrector.
    pub counts: [u64; 4],
    /// The same less what the source prints.
    pub off: [i64; 4],
    /// The largest of these as a share of what is printed.
    pub worst: f64,
}

/// The source's numbers: predictor, index, a place of the mask, corrector.
pub const PRINTED: [u64; 4] = [59, 12, 69, 54];

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Conventions {
    /// How many ways were counted.
    pub tried: usize,
    /// How many give each of the four numbers exactly.
    pub exact: [usize; 4],
    /// How many give all four.
    pub all_exact: usize,
    /// The most of the four that one way gives exactly.
    pub most_exact: usize,
    /// The nearest to all four, by the largest difference as a share; then those that give most of them exactly.
    pub nearest: Vec<Counted>,
    /// The printed text by all of its operations: loads, stores, everything.
    pub everything: Counted,
    /// Operations of a place and periodic side that shifts which wrap would need in place of a halo: the nearest image.
    pub nearest_image: u64,
}

/// Counts every combination for a question that is asked of the printed text.
///
/// # Errors
/// [`QuestionError`] if no such lattice exists.
pub fn conventions(question: &Question) -> Result<Conventions, QuestionError> {
    let texts = Texts::of(question)?;
    let mut all: Vec<Counted> = every().map(|convention| texts.counted(convention)).collect();
    let exact = [0, 1, 2, 3].map(|part| all.iter().filter(|counted| counted.off[part] == 0).count());
    let hits = |counted: &Counted| counted.off.iter().filter(|&&off| off == 0).count();
    let everything = all
        .iter()
        .copied()
        .find(|counted| counted.convention == Convention::everything(question.choice.gear_values));
    all.sort_by(|a, b| a.worst.total_cmp(&b.worst).then(hits(b).cmp(&hits(a))));
    let most_exact = all.iter().map(hits).max().unwrap_or(0);
    let mut nearest: Vec<Counted> = all.iter().take(6).copied().collect();
    let by_hits = all.iter().filter(|counted| hits(counted) == most_exact && !nearest.contains(counted));
    let by_hits: Vec<Counted> = by_hits.take(4).copied().collect();
    nearest.extend(by_hits);
    Ok(Conventions {
        tried: all.len(),
        exact,
        all_exact: all.iter().filter(|counted| hits(counted) == 4).count(),
        most_exact,
        nearest,
        // It is among those tried.
        everything: everything.unwrap_or(all[0]),
        nearest_image: recorded(&NearestImage).filtered(|op| !op.class().moves_data()).total(),
    })
}

impl Convention {
    fn everything(gear_values: usize) -> Convention {
        Convention {
            gear_values,
            scaled: false,
            angle: true,
            folded: true,
            loads: true,
            stores: true,
            gathers: true,
            shifts: true,
            gravity: true,
        }
    }

    fn counts(&self, op: Op) -> bool {
        match op.class() {
            OpClass::Load => self.loads,
            OpClass::Store => self.stores,
            OpClass::Gather | OpClass::Scatter => self.gathers,
            OpClass::Shift => self.shifts,
            OpClass::Convert => op == Op::Truncate,
            _ => true,
        }
    }
}

fn every() -> impl Iterator<Item = Convention> {
    (4..=6usize).flat_map(|gear_values| {
        (0..1u32 << 8).map(move |bits| {
            let bit = |number: u32| bits >> number & 1 == 1;
            Convention {
                gear_values,
                scaled: bit(0),
                angle: bit(1),
                folded: bit(2),
                loads: bit(3),
                stores: bit(4),
                gathers: bit(5),
                shifts: bit(6),
                gravity: bit(7),
            }
        })
    })
}

/// What is counted: recorded once.
struct Texts {
    index: Vec<(&'static str, OpCounts)>,
    /// Sections of the forces at all places of the mask, and at one.
    places: usize,
    all_places: OpCounts,
    one_place: OpCounts,
    gravity: bool,
}

impl Texts {
    fn of(question: &Question) -> Result<Texts, QuestionError> {
        let (all, _) = step(question)?;
        let tally = |programs: &[StepProgram], part: Part| -> Vec<(&'static str, OpCounts)> {
            programs.iter().filter(|step| step.part == part).flat_map(|step| step.program.tally()).collect()
        };
        let sum = |sections: Vec<(&'static str, OpCounts)>| {
            let mut sum = OpCounts::default();
            sections.iter().for_each(|(_, counts)| sum.add(counts));
            sum
        };
        let mut model = model_of(question)?;
        let places = model.mask.offsets().len();
        let gravity = model.gravity != [0.0; 2];
        model.mask = Mask::one_place();
        let one = programs(&model, Precision::F64);
        debug_assert!(one.iter().any(|step| step.length == Length::SweptCells));
        Ok(Texts {
            index: tally(&all, Part::Index),
            places,
            all_places: sum(tally(&all, Part::Forces)),
            one_place: sum(tally(&one, Part::Forces)),
            gravity,
        })
    }

    fn counted(&self, convention: Convention) -> Counted {
        let of = |counts: &OpCounts| counts.filtered(|op| convention.counts(op)).total();
        let gear = |corrects: bool| of(&recorded(&Gear { convention, corrects }));
        let index = self.index.iter().filter(|(section, _)| !(convention.folded && *section == "i of (2)"));
        // A place: what one more place adds, with its operands and its sums where these are counted.
        let each = (of(&self.all_places) - of(&self.one_place)) / (self.places as u64 - 1);
        let once = |class: OpClass| self.one_place.of_class(class);
        let operands = if convention.loads { once(OpClass::Load) } else { 0 };
        let stored = if convention.stores { once(OpClass::Store) } else { 0 };
        // A sum in memory is loaded, added to and stored.
        let loaded = if convention.loads { once(OpClass::Store) } else { 0 };
        let counts = [
            gear(false),
            index.map(|(_, counts)| of(counts)).sum(),
            each + operands + stored + loaded,
            gear(true) + u64::from(convention.gravity && self.gravity),
        ];
        let off = [0, 1, 2, 3].map(|part| counts[part] as i64 - PRINTED[part] as i64);
        let share = |part: usize| off[part].unsigned_abs() as f64 / PRINTED[part] as f64;
        Counted { convention, counts, off, worst: (0..4).map(share).fold(0.0, f64::max) }
    }
}

fn recorded(text: &impl Text<Lane = f64>) -> OpCounts {
    let mut sum = OpCounts::default();
    Tape::record(text).tally().iter().for_each(|(_, counts)| sum.add(counts));
    sum
}

/// Δx − L int(2 Δx/L): what (5) would need with shifts that wrap, for they meet the positions themselves and not those of an
/// image. Only recorded, never run.
struct NearestImage;

// SAFETY: the body names its slots unconditionally.
unsafe impl Text for NearestImage {
    type Lane = f64;

    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        let dx = m.load(Slot::<f64>::new(Array::X));
        let periods = (dx * m.uniform(2.0)).truncate();
        m.store(Slot::<f64>::new(Array::X), dx - m.uniform(1.0) * periods);
    }
}

/// Gear's predictor or corrector as a convention writes it. Only recorded, never run.
struct Gear {
    convention: Convention,
    corrects: bool,
}

impl Gear {
    fn predict<M: Machine<Lane = f64>>(&self, m: M, row: &[Slot<f64>]) {
        let mut q: Vec<M::V> = row.iter().map(|&slot| m.load(slot)).collect();
        let last = q.len() - 1;
        for k in 0..last {
            if self.convention.scaled {
                for upper in (k..last).rev() {
                    q[upper] = q[upper] + q[upper + 1];
                }
            } else {
                for term in 1..=last - k {
                    let mut more = q[k + term] * m.uniform(0.1);
                    if !self.convention.folded && term > 1 {
                        more = more * m.uniform(0.2);
                    }
                    q[k] = q[k] + more;
                }
            }
        }
        (0..last).for_each(|k| m.store(row[k], q[k]));
    }

    fn correct<M: Machine<Lane = f64>>(&self, m: M, freedom: usize, row: &[Slot<f64>], from: usize) {
        let Convention { gear_values, scaled, folded, .. } = self.convention;
        let cell = m.load_index(Slot::new(Array::DiscCell));
        let force =
            m.gather(Slot::<f64>::new([Array::Fx, Array::Fy, Array::Torque][freedom]), cell, m.uniform(0.0));
        let inverse = [Array::DiscInverseMass, Array::DiscInverseInertia][freedom / 2];
        let mut acceleration = force * m.load(Slot::<f64>::new(inverse));
        if scaled && !folded {
            acceleration = acceleration * m.uniform(0.1);
        }
        let difference = acceleration - m.load(row[2 - from]);
        let coefficients = coefficients(gear_values, Acceleration::OfVelocities);
        for k in from..gear_values {
            let mut more = difference;
            if k != 2 {
                more = more * m.uniform(coefficients[k]);
                if !scaled && !folded {
                    more = more * m.uniform(0.2);
                }
            }
            m.store(row[k - from], m.load(row[k - from]) + more);
        }
    }
}

// SAFETY: the slots depend on the convention only.
unsafe impl Text for Gear {
    type Lane = f64;

    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        let Convention { gear_values, scaled, angle, folded, .. } = self.convention;
        for (freedom, row) in STATE.iter().enumerate() {
            // Without the angle the rotation's row begins with the angular velocity.
            let from = usize::from(freedom == 2 && !angle);
            let row: Vec<Slot<f64>> = row[from..gear_values].iter().map(|&array| Slot::new(array)).collect();
            if self.corrects {
                self.correct(m, freedom, &row, from);
            } else {
                self.predict(m, &row);
                if scaled && !folded {
                    // The forces want the velocities themselves.
                    let velocity = [Array::DiscVx, Array::DiscVy, Array::DiscOmega][freedom];
                    m.store(Slot::<f64>::new(velocity), m.load(row[1 - from]) * m.uniform(0.1));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::lattice_md::study::efficiency_table::{Choice, SOURCES_PARTS, printed_nop};

    fn question(gear_values: usize) -> Question {
        let choice = Choice { gear_values, ..Choice::default() };
        Question { choice: choice.printed(), ..Question::default() }
    }

    /// The scheme as it is counted here is the one that runs, where a convention is that of the printed text or of ours.
    #[test]
    fn what_is_counted_is_what_runs() {
        for gear_values in 4..=6 {
            for (choice, scaled) in
                [(question(gear_values).choice, false), (Choice { gear_values, ..Choice::default() }, true)]
            {
                let (programs, _) = step(&Question { choice, ..Question::default() }).unwrap();
                for (part, corrects) in [(Part::Predictor, false), (Part::Corrector, true)] {
                    let run = programs.iter().find(|step| step.part == part).unwrap().program.tally();
                    let mut expected = OpCounts::default();
                    run.iter().for_each(|(_, counts)| expected.add(counts));
                    let convention =
                        Convention { scaled, folded: !scaled, ..Convention::everything(gear_values) };
                    let counted = recorded(&Gear { convention, corrects });
                    for &class in OpClass::ALL {
                        let (mut run, mut ours) = (expected.of_class(class), counted.of_class(class));
                        if class == OpClass::Load && corrects {
                            // Each row here loads the discs' cells, and those that run load them once; r'' is loaded twice.
                            ours -= 2;
                            ours -= if scaled { 3 } else { 0 };
                        }
                        if class == OpClass::Load && !corrects && scaled {
                            ours -= 3; // Velocities are at hand there.
                        }
                        if class == OpClass::Add && corrects {
                            run -= 1; // Gravity.
                        }
                        assert_eq!(ours, run, "{part:?} {gear_values} {scaled} {class:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_ways_are_all_different_and_the_printed_numbers_are_the_sources() {
        let all: Vec<Convention> = every().collect();
        assert_eq!(all.len(), 3 * 256);
        assert!(all.iter().enumerate().all(|(at, one)| !all[..at].contains(one)));
        let printed = SOURCES_PARTS.map(|part| printed_nop(part).unwrap());
        assert_eq!(printed, [PRINTED[0], PRINTED[1], 24 * PRINTED[2], PRINTED[3]]);
    }

    /// What the issue of counting comes down to, by hand: a place of the printed text has 58 computing operations, 8 shifted copies
    /// and 3 sums.
    #[test]
    fn a_place_of_the_printed_text_counted_by_hand() {
        let texts = Texts::of(&question(5)).unwrap();
        let arithmetic = Convention {
            loads: false,
            stores: false,
            gathers: false,
            shifts: false,
            gravity: false,
            ..Convention::everything(5)
        };
        let place = |convention| texts.counted(convention).counts[2];
        assert_eq!(place(arithmetic), 58);
        assert_eq!(place(Convention { shifts: true, ..arithmetic }), 66);
        assert_eq!(place(Convention { shifts: true, stores: true, ..arithmetic }), 69);
    }
}
