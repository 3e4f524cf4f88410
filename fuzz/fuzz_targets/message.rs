//! The socket between the daemon and the process that publishes: any message,
//! in both directions; what is read is sent as the same.
#![no_main]

libfuzzer_sys::fuzz_target!(|message: &[u8]| {
    fcc_live::read_message(message);
});
