//! Recordings: any file is read as far as possible, and what is missing is
//! reported.
#![no_main]

mod files;

use fcc_record::{Recording, entry};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((path, bytes)) = files::file_of(input) else {
        return;
    };
    let Ok(recording) = Recording::open(path) else {
        assert!(entry(path).is_err());
        return;
    };
    // Unless it describes another plant.
    if let Ok(mut messages) = recording.messages::<fcc_telemetry::FlightMessage>() {
        // Every message has at least its header.
        assert!(messages.by_ref().count() <= bytes / 9);
        let cut = messages.cut().is_some();
        assert!(recording.is_whole() || cut || !messages.damages().is_empty());
    }
    let _ = entry(path);
});
