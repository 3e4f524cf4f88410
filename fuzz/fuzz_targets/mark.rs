//! The file of a plant: any content, and daemons after each other that take,
//! release and end; held is what was taken and not released.
//!
//! The first byte is the length of the content, up to 24.
#![no_main]

use std::sync::LazyLock;
use std::{env, process};

use fcc_telemetry::RunFolder;

static FOLDER: LazyLock<RunFolder> = LazyLock::new(|| {
    let path = env::temp_dir().join(format!("fcc-fuzz-{}", process::id()));
    RunFolder::at(path).expect("a temporary folder")
});

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((length, rest)) = input.split_first() else {
        return;
    };
    let (content, steps) = rest.split_at(usize::from(length % 25).min(rest.len()));
    let steps = &steps[..steps.len().min(8)];
    fcc_daemon::use_plant_file(&FOLDER, content, steps);
});
