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
    if let Ok(recovered) = recover(path, |_| {}) {
        // Or the next one would be kept beside it, under the next free name.
        if let Some(kept) = recovered.kept {
            assert_eq!(fs::read(&kept).expect("it was kept"), before);
            fs::remove_file(kept).expect("it was kept");
        }
        let whole = entry(path).expect("it was recovered");
        assert_eq!(whole.file, Wholeness::Whole);
    } else {
        assert_eq!(fs::read(path).expect("still there"), before);
    }
});
