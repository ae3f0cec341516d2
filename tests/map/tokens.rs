//! Rust code as words and signs: enough to find `use` declarations and paths.

/// A word (names, keywords, numbers), `::`, or any other sign.
#[derive(Debug, Clone, PartialEq)]
pub enum Token {
    Word(String),
    Path,
    Sign(char),
}

impl Token {
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word) => Some(word),
            _ => None,
        }
    }

    pub fn is(&self, word: &str) -> bool {
        self.word() == Some(word)
    }
}

/// A name that a `use` declaration binds, its target, and true if it is re-exported (`pub use`).
#[derive(Debug, Clone, PartialEq)]
pub struct Use {
    pub name: String,
    pub path: Vec<String>,
    pub handed_on: bool,
}

/// Tokens of a text without comments, strings and characters.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut found = vec![];
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let taken = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = raw_string(rest) {
            length
        } else if first == '"' {
            string(rest)
        } else if first == '\'' {
            character(rest)
        } else if is_word(first) {
            let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            found.push(Token::Word(rest[..length].to_owned()));
            length
        } else if rest.starts_with("::") {
            found.push(Token::Path);
            2
        } else {
            if !first.is_whitespace() {
                found.push(Token::Sign(first));
            }
            first.len_utf8()
        };
        rest = &rest[taken..];
    }
    found
}

/// Length of a string in quotes.
fn string(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Length of a raw string, `r"…"` or `r#"…"#`, if one begins here.
fn raw_string(text: &str) -> Option<usize> {
    let behind = text.strip_prefix("br").or_else(|| text.strip_prefix('r'))?;
    let hashes = behind.len() - behind.trim_start_matches('#').len();
    let inside = behind[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    Some(text.len() - inside.len() + inside.find(&end)? + end.len())
}

/// Length of a character in quotes; for a lifetime, of its quote.
fn character(text: &str) -> usize {
    let mut chars = text.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), Some((at, _))) => {
            text[at + 1..].find('\'').map_or(text.len(), |end| at + 1 + end + 1)
        }
        (Some(_), Some((at, '\''))) => at + 1,
        _ => 1,
    }
}

/// Removes items after `#[cfg(test)]` or `#[cfg(all(test, …))]`.
pub fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mut kept = vec![];
    let mut at = 0;
    while at < tokens.len() {
        if is_of_tests(&tokens[at..]) {
            at = end_of_item(&tokens, at);
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

fn is_of_tests(tokens: &[Token]) -> bool {
    let [Token::Sign('#'), Token::Sign('['), cfg, Token::Sign('('), rest @ ..] = tokens else { return false };
    let rest = match rest {
        [all, Token::Sign('('), rest @ ..] if all.is("all") => rest,
        rest => rest,
    };
    cfg.is("cfg") && rest.first().is_some_and(|it| it.is("test"))
}

/// Index after an item and its attributes: after its semicolon or last brace.
fn end_of_item(tokens: &[Token], start: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(start) {
        match token {
            Token::Sign('{' | '(' | '[') => depth += 1,
            Token::Sign('}') if depth == 1 => return at + 1,
            Token::Sign('}' | ')' | ']') => depth -= 1,
            Token::Sign(';') if depth == 0 => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Names that `use` declarations bind; `*` for all of a module.
pub fn uses(tokens: &[Token]) -> Vec<Use> {
    let mut found = vec![];
    for (at, token) in tokens.iter().enumerate() {
        // `use<'a>` in a type does not declare anything.
        let is_use = token.is("use") && matches!(tokens.get(at + 1), Some(Token::Word(_) | Token::Path));
        if is_use {
            let is_private = at == 0 || matches!(tokens[at - 1], Token::Sign(';' | '}' | '{' | ']'));
            let mut rest = tokens[at + 1..].iter().peekable();
            tree(&mut rest, &[], !is_private, &mut found);
        }
    }
    found
}

/// Reads one branch of a tree of names, up to its `,`, `}` or `;`.
fn tree<'a>(
    tokens: &mut std::iter::Peekable<impl Iterator<Item = &'a Token>>,
    stem: &[String],
    handed_on: bool,
    found: &mut Vec<Use>,
) {
    let mut path = stem.to_vec();
    let mut name = None;
    while let Some(token) = tokens.next_if(|it| !matches!(it, Token::Sign(',' | '}' | ';'))) {
        match token {
            Token::Sign('{') => {
                while tokens.next_if(|it| **it == Token::Sign('}')).is_none() {
                    tree(tokens, &path, handed_on, found);
                    tokens.next_if(|it| **it == Token::Sign(','));
                }
                return;
            }
            Token::Word(word) if word == "as" => {
                name = tokens.next().and_then(Token::word).map(str::to_owned);
            }
            // `{self, …}` is the module itself.
            Token::Word(word) if word == "self" && !path.is_empty() => {}
            Token::Word(word) => path.push(word.clone()),
            Token::Path | Token::Sign(_) => {}
        }
    }
    let name = name.or_else(|| path.last().cloned()).unwrap_or_default();
    found.push(Use { name, path, handed_on });
}

#[test]
fn use_trees_are_read_without_tests() {
    let text = r#"
        pub use crate::{a::{self, B as C}, d::*};
        // use crate::comment;
        const S: &str = "use crate::string; {"; const R: &str = r"\"; const Q: char = '"';
        fn f<'a>(x: &'a str) -> super::Out { use self::g; '\'' }
        #[cfg(test)]
        mod tests { use crate::tested; }
    "#;
    let found = without_tests(tokens(text));
    let found: Vec<String> = uses(&found)
        .iter()
        .map(|it| format!("{} {}{}", it.path.join("::"), it.name, if it.handed_on { " pub" } else { "" }))
        .collect();
    assert_eq!(found, ["crate::a a pub", "crate::a::B C pub", "crate::d d pub", "self::g g"]);
}
