//! A serial line to a servo board: any bytes, and between them frames of any
//! messages. A whole frame after noise arrives, servos stay within their ranges,
//! and 200 ms after the last byte nobody holds them.
//!
//! The first byte is the size of the parts, every second of which is put into a
//! frame.
#![no_main]

use fcc_servo_board::{
    Board, BoardConfig, Control, Decoder, Encoder, MAX_FRAME, MAX_MESSAGE, Readings,
};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((part, bytes)) = input.split_first() else {
        return;
    };
    let (mut decoder, mut encoder) = (Decoder::new(), Encoder::new());
    let mut board: Board = Board::new(BoardConfig::default());
    let readings = Readings::default();
    let mut now_ms = 0;
    for (number, part) in bytes
        .chunks(usize::from(*part).clamp(1, MAX_MESSAGE))
        .enumerate()
    {
        let mut frame = [0; MAX_FRAME];
        let is_framed = number % 2 == 1;
        let line = if is_framed {
            encoder.frame(part, &mut frame).expect("it fits")
        } else {
            part
        };
        let mut last = None;
        for byte in line {
            if let Some(message) = decoder.push(*byte) {
                let _ = board.receive(now_ms, (), message);
                last = Some(message.to_vec());
            }
        }
        assert!(!is_framed || last.as_deref() == Some(part));
        now_ms += 3;
        let mut into = [0; MAX_MESSAGE];
        let _ = board.poll(now_ms, &readings, &mut into);
        let drive = board.drive();
        assert!(
            drive
                .surfaces
                .into_iter()
                .flatten()
                .all(|ratio| (-1.0..=1.0).contains(&ratio))
        );
        assert!(
            drive
                .throttle
                .is_none_or(|ratio| (0.0..=1.0).contains(&ratio))
        );
    }
    let _ = board.poll(now_ms + 200, &readings, &mut [0; MAX_MESSAGE]);
    assert_ne!(board.control(), Control::Held);
});
