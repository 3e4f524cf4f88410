//! Frames: their bytes, and what a receiver makes of a disturbed line.

use fcc_servo_board::{Decoder, Encoder, LineCounts, MAX_FRAME, MAX_MESSAGE};
use proptest::prelude::*;

fn frame(encoder: &mut Encoder, message: &[u8]) -> Vec<u8> {
    encoder
        .frame(message, &mut [0; MAX_FRAME])
        .unwrap()
        .to_vec()
}

fn frames(messages: &[&[u8]]) -> Vec<Vec<u8>> {
    let mut encoder = Encoder::new();
    let each = messages.iter();
    each.map(|message| frame(&mut encoder, message)).collect()
}

fn decoded(decoder: &mut Decoder, bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut messages = Vec::new();
    for byte in bytes {
        messages.extend(decoder.push(*byte).map(<[u8]>::to_vec));
    }
    messages
}

fn counts(received: u32, corrupt: u32, lost: u32) -> LineCounts {
    LineCounts {
        received,
        corrupt,
        lost,
    }
}

fn bytes(hex: &str) -> Vec<u8> {
    let digits = hex.as_bytes().chunks(2);
    let pairs = digits.map(|pair| std::str::from_utf8(pair).unwrap());
    pairs
        .map(|pair| u8::from_str_radix(pair, 16).unwrap())
        .collect()
}

/// Of "123456789" the catalogue of parametrised CRC algorithms (G. Cook,
/// reveng.sourceforge.io) has 0xCBF43926 for CRC-32/ISO-HDLC. The sequence
/// number 0x31 stands for the first of these letters.
#[test]
fn the_checksum_is_that_of_the_catalogue() {
    let mut encoder = Encoder::new();
    let mut frame_0x31 = Vec::new();
    for _ in 0..=0x31 {
        frame_0x31 = frame(&mut encoder, b"23456789");
    }
    // Without a 0 in it, a frame is one code byte, 1 more than its length, and
    // the bytes as they are.
    assert_eq!(frame_0x31, b"\x00\x0e123456789\x26\x39\xf4\xcb\x00");
}

/// Made by Python's `zlib.crc32` and an encoder of its own; the same is in
/// `hil/tests/test_servo_board.py`.
#[test]
fn a_frame_is_as_another_program_makes_it() {
    let message = b"DREF\0\0\0\x80\x3fsim/operation/override/override_joystick";
    let first = frames(&[message]).remove(0);
    assert_eq!(first, bytes(FRAME));
    let mut decoder = Decoder::new();
    assert_eq!(decoded(&mut decoder, &bytes(FRAME)), [message.to_vec()]);
}

const FRAME: &str = "0001054452454601012f803f73696d2f6f7065726174696f6e2f6f766572726964652f6f7665\
                     72726964655f6a6f79737469636b9805f56500";

#[test]
fn gaps_in_the_numbers_are_counted_beyond_255() {
    let mut encoder = Encoder::new();
    let mut decoder = Decoder::new();
    for number in 0..600 {
        let bytes = frame(&mut encoder, b"DATA\0");
        // Frames 100 to 102, and 254 to 257.
        if !(100..103).contains(&number) && !(254..258).contains(&number) {
            assert_eq!(decoded(&mut decoder, &bytes).len(), 1);
        }
    }
    assert_eq!(decoder.counts(), counts(593, 0, 7));
}

#[test]
fn the_longest_message_fits_and_a_longer_one_is_refused() {
    for fill in [0, 1, 255] {
        let message = [fill; MAX_MESSAGE];
        let whole = frames(&[&message]).remove(0);
        assert!(whole.len() <= MAX_FRAME);
        assert_eq!(decoded(&mut Decoder::new(), &whole), [message.to_vec()]);
    }
    let longer = [1; MAX_MESSAGE + 1];
    assert!(Encoder::new().frame(&longer, &mut [0; MAX_FRAME]).is_none());
}

#[test]
fn what_is_between_delimiters_and_no_frame_is_counted_once() {
    let [first, second] = frames(&[b"one", b"two"]).try_into().unwrap();
    for garbage in [&b"\x01"[..], b"\x09x", b"hello", &[7; 10_000]] {
        let mut decoder = Decoder::new();
        let line = [&first[..], garbage, &second[..]].concat();
        let expected = [b"one".to_vec(), b"two".to_vec()];
        assert_eq!(decoded(&mut decoder, &line), expected, "{garbage:?}");
        assert_eq!(decoder.counts(), counts(2, 1, 0));
    }
    // Zeros alone are an idle line.
    let mut decoder = Decoder::new();
    assert!(decoded(&mut decoder, &[0; 100]).is_empty());
    assert_eq!(decoder.counts(), counts(0, 0, 0));
}

#[test]
fn a_cut_frame_costs_itself_only() {
    let [first, second] = frames(&[b"first", b"second"]).try_into().unwrap();
    for length in 1..first.len() - 1 {
        let line = [&first[..length], &second[..]].concat();
        let mut decoder = Decoder::new();
        assert_eq!(decoded(&mut decoder, &line), [b"second".to_vec()]);
    }
}

/// CRC-32 detects every error within 32 bits, which a changed byte is unless it
/// is one of COBS's.
#[test]
fn no_changed_byte_gives_a_message() {
    let whole = frames(&[b"DATA\0\x08\0\0\0 and more of it"]).remove(0);
    for at in 1..whole.len() - 1 {
        for flip in 1..=255 {
            let mut changed = whole.clone();
            changed[at] ^= flip;
            assert!(decoded(&mut Decoder::new(), &changed).is_empty());
        }
    }
}

#[test]
fn after_a_reset_no_gap_is_counted() {
    let all = frames(&[b"0", b"1", b"2", b"3"]);
    let mut decoder = Decoder::new();
    decoded(&mut decoder, &all[0]);
    decoded(&mut decoder, b"\x03a");
    decoder.reset();
    assert_eq!(decoded(&mut decoder, &all[3]), [b"3".to_vec()]);
    assert_eq!(decoder.counts(), counts(2, 0, 0));
}

proptest! {
    #[test]
    fn any_message_arrives_whole_however_it_is_cut_into_reads(
        messages in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..=MAX_MESSAGE), 0..8),
    ) {
        let mut encoder = Encoder::new();
        let mut line = Vec::new();
        for message in &messages {
            line.extend(frame(&mut encoder, message));
        }
        let mut decoder = Decoder::new();
        prop_assert_eq!(decoded(&mut decoder, &line), messages);
        prop_assert_eq!(decoder.counts().corrupt, 0);
        prop_assert_eq!(decoder.counts().lost, 0);
    }

    /// Whatever arrived before, of two frames at least the second one is found.
    #[test]
    fn after_any_bytes_the_next_frame_is_found(noise in prop::collection::vec(any::<u8>(), 0..2_000)) {
        let mut decoder = Decoder::new();
        decoded(&mut decoder, &noise);
        let after = decoded(&mut decoder, &frames(&[b"after"]).remove(0));
        prop_assert_eq!(after.last(), Some(&b"after".to_vec()));
    }
}
