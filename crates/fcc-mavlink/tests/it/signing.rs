//! Signatures (mavlink.io, "Message Signing"), of frames that pymavlink 2.4.50 has signed.

use fcc_mavlink::{Identity, Key, LinkOptions, Now, Protocol, Settings, read_key};

use crate::commands::{frame, long};
use crate::world::{QUIET, UTC_US};

/// The key of these frames is 00 01 02 ... 1f, their link 3. They ask for `AUTOPILOT_VERSION`,
/// signed 1 s and 10 s after `UTC_US`.
const FIRST: &str = "fd20010001ffbe4c0000000014430000000000000000000000000000000000000000000000000002\
     01015afb03a082fc762e2262951e5ec780";
const SECOND: &str = "fd20010002ffbe4c0000000014430000000000000000000000000000000000000000000000000002\
     0101682403403e0a772e228a0df90a72ba";

fn bytes(hex: &str) -> Vec<u8> {
    let pairs = (0..hex.len() / 2).map(|n| u8::from_str_radix(&hex[2 * n..2 * n + 2], 16));
    pairs.collect::<Result<_, _>>().unwrap()
}

fn key() -> Key {
    read_key("000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f").unwrap()
}

fn now(seconds: u64) -> Now {
    Now {
        ms: seconds * 1_000,
        utc_us: UTC_US + seconds * 1_000_000,
    }
}

fn vehicle(key: Option<Key>, newest_time_stamp: u64, now: Now) -> Protocol {
    let settings = Settings {
        system: 1,
        identity: Identity::Generic,
        key,
        newest_time_stamp,
    };
    let mut protocol = Protocol::new(settings, now);
    protocol.open(1, QUIET, now);
    protocol.open(2, LinkOptions { ..QUIET }, now);
    protocol
}

/// Whether a frame is answered.
fn is_read(protocol: &mut Protocol, link: u16, bytes: &[u8], now: Now) -> bool {
    protocol.receive(link, bytes, now);
    let mut is_answered = false;
    protocol.step(now, |_, frame| is_answered |= frame[7] == 77);
    is_answered
}

#[test]
fn what_another_program_has_signed_is_read_once_on_all_links() {
    let mut protocol = vehicle(Some(key()), 0, now(0));
    assert!(is_read(&mut protocol, 1, &bytes(FIRST), now(1)));
    assert!(
        !is_read(&mut protocol, 1, &bytes(FIRST), now(1)),
        "replayed"
    );
    // PX4 #28697: a table for each link let it in by another one.
    assert!(
        !is_read(&mut protocol, 2, &bytes(FIRST), now(1)),
        "on another link"
    );
    assert!(is_read(&mut protocol, 2, &bytes(SECOND), now(10)));
    assert!(
        !is_read(&mut protocol, 1, &bytes(FIRST), now(3)),
        "an older one"
    );
}

#[test]
fn without_the_signature_nothing_is_read() {
    let mut protocol = vehicle(Some(key()), 0, now(0));
    let payload = long(512, [148.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
    assert!(!is_read(
        &mut protocol,
        1,
        &frame((255, 190), 1, 76, &payload),
        now(1)
    ));
    // CVE-2020-10283: falling back to version 1.
    let mut v1 = vec![0xfe, 33, 1, 255, 190, 76];
    v1.extend(&payload);
    v1.extend(mavlink::calculate_crc(&v1[1..], 152).to_le_bytes());
    assert!(!is_read(&mut protocol, 1, &v1, now(1)));
    assert!(
        is_read(&mut vehicle(None, 0, now(0)), 1, &v1, now(1)),
        "that it is one"
    );
    for n in 0..bytes(FIRST).len() {
        let mut changed = bytes(FIRST);
        changed[n] ^= 1;
        assert!(!is_read(&mut protocol, 1, &changed, now(1)), "byte {n}");
    }
    let other = read_key(&"ab".repeat(32)).unwrap();
    assert!(!is_read(
        &mut vehicle(Some(other), 0, now(0)),
        1,
        &bytes(FIRST),
        now(1)
    ));
}

#[test]
fn a_recorded_frame_does_not_work_after_a_restart() {
    let mut first = vehicle(Some(key()), 0, now(0));
    assert!(is_read(&mut first, 1, &bytes(FIRST), now(1)));
    let kept = first.newest_time_stamp();
    // Also where the clock has gone back, as without a battery.
    for begin in [now(2), now(0), Now::default()] {
        let mut again = vehicle(Some(key()), kept, begin);
        assert!(!is_read(&mut again, 1, &bytes(FIRST), begin), "{begin:?}");
    }
    // What was signed later than that is read.
    let mut again = vehicle(Some(key()), kept, now(0));
    assert!(is_read(&mut again, 1, &bytes(SECOND), now(10)));
}

/// A new stream may be 1 minute behind.
#[test]
fn a_station_whose_clock_is_far_behind_is_not_read() {
    for (seconds, expected) in [(50, true), (70, false)] {
        let mut protocol = vehicle(Some(key()), 0, now(0));
        assert_eq!(
            is_read(&mut protocol, 1, &bytes(FIRST), now(seconds)),
            expected,
            "{seconds} s"
        );
    }
}

#[test]
fn what_is_sent_is_signed_with_growing_time_stamps() {
    let mut protocol = vehicle(Some(key()), 0, now(0));
    let mut stamps = Vec::new();
    for second in 0..20 {
        protocol.step(now(second), |_, frame| {
            assert_eq!(frame[2] & 1, 1);
            let at = frame.len() - 13;
            let mut stamp = [0; 8];
            stamp[..6].copy_from_slice(&frame[at + 1..at + 7]);
            stamps.push(u64::from_le_bytes(stamp));
        });
    }
    assert!(
        stamps.len() >= 8 && stamps.is_sorted_by(|a, b| a < b),
        "{stamps:?}"
    );
}

#[test]
fn a_key_is_64_digits() {
    for wrong in [
        "",
        "ab",
        &"ab".repeat(31),
        &"ab".repeat(33),
        &"zz".repeat(32),
    ] {
        assert!(read_key(wrong).is_err(), "{wrong}");
    }
    assert!(read_key(&format!("{}\n", "0a".repeat(32))).is_ok());
    assert_eq!(format!("{:?}", key()), "Key", "it is in no log");
}
