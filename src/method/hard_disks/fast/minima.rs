//! The smallest of many numbers that change one at a time: a tree of groups of eight, each known by its smallest.

/// Numbers of a group: a line of the cache.
const GROUP: usize = 8;

/// A group.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Group([f64; GROUP]);

impl Group {
    const NONE: Group = Group([f64::INFINITY; GROUP]);

    #[inline(always)]
    fn smallest(&self) -> f64 {
        let least = |a: f64, b: f64| if b < a { b } else { a };
        let [a, b, c, d, e, f, g, h] = self.0;
        least(least(least(a, b), least(c, d)), least(least(e, f), least(g, h)))
    }

    /// Its members that are a number, a bit each.
    #[inline(always)]
    fn members(&self, number: f64) -> u32 {
        let mut bits = 0;
        for member in 0..GROUP {
            bits |= u32::from(self.0[member] == number) << member;
        }
        bits
    }
}

/// The tree. Levels from the numbers up to the root.
#[derive(Clone, Debug)]
pub struct Minima {
    levels: Vec<Vec<Group>>,
}

impl Minima {
    /// Of `count` numbers, all infinite.
    pub fn new(count: usize) -> Minima {
        let mut levels = vec![vec![Group::NONE; count.div_ceil(GROUP).max(1)]];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            levels.push(vec![Group::NONE; last.len().div_ceil(GROUP)]);
        }
        Minima { levels }
    }

    /// The numbers, and infinite ones behind them.
    #[inline(always)]
    pub fn numbers(&self) -> &[f64] {
        let groups = &self.levels[0];
        // SAFETY: a group is eight numbers, as large and aligned more strictly.
        unsafe { std::slice::from_raw_parts(groups.as_ptr().cast::<f64>(), groups.len() * GROUP) }
    }

    /// The smallest number.
    #[inline(always)]
    pub fn smallest(&self) -> f64 {
        self.levels.last().map_or(f64::INFINITY, |root| root[0].smallest())
    }

    /// A number is another.
    #[inline(always)]
    pub fn set(&mut self, place: usize, number: f64) {
        let (mut place, mut number) = (place, number);
        for level in &mut self.levels {
            let group = &mut level[place / GROUP];
            let former = std::mem::replace(&mut group.0[place % GROUP], number);
            if former == number {
                return;
            }
            number = group.smallest();
            place /= GROUP;
        }
    }

    /// The places of a number, of the smallest or of one that there is not: the first, and whether there are more.
    #[inline(always)]
    pub fn first(&self, number: f64) -> (usize, bool) {
        let (mut place, mut more) = (0, false);
        for level in self.levels.iter().rev() {
            let members = level[place].members(number);
            more |= members & (members.wrapping_sub(1)) != 0;
            place = GROUP * place + members.trailing_zeros().min(GROUP as u32 - 1) as usize;
        }
        (place, more)
    }

    /// Hears of every place of a number.
    pub fn places(&self, number: f64, mut hear: impl FnMut(usize)) {
        self.below(self.levels.len() - 1, 0, number, &mut hear);
    }

    fn below(&self, level: usize, group: usize, number: f64, hear: &mut impl FnMut(usize)) {
        let mut members = self.levels[level][group].members(number);
        while members != 0 {
            let place = GROUP * group + members.trailing_zeros() as usize;
            match level {
                0 => hear(place),
                _ => self.below(level - 1, place, number, hear),
            }
            members &= members - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::noise::{Purpose, Stream};

    #[test]
    fn the_smallest_is_known_after_every_change() {
        let mut stream = Stream::new(7, Purpose::Test, 0);
        for count in [1usize, 2, 8, 9, 64, 65, 700] {
            let mut numbers = vec![f64::INFINITY; count];
            let mut tree = Minima::new(count);
            for _ in 0..600 {
                let changed = stream.random_range(0..count);
                numbers[changed] = stream.random_range(0..40) as f64;
                tree.set(changed, numbers[changed]);
                let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
                assert_eq!(tree.smallest(), least);
                let mut found = vec![];
                tree.places(least, |place| found.push(place));
                let expected: Vec<usize> = (0..count).filter(|&place| numbers[place] == least).collect();
                assert_eq!(found, expected);
                if least < f64::INFINITY {
                    assert_eq!(tree.first(least), (expected[0], expected.len() > 1));
                }
                assert_eq!(&tree.numbers()[..count], numbers);
            }
        }
    }
}
