//! Normally distributed numbers that are the same on every machine.
//!
//! A recorded flight must be reproducible bit for bit on another computer. The
//! usual samplers call the platform's `exp` and `ln`, which differ in the last
//! digit from one C library to the next; this one calls `libm`'s.

use libm::{log, sqrt};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A seeded source of standard normal numbers: xoshiro256++ and the polar
/// method of Marsaglia and Bray (1964).
#[derive(Clone, Debug)]
pub struct Gauss {
    bits: Xoshiro256PlusPlus,
    /// The method generates two numbers at a time; this is the second.
    spare: Option<f64>,
}

impl Gauss {
    /// The source with this seed. `stream` makes the sources of one simulation
    /// independent: gusts do not change when a sensor's noise is turned off.
    pub fn new(seed: u64, stream: Stream) -> Self {
        let mut bits = Xoshiro256PlusPlus::seed_from_u64(seed);
        for _ in 0..stream as u8 {
            bits.jump();
        }
        Self { bits, spare: None }
    }

    /// The next number of the source: mean 0, standard deviation 1.
    pub fn draw(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let x = self.uniform();
            let y = self.uniform();
            let square = x * x + y * y;
            if square < 1.0 && square > 0.0 {
                let scale = sqrt(-2.0 * log(square) / square);
                self.spare = Some(y * scale);
                return x * scale;
            }
        }
    }

    /// Uniform in -1..1.
    fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 52) as f64;
        (self.bits.next_u64() >> 11) as f64 * STEP - 1.0
    }
}

/// The purpose of a source of random numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Stream {
    /// Errors of the sensors.
    Sensors = 0,
    /// Gusts.
    Gusts = 1,
    /// The raw sensors, each by itself.
    Accelerometer = 2,
    /// See `Accelerometer`.
    Gyroscope = 3,
    /// See `Accelerometer`.
    Magnetometer = 4,
    /// See `Accelerometer`.
    Barometer = 5,
    /// See `Accelerometer`.
    Pitot = 6,
    /// See `Accelerometer`.
    Thermometer = 7,
    /// See `Accelerometer`.
    Gnss = 8,
    /// See `Accelerometer`.
    Rangefinder = 9,
}
