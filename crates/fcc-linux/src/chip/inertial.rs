//! What accelerometers and gyroscopes have in common.

use crate::RawValues;

/// Standard gravity, m/s² (ISO 80000-3).
const G_MPS2: f64 = 9.806_65;

/// Two bytes, the higher first.
pub(super) const fn word(high: u8, low: u8) -> i16 {
    i16::from_be_bytes([high, low])
}

/// LSB per rad/s of so many LSB per °/s.
pub(super) fn radps(lsb_per_degps: f64) -> f64 {
    lsb_per_degps * 180.0 / core::f64::consts::PI
}

/// The sum of samples in LSB.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    force: [i64; 3],
    rates: [i64; 3],
    samples: u32,
}

impl Sum {
    pub(super) fn add(&mut self, force: [i16; 3], rates: [i16; 3]) {
        for (sum, value) in self.force.iter_mut().zip(force) {
            *sum += i64::from(value);
        }
        for (sum, value) in self.rates.iter_mut().zip(rates) {
            *sum += i64::from(value);
        }
        self.samples += 1;
    }

    /// The mean in m/s² and rad/s; none without a sample.
    pub(super) fn mean(&self, lsb_per_g: f64, lsb_per_radps: f64) -> Option<RawValues> {
        if self.samples == 0 {
            return None;
        }
        let samples = f64::from(self.samples);
        Some(RawValues {
            specific_force_mps2: Some(
                self.force
                    .map(|sum| sum as f64 / samples / lsb_per_g * G_MPS2),
            ),
            rates_radps: Some(self.rates.map(|sum| sum as f64 / samples / lsb_per_radps)),
            samples: self.samples,
            ..RawValues::NONE
        })
    }
}
