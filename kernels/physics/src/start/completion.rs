//! Completion of a start file by keys of the scene.

use crate::io::start_files::{QuantitySource, StartFrame, StartQuantity};
use crate::number::significant;
use crate::particles::Particle;
use crate::scene::{Key, MistakeKind, SceneError, SceneValues, Warning};

/// Frame of a start file, and the scene whose keys supply what the file lacks.
pub(crate) struct StartCompletion<'s> {
    /// Values of the scene.
    pub(crate) values: &'s SceneValues,
    /// Frame of the file.
    pub(crate) frame: &'s StartFrame,
    /// Path of the file, for messages.
    pub(crate) path: &'s str,
    /// Key of the file.
    pub(crate) file: &'static Key,
    /// Advice for a file without velocities.
    pub(crate) rest: &'static str,
}

impl StartCompletion<'_> {
    /// Checks that keys supply every quantity that the file lacks; each comes with its key, and true if the key is given.
    ///
    /// # Errors
    /// One error that names all columns and keys.
    pub(crate) fn check(&self, quantities: &[(StartQuantity, &Key, bool)]) -> Result<(), SceneError> {
        let is_missing = |&&(quantity, _, is_given): &&(StartQuantity, &Key, bool)| {
            self.frame.source(quantity) == QuantitySource::Missing && !is_given
        };
        let missing: Vec<_> = quantities.iter().filter(is_missing).collect();
        let Some((last, ..)) = missing.last() else { return Ok(()) };
        let list = |of: &dyn Fn(&(StartQuantity, &Key, bool)) -> String, between: &str| {
            missing.iter().map(|it| of(it)).collect::<Vec<_>>().join(between)
        };
        let columns = list(&|(quantity, ..)| self.frame.column(*quantity).to_owned(), ", no ");
        let keys = list(&|(_, key, _)| format!("`{}`", key.path()), ", ");
        let line = self.frame.line.map_or_else(String::new, |line| format!(":{line}"));
        let are = if missing.len() == 1 { "is" } else { "are" };
        let message = format!("the start file {}{line} has no {columns}; {keys} {are} not given", self.path);
        let error = self.values.spot(self.file).error(MistakeKind::Missing, message);
        let error = error.expecting(list(&|(_, key, _)| key.expected(), "; "));
        Err(error.advising(match last {
            StartQuantity::Velocity => {
                format!("give it in [particles] ({}), or add the column to the file", self.rest)
            }
            StartQuantity::Radius | StartQuantity::Mass => {
                "give it in [particles], or add the column to the file".to_owned()
            }
        }))
    }

    /// Fills in a quantity that the file lacks with the value of its key, or with that of the file's format.
    pub(crate) fn quantity(
        &self,
        of: (StartQuantity, &Key),
        supplied: Option<f64>,
        particles: &mut [Particle],
        warnings: &mut Vec<Warning>,
        field: fn(&mut Particle) -> &mut f64,
    ) -> Result<(), SceneError> {
        let is_supplied = self.is_supplied(of, supplied, warnings)?;
        let value = match (is_supplied, supplied, self.frame.source(of.0)) {
            (true, Some(value), _) | (_, None, QuantitySource::Default(value)) => value,
            _ => return Ok(()),
        };
        particles.iter_mut().for_each(|particle| *field(particle) = value);
        Ok(())
    }

    /// True if the file lacks a quantity and a key supplies it.
    ///
    /// # Errors
    /// If both have it.
    pub(crate) fn is_supplied(
        &self,
        (quantity, key): (StartQuantity, &Key),
        supplied: Option<f64>,
        warnings: &mut Vec<Warning>,
    ) -> Result<bool, SceneError> {
        let (path, column) = (self.path, self.frame.column(quantity));
        match (self.frame.source(quantity), supplied) {
            (QuantitySource::Stated, Some(_)) => {
                let message = format!("`{}` has no effect: the start file {path} has {column}", key.path());
                let error = self.values.spot(key).error(MistakeKind::Unused, message);
                Err(error.advising("leave the key out, or leave the column out of the file"))
            }
            (QuantitySource::Default(value), None) => {
                let message = format!(
                    "the start file {path} has no {column}; by its format the {} is {}",
                    quantity.noun(),
                    significant(value, 3)
                );
                warnings.push(warning(
                    self.file,
                    "start-file-defaults",
                    message,
                    &format!("`{}` sets another value", key.path()),
                ));
                Ok(false)
            }
            (QuantitySource::Stated | QuantitySource::Missing, None) => Ok(false),
            (_, Some(_)) => Ok(true),
        }
    }
}

/// Warning about a start file.
pub(super) fn warning(file: &Key, check: &'static str, message: String, suggestion: &str) -> Warning {
    Warning {
        check,
        share: f64::INFINITY,
        is_refusal: false,
        key: file.path(),
        message,
        suggestion: suggestion.to_owned(),
    }
}
