//! The floor: an altitude below which nothing that is flown leads.
//!
//! It limits the target altitude, whether that was captured, commanded, restored
//! or is part of a pattern: a descent is captured a margin above the floor, and
//! engaged below it, the aircraft climbs to it. A failsafe that holds no climb,
//! or a pitch, climbs to it as well. Speed comes before it: an aircraft without
//! the power to hold its altitude descends, and a glide without a pilot, too.

use super::Autopilot;
use crate::flight::AltitudeReference;

/// A target this far below the lowest altitude is not limited by it, m: a round
/// altitude in feet is not round in metres.
const ROUNDING_M: f64 = 0.01;

/// How much a failsafe that keeps the altitude by pitch loses in turbulence
/// (`docs/envelope.md`, degraded flight), m: 100 ft.
const BY_PITCH_M: f64 = 30.5;

/// The climb rate of a failsafe per height below the lowest altitude, 1/s.
const GAIN_PER_S: f64 = 0.2;

impl Autopilot {
    /// The lowest pressure altitude that is flown to, m; minus infinity without a
    /// floor.
    fn lowest_m(&self) -> f64 {
        let lowest_m = self.config.envelope.lowest_altitude_m();
        lowest_m.map_or(f64::NEG_INFINITY, |lowest_m| {
            // At sea level there is always a datum.
            let datum_m = self.altimeter.datum_m(AltitudeReference::SeaLevel);
            lowest_m + datum_m.unwrap_or(0.0)
        })
    }

    /// Raises the target altitude to the lowest one.
    pub(super) fn keep_above_floor(&mut self) {
        let lowest_m = self.lowest_m();
        self.is_at_floor = self.targets.altitude_m < lowest_m - ROUNDING_M;
        self.targets.altitude_m = self.targets.altitude_m.max(lowest_m);
    }

    /// The altitude for a failsafe to keep by pitch, m: that at its beginning, or
    /// as much above the lowest one as it is kept worse.
    pub(super) fn kept_altitude_m(&self) -> f64 {
        self.degraded.altitude_m.max(self.lowest_m() + BY_PITCH_M)
    }

    /// The climb rate for a failsafe to hold, m/s: none, or that to the floor.
    pub(super) fn kept_climb_rate_mps(&self) -> f64 {
        let low_m = self.lowest_m() - self.navigation.estimate().altitude_m;
        (GAIN_PER_S * low_m).max(0.0)
    }
}
