//! Cache-line-aligned columns in huge pages.
//!
//! A general allocator makes timings irreproducible. It aligns an array to 16 bytes, so that vectors of 64 bytes may straddle two
//! cache lines. Large arrays all begin at a page boundary, so that they compete for the same few lines of a first-level cache.
//! And the physical pages decide which data collide in larger caches. Each effect can slow a loop by half, in one process and not
//! in the next: a copy of the predictor took 2.1 or 5.1 µs. So each column begins at a cache line of its own, and columns are
//! stored one behind the other in huge pages where the system has them.

use super::Element;
use memmap2::MmapMut;
use std::cell::RefCell;
use std::fmt::{self, Debug, Formatter};
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;
use std::sync::Arc;

/// Size of a cache line in bytes.
pub(crate) const LINE: usize = 64;
/// Period in bytes after which addresses map to the same line of a first-level cache.
pub(crate) const ALIKE: usize = 4096;
/// Lines between the beginnings of consecutive columns, modulo that period: an odd number, so that they spread over the whole
/// cache.
const APART: usize = 9;
/// Size of a huge page in bytes.
const LARGE: usize = 1 << 21;

/// Huge pages, initially zero.
struct Pages {
    /// Address of the first page.
    origin: NonNull<u8>,
    length: usize,
    /// Owns the memory.
    _bytes: PageOwner,
}

/// Owner of the memory of pages.
enum PageOwner {
    Mapped(MmapMut),
    /// From the allocator, the fallback if the system maps no more pages.
    Allocated(Vec<u8>),
}

impl PageOwner {
    fn holding(length: usize) -> PageOwner {
        let Ok(map) = MmapMut::map_anon(length) else { return PageOwner::Allocated(vec![0; length]) };
        #[cfg(target_os = "linux")]
        #[expect(clippy::let_underscore_must_use, reason = "small pages are a valid fallback")]
        let _ = map.advise(memmap2::Advice::HugePage);
        PageOwner::Mapped(map)
    }

    fn all(&mut self) -> &mut [u8] {
        match self {
            PageOwner::Mapped(map) => map,
            PageOwner::Allocated(bytes) => bytes,
        }
    }
}

// SAFETY: the memory belongs to no thread; columns decide who uses which part of it, and no two columns share any.
unsafe impl Send for Pages {}
// SAFETY: through a shared reference only `origin` and `length` are read, which never change.
unsafe impl Sync for Pages {}

impl Pages {
    /// Allocates pages for `bytes` bytes.
    #[inline]
    fn holding(bytes: usize) -> Arc<Pages> {
        let length = bytes.next_multiple_of(LARGE);
        // One page more, because the first may begin anywhere.
        let mut bytes = PageOwner::holding(length + LARGE);
        let skipped = bytes.all().as_ptr().align_offset(LARGE);
        let origin = NonNull::from(&mut bytes.all()[skipped..]).cast();
        Arc::new(Pages { origin, length, _bytes: bytes })
    }
}

thread_local! {
    /// Pages that short columns share, and the number of their bytes in use.
    static SHARED: RefCell<Option<(Arc<Pages>, usize)>> = const { RefCell::new(None) };
}

/// Allocates `bytes` bytes that begin at the cache line of the column with this number.
fn allocate_line(number: usize, bytes: usize) -> (Arc<Pages>, NonNull<u8>) {
    let line = number * APART * LINE % ALIKE;
    // The first address from `taken` on that maps to that line.
    let behind = |taken: usize| taken.next_multiple_of(ALIKE) + line;
    if bytes > LARGE / 4 {
        let pages = Pages::holding(behind(0) + bytes);
        // SAFETY: the pages hold that and more.
        let start = unsafe { pages.origin.add(behind(0)) };
        return (pages, start);
    }
    SHARED.with_borrow_mut(|shared| {
        let (pages, taken) = match shared.take() {
            Some((pages, taken)) if behind(taken) + bytes <= pages.length => (pages, taken),
            _ => (Pages::holding(LARGE), 0),
        };
        // SAFETY: `behind(taken) + bytes` is within the pages: checked above, and new ones are at least four times as long.
        let start = unsafe { pages.origin.add(behind(taken)) };
        *shared = Some((Arc::clone(&pages), behind(taken) + bytes));
        (pages, start)
    })
}

/// Elements stored contiguously from a cache line of their own.
pub struct AlignedColumn<X> {
    number: usize,
    start: NonNull<X>,
    length: usize,
    /// Pages of the elements; `None` without elements.
    _pages: Option<Arc<Pages>>,
}

// SAFETY: a column owns its elements, as a vector does.
unsafe impl<X: Send> Send for AlignedColumn<X> {}
// SAFETY: a shared column gives out shared references to its elements, and nothing else.
unsafe impl<X: Sync> Sync for AlignedColumn<X> {}

impl<X: Clone> AlignedColumn<X> {
    /// Stores `values`; columns with another `number` begin at other cache lines.
    #[inline]
    pub fn new(number: usize, values: impl IntoIterator<Item = X>) -> AlignedColumn<X> {
        AlignedColumn::from_vec(number, &values.into_iter().collect::<Vec<X>>())
    }

    /// Column with the same value `length` times.
    #[inline]
    pub fn filled(number: usize, value: X, length: usize) -> AlignedColumn<X> {
        AlignedColumn::filled_by(number, length, |_| value.clone())
    }

    #[inline]
    fn from_vec(number: usize, values: &[X]) -> AlignedColumn<X> {
        AlignedColumn::filled_by(number, values.len(), |at| values[at].clone())
    }

    #[inline]
    fn filled_by(number: usize, length: usize, value: impl Fn(usize) -> X) -> AlignedColumn<X> {
        const { assert!(align_of::<X>() <= LINE && !std::mem::needs_drop::<X>()) }
        if length == 0 {
            return AlignedColumn::default();
        }
        let (pages, start) = allocate_line(number, length * size_of::<X>());
        let start = start.cast::<X>();
        for at in 0..length {
            // SAFETY: `allocate_line` has allocated the bytes of `length` elements, from the beginning of a line, for this column alone.
            unsafe { start.add(at).write(value(at)) };
        }
        AlignedColumn { number, start, length, _pages: Some(pages) }
    }
}

/// Memory in bytes that a column of some bytes uses: a long one has huge pages to itself.
#[inline]
pub fn column_memory(bytes: f64) -> f64 {
    let large = LARGE as f64;
    if bytes > large / 4.0 { (bytes / large).ceil() * large } else { bytes }
}

impl<X: Element> AlignedColumn<X> {
    /// Column of zeros. No memory is touched yet: a page is placed near the thread that writes it first.
    #[inline]
    pub fn zeros(number: usize, length: usize) -> AlignedColumn<X> {
        if length == 0 {
            return AlignedColumn::default();
        }
        // Pages are zero until written, every part of them is allocated once, and zero bits are the number 0.
        let (pages, start) = allocate_line(number, length * size_of::<X>());
        AlignedColumn { number, start: start.cast(), length, _pages: Some(pages) }
    }
}

impl<X> AlignedColumn<X> {
    /// Number that selects the cache line.
    #[inline]
    pub fn number(&self) -> usize {
        self.number
    }

    /// Prefetches the first two cache lines of an element, or its only one. Does nothing if the element or the instruction does
    /// not exist.
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
    /// Empty column.
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
        // SAFETY: all elements were written, and they belong to this column alone.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.length) }
    }
}

impl<X> DerefMut for AlignedColumn<X> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [X] {
        // SAFETY: all `length` elements were written when the column was created, no other column has them, and this one is
        // borrowed exclusively.
        unsafe { std::slice::from_raw_parts_mut(self.start.as_ptr(), self.length) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_begin_at_distinct_cache_lines() {
        let rows: Vec<AlignedColumn<f32>> = (0..40)
            .map(|number| AlignedColumn::filled(number, number as f32, 100 + 20_000 * number))
            .collect();
        let mut lines: Vec<usize> = rows.iter().map(|row| row.as_ptr().addr() % ALIKE).collect();
        assert!(lines.iter().all(|at| at.is_multiple_of(LINE)));
        lines.sort_unstable();
        lines.dedup();
        assert_eq!(lines.len(), rows.len());
        // Columns do not overlap.
        for (number, row) in rows.iter().enumerate() {
            assert!(
                row.len() == 100 + 20_000 * number && row.iter().all(|&x| x == number as f32),
                "{number}"
            );
        }
    }

    #[test]
    fn columns_behave_as_vectors() {
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
    fn a_column_outlives_its_thread() {
        let row = std::thread::spawn(|| AlignedColumn::new(5, 0..1000_u32)).join();
        assert_eq!(row.map(|row| row.iter().sum::<u32>()).ok(), Some(499_500));
    }
}
