//! The beacon: any bytes, only addresses that can be answered.
#![no_main]

use fcc_xplane::protocol::beacon;

libfuzzer_sys::fuzz_target!(|datagram: &[u8]| {
    if let Ok(beacon) = beacon::parse(datagram) {
        assert_ne!(beacon.port, 0);
        assert!(!beacon.name.contains(&0));
        assert!(beacon.name.len() < datagram.len());
    }
});
