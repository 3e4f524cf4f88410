//! The position: any bytes, only places on Earth.
#![no_main]

use fcc_xplane::protocol::rpos;

libfuzzer_sys::fuzz_target!(|datagram: &[u8]| {
    if let Ok(reply) = rpos::parse(datagram) {
        assert!(reply.latitude_deg.abs() <= 90.0);
        assert!(reply.longitude_deg.abs() <= 180.0);
        assert!(reply.elevation_m.is_finite());
        assert!(reply.yaw_radps.is_finite());
    }
});
