//! The committed report: short, in words and numbers for a reader.

use std::fs;
use std::path::{Path, PathBuf};

/// Words of question, expectation and answer of an item at most: all else is folded.
const WORDS: usize = 120;
/// Decimals of a number in a sentence at most.
const DECIMALS: usize = 9;
/// Bytes of the pages at most, an item of the short one.
const PAGES: [(&str, usize); 2] = [("README.md", 1_100), ("index.html", 1_200_000)];

fn reports() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("reports")
}

/// Every section of the report: its name, what all read, and what is folded.
fn sections() -> Vec<(String, [String; 2])> {
    let folders = [reports(), reports().join("host")];
    let items = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let files = items.map(|item| item.unwrap().path().join("section.json")).filter(|file| file.exists());
    let section = |file: PathBuf| {
        let section: serde_json::Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
        let text = |name: &str| section[name].as_str().unwrap().to_owned();
        let details = section["details"].as_array().unwrap().iter().filter_map(|it| it.as_str());
        let read = ["question", "expected", "answer"].map(text).join(" ");
        (text("name"), [read, details.collect::<Vec<_>>().join(" ")])
    };
    files.map(section).collect()
}

#[test]
fn an_item_is_read_in_a_minute() {
    let sections = sections();
    assert!(sections.len() > 30);
    let items = sections.len();
    for (name, [read, _]) in sections {
        let words = read.split_whitespace().count();
        assert!(words <= WORDS, "{name}: {words} words");
    }
    for (page, most) in PAGES {
        let bytes = fs::metadata(reports().join(page)).unwrap().len();
        let most = if page == "README.md" { items * most } else { most };
        assert!(bytes <= most as u64, "{page}: {bytes} bytes");
    }
}

/// What is wrong with numbers in a sentence, for a reader.
fn clumsy(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split([' ', '\u{a0}']).collect();
    let long = words.iter().find(|word| {
        let decimals = word.split_once('.').map_or("", |(_, decimals)| decimals);
        decimals.chars().take_while(char::is_ascii_digit).count() > DECIMALS
    });
    // `1 layers`; `1 of 1 runs`. Letters with an s at their end that are no plural are few.
    let plural = |word: &str| {
        let word = word.trim_end_matches(['.', ',', ';', ':', ')']);
        word.len() > 3
            && word.ends_with('s')
            && !word.ends_with("ss")
            && word.chars().all(|c| c.is_ascii_lowercase())
    };
    let few = words.windows(2).find(|pair| pair[0] == "1" && plural(pair[1]));
    long.map(|word| (*word).to_owned()).or_else(|| few.map(|pair| pair.join(" ")))
}

#[test]
fn numbers_in_sentences_are_for_readers() {
    assert_eq!(clumsy("0.7142857142857143 ns"), Some("0.7142857142857143".into()));
    assert_eq!(clumsy("in 1 layers, in 2 layers"), Some("1 layers,".into()));
    assert_eq!(clumsy("in 1 layer of 0.25 m"), None);
    for (name, texts) in sections() {
        for text in texts {
            assert_eq!(clumsy(&text), None, "{name}");
        }
    }
}

/// Entries of a legend at most.
const ENTRIES: usize = 7;

#[test]
fn legends_are_short() {
    let folders = [reports(), reports().join("host")];
    let items = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    for file in items.map(|item| item.unwrap().path().join("section.json")).filter(|file| file.exists()) {
        let section: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
        for figure in section["figures"].as_array().unwrap() {
            let chart = &figure["picture"]["Chart"];
            let named = |list: &str, name: &str| {
                let all = chart[list].as_array().into_iter().flatten();
                all.filter(|it| it[name].as_str().is_some_and(|name| !name.is_empty())).count()
            };
            let entries = named("series", "name") + named("bands", "label");
            assert!(entries <= ENTRIES, "{} {}: {entries}", section["name"], figure["name"]);
        }
    }
}
