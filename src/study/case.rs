//! Scene of a study, with its configurations.

use super::SettingChoice;
use crate::results::JournalIdentity;
use sha2::{Digest, Sha256};
use stripmine_physics::method::{
    MethodEntry, Methods, ObservedQuantity, Prepared, Until, prepare, vocabularies,
};
use stripmine_physics::scene::{Overrides, SceneErrors, SceneValues};

/// Format of finished runs in journals; raised whenever their contents change.
const JOURNALED: &str = "12";

/// A scene, its method, and its own configuration.
pub(crate) struct StudyCase {
    what: String,
    /// Overrides as typed by the user; the values include them.
    overrides: Vec<String>,
    methods: Methods,
    pub entry: &'static MethodEntry,
    /// Values of the scene. Scene and start file are read once: all trials are of the same scene, even if the files change.
    pub values: SceneValues,
    /// The scene, prepared with its own values.
    pub prepared: Prepared,
    /// Its own configuration.
    pub own: SettingChoice,
}

impl StudyCase {
    /// Loads a scene by the name of a preset or the path of a file, with overrides.
    ///
    /// # Errors
    /// [`SceneErrors`] if the scene is invalid, or needs more memory than there is.
    pub(crate) fn load(what: &str, overrides: &[String], methods: Methods) -> Result<StudyCase, SceneErrors> {
        let text = SceneValues::text(what, &vocabularies(methods))?;
        StudyCase::parse(what, &text, overrides, methods)
    }

    /// Parses a scene from its text, under a name, with overrides.
    ///
    /// # Errors
    /// [`SceneErrors`] as for [`load`](StudyCase::load).
    pub(crate) fn parse(
        what: &str,
        text: &str,
        overrides: &[String],
        methods: Methods,
    ) -> Result<StudyCase, SceneErrors> {
        StudyCase::of(what, text, overrides, methods, None)
    }

    /// Parses a scene; the start file is shared with another scene that has read it, if one is given.
    fn of(
        what: &str,
        text: &str,
        overrides: &[String],
        methods: Methods,
        start: Option<&SceneValues>,
    ) -> Result<StudyCase, SceneErrors> {
        let values = SceneValues::parse(what, text, overrides, &vocabularies(methods))?;
        let values = match start {
            Some(other) => values.with_start_of(other),
            None => values.sharing_start(),
        };
        let (prepared, entry) = prepare(values.clone(), methods)?;
        prepared.memory.fits("scene")?;
        let own = SettingChoice::own(entry.axes, &prepared);
        Ok(StudyCase {
            what: what.to_owned(),
            overrides: overrides.to_vec(),
            methods,
            entry,
            values,
            prepared,
            own,
        })
    }

    /// Arguments that name the scene on a command line.
    pub(crate) fn arguments(&self) -> String {
        let set = self.overrides.iter().map(|text| format!(" --set {text}"));
        std::iter::once(self.what.clone()).chain(set).collect()
    }

    /// Observed quantities: those of the method, and those of the scene's walls and lines.
    pub(crate) fn quantities(&self) -> &'static [ObservedQuantity] {
        self.prepared.quantities(self.entry)
    }

    /// Time step of the scene; none where the method has none (time).
    pub(crate) fn step(&self) -> Option<f64> {
        let step = self.entry.trials?.step;
        // A method may derive the step from other keys: the resolved scene has it.
        self.values.number(step).or_else(|| {
            let resolved =
                SceneValues::parse(&self.what, &self.prepared.scene, &[], &vocabularies(self.methods));
            resolved.ok()?.number(step)
        })
    }

    /// Duration of the scene (time); none where its end is a number of events.
    pub(crate) fn duration(&self) -> Option<f64> {
        match self.prepared.schedule.until {
            Until::Time(time) => Some(time),
            Until::Steps(steps) => Some(steps as f64 * self.step()?),
            Until::Events(_) => None,
        }
    }

    /// Identity of a study: digest of the resolved scene, the options and the version of the program.
    pub(crate) fn identity(&self, study: &str, options: &str) -> JournalIdentity {
        let mut sum = Sha256::new();
        for part in [study, JOURNALED, options, env!("CARGO_PKG_VERSION"), &self.prepared.scene] {
            sum.update(part.as_bytes());
            sum.update([0]);
        }
        sum.update(self.prepared.particles().checksum().as_bytes());
        let digest = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        JournalIdentity { of: format!("{study} of {}", self.arguments()), digest }
    }

    /// Prepares the scene with further overrides.
    pub(crate) fn prepared_with(&self, more: &Overrides) -> Result<Prepared, SceneErrors> {
        Ok(prepare(self.values.with(more)?, self.methods)?.0)
    }

    /// Parses another scene with the same methods, and the same start file if it has one.
    pub(crate) fn with_text_of(&self, text: &str) -> Result<StudyCase, SceneErrors> {
        StudyCase::of(&self.what, text, &[], self.methods, Some(&self.values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use stripmine_physics::io::extxyz::{ParticleFrame, write};
    use stripmine_physics::method::{METHODS, load};
    use stripmine_physics::particles::Particles;
    use stripmine_physics::scene::TIME;

    /// A scene and its start file may change or vanish once they are read: every later preparation uses the original discs, and so does a derived
    /// scene.
    #[test]
    fn scene_and_start_file_are_read_once() {
        let folder = tempfile::tempdir().unwrap();
        let [scene, start] = ["scene.toml", "start.xyz"].map(|name| folder.path().join(name));
        let (gas, _) = load("hard-disks", &["particles.count=20".to_owned()], METHODS).unwrap();
        let written = |particles: &Particles| {
            let frame = ParticleFrame {
                particles: particles.clone(),
                cell: gas.domain.lengths(),
                origin: gas.domain.corner(),
                periodic: None,
                time: 0.0,
                step: 0,
                seed: None,
                has_raised_ids: false,
            };
            write(&frame, &mut fs::File::create(&start).unwrap()).unwrap();
        };
        written(gas.particles());
        let text = format!(
            "format = 2\nunits = \"reduced\"\n[method]\nkind = \"hard-disks\"\n[domain]\nsides = {:?}\n[particles]\nfile = \"start.xyz\"\n[run]\ntime = 1.0\n",
            gas.domain.lengths()
        );
        fs::write(&scene, &text).unwrap();
        let case = StudyCase::load(scene.to_str().unwrap(), &[], METHODS).unwrap();
        let checksum = case.prepared.particles().checksum();
        let again = |case: &StudyCase| {
            case.prepared_with(&Overrides::new().set(&TIME, 2.0)).unwrap().particles().checksum()
        };
        // First another frame, then no files.
        let mut others = gas.particles().clone();
        others.all_mut()[0].velocity[0] += 1.0;
        written(&others);
        fs::write(&scene, "none").unwrap();
        assert_eq!(again(&case), checksum);
        fs::remove_file(&start).unwrap();
        fs::remove_file(&scene).unwrap();
        assert_eq!(again(&case), checksum);
        assert_eq!(again(&case.with_text_of(&text).unwrap()), checksum);
    }
}
