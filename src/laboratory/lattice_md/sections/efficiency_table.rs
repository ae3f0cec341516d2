//! The efficiency table: tables, figures and what came out.

use crate::laboratory::lattice_md::study::efficiency_table::conventions::{Counted, PRINTED};
use crate::laboratory::lattice_md::study::efficiency_table::{
    EfficiencyTable, SOURCES_PARTS, SectionRow, TextCount,
};
use crate::report;
use crate::report::{Cell, Section, Table, Verdict};
use stripmine_kernels::printed::EQUATIONS;
use stripmine_physics::method::lattice_md::Part;
use stripmine_physics::number::significant;

/// What came out.
pub fn section(data: &EfficiencyTable) -> Section {
    Section::new("table", "The efficiency table", report::Part::Machine)
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
            "; the nearest ({}) gives {}, at most {:.0} % off",
            nearest.convention.words(),
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
         are printed. Of {} ways of counting it {all}, and none more than {}{nearest}.",
        counted.join(", "),
        data.conventions.tried,
        data.conventions.most_exact
    )
}

/// What the source's numbers need.
fn details(data: &EfficiencyTable) -> Vec<String> {
    let exact = data.conventions.exact;
    let ways = |ways: usize| if ways == 0 { "none".to_owned() } else { ways.to_string() };
    let place: u64 = data.printed_sections.iter().map(|row| row.in_a_place).sum();
    vec![
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
    ]
}

fn headings(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

fn parts(data: &EfficiencyTable) -> Table {
    let clocks = |text: &TextCount, part: Part| -> f64 {
        text.parts.iter().filter(|row| row.part == part.name()).map(|row| row.clocks).sum()
    };
    let counted = |count: u64| if count == 0 { Cell::Nothing } else { Cell::Count(count) };
    let periods = |clocks: f64| if clocks == 0.0 { Cell::Nothing } else { Cell::Number(clocks, 0) };
    let mut rows: Vec<Vec<Cell>> = vec![];
    for &part in Part::ALL {
        let source = data.source.iter().find(|row| row.part == part.name());
        let [printed, ours] = [&data.printed, &data.ours].map(|text| (text.of(part), clocks(text, part)));
        if source.is_none() && printed.0 + ours.0 == 0 {
            continue;
        }
        rows.push(vec![
            part.name().into(),
            source.map_or(Cell::Nothing, |row| Cell::Count(row.nop)),
            counted(printed.0),
            counted(ours.0),
            source.map_or(Cell::Nothing, |row| Cell::Number(row.clocks, 0)),
            periods(printed.1),
            periods(ours.1),
        ]);
    }
    let sum = |text: &TextCount| Cell::Count(text.parts.iter().map(|row| row.counted).sum());
    rows.push(vec![
        "step".into(),
        Cell::Count(data.source.iter().map(|row| row.nop).sum()),
        sum(&data.printed),
        sum(&data.ours),
        Cell::Number(data.source_clocks, 0),
        Cell::Number(data.printed.clocks, 0),
        Cell::Number(data.ours.clocks, 0),
    ]);
    let each = |clocks: f64| clocks / data.particles as f64;
    let mut notes = vec![
        format!(
            "NP = {} discs, LMAX = {} cells, occupancy {:.4}; a count of 1 is one vector instruction over n elements, loads, stores, gathers and \
             shifted copies among them. The source counts the lattice vectors nowhere, and nothing returns discs into a periodic box or repeats \
             the halo: these rows are beside its equations.",
            data.particles, data.cells, data.occupancy
        ),
        format!(
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
        ),
    ];
    if !data.assumed.is_empty() {
        notes.push(format!("Assumed numbers of this machine: {}.", data.assumed.join(", ")));
    }
    Table {
        name: "efficiency_table".into(),
        title: "Operations and clock periods of one step (BP93, section 3)".to_owned(),
        columns: headings(&[
            "part",
            "printed in 1993",
            "printed text, counted",
            "ours, counted",
            "clocks printed",
            "clocks, printed text",
            "clocks, ours",
        ]),
        rows,
        notes,
    }
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
    let yes = |is: bool| Cell::from(if is { "yes" } else { "no" });
    let row = |counted: &Counted| {
        let way = counted.convention;
        let mut cells = vec![
            Cell::Count(way.gear_values as u64),
            yes(way.scaled),
            yes(way.angle),
            yes(way.folded),
            yes(way.loads),
            yes(way.stores),
            yes(way.gathers),
            yes(way.shifts),
            yes(way.gravity),
        ];
        cells.extend(counted.counts.map(Cell::Count));
        cells.push(Cell::Number(100.0 * counted.worst, 1));
        cells.push(residual(counted).as_str().into());
        cells
    };
    let mut rows: Vec<Vec<Cell>> = data.conventions.nearest.iter().map(row).collect();
    rows.push(row(&data.conventions.everything));
    let printed = PRINTED.map(|count| count.to_string());
    Table {
        name: "conventions".into(),
        title: "Ways of counting the printed text, and what each makes of the four parts".to_owned(),
        columns: headings(&[
            "Gear values",
            "scaled",
            "with angle",
            "constants folded",
            "loads",
            "stores",
            "gathers, scatters",
            "shifts",
            "gravity",
            "predictor",
            "index",
            "a place",
            "corrector",
            "largest difference (%)",
            "what the source's number lacks or has beyond it",
        ]),
        rows,
        notes: vec![format!(
            "Printed: {}. {} ways, every combination of the first nine columns, counted on recorded programs; shown are the nearest to all four, \
             then those that give the most of them exactly, last the printed text with all that it executes. Changes between numbers and index \
             vectors are counted by none: a word of a CRAY is both. Stores of a place are those of its three sums.",
            printed.join(", "),
            data.conventions.tried
        )],
    }
}

fn sections_of(name: &str, title: &str, sections: &[SectionRow]) -> Table {
    let equation = |section: &str| {
        EQUATIONS.iter().find(|(known, _)| *known == section).map_or("", |(_, meaning)| *meaning)
    };
    let mut rows: Vec<Vec<Cell>> = sections
        .iter()
        .map(|row| {
            vec![
                row.section.into(),
                equation(row.section).into(),
                row.in_a_place.into(),
                row.shifts_in_a_place.into(),
                row.once.into(),
                Cell::Number(100.0 * row.share, 1),
            ]
        })
        .collect();
    let sum = |value: fn(&SectionRow) -> u64| Cell::Count(sections.iter().map(value).sum());
    rows.push(vec![
        "forces".into(),
        "".into(),
        sum(|row| row.in_a_place),
        sum(|row| row.shifts_in_a_place),
        sum(|row| row.once),
        Cell::Number(100.0, 1),
    ]);
    Table {
        name: name.into(),
        title: title.to_owned(),
        columns: headings(&[
            "section",
            "what it is",
            "operations of a place",
            "of these shifted copies",
            "operations once a cell",
            "share of the forces (%)",
        ]),
        rows,
        notes: vec![],
    }
}

fn lengths(data: &EfficiencyTable) -> Table {
    let rows = [("printed", &data.printed), ("ours", &data.ours)].into_iter().flat_map(|(name, text)| {
        text.parts.iter().map(move |row| {
            vec![
                name.into(),
                row.part.into(),
                row.counted.into(),
                row.computing.into(),
                row.moving.into(),
                row.length.into(),
                row.n.into(),
                Cell::Number(row.clocks, 0),
            ]
        })
    });
    Table {
        name: "vector_lengths".into(),
        title: "Operations by the length of their vectors".to_owned(),
        columns: headings(&["text", "part", "NOP", "computing", "moving data", "n is", "n", "clocks"]),
        rows: rows.collect(),
        notes: vec![],
    }
}

fn classes(data: &EfficiencyTable) -> Table {
    let shown = |at: &usize| data.classes.iter().any(|row| row.parts[*at] != [0, 0]);
    let parts: Vec<usize> = (0..Part::ALL.len()).filter(shown).collect();
    let mut columns = vec!["class".to_owned()];
    for name in parts.iter().map(|&at| Part::ALL[at].name()).chain(["step"]) {
        columns.extend(["printed", "ours"].map(|text| format!("{name}, {text}")));
    }
    let rows = data.classes.iter().map(|row| {
        let mut cells = vec![row.class.into()];
        cells.extend(parts.iter().flat_map(|&at| row.parts[at]).chain(row.total).map(Cell::Count));
        cells
    });
    Table {
        name: "operation_classes".into(),
        title: "Counted operations by class".to_owned(),
        columns,
        rows: rows.collect(),
        notes: vec![],
    }
}

fn savings(data: &EfficiencyTable) -> Table {
    let mut columns = vec!["scene".to_owned()];
    let shown = |at: &usize| data.savings.iter().any(|row| row.parts[*at] != 0);
    let parts: Vec<usize> = (0..Part::ALL.len()).filter(shown).collect();
    columns.extend(parts.iter().map(|&at| format!("NOP {}", Part::ALL[at].name())));
    columns.extend(["clocks a step".to_owned(), "relative".to_owned()]);
    let rows = data.savings.iter().map(|row| {
        let mut cells = vec![row.variant.into()];
        cells.extend(parts.iter().map(|&at| Cell::Count(row.parts[at])));
        cells.extend([Cell::Number(row.clocks, 0), Cell::Number(row.relative, 3)]);
        cells
    });
    Table {
        name: "savings".into(),
        title: "What a simpler scene saves".to_owned(),
        columns,
        rows: rows.collect(),
        notes: vec![
            "No friction, no rotation: no spin, no torque, no angle. Equal discs: radius and mass are numbers, not vectors.".to_owned(),
        ],
    }
}
