//! What help and manual pages say beside the options: examples, exit codes, environment, where to read on.

/// Examples by verb; the overview has those under no verb.
const EXAMPLES: &[(&str, &[(&str, &str)])] = &[
    (
        "",
        &[
            ("stripmine run pipe-small", "a run of a preset; its folder is pipe-small.run"),
            ("stripmine plot pipe-small.run", "its observables and its last state as pictures"),
            ("stripmine table", "the efficiency table of 1993 beside ours"),
            ("stripmine reproduce --quick", "the report in half a minute"),
        ],
    ),
    (
        "run",
        &[
            ("stripmine run hard-disks", "a preset"),
            (
                "stripmine run scene.toml --out first.run --set run.steps=1000",
                "a file, with another number of steps",
            ),
            ("stripmine run hard-disks --seeds 8", "eight runs with seeds of their own, and their mean"),
            ("stripmine run pipe --resume", "begins, or goes on where the run was interrupted"),
        ],
    ),
    (
        "average",
        &[
            ("stripmine average pipe-small.run", "means with their errors"),
            ("stripmine average a.run b.run --json", "two runs of one scene with seeds of their own, joined"),
        ],
    ),
    (
        "explain",
        &[
            (
                "stripmine explain langevin-dense --of pressure --error 1%",
                "the cheapest run that reaches it, and why",
            ),
            (
                "stripmine explain kepler --of energy_error --error 1e-6 --write plan.toml",
                "the step that keeps the energy",
            ),
            ("stripmine explain pipe-small --estimate", "by what is kept of it, without a run"),
        ],
    ),
    (
        "plot",
        &[
            ("stripmine plot pipe-small.run", "SVG and PNG in pipe-small.plots, courses in the terminal"),
            ("stripmine plot melting.run --film --color psi6", "a film for a browser too, coloured by order"),
        ],
    ),
    (
        "bench",
        &[
            (
                "stripmine bench lattice --packing-fraction 0.84 --steps 1e4 --threads 1",
                "steps a second of dense discs",
            ),
            ("stripmine bench langevin --json", "the same of particles in a bath, as data"),
        ],
    ),
    (
        "compare",
        &[(
            "stripmine compare plummer --against machine.engine=reference",
            "two engines: same bits, or where they part",
        )],
    ),
    (
        "scene",
        &[
            ("stripmine scene keys lattice-md", "every key with unit, default and meaning"),
            ("stripmine scene check pipe-small", "the step beside every limit of theory, before a run"),
            ("stripmine scene show pipe-small", "the preset as a file to begin from"),
        ],
    ),
    (
        "reproduce",
        &[
            ("stripmine reproduce --only table --only misprints", "two items"),
            ("stripmine reproduce --out report", "all, into a folder"),
        ],
    ),
    ("chart", &[("stripmine chart soft-hard", "when soft discs are as good as hard ones")]),
    (
        "table",
        &[("stripmine table --ladder --machine cray-1", "what strip-mining, chaining and memory ports add")],
    ),
    (
        "listing",
        &[("stripmine listing forces --json", "instructions with operation, destination and sources")],
    ),
    ("calibrate", &[("stripmine calibrate --out host.toml", "a model of this host in 75 seconds")]),
    (
        "validate-model",
        &[("stripmine validate-model --host host.toml", "its predictions beside what is measured")],
    ),
    (
        "completions",
        &[(
            "stripmine completions bash",
            "to be kept where the shell looks, such as ~/.local/share/bash-completion/completions/stripmine",
        )],
    ),
    ("man", &[("stripmine man run", "the page of a verb, in roff: pipe it into man -l -")]),
];

/// Exit codes with their meaning.
const EXIT_CODES: &[(&str, &str)] = &[
    ("0", "done, also where a reader closes the pipe"),
    ("2", "wrong arguments, or a folder that holds something else"),
    ("3", "a scene or an input file that cannot be used; every mistake with its place"),
    (
        "4",
        "the physics failed, an accuracy cannot be reached, or a prediction lies outside what was calibrated",
    ),
    ("5", "reading or writing failed, or the system gives no more memory or threads"),
    ("6", "a damaged checkpoint"),
    ("130", "interrupted; a run has written its checkpoint"),
];

/// Variables of the environment that are read.
const ENVIRONMENT: &[(&str, &str)] = &[
    ("COLUMNS", "width of tables and notes, where it is set"),
    ("RAYON_NUM_THREADS", "threads where --threads is not given, at most 1024"),
];

/// Where to read on.
const SEE_ALSO: &str = "stripmine VERB --help, stripmine man VERB, stripmine scene keys, and the README";

/// A heading and its entries: what is written, and what it means.
pub(super) type Part = (&'static str, Vec<(&'static str, &'static str)>);

/// What there is to be said of a verb, or, under no verb, of the command.
pub(super) fn parts(verb: &str) -> Vec<Part> {
    let examples =
        EXAMPLES.iter().filter(|(of, _)| *of == verb).map(|(_, examples)| ("Examples", examples.to_vec()));
    let codes = [
        ("Exit codes", EXIT_CODES.to_vec()),
        ("Environment", ENVIRONMENT.to_vec()),
        ("See also", vec![(SEE_ALSO, "")]),
    ];
    examples.chain(codes).collect()
}

/// The same as help shows it.
pub(super) fn text(verb: &str) -> String {
    let mut text = String::new();
    for (heading, entries) in parts(verb) {
        text.push_str(&format!("{heading}:\n"));
        for (what, meaning) in entries {
            // A command stands on a line of its own: it is copied whole.
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
    fn every_example_is_a_command_and_every_verb_has_one() {
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
