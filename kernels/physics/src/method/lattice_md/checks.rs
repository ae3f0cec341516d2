//! Warnings of a run about its counts and its energy.

use super::GranularTotals;
use super::balance::EnergyBalance;
use crate::method::RunWarning;
use crate::number::{of_limit, significant};

/// Tolerated balance error relative to the energy that passed through. An error that grows evenly to it is 5 % in the mean over the second half of a
/// run, three quarters of its final value.
const BALANCED: f64 = 0.05 / 0.75;

/// Returns warnings about counts. Contacts deeper than `law.max_penetration` are only counted: every search finds them, and the run stops at
/// `law.stop_penetration`.
pub(super) fn counted(totals: &GranularTotals) -> Vec<RunWarning> {
    let mut warnings = Vec::new();
    let mut warn = |check, value: f64, limit, message| {
        warnings.push(RunWarning { check, value, limit, message });
    };
    if totals.long_steps > 0 {
        let message = format!(
            "{} times a disc moved so far in a step that contacts deeper than law.max_penetration may have been missed: \
             lower dt, or slow the discs",
            totals.long_steps
        );
        warn("long-steps", totals.long_steps as f64, 0.0, message);
    }
    if totals.shared_cells > 0 {
        let message = format!(
            "{} times a disc was in an occupied lattice cell and was kept beside the lattice: exact, but \
             slower with every such disc",
            totals.shared_cells
        );
        warn("shared-cells", totals.shared_cells as f64, 0.0, message);
    }
    warnings
}

/// Warns of energy created or lost by the integration; `passed` is the start energy plus the input from outside.
pub(super) fn energy(balance: &EnergyBalance, passed: f64) -> Option<RunWarning> {
    let off = balance.balance_error / passed;
    // NaN counts as unbalanced.
    let is_balanced = balance.balance_error == 0.0 || off.abs() <= BALANCED;
    (!is_balanced).then(|| {
        let [has, is_wrong] = if off < 0.0 { ["lost", "too little"] } else { ["created", "too much"] };
        let message = format!(
            "the integration has {has} {:.2} % of the energy that passed through, {} the limit {:.2} %, {} {is_wrong}: lower dt, \
             or choose another integrator",
            100.0 * off.abs(), of_limit(off.abs() / BALANCED), 100.0 * BALANCED, significant(balance.balance_error.abs(), 4));
        RunWarning { check: "energy-balance", value: off, limit: BALANCED, message }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_drift_is_warned_with_its_number() {
        let off = |balance_error: f64| {
            let balance = EnergyBalance { balance_error, ..EnergyBalance::default() };
            energy(&balance, 2.0).map(|warning| (warning.value, warning.message))
        };
        assert_eq!(off(0.099), None);
        let (value, message) = off(0.25).unwrap();
        assert!(value == 0.125 && message.contains("has created 12.50 %"), "{message}");
        // By hand: 0.125/(0.05/0.75) = 1.875.
        assert!(message.contains("passed through, 1.88 times the limit 6.67 %, 0.25 too much"), "{message}");
        assert!(off(-0.25).unwrap().1.contains("has lost 12.50 %"));
        assert!(off(f64::NAN).is_some());
        assert_eq!(energy(&EnergyBalance::default(), 0.0), None);
    }

    #[test]
    fn zero_counts_give_no_warning() {
        assert_eq!(counted(&GranularTotals::default()), []);
        let mut totals = GranularTotals::default();
        totals.long_steps = 3;
        let [warning] = counted(&totals).try_into().unwrap();
        assert!(warning.check == "long-steps" && warning.value == 3.0, "{warning:?}");
    }
}
