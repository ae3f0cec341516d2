//! Prefetching for the next events: with many discs, most of the data is not in the caches near a core.

use super::{Fast, RENEWAL};

/// Number of discs beyond which prefetching pays off, because they exceed the caches next to a core.
pub(super) const OUT_OF_REACH: usize = 6_000;
/// Events ahead at which to prefetch a disc and its list, the discs of the list, and those around its partner.
const AHEAD: [usize; 3] = [40, 24, 12];

impl Fast {
    /// Prefetches the data of the next events: first the cache lines of their discs, then those of the discs around them.
    #[inline(always)]
    pub(super) fn prefetch_next_events(&self) {
        let Fast { discs, lists, queue, partners, .. } = self;
        if let Some((_, disc)) = queue.upcoming(AHEAD[0]) {
            let disc = disc as usize;
            discs.prefetch(disc);
            partners.prefetch(disc);
            lists.prefetch(disc);
        }
        if let Some((time, disc)) = queue.upcoming(AHEAD[1]) {
            if partners[disc as usize].with == RENEWAL {
                let disc = &discs[disc as usize];
                lists.prefetch_cells(self.registered(disc, time), disc.radius);
            }
            let with = partners[disc as usize].with as usize;
            lists.prefetch(with);
            queue.prefetch(with);
            for &other in lists.of(disc) {
                discs.prefetch(other as usize);
            }
        }
        if let Some((_, disc)) = queue.upcoming(AHEAD[2]) {
            match partners[disc as usize].with {
                RENEWAL => lists.of(disc).iter().for_each(|&other| lists.prefetch(other as usize)),
                with if (with as usize) < discs.len() => {
                    for &other in lists.of(with) {
                        discs.prefetch(other as usize);
                    }
                }
                _ => {}
            }
        }
    }
}
