//! Why a sensor of airspeed is excluded.

use fcc_core::flight::atmosphere::SEA_LEVEL_DENSITY_KGPM3;
use fcc_core::units::GRAVITY_MPS2;

/// The height that tells a blocked tube from other faults, m, and the part of
/// the expected change that must be seen, both ways.
const TELLING_M: f64 = 8.0;
const SEEN: core::ops::RangeInclusive<f64> = 0.6..=1.6;

/// What is wrong with an excluded airspeed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DoubtReason {
    /// It rises with height as an altimeter does: the total pressure is
    /// trapped, so its dynamic pressure changes by -dp = ρ g dh (FAA-H-8083-15B,
    /// chapter 5, blocked pitot tube and drain).
    BlockedTube,
    /// It contradicts the speed over the ground in a take-off.
    Ground,
    /// It is too high.
    TooHigh,
    /// It is too low.
    TooLow,
}

/// An excluded sensor of airspeed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Doubt {
    /// The number of the sensor.
    pub source: u8,
    /// Why.
    pub reason: DoubtReason,
}

/// Altitude and airspeed when the sensor last agreed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference(Option<(f64, f64)>);

impl Reference {
    pub(super) const NONE: Self = Self(None);

    pub(super) const fn new(altitude_m: f64, airspeed_mps: f64) -> Self {
        Self(Some((altitude_m, airspeed_mps)))
    }

    /// The reason, with the density over that at sea level and the sensor's
    /// difference.
    pub(super) fn reason(
        self,
        altitude_m: f64,
        airspeed_mps: f64,
        density_ratio: f64,
        differs_mps: f64,
    ) -> DoubtReason {
        if let Self(Some((before_m, before_mps))) = self {
            let climbed_m = altitude_m - before_m;
            let rose_pa = 0.5
                * SEA_LEVEL_DENSITY_KGPM3
                * (airspeed_mps * airspeed_mps - before_mps * before_mps);
            let trapped_pa = SEA_LEVEL_DENSITY_KGPM3 * density_ratio * GRAVITY_MPS2 * climbed_m;
            if climbed_m.abs() > TELLING_M && SEEN.contains(&(rose_pa / trapped_pa)) {
                return DoubtReason::BlockedTube;
            }
        }
        if differs_mps > 0.0 {
            DoubtReason::TooHigh
        } else {
            DoubtReason::TooLow
        }
    }
}
