//! From a lateral acceleration to a bank.

use libm::atan;

use fcc_core::blocks::RateLimit;
use fcc_core::units::GRAVITY_MPS2;

/// The bank of a coordinated turn, tan φ = a/g, within a limit and a rate.
///
/// ```
/// use fcc_guidance::path::BankCommand;
///
/// let mut bank = BankCommand::new(30.0_f64.to_radians(), 10.0_f64.to_radians());
/// bank.reset(0.0);
/// // g · tan 45° would be 45° of bank: 10° after a second, and 30° at most.
/// assert!((bank.step(9.806_65, 1.0).to_degrees() - 10.0).abs() < 1e-9);
/// assert!((bank.step(9.806_65, 9.0).to_degrees() - 30.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct BankCommand {
    most_rad: f64,
    rate: RateLimit,
}

impl BankCommand {
    /// With the largest bank in rad, below π/2, and its largest rate in rad/s.
    pub const fn new(most_rad: f64, rate_radps: f64) -> Self {
        Self {
            most_rad,
            rate: RateLimit::new(rate_radps),
        }
    }

    /// Begins with the present bank, rad.
    pub const fn reset(&mut self, bank_rad: f64) {
        self.rate.reset(bank_rad);
    }

    /// The bank, rad, positive to the right, for an acceleration to the right of the
    /// air velocity, m/s², `dt_s` seconds after the last one.
    pub fn step(&mut self, acceleration_mps2: f64, dt_s: f64) -> f64 {
        let bank = atan(acceleration_mps2 / GRAVITY_MPS2);
        self.rate
            .step(bank.clamp(-self.most_rad, self.most_rad), dt_s)
    }
}
