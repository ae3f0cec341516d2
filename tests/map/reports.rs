//! Length and language of the committed report.

use std::fs;
use std::path::{Path, PathBuf};
use stripmine::report::Section;
use stripmine::results::Folder;

/// Largest number of words of an item's question, expectation and answer; everything else is folded.
const WORDS: usize = 120;
/// Largest number of decimals in a sentence.
const DECIMALS: usize = 9;
/// Largest sizes of the pages in bytes: of the short one for each item, plus [`FAILED`] for each failed claim on its first screen. The page with
/// charts grew by 80 kB for six items of ISO99, BP93 and PWP with their charts, by 60 kB for five more, and by 20 kB for the programs on RISC-V and the models of others.
const PAGES: [(&str, usize); 2] = [("README.md", 1_100), ("index.html", 1_370_000)];
const FAILED: usize = 400;
/// Further bytes of the page with charts for each claim.
const CLAIM: usize = 700;

fn reports() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("reports")
}

/// All sections of the report, as its page shows them.
fn sections() -> Vec<Section> {
    let folder = Folder::opened_elsewhere(&reports());
    let items =
        [reports(), reports().join("host")].into_iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let names = items.map(|item| item.unwrap()).filter(|item| item.path().join("provenance.json").exists());
    names.filter_map(|item| folder.section(item.file_name().to_str().unwrap()).unwrap()).collect()
}

#[test]
fn report_items_are_short() {
    let sections = sections();
    assert!(sections.len() > 30);
    let items = sections.len();
    let claims = sections.iter().map(|it| it.claims.len()).sum::<usize>();
    let failed =
        sections.iter().flat_map(|it| &it.claims).filter(|it| it.verdict == "not reproduced").count();
    for Section { name, question, expected, answer, .. } in sections {
        let words =
            [question, expected, answer].iter().map(|it| it.split_whitespace().count()).sum::<usize>();
        assert!(words <= WORDS, "{name}: {words} words");
    }
    for (page, most) in PAGES {
        let bytes = fs::metadata(reports().join(page)).unwrap().len();
        let most = if page == "README.md" { items * most + failed * FAILED } else { most + claims * CLAIM };
        assert!(bytes <= most as u64, "{page}: {bytes} bytes");
    }
}

/// First number of a sentence that is hard to read: too many decimals, or 1 with a plural.
fn clumsy(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split([' ', '\u{a0}']).collect();
    let long = words.iter().find(|word| {
        let decimals = word.split_once('.').map_or("", |(_, decimals)| decimals);
        decimals.chars().take_while(char::is_ascii_digit).count() > DECIMALS
    });
    // `1 layers`; `1 of 1 runs`. Few words with a final s are no plural.
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
fn numbers_in_sentences_are_readable() {
    assert_eq!(clumsy("0.7142857142857143 ns"), Some("0.7142857142857143".into()));
    assert_eq!(clumsy("in 1 layers, in 2 layers"), Some("1 layers,".into()));
    assert_eq!(clumsy("in 1 layer of 0.25 m"), None);
    for section in sections() {
        for text in
            [&section.question, &section.expected].into_iter().map(String::as_str).chain(section.paragraphs())
        {
            assert_eq!(clumsy(text), None, "{}", section.name);
        }
    }
}

/// Largest number of entries of a legend.
const ENTRIES: usize = 7;

#[test]
fn legends_are_short() {
    for section in sections() {
        for figure in &section.figures {
            let entries = figure.legend();
            assert!(entries.len() <= ENTRIES, "{}: {entries:?}", section.name);
        }
    }
}

/// A column described as words holds at least one: a reader of tables takes a column of numbers for numbers (tests/clients/report_tables.py).
#[test]
fn columns_of_words_are_not_numbers() {
    let items = [reports(), reports().join("host")].into_iter().flat_map(|it| fs::read_dir(it).unwrap());
    let packages = items.map(|item| item.unwrap().path()).filter(|it| it.join("datapackage.json").exists());
    for folder in packages {
        let package: serde_json::Value =
            serde_json::from_slice(&fs::read(folder.join("datapackage.json")).unwrap()).unwrap();
        for resource in package["resources"].as_array().unwrap() {
            let file = folder.join(resource["path"].as_str().unwrap());
            let rows: Vec<csv::StringRecord> =
                csv::Reader::from_path(&file).unwrap().records().map(Result::unwrap).collect();
            for (column, field) in resource["schema"]["fields"].as_array().unwrap().iter().enumerate() {
                let mut cells = rows.iter().map(|row| &row[column]).filter(|it| !it.is_empty()).peekable();
                let numbers = cells.peek().is_some() && cells.all(|it| it.parse::<f64>().is_ok());
                assert!(!numbers || field["type"] != "string", "{}: {}", file.display(), field["name"]);
            }
        }
    }
}
