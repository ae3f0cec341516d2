//! Pool of register files, reused between runs: fresh pages for every run would cost more than the passes over them.
//!
//! The interface is two calls, not a closure, because a closure would leave the function that is compiled for the instruction
//! set.

use std::any::Any;
use std::cell::RefCell;

thread_local! {
    static KEPT: RefCell<Vec<Box<dyn Any>>> = const { RefCell::new(Vec::new()) };
}

/// Takes this thread's `T` out of the pool; creates a default if there is none or another run uses it.
#[inline(never)]
pub(super) fn take_pooled<T: Default + 'static>() -> Box<T> {
    let kept = KEPT.with_borrow_mut(|kept| {
        let at = kept.iter().position(|any| any.is::<T>());
        at.and_then(|at| kept.swap_remove(at).downcast::<T>().ok())
    });
    kept.unwrap_or_default()
}

/// Returns it to the pool for the next run.
#[inline(never)]
pub(super) fn return_to_pool<T: 'static>(kept: Box<T>) {
    KEPT.with_borrow_mut(|all| all.push(kept));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pool_reuses_returned_values_only() {
        let mut kept: Box<Vec<u8>> = take_pooled();
        kept.push(1);
        assert!(take_pooled::<Vec<u8>>().is_empty());
        return_to_pool(kept);
        assert!(take_pooled::<Vec<u16>>().is_empty());
        assert_eq!(*take_pooled::<Vec<u8>>(), [1]);
    }
}
