//! `fccd`.
fn main() {}
