//! Marks that a tracer sees: what is between them is the tick's.

/// A tick begins. To `strace` it is a `getppid`, to a trace of instructions
/// the call of this function.
#[inline(never)]
pub extern "C" fn begin() {
    std::hint::black_box(std::os::unix::process::parent_id());
}

/// A tick ends.
#[inline(never)]
pub extern "C" fn end() {
    // Not what `begin` does, so that the two are not folded into one.
    std::hint::black_box(std::os::unix::process::parent_id() + 1);
}
