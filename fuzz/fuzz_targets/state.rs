//! State files: any content is refused, or read and written again.
#![no_main]

libfuzzer_sys::fuzz_target!(|body: &[u8]| {
    assert_ne!(fcc_flight::flight::read_state(body), Some(false));
});
