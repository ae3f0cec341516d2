//! Numbers as other programs write them.

/// A number as programs write it, Fortran's too, whose exponent may be a `D`.
pub(super) fn number(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| {
        let at = text.find(['D', 'd']).filter(|&at| at > 0)?;
        format!("{}E{}", &text[..at], &text[at + 1..]).parse().ok()
    })
}
