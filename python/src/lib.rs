//! Python package `stripmine`: scenes, simulations and runs, with numpy arrays and Arrow tables. The Python interface is described
//! in `stripmine/__init__.pyi`.

mod checked;
mod computing;
mod exceptions;
mod frames;
mod interruption;
mod json;
mod lists;
mod overrides;
mod particles;
mod pickling;
mod pulse;
mod run;
mod running;
mod scene;
mod scratch;
mod simulation;
mod steering;
mod table;
mod tracing;

use pyo3::prelude::*;

/// Names that `stripmine/__init__.py` re-exports.
#[pymodule]
mod _stripmine {
    #[pymodule_export]
    use crate::computing::_forked;
    #[pymodule_export]
    use crate::frames::{_frame, Frame, Frames};
    #[pymodule_export]
    use crate::lists::{keys, methods, presets};
    #[pymodule_export]
    use crate::particles::{_particles, Particles};
    #[pymodule_export]
    use crate::run::{Run, average, read};
    #[pymodule_export]
    use crate::scene::{Scene, scene};
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::table::{_table, Table};
    #[pymodule_export]
    use crate::tracing::{_TracedProgram, _traced};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("_attributes_of_particles", Particles::ATTRIBUTES.to_vec())?;
        module.add("_attributes_of_a_frame", Frame::ATTRIBUTES.to_vec())?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
