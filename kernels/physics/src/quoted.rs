//! Text from outside, made safe for messages: control and invisible characters are escaped.

/// Longest text that a message quotes (characters).
const LONGEST: usize = 80;

/// Quotes a name or value from a file or a command line. Control characters, line ends, direction marks and invisible characters become `\n`,
/// `\u{202e}` and the like. Text longer than 80 characters is cut.
pub fn quoted(text: &str) -> String {
    shortened(text, LONGEST)
}

fn shortened(text: &str, most: usize) -> String {
    let mut shown = escaped_characters(text.chars().take(most));
    if text.chars().nth(most).is_some() {
        shown.push('…');
    }
    shown
}

/// Longest line of a message (characters), since a terminal shows few of them.
const LONGEST_LINE: usize = 2000;

/// Quotes the name of a file without cutting it.
pub fn path(path: &std::path::Path) -> String {
    escaped_characters(path.to_string_lossy().chars())
}

/// Quotes a message of one line, which may repeat text from outside.
pub fn one_line(text: &str) -> String {
    shortened(text, LONGEST_LINE)
}

/// Quotes a message of several lines, which may repeat text from outside, as [`quoted`] does. Line ends are kept; a line longer than any of ours is
/// cut.
pub fn message(text: &str) -> String {
    text.split('\n').map(|line| shortened(line, LONGEST_LINE)).collect::<Vec<_>>().join("\n")
}

/// Quotes a whole text for a terminal, with its line ends and tabs.
pub fn escaped_for_terminal(text: &str) -> String {
    // Numbers have narrow no-break spaces between groups of digits.
    let is_plain = |c: char| matches!(c, ' '..='~' | '\n' | '\t' | '\u{202f}');
    let pieces = text.split_inclusive(['\n', '\t', '\u{202f}']);
    let one = |piece: &str| match piece.strip_suffix(['\n', '\t', '\u{202f}']) {
        _ if piece.chars().all(is_plain) => piece.to_owned(),
        Some(rest) => escaped_characters(rest.chars()) + &piece[rest.len()..],
        None => escaped_characters(piece.chars()),
    };
    pieces.map(one).collect()
}

/// Escapes invisible characters in JSON, so that its strings read back unchanged.
pub fn in_json(text: &str) -> String {
    if text.is_ascii() {
        return text.to_owned();
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        // A combining mark is escaped too: after its letter it reads back the same.
        let is_seen = c == '\n' || c.is_ascii() || !is_blank(c) && !is_mark(c) && c.escape_debug().eq([c]);
        match is_seen {
            true => out.push(c),
            false => {
                c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| out.push_str(&format!("\\u{unit:04x}")))
            }
        }
    }
    out
}

fn escaped_characters(text: impl Iterator<Item = char>) -> String {
    let mut shown = String::new();
    let mut marks = 0;
    for c in text {
        // A combining mark belongs to the letter before it. More than three of them, or one without a letter, are escaped.
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

/// True for combining marks: printable, though `escape_debug` escapes them on their own.
fn is_mark(c: char) -> bool {
    let plain = |c: char| c.escape_debug().count() == 1;
    !plain(c) && !c.is_control() && format!("a{c}").escape_debug().eq(['a', c])
}

/// True for letters, symbols and selectors that show nothing.
fn is_blank(c: char) -> bool {
    matches!(c,
        '\u{34f}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}' | '\u{2800}'
        | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{ffa0}' | '\u{e0100}'..='\u{e01ef}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_output_keeps_its_shape_and_hides_nothing() {
        assert_eq!(escaped_for_terminal("a\tb\u{202f}c\nd é\n"), "a\tb\u{202f}c\nd é\n");
        assert_eq!(escaped_for_terminal("\u{1b}[2J\n\u{202e}x\r\n"), "\\u{1b}[2J\n\\u{202e}x\\r\n");
        assert_eq!(escaped_for_terminal(&"x".repeat(5000)).len(), 5000);
        let nasty = "a\u{202e}\u{9b}e\u{301}\u{e0041}é";
        let json = in_json(&serde_json::to_string(&nasty).unwrap());
        assert!(json.chars().all(|c| c.is_ascii() || c == 'é'), "{json}");
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), nasty);
    }

    #[test]
    fn invisible_characters_are_escaped() {
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
