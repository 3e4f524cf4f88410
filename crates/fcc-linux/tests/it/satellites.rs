//! What satellite receivers say, as other programs decode and encode it: pyubx2
//! 1.4.0, pynmea2 1.19.0.

use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_core::framework::Time;
use fcc_linux::serial::{Epoch, Epochs, Frames, NavPvt, Nmea, Ubx, UbxMessage, configuration};

/// Captured from a receiver in 2018, and published with the tests of another
/// decoder; its values below are those of pyubx2.
const CAPTURED: [u8; 100] = [
    0xb5, 0x62, 0x01, 0x07, 0x5c, 0x00, 0x00, 0x26, 0x08, 0x18, 0xe2, 0x07, 0x04, 0x1a, 0x0f, 0x3b,
    0x1d, 0xf7, 0xe9, 0x03, 0x00, 0x00, 0xf5, 0x1a, 0xe6, 0x0b, 0x03, 0x43, 0xea, 0x0e, 0x40, 0x60,
    0x91, 0x08, 0x94, 0xfa, 0xe0, 0x1d, 0xd2, 0xf1, 0x04, 0x00, 0xad, 0x44, 0x04, 0x00, 0x27, 0x00,
    0x00, 0x00, 0x31, 0x00, 0x00, 0x00, 0xee, 0xff, 0xff, 0xff, 0x04, 0x00, 0x00, 0x00, 0xe2, 0xff,
    0xff, 0xff, 0x12, 0x00, 0x00, 0x00, 0xd5, 0x65, 0x92, 0x01, 0x20, 0x00, 0x00, 0x00, 0x53, 0xcc,
    0x2c, 0x00, 0xa2, 0x00, 0x00, 0x00, 0x12, 0x19, 0x26, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x57, 0x03,
];

fn ubx(bytes: &[u8]) -> Vec<UbxMessage> {
    let mut found = Vec::new();
    Frames::<Ubx>::default().push(bytes, |message| found.push(message));
    found
}

fn pvt(bytes: &[u8]) -> NavPvt {
    match ubx(bytes)[..] {
        [UbxMessage::NavPvt(pvt)] => pvt,
        ref other => panic!("{other:?}"),
    }
}

fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} for {expected}");
}

fn assert_fix(found: &GnssFix, expected: &GnssFix) {
    let (at, place) = (found.position, expected.position);
    // A centimetre on the ground, and less than the last digit of the others.
    assert_near(at.latitude_rad, place.latitude_rad, 1.5e-9);
    assert_near(at.longitude_rad, place.longitude_rad, 1.5e-9);
    assert_near(at.altitude_m, place.altitude_m, 1e-9);
    let (v, velocity) = (found.velocity, expected.velocity);
    assert_near(v.north_mps, velocity.north_mps, 1e-3);
    assert_near(v.east_mps, velocity.east_mps, 1e-3);
    assert_near(v.down_mps, velocity.down_mps, 1e-9);
    assert_near(
        found.horizontal_accuracy_m,
        expected.horizontal_accuracy_m,
        1e-9,
    );
    assert_near(
        found.vertical_accuracy_m,
        expected.vertical_accuracy_m,
        1e-9,
    );
    assert_near(found.speed_accuracy_mps, expected.speed_accuracy_mps, 1e-9);
}

/// iTOW 15:59:29.200 on Thursday, lon 14.3745088, lat 50.1283476, hMSL 279725,
/// hAcc 39, vAcc 49, velN -18, velE 4, velD -30, sAcc 32, fixType 3, gnssFixOk 1.
#[test]
fn a_captured_fix_has_the_values_that_pyubx2_decodes() {
    let pvt = pvt(&CAPTURED);
    assert_eq!(pvt.fix_type, 3);
    assert!(pvt.is_valid);
    // pyubx2 shows the time in UTC, 18 s behind GPS since 2017.
    let thursday_utc_ms = 4 * 86_400_000 + ((15 * 60 + 59) * 60 + 29) * 1_000 + 200;
    assert_eq!(pvt.time_of_week_ms, thursday_utc_ms + 18_000);
    let expected = GnssFix {
        position: Position {
            latitude_rad: 50.128_347_6_f64.to_radians(),
            longitude_rad: 14.374_508_8_f64.to_radians(),
            altitude_m: 279.725,
        },
        velocity: Velocity {
            north_mps: -0.018,
            east_mps: 0.004,
            down_mps: -0.030,
        },
        horizontal_accuracy_m: 0.039,
        vertical_accuracy_m: 0.049,
        speed_accuracy_mps: 0.032,
    };
    assert_fix(&pvt.usable().unwrap(), &expected);
}

/// Encoded by pyubx2: NAV-PVT of iTOW 123456789, fixType 3, gnssFixOk 1, lon
/// -87.88, lat 42.95, height 186000, hMSL 220400, hAcc 1200, vAcc 2100, velN
/// -51400, velE 12345, velD -2540, sAcc 110.
const ENCODED: [u8; 100] = [
    0xb5, 0x62, 0x01, 0x07, 0x5c, 0x00, 0x15, 0xcd, 0x5b, 0x07, 0xea, 0x07, 0x0b, 0x16, 0x01, 0x02,
    0x03, 0x07, 0x14, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x01, 0x00, 0x0e, 0x80, 0x93,
    0x9e, 0xcb, 0x60, 0xa6, 0x99, 0x19, 0x90, 0xd6, 0x02, 0x00, 0xf0, 0x5c, 0x03, 0x00, 0xb0, 0x04,
    0x00, 0x00, 0x34, 0x08, 0x00, 0x00, 0x38, 0x37, 0xff, 0xff, 0x39, 0x30, 0x00, 0x00, 0x14, 0xf6,
    0xff, 0xff, 0x7d, 0xce, 0x00, 0x00, 0x0f, 0x0f, 0xfe, 0x00, 0x6e, 0x00, 0x00, 0x00, 0x9f, 0x86,
    0x01, 0x00, 0x8c, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x2d, 0x8b,
];

/// Milwaukee, as [`ENCODED`] and the sentences below.
fn milwaukee() -> GnssFix {
    GnssFix {
        position: Position {
            latitude_rad: 42.95_f64.to_radians(),
            longitude_rad: (-87.88_f64).to_radians(),
            altitude_m: 220.4,
        },
        velocity: Velocity {
            north_mps: -51.4,
            east_mps: 12.345,
            down_mps: -2.54,
        },
        horizontal_accuracy_m: 1.2,
        vertical_accuracy_m: 2.1,
        speed_accuracy_mps: 0.11,
    }
}

#[test]
fn west_south_and_down_have_their_signs() {
    let pvt = pvt(&ENCODED);
    assert_eq!(pvt.time_of_week_ms, 123_456_789);
    assert_fix(&pvt.usable().unwrap(), &milwaukee());
}

/// A frame with another byte in its payload, and the checksum of RFC 1145 for it.
fn changed(at: usize, value: u8) -> Vec<u8> {
    let mut frame = ENCODED.to_vec();
    frame[6 + at] = value;
    let (mut a, mut b) = (0_u32, 0_u32);
    for byte in &frame[2..98] {
        a += u32::from(*byte);
        b += a;
    }
    (frame[98], frame[99]) = (a as u8, b as u8);
    frame
}

#[test]
fn only_a_three_dimensional_fix_that_the_receiver_vouches_for_is_one() {
    assert!(
        pvt(&changed(20, 4)).usable().is_some(),
        "with dead reckoning"
    );
    for (fix_type, why) in [(0, "none"), (1, "dead reckoning"), (2, "2D"), (5, "time")] {
        assert!(pvt(&changed(20, fix_type)).usable().is_none(), "{why}");
    }
    assert!(pvt(&changed(21, 0)).usable().is_none(), "gnssFixOk 0");
    assert!(pvt(&changed(78, 1)).usable().is_none(), "invalidLlh 1");
}

#[test]
fn a_wrong_checksum_is_counted_and_gives_nothing() {
    for at in [10, 98, 99] {
        let mut frame = CAPTURED;
        frame[at] ^= 0x10;
        let mut frames = Frames::<Ubx>::default();
        frames.push(&frame, |message| panic!("{message:?}"));
        assert_eq!(frames.damaged(), 1);
    }
}

/// ACK-ACK and ACK-NAK of CFG-VALSET, encoded by pyubx2.
#[test]
fn the_receiver_accepts_or_refuses_a_configuration() {
    let accepted = [0xb5, 0x62, 0x05, 0x01, 0x02, 0x00, 0x06, 0x8a, 0x98, 0xc1];
    let refused = [0xb5, 0x62, 0x05, 0x00, 0x02, 0x00, 0x06, 0x8a, 0x97, 0xbc];
    assert_eq!(ubx(&accepted), [UbxMessage::Configured(true)]);
    assert_eq!(ubx(&refused), [UbxMessage::Configured(false)]);
}

/// pyubx2's `UBXMessage.config_set(1, 0, ...)` with the names of the items.
#[test]
fn the_configuration_is_what_pyubx2_encodes() {
    let [rate, uart1, usb] = configuration();
    // CFG_RATE_MEAS 200, CFG_RATE_NAV 1, CFG_NAVSPG_DYNMODEL 7
    assert_eq!(
        rate,
        [
            0xb5, 0x62, 0x06, 0x8a, 0x15, 0x00, 0x00, 0x01, 0x00, 0x00, 0x01, 0x00, 0x21, 0x30,
            0xc8, 0x00, 0x02, 0x00, 0x21, 0x30, 0x01, 0x00, 0x21, 0x00, 0x11, 0x20, 0x07, 0x6d,
            0x2a
        ]
    );
    // CFG_MSGOUT_UBX_NAV_PVT_UART1 1, CFG_UART1OUTPROT_UBX 1, CFG_UART1OUTPROT_NMEA 0
    assert_eq!(
        uart1,
        [
            0xb5, 0x62, 0x06, 0x8a, 0x13, 0x00, 0x00, 0x01, 0x00, 0x00, 0x07, 0x00, 0x91, 0x20,
            0x01, 0x01, 0x00, 0x74, 0x10, 0x01, 0x02, 0x00, 0x74, 0x10, 0x00, 0x69, 0xfe
        ]
    );
    // CFG_MSGOUT_UBX_NAV_PVT_USB 1, CFG_USBOUTPROT_UBX 1, CFG_USBOUTPROT_NMEA 0
    assert_eq!(
        usb,
        [
            0xb5, 0x62, 0x06, 0x8a, 0x13, 0x00, 0x00, 0x01, 0x00, 0x00, 0x09, 0x00, 0x91, 0x20,
            0x01, 0x01, 0x00, 0x78, 0x10, 0x01, 0x02, 0x00, 0x78, 0x10, 0x00, 0x73, 0x48
        ]
    );
}

fn fixes(sentences: &[&str]) -> Vec<GnssFix> {
    let (mut frames, mut epochs) = (Frames::<Nmea>::default(), Epochs::default());
    let mut found = Vec::new();
    for sentence in sentences {
        let line = format!("{sentence}\r\n");
        frames.push(line.as_bytes(), |sentence| {
            if let Epoch::Complete(fix) = epochs.take(sentence, Time::from_nanos(0)) {
                found.push(fix.value);
            }
        });
    }
    found
}

/// Encoded by pynmea2; a second apart, 2.54 m higher.
const CLIMBING: [&str; 5] = [
    "$GNGGA,101111.20,4257.00000,N,08752.80000,W,4,14,0.7,217.86,M,-34.4,M,1.0,0000*5B",
    "$GNRMC,101111.20,A,4257.00000,N,08752.80000,W,102.754,166.50,221126,,,R*73",
    "$GNGST,101111.20,1.5,,,,0.9,1.2,2.1*69",
    "$GNRMC,101112.20,A,4257.00000,N,08752.80000,W,102.754,166.50,221126,,,R*70",
    "$GNGGA,101112.20,4257.00000,N,08752.80000,W,4,14,0.7,220.4,M,-34.4,M,1.0,0000*66",
];

/// 102.754 kt to 166.5° is -51.4 and 12.34 m/s.
#[test]
fn the_sentences_of_an_epoch_are_one_fix() {
    let [fix] = fixes(&CLIMBING)[..] else {
        panic!("one fix: the first has no vertical speed yet");
    };
    let expected = GnssFix {
        velocity: Velocity {
            east_mps: 12.340,
            ..milwaukee().velocity
        },
        speed_accuracy_mps: 0.0,
        ..milwaukee()
    };
    assert_fix(&fix, &expected);
}

/// The examples of the crate `nmea`'s documentation; the position is pynmea2's:
/// 53.361336667, -6.50562, and the altitude 61.7.
#[test]
fn a_published_epoch_has_the_position_that_pynmea2_decodes() {
    let again = "$GPGGA,092751.000,5321.6802,N,00630.3371,W,1,8,1.03,61.7,M,55.3,M,,*75";
    let [fix] = fixes(&[
        "$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76",
        "$GPRMC,092750.000,A,5321.6802,N,00630.3372,W,0.02,31.66,280511,,,A*43",
        again,
        "$GPRMC,092751.000,A,5321.6802,N,00630.3371,W,0.06,31.66,280511,,,A*45",
    ])[..] else {
        panic!("one fix");
    };
    assert_near(fix.position.latitude_rad.to_degrees(), 53.361_336_667, 1e-8);
    assert_near(
        fix.position.longitude_rad.to_degrees(),
        -6.505_618_333,
        1e-8,
    );
    assert_eq!(fix.position.altitude_m, 61.7);
    assert_eq!(fix.velocity.down_mps, 0.0);
    assert_eq!(
        fix.horizontal_accuracy_m, 0.0,
        "no GST: the receiver does not say"
    );
}

/// A sentence with its checksum, the exclusive or of what is between `$` and `*`.
fn with_checksum(text: &str) -> String {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${text}*{sum:02X}")
}

#[test]
fn without_a_fix_there_is_none() {
    let rmc = |status: &str, mode: &str| {
        let mode = if mode.is_empty() {
            String::new()
        } else {
            format!(",{mode}")
        };
        with_checksum(&format!(
            "GPRMC,101112.20,{status},4257.0,N,08752.8,W,0.3,,221126,,{mode}"
        ))
    };
    let gga = |quality: &str| {
        with_checksum(&format!(
            "GPGGA,101112.20,4257.0,N,08752.8,W,{quality},14,0.7,220.4,M,-34.4,M,,"
        ))
    };
    let count = |rmc: &str, gga: &str| {
        let first = &CLIMBING[..3];
        fixes(&[first, &[rmc, gga][..]].concat()).len()
    };
    assert_eq!(count(&rmc("A", "A"), &gga("1")), 1);
    assert_eq!(count(&rmc("A", ""), &gga("2")), 1, "before version 2.3");
    assert_eq!(count(&rmc("V", "A"), &gga("1")), 0, "status V");
    for mode in ["N", "E", "M", "S"] {
        assert_eq!(count(&rmc("A", mode), &gga("1")), 0, "mode {mode}");
    }
    for quality in ["0", "6", "7", "8", ""] {
        assert_eq!(count(&rmc("A", "A"), &gga(quality)), 0, "quality {quality}");
    }
}

#[test]
fn sentences_of_different_epochs_make_no_fix() {
    let other = CLIMBING[3]
        .replace("101112.20", "101112.40")
        .replace("*70", "*76");
    assert_eq!(
        fixes(&[&CLIMBING[..3], &[other.as_str(), CLIMBING[4]]].concat()),
        []
    );
}

#[test]
fn damaged_sentences_are_counted_and_give_nothing() {
    let good = CLIMBING[4];
    for (damaged, why) in [
        (good.replace("*66", "*67"), "checksum"),
        (good.replace("220.4", "221.4"), "content"),
        (good.replace("*66", "*6+"), "no digit"),
        (
            with_checksum("GNGGA,nan,4257.0,N,08752.8,W,4,14,0.7,1,M,1,M,,"),
            "time",
        ),
        (with_checksum("GNGGA,101112"), "ends early"),
        (
            with_checksum("GNGGA,101112,4260.0,N,08752.8,W,4,14,0.7,1,M,1,M,,"),
            "60 minutes",
        ),
        (
            with_checksum("GNGGA,101112,4257.0,N,08752.8,W,4,14,0.7,715,F,1,M,,"),
            "an altitude in feet",
        ),
        (
            with_checksum("GNRMC,101112,A,4257.0,N,08752.8,W,-5.0,90.0,221126,,,A"),
            "a negative speed",
        ),
        (
            with_checksum("GNRMC,101112,A,4257.0,N,08752.8,W,5.0,400.0,221126,,,A"),
            "a course of 400°",
        ),
    ] {
        let mut frames = Frames::<Nmea>::default();
        frames.push(damaged.as_bytes(), |sentence| panic!("{why}: {sentence:?}"));
        assert_eq!(frames.damaged(), 1, "{why}");
    }
}

/// What passes sentences on hangs, and sends the last ones again.
#[test]
fn an_epoch_that_arrives_again_is_no_fix() {
    let again = [&CLIMBING[..], &CLIMBING[3..], &CLIMBING[..3]].concat();
    assert_eq!(fixes(&again).len(), 1);
}
