//! Which arrays a program touches, and how far from the own place.

use super::slot::Array;

/// How a program uses one array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// The array.
    pub array: Array,
    /// Name of its element type.
    pub element: &'static str,
    /// Lowest shift at which a strided access meets it.
    pub lowest: isize,
    /// Highest shift at which a strided access meets it.
    pub highest: isize,
    /// Whether it is met at unit stride.
    pub(crate) strided: bool,
    /// Whether it is met through an index vector, which is checked element by element.
    pub indexed: bool,
    /// Whether it is written.
    pub writes: bool,
}

/// Everything a program touches: found by tracing its text once, checked before it runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Footprint(Vec<Access>);

impl Footprint {
    /// One entry an array and element type, in order of first use.
    pub(crate) fn accesses(&self) -> &[Access] {
        &self.0
    }

    /// Whether elements are independent: what is written is met only at the own place, so that parts of the elements may
    /// run at once.
    pub(crate) fn is_elementwise(&self) -> bool {
        self.0
            .iter()
            .filter(|access| access.writes)
            .all(|access| access.strided && !access.indexed && (access.lowest, access.highest) == (0, 0))
    }

    #[expect(clippy::expect_used, reason = "an element was pushed the line before")]
    pub(crate) fn record(&mut self, array: Array, element: &'static str, shift: Option<isize>, writes: bool) {
        let found = self.0.iter_mut().find(|access| access.array == array && access.element == element);
        let access = match found {
            Some(access) => access,
            None => {
                self.0.push(Access {
                    array,
                    element,
                    lowest: 0,
                    highest: 0,
                    strided: false,
                    indexed: false,
                    writes: false,
                });
                self.0.last_mut().expect("just pushed")
            }
        };
        access.writes |= writes;
        access.indexed |= shift.is_none();
        if let Some(shift) = shift {
            access.strided = true;
            access.lowest = access.lowest.min(shift);
            access.highest = access.highest.max(shift);
        }
    }
}
