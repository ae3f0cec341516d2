//! Counting conventions: all combinations of counted operations and of forms of Gear's scheme, compared with BP93's four numbers.
//!
//! BP93 prints 59, 12, 1656 = 24 · 69 and 54, but neither a program nor a rule of counting. No convention counts conversions between
//! numbers and indices, because a CRAY word serves as both.

use super::question::{TableScene, TableSceneError, programs_of_step, scene_model};
use crate::frame::{FrameBuilder, ResultFrame};
use stripmine_kernels::isa::{Op, OpClass, OpCounts};
use stripmine_kernels::mask::Mask;
use stripmine_physics::method::lattice_md::{Part, ledger, programs};
use stripmine_physics::scene::Precision;

/// BP93's numbers: predictor, index, one offset of the mask, corrector.
const PRINTED: [u64; 4] = [59, 12, 69, 54];
/// Names of the four numbers.
const NUMBERS: [&str; 4] = ["predictor", "index", "a place", "corrector"];
/// Choices of a convention: the form of Gear's scheme, then the operations counted in addition to arithmetic.
///
/// Derivatives may be scaled by δt^k/k!, and the row of the rotation may begin with the angle or the angular velocity. With folded
/// constants each term has one factor, cells are numbered from the corner, and nothing is rescaled.
const CHOICES: [&str; 8] =
    ["scaled", "with angle", "constants folded", "loads", "stores", "gathers, scatters", "shifts", "gravity"];

/// Counting convention: values of Gear's scheme, and a choice for each of [`CHOICES`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct CountingConvention(u64, [bool; CHOICES.len()]);

/// Convention that counts all operations of the printed program.
const EVERYTHING: [bool; CHOICES.len()] = [false, true, true, true, true, true, true, true];

/// The four numbers by a convention, and their differences from BP93's.
#[derive(Clone, Copy, PartialEq)]
struct ConventionCounts {
    convention: CountingConvention,
    counts: [u64; 4],
    /// Counts minus the printed numbers.
    off: [i64; 4],
    /// Largest relative difference.
    worst: f64,
}

impl ConventionCounts {
    fn exact(&self) -> usize {
        self.off.iter().filter(|off| **off == 0).count()
    }
}

/// Counts the printed program by every convention.
///
/// The frame has the nearest conventions, those with the most exact numbers, and the count of all operations. The numbers are: all
/// conventions, those that give each of the four numbers, those that give all four, and the most numbers given by one.
pub(super) fn conventions(question: &TableScene) -> Result<(ResultFrame, [usize; 7]), TableSceneError> {
    let texts = PrintedOperations::of(question)?;
    let conventions = (4..=6).flat_map(|values| {
        (0..1u32 << CHOICES.len())
            .map(move |bits| CountingConvention(values, std::array::from_fn(|bit| bits >> bit & 1 == 1)))
    });
    let mut all: Vec<ConventionCounts> = conventions.map(|convention| texts.counted(convention)).collect();
    all.sort_by(|a, b| a.worst.total_cmp(&b.worst).then(b.exact().cmp(&a.exact())));
    let most = all.iter().map(ConventionCounts::exact).max().unwrap_or(0);
    let mut shown = all[..6].to_vec();
    let exact = all[6..].iter().filter(|it| it.exact() == most).take(4);
    shown.extend(exact);
    shown.push(texts.counted(CountingConvention(question.choice.gear_values.into(), EVERYTHING)));
    let yes = |is: bool| if is { "yes" } else { "no" };
    let mut rows = FrameBuilder::of(&shown).count("Gear values", |it| it.convention.0);
    for (at, choice) in CHOICES.iter().enumerate() {
        rows = rows.text(*choice, |it| yes(it.convention.1[at]));
    }
    let frame = rows
        .cells(NUMBERS, |it| it.counts)
        .number("largest difference (%)", 1, |it| 100.0 * it.worst)
        .text("what the source's number lacks or has beyond it", describe_differences)
        .frame("conventions", "Ways of counting the printed text, and the four numbers by each");
    let of = |is: &dyn Fn(&&ConventionCounts) -> bool| all.iter().filter(is).count();
    let [predictor, index, place, corrector] = [0, 1, 2, 3].map(|part| of(&|it| it.off[part] == 0));
    Ok((frame, [all.len(), predictor, index, place, corrector, of(&|it| it.exact() == 4), most]))
}

/// Description of the differences.
fn describe_differences(counted: &&ConventionCounts) -> String {
    let off = NUMBERS.iter().zip(counted.off).filter(|(_, off)| *off != 0);
    let words: Vec<String> = off
        .map(|(name, off)| format!("{name}: {} {}", off.abs(), if off > 0 { "too many" } else { "missing" }))
        .collect();
    if words.is_empty() { "nothing".to_owned() } else { words.join(", ") }
}

/// Recorded operations of the printed program.
struct PrintedOperations {
    index: Vec<(&'static str, OpCounts)>,
    offsets: u64,
    all_offsets: OpCounts,
    one_offset: OpCounts,
    gravity: bool,
}

impl PrintedOperations {
    fn of(question: &TableScene) -> Result<PrintedOperations, TableSceneError> {
        let mut model = scene_model(question)?;
        let (all, offsets) = (ledger(&programs_of_step(question)?.0), model.mask.offsets().len() as u64);
        model.mask = Mask::single_offset();
        let one = ledger(&programs(&model, Precision::F64));
        let index = all.entries().iter().filter(|entry| entry.part == Part::Index.name());
        Ok(PrintedOperations {
            index: index.map(|entry| (entry.section, entry.counts.clone())).collect(),
            offsets,
            all_offsets: all.part(Part::Forces.name()),
            one_offset: one.part(Part::Forces.name()),
            gravity: model.gravity != [0.0; 2],
        })
    }

    fn counted(&self, convention: CountingConvention) -> ConventionCounts {
        let CountingConvention(_, [_, _, folded, loads, stores, gathers, shifts, gravity]) = convention;
        let counts = |op: Op| match op.class() {
            OpClass::Load => loads,
            OpClass::Store => stores,
            OpClass::Gather | OpClass::Scatter => gathers,
            OpClass::Shift => shifts,
            OpClass::Convert => op == Op::Truncate,
            _ => true,
        };
        let of = |all: &OpCounts| all.filtered(counts).total();
        let index = self.index.iter().filter(|(section, _)| !(folded && *section == "i of (2)"));
        // One more offset, with its operands and its three sums; a sum in memory is loaded, added to and stored.
        let each = (of(&self.all_offsets) - of(&self.one_offset)) / (self.offsets - 1);
        let once = |class| self.one_offset.of_class(class);
        let operands = if loads { once(OpClass::Load) + once(OpClass::Store) } else { 0 };
        let stored = if stores { once(OpClass::Store) } else { 0 };
        let gear = |corrects| {
            let [arithmetic, load, store, gather] = gear(convention, corrects);
            arithmetic + u64::from(loads) * load + u64::from(stores) * store + u64::from(gathers) * gather
        };
        let counts = [
            gear(false),
            index.map(|(_, counts)| of(counts)).sum(),
            each + operands + stored,
            gear(true) + u64::from(gravity && self.gravity),
        ];
        let off = [0, 1, 2, 3].map(|part| counts[part] as i64 - PRINTED[part] as i64);
        let share = |part: usize| off[part].unsigned_abs() as f64 / PRINTED[part] as f64;
        ConventionCounts { convention, counts, off, worst: (0..4).map(share).fold(0.0, f64::max) }
    }
}

/// Arithmetic, loads, stores and gathers of Gear's predictor or corrector for the three degrees of freedom of a disc.
fn gear(
    CountingConvention(values, [scaled, angle, folded, ..]): CountingConvention,
    corrects: bool,
) -> [u64; 4] {
    // A rescaling, and a separate constant for each term.
    let (rescaled, apart) = (u64::from(scaled && !folded), u64::from(!scaled && !folded));
    let row = |values: u64| match corrects {
        false => {
            let (last, terms) = (values - 1, values * (values - 1) / 2);
            let arithmetic = if scaled { terms } else { 2 * terms + apart * (terms - last) };
            [arithmetic + rescaled, values + rescaled, last + rescaled, 0]
        }
        true => [2 + rescaled + values + (values - 1) * (1 + apart), 3 + values, values, 1],
    };
    let (place, rotation) = (row(values), row(values - u64::from(!angle)));
    std::array::from_fn(|at| 2 * place[at] + rotation[at])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::lattice_md::study::efficiency_table::{SOURCES_PARTS, TableFeatures, printed_nop};

    fn question(gear_values: u8) -> TableScene {
        let choice = TableFeatures { gear_values, ..TableFeatures::default() };
        TableScene { choice: choice.printed(), ..TableScene::default() }
    }

    /// For the conventions of the printed program and of ours, the counts here equal those of the programs that run.
    #[test]
    fn counted_schemes_equal_the_running_programs() {
        for gear_values in 4..=6 {
            for (choice, scaled) in [
                (question(gear_values).choice, false),
                (TableFeatures { gear_values, ..TableFeatures::default() }, true),
            ] {
                let (programs, _) =
                    programs_of_step(&TableScene { choice, ..TableScene::default() }).unwrap();
                for (part, corrects) in [(Part::Predictor, false), (Part::Corrector, true)] {
                    let run = ledger(&programs).part(part.name());
                    let arithmetic = run.filtered(|op| !op.class().moves_data()).total();
                    let convention = CountingConvention(
                        gear_values.into(),
                        [scaled, true, !scaled, true, true, true, true, true],
                    );
                    let [mut counted, mut loads, stores, gathers] = gear(convention, corrects);
                    if corrects {
                        counted += 1; // Gravity.
                        // Each row here loads the discs' cells, whereas the programs load them once. A scaled row here loads r'' twice.
                        loads -= 2 + 3 * u64::from(scaled);
                    } else if scaled {
                        loads -= 3; // Velocities are already loaded there.
                    }
                    let class = |class| run.of_class(class);
                    assert_eq!(
                        [counted, loads, stores, gathers],
                        [arithmetic, class(OpClass::Load), class(OpClass::Store), class(OpClass::Gather)],
                        "{part:?} {gear_values} {scaled}"
                    );
                }
            }
        }
    }

    /// Counted by hand, an offset of the printed program has 58 computing operations, 8 shifted copies and 3 sums.
    #[test]
    fn operations_of_an_offset_match_a_hand_count() {
        let texts = PrintedOperations::of(&question(5)).unwrap();
        let place = |stores, shifts| {
            texts
                .counted(CountingConvention(5, [false, true, true, false, stores, false, shifts, false]))
                .counts[2]
        };
        assert_eq!([place(false, false), place(false, true), place(true, true)], [58, 66, 69]);
        let printed = SOURCES_PARTS.map(|part| printed_nop(part).unwrap());
        assert_eq!(printed, [PRINTED[0], PRINTED[1], 24 * PRINTED[2], PRINTED[3]]);
    }
}
