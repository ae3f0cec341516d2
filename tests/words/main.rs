//! Words of texts that people read: doc comments, messages, help, documents, names of types and tests. The lists are data, in
//! `words.toml` and `names.toml`; `docs/style.md` says what to write instead.

mod prose;
mod source;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use source::{Source, Text};

#[derive(Deserialize)]
struct Words {
    beginnings: Vec<String>,
    phrase: Vec<Phrase>,
    documents: Documents,
    sentences: Sentences,
    results: Results,
    tests: Tests,
}

#[derive(Deserialize)]
struct Phrase {
    avoid: Vec<String>,
    write: String,
}

#[derive(Deserialize)]
struct Documents {
    paths: Vec<String>,
    except: Vec<String>,
}

#[derive(Deserialize)]
struct Sentences {
    paths: Vec<String>,
    mean: f64,
}

#[derive(Deserialize)]
struct Results {
    kept: Vec<String>,
}

#[derive(Deserialize)]
struct Tests {
    words: usize,
}

/// Reason why several types share a name.
#[derive(Deserialize)]
struct Shared {
    name: String,
    reason: String,
}

#[derive(Deserialize)]
struct Names {
    shared: Vec<Shared>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn words() -> Words {
    toml::from_str(&fs::read_to_string(root().join("tests/words/words.toml")).unwrap()).unwrap()
}

/// Files below a path with one of the extensions, in order; build folders left out.
fn files(path: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let mut entries: Vec<PathBuf> = fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let is_searched = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        let is_source = path.extension().is_some_and(|it| extensions.iter().any(|known| it == *known));
        if path.is_dir() { !name.starts_with('.') && name != "target" } else { is_source }
    };
    entries.iter().filter(|path| is_searched(path)).flat_map(|path| files(path, extensions)).collect()
}

fn sources() -> Vec<Source> {
    let folders = ["kernels", "src", "python/src", "tests", "benches"];
    let paths = folders.iter().flat_map(|folder| files(&root().join(folder), &["rs"]));
    paths.map(|path| Source::read(root(), &path)).collect()
}

/// Documents with their texts, by path from the root of the repository.
fn documents(paths: &[String], except: &[String]) -> Vec<(String, String)> {
    let found = paths.iter().flat_map(|path| files(&root().join(path), &["md", "toml"]));
    let named = found.map(|path| (path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned(), path));
    let kept = named.filter(|(name, _)| !except.contains(name) && !name.starts_with("docs/gallery/"));
    kept.map(|(name, path)| (name, fs::read_to_string(path).unwrap())).collect()
}

fn fail_on(faults: &[String]) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn first_doc_lines_name_their_subject() {
    let beginnings = words().beginnings;
    let mut faults = vec![];
    for source in sources() {
        for doc in &source.docs {
            if let Some(found) = beginnings.iter().find(|it| prose::begins_with(&doc.text, it)) {
                faults.push(format!("{}:{}: begins with {found:?}", source.path, doc.line));
            }
        }
    }
    fail_on(&faults);
}

#[test]
fn texts_have_no_private_words() {
    let words = words();
    let phrases: Vec<(&str, &str)> = words
        .phrase
        .iter()
        .flat_map(|phrase| phrase.avoid.iter().map(|avoid| (avoid.as_str(), phrase.write.as_str())))
        .collect();
    let mut faults = vec![];
    let mut check = |path: &str, line: usize, text: &str| {
        for (avoid, write) in &phrases {
            if prose::contains(text, avoid) {
                faults.push(format!("{path}:{line}: {avoid:?}; write: {write}"));
            }
        }
    };
    for source in sources() {
        let is_kept = |text: &&Text| words.results.kept.iter().any(|kept| text.text == format!("\"{kept}\""));
        for text in source.docs.iter().chain(source.messages.iter().filter(|text| !is_kept(text))) {
            check(&source.path, text.line, &text.text);
        }
    }
    for (path, text) in documents(&words.documents.paths, &words.documents.except) {
        for (line, paragraph) in prose::paragraphs(&text) {
            check(&path, line, &paragraph);
        }
    }
    fail_on(&faults);
}

#[test]
fn sentences_of_documents_are_short() {
    let Sentences { paths, mean } = words().sentences;
    let mut counts = vec![];
    let mut by_document = vec![];
    for (path, text) in documents(&paths, &[]) {
        if !path.ends_with(".md") {
            continue;
        }
        let lengths: Vec<usize> = prose::paragraphs(&text)
            .iter()
            .flat_map(|(_, paragraph)| prose::sentence_lengths(paragraph))
            .collect();
        let average = lengths.iter().sum::<usize>() as f64 / lengths.len().max(1) as f64;
        by_document.push(format!("{path}: {average:.1} words in {} sentences", lengths.len()));
        counts.extend(lengths);
    }
    let found = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
    println!("{found:.2} words\n{}", by_document.join("\n"));
    assert!(found <= mean, "mean sentence of {found:.2} words, at most {mean}\n{}", by_document.join("\n"));
}

#[test]
fn names_of_tests_are_short() {
    let most = words().tests.words;
    let mut faults = vec![];
    for source in sources() {
        for (name, line) in &source.tests {
            let count = name.split('_').count();
            if count > most {
                faults.push(format!("{}:{line}: {name} has {count} words, at most {most}", source.path));
            }
        }
    }
    fail_on(&faults);
}

#[test]
fn types_share_a_name_with_a_reason() {
    let names: Names =
        toml::from_str(&fs::read_to_string(root().join("tests/words/names.toml")).unwrap()).unwrap();
    let shared: BTreeMap<&str, &str> =
        names.shared.iter().map(|it| (it.name.as_str(), it.reason.as_str())).collect();
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for source in sources() {
        // Names of tests are in programs of their own.
        if ["kernels/src", "kernels/physics/src", "src", "python/src"]
            .iter()
            .any(|it| source.path.starts_with(it))
        {
            for name in source.types {
                found.entry(name).or_default().insert(source.path.clone());
            }
        }
    }
    found.retain(|_, paths| paths.len() > 1);
    let mut faults = vec![];
    for (name, paths) in &found {
        if !shared.contains_key(name.as_str()) {
            faults.push(format!("{name} is the name of several types: {paths:?}"));
        }
    }
    for (name, reason) in shared {
        if !found.contains_key(name) || reason.is_empty() {
            faults.push(format!("names.toml: {name} is the name of one type, or has no reason"));
        }
    }
    fail_on(&faults);
}
