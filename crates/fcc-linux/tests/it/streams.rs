//! Frames in streams: cut anywhere, with noise between, and bytes that are none.

use fcc_core::framework::Time;
use fcc_linux::serial::{Begin, Crsf, Epoch, Epochs, Frames, Nmea, Protocol, Sbus, Ubx};
use proptest::prelude::*;

/// Acknowledgement of a configuration, encoded by pyubx2.
const ACK: &[u8] = &[0xb5, 0x62, 0x05, 0x01, 0x02, 0x00, 0x06, 0x8a, 0x98, 0xc1];
/// Encoded by pynmea2.
const GST: &[u8] = b"$GNGST,101112.20,1.5,,,,0.9,1.2,2.1*6A";
/// A capture in Betaflight's `rx_crsf_unittest.cc`.
const CRSF: &[u8] = &[
    0xc8, 0x18, 0x16, 0xbd, 0x08, 0x9f, 0xf4, 0xae, 0xf7, 0xbd, 0xef, 0x7d, 0xef, 0xfb, 0xad, 0xfd,
    0x45, 0x2b, 0x5a, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x6c,
];
/// Of the crate `sbus`; 0x0f is nowhere but at its beginning.
const SBUS: &[u8] = &[
    0x0f, 0xe0, 0x03, 0x1f, 0x58, 0xc0, 0x07, 0x16, 0xb0, 0x80, 0x05, 0x2c, 0x60, 0x01, 0x0b, 0xf8,
    0xc0, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x00,
];

/// How many frames are found if the stream is cut into pieces of these lengths.
fn count<P: Protocol>(stream: &[u8], pieces: &[usize]) -> usize {
    let (mut frames, mut found) = (Frames::<P>::default(), 0);
    let mut rest = stream;
    for length in pieces {
        let (piece, later) = rest.split_at((*length).min(rest.len()));
        frames.push(piece, |_| found += 1);
        rest = later;
    }
    frames.push(rest, |_| found += 1);
    found
}

/// Frames with noise before each, which has none of the bytes that could begin
/// one.
fn stream(frame: &[u8], noises: &[Vec<u8>]) -> Vec<u8> {
    let first = frame[0];
    let noise = |bytes: &Vec<u8>| -> Vec<u8> {
        bytes
            .iter()
            .map(|byte| if *byte == first { !first } else { *byte })
            .collect()
    };
    noises
        .iter()
        .flat_map(|bytes| [noise(bytes), frame.to_vec()].concat())
        .collect()
}

fn noises() -> impl Strategy<Value = Vec<Vec<u8>>> {
    prop::collection::vec(prop::collection::vec(any::<u8>(), 0..200), 1..6)
}

fn pieces() -> impl Strategy<Value = Vec<usize>> {
    prop::collection::vec(0_usize..40, 0..60)
}

proptest! {
    /// All of them are found, wherever the stream is cut.
    #[test]
    fn frames_are_found_between_noise(noises in noises(), pieces in pieces()) {
        let all = noises.len();
        prop_assert_eq!(count::<Ubx>(&stream(ACK, &noises), &pieces), all);
        prop_assert_eq!(count::<Nmea>(&stream(GST, &noises), &pieces), all);
        prop_assert_eq!(count::<Crsf>(&stream(CRSF, &noises), &pieces), all);
        prop_assert_eq!(count::<Sbus>(&stream(SBUS, &noises), &pieces), all);
    }

    /// A frame that was cut off costs itself alone, and not the next, of which its
    /// last bytes seem to be a part.
    #[test]
    fn a_frame_that_was_cut_off_costs_no_other(cut in 1_usize..38, pieces in pieces()) {
        let after = |frame: &[u8]| {
            [&frame[..cut.min(frame.len() - 1)], frame, frame].concat()
        };
        prop_assert_eq!(count::<Ubx>(&after(ACK), &pieces), 2);
        prop_assert_eq!(count::<Nmea>(&after(GST), &pieces), 2);
        prop_assert_eq!(count::<Crsf>(&after(CRSF), &pieces), 2);
        let mut frames = Frames::<Sbus>::default();
        let mut found = 0;
        frames.push(&SBUS[..cut.min(24)], |_| found += 1);
        frames.restart();
        frames.push(&[SBUS, SBUS].concat(), |_| found += 1);
        prop_assert_eq!(found, 2);
    }

    /// Any bytes: no panic, no frame longer than the protocol's, and what is found
    /// does not depend on how they are cut.
    #[test]
    fn any_bytes_give_the_same_however_they_are_cut(
        bytes in prop::collection::vec(
            prop_oneof![any::<u8>(), prop::sample::select(&b"\x0f\xb5\x62\xc8\x18\x16\x14$GPRMC,*"[..])],
            0..400,
        ),
        pieces in pieces(),
    ) {
        fn check<P: Protocol>(bytes: &[u8], pieces: &[usize]) {
            assert_eq!(count::<P>(bytes, pieces), count::<P>(bytes, &[]));
            for begin in 0..bytes.len() {
                if let Begin::Frame(_, length) = P::begin(&bytes[begin..]) {
                    assert!((1..=P::LONGEST).contains(&length));
                }
            }
        }
        check::<Ubx>(&bytes, &pieces);
        check::<Nmea>(&bytes, &pieces);
        check::<Crsf>(&bytes, &pieces);
        check::<Sbus>(&bytes, &pieces);
    }

    /// Numbers of any form in sentences with the right checksum: what makes a fix
    /// is on the earth.
    #[test]
    fn sentences_give_only_places_on_the_earth(
        fields in prop::collection::vec("[0-9NSEWAVMD.,+-]{0,10}|nan|inf|1e9", 14),
    ) {
        let (mut frames, mut epochs) = (Frames::<Nmea>::default(), Epochs::default());
        for kind in ["GGA", "RMC", "GST", "GGA", "RMC"] {
            let text = format!("GN{kind},101112,{}", fields.join(","));
            let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
            frames.push(format!("${text}*{sum:02x}").as_bytes(), |sentence| {
                if let Epoch::Complete(fix) = epochs.take(sentence, Time::from_nanos(0)) {
                    let fix = fix.value;
                    assert!(fix.position.latitude_rad.abs() <= core::f64::consts::FRAC_PI_2);
                    assert!(fix.position.longitude_rad.abs() <= core::f64::consts::PI);
                    assert!(fix.position.altitude_m.is_finite());
                    assert!(fix.velocity.north_mps.is_finite() && fix.velocity.down_mps.is_finite());
                }
            });
        }
    }
}
