//! Verdicts and sentences in HTML.

use crate::claims::ClaimVerdict;
use crate::report::Section;
use maud::{Markup, html};

/// Badge of a verdict: colour, sign and words.
pub(super) fn badge(verdict: ClaimVerdict) -> Markup {
    html! {
        span class={ "badge " (verdict_class(verdict)) } { (verdict_sign(verdict)) " " (verdict.words()) }
    }
}

/// Badges of the verdicts of a section's claims, with their numbers.
pub(super) fn badges(section: &Section) -> Markup {
    html! {
        @for (verdict, count) in section.counts() {
            span class={ "badge " (verdict_class(verdict)) } { (verdict_sign(verdict)) " " (count) " " (verdict.words()) } " "
        }
        @if section.is_stale() {
            span.badge.not-tested title="Kernels or physics have changed since these results were made." { "stale" }
        }
    }
}

/// Class of a verdict in the style sheet.
pub(super) fn verdict_class(verdict: ClaimVerdict) -> &'static str {
    match verdict {
        ClaimVerdict::Reproduced => "reproduced",
        ClaimVerdict::NotReproduced => "not-reproduced",
        ClaimVerdict::Undecided => "undecided",
        ClaimVerdict::Contradiction => "contradiction",
        ClaimVerdict::NotTested => "not-tested",
    }
}

/// Sign of a verdict, readable without colour.
pub(super) fn verdict_sign(verdict: ClaimVerdict) -> &'static str {
    match verdict {
        ClaimVerdict::Reproduced => "✓",
        ClaimVerdict::NotReproduced => "✗",
        ClaimVerdict::Undecided => "?",
        ClaimVerdict::Contradiction => "⇄",
        ClaimVerdict::NotTested => "○",
    }
}

/// Sentence with code in backquotes, as in Markdown.
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
