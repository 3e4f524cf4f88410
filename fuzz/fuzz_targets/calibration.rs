//! Files of `fccd calibrate`: any content is refused, or read and written again.
#![no_main]

libfuzzer_sys::fuzz_target!(|body: &[u8]| {
    assert_ne!(fcc_flight::calibrate::read_calibration(body), Some(false));
});
