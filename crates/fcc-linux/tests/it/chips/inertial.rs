//! Accelerometers and gyroscopes.

use std::time::Duration;

use fcc_linux::chip::Chip;
use fcc_linux::chip::icm42688::{Icm42688, mean_of};
use fcc_linux::chip::mpu6050::Mpu6050;
use proptest::prelude::*;

use crate::chips::board::{Board, NoDelay};
use crate::chips::measured;

const G_MPS2: f64 = 9.80665;

fn icm42688() -> Board {
    let board = Board::with(&[(0x75, 0x47)]);
    board.state().queues.insert(0x30, [].into());
    board
}

/// A packet of structure 3 (DS-000347, section 6.1): header, accelerations, turn
/// rates, temperature, time stamp.
pub(crate) fn packet(force: [i16; 3], rates: [i16; 3]) -> [u8; 16] {
    let mut packet = [0; 16];
    packet[0] = 0x68;
    for (place, value) in packet[1..13]
        .chunks_exact_mut(2)
        .zip(force.iter().chain(&rates))
    {
        place.copy_from_slice(&value.to_be_bytes());
    }
    packet
}

pub(crate) fn fill(board: &Board, packets: &[[u8; 16]]) {
    let bytes = packets.concat();
    let [high, low] = (bytes.len() as u16).to_be_bytes();
    // At once: a thread that reads meanwhile would find a count without data.
    let mut state = board.state();
    state
        .registers
        .extend([(0x2D, 0x04), (0x2E, high), (0x2F, low)]);
    state.queues.insert(0x30, bytes.into());
}

/// At ±16 g a g has 2,048 LSB, at ±2000 °/s a °/s 16.4 (DS-000347, tables 1 and 2).
#[test]
fn an_icm42688_gives_the_mean_of_its_fifo() {
    let board = icm42688();
    let mut chip = Icm42688::new(board.spi(0), &mut NoDelay).unwrap();
    for (register, value) in [
        (0x4E, 0x0F),
        (0x4F, 0x06),
        (0x50, 0x06),
        (0x16, 0x40),
        (0x4D, 0x51),
        (0x5F, 0x07),
    ] {
        assert_eq!(board.state().registers[&register], value, "{register:#x}");
    }
    assert_eq!(chip.measure().unwrap(), None, "nothing in the FIFO");
    let invalid = packet([i16::MIN; 3], [i16::MIN; 3]);
    let two = [
        packet([0, 0, 2_048], [164, 0, 0]),
        packet([0, 2_048, 2_048], [492, 0, 0]),
    ];
    fill(&board, &[invalid, two[0], two[1]]);
    let measurement = measured(&mut chip);
    let values = measurement.values;
    assert_eq!(
        (values.samples, measurement.age),
        (2, Duration::from_millis(1))
    );
    assert_eq!(
        values.specific_force_mps2,
        Some([0.0, G_MPS2 / 2.0, G_MPS2])
    );
    let [p, q, r] = values.rates_radps.unwrap();
    assert!((p.to_degrees() - 20.0).abs() < 1e-9 && q == 0.0 && r == 0.0);
}

/// The time stamp of a packet, its last two bytes.
fn stamped(mut packet: [u8; 16], stamp: u16) -> [u8; 16] {
    packet[14..].copy_from_slice(&stamp.to_be_bytes());
    packet
}

/// At 1 kHz the stamps are 937.5 apart: 30/32 of 1,000 (DS-000347, "FIFO timestamp
/// interval scaling"). They overflow at 65,536.
#[test]
fn the_stamps_of_an_icm42688_are_its_own_clock() {
    let board = icm42688();
    let mut chip = Icm42688::new(board.spi(0), &mut NoDelay).unwrap();
    let at = |number: u32| {
        let stamp = (65_000.0 + 937.5 * f64::from(number)) as u32 as u16;
        stamped(packet([0, 0, 2_048], [0; 3]), stamp)
    };
    let mut times = Vec::new();
    for first in [0, 4, 8] {
        fill(&board, &[0, 1, 2, 3].map(|after| at(first + after)));
        times.push(measured(&mut chip).stamp.unwrap().as_secs_f64());
    }
    // The mean of 0, 1, 2 and 3 ms, and of those after them, to a count.
    for (time_s, expected_s) in times.into_iter().zip([0.0015, 0.0055, 0.0095]) {
        assert!((time_s - expected_s).abs() < 2e-6, "{time_s} s");
    }
    // Of an external synchronization: header bits 3 and 2 are 11.
    let mut other = at(12);
    other[0] = 0x6C;
    fill(&board, &[other]);
    assert_eq!(measured(&mut chip).stamp, None);
}

#[test]
fn a_fifo_that_overflowed_or_is_out_of_step_is_emptied() {
    let board = icm42688();
    let mut chip = Icm42688::new(board.i2c(), &mut NoDelay).unwrap();
    let flush = vec![0x4B, 0x02];
    for (status, header, why) in [(0x06, 0x68, "overflowed"), (0x04, 0x78, "out of step")] {
        let mut one = packet([0; 3], [0; 3]);
        one[0] = header;
        fill(&board, &[one]);
        board.put(0x2D, &[status]);
        board.state().written.clear();
        let error = chip.measure().unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
        assert_eq!(board.state().written.last(), Some(&flush));
    }
}

/// At ±8 g a g has 4,096 LSB, at ±1000 °/s a °/s 32.8 (RM-MPU-6000A-00, sections
/// 4.17 and 4.19).
#[test]
fn an_mpu6050_is_read_when_it_is_ready() {
    let board = Board::with(&[(0x75, 0x68)]);
    let mut chip = Mpu6050::new(board.i2c(), 200.0, &mut NoDelay).unwrap();
    for (register, value) in [
        (0x6B, 0x01),
        (0x19, 4),
        (0x1A, 3),
        (0x1B, 0x10),
        (0x1C, 0x10),
    ] {
        assert_eq!(board.state().registers[&register], value, "{register:#x}");
    }
    assert_eq!(board.state().registers.get(&0x1D), None);
    assert_eq!(chip.measure().unwrap(), None);
    let values: [i16; 7] = [-4_096, 0, 4_096, 1_234, 0, -328, 3_280];
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_be_bytes())
        .collect();
    board.put(0x3A, &[0x01]);
    board.put(0x3B, &bytes);
    let measurement = measured(&mut chip);
    assert_eq!(
        measurement.values.specific_force_mps2,
        Some([-G_MPS2, 0.0, G_MPS2])
    );
    let [p, q, r] = measurement.values.rates_radps.unwrap().map(f64::to_degrees);
    assert!(p == 0.0 && (q + 10.0).abs() < 1e-9 && (r - 100.0).abs() < 1e-9);
    // Half of 5 ms, and the filter's 4.85 ms.
    assert_eq!(measurement.age, Duration::from_micros(7_350));
}

#[test]
fn an_mpu9250_has_a_filter_for_each() {
    let board = Board::with(&[(0x75, 0x71)]);
    Mpu6050::new(board.i2c(), 1_000.0, &mut NoDelay).unwrap();
    let state = board.state();
    assert_eq!((state.registers[&0x19], state.registers[&0x1D]), (0, 3));
}

proptest! {
    #[test]
    fn any_bytes_of_a_fifo_are_finite_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        if let Ok(Some(values)) = mean_of(&bytes) {
            let all = [values.specific_force_mps2.unwrap(), values.rates_radps.unwrap()].concat();
            prop_assert!(all.iter().all(|value| value.abs() <= 16.0 * G_MPS2 + 1.0));
            prop_assert!(values.samples as usize <= bytes.len() / 16);
        }
    }
}
