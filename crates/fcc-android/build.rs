//! What every link for a phone needs, with any NDK.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("android") {
        // A symbol that no phone has is an error here, not when it is loaded.
        println!("cargo::rustc-link-arg-cdylib=-Wl,-z,defs");
        // Phones may have pages of 16 KiB.
        println!("cargo::rustc-link-arg-cdylib=-Wl,-z,max-page-size=16384");
    }
}
