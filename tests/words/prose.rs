//! Prose: paragraphs of documents, sentences and their lengths, phrases in them.

/// True if a text begins with these words, as whole words.
pub fn begins_with(text: &str, words: &str) -> bool {
    text.trim_start()
        .strip_prefix(words)
        .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
}

/// True if a text contains a phrase as whole words, whatever the case and the line ends between them.
pub fn contains(text: &str, phrase: &str) -> bool {
    let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '\'');
    let text = text.to_lowercase().split_whitespace().collect::<Vec<_>>().join(" ");
    let phrase = phrase.to_lowercase();
    text.match_indices(&phrase).any(|(at, _)| {
        !is_word(text[..at].chars().next_back()) && !is_word(text[at + phrase.len()..].chars().next())
    })
}

/// Text without code between backticks.
pub fn without_code(text: &str) -> String {
    text.split('`').step_by(2).collect::<Vec<_>>().join("‹code›")
}

/// Paragraphs and list items of a Markdown document with their first lines, from 1. Leaves out code blocks, tables, headings, comments and a
/// front matter.
pub fn paragraphs(text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = vec![];
    let mut is_open = false;
    let mut fence: Option<&str> = None;
    for (at, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(end) = fence {
            if line.contains(end) {
                fence = None;
            }
            continue;
        }
        let opens = [("```", "```"), ("<!--", "-->")].into_iter().find(|(begin, _)| line.starts_with(begin));
        if let Some((begin, end)) = opens {
            if begin == "```" || !line.contains(end) {
                fence = Some(end);
            }
            is_open &= begin != "```";
            continue;
        }
        if at == 0 && (line == "---" || line == "+++") {
            fence = Some(if line == "---" { "---" } else { "+++" });
            continue;
        }
        if line.is_empty() || line.starts_with('#') || line.starts_with('|') {
            is_open = false;
            continue;
        }
        let item = ["- ", "* ", "> "].iter().find_map(|mark| line.strip_prefix(mark));
        match (item, is_open) {
            (None, true) => {
                let last = &mut found.last_mut().unwrap().1;
                last.push(' ');
                last.push_str(line);
            }
            (item, _) => found.push((at + 1, item.unwrap_or(line).to_owned())),
        }
        is_open = true;
    }
    for (_, paragraph) in &mut found {
        *paragraph = without_code(&without_comments(paragraph));
    }
    found
}

/// Text without comments of Markdown.
fn without_comments(text: &str) -> String {
    let mut parts = text.split("<!--");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| kept + part.split_once("-->").map_or("", |(_, rest)| rest))
}

/// Numbers of words of the sentences of a paragraph.
pub fn sentence_lengths(paragraph: &str) -> Vec<usize> {
    let mut lengths = vec![];
    let mut count = 0;
    for word in paragraph.split_whitespace() {
        count += usize::from(word.contains(|c: char| c.is_alphanumeric()));
        let bare = word.trim_end_matches([')', '*', '"', '_', ']']);
        if bare.ends_with(['.', '!', '?']) {
            lengths.push(count);
            count = 0;
        }
    }
    lengths.push(count);
    lengths.retain(|count| *count > 0);
    lengths
}

#[test]
fn phrases_are_found_as_whole_words() {
    assert!(contains("It goes\n  on With that.", "goes on with"));
    assert!(!contains("endearing", "dear"));
    assert!(begins_with("What it is", "What") && !begins_with("Whatever", "What"));
}

#[test]
fn paragraphs_leave_out_code_and_tables() {
    let text = "+++\na = 1\n+++\n# Head\n\nOne two. Three\nfour `five six`!\n\n```text\ncode\n```\n| a | b |\n- item one\n- item two\n";
    let found = paragraphs(text);
    assert_eq!(found.iter().map(|it| it.0).collect::<Vec<_>>(), [6, 13, 14]);
    assert_eq!(sentence_lengths(&found[0].1), [2, 3]);
}
