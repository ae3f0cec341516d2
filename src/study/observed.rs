//! Quantities that studies observe: indices of the quantities that a method names in its trials, looked up once.

use stripmine_physics::method::observed::{UnknownName, find};
use stripmine_physics::method::{ObservedQuantity, Trials};

/// A quantity that has a mean in a run.
#[derive(Debug)]
pub(crate) struct WatchedQuantity {
    pub name: &'static str,
    /// Index among the observed quantities.
    pub place: usize,
    /// True if it fluctuates with single contacts, so that its mean is meaningful over independent seeds only.
    pub(crate) fluctuates: bool,
    /// True if it is a velocity, whose mean is compared with the speeds.
    pub(crate) is_velocity: bool,
}

/// Indices of the terms of the energy balance.
#[derive(Debug)]
pub(crate) struct BalanceIndices {
    error: usize,
    energies: Vec<usize>,
    inputs: Vec<usize>,
}

impl BalanceIndices {
    /// Error of the balance (energy).
    pub(crate) fn error(&self, values: &[f64]) -> f64 {
        values[self.error]
    }

    /// Sum of the magnitudes of the energies (energy).
    pub(crate) fn energies(&self, values: &[f64]) -> f64 {
        self.energies.iter().map(|&place| values[place].abs()).sum()
    }

    /// Sum of the energies (energy).
    pub(crate) fn energy(&self, values: &[f64]) -> f64 {
        self.energies.iter().map(|&place| values[place]).sum()
    }

    /// Sum of the magnitudes of external work (energy).
    pub(crate) fn inputs(&self, values: &[f64]) -> f64 {
        self.inputs.iter().map(|&place| values[place].abs()).sum()
    }
}

/// Quantities that studies observe of a scene.
#[derive(Debug)]
pub(crate) struct StudyQuantities {
    /// Quantities that have a mean in a run.
    pub(crate) means: Vec<WatchedQuantity>,
    /// Energy balance, where the method observes one.
    pub balance: Option<BalanceIndices>,
}

impl StudyQuantities {
    /// Looks up the quantities that the trials of a method name.
    pub(crate) fn of(
        trials: &Trials,
        quantities: &[ObservedQuantity],
    ) -> Result<StudyQuantities, UnknownName> {
        let places = |names: &[&str]| -> Result<Vec<usize>, UnknownName> {
            names.iter().map(|name| find(quantities, name)).collect()
        };
        let mean = |&name: &&'static str| {
            let place = find(quantities, name)?;
            let fluctuates = trials.fluctuating.contains(&name);
            let is_velocity = quantities[place].unit == "length/time";
            Ok(WatchedQuantity { name, place, fluctuates, is_velocity })
        };
        let stranger = trials.fluctuating.iter().find(|name| !trials.observables.contains(name));
        if let Some(name) = stranger {
            let known = trials.observables.iter().copied();
            return Err(UnknownName::new("quantity that has a mean in a run", name, known));
        }
        let balance = trials.balance.map(|balance| {
            let error = find(quantities, balance.error)?;
            Ok(BalanceIndices { error, energies: places(balance.energies)?, inputs: places(balance.inputs)? })
        });
        let means = trials.observables.iter().map(mean).collect::<Result<_, UnknownName>>()?;
        Ok(StudyQuantities { means, balance: balance.transpose()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::{EnergyBalanceNames, METHODS};

    #[test]
    fn trials_naming_unobserved_quantities_are_refused() {
        for method in METHODS {
            let Some(trials) = method.trials else { continue };
            let observed = StudyQuantities::of(trials, method.quantities).unwrap();
            assert_eq!(observed.means.len(), trials.observables.len());
            let wrong: [fn(Trials) -> Trials; 4] = [
                |trials| Trials { observables: &["temprature"], fluctuating: &[], ..trials },
                |trials| Trials { fluctuating: &["temprature"], ..trials },
                |trials| {
                    let balance = EnergyBalanceNames { error: "temprature", energies: &[], inputs: &[] };
                    Trials { balance: Some(balance), ..trials }
                },
                |trials| {
                    let balance =
                        EnergyBalanceNames { error: "time", energies: &["temprature"], inputs: &[] };
                    Trials { balance: Some(balance), ..trials }
                },
            ];
            for wrong in wrong {
                let error = StudyQuantities::of(&wrong(trials.clone()), method.quantities).unwrap_err();
                assert_eq!(error.name, "temprature");
                assert!(!error.known.is_empty(), "{error}");
            }
        }
    }
}
