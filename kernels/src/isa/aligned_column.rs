//! Elements in a row whose place in the caches is no matter of luck.
//!
//! A general allocator puts an array at some sixteenth byte, so that vectors of 64 bytes may lie across two lines; large
//! arrays all begin at a page's border, so that they fall upon the same few lines of a first-level cache; and which pages of
//! the memory they are made of decides what meets what in the larger ones. Each makes a loop half as fast again or not, in
//! one process and not in the next: a copy of the predictor took 2.1 or 5.1 µs. So rows begin at lines of their own, one
//! behind the other in large pages, as far as the system has some.

use super::Element;
use memmap2::MmapMut;
use std::cell::RefCell;
use std::fmt::{self, Debug, Formatter};
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;
use std::sync::Arc;

/// Bytes of a cache line.
pub(crate) const LINE: usize = 64;
/// Bytes after which addresses look alike to a first-level cache.
pub(crate) const ALIKE: usize = 4096;
/// Lines from where one row begins to where the next one does, addresses taken as such a cache sees them: an odd number, so
/// that they spread over all of it.
const APART: usize = 9;
/// Bytes of a large page.
const LARGE: usize = 1 << 21;

/// Large pages, zero at first.
struct Pages {
    /// Where the first of them begins.
    origin: NonNull<u8>,
    length: usize,
    /// Keeps them.
    _bytes: Bytes,
}

/// Bytes that are kept for pages.
enum Bytes {
    Mapped(MmapMut),
    /// Of the allocator, which has the last word where the system maps no more pages.
    Allocated(Vec<u8>),
}

impl Bytes {
    fn holding(length: usize) -> Bytes {
        let Ok(map) = MmapMut::map_anon(length) else { return Bytes::Allocated(vec![0; length]) };
        #[cfg(target_os = "linux")]
        #[expect(clippy::let_underscore_must_use, reason = "where there are no large pages, small ones do")]
        let _ = map.advise(memmap2::Advice::HugePage);
        Bytes::Mapped(map)
    }

    fn all(&mut self) -> &mut [u8] {
        match self {
            Bytes::Mapped(map) => map,
            Bytes::Allocated(bytes) => bytes,
        }
    }
}

// SAFETY: the memory belongs to no thread; who may use which part of it is the rows' affair, and no two rows share any.
unsafe impl Send for Pages {}
// SAFETY: through a shared reference only `origin` and `length` are read, which never change.
unsafe impl Sync for Pages {}

impl Pages {
    /// As many as hold `bytes` bytes.
    #[inline]
    fn holding(bytes: usize) -> Arc<Pages> {
        let length = bytes.next_multiple_of(LARGE);
        // One more, for the first may begin anywhere.
        let mut bytes = Bytes::holding(length + LARGE);
        let skipped = bytes.all().as_ptr().align_offset(LARGE);
        let origin = NonNull::from(&mut bytes.all()[skipped..]).cast();
        Arc::new(Pages { origin, length, _bytes: bytes })
    }
}

thread_local! {
    /// Pages that short rows share, and how many bytes of them are taken.
    static SHARED: RefCell<Option<(Arc<Pages>, usize)>> = const { RefCell::new(None) };
}

/// Room for `bytes` bytes that begins at the line of a row with this number.
fn room(number: usize, bytes: usize) -> (Arc<Pages>, NonNull<u8>) {
    let line = number * APART * LINE % ALIKE;
    // The first place from `taken` on that looks like that line.
    let behind = |taken: usize| taken.next_multiple_of(ALIKE) + line;
    if bytes > LARGE / 4 {
        let pages = Pages::holding(behind(0) + bytes);
        // SAFETY: they hold that and more.
        let start = unsafe { pages.origin.add(behind(0)) };
        return (pages, start);
    }
    SHARED.with_borrow_mut(|shared| {
        let (pages, taken) = match shared.take() {
            Some((pages, taken)) if behind(taken) + bytes <= pages.length => (pages, taken),
            _ => (Pages::holding(LARGE), 0),
        };
        // SAFETY: `behind(taken) + bytes` lies within: as asked above, and new ones are four times as long and more.
        let start = unsafe { pages.origin.add(behind(taken)) };
        *shared = Some((Arc::clone(&pages), behind(taken) + bytes));
        (pages, start)
    })
}

/// Elements in a row that begin at a line of their own.
pub struct AlignedColumn<X> {
    number: usize,
    start: NonNull<X>,
    length: usize,
    /// Where they lie; none without elements.
    _pages: Option<Arc<Pages>>,
}

// SAFETY: a row owns its elements, as a vector does.
unsafe impl<X: Send> Send for AlignedColumn<X> {}
// SAFETY: a shared row gives out shared references to its elements, and nothing else.
unsafe impl<X: Sync> Sync for AlignedColumn<X> {}

impl<X: Clone> AlignedColumn<X> {
    /// `values` behind each other; rows of another `number` begin at other lines.
    #[inline]
    pub fn new(number: usize, values: impl IntoIterator<Item = X>) -> AlignedColumn<X> {
        AlignedColumn::from_vec(number, &values.into_iter().collect::<Vec<X>>())
    }

    /// The same value `length` times.
    #[inline]
    pub fn filled(number: usize, value: X, length: usize) -> AlignedColumn<X> {
        AlignedColumn::written(number, length, |_| value.clone())
    }

    #[inline]
    fn from_vec(number: usize, values: &[X]) -> AlignedColumn<X> {
        AlignedColumn::written(number, values.len(), |at| values[at].clone())
    }

    #[inline]
    fn written(number: usize, length: usize, value: impl Fn(usize) -> X) -> AlignedColumn<X> {
        const { assert!(align_of::<X>() <= LINE && !std::mem::needs_drop::<X>()) }
        if length == 0 {
            return AlignedColumn::default();
        }
        let (pages, start) = room(number, length * size_of::<X>());
        let start = start.cast::<X>();
        for at in 0..length {
            // SAFETY: `room` has given `length` elements' bytes, at the beginning of a line, to this row alone.
            unsafe { start.add(at).write(value(at)) };
        }
        AlignedColumn { number, start, length, _pages: Some(pages) }
    }
}

/// Bytes of memory that a row of some bytes takes: a long one has large pages to itself.
#[inline]
pub fn taken(bytes: f64) -> f64 {
    let large = LARGE as f64;
    if bytes > large / 4.0 { (bytes / large).ceil() * large } else { bytes }
}

impl<X: Element> AlignedColumn<X> {
    /// Zeros, of which no memory is touched yet: a page becomes that of the thread that writes there first.
    #[inline]
    pub fn zeros(number: usize, length: usize) -> AlignedColumn<X> {
        if length == 0 {
            return AlignedColumn::default();
        }
        // Pages are zero until something is written, every part of them is given away once, and zero bits are the number 0.
        let (pages, start) = room(number, length * size_of::<X>());
        AlignedColumn { number, start: start.cast(), length, _pages: Some(pages) }
    }
}

impl<X> AlignedColumn<X> {
    /// By this its line is chosen.
    #[inline]
    pub fn number(&self) -> usize {
        self.number
    }

    /// Asks for the first two lines of an element, or its one, ahead of its use. Nothing happens where there is no such element, or no such instruction.
    #[inline(always)]
    pub fn prefetch(&self, at: usize) {
        #[cfg(target_arch = "x86_64")]
        if at < self.length {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            // SAFETY: the element exists, and every such processor has the instruction, which reads nothing.
            unsafe {
                let line = self.start.as_ptr().add(at).cast::<i8>();
                _mm_prefetch::<_MM_HINT_T0>(line);
                if size_of::<X>() > LINE {
                    _mm_prefetch::<_MM_HINT_T0>(line.wrapping_add(LINE));
                }
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = at;
    }
}

impl<X> Default for AlignedColumn<X> {
    /// None.
    #[inline]
    fn default() -> Self {
        AlignedColumn { number: 0, start: NonNull::dangling(), length: 0, _pages: None }
    }
}

impl<X: Clone> Clone for AlignedColumn<X> {
    #[inline]
    fn clone(&self) -> Self {
        AlignedColumn::from_vec(self.number, self)
    }
}

impl<X: Debug> Debug for AlignedColumn<X> {
    #[inline]
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl<X> Deref for AlignedColumn<X> {
    type Target = [X];

    #[inline]
    fn deref(&self) -> &[X] {
        // SAFETY: all of them were written, and they are this row's alone.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.length) }
    }
}

impl<X> DerefMut for AlignedColumn<X> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [X] {
        // SAFETY: all `length` elements were written when the row was made, no other row has them, and this one is borrowed
        // exclusively.
        unsafe { std::slice::from_raw_parts_mut(self.start.as_ptr(), self.length) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_begin_at_lines_of_their_own_wherever_memory_is() {
        let rows: Vec<AlignedColumn<f32>> = (0..40)
            .map(|number| AlignedColumn::filled(number, number as f32, 100 + 20_000 * number))
            .collect();
        let mut lines: Vec<usize> = rows.iter().map(|row| row.as_ptr().addr() % ALIKE).collect();
        assert!(lines.iter().all(|at| at.is_multiple_of(LINE)));
        lines.sort_unstable();
        lines.dedup();
        assert_eq!(lines.len(), rows.len());
        // None lies in another.
        for (number, row) in rows.iter().enumerate() {
            assert!(
                row.len() == 100 + 20_000 * number && row.iter().all(|&x| x == number as f32),
                "{number}"
            );
        }
    }

    #[test]
    fn rows_are_vectors_otherwise() {
        let mut row = AlignedColumn::new(3, 1_u16..=9);
        row[2] = 7;
        let copy = row.clone();
        row[0] = 5;
        drop(row);
        assert_eq!((&copy[..4], copy.len()), ([1, 2, 7, 4].as_slice(), 9));
        assert!(AlignedColumn::<u64>::default().is_empty() && AlignedColumn::new(1, [0.0; 0]).is_empty());
        assert_eq!(format!("{:?}", AlignedColumn::new(0, [1, 2])), "[1, 2]");
    }

    #[test]
    fn a_row_outlives_the_thread_that_laid_it_out() {
        let row = std::thread::spawn(|| AlignedColumn::new(5, 0..1000_u32)).join();
        assert_eq!(row.map(|row| row.iter().sum::<u32>()).ok(), Some(499_500));
    }
}
