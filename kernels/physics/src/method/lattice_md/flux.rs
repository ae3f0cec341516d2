//! Grains that cross lines: net numbers and masses since the start.

use crate::domain::Domain;
use crate::method::pairwise::NameableDiscs;
use crate::particles::Particle;

/// Net number and mass of the grains that have crossed each line to its right since the start.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Flux {
    lines: Vec<FluxLine>,
    /// Number and mass for each line.
    pub(super) sums: Vec<[f64; 2]>,
    /// Positions of the grains after the last step, by their numbers in the scene (length).
    before: Vec<[f64; 2]>,
}

/// Line through which grains are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FluxLine {
    middle: [f64; 2],
    /// Unit vector along the line, and half its length.
    along: [f64; 2],
    half: f64,
}

/// Names of the sums of a line in checkpoints.
const SAVED: [&str; 2] = ["count", "mass"];

impl Flux {
    /// No crossings, for lines with these ends.
    pub(super) fn new(lines: &[[[f64; 2]; 2]], discs: &(impl NameableDiscs + ?Sized)) -> Flux {
        let line = |[a, b]: &[[f64; 2]; 2]| {
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            let length = (x * x + y * y).sqrt();
            let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            FluxLine { middle, along: [x / length, y / length], half: 0.5 * length }
        };
        let lines: Vec<FluxLine> = lines.iter().map(line).collect();
        let sums = vec![[0.0; 2]; lines.len()];
        let before = if lines.is_empty() { vec![] } else { positions(discs) };
        Flux { lines, sums, before }
    }

    /// Adds the crossings of the step that has just been finished.
    pub(super) fn add(
        &mut self,
        discs: &(impl NameableDiscs + ?Sized),
        grains: &[Particle],
        domain: &Domain,
    ) {
        if self.lines.is_empty() {
            return;
        }
        let now = positions(discs);
        for ((from, to), grain) in self.before.iter().zip(&now).zip(grains) {
            let step = domain.displacement(*from, *to);
            for (line, sums) in self.lines.iter().zip(&mut self.sums) {
                let way = line.crossing(domain.displacement(line.middle, *from), step);
                (sums[0], sums[1]) = (sums[0] + way, sums[1] + way * grain.mass);
            }
        }
        self.before = now;
    }

    /// All sums by name, for a checkpoint.
    pub(super) fn entries(&self) -> Vec<(String, f64)> {
        let each = self.sums.iter().zip(1..);
        let named = |(sums, number): (&[f64; 2], usize)| {
            SAVED.into_iter().zip(*sums).map(move |(name, sum)| (format!("flux.{number}.{name}"), sum))
        };
        each.flat_map(named).collect()
    }

    /// Restores the sums, found by name; the grains are where they were then.
    ///
    /// # Errors
    /// As `find`.
    pub(super) fn restore(
        &mut self,
        discs: &(impl NameableDiscs + ?Sized),
        find: impl Fn(&str) -> Result<f64, String>,
    ) -> Result<(), String> {
        for (sums, number) in self.sums.iter_mut().zip(1..) {
            for (sum, name) in sums.iter_mut().zip(SAVED) {
                *sum = find(&format!("flux.{number}.{name}"))?;
            }
        }
        if !self.lines.is_empty() {
            self.before = positions(discs);
        }
        Ok(())
    }
}

impl FluxLine {
    /// Direction in which a step (length) from a position relative to the middle crosses the line: 1 to its right, −1 to its left, 0 without a
    /// crossing.
    fn crossing(&self, from: [f64; 2], step: [f64; 2]) -> f64 {
        let [x, y] = self.along;
        let beside = |[u, v]: [f64; 2]| x * v - y * u;
        let (before, moved) = (beside(from), beside(step));
        let after = before + moved;
        if (before >= 0.0) == (after >= 0.0) {
            return 0.0;
        }
        let share = -before / moved;
        let at = [from[0] + share * step[0], from[1] + share * step[1]];
        let is_on_line = (at[0] * x + at[1] * y).abs() <= self.half;
        if is_on_line { -moved.signum() } else { 0.0 }
    }
}

/// Positions of the grains by their numbers in the scene (length).
fn positions(discs: &(impl NameableDiscs + ?Sized)) -> Vec<[f64; 2]> {
    let grains = discs.grains();
    let mut all = vec![[0.0; 2]; grains.len()];
    grains.for_each(|disc| all[discs.number(disc)] = discs.position(disc));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line along x: downwards is to its right. Steps beside its ends and steps that stop before it do not count.
    #[test]
    fn crossings_have_the_sign_of_their_direction() {
        let line = FluxLine { middle: [0.0; 2], along: [1.0, 0.0], half: 2.0 };
        assert_eq!(line.crossing([1.0, 0.5], [0.5, -1.0]), 1.0);
        assert_eq!(line.crossing([1.5, -0.5], [0.5, 1.0]), -1.0);
        assert_eq!(line.crossing([1.9, 0.5], [1.0, -1.0]), 0.0);
        assert_eq!(line.crossing([0.0, 0.5], [0.0, -0.4]), 0.0);
        // From the line itself a grain has left it to one side only.
        let up = line.crossing([0.0, -0.5], [0.0, 0.5]) + line.crossing([0.0, 0.0], [0.0, 0.5]);
        assert_eq!(up, -1.0);
    }
}
