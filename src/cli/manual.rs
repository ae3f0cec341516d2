//! Text of help and manual pages beside the options: examples, exit codes, environment, further reading.

/// Examples by verb; those under the empty verb are shown in the overview.
const EXAMPLES: &[(&str, &[(&str, &str)])] = &[
    (
        "",
        &[
            ("stripmine run pipe-small", "runs a preset into the folder pipe-small.run"),
            ("stripmine plot pipe-small.run", "plots its observables and last state"),
            (
                "stripmine explain langevin-dense --of pressure --error 1%",
                "finds the cheapest run with this error",
            ),
            ("stripmine table", "compares the efficiency table of 1993 with our count"),
            ("stripmine reproduce --quick", "makes the report in half a minute"),
        ],
    ),
    (
        "run",
        &[
            ("stripmine run hard-disks", "runs a preset"),
            (
                "stripmine run scene.toml --out first.run --set run.steps=1000",
                "runs a scene file with another number of steps",
            ),
            ("stripmine run hard-disks --seeds 8", "runs eight different seeds and averages them"),
            ("stripmine run pipe --resume", "starts the run, or resumes it after an interruption"),
        ],
    ),
    (
        "scan",
        &[
            (
                "stripmine scan hard-disks --over particles.packing_fraction=0.05:0.65:20 --until compressibility=1%",
                "finds Z at 20 packing fractions to 1 %",
            ),
            (
                "stripmine scan langevin-dense --over law.bath_temperature=1,2,4 --over law.drag=0.5,1 --seeds 4",
                "runs a grid of six points with four seeds each",
            ),
        ],
    ),
    (
        "average",
        &[
            ("stripmine average pipe-small.run", "prints means with errors"),
            ("stripmine average a.run b.run --json", "joins two runs of one scene with different seeds"),
            ("stripmine average hard-disks.scan", "prints the table of a scan again"),
        ],
    ),
    (
        "explain",
        &[
            (
                "stripmine explain langevin-dense --of pressure --error 1%",
                "finds the cheapest run with this error, with reasons",
            ),
            (
                "stripmine explain kepler --of energy_error --error 1e-6 --write plan.toml",
                "finds the largest step that conserves the energy this well",
            ),
            ("stripmine explain pipe-small --estimate", "uses cached measurements only"),
        ],
    ),
    (
        "plot",
        &[
            (
                "stripmine plot pipe-small.run",
                "writes a page with all pictures and the film to pipe-small.plots, and SVG and PNG",
            ),
            (
                "stripmine plot melting.run --film --color psi6",
                "also writes the film alone, coloured by order",
            ),
            ("stripmine plot hopper", "draws the start of a scene, with its walls"),
        ],
    ),
    (
        "bench",
        &[
            (
                "stripmine bench lattice --packing-fraction 0.84 --steps 1e4 --threads 1",
                "measures steps a second of dense discs",
            ),
            ("stripmine bench langevin --json", "measures Langevin particles and prints JSON"),
        ],
    ),
    (
        "compare",
        &[
            (
                "stripmine compare plummer --against machine.engine=reference",
                "compares two engines bit by bit",
            ),
            (
                "stripmine compare hard-disks --against particles.packing_fraction=0.7",
                "compares means, with the difference in standard errors",
            ),
        ],
    ),
    (
        "emit",
        &[(
            "stripmine emit bench --isa rvv --out bench.rvv",
            "writes the programs of a scene as RISC-V vector code, with its arrays",
        )],
    ),
    (
        "price",
        &[(
            "stripmine price kernel.json --machine cray-1",
            "operations and clock periods of a kernel of your own",
        )],
    ),
    (
        "scene",
        &[
            ("stripmine scene keys lattice-md", "lists every key with unit, default and meaning"),
            ("stripmine scene keys wall", "lists the keys of all methods with a word"),
            ("stripmine scene check pipe-small", "compares the step with every theoretical limit"),
            ("stripmine scene show pipe-small", "prints a preset as a starting point"),
        ],
    ),
    (
        "reproduce",
        &[
            ("stripmine reproduce --only table --only misprints", "makes two items"),
            ("stripmine reproduce --out report", "makes all default items in a folder"),
        ],
    ),
    ("chart", &[("stripmine chart soft-hard", "compares soft discs with hard discs")]),
    (
        "table",
        &[(
            "stripmine table --ladder --machine cray-1",
            "shows what strip-mining, chaining and memory ports add",
        )],
    ),
    (
        "listing",
        &[(
            "stripmine listing forces --json",
            "prints operation, destination and sources of each instruction",
        )],
    ),
    ("calibrate", &[("stripmine calibrate --out host.toml", "measures this host in 75 seconds")]),
    (
        "validate-model",
        &[("stripmine validate-model --host host.toml", "compares predictions with measurements")],
    ),
    (
        "completions",
        &[("stripmine completions bash", "save it to ~/.local/share/bash-completion/completions/stripmine")],
    ),
    ("man", &[("stripmine man run", "prints the page of a verb; pipe it into man -l -")]),
];

/// Exit codes and their meanings.
const EXIT_CODES: &[(&str, &str)] = &[
    ("0", "success, also if the reader closes the pipe"),
    ("2", "wrong arguments, or the folder holds something else"),
    ("3", "invalid scene or input file; every mistake is listed"),
    ("4", "physics failure, unreachable error, or prediction outside calibration"),
    ("5", "reading or writing failed, or out of memory or threads"),
    ("6", "damaged checkpoint"),
    ("130", "interrupted; a run leaves a checkpoint"),
];

/// Environment variables that are read.
const ENVIRONMENT: &[(&str, &str)] = &[
    ("COLUMNS", "width of tables and messages"),
    ("RAYON_NUM_THREADS", "threads without --threads, at most 1024"),
];

/// Further reading.
const SEE_ALSO: &str = "stripmine VERB --help, stripmine man VERB, stripmine scene keys, README";

/// Heading with its entries, each a text and its meaning.
pub(super) type HelpSection = (&'static str, Vec<(&'static str, &'static str)>);

/// Parts for a verb, or for the command as a whole if the verb is empty.
pub(super) fn parts(verb: &str) -> Vec<HelpSection> {
    let examples =
        EXAMPLES.iter().filter(|(of, _)| *of == verb).map(|(_, examples)| ("Examples", examples.to_vec()));
    let codes = [
        ("Exit codes", EXIT_CODES.to_vec()),
        ("Environment", ENVIRONMENT.to_vec()),
        ("See also", vec![(SEE_ALSO, "")]),
    ];
    examples.chain(codes).collect()
}

/// Parts of a verb as help shows them.
pub(super) fn text(verb: &str) -> String {
    written(parts(verb))
}

/// Examples of a verb as short help shows them.
pub(super) fn examples(verb: &str) -> String {
    written(parts(verb).into_iter().filter(|(heading, _)| *heading == "Examples"))
}

fn written(parts: impl IntoIterator<Item = HelpSection>) -> String {
    let mut text = String::new();
    for (heading, entries) in parts {
        text.push_str(&format!("{heading}:\n"));
        for (what, meaning) in entries {
            // A command has its own line, so that it can be copied.
            let between = if heading == "Examples" { "\n      " } else { "  " };
            let end = if meaning.is_empty() { String::new() } else { format!("{between}{meaning}") };
            text.push_str(&format!("  {what}{end}\n"));
        }
        text.push('\n');
    }
    text.trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::command;
    use stripmine_physics::method::METHODS;

    #[test]
    fn examples_parse_and_cover_every_verb() {
        for (_, examples) in EXAMPLES {
            for (example, _) in *examples {
                let understood = command(METHODS).try_get_matches_from(example.split(' '));
                assert!(understood.is_ok(), "{example}: {}", understood.unwrap_err());
            }
        }
        for verb in command(METHODS).get_subcommands().filter(|verb| !verb.is_hide_set()) {
            assert!(
                EXAMPLES.iter().any(|(of, _)| *of == verb.get_name()),
                "{} has no example",
                verb.get_name()
            );
        }
    }
}
