//! A source file as its texts: doc comments, messages, types, tests.

use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A text of a source file and the line, from 1, where it begins.
pub struct Text {
    pub line: usize,
    pub text: String,
}

/// Texts and names of a source file.
pub struct Source {
    /// From the root of the repository.
    pub path: String,
    /// Doc comments, each whole, without code.
    pub docs: Vec<Text>,
    /// String literals of several words that are not for tests only.
    pub messages: Vec<Text>,
    /// Types of modules, without those for tests only.
    pub types: Vec<String>,
    /// Test functions with their lines.
    pub tests: Vec<(String, usize)>,
}

impl Source {
    pub fn read(root: &Path, path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let name = path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
        let is_test = name.starts_with("tests/") || name.contains("/tests/") || name.ends_with("/tests.rs");
        let tokens: TokenStream = text.parse().unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut source = Self { path: name, docs: vec![], messages: vec![], types: vec![], tests: vec![] };
        source.visit(tokens, true, is_test);
        source
    }

    /// Collects the texts of a stream; `is_module` for items of a module, `is_test` for code that only tests contain.
    fn visit(&mut self, tokens: TokenStream, is_module: bool, is_test: bool) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut doc: Option<Text> = None;
        // What the attributes before an item say of it.
        let (mut of_tests, mut runs_as_test, mut is_mod) = (false, false, false);
        let mut at = 0;
        while at < tokens.len() {
            if let Some((attribute, length)) = attribute(&tokens[at..]) {
                match doc_line(&attribute) {
                    Some((line, text)) => {
                        let doc = doc.get_or_insert(Text { line, text: String::new() });
                        doc.text.push_str(&text);
                        doc.text.push('\n');
                    }
                    None => {
                        let words = attribute.to_string();
                        of_tests |=
                            words.starts_with("cfg") && words.contains("test") && !words.contains("not");
                        runs_as_test |= words == "test";
                        self.visit(attribute, false, is_test);
                    }
                }
                at += length;
                continue;
            }
            if let Some(text) = doc.take() {
                self.docs.push(Text { line: text.line, text: without_blocks(&text.text) });
            }
            match &tokens[at] {
                TokenTree::Ident(word) => {
                    let word = word.to_string();
                    let next = tokens
                        .get(at + 1)
                        .and_then(|it| if let TokenTree::Ident(it) = it { Some(it) } else { None });
                    is_mod |= word == "mod";
                    if let Some(name) = next {
                        let is_type = ["struct", "enum", "trait", "type", "union"].contains(&word.as_str());
                        if is_type && is_module && !is_test && !of_tests {
                            self.types.push(name.to_string());
                        }
                        if word == "fn" {
                            if runs_as_test {
                                self.tests.push((name.to_string(), name.span().start().line));
                            }
                            runs_as_test = false;
                        }
                    }
                }
                TokenTree::Group(group) => {
                    self.visit(group.stream(), is_mod && is_module, is_test || of_tests);
                    if group.delimiter() == Delimiter::Brace {
                        (of_tests, is_mod) = (false, false);
                    }
                }
                TokenTree::Literal(literal) => {
                    let text = literal.to_string();
                    if !is_test && !of_tests && text.contains('"') && text.contains(' ') {
                        let joined = text.replace("\\\n", " ").replace("\\n", " ");
                        self.messages.push(Text { line: literal.span().start().line, text: joined });
                    }
                }
                TokenTree::Punct(sign) if sign.as_char() == ';' => (of_tests, is_mod) = (false, false),
                TokenTree::Punct(_) => {}
            }
            at += 1;
        }
        if let Some(text) = doc {
            self.docs.push(Text { line: text.line, text: without_blocks(&text.text) });
        }
    }
}

/// The inside of an attribute at the beginning of the tokens, and how many tokens it is.
fn attribute(tokens: &[TokenTree]) -> Option<(TokenStream, usize)> {
    let is_sign =
        |at: usize, sign: char| matches!(tokens.get(at), Some(TokenTree::Punct(it)) if it.as_char() == sign);
    if !is_sign(0, '#') {
        return None;
    }
    let at = if is_sign(1, '!') { 2 } else { 1 };
    match tokens.get(at) {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Bracket => {
            Some((group.stream(), at + 1))
        }
        _ => None,
    }
}

/// A line of a doc comment, and where it is.
fn doc_line(attribute: &TokenStream) -> Option<(usize, String)> {
    let tokens: Vec<TokenTree> = attribute.clone().into_iter().collect();
    match &tokens[..] {
        [TokenTree::Ident(doc), TokenTree::Punct(_), TokenTree::Literal(text)] if doc == "doc" => {
            let words = text.to_string();
            let words =
                words.trim_matches('"').trim_start_matches("r\"").replace("\\\"", "\"").replace("\\n", "\n");
            Some((text.span().start().line, words.trim_start().to_owned()))
        }
        _ => None,
    }
}

/// A doc comment without blocks of code and without code between backticks.
fn without_blocks(doc: &str) -> String {
    let mut is_code = false;
    let mut kept = String::new();
    for line in doc.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    crate::prose::without_code(&kept)
}
