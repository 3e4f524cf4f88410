//! Recovery: any file is recovered, after which it is whole, or unchanged.
//!
//! Apart from reading, since each recovery writes a recording with its schemas.
#![no_main]

mod files;

use std::fs;

use fcc_record::{Wholeness, entry, recover};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((path, _)) = files::file_of(input) else {
        return;
    };
    let before = fs::read(path).expect("just written");
    if recover(path, |_| {}).is_ok() {
        let whole = entry(path).expect("it was recovered");
        assert_eq!(whole.file, Wholeness::Whole);
    } else {
        assert_eq!(fs::read(path).expect("still there"), before);
    }
});
