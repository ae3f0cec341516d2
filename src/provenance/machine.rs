//! The machine that something was measured on, as far as the system says.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs;
use std::path::Path;

/// What a time depends on beside the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name and the platform.
    pub(crate) processor: String,
    /// Family, model and stepping of the processor; none where the system does not say.
    #[serde(default)]
    pub model: Option<String>,
    /// Processors that the system shows.
    pub(crate) cores: usize,
    /// The clock of the first of them when it was asked (MHz).
    pub clock: Option<f64>,
    /// Caches of the first processor, such as `L1d 32K`.
    pub(crate) caches: Vec<String>,
    /// How the system sets the clock; none where it does not say, as in most virtual machines.
    pub(crate) governor: Option<String>,
    /// Whether the system runs in a virtual machine; none where it does not say.
    pub(crate) is_virtual: Option<bool>,
    /// The compiler of this program, and the flags that were given beside its profile.
    pub(crate) compiler: String,
}

impl Machine {
    /// This machine. What the system does not say is left out; Linux says it in `/proc/cpuinfo` and `/sys/devices/system/cpu`.
    pub(crate) fn here() -> Machine {
        #[expect(
            clippy::disallowed_methods,
            reason = "a system that does not name its processor leaves it out"
        )]
        let cpuinfo = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let field = |name: &str| {
            let value = |line: &str| Some(line.strip_prefix(name)?.split_once(':')?.1.trim().to_owned());
            cpuinfo.lines().find_map(value)
        };
        let first = Path::new("/sys/devices/system/cpu/cpu0");
        Machine {
            processor: stripmine_physics::origin::host(),
            model: model(&field),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            clock: field("cpu MHz").and_then(|clock| clock.parse().ok()),
            caches: (0..8).filter_map(|index| cache(&first.join(format!("cache/index{index}")))).collect(),
            governor: word(&first.join("cpufreq/scaling_governor")),
            is_virtual: field("flags").map(|flags| flags.split(' ').any(|flag| flag == "hypervisor")),
            compiler: env!("STRIPMINE_COMPILER").to_owned(),
        }
    }
}

impl Machine {
    /// This without the clock, which differs from moment to moment on some machines.
    pub(crate) fn without_clock(&self) -> Machine {
        Machine { clock: None, ..self.clone() }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.processor)?;
        if let Some(model) = &self.model {
            write!(f, ", {model}")?;
        }
        write!(f, ", {} cores", self.cores)?;
        if let Some(clock) = self.clock {
            write!(f, ", {:.2} GHz", clock / 1e3)?;
        }
        if !self.caches.is_empty() {
            write!(f, ", {}", self.caches.join(", "))?;
        }
        match &self.governor {
            Some(governor) => write!(f, ", governor {governor}")?,
            None => write!(f, ", clock not set by this system")?,
        }
        if self.is_virtual == Some(true) {
            write!(f, ", virtual machine")?;
        }
        write!(f, "; {}", self.compiler)
    }
}

/// Family, model and stepping, as `/proc/cpuinfo` has them.
fn model(field: &dyn Fn(&str) -> Option<String>) -> Option<String> {
    let [family, model, stepping] =
        [field("cpu family")?, field("model\t").or_else(|| field("model "))?, field("stepping")?];
    Some(format!("family {family} model {model} stepping {stepping}"))
}

/// A cache as the kernel describes it: level, kind, size.
fn cache(folder: &Path) -> Option<String> {
    let [level, kind, size] = ["level", "type", "size"].map(|name| word(&folder.join(name)));
    let kind = match kind?.as_str() {
        "Data" => "d",
        "Instruction" => "i",
        _ => "",
    };
    Some(format!("L{}{kind} {}", level?, size?))
}

fn word(path: &Path) -> Option<String> {
    fs::read_to_string(path).ok().map(|text| text.trim().to_owned()).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_described_as_far_as_it_is_known() {
        let machine = Machine {
            processor: "A, linux x86_64".into(),
            model: Some("family 25 model 17 stepping 1".into()),
            cores: 2,
            clock: Some(2595.124),
            caches: vec!["L1d 32K".into(), "L2 1024K".into()],
            governor: None,
            is_virtual: Some(true),
            compiler: "rustc 1.90.0".into(),
        };
        let said = machine.to_string();
        assert_eq!(
            said,
            "A, linux x86_64, family 25 model 17 stepping 1, 2 cores, 2.60 GHz, L1d 32K, L2 1024K, clock not set by this system, virtual machine; rustc 1.90.0"
        );
        let unknown = Machine {
            model: None,
            clock: None,
            caches: vec![],
            is_virtual: None,
            governor: Some("performance".into()),
            ..machine
        };
        assert_eq!(unknown.to_string(), "A, linux x86_64, 2 cores, governor performance; rustc 1.90.0");
        assert!(Machine::here().compiler.starts_with("rustc "));
    }
}
