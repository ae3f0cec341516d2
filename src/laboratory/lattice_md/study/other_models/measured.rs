//! Results of `tests/rivals/models.py`.

use crate::console::CommandFailure;
use crate::provenance::RepeatedMeasurement;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Results of the script, and their provenance.
const MODELS: &str = include_str!("../../../../study/rivals/measured/models/models.json");
const SOURCE: &str = include_str!("../../../../study/rivals/measured/models/provenance.json");

#[derive(Deserialize)]
pub(super) struct MeasuredModels {
    pub(super) llvm: String,
    pub(super) osaca: String,
    pub(super) occupancy: f64,
    /// Elements of a strip of the chained loops.
    pub(super) lanes: f64,
    pub(super) processor: ProcessorPeaks,
    pub(super) steps: Vec<PhaseTime>,
    pub(super) loops: Vec<LoopPrediction>,
    pub(super) sections: Vec<VectorSection>,
}

/// Measured limits of the processor.
#[derive(Deserialize)]
pub(super) struct ProcessorPeaks {
    pub(super) ghz: f64,
    /// Rate of sums and products of their own, and of fused ones (GFlop/s).
    pub(super) separate_gflops: f64,
    pub(super) fused_gflops: f64,
    pub(super) levels: Vec<MemoryLevel>,
}

/// Bandwidth of the arrays of a footprint.
#[derive(Deserialize)]
pub(super) struct MemoryLevel {
    pub(super) name: String,
    pub(super) footprint: f64,
    pub(super) gb_s: f64,
}

/// Time of a phase, measured and predicted by our host model (ns).
#[derive(Deserialize)]
pub(super) struct PhaseTime {
    pub(super) particles: usize,
    pub(super) execution: String,
    pub(super) phase: String,
    pub(super) host: f64,
    pub(super) measured: f64,
}

/// Clock periods of a strip of a chained loop by llvm-mca and OSACA, and the instructions that they do not know.
#[derive(Deserialize)]
pub(super) struct LoopPrediction {
    pub(super) part: String,
    pub(super) kernel: String,
    pub(super) instructions: usize,
    pub(super) branches: usize,
    pub(super) mca: f64,
    pub(super) mca_unknown: BTreeMap<String, u64>,
    pub(super) osaca: f64,
    pub(super) osaca_unknown: BTreeMap<String, u64>,
}

/// Clock periods of a section of the RISC-V text by llvm-mca.
#[derive(Deserialize)]
pub(super) struct VectorSection {
    pub(super) program: String,
    pub(super) section: String,
    pub(super) mca: f64,
}

/// Reads the results that are shipped.
///
/// # Errors
/// Fails if a file is not in the format of the script.
pub(super) fn measured_models() -> Result<(MeasuredModels, RepeatedMeasurement), CommandFailure> {
    let wrong = |cause: serde_json::Error| CommandFailure::writing("results of models.py")(cause.into());
    Ok((serde_json::from_str(MODELS).map_err(wrong)?, serde_json::from_str(SOURCE).map_err(wrong)?))
}
