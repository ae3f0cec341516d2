//! Measurements in a child process: the program calls itself, and the two processes communicate through pipes with one line of JSON per reading.

use super::case::{CaseReading, CaseTask, RateCase, StudyWork};
use crate::console::{CommandFailure, print};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use stripmine_physics::reported::ErrorClass;
use stripmine_physics::signals::INTERRUPTED;

/// Class and message of a failure; no class if a signal ended the process.
pub(super) type ProcessFailure = (Option<ErrorClass>, String);

/// Verb of the measuring process.
pub(crate) const VERB: &str = "measure-cases";

/// Measures some cases in order in a new process of the program.
pub(super) fn measure(
    program: &Path,
    cases: &[&RateCase],
    heard: &mut dyn FnMut(CaseReading),
) -> Result<(), ProcessFailure> {
    let mut command = Command::new(program);
    command.args([VERB, "--quiet"]);
    run_child(&mut command, cases, heard)
}

/// Runs a command and receives its readings of some cases.
fn run_child(
    command: &mut Command,
    cases: &[&RateCase],
    heard: &mut dyn FnMut(CaseReading),
) -> Result<(), ProcessFailure> {
    let failed =
        |cause: io::Error| (Some(ErrorClass::InputOutput), format!("the measuring process: {cause}"));
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = piped.spawn().map_err(failed)?;
    let errors = child.stderr.take();
    let words = thread::spawn(move || {
        let mut words = vec![];
        // If the message cannot be read, the exit code still classifies the failure.
        drop(errors.map(|mut errors| errors.read_to_end(&mut words)));
        String::from_utf8_lossy(&words).into_owned()
    });
    // The child ends when this pipe closes: keep it open until the child has ended, or this process is gone.
    let mut asked = child.stdin.take();
    let cases: Vec<(&CaseTask, Option<usize>)> =
        cases.iter().map(|case| (&case.task, case.threads)).collect();
    let line = serde_json::to_string(&cases).map_err(|cause| failed(cause.into()))? + "\n";
    if let Some(asked) = &mut asked {
        // A child that is gone reports the reason on standard error.
        drop(asked.write_all(line.as_bytes()).and_then(|()| asked.flush()));
    }
    let mut readings = 0;
    for line in child.stdout.take().into_iter().flat_map(|answers| BufReader::new(answers).lines()) {
        let reading =
            line.and_then(|line| Ok(serde_json::from_str::<CaseReading>(&line)?)).map_err(failed)?;
        heard(reading);
        readings += 1;
    }
    let status = child.wait().map_err(failed)?;
    drop(asked);
    // If the message could not be read, the exit code still classifies the failure.
    let words = words.join().unwrap_or_else(|_| String::new());
    match status.success() && readings == cases.len() {
        true => Ok(()),
        false => Err(failure_of_child(status, &words)),
    }
}

/// Failure of a process, from its exit status and message.
fn failure_of_child(status: ExitStatus, words: &str) -> ProcessFailure {
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    let class = match code {
        Some(INTERRUPTED) => None,
        code => Some(code.and_then(ErrorClass::of_exit_code).unwrap_or(ErrorClass::InputOutput)),
    };
    let words = words.trim();
    let said = words.strip_prefix("error: ").unwrap_or(words);
    let said = if said.is_empty() {
        format!("the measuring process ended early ({status})")
    } else {
        said.to_owned()
    };
    (class, said)
}

/// Measures the cases read from standard input and prints one line for each.
///
/// # Errors
/// [`CommandFailure`] of a case, or of standard input that does not contain cases.
pub(crate) fn serve(all: &[&StudyWork]) -> Result<(), CommandFailure> {
    let mut line = String::new();
    let read = io::stdin().lock().read_line(&mut line);
    let cases = read.and_then(|_| Ok(serde_json::from_str::<Vec<(CaseTask, Option<usize>)>>(&line)?));
    let cases = cases.map_err(CommandFailure::writing("cases on standard input"))?;
    thread::spawn(|| {
        // The parent holds the other end as long as it waits.
        drop(io::copy(&mut io::stdin().lock(), &mut io::sink()));
        std::process::exit(INTERRUPTED.into());
    });
    for (task, threads) in cases {
        let reading = RateCase { labels: vec![], task, threads }.measure(all)?;
        print(
            &(serde_json::to_string(&reading)
                .map_err(|cause| CommandFailure::writing("JSON")(cause.into()))?
                + "\n"),
        )?;
    }
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use stripmine_physics::scene::Overrides;

    fn shell(script: &str) -> (Result<(), ProcessFailure>, Vec<f64>) {
        let case = RateCase::steps("bench", &Overrides::new(), 0, 1);
        let (mut command, mut heard) = (Command::new("sh"), vec![]);
        let outcome = run_child(command.args(["-c", script]), &[&case; 2], &mut |it| heard.push(it.work));
        (outcome, heard)
    }

    /// Each line is a reading; class and message of a failed process are passed on.
    #[test]
    fn readings_and_failures_of_a_child_are_received() {
        let line = r#"echo '{"work": 3.0, "seconds": 1.0, "parts": {}, "counts": {}}'; "#;
        let one = format!("read cases; {line}");
        assert_eq!(shell(&format!("{one}{line}")), (Ok(()), vec![3.0, 3.0]));
        let failing = |end: &str| {
            let (outcome, heard) = shell(&format!("{one}{end}"));
            assert_eq!(heard, [3.0]);
            outcome.unwrap_err()
        };
        let class = |class: ErrorClass| Some(class);
        assert_eq!(
            failing("echo 'error: no' >&2; exit 4"),
            (class(ErrorClass::Precondition), "no".to_owned())
        );
        assert_eq!(failing("exit 130").0, None);
        let (killed, said) = failing("kill -9 $$");
        assert!(killed == class(ErrorClass::InputOutput) && said.contains("signal"), "{said}");
        assert!(failing("exit 0").1.contains("ended early"));
        assert_eq!(failing("echo words").0, class(ErrorClass::InputOutput));
    }

    #[test]
    fn a_missing_program_is_an_error() {
        let (class, said) = measure(Path::new("/no/such/program"), &[], &mut |_| ()).unwrap_err();
        assert!(
            class == Some(ErrorClass::InputOutput) && said.starts_with("the measuring process: "),
            "{said}"
        );
    }
}
