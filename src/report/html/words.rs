//! Verdicts and sentences in HTML.

use crate::report::Verdict;
use maud::{Markup, html};

/// A verdict as colour, sign and word.
pub(super) fn badge(verdict: Verdict) -> Markup {
    html! {
        span class={ "badge " (kind(verdict)) } { (sign(verdict)) " " (verdict.word()) }
    }
}

/// A verdict's name in the style sheet.
pub(super) fn kind(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Reproduced => "reproduced",
        Verdict::Partly => "partly",
        Verdict::NotReproduced => "not-reproduced",
        Verdict::Undecided => "undecided",
        Verdict::AimMet => "aim-met",
        Verdict::AimMissed => "aim-missed",
        Verdict::Measured => "measured",
        Verdict::Computed => "computed",
    }
}

/// A verdict as a sign that needs no colour.
pub(super) fn sign(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Reproduced => "✓",
        Verdict::Partly => "◐",
        Verdict::NotReproduced => "✗",
        Verdict::Undecided => "?",
        Verdict::AimMet => "▲",
        Verdict::AimMissed => "△",
        Verdict::Measured => "○",
        Verdict::Computed => "□",
    }
}

/// A sentence in which backquotes set apart what a machine reads, as in the page in Markdown.
pub(super) fn prose(text: &str) -> Markup {
    let pieces: Vec<&str> = text.split('`').collect();
    let paired = pieces.len() % 2 == 1;
    html! {
        @if paired {
            @for (i, piece) in pieces.iter().enumerate() {
                @if i % 2 == 1 { code { (piece) } } @else { (piece) }
            }
        } @else {
            (text)
        }
    }
}
