//! Arrays that a kernel accesses, with the range of shifts.

use super::slot::Array;

/// Use of one array by a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// The array.
    pub array: Array,
    /// Name of its element type.
    pub element: &'static str,
    /// Lowest shift of a strided access.
    pub lowest: isize,
    /// Highest shift of a strided access.
    pub highest: isize,
    /// True if it is accessed at unit stride.
    pub(crate) strided: bool,
    /// True if it is accessed through an index vector, which is checked element by element.
    pub indexed: bool,
    /// True if it is written.
    pub writes: bool,
}

/// Everything that a kernel accesses: recorded by tracing it once, checked before it runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Footprint(Vec<Access>);

impl Footprint {
    /// Accesses, one per array and element type, in order of first use.
    pub(crate) fn accesses(&self) -> &[Access] {
        &self.0
    }

    /// True if elements are independent: arrays that are written are accessed only at the own element, so that parts of the
    /// elements may run concurrently.
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
