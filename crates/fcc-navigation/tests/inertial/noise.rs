//! Random numbers with a seed.

use std::f64::consts::TAU;

/// xorshift64* (Vigna 2016), and normal numbers by Box and Muller.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal, with a standard deviation.
    pub(crate) fn normal(&mut self, sigma: f64) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        sigma * radius * (TAU * self.uniform()).cos()
    }

    pub(crate) fn vector(&mut self, sigma: f64) -> [f64; 3] {
        [0; 3].map(|_| self.normal(sigma))
    }
}
