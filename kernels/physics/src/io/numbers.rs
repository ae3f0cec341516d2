//! Numbers as formatted by other programs.

/// Parses a number, also with the exponent `D` of Fortran.
pub(crate) fn number(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| {
        let at = text.find(['D', 'd']).filter(|&at| at > 0)?;
        format!("{}E{}", &text[..at], &text[at + 1..]).parse().ok()
    })
}
