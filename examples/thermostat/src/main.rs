//! The framework with no aircraft in it.
fn main() {}
