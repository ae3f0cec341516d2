//! The efficiency table: tables, figures and what came out.

use crate::laboratory::lattice_md::study::efficiency_table::conventions::{Counted, PRINTED};
use crate::laboratory::lattice_md::study::efficiency_table::{
    EfficiencyTable, SOURCES_PARTS, SectionRow, TextCount,
};
use crate::report::{Rows, Section, Table, Verdict};
use stripmine_kernels::printed::EQUATIONS;
use stripmine_physics::method::lattice_md::Part;
use stripmine_physics::number::significant;

/// What came out.
pub fn section(data: &EfficiencyTable) -> Section {
    Section::new("table", "The efficiency table")
        .asks("How many vector operations and clock periods does a step take?")
        .expects("BP93, section 3, counts 59, 12, 1656 = 24·69 and 54 operations for predictor, index, forces and corrector, each at NOP·(n + D) \
                  clock periods with D = 20. It prints no program and no rule of counting.")
        .answers(answer(data))
        .verdict(Verdict::reproduced(data.conventions.all_exact > 0))
        .details(details(data))
        .tables(tables(data))
}

/// The tables of the dataset: the source's own beside both texts, and the ways of counting.
pub fn tables(data: &EfficiencyTable) -> Vec<Table> {
    vec![
        parts(data),
        conventions(data),
        sections_of(
            "printed_sections",
            "The printed text: a place of the mask, equation by equation",
            &data.printed_sections,
        ),
        sections_of(
            "force_sections",
            "Our text: where the operations of the forces go",
            &data.force_sections,
        ),
        lengths(data),
        classes(data),
        savings(data),
    ]
}

fn four(counts: [u64; 4]) -> String {
    let [predictor, index, place, corrector] = counts;
    format!("{predictor}, {index}, {place} a place and {corrector}")
}

/// What came out, in a sentence or two.
fn answer(data: &EfficiencyTable) -> String {
    let counted: Vec<String> = SOURCES_PARTS.iter().map(|&part| data.printed.of(part).to_string()).collect();
    let nearest = data.conventions.nearest.first();
    let nearest = nearest.map_or(String::new(), |nearest| {
        format!(
            ", and the nearest gives {}, at most {:.0} % off",
            four(nearest.counts),
            100.0 * nearest.worst
        )
    });
    let all = match data.conventions.all_exact {
        0 => "none gives all four".to_owned(),
        1 => "one gives all four".to_owned(),
        many => format!("{many} give all four"),
    };
    format!(
        "The source's own program, written as it is printed and counted with every load and store, has {} operations where 59, 12, 1656 and 54 \
         are printed; of {} ways of counting it {all}{nearest}.",
        counted.join(", "),
        data.conventions.tried,
    )
}

/// What the source's numbers need.
fn details(data: &EfficiencyTable) -> Vec<String> {
    let exact = data.conventions.exact;
    let ways = |ways: usize| if ways == 0 { "none".to_owned() } else { ways.to_string() };
    let place: u64 = data.printed_sections.iter().map(|row| row.in_a_place).sum();
    let nearest = data.conventions.nearest.first().map(|nearest| {
        format!(
            "No way of counting gives more than {} of the four printed numbers. The nearest: {}.",
            data.conventions.most_exact,
            nearest.convention.words()
        )
    });
    let more = vec![
        format!(
            "One by one, ways of counting that give the printed number: {} for the predictor's 59, {} for the index's 12, {} for the 69 of a \
             place of the mask, {} for the corrector's 54. 1656 is 24·69, so the source counts nothing outside the loop over the places. A place \
             as printed has {place} operations with its shifted copies; with its three sums stored it has 69.",
            ways(exact[0]),
            ways(exact[1]),
            ways(exact[2]),
            ways(exact[3])
        ),
        format!(
            "Periodic sides: with a halo, which is what runs here, an image is shifted once a cell and side ({} operations beside the source's \
             parts copy Index and Test into the halo). Shifts that wrap would need no halo and the nearest image at every place: {} operations a \
             place and side, {} a step for one periodic side.",
            data.printed.of(Part::Halo),
            data.conventions.nearest_image,
            24 * data.conventions.nearest_image
        ),
        format!(
            "Clock periods of a step by NOP·(n + D) on {}, at NP = {} and LMAX = {}: {:.0} as printed, {:.0} by the printed text ({:.0} without \
             the parts that the source does not count), {:.0} by ours. Our text counts its halo, its checks and scaled derivatives; that its sum \
             is near the printed one is two differences that cancel.",
            data.machine,
            data.particles,
            data.cells,
            data.source_clocks,
            data.printed.clocks,
            data.printed.clocks_of_the_sources_parts(),
            data.ours.clocks
        ),
    ];
    nearest.into_iter().chain(more).collect()
}

fn parts(data: &EfficiencyTable) -> Table {
    let clocks = |text: &TextCount, part: Part| -> f64 {
        text.parts.iter().filter(|row| row.part == part.name()).map(|row| row.clocks).sum()
    };
    // The source's numbers, where it has any, and what is counted in the printed text and in ours.
    let parts = Part::ALL.iter().map(|&part| {
        let source = data.source.iter().find(|row| row.part == part.name());
        let texts = [&data.printed, &data.ours].map(|text| (text.of(part), clocks(text, part)));
        let texts = texts.map(|(nop, clocks)| ((nop > 0).then_some(nop), (clocks != 0.0).then_some(clocks)));
        (part.name(), source.map(|row| row.nop), source.map(|row| row.clocks), texts)
    });
    let parts =
        parts.filter(|(_, source, _, texts)| source.is_some() || texts.iter().any(|(nop, _)| nop.is_some()));
    let sums = [&data.printed, &data.ours]
        .map(|text| (Some(text.parts.iter().map(|row| row.counted).sum()), Some(text.clocks)));
    let sum = ("step", Some(data.source.iter().map(|row| row.nop).sum()), Some(data.source_clocks), sums);
    let each = |clocks: f64| clocks / data.particles as f64;
    let assumed = (!data.assumed.is_empty())
        .then(|| format!("Assumed numbers of this machine: {}.", data.assumed.join(", ")));
    Rows::of(parts.chain([sum]))
        .text("part", |(part, ..)| *part)
        .cell("printed in 1993", |(_, nop, ..)| *nop)
        .cell("printed text, counted", |(.., [(nop, _), _])| *nop)
        .cell("ours, counted", |(.., [_, (nop, _)])| *nop)
        .number("clocks printed", 0, |(_, _, clocks, _)| *clocks)
        .number("clocks, printed text", 0, |(.., [(_, clocks), _])| *clocks)
        .number("clocks, ours", 0, |(.., [_, (_, clocks)])| *clocks)
        .table("efficiency_table", "Operations and clock periods of one step (BP93, section 3)")
        .note(format!(
            "NP = {} discs, LMAX = {} cells, occupancy {:.4}; a count of 1 is one vector instruction over n elements, loads, stores, gathers and \
             shifted copies among them. The source counts the lattice vectors nowhere, and nothing returns discs into a periodic box or repeats \
             the halo: these rows are beside its equations.",
            data.particles, data.cells, data.occupancy
        ))
        .note(format!(
            "Clock periods by NOP·(n + D) on: {}. A disc and step: printed {:.0}, the printed text {:.0}, ours {:.0}; the operations of the \
             printed text on a scalar machine (n·D) {:.0}: the vector machine is {:.1} times faster. At {} ns a clock period a step takes {:.4} \
             s by the printed count, {:.4} s by the printed text, {:.4} s by ours.",
            data.machine,
            each(data.source_clocks),
            each(data.printed.clocks),
            each(data.ours.clocks),
            each(data.printed.scalar_clocks),
            data.printed.scalar_clocks / data.printed.clocks,
            significant(data.clock_period_ns, 4),
            data.source_clocks * data.clock_period_ns * 1e-9,
            data.printed.clocks * data.clock_period_ns * 1e-9,
            data.ours.clocks * data.clock_period_ns * 1e-9
        ))
        .notes(assumed)
}

/// What of a way of counting is off, in words.
fn residual(counted: &Counted) -> String {
    let names = ["predictor", "index", "a place", "corrector"];
    let off = names.iter().zip(counted.off).filter(|(_, off)| *off != 0);
    let words: Vec<String> = off
        .map(|(name, off)| match off {
            off if off > 0 => format!("{name}: {off} too many"),
            off => format!("{name}: {} missing", -off),
        })
        .collect();
    if words.is_empty() { "nothing".to_owned() } else { words.join(", ") }
}

fn conventions(data: &EfficiencyTable) -> Table {
    let yes = |is: bool| if is { "yes" } else { "no" };
    let printed = PRINTED.map(|count| count.to_string());
    Rows::of(data.conventions.nearest.iter().chain([&data.conventions.everything]))
        .count("Gear values", |it| it.convention.gear_values)
        .text("scaled", |it| yes(it.convention.scaled))
        .text("with angle", |it| yes(it.convention.angle))
        .text("constants folded", |it| yes(it.convention.folded))
        .text("loads", |it| yes(it.convention.loads))
        .text("stores", |it| yes(it.convention.stores))
        .text("gathers, scatters", |it| yes(it.convention.gathers))
        .text("shifts", |it| yes(it.convention.shifts))
        .text("gravity", |it| yes(it.convention.gravity))
        .cells(["predictor", "index", "a place", "corrector"], |it| it.counts)
        .number("largest difference (%)", 1, |it| 100.0 * it.worst)
        .text("what the source's number lacks or has beyond it", |it| residual(it))
        .table("conventions", "Ways of counting the printed text, and what each makes of the four parts")
        .note(format!(
            "Printed: {}. {} ways, every combination of the first nine columns, counted on recorded programs; shown are the nearest to all four, \
             then those that give the most of them exactly, last the printed text with all that it executes. Changes between numbers and index \
             vectors are counted by none: a word of a CRAY is both. Stores of a place are those of its three sums.",
            printed.join(", "),
            data.conventions.tried
        ))
}

fn sections_of(name: &str, title: &str, sections: &[SectionRow]) -> Table {
    let equation = |section: &str| {
        EQUATIONS.iter().find(|(known, _)| *known == section).map_or("", |(_, meaning)| *meaning)
    };
    let sum = |value: fn(&SectionRow) -> u64| sections.iter().map(value).sum();
    let forces = SectionRow {
        section: "forces",
        in_a_place: sum(|row| row.in_a_place),
        shifts_in_a_place: sum(|row| row.shifts_in_a_place),
        once: sum(|row| row.once),
        share: 1.0,
    };
    Rows::of(sections.iter().chain([&forces]))
        .text("section", |row| row.section)
        .text("what it is", |row| equation(row.section))
        .count("operations of a place", |row| row.in_a_place)
        .count("of these shifted copies", |row| row.shifts_in_a_place)
        .count("operations once a cell", |row| row.once)
        .number("share of the forces (%)", 1, |row| 100.0 * row.share)
        .table(name, title)
}

fn lengths(data: &EfficiencyTable) -> Table {
    let texts = [("printed", &data.printed), ("ours", &data.ours)].into_iter();
    Rows::of(texts.flat_map(|(name, text)| text.parts.iter().map(move |row| (name, row))))
        .text("text", |(name, _)| *name)
        .text("part", |(_, row)| row.part)
        .count("NOP", |(_, row)| row.counted)
        .count("computing", |(_, row)| row.computing)
        .count("moving data", |(_, row)| row.moving)
        .text("n is", |(_, row)| row.length)
        .count("n", |(_, row)| row.n)
        .number("clocks", 0, |(_, row)| row.clocks)
        .table("vector_lengths", "Operations by the length of their vectors")
}

fn classes(data: &EfficiencyTable) -> Table {
    let shown = |at: &usize| data.classes.iter().any(|row| row.parts[*at] != [0, 0]);
    let both = |name: &str| ["printed", "ours"].map(|text| format!("{name}, {text}"));
    let mut rows = Rows::of(&data.classes).text("class", |row| row.class);
    for at in (0..Part::ALL.len()).filter(shown) {
        rows = rows.cells(both(Part::ALL[at].name()), |row| row.parts[at]);
    }
    rows.cells(both("step"), |row| row.total).table("operation_classes", "Counted operations by class")
}

fn savings(data: &EfficiencyTable) -> Table {
    let shown = |at: &usize| data.savings.iter().any(|row| row.parts[*at] != 0);
    let mut rows = Rows::of(&data.savings).text("scene", |row| row.variant);
    for at in (0..Part::ALL.len()).filter(shown) {
        rows = rows.count(format!("NOP {}", Part::ALL[at].name()), |row| row.parts[at]);
    }
    rows.number("clocks a step", 0, |row| row.clocks)
        .number("relative", 3, |row| row.relative)
        .table("savings", "What a simpler scene saves")
        .note("No friction, no rotation: no spin, no torque, no angle. Equal discs: radius and mass are numbers, not vectors.")
}
