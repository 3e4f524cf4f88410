//! What copper's macros ask of a crate that uses them.

fn main() {
    cu29_build::setup();
}
