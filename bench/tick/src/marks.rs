//! Marks for a tracer: what is between them belongs to the tick.

/// A tick begins. To `strace` it is a `getppid`, to a trace of instructions
/// the call of this function.
#[inline(never)]
pub extern "C" fn begin() {
    std::hint::black_box(std::os::unix::process::parent_id());
}

/// A tick ends.
#[inline(never)]
pub extern "C" fn end() {
    // Different from `begin`, so that the compiler does not merge the two.
    std::hint::black_box(std::os::unix::process::parent_id() + 1);
}
