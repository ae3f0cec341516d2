//! Counts and sums of a simulation since its start.

/// Counts and sums since the start of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GranularTotals {
    /// Grains in a contact deeper than `law.max_penetration`, summed over the steps.
    pub deep_disc_steps: u64,
    /// Deepest penetration of such a contact (a fraction of the sum of the radii).
    pub deepest: f64,
    pub(crate) deepest_step: u64,
    /// Discs in an occupied lattice cell, summed over the steps; zero unless such conflicts are resolved.
    pub shared_cells: u64,
    /// Discs that moved so far in a step that contacts may be missed, summed over the steps; zero unless the scene allows them.
    pub long_steps: u64,
    /// Energy dissipated in contacts.
    pub dissipated: f64,
    /// Work of moving walls.
    pub wall_work: f64,
    /// Power dissipated in contacts now (energy/time).
    power: f64,
    /// Power of moving walls now (energy/time).
    wall_power: f64,
}

/// Count or sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TotalEntry {
    /// Number of occurrences.
    Count(u64),
    /// Accumulated amount.
    Sum(f64),
}

macro_rules! define_entries {
    ($($name:literal $kind:ident $field:ident,)*) => {
        impl GranularTotals {
            /// Returns all entries by name, for a checkpoint.
            pub fn entries(&self) -> Vec<(&'static str, TotalEntry)> {
                vec![$(($name, TotalEntry::$kind(self.$field))),*]
            }

            /// Restores totals from what [`entries`](Self::entries) returned.
            ///
            /// # Errors
            /// Returns the name of an entry that is missing or has the wrong kind.
            pub(crate) fn from_entries(find: impl Fn(&str) -> Option<TotalEntry>) -> Result<GranularTotals, &'static str> {
                Ok(GranularTotals {
                    $($field: match find($name) {
                        Some(TotalEntry::$kind(value)) => value,
                        _ => return Err($name),
                    },)*
                })
            }
        }
    };
}

define_entries! {
    "deep.disc_steps" Count deep_disc_steps,
    "deep.deepest" Sum deepest,
    "deep.step" Count deepest_step,
    "deep.shared_cells" Count shared_cells,
    "long_steps" Count long_steps,
    "dissipated" Sum dissipated,
    "wall_work" Sum wall_work,
    "power" Sum power,
    "wall_power" Sum wall_power,
}

impl GranularTotals {
    /// Checks that these totals are possible after a number of steps of a number of discs.
    ///
    /// # Errors
    /// Names the first impossible entry.
    pub(super) fn check_plausible(&self, steps: u64, discs: u64) -> Result<(), String> {
        // The start is counted too.
        let most = (steps + 1).saturating_mul(discs);
        let is_right = |total: TotalEntry| match total {
            TotalEntry::Count(count) => count <= most,
            TotalEntry::Sum(sum) => sum.is_finite(),
        };
        match self.entries().into_iter().find(|(_, total)| !is_right(*total)) {
            None => Ok(()),
            Some((name, total)) => Err(format!(
                "the total {name} is {total:?}, which {steps} steps of {discs} discs cannot reach"
            )),
        }
    }

    /// Totals at the start, where contacts and walls have these powers (energy/time).
    pub(super) fn starting_with(power: f64, wall_power: f64) -> GranularTotals {
        GranularTotals { power, wall_power, ..GranularTotals::default() }
    }

    /// These totals where contacts and walls have other powers now (energy/time).
    pub(super) fn with_powers(self, power: f64, wall_power: f64) -> GranularTotals {
        GranularTotals { power, wall_power, ..self }
    }

    /// Adds the work of a step of `dt` (time) by the trapezoidal rule; the powers are those at its end (energy/time).
    pub(super) fn add_work(&mut self, dt: f64, power: f64, wall_power: f64) {
        self.dissipated += 0.5 * dt * (self.power + power);
        self.wall_work += 0.5 * dt * (self.wall_power + wall_power);
        (self.power, self.wall_power) = (power, wall_power);
    }

    /// Adds the deep contacts of a step: the number of grains in them and the deepest penetration.
    pub(super) fn add_deep(&mut self, step: u64, grains: u64, penetration: f64) {
        self.deep_disc_steps += grains;
        if penetration > self.deepest {
            self.deepest = penetration;
            self.deepest_step = step;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_round_trip_through_entries() {
        let totals = GranularTotals {
            deep_disc_steps: 1,
            deepest: 0.25,
            deepest_step: 3,
            shared_cells: 4,
            long_steps: 5,
            dissipated: 6.5,
            wall_work: -7.5,
            power: 8.5,
            wall_power: -9.5,
        };
        let entries = totals.entries();
        let find = |name: &str| entries.iter().find(|(known, _)| *known == name).map(|(_, total)| *total);
        assert_eq!(GranularTotals::from_entries(find), Ok(totals));
        assert_eq!(GranularTotals::from_entries(|name| find(name).filter(|_| name != "power")), Err("power"));
        assert_eq!(GranularTotals::from_entries(|_| Some(TotalEntry::Count(1))), Err("deep.deepest"));
    }
}
