//! Values of subscribed datarefs: any bytes, only finite values.
#![no_main]

use fcc_xplane::protocol::rref;

libfuzzer_sys::fuzz_target!(|datagram: &[u8]| {
    if let Ok(pairs) = rref::parse(datagram) {
        assert!(pairs.clone().count() <= datagram.len() / 8);
        for (_, value) in pairs {
            assert!(value.is_finite());
        }
    }
});
