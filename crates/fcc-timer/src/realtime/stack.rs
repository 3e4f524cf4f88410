//! Loading the stack into memory before it is needed.
//!
//! A thread's stack is mapped at once but backed by memory page by page, each
//! with a page fault when it is first touched. Touching it beforehand avoids
//! these faults in the loop.
#![allow(unsafe_code)]

use nix::errno::Errno;
use std::hint::black_box;
use std::mem::MaybeUninit;
use std::ops::Range;
use std::ptr;

use super::DeniedRequest;
use crate::usage::page_faults;

/// The smallest page of any machine that Linux runs on.
const PAGE_BYTES: usize = 4096;
/// Stack left for the loop's own calls.
const RESERVE_BYTES: usize = 64 * 1024;

/// Touches this many bytes of the calling thread's stack.
pub(super) fn prefault(bytes: usize) -> Result<(), DeniedRequest> {
    let denied = |reason: String, remedy: String| DeniedRequest {
        request: format!("{} KiB of stack in memory", bytes / 1024),
        reason,
        remedy,
    };
    let left = left_over().map_err(|errno| {
        denied(
            format!("the size of the stack is not known: {errno}"),
            "do not ask for it".to_owned(),
        )
    })?;
    // A frame is a page and a little more.
    let needed = bytes
        .saturating_add(bytes / 4)
        .saturating_add(RESERVE_BYTES);
    if needed > left {
        return Err(denied(
            format!("the thread has {} KiB left", left / 1024),
            format!(
                "ask for less, or give the thread a stack {} KiB larger",
                (needed - left).div_ceil(1024)
            ),
        ));
    }
    let pages = bytes.div_ceil(PAGE_BYTES);
    touch(pages);
    // Pages in memory cause no further faults.
    let before = page_faults();
    touch(pages);
    let faults = page_faults().minor - before.minor;
    if faults == 0 {
        Ok(())
    } else {
        Err(denied(
            format!("{faults} pages were gone again at once"),
            "lock the memory too, or free some".to_owned(),
        ))
    }
}

/// Writes to `pages` pages of stack, one frame each.
#[inline(never)]
fn touch(pages: usize) {
    let mut page = [0_u8; PAGE_BYTES];
    black_box(&mut page);
    if pages > 1 {
        touch(pages - 1);
    }
    // Used after the call, or the call would become a jump and the frames one.
    black_box(&mut page);
}

/// Bytes of the calling thread's stack below this frame.
fn left_over() -> Result<usize, Errno> {
    let here = MaybeUninit::<u8>::uninit();
    Ok(here.as_ptr().addr().saturating_sub(range()?.start))
}

/// The addresses of the calling thread's stack.
pub(super) fn range() -> Result<Range<usize>, Errno> {
    let mut attributes = MaybeUninit::<libc::pthread_attr_t>::uninit();
    let mut lowest = ptr::null_mut();
    let mut size = 0;
    // SAFETY: the pointers are to live values. The attributes are read and
    // destroyed only after the first call has filled them in.
    let errno = unsafe {
        let errno = libc::pthread_getattr_np(libc::pthread_self(), attributes.as_mut_ptr());
        if errno == 0 {
            libc::pthread_attr_getstack(attributes.as_ptr(), &raw mut lowest, &raw mut size);
            libc::pthread_attr_destroy(attributes.as_mut_ptr());
        }
        errno
    };
    if errno == 0 {
        Ok(lowest.addr()..lowest.addr().saturating_add(size))
    } else {
        Err(Errno::from_raw(errno))
    }
}
