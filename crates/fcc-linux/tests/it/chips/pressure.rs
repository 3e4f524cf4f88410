//! Barometers and pitot tubes.

use fcc_linux::chip::Chip;
use fcc_linux::chip::bmp3::Bmp3;
use fcc_linux::chip::bmp180::{Bmp180, Bmp180Calibration};
use fcc_linux::chip::ms4525do::{Ms4525do, OutputType};
use fcc_linux::chip::sdp3x::{Sdp3x, crc};

use proptest::prelude::*;

use crate::chips::board::{Board, NoDelay};
use crate::chips::measured;

/// The calibration in the data sheet's example (BST-BMP180-DS000-09, figure 4).
const BMP180: [i32; 11] = [
    408, -72, -14_383, 32_741, 32_757, 23_153, 6_190, 4, -32_768, -8_711, 2_868,
];

/// The same temperature and pressure as in the example, with eight samples in
/// one: 23,843 · 8 is 190,744. Its arithmetic with integers rounds elsewhere then.
#[test]
fn a_bmp180_measures_as_in_its_data_sheet() {
    let board = Board::with(&[(0xD0, 0x55)]);
    let words: Vec<u8> = BMP180
        .iter()
        .flat_map(|word| (*word as i16).to_be_bytes())
        .collect();
    board.put(0xAA, &words);
    let mut chip = Bmp180::new(board.i2c(), NoDelay).unwrap();
    // The control register, of which bit 5 is cleared after a conversion, and
    // the result after another register.
    let [t1, t0] = 27_898_u16.to_be_bytes();
    let [_, p2, p1, p0] = (190_744_u32 << 5).to_be_bytes();
    let done = |control: u8, [a, b, c]: [u8; 3]| (0xF4, vec![control, 0, a, b, c]);
    let temperature = (vec![0xF4, 0x2E], done(0x0E, [t1, t0, 0]));
    let pressure = (vec![0xF4, 0xF4], done(0xD4, [p2, p1, p0]));
    board.state().after = [temperature, pressure].into();
    let pa = measured(&mut chip).values.static_pressure_pa.unwrap();
    assert!((pa - 69_964.0).abs() < 3.0, "{pa}");
    board.state().after.clear();
    let busy = chip.measure().unwrap_err().to_string();
    assert!(busy.ends_with("a conversion takes too long"), "{busy}");
}

/// A BMP388's calibration and one of its readings, and what another program
/// computes of them (`elixir-sensors/bmp3xx`, tests of its calibration).
#[test]
fn a_bmp388_measures_on_both_buses() {
    let board = Board::with(&[(0x00, 0x50)]);
    board.put(
        0x31,
        &[
            0x23, 0x6B, 0x58, 0x49, 0xF6, 0x5C, 0xFF, 0xCE, 0xF4, 0x23, 0x00, 0xEA, 0x63, 0x6E,
            0x79, 0xF3, 0xF6, 0xAA, 0x43, 0x12, 0xC4,
        ],
    );
    board.put(0x03, &[0x70, 0x97, 0x9F, 0x6D, 0x73, 0xD8, 0x85]);
    let mut by_i2c = Bmp3::new(board.i2c(), &mut NoDelay).unwrap();
    for (register, value) in [(0x1B, 0x33), (0x1C, 0x03), (0x1D, 0x02), (0x1F, 0)] {
        assert_eq!(board.state().registers[&register], value, "{register:#x}");
    }
    let mut by_spi = Bmp3::new(board.spi(1), &mut NoDelay).unwrap();
    for values in [measured(&mut by_i2c).values, measured(&mut by_spi).values] {
        assert!((values.static_pressure_pa.unwrap() - 100_876.006_346_9).abs() < 1e-6);
    }
    board.put(0x03, &[0x10]);
    assert_eq!(by_i2c.measure().unwrap(), None);
    board.put(0x03, &[0x70, 0, 0, 0]);
    let error = by_i2c.measure().unwrap_err().to_string();
    assert!(
        error.ends_with("its pressure is out of its range"),
        "{error}"
    );
}

/// Status bits: 0 good, 2 read before, 3 a fault ("Interfacing to MEAS Digital
/// Pressure Modules", section 1.6.1).
#[test]
fn an_ms4525do_says_whether_it_is_well() {
    let board = Board::default();
    let mut chip = Ms4525do::new(board.i2c(), OutputType::A, 1.0).unwrap();
    // 90 % of 16,383: +1 psi.
    board.state().answer = vec![0x39, 0x99, 0x66, 0x20];
    let pa = measured(&mut chip).values.differential_pressure_pa.unwrap();
    assert!((pa - 6_894.757).abs() < 1.06, "{pa}");
    board.state().answer[0] = 0x39 | 0x80;
    assert_eq!(chip.measure().unwrap(), None);
    for (status, why) in [(0xC0, "a fault of its bridge"), (0x40, "a reserved one")] {
        board.state().answer[0] = 0x39 | status;
        let error = chip.measure().unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}

/// -500 Pa of an SDP31, at 60 LSB in a pascal.
#[test]
fn an_sdp31_checks_what_it_sends() {
    let board = Board::default();
    let words = [
        (-30_000_i16).to_be_bytes(),
        5_000_i16.to_be_bytes(),
        60_i16.to_be_bytes(),
    ];
    let answer = words.iter().flat_map(|word| [word[0], word[1], crc(word)]);
    board.state().answer = answer.collect();
    let mut chip = Sdp3x::new(board.i2c(), &mut NoDelay).unwrap();
    assert_eq!(board.state().written, [vec![0x3F, 0xF9], vec![0x36, 0x15]]);
    assert_eq!(
        measured(&mut chip).values.differential_pressure_pa,
        Some(-500.0)
    );
    board.state().answer[0] ^= 1;
    let error = chip.measure().unwrap_err().to_string();
    assert!(error.ends_with("a checksum is wrong"), "{error}");
    assert!(
        Sdp3x::new(board.i2c(), &mut NoDelay).is_err(),
        "another chip"
    );
}

proptest! {
    /// Also of a memory that was not read rightly, in debug builds, where an
    /// overflow is a panic.
    #[test]
    fn any_calibration_of_a_bmp180_gives_a_pressure_or_none(
        words in prop::array::uniform11(any::<u16>()),
        temperature in 0..1_i32 << 16,
        pressure in 0..1_i32 << 24,
        oss in 0..4_u8,
    ) {
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
        if let Some(calibration) = bytes.first_chunk().and_then(Bmp180Calibration::of) {
            let _ = calibration.compensated(temperature, pressure, oss);
        }
    }
}
