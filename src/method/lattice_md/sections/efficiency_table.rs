//! The efficiency table: tables, figures and what came out.

use crate::method::lattice_md::Part;
use crate::method::lattice_md::study::efficiency_table::EfficiencyTable;
use crate::method::lattice_md::study::efficiency_table::differences::{PASCAL_FACTORS, by_the_source};
use crate::number::significant;
use crate::report;
use crate::report::{Cell, Section, Table, Verdict};

/// What came out.
pub fn section(data: &EfficiencyTable) -> Section {
    Section {
        name: "table".into(),
        title: "The efficiency table".into(),
        part: report::Part::Machine,
        question: "How many vector operations and clock periods does a step take?".into(),
        expected: "BP93, section 3, counts 59, 12, 1656 and 54 operations for predictor, index, forces and corrector, each at NOP·(n + D) \
                   clock periods with D = 20."
            .into(),
        answer: answer(data),
        details: details(data),
        verdict: verdict(data),
        again: "stripmine reproduce --only table".into(),
        figures: vec![],
        tables: tables(data),
        excerpt: None,
        film: None,
        seeds: vec![],
        depends_on_host: false,
        provenance: None,
    }
}

/// The tables of the dataset: the source's own, and what explains the difference to ours.
pub fn tables(data: &EfficiencyTable) -> Vec<Table> {
    vec![parts(data), differences(data), force_sections(data), classes(data), savings(data)]
}

/// Whether every part's count is within a fifth of the printed one.
fn verdict(data: &EfficiencyTable) -> Verdict {
    let near = |part: &Part| {
        let rows = || data.parts.iter().filter(|row| row.part == part.name());
        let counted: u64 = rows().map(|row| row.counted).sum();
        rows().find_map(|row| row.printed).is_none_or(|printed| counted.abs_diff(printed) * 5 <= printed)
    };
    if Part::ALL.iter().all(near) { Verdict::Reproduced } else { Verdict::Partly }
}

/// What came out, in a sentence.
fn answer(data: &EfficiencyTable) -> String {
    let parts: Vec<String> = Part::ALL
        .iter()
        .filter_map(|part| {
            let rows = || data.parts.iter().filter(|row| row.part == part.name());
            let printed = rows().find_map(|row| row.printed)?;
            let counted: u64 = rows().map(|row| row.counted).sum();
            Some(format!("{} {counted} (printed {printed})", part.name()))
        })
        .collect();
    format!(
        "{}; at NP = {} and occupancy {:.2} that is {:.0} clock periods a disc and step, {:.3} of the printed formula's.",
        parts.join(", "),
        data.particles,
        data.occupancy,
        data.counted_clocks / data.particles as f64,
        data.counted_clocks / data.printed_clocks
    )
}

/// Where the differences come from.
fn details(data: &EfficiencyTable) -> Vec<String> {
    let [predictor, index, corrector] = [Part::Predictor, Part::Index, Part::Corrector].map(|part| {
        let (ours, printed) = by_the_source(&data.differences, part);
        (ours, printed.unwrap_or_default())
    });
    vec![
        format!(
            "One way of counting explains most of the difference: arithmetic, stores, gathers and scatters of what the source's \
             equations ask for; no loads, no changes between numbers and index vectors, nothing that our programs do beside the \
             equations. By it our index has {} operations (printed {}) and our corrector {} (printed {}). These are the smallest \
             programs that give the printed numbers; the table below names every section that is left out.",
            index.0, index.1, corrector.0, corrector.1
        ),
        format!(
            "The predictor is {} by the same count, because ours keeps derivatives scaled by powers of dt. With the {PASCAL_FACTORS} \
             factors of the Pascal triangle that derivatives without scale need, it is {}; printed are {}. We found no program \
             with exactly that number.",
            predictor.0,
            predictor.0 + PASCAL_FACTORS,
            predictor.1
        ),
    ]
}

fn headings(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

fn parts(data: &EfficiencyTable) -> Table {
    let number = |value: Option<f64>| value.map_or(Cell::Nothing, |value| Cell::Number(value, 0));
    let mut rows: Vec<Vec<Cell>> = data
        .parts
        .iter()
        .map(|row| {
            vec![
                row.part.into(),
                row.printed.map_or(Cell::Nothing, Cell::Count),
                row.counted.into(),
                row.computing.into(),
                row.moving.into(),
                row.length.into(),
                row.n.into(),
                number(row.printed_clocks),
                Cell::Number(row.counted_clocks, 0),
            ]
        })
        .collect();
    rows.push(vec![
        "step".into(),
        Cell::Count(data.parts.iter().filter_map(|row| row.printed).sum()),
        Cell::Count(data.parts.iter().map(|row| row.counted).sum()),
        Cell::Count(data.parts.iter().map(|row| row.computing).sum()),
        Cell::Count(data.parts.iter().map(|row| row.moving).sum()),
        "".into(),
        Cell::Nothing,
        Cell::Number(data.printed_clocks, 0),
        Cell::Number(data.counted_clocks, 0),
    ]);
    let each = |clocks: f64| clocks / data.particles as f64;
    let mut notes = vec![
        format!(
            "NP = {} discs, LMAX = {} cells, occupancy {:.4}; a count of 1 is one vector instruction over n elements.",
            data.particles, data.cells, data.occupancy
        ),
        format!(
            "Clock periods by NOP·(n + D) on: {}. A disc and step: printed {:.0}, counted {:.0}, the counted \
             operations on a scalar machine (n·D) {:.0}: the vector machine is {:.1} times faster.",
            data.machine,
            each(data.printed_clocks),
            each(data.counted_clocks),
            each(data.scalar_clocks),
            data.scalar_clocks / data.counted_clocks
        ),
        "The source counts no operation for bringing the discs' quantities onto the lattice; we do. Its forces run \
         over LMAX cells, ours also over the halo at the ends of each row."
            .to_owned(),
    ];
    notes.push(format!(
        "At {} ns a clock period such a step takes {:.4} s by the printed count, {:.4} s by ours.",
        significant(data.clock_period_ns, 4),
        data.printed_clocks * data.clock_period_ns * 1e-9,
        data.counted_clocks * data.clock_period_ns * 1e-9
    ));
    if !data.assumed.is_empty() {
        notes.push(format!("Assumed numbers of this machine: {}.", data.assumed.join(", ")));
    }
    Table {
        name: "efficiency_table".into(),
        title: "Operations and clock periods of one step (BP93, section 3)".to_owned(),
        columns: headings(&[
            "part",
            "NOP printed",
            "NOP counted",
            "computing",
            "moving data",
            "n is",
            "n",
            "clocks printed",
            "clocks counted",
        ]),
        rows,
        notes,
    }
}

fn differences(data: &EfficiencyTable) -> Table {
    let mut rows = Vec::new();
    for part in [Part::Predictor, Part::Index, Part::Corrector] {
        let of_part = || data.differences.iter().filter(|row| row.part == part.name());
        rows.extend(of_part().map(|row| {
            vec![
                row.part.into(),
                row.section.into(),
                row.ours.into(),
                row.loads.into(),
                row.conversions.into(),
                row.counted.into(),
                row.only_ours.unwrap_or("in the source's equations").into(),
            ]
        }));
        let (counted, printed) = by_the_source(&data.differences, part);
        rows.push(vec![
            part.name().into(),
            "all".into(),
            of_part().map(|row| row.ours).sum::<u64>().into(),
            of_part().map(|row| row.loads).sum::<u64>().into(),
            of_part().map(|row| row.conversions).sum::<u64>().into(),
            counted.into(),
            printed.map_or(String::new(), |printed| format!("printed: {printed}")).as_str().into(),
        ]);
    }
    Table {
        name: "differences".into(),
        title: "Which of our operations the source's count has".to_owned(),
        columns: headings(&[
            "part",
            "section",
            "ours",
            "of these loads",
            "of these index conversions",
            "by the source's count",
            "why",
        ]),
        rows,
        notes: vec![],
    }
}

fn force_sections(data: &EfficiencyTable) -> Table {
    let mut rows: Vec<Vec<Cell>> = data
        .force_sections
        .iter()
        .map(|row| {
            vec![
                row.section.into(),
                row.counted.into(),
                Cell::Number(row.each_place, 2),
                Cell::Number(row.loads_each_place, 2),
                Cell::Number(row.divides_and_roots_each_place, 2),
                Cell::Number(100.0 * row.share, 1),
            ]
        })
        .collect();
    let sum = |value: fn(&crate::method::lattice_md::study::efficiency_table::SectionRow) -> f64| {
        Cell::Number(data.force_sections.iter().map(value).sum(), 2)
    };
    rows.push(vec![
        "forces".into(),
        Cell::Count(data.force_sections.iter().map(|row| row.counted).sum()),
        sum(|row| row.each_place),
        sum(|row| row.loads_each_place),
        sum(|row| row.divides_and_roots_each_place),
        Cell::Number(100.0, 1),
    ]);
    Table {
        name: "force_sections".into(),
        title: "Where the operations of the forces go".to_owned(),
        columns: headings(&[
            "section",
            "NOP counted",
            "each mask place",
            "loads and shifts",
            "divides and roots",
            "share (%)",
        ]),
        rows,
        notes: vec![
            "The source prints 69 operations a place (1656/24) and no breakdown, so the difference has no line of its \
             own. What ours does without: products with Test (an empty cell stands far from everything), copies of a \
             shifted vector (a load at a shift is the copy), operations between scalars."
                .to_owned(),
        ],
    }
}

fn classes(data: &EfficiencyTable) -> Table {
    let mut columns = vec!["class".to_owned()];
    columns.extend(Part::ALL.iter().map(|part| part.name().to_owned()));
    columns.push("step".to_owned());
    let rows = data.classes.iter().map(|row| {
        let mut cells = vec![row.class.into()];
        cells.extend(row.parts.iter().map(|&count| Cell::Count(count)));
        cells.push(row.total.into());
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
    columns.extend(Part::ALL.iter().map(|part| format!("NOP {}", part.name())));
    columns.extend(["clocks a step".to_owned(), "relative".to_owned()]);
    let rows = data.savings.iter().map(|row| {
        let mut cells = vec![row.variant.into()];
        cells.extend(row.parts.iter().map(|&count| Cell::Count(count)));
        cells.extend([Cell::Number(row.clocks, 0), Cell::Number(row.relative, 3)]);
        cells
    });
    Table {
        name: "savings".into(),
        title: "What a simpler scene saves".to_owned(),
        columns,
        rows: rows.collect(),
        notes: vec![
            "No friction, no rotation: no spin, no torque, no angle. Equal discs: radius and mass are numbers, not \
             vectors."
                .to_owned(),
        ],
    }
}
