//! Whether standard output was open when the program was started.
//!
//! Rust's runtime opens `/dev/null` in its place if it was closed, before `main`, and what is
//! printed then seems to be written. So it is looked at earlier: the linker's list
//! `.init_array` has functions that run before the runtime (System V ABI, chapter 5,
//! initialization and termination functions).

use std::sync::atomic::{AtomicBool, Ordering};

use nix::libc;

static WAS_CLOSED: AtomicBool = AtomicBool::new(false);

extern "C" fn look() {
    #[expect(
        unsafe_code,
        reason = "the descriptor may be closed, and is only asked about"
    )]
    // SAFETY: fcntl(F_GETFD) takes any number and changes nothing.
    let flags = unsafe { libc::fcntl(libc::STDOUT_FILENO, libc::F_GETFD) };
    WAS_CLOSED.store(flags < 0, Ordering::Relaxed);
}

#[expect(unsafe_code, reason = "a section is named")]
// SAFETY: the section has pointers to functions of this kind, which need no runtime.
#[unsafe(link_section = ".init_array")]
#[used]
static LOOK: extern "C" fn() = look;

/// Whether standard output was closed.
pub(crate) fn was_closed() -> bool {
    WAS_CLOSED.load(Ordering::Relaxed)
}
