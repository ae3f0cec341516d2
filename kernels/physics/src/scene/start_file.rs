//! Start files of scenes, and what keys supply where a file lacks it.

use super::binding::Binding;
use super::disc_keys::{FILE, FRAME, MASS, RADIUS, SEED};
use super::shared_frame::SharedFrame;
use super::speed::{Speed, bind_exactness};
use crate::io::start_files::{StartFileError, StartFrame, StartRequest, read_start_file};
use std::path::{Path, PathBuf};

/// Start file, read once by the runs that share it.
#[derive(Clone, Debug, Default)]
pub struct StartFile {
    path: PathBuf,
    /// Number of the frame; the last one if none.
    frame: Option<u64>,
    /// Values of keys for what the file lacks.
    pub supplied: SuppliedValues,
    shared: Option<SharedFrame>,
}

/// Values for quantities that a start file lacks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SuppliedValues {
    /// Radius of all discs (length).
    pub radius: Option<f64>,
    /// Mass of all particles (mass).
    pub mass: Option<f64>,
    /// Velocities.
    pub speed: Option<Speed>,
    /// True if drawn velocities have their temperature exactly.
    pub is_exact: bool,
    /// Seed of drawn velocities.
    pub seed: u64,
}

impl PartialEq for StartFile {
    fn eq(&self, other: &StartFile) -> bool {
        (&self.path, self.frame, self.supplied) == (&other.path, other.frame, other.supplied)
    }
}

impl StartFile {
    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Binds the path and the number of the frame to keys of a method.
    pub(crate) fn bind_frame(
        &mut self,
        binding: &mut dyn Binding,
        file: &'static super::Key,
        frame: &'static super::Key,
    ) {
        let mut name = self.path.to_string_lossy().into_owned();
        binding.word(file, &mut name);
        self.path = path_beside(binding.file(), &name);
        self.shared = binding.shared_start();
        binding.whole_if_any(frame, &mut self.frame);
    }

    /// Binds the keys of a start file of discs.
    pub(super) fn bind(&mut self, binding: &mut dyn Binding) {
        self.bind_frame(binding, &FILE, &FRAME);
        let SuppliedValues { radius, mass, speed, is_exact, seed } = &mut self.supplied;
        binding.number_if_any(&RADIUS, radius);
        binding.number_if_any(&MASS, mass);
        Speed::bind(binding, speed);
        if speed.is_some() {
            binding.whole(&SEED, seed);
            bind_exactness(binding, is_exact);
        }
    }

    /// Returns the frame, as the first of the runs that share it has read it. `is_planar` requires particles in a plane.
    ///
    /// # Errors
    /// [`StartFileError`] if the file cannot be read or lacks the frame.
    pub(crate) fn read(&self, is_planar: bool) -> Result<StartFrame, StartFileError> {
        let request = StartRequest { frame: self.frame, is_planar };
        let known = self.shared.as_ref().and_then(|shared| shared.get());
        if let Some((.., frame)) = known.filter(|(path, of, _)| (path, *of) == (&self.path, request)) {
            return Ok(frame.clone());
        }
        let frame = read_start_file(&self.path, request)?;
        if let Some(shared) = &self.shared {
            #[expect(clippy::let_underscore_must_use, reason = "another thread has read the same meanwhile")]
            let _ = shared.set((self.path.clone(), request, frame.clone()));
        }
        Ok(frame)
    }
}

/// Path of a file that a scene names: absolute, or relative to the scene file.
pub(crate) fn path_beside(scene_file: &str, path: &str) -> PathBuf {
    let folder = Path::new(scene_file).parent().unwrap_or(Path::new(""));
    let path = folder.join(path);
    std::path::absolute(&path).unwrap_or(path)
}
