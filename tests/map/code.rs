//! Files of the crates and the arrows between them, from `use` declarations and paths in the code, through re-exports.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::tokens::{Token, Use, tokens, uses, without_tests};

/// A crate by its name in code, its sources, and its name in drawings.
#[derive(Debug, Clone, Copy)]
pub struct Crate {
    pub name: &'static str,
    pub folder: &'static str,
    pub short: &'static str,
}

/// Crates from the lowest to the highest: each uses only those before it.
pub const CRATES: [Crate; 4] = [
    Crate { name: "stripmine_kernels", folder: "kernels/src", short: "kernels" },
    Crate { name: "stripmine_physics", folder: "kernels/physics/src", short: "physics" },
    Crate { name: "stripmine", folder: "src", short: "src" },
    Crate { name: "stripmine_python", folder: "python/src", short: "python" },
];

impl Crate {
    /// The crate of a file.
    pub fn of(path: &str) -> Self {
        let within = CRATES.iter().filter(|it| Path::new(path).starts_with(it.folder));
        *within.max_by_key(|it| it.folder.len()).unwrap()
    }

    /// The room of a file: the top folder or file of the crate that contains it.
    pub fn room(self, path: &str) -> &str {
        let within = path.strip_prefix(self.folder).unwrap().trim_start_matches('/');
        within.split('/').next().unwrap().trim_end_matches(".rs")
    }
}

/// A module that is a file: the crate's name and the path of modules.
type Module = Vec<String>;

/// A source file, without code compiled for tests only.
#[derive(Debug)]
struct Source {
    path: String,
    tokens: Vec<Token>,
    uses: Vec<Use>,
}

impl Source {
    /// Resolves the first name of a path if a `use` binds it.
    fn in_full(&self, path: Vec<String>) -> Vec<String> {
        match self.uses.iter().find(|it| it.name == path[0]) {
            Some(bound) => [&bound.path[..], &path[1..]].concat(),
            None => path,
        }
    }
}

/// All sources, by module.
#[derive(Debug)]
pub struct Code {
    sources: BTreeMap<Module, Source>,
}

/// The user and the used file, each by its path from the root of the repository.
pub type Arrow = (String, String);

impl Code {
    /// Reads the crates below the root of the repository.
    pub fn read(root: &Path) -> Self {
        let mut sources = BTreeMap::new();
        for it in CRATES {
            read_folder(root, Path::new(it.folder), &[it.name.to_owned()], &mut sources);
        }
        Self { sources }
    }

    /// Names of other crates in `use` declarations, each with its file.
    pub fn foreign(&self) -> BTreeSet<(&str, &str)> {
        let mut found = BTreeSet::new();
        for (module, source) in &self.sources {
            // A single name is a macro's, which is in scope.
            for path in source.uses.iter().map(|it| &it.path).filter(|path| path.len() > 1) {
                if self.resolve(module, path).is_none() {
                    found.insert((source.path.as_str(), path[0].as_str()));
                }
            }
        }
        found
    }

    /// All arrows between files. A re-export (`pub use`) becomes an arrow of the files that use it.
    pub fn arrows(&self) -> BTreeSet<Arrow> {
        let mut arrows = BTreeSet::new();
        for (module, source) in &self.sources {
            let (words, inline) = text(&source.tokens);
            let used = source.uses.iter().filter(|it| !it.handed_on || words.contains(it.name.as_str()));
            let used = used.map(|it| it.path.clone());
            let inline = inline.into_iter().map(|path| source.in_full(path));
            for path in used.chain(inline) {
                let Some(found) = self.resolve(module, &path) else { continue };
                if found != *module {
                    arrows.insert((source.path.clone(), self.sources[&found].path.clone()));
                }
            }
        }
        arrows
    }

    /// The file that defines the target of a path, seen from a module; `None` for items of other crates.
    fn resolve(&self, from: &Module, path: &[String]) -> Option<Module> {
        let (first, rest) = path.split_first()?;
        let start = match first.as_str() {
            "crate" => vec![from[0].clone()],
            "self" => from.clone(),
            "super" => from[..from.len() - 1].to_vec(),
            name if CRATES.iter().any(|it| it.name == name) => vec![name.to_owned()],
            name => {
                let child = [&from[..], &[name.to_owned()]].concat();
                return self.sources.contains_key(&child).then(|| self.walk(child, rest));
            }
        };
        Some(self.walk(start, rest))
    }

    /// Follows a path down into modules, and through names that a module re-exports.
    fn walk(&self, at: Module, path: &[String]) -> Module {
        let Some((first, rest)) = path.split_first() else { return at };
        if first == "super" {
            return self.walk(at[..at.len() - 1].to_vec(), rest);
        }
        let child = [&at[..], std::slice::from_ref(first)].concat();
        if self.sources.contains_key(&child) {
            return self.walk(child, rest);
        }
        let bound = self.sources.get(&at).and_then(|source| source.uses.iter().find(|it| it.name == *first));
        match bound.and_then(|it| self.resolve(&at, &it.path)) {
            Some(found) => self.walk(found, rest),
            None => at,
        }
    }
}

/// Reads the files of a folder as modules below one, each with the folder of its name.
fn read_folder(root: &Path, folder: &Path, module: &[String], sources: &mut BTreeMap<Module, Source>) {
    let mut paths: Vec<_> =
        fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let child = [module, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            read_folder(root, &folder.join(&name), &child, sources);
            continue;
        }
        if path.extension().is_none_or(|it| it != "rs") || name == "tests" {
            continue;
        }
        let of_module = if ["mod", "lib", "main"].contains(&name.as_str()) { module.to_vec() } else { child };
        let path = folder.join(path.file_name().unwrap()).to_str().unwrap().to_owned();
        let tokens = without_tests(tokens(&fs::read_to_string(root.join(&path)).unwrap()));
        // The program is treated as part of the library's crate: it names the library as others do.
        let of_module = if name == "main" { [module, &["main".to_owned()]].concat() } else { of_module };
        sources.insert(of_module, Source { path, uses: uses(&tokens), tokens });
    }
}

/// Words and paths of the code without `use` declarations; a path begins with a crate, `self`, `super`, or any name (it may be a module's).
fn text(tokens: &[Token]) -> (BTreeSet<&str>, Vec<Vec<String>>) {
    let (mut words, mut paths) = (BTreeSet::new(), vec![]);
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at].is("use") {
            at += tokens[at..].iter().position(|it| *it == Token::Sign(';')).unwrap_or(1);
            continue;
        }
        let (path, next) = path_at(tokens, at);
        let is_visibility = at > 1 && tokens[at - 1].is("in") && tokens[at - 2] == Token::Sign('(');
        if path.len() > 1 && !is_visibility {
            paths.push(path);
        }
        words.extend(tokens[at].word());
        at = next.max(at + 1);
    }
    (words, paths)
}

/// The path that begins at a token, and the index after it.
fn path_at(tokens: &[Token], mut at: usize) -> (Vec<String>, usize) {
    let mut path = vec![];
    while let Some(word) = tokens.get(at).and_then(Token::word) {
        path.push(word.to_owned());
        at += 1;
        if tokens.get(at) != Some(&Token::Path) {
            break;
        }
        at += 1;
    }
    (path, at)
}
