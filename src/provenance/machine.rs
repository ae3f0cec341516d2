//! Description of the machine of a measurement, as far as the system reports it.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs;
use std::path::Path;

/// Properties of the machine that measured times depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MachineDescription {
    /// Name of the processor, and the platform.
    pub(crate) processor: String,
    /// Family, model and stepping of the processor, if reported.
    #[serde(default)]
    pub model: Option<String>,
    /// Number of processors available to the program.
    pub(crate) cores: usize,
    /// Clock of the first processor at the time of the query (MHz).
    pub clock: Option<f64>,
    /// Caches of the first processor, such as `L1d 32K`.
    pub(crate) caches: Vec<String>,
    /// Frequency governor; none if not reported, as in most virtual machines.
    pub(crate) governor: Option<String>,
    /// True in a virtual machine; none if not reported.
    pub(crate) is_virtual: Option<bool>,
    /// Compiler of this program, with flags beyond its profile.
    pub(crate) compiler: String,
}

impl MachineDescription {
    /// Describes this machine, from `/proc/cpuinfo` and `/sys/devices/system/cpu` on Linux. Unreported properties are left out.
    pub(crate) fn here() -> MachineDescription {
        #[expect(clippy::disallowed_methods, reason = "without this file the properties are left out")]
        let cpuinfo = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let field = |name: &str| {
            let value = |line: &str| Some(line.strip_prefix(name)?.split_once(':')?.1.trim().to_owned());
            cpuinfo.lines().find_map(value)
        };
        let first = Path::new("/sys/devices/system/cpu/cpu0");
        MachineDescription {
            processor: stripmine_physics::origin::host(),
            model: model(&field),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            clock: field("cpu MHz").and_then(|clock| clock.parse().ok()),
            caches: (0..8).filter_map(|index| cache(&first.join(format!("cache/index{index}")))).collect(),
            governor: file_word(&first.join("cpufreq/scaling_governor")),
            is_virtual: field("flags").map(|flags| flags.split(' ').any(|flag| flag == "hypervisor")),
            compiler: env!("STRIPMINE_COMPILER").to_owned(),
        }
    }
}

impl MachineDescription {
    /// Names and sizes (bytes) of the data caches.
    pub(crate) fn data_caches(&self) -> Vec<(String, f64)> {
        let cache = |text: &String| {
            let (name, size) = text.split_once(' ')?;
            let kibibytes: f64 = size.strip_suffix('K')?.parse().ok()?;
            Some((name.to_owned(), 1024.0 * kibibytes))
        };
        self.caches.iter().filter_map(cache).filter(|(name, _)| !name.ends_with('i')).collect()
    }

    /// Copy without the clock, which fluctuates on some machines.
    pub(crate) fn without_clock(&self) -> MachineDescription {
        MachineDescription { clock: None, ..self.clone() }
    }
}

impl fmt::Display for MachineDescription {
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

/// Family, model and stepping from `/proc/cpuinfo`.
fn model(field: &dyn Fn(&str) -> Option<String>) -> Option<String> {
    let [family, model, stepping] =
        [field("cpu family")?, field("model\t").or_else(|| field("model "))?, field("stepping")?];
    Some(format!("family {family} model {model} stepping {stepping}"))
}

/// Level, kind and size of a cache as the Linux kernel describes them.
fn cache(folder: &Path) -> Option<String> {
    let [level, kind, size] = ["level", "type", "size"].map(|name| file_word(&folder.join(name)));
    let kind = match kind?.as_str() {
        "Data" => "d",
        "Instruction" => "i",
        _ => "",
    };
    Some(format!("L{}{kind} {}", level?, size?))
}

fn file_word(path: &Path) -> Option<String> {
    fs::read_to_string(path).ok().map(|text| text.trim().to_owned()).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unreported_machine_properties_are_left_out() {
        let machine = MachineDescription {
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
        let unknown = MachineDescription {
            model: None,
            clock: None,
            caches: vec![],
            is_virtual: None,
            governor: Some("performance".into()),
            ..machine
        };
        assert_eq!(unknown.to_string(), "A, linux x86_64, 2 cores, governor performance; rustc 1.90.0");
        assert!(MachineDescription::here().compiler.starts_with("rustc "));
    }
}
