//! Failures of a method: what broke, when, which particles, and what to do. A method defines its failures beside the physics they concern.

use super::clock::Clock;
use crate::number::significant;
use crate::reported::{ErrorClass, Reported};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::fmt;
use std::sync::{Mutex, PoisonError};
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::sweep::fast::GridError;

/// Kind of a failure, by its name in JSON. Kinds shared by several methods are defined here; a method defines its own beside the physics they
/// concern.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailureKind(#[serde(deserialize_with = "interned")] InternedName);

/// Interned name in a failure.
type InternedName = &'static str;

/// Reads a name sent by another rank. Each name is leaked once and kept for the life of the process.
fn interned<'de, D: Deserializer<'de>>(deserializer: D) -> Result<InternedName, D::Error> {
    static NAMES: Mutex<BTreeSet<InternedName>> = Mutex::new(BTreeSet::new());
    let name = String::deserialize(deserializer)?;
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    Ok(names.get(name.as_str()).copied().unwrap_or_else(|| {
        let name: InternedName = name.leak();
        names.insert(name);
        name
    }))
}

/// Reads values with their names.
fn interned_values<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<(InternedName, f64)>, D::Error> {
    #[derive(Deserialize)]
    struct NamedNumber(#[serde(deserialize_with = "interned")] InternedName, f64);
    let values = Vec::<NamedNumber>::deserialize(deserializer)?;
    Ok(values.into_iter().map(|NamedNumber(name, value)| (name, value)).collect())
}

impl FailureKind {
    /// Positions or forces that are not finite.
    pub const NOT_FINITE: FailureKind = FailureKind("not-finite");
    /// Particles outside a closed side, or more than a period outside a periodic one.
    pub const OUT_OF_BOX: FailureKind = FailureKind("out-of-box");
    /// Two particles in a cell that holds one.
    pub const CONFLICT: FailureKind = FailureKind("conflict");
    /// A contact deeper than the scene allows.
    pub const TOO_DEEP: FailureKind = FailureKind("too-deep");
    /// A particle that moved so far in a step that it may have passed through another undetected.
    pub const LONG_STEP: FailureKind = FailureKind("long-step");
    /// Sums over all particles that overflow.
    pub const OVERFLOW: FailureKind = FailureKind("overflow");
    /// Sectors do not fit the box.
    pub(crate) const NO_SECTORS: FailureKind = FailureKind("no-sectors");
    /// The vector machine rejected a program.
    pub(crate) const MACHINE: FailureKind = FailureKind("machine");

    /// Defines a kind of a method.
    pub const fn new(name: &'static str) -> FailureKind {
        FailureKind(name)
    }

    /// Name in JSON.
    pub fn name(self) -> &'static str {
        self.0
    }
}

/// Particle named by a failure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Culprit {
    /// Word for a particle in its method.
    #[serde(deserialize_with = "interned")]
    pub(crate) called: InternedName,
    /// Its id.
    pub id: u32,
    /// Position (length).
    pub position: [f64; 3],
    /// Velocity (length/time).
    pub velocity: [f64; 3],
}

impl Culprit {
    /// Particle that moves in a plane.
    pub(crate) fn in_plane(called: &'static str, id: u32, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Culprit {
        Culprit { called, id, position: [x, y, 0.0], velocity: [u, v, 0.0] }
    }
}

impl fmt::Display for Culprit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Culprit { called, id, position, velocity } = self;
        let axes = if position[2] == 0.0 && velocity[2] == 0.0 { 2 } else { 3 };
        let list = |numbers: Vec<String>| numbers.join(", ");
        let position = list(position.iter().take(axes).map(|x| significant(*x, 10)).collect());
        let velocity = list(velocity.iter().take(axes).map(|v| significant(*v, 5)).collect());
        write!(f, "{called} {id} at ({position}) with velocity ({velocity})")
    }
}

/// Violation of a method's precondition by the physics, detected in the step in which it occurs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhysicsFailure {
    /// Kind.
    pub kind: FailureKind,
    /// Time of the failure; none if no simulation existed or time is irrelevant.
    pub at: Option<Clock>,
    /// Named particles: the first affected, or the two of a pair.
    pub culprits: Vec<Culprit>,
    /// Number of affected particles.
    pub count: u64,
    /// Measured values and limits, by name.
    #[serde(deserialize_with = "interned_values")]
    pub values: Vec<(InternedName, f64)>,
    /// Sentence that says what broke and names the particles, without the moment.
    pub message: String,
    /// Remedy.
    pub remedy: String,
}

impl PhysicsFailure {
    /// Failure that names no particle and no moment.
    pub fn new(kind: FailureKind, message: impl Into<String>, remedy: impl Into<String>) -> PhysicsFailure {
        let (message, remedy) = (message.into(), remedy.into());
        PhysicsFailure { kind, at: None, culprits: vec![], count: 0, values: vec![], message, remedy }
    }

    /// Adds the moment.
    pub fn at(self, clock: Clock) -> PhysicsFailure {
        PhysicsFailure { at: Some(clock), ..self }
    }

    /// Adds the number of affected particles and those to name.
    pub fn of(self, count: u64, culprits: impl Into<Vec<Culprit>>) -> PhysicsFailure {
        PhysicsFailure { count, culprits: culprits.into(), ..self }
    }

    /// Adds measured values and limits.
    pub fn with(self, values: impl Into<Vec<(&'static str, f64)>>) -> PhysicsFailure {
        PhysicsFailure { values: values.into(), ..self }
    }

    /// Measured value or limit of a name.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|(known, _)| *known == name).map(|&(_, value)| value)
    }

    /// Moment, problem and particles in a sentence.
    pub fn what_and_when(&self) -> String {
        match self.at {
            Some(clock) => format!("{clock}: {}", self.message),
            None => self.message.clone(),
        }
    }

    /// Data of the failure without its sentences. Numbers that are not finite become null.
    fn data(&self) -> Map<String, Value> {
        let values: Map<String, Value> =
            self.values.iter().map(|&(name, value)| (name.to_owned(), json!(value))).collect();
        let entries = [
            ("kind", json!(self.kind.name())),
            ("when", json!(self.at)),
            ("who", json!(self.culprits)),
            ("count", json!(self.count)),
            ("values", Value::Object(values)),
        ];
        entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }

    /// Serializes a failure, or none.
    pub(crate) fn in_json<S: Serializer>(
        failure: &Option<PhysicsFailure>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let Some(failure) = failure else { return serializer.serialize_none() };
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("message", &failure.what_and_when())?;
        map.serialize_entry("remedy", &failure.remedy)?;
        failure.data().iter().try_for_each(|(name, value)| map.serialize_entry(name, value))?;
        map.end()
    }
}

impl fmt::Display for PhysicsFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n  help: {}", self.what_and_when(), self.remedy)
    }
}

impl std::error::Error for PhysicsFailure {}

impl Reported for PhysicsFailure {
    fn class(&self) -> ErrorClass {
        ErrorClass::Precondition
    }

    fn remedy(&self) -> Option<String> {
        Some(self.remedy.clone())
    }

    fn details(&self) -> Option<Value> {
        Some(Value::Object(self.data()))
    }
}

impl From<GridError> for PhysicsFailure {
    fn from(error: GridError) -> PhysicsFailure {
        let remedy = "use more discs, a smaller search.skin, or search.by = \"lattice\"";
        PhysicsFailure::new(FailureKind::NO_SECTORS, error.to_string(), remedy)
    }
}

impl From<ProgramError> for PhysicsFailure {
    fn from(error: ProgramError) -> PhysicsFailure {
        let remedy = match error {
            ProgramError::NoSuchInstructionSet(_) => "set machine.instruction_set = \"auto\"",
            _ => "the program is at fault, not the scene: report this with the scene",
        };
        PhysicsFailure::new(FailureKind::MACHINE, error.to_string(), remedy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_are_sentences_and_data() {
        let culprit = Culprit::in_plane("disc", 7, [1.0, f64::NAN], [0.5, 0.0]);
        let at = |clock| {
            let failure =
                PhysicsFailure::new(FailureKind::NOT_FINITE, format!("first {culprit}"), "halve dt");
            failure.at(clock).of(3, [culprit]).with([("limit", 0.25)])
        };
        let failure = at(Clock { steps: 61, time: 0.5, events: 0 });
        assert_eq!(
            failure.to_string(),
            "step 61: first disc 7 at (1, NaN) with velocity (0.5, 0)\n  help: halve dt"
        );
        assert_eq!((failure.value("limit"), failure.value("depth")), (Some(0.25), None));
        let data = json!({
            "kind": "not-finite", "count": 3, "values": {"limit": 0.25},
            "when": {"steps": 61, "time": 0.5, "events": 0},
            "who": [{"called": "disc", "id": 7, "position": [1.0, null, 0.0], "velocity": [0.5, 0.0, 0.0]}],
        });
        assert_eq!(failure.details(), Some(data));
        let whole = PhysicsFailure::in_json(&Some(failure), serde_json::value::Serializer).unwrap();
        assert_eq!((&whole["remedy"], &whole["kind"]), (&json!("halve dt"), &json!("not-finite")));
        // A method of events takes no steps.
        assert!(
            at(Clock { steps: 0, time: 0.5, events: 9 })
                .what_and_when()
                .starts_with("event 9, time 0.5: first")
        );
        let refused = PhysicsFailure::from(ProgramError::NoSuchInstructionSet("avx512"));
        assert_eq!((refused.what_and_when().as_str(), refused.at), ("this processor has no avx512", None));
        assert!(refused.remedy.contains("instruction_set"));
    }
}
