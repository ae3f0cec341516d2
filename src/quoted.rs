//! Text from outside, as it may stand in a message: what a terminal would obey, or would not show, is spelled out.

/// Longest text that a message repeats (characters).
const LONGEST: usize = 80;

/// A name or value from a file or a command line: control characters, line ends, marks of direction and everything else
/// that is not seen become `\n`, `\u{202e}` and the like; after 80 characters it breaks off.
pub fn quoted(text: &str) -> String {
    shortened(text, LONGEST)
}

fn shortened(text: &str, most: usize) -> String {
    let mut shown = spelled(text.chars().take(most));
    if text.chars().nth(most).is_some() {
        shown.push('…');
    }
    shown
}

/// Longest line of a message (characters): a terminal shows few of them.
const LONGEST_LINE: usize = 2000;

/// The name of a file, whole.
pub fn path(path: &std::path::Path) -> String {
    spelled(path.to_string_lossy().chars())
}

/// A message of one line, which may repeat text from outside.
pub fn one_line(text: &str) -> String {
    shortened(text, LONGEST_LINE)
}

/// A message of several lines, which may repeat text from outside: as [`quoted`], but for its line ends. Of a line that
/// is longer than any that we write, the beginning.
pub fn message(text: &str) -> String {
    text.split('\n').map(|line| shortened(line, LONGEST_LINE)).collect::<Vec<_>>().join("\n")
}

fn spelled(text: impl Iterator<Item = char>) -> String {
    let mut shown = String::new();
    let mut marks = 0;
    for c in text {
        // An accent belongs to the letter before it; a heap of them, or one on nothing, is no writing.
        marks = if is_mark(c) { marks + 1 } else { 0 };
        let lone = marks > 3 || marks == 1 && shown.is_empty();
        match c {
            '\'' | '"' | '\\' => shown.push(c),
            _ if is_blank(c) || lone => shown.extend(c.escape_unicode()),
            _ if is_mark(c) => shown.push(c),
            _ => shown.extend(c.escape_debug()),
        }
    }
    shown
}

/// What `escape_debug` spells out though it is printable: marks that join the letter before.
fn is_mark(c: char) -> bool {
    let plain = |c: char| c.escape_debug().count() == 1;
    !plain(c) && !c.is_control() && format!("a{c}").escape_debug().eq(['a', c])
}

/// Letters, symbols and selectors that show nothing at all.
fn is_blank(c: char) -> bool {
    matches!(c,
        '\u{34f}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}' | '\u{2800}'
        | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{ffa0}' | '\u{e0100}'..='\u{e01ef}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_seen_is_spelled_out() {
        for (text, shown) in [
            ("law.stiffness", "law.stiffness"),
            ("größe ≥ 数 'a' \"b\" \\", "größe ≥ 数 'a' \"b\" \\"),
            ("e\u{301}", "e\u{301}"),
            ("\u{301}", "\\u{301}"),
            ("a\nb\tc\r\0", "a\\nb\\tc\\r\\0"),
            ("\u{1b}[31mred", "\\u{1b}[31mred"),
            ("\u{9b}1m\u{7f}", "\\u{9b}1m\\u{7f}"),
            ("exe\u{202e}txt", "exe\\u{202e}txt"),
            ("\u{2066}a\u{2069}\u{200f}", "\\u{2066}a\\u{2069}\\u{200f}"),
            ("a\u{200b}\u{feff}\u{ad}b", "a\\u{200b}\\u{feff}\\u{ad}b"),
            ("\u{2028}\u{a0}\u{e0041}", "\\u{2028}\\u{a0}\\u{e0041}"),
            ("\u{3164}\u{2800}x\u{fe0f}", "\\u{3164}\\u{2800}x\\u{fe0f}"),
            ("\u{d7ff}\u{e000}\u{10ffff}", "\\u{d7ff}\\u{e000}\\u{10ffff}"),
        ] {
            assert_eq!(quoted(text), shown, "{text:?}");
        }
        assert_eq!(quoted(&"x".repeat(80)), "x".repeat(80));
        assert_eq!(quoted(&"x".repeat(81)), format!("{}…", "x".repeat(80)));
        assert_eq!(one_line("a\n"), "a\\n");
        assert_eq!(message("a\nb\u{202e}\r\n"), "a\nb\\u{202e}\\r\n");
        assert_eq!(quoted("a\u{301}\u{301}\u{301}\u{301}"), "a\u{301}\u{301}\u{301}\\u{301}");
    }
}
