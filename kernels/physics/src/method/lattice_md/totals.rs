//! What a simulation counts and sums up from its start on.

/// Counts and sums since the start of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Grains in a contact deeper than the scene calls reasonable, summed over the steps.
    pub deep_disc_steps: u64,
    /// The deepest penetration of such a contact (a fraction of the sum of the radii).
    pub deepest: f64,
    pub(crate) deepest_step: u64,
    /// Discs in a lattice cell that was another disc's, summed over the steps; more than none only where such conflicts
    /// are resolved.
    pub shared_cells: u64,
    /// Discs that moved farther in a step than contacts can be seen, summed over the steps; more than none only where
    /// the scene lets them.
    pub long_steps: u64,
    /// Energy that contacts have turned into heat.
    pub dissipated: f64,
    /// Energy that moving walls have put in.
    pub wall_work: f64,
    /// What contacts dissipate at this moment (energy/time).
    power: f64,
    /// What moving walls put in at this moment (energy/time).
    wall_power: f64,
}

/// A count or a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Total {
    /// How many.
    Count(u64),
    /// How much.
    Sum(f64),
}

macro_rules! define_entries {
    ($($name:literal $kind:ident $field:ident,)*) => {
        impl Totals {
            /// All of them by name, for a checkpoint.
            pub fn entries(&self) -> Vec<(&'static str, Total)> {
                vec![$(($name, Total::$kind(self.$field))),*]
            }

            /// From what [`entries`](Self::entries) gave.
            ///
            /// # Errors
            /// The name of one that is missing, or is no count but a sum or the other way round.
            pub(crate) fn from_entries(find: impl Fn(&str) -> Option<Total>) -> Result<Totals, &'static str> {
                Ok(Totals {
                    $($field: match find($name) {
                        Some(Total::$kind(value)) => value,
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

impl Totals {
    /// That a number of steps of a number of discs can have come to them.
    ///
    /// # Errors
    /// A sentence that names the first that cannot be.
    pub(super) fn are_of(&self, steps: u64, discs: u64) -> Result<(), String> {
        // The start is looked at too.
        let most = (steps + 1).saturating_mul(discs);
        let is_right = |total: Total| match total {
            Total::Count(count) => count <= most,
            Total::Sum(sum) => sum.is_finite(),
        };
        match self.entries().into_iter().find(|(_, total)| !is_right(*total)) {
            None => Ok(()),
            Some((name, total)) => Err(format!(
                "the total {name} is {total:?}, which {steps} steps of {discs} discs do not come to"
            )),
        }
    }

    /// At the start, where contacts and walls have these powers (energy/time).
    pub(super) fn starting_with(power: f64, wall_power: f64) -> Totals {
        Totals { power, wall_power, ..Totals::default() }
    }

    /// A step of `dt` (time), at whose end contacts and walls have these powers (energy/time): by the trapezoidal rule.
    pub(super) fn add_work(&mut self, dt: f64, power: f64, wall_power: f64) {
        self.dissipated += 0.5 * dt * (self.power + power);
        self.wall_work += 0.5 * dt * (self.wall_power + wall_power);
        (self.power, self.wall_power) = (power, wall_power);
    }

    /// Deep contacts of a step: how many grains are in one, and the deepest penetration.
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
    fn totals_come_back_from_their_entries() {
        let totals = Totals {
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
        assert_eq!(Totals::from_entries(find), Ok(totals));
        assert_eq!(Totals::from_entries(|name| find(name).filter(|_| name != "power")), Err("power"));
        assert_eq!(Totals::from_entries(|_| Some(Total::Count(1))), Err("deep.deepest"));
    }
}
