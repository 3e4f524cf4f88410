//! Counts how often a thread calls the allocator.
#![allow(unsafe_code, reason = "an allocator is unsafe by nature")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    // Const and without a destructor, so that counting does not allocate; per
    // thread, because the test harness has other threads.
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn count() {
    CALLS.set(CALLS.get() + 1);
}

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps to the contract of this same method.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps to the contract of this same method.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller keeps to the contract of this same method.
        unsafe { System.realloc(old, layout, size) }
    }

    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        count();
        // SAFETY: the caller keeps to the contract of this same method.
        unsafe { System.dealloc(old, layout) }
    }
}

/// The result of `work`, and how often the calling thread allocated,
/// reallocated or freed meanwhile.
///
/// ```
/// let ((), calls) = fcc_conformance::allocator_calls(|| drop(std::hint::black_box(Box::new(1))));
/// assert_eq!(calls, 2);
/// ```
pub fn allocator_calls<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = allocator_calls_so_far();
    let result = work();
    (result, allocator_calls_so_far() - before)
}

/// How often the calling thread has allocated, reallocated or freed since it began.
pub fn allocator_calls_so_far() -> u64 {
    CALLS.get()
}
