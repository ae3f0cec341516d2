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
    /// If both have it, or neither.
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
                    "the start file {path} has no {column}; by its format the value is {}",
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
            (QuantitySource::Missing, None) => Err(self.missing(quantity, key)),
            (QuantitySource::Stated, None) => Ok(false),
            (_, Some(_)) => Ok(true),
        }
    }

    /// Error for a quantity that neither the file nor a key has.
    fn missing(&self, quantity: StartQuantity, key: &Key) -> SceneError {
        let line = self.frame.line.map_or_else(String::new, |line| format!(":{line}"));
        let message = format!(
            "the start file {}{line} has no {}, and `{}` is not given",
            self.path,
            self.frame.column(quantity),
            key.path()
        );
        let error = self.values.spot(self.file).error(MistakeKind::Missing, message);
        let error =
            error.expecting(format!("{} in [{}], or the column in the file", key.expected(), key.section));
        error.advising(match quantity {
            StartQuantity::Velocity => self.rest,
            StartQuantity::Radius | StartQuantity::Mass => key.doc,
        })
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
