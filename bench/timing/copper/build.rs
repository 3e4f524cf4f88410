//! Required by copper's macros.

fn main() {
    cu29_build::setup();
}
