//! Simulation methods: one folder for each publication, and one line in the [list](METHODS).

mod bound;
mod clock;
mod counted;
mod entry;
pub(crate) mod failure;
pub mod hard_disks;
pub mod langevin;
pub mod lattice_md;
mod list;
pub mod nbody;
pub mod observed;
mod pairwise;
mod restored;
mod scene_quantities;
mod several;
mod simulation;
mod snapshot;
mod start_temperature;
mod steering;
mod stepped;
pub mod throughput;
mod trials;

pub use crate::particles::PerParticle;
pub use bound::{BoundPrograms, ProgramCall};
pub use clock::{Clock, Every, Schedule, Until, steps_over};
pub use counted::SectionCounts;
pub use entry::{
    Bench, BenchOption, Fact, LimitConsequence, MethodEntry, MethodObservable, ObservedQuantity, Prepared,
    QuantityKind, StartPurpose, Startable, StepLimit, VectorProgram,
};
pub(crate) use entry::{is_sound, quantities};
pub use failure::{Culprit, FailureKind, PhysicsFailure};
pub use hard_disks::compress;
pub use list::{METHODS, Methods, load, method, prepare, vocabularies};
pub use pairwise::Elapsed;
pub(crate) use scene_quantities::names_of;
pub use scene_quantities::observed_quantities;
use several::rank_loss_failure;
pub(crate) use several::reject_several_ranks;
pub use several::{DISMISSED, RANK_ENDED};
pub use simulation::{RunWarning, Simulation};
pub use snapshot::Snapshot;
pub(crate) use start_temperature::START_TEMPERATURE;
pub use steering::{Change, SteeredQuantity, Steering, SteeringError};
pub(crate) use steering::{WORK_OF_CHANGES, has_no};
pub use stepped::{Stepped, SteppedState, Stepwise};
pub use trials::{
    AxisSetting, ChoiceEffect, DistanceUnit, EncounterGeometry, EnergyBalanceNames, Parameter,
    SMALLEST_RADIUS, SettingAxis, ShadowEnergy, SimplifiedModel, TheoreticalOrder, TranslatedScene, Trials,
    Twin,
};
