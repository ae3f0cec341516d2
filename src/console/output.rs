//! Output of the command: data on standard output; messages and progress on standard error. A failure to write the latter
//! does not change what the command does.

use super::{CommandFailure, Common};
use crate::report::terminal;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Display;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use stripmine_physics::quoted;

/// Set once anything is written to standard output.
static BEGUN: AtomicBool = AtomicBool::new(false);

/// Progress bar on the screen.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn current_bar() -> MutexGuard<'static, Option<ProgressBar>> {
    BAR.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a line to standard error, above the progress bar.
pub(crate) fn print_message(message: impl Display) {
    let line = || {
        let text = terminal::wrap_message(&quoted::message(&message.to_string()));
        #[expect(
            clippy::let_underscore_must_use,
            reason = "if standard error is full or closed, nothing can be reported"
        )]
        let _ = writeln!(io::stderr().lock(), "{text}");
    };
    let bar = current_bar().clone();
    match bar {
        Some(bar) => bar.suspend(line),
        None => line(),
    }
}

/// Writes a warning to standard error.
pub(crate) fn warn(message: impl Display) {
    print_message(format_args!("warning: {message}"));
}

/// Starts a progress bar with ETA on a terminal; hidden elsewhere.
pub(crate) fn bar(common: &Common, length: u64, template: &str) -> ProgressBar {
    let target = if common.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.set_style(style.with_key("left", |state: &ProgressState, out: &mut dyn std::fmt::Write| {
        #[expect(clippy::let_underscore_must_use, reason = "a bar that cannot be drawn is not drawn")]
        let _ = out.write_str(&remaining(state.fraction(), state.elapsed(), state.eta()));
    }));
    // A thread keeps the elapsed time current; a hidden bar needs none.
    if !bar.is_hidden() {
        bar.enable_steady_tick(TICK);
    }
    *current_bar() = Some(bar.clone());
    bar
}

/// Interval at which a bar is redrawn without progress.
const TICK: Duration = Duration::from_millis(500);

/// Template of a bar in percent, with a message.
pub(crate) const SHARES: &str = "{wide_bar} {msg} {percent}% [{elapsed}{left}]";
/// Template of a bar over steps.
pub(crate) const STEPS: &str = "{wide_bar} {pos}/{len} [{elapsed}{left}]";

/// Remaining time, once 2 % and three seconds are done.
fn remaining(share: f32, elapsed: Duration, eta: Duration) -> String {
    if share < 0.02 || elapsed < Duration::from_secs(3) {
        return String::new();
    }
    format!(", ETA {}", HumanDuration(eta))
}

/// Starts a progress bar in thousandths.
pub(crate) fn progress(common: &Common, what: &'static str) -> ProgressBar {
    let bar = bar(common, 1000, SHARES);
    bar.set_message(what);
    bar
}

/// Removes the progress bar from the screen.
pub(crate) fn clear_progress() {
    if let Some(bar) = current_bar().take() {
        bar.finish_and_clear();
    }
}

/// Writes to standard output.
fn write(text: impl FnOnce() -> io::Result<()>) -> Result<(), CommandFailure> {
    BEGUN.store(true, Ordering::SeqCst);
    text().and_then(|()| io::stdout().flush()).map_err(CommandFailure::StandardOutput)
}

/// Returns true if nothing was written to standard output.
pub fn is_untouched() -> bool {
    !BEGUN.load(Ordering::SeqCst)
}

/// Writes data to standard output; control characters in quoted names are escaped.
///
/// # Errors
/// [`CommandFailure::StandardOutput`] if it cannot be written.
pub(crate) fn print(text: &str) -> Result<(), CommandFailure> {
    write(|| io::stdout().write_all(quoted::escaped_for_terminal(text).as_bytes()))
}

/// Writes lines of text to standard output, wrapped to the width of the terminal or of a page; continued lines are indented.
///
/// # Errors
/// [`CommandFailure::StandardOutput`] if it cannot be written.
pub(crate) fn print_text(text: &str) -> Result<(), CommandFailure> {
    print(&terminal::wrap_text(text))
}

/// Writes paragraphs to standard output, wrapped to the width of the terminal or of a page.
///
/// # Errors
/// [`CommandFailure::StandardOutput`] if it cannot be written.
pub(crate) fn print_prose(text: &str) -> Result<(), CommandFailure> {
    print(&terminal::wrap_prose(text))
}

/// Writes the parser's help or version to standard output.
pub(crate) fn print_answer(answer: &clap::Error) -> Result<(), CommandFailure> {
    write(|| answer.print())
}

/// Writes data to standard output as one JSON document.
///
/// # Errors
/// [`CommandFailure::StandardOutput`] if it cannot be written.
pub(crate) fn print_json(data: &impl serde::Serialize) -> Result<(), CommandFailure> {
    print(&(to_json(data)? + "\n"))
}

/// Formats data as JSON, floats in shortest round-trip form.
///
/// # Errors
/// If JSON cannot represent the data.
pub(crate) fn to_json(data: &impl serde::Serialize) -> Result<String, CommandFailure> {
    let text =
        serde_json::to_string_pretty(data).map_err(|cause| CommandFailure::writing("JSON")(cause.into()))?;
    Ok(quoted::in_json(&text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remaining_time_is_shown_once_known() {
        let [short, long] = [1, 10].map(Duration::from_secs);
        assert_eq!(remaining(0.5, short, long), "");
        assert_eq!(remaining(0.01, long, long), "");
        assert_eq!(remaining(0.5, long, long), ", ETA 10 seconds");
    }
}
