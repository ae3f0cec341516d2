//! Model of a host, and its predictions for programs.

use super::costs::{LaneCosts, StepArrays, charges};
use super::out_of_range::OutOfRange;
use super::rates::{Amounts, PhaseRates, phase};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_physics::number::{count_with_noun, significant};

/// Conditions of a measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MeasurementConditions {
    /// State of the machine: quiet, busy, noisy, changing, or unknown.
    pub state: String,
    /// Load average of the last minute before the start; none where the system does not report it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<f64>,
    /// Duration of the measurement (s).
    pub seconds: f64,
    /// Median, over all points, of the relative half-range of the middle half of the samples; none where most points have too few.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<f64>,
    /// Median, over all points, of the difference between the two halves of the measurement; none where most points have too few.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) disagreement: Option<f64>,
    /// Shortest vectors.
    pub(crate) shortest: usize,
    /// Longest vectors.
    pub(crate) longest: usize,
    /// Median deviation of the programs from the prices fitted to them.
    pub(crate) residual: f64,
}

impl MeasurementConditions {
    /// Largest spread of a steady machine: beyond it the samples are noisy, or the halves of the measurement differ.
    const UNSTEADY: f64 = 0.05;

    /// State of a machine with some cores and a load, from the spread of the samples and the difference between the halves of the measurement.
    pub(crate) fn state_of(
        [spread, disagreement]: [Option<f64>; 2],
        load: Option<f64>,
        cores: usize,
    ) -> String {
        // One core is free for the measurement, or half of the only one.
        let bearable = (cores as f64 - 1.0).max(0.5);
        let busy = load.filter(|load| *load > bearable).map(|load| {
            let cores = count_with_noun(cores, "core", "cores");
            format!("busy: the load average was {} on {cores} when it began", significant(load, 3))
        });
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let seen = match (spread, disagreement) {
            (Some(spread), Some(apart)) => {
                let noisy = (spread > MeasurementConditions::UNSTEADY)
                    .then(|| format!("noisy: half of the samples lie within {}", percent(spread)));
                let changing = (apart > MeasurementConditions::UNSTEADY)
                    .then(|| format!("changing: the halves of the measurement differ by {}", percent(apart)));
                noisy.into_iter().chain(changing).collect()
            }
            _ => vec![
                "in an unknown state: too few samples of each program to measure their scatter".to_owned(),
            ],
        };
        let said: Vec<String> = busy.into_iter().chain(seen).collect();
        if said.is_empty() { "quiet".to_owned() } else { said.join("; ") }
    }

    pub(crate) fn was_quiet(&self) -> bool {
        self.state == "quiet"
    }
}

/// Model of a host.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HostModel {
    /// Version of the file format.
    pub(crate) format: u32,
    /// Processor and platform.
    pub title: String,
    /// Instruction set of the measurement.
    pub(crate) instruction_set: String,
    /// Footprints at which a byte has a price, rising; prices between them are interpolated by the logarithm (bytes).
    pub(crate) footprints: Vec<f64>,
    /// Conditions of the measurement.
    pub(crate) measured: MeasurementConditions,
    /// Prices of programs by the element type of the lanes.
    pub programs: BTreeMap<String, LaneCosts>,
    /// Fewest and most discs of the steps that rates were fitted to.
    pub discs: [f64; 2],
    /// Rates of work whose amount depends on the data, by method.
    pub rates: BTreeMap<String, PhaseRates>,
}

impl HostModel {
    /// Describes the difference from another host; none for the same processor with the same instructions.
    pub(crate) fn differs_from(&self, title: &str, instruction_set: &str) -> Option<String> {
        ((&*self.title, &*self.instruction_set) != (title, instruction_set)).then(|| {
            format!(
                "the model is of {} by {}, but this host is {title} and measures by {instruction_set}",
                self.title, self.instruction_set
            )
        })
    }

    /// Checks that vectors of `n` elements are within the measured range.
    ///
    /// # Errors
    /// [`OutOfRange::Length`] if they are not.
    pub(crate) fn check_length(&self, n: usize) -> Result<(), OutOfRange> {
        let MeasurementConditions { shortest, longest, .. } = self.measured;
        if n < shortest || n > longest {
            return Err(OutOfRange::Length { n, shortest, longest });
        }
        Ok(())
    }

    /// Nanoseconds of a phase of a method whose work depends on the data.
    ///
    /// # Errors
    /// [`OutOfRange`] where the measurements do not cover it.
    pub(crate) fn rated(
        &self,
        (method, name, precision): (&str, &str, &str),
        amounts: &Amounts,
    ) -> Result<f64, OutOfRange> {
        let ([fewest, most], discs) = (self.discs, amounts.discs);
        if !(fewest..=most).contains(&discs) {
            return Err(OutOfRange::Discs { discs, fewest, most });
        }
        let unmeasured = || OutOfRange::NotMeasured(format!("method {method}"));
        phase(self.rates.get(method).ok_or_else(unmeasured)?, name, precision, amounts)
    }

    /// Nanoseconds of a run of a program over `n` elements, among the arrays of a step.
    ///
    /// # Errors
    /// [`OutOfRange`] where the measurements do not cover it.
    pub(crate) fn program(
        &self,
        outlines: &Outlines,
        n: usize,
        execution: Execution,
        around: &StepArrays,
    ) -> Result<f64, OutOfRange> {
        if n == 0 {
            return Ok(0.0);
        }
        self.check_length(n)?;
        let unmeasured = || OutOfRange::NotMeasured(format!("precision {}", outlines.lane));
        let of = self.programs.get(outlines.lane).ok_or_else(unmeasured)?;
        let costs = if execution == Execution::Chained { &of.chained } else { &of.interpreted };
        let shape = (of.register_bytes, of.lanes);
        Ok(costs.total(&charges(outlines, (n, execution), shape, around, &self.footprints)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::host::ExecutionPrices;
    use stripmine_kernels::backend::tape::{ArrayReference, Outline, VectorLocation};
    use stripmine_kernels::isa::{Array, Op};

    /// A host on which a pass takes 10 ns to start and 0.5 ns per element, a run 100 ns, a loop 7 ns, and a byte 0.25 or 0.125 ns.
    fn host() -> HostModel {
        let of = LaneCosts {
            register_bytes: [8.0, 1.0, 4.0],
            lanes: 1,
            interpreted: ExecutionPrices::of(&[100.0, 10.0, 0.5, 0.0, 0.25]),
            chained: ExecutionPrices::of(&[7.0, 0.0, 0.375, 0.0, 0.125]),
        };
        HostModel {
            measured: MeasurementConditions {
                shortest: 8,
                longest: 1000,
                ..MeasurementConditions::default()
            },
            footprints: vec![64.0],
            programs: BTreeMap::from([("f64".to_owned(), of)]),
            ..HostModel::default()
        }
    }

    /// `count` passes that read one array.
    fn sums(count: usize) -> Outlines {
        let x = VectorLocation::Memory(ArrayReference { array: Array::X, element: "f64", shift: 0 });
        let pass = Outline { op: Op::Add, converts: false, reads: vec![x], writes: None };
        let all = vec![pass; count];
        Outlines { lane: "f64", instructions: all.clone(), passes: all, registers: [0; 3] }
    }

    /// By hand: two passes over 100 elements at once, in strips of 32 with 4 in the last, and as a loop.
    #[test]
    fn program_time_sums_starts_operations_and_bytes() {
        let around = StepArrays::of_step(&[(&sums(1), 100)]);
        let ns = |execution| host().program(&sums(2), 100, execution, &around);
        let bytes = 0.25 * 2.0 * 800.0;
        assert_eq!(ns(Execution::Eager), Ok(100.0 + 2.0 * (10.0 + 50.0) + bytes));
        assert_eq!(ns(Execution::Strip(32)), Ok(100.0 + 2.0 * (4.0 * 10.0 + 50.0) + bytes));
        assert_eq!(ns(Execution::Chained), Ok(7.0 + 100.0 * 2.0 * 0.375 + 0.125 * 800.0));
        assert_eq!(host().program(&sums(2), 0, Execution::Eager, &around), Ok(0.0));
        let beyond = host().program(&sums(2), 1001, Execution::Eager, &around);
        assert!(matches!(beyond, Err(OutOfRange::Length { n: 1001, .. })));
        let beyond = host().rated(("fast", "index", "f64"), &Amounts { discs: 9.0, ..Amounts::default() });
        assert_eq!(beyond, Err(OutOfRange::Discs { discs: 9.0, fewest: 0.0, most: 0.0 }));
    }

    /// A single sample has no spread, whatever the load; a load above the free cores means that the machine is not quiet.
    #[test]
    fn machine_state_follows_from_the_measurements() {
        let state =
            |seen: [Option<f64>; 2], load: Option<f64>| MeasurementConditions::state_of(seen, load, 2);
        for (seen, load, begins, has) in [
            ([Some(0.01), Some(0.01)], Some(0.3), "quiet", ""),
            ([Some(0.01), Some(0.01)], None, "quiet", ""),
            ([None, None], Some(0.0), "in an unknown state", "too few samples"),
            ([None, Some(0.0)], None, "in an unknown state", "too few samples"),
            ([Some(0.01), Some(0.01)], Some(19.0), "busy: the load average was 19 on 2 cores", ""),
            ([None, None], Some(19.0), "busy", "unknown state"),
            ([Some(0.2), Some(0.01)], Some(0.5), "noisy", "20 %"),
            ([Some(0.01), Some(0.14)], Some(0.5), "changing", "14 %"),
            (
                [Some(0.2), Some(0.14)],
                Some(1.5),
                "busy",
                "noisy: half of the samples lie within 20 %; changing",
            ),
        ] {
            let said = state(seen, load);
            assert!(said.starts_with(begins) && said.contains(has), "{seen:?} {load:?}: {said}");
        }
    }

    #[test]
    fn model_of_another_host_is_reported() {
        let model = HostModel {
            title: "A CPU".to_owned(),
            instruction_set: "avx2".to_owned(),
            ..HostModel::default()
        };
        assert_eq!(model.differs_from("A CPU", "avx2"), None);
        for (title, set) in [("Another CPU", "avx2"), ("A CPU", "avx512")] {
            let said = model.differs_from(title, set).unwrap();
            assert!(["A CPU by avx2", title, set].iter().all(|word| said.contains(word)), "{said}");
        }
    }
}
