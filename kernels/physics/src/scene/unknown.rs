//! Help for keys that a method lacks.

use super::general::METHOD;
use super::key_set::KeySet;
use super::keys::Key;
use super::values::Vocabulary;
use crate::words::nearest;

/// Key that a method lacks.
#[derive(Clone, Copy)]
pub(super) struct UnknownKey<'u> {
    pub(super) keys: &'static KeySet,
    /// All methods.
    pub(super) methods: &'u [&'static Vocabulary],
    /// Section in which it was given.
    pub(super) section: &'static str,
    pub(super) name: &'u str,
    /// True if it comes from the command line, where a key may be given without its section.
    pub(super) overrides: bool,
}

/// Help for an unknown key.
pub(super) enum KeyHelp {
    /// Sentence, and the keys that may be meant.
    Advice(String, Vec<&'static Key>),
    /// Keys of the section, since none is similar.
    Expected(String),
}

impl UnknownKey<'_> {
    /// Most specific help available, in this order: the method's own advice, methods that have the key, a longer name in the section, a section
    /// that has the name, the most similar name.
    pub(super) fn help(self) -> KeyHelp {
        let sentence = |text: String| KeyHelp::Advice(text, vec![]);
        let (path, method) = (self.path(), self.keys.method);
        if let Some((_, why)) = self.keys.advice.iter().find(|(key, _)| *key == path) {
            return sentence((*why).to_owned());
        }
        let has_it = |other: &&&Vocabulary| other.keys.key(self.section, self.name).is_some();
        let others: Vec<String> =
            self.methods.iter().filter(has_it).map(|other| format!("\"{}\"", other.keys.method)).collect();
        if !others.is_empty() {
            return sentence(format!(
                "it is a key of scenes with {} = {}",
                METHOD.path(),
                others.join(" or ")
            ));
        }
        let exact = self.more_exact();
        if !exact.is_empty() {
            return did_you_mean(exact);
        }
        let named = self.full_names();
        if self.overrides && !named.is_empty() {
            return did_you_mean(named);
        }
        if let Some(key) = self.keys.keys().find(|key| key.name == self.name) {
            let home = match key.section {
                "" => "at the top of the file".to_owned(),
                section => format!("in [{section}]"),
            };
            return KeyHelp::Advice(format!("`{}` belongs {home}", key.name), vec![key]);
        }
        let in_section = || self.keys.section(self.section).map(|key| key.name);
        if let Some(key) = nearest(self.name, in_section()).and_then(|name| self.keys.key(self.section, name))
        {
            return KeyHelp::Advice(format!("did you mean `{}`?", key.name), vec![key]);
        }
        match in_section().next() {
            None => sentence(format!(
                "scenes with {} = \"{method}\" have no keys in [{}]",
                METHOD.path(),
                self.section
            )),
            Some(_) => KeyHelp::Expected(in_section().collect::<Vec<_>>().join(", ")),
        }
    }

    fn path(self) -> String {
        if self.section.is_empty() { self.name.to_owned() } else { format!("{}.{}", self.section, self.name) }
    }

    /// Keys of the section that contain all words of the name and more: `bath_temperature` for `temperature`.
    fn more_exact(self) -> Vec<&'static Key> {
        let has = |key: &&'static Key| {
            self.name.split('_').all(|word| key.name.split('_').any(|other| other == word))
        };
        if self.section.is_empty() { vec![] } else { self.keys.section(self.section).filter(has).collect() }
    }

    /// Keys of the method with this name, in any section. Without any: the most similar of the section, or of all keys if no section is given.
    fn full_names(self) -> Vec<&'static Key> {
        let called = |name: &str| self.keys.keys().filter(|key| key.name == name).collect::<Vec<_>>();
        match called(self.name) {
            exact if !exact.is_empty() => exact,
            _ if self.section.is_empty() => {
                nearest(self.name, self.keys.keys().map(|key| key.name)).map_or(vec![], called)
            }
            _ => {
                let near = nearest(self.name, self.keys.section(self.section).map(|key| key.name));
                near.and_then(|name| self.keys.key(self.section, name)).into_iter().collect()
            }
        }
    }
}

fn did_you_mean(keys: Vec<&'static Key>) -> KeyHelp {
    let paths: Vec<String> = keys.iter().map(|key| format!("`{}`", key.path())).collect();
    KeyHelp::Advice(format!("did you mean {}?", paths.join(" or ")), keys)
}

#[cfg(test)]
mod tests {
    use crate::method::{METHODS, load};

    /// Keys that are misspelt, of other programs, of other methods or in the wrong section, for each method, in a file and on the command line: no
    /// help suggests a key with another meaning.
    #[test]
    fn help_suggests_the_intended_key() {
        for (preset, key, words) in [
            ("langevin-free", "law.temperature", "did you mean `law.bath_temperature`?"),
            ("langevin-free", "law.seed", "did you mean `law.noise_seed`?"),
            ("langevin-free", "law.friction", "the friction of the bath is `law.drag`"),
            ("langevin-free", "law.gamma", "the friction of the bath is `law.drag`"),
            ("langevin-free", "particles.bath_temperature", "law.bath_temperature"),
            ("langevin-free", "law.stiffness", "\"lattice-md\""),
            ("langevin-free", "integrator.step", "did you mean `integrator.dt`?"),
            ("langevin-free", "run.events", "\"hard-disks\""),
            ("hard-disks", "integrator.dt", "hard discs have no time step"),
            ("hard-disks", "integrator.kind", "hard discs have no time step"),
            ("hard-disks", "integrator.scheme", "hard discs have no time step"),
            ("hard-disks", "run.steps", "`run.events` or `run.time`"),
            ("hard-disks", "law.temperature", "`particles.temperature`"),
            ("hard-disks", "law.bath_temperature", "`law.thermal_side`"),
            ("hard-disks", "law.friction", "hard discs are smooth"),
            ("hard-disks", "law.stiffness", "hard discs are rigid"),
            ("hard-disks", "law.restitution_wall", "did you mean `law.wall_restitution`?"),
            ("hard-disks", "machine.precision", "always in double precision"),
            ("dense-gas", "law.temperature", "particles.temperature"),
            ("dense-gas", "law.restitution", "\"hard-disks\""),
            ("dense-gas", "law.bath_temperature", "\"langevin\""),
            ("dense-gas", "law.frction", "law.friction"),
            ("dense-gas", "integrator.timestep", "integrator.dt"),
            ("dense-gas", "integrator.time_step", "integrator.dt"),
            ("dense-gas", "domain.size", "sides"),
            ("dense-gas", "run.dt", "integrator.dt"),
            ("plummer", "law.G", "did you mean `law.gravitational_constant`?"),
            ("plummer", "law.gravitational", "did you mean `law.gravitational_constant`?"),
            ("plummer", "law.epsilon", "softening"),
            ("plummer", "domain.sides", "bodies are in open space"),
            ("plummer", "domain.gravity", "bodies are in open space"),
            ("plummer", "particles.radius", "bodies are points"),
            ("plummer", "particles.softening", "law.softening"),
            ("plummer", "particles.temperature", "`particles.virial`"),
        ] {
            let failed = |overrides: &[String], scene: &str| match load(scene, overrides, METHODS) {
                Ok(_) => panic!("{preset}: {key} is taken"),
                Err(errors) => errors.to_string(),
            };
            let on_command_line = failed(&[format!("{key}=1")], preset);
            let text =
                METHODS.iter().flat_map(|method| method.vocabulary.presets).find(|it| it.name == preset);
            let (section, name) = key.split_once('.').unwrap();
            let header = format!("[{section}]\n");
            let text = text.unwrap().text;
            let text = match text.contains(&header) {
                true => text.replacen(&header, &format!("{header}{name} = 1\n"), 1),
                false => format!("{text}\n{header}{name} = 1\n"),
            };
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("scene.toml");
            std::fs::write(&file, text).unwrap();
            let in_file = failed(&[], file.to_str().unwrap());
            for said in [on_command_line, in_file] {
                let bare = words.rsplit('.').next().unwrap();
                let is_path = !words.contains(' ') && words.contains('.');
                assert!(said.contains(words) || is_path && said.contains(bare), "{preset} {key}: {said}");
                assert!(!said.contains("dcd") && !said.contains("is missing"), "{preset} {key}: {said}");
            }
        }
    }
}
