//! Vector registers of the emitted code: each holds a register of the tape, or is free. The one read last is spilled if none is free.

/// Uses of the registers of a file of the tape, by instruction.
#[derive(Clone, Debug, Default)]
pub(super) struct Uses(Vec<Vec<(usize, bool)>>);

impl Uses {
    /// Uses of a number of registers.
    pub(super) fn of(registers: usize) -> Uses {
        Uses(vec![vec![]; registers])
    }

    /// Records that an instruction reads or writes a register; reads of an instruction come before its write.
    pub(super) fn record(&mut self, register: usize, instruction: usize, reads: bool) {
        self.0[register].push((instruction, reads));
    }

    /// Next instruction after the given one that reads the value now in a register; none if it is overwritten or never read.
    fn next_read(&self, register: usize, after: usize) -> Option<usize> {
        let (at, reads) = self.0[register].iter().find(|(at, _)| *at > after)?;
        reads.then_some(*at)
    }
}

/// Move between a register and its place in memory: true to store, the register of the tape, and the group.
pub(super) type SpillMove = (bool, usize, usize);

/// Groups of vector registers for a file of the tape.
#[derive(Clone, Debug)]
pub(super) struct RegisterPool {
    uses: Uses,
    /// Register of the tape in each group, and true if the running instruction needs the group.
    groups: Vec<(Option<usize>, bool)>,
    /// Group of each register of the tape, and true if its place in memory has another value.
    homes: Vec<(Option<usize>, bool)>,
}

impl RegisterPool {
    pub(super) fn of(uses: Uses, groups: usize) -> RegisterPool {
        let homes = vec![(None, false); uses.0.len()];
        RegisterPool { uses, groups: vec![(None, false); groups], homes }
    }

    /// Takes a group for the running instruction, the preferred one if it is free.
    fn take(&mut self, preferred: usize, now: usize, spills: &mut Vec<SpillMove>) -> Option<usize> {
        let is_free = |group: &usize| self.groups[*group] == (None, false);
        let all = 0..self.groups.len();
        let free = Some(preferred % self.groups.len()).filter(is_free).or_else(|| all.clone().find(is_free));
        let group = free.or_else(|| {
            let candidates = all.filter(|&group| !self.groups[group].1);
            candidates.max_by_key(|&group| {
                let home = self.groups[group].0;
                home.map_or(usize::MAX, |home| self.uses.next_read(home, now).unwrap_or(usize::MAX))
            })
        })?;
        if let Some(home) = self.groups[group].0 {
            if self.homes[home].1 && self.uses.next_read(home, now).is_some() {
                spills.push((true, home, group));
            }
            self.homes[home] = (None, false);
        }
        self.groups[group] = (None, true);
        Some(group)
    }

    /// Group of a register that the instruction reads; loads it if it was spilled.
    pub(super) fn read(&mut self, home: usize, now: usize, spills: &mut Vec<SpillMove>) -> Option<usize> {
        let group = match self.homes[home].0 {
            Some(group) => group,
            None => {
                let group = self.take(home, now, spills)?;
                spills.push((false, home, group));
                self.homes[home] = (Some(group), false);
                group
            }
        };
        self.groups[group] = (Some(home), true);
        Some(group)
    }

    /// Group for a temporary value of the instruction.
    pub(super) fn temporary(&mut self, now: usize, spills: &mut Vec<SpillMove>) -> Option<usize> {
        let last = self.groups.len() - 1;
        self.take(last, now, spills)
    }

    /// Group for the result of the instruction, which is bound by [`bind`](Self::bind).
    pub(super) fn result(&mut self, home: usize, now: usize, spills: &mut Vec<SpillMove>) -> Option<usize> {
        self.take(home, now, spills)
    }

    /// Keeps an operand of the running instruction in its group, if it is in one.
    pub(super) fn keep(&mut self, home: usize) {
        if let Some(group) = self.homes[home].0 {
            self.groups[group].1 = true;
        }
    }

    /// Ends the use of a group by the instruction; frees it if its value is not read later, or is overwritten by the instruction.
    pub(super) fn release(&mut self, group: usize, now: usize, overwritten: Option<usize>) {
        let is_read = |home: &usize| overwritten != Some(*home) && self.uses.next_read(*home, now).is_some();
        let home = self.groups[group].0.filter(is_read);
        if let (Some(dead), None) = (self.groups[group].0, home) {
            self.homes[dead] = (None, false);
        }
        self.groups[group] = (home, false);
    }

    /// Binds the result of the instruction to its register of the tape.
    pub(super) fn bind(&mut self, home: usize, group: usize, now: usize) {
        if let Some(old) = self.homes[home].0.filter(|old| *old != group) {
            self.groups[old] = (None, false);
        }
        self.homes[home] = (Some(group), true);
        self.groups[group] = (Some(home), false);
        // A result that nobody reads frees its group.
        self.release(group, now, None);
    }
}
