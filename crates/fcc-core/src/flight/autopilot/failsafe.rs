//! The outputs of the failsafe.

use super::{Autopilot, flags};
use crate::flight::{BodyRates, Measurements, Surfaces};
use crate::framework::Time;

/// The trims that the loops had found when the body rates last changed: with
/// rates that no longer change, the loops' integrals run away.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeptTrims {
    pub(super) found_with: BodyRates,
    trims: Surfaces,
}

impl Autopilot {
    /// Keeps the present trims.
    pub(super) fn keep_trims(&mut self) {
        self.kept_trims = KeptTrims {
            found_with: self.accepted.body_rates.value,
            trims: self.trims(),
        };
    }

    /// Wings level while the attitude is known, level flight while the climb
    /// rate is; otherwise the trims that the loops had found; trim throttle,
    /// idle while thrust is reversed. A silent plant keeps its throttle: it may
    /// return with another aircraft. What was rejected as implausible is not
    /// believed again while the failsafe lasts, however long it is repeated.
    pub(super) fn safest(&mut self, now: Time, measured: &Measurements) -> Surfaces {
        self.distrusted |= self.rejected(measured);
        let frozen = self.frozen();
        let unusable = flags::unusable(self.stale(now), frozen);
        self.setpoints.roll_rad = 0.0;
        self.setpoints.climb_rate_mps = 0.0;
        let throttle = if self.is_silent(now) {
            self.last.throttle
        } else if measured.other_control.value.reverse_thrust {
            0.0
        } else {
            self.config.airspeed.trim_throttle
        };
        if unusable.intersects(flags::ATTITUDE | flags::BODY_RATES) {
            self.setpoints.pitch_rad = 0.0;
            let trims = if frozen.contains(flags::FROZEN_BODY_RATES) {
                self.kept_trims.trims
            } else {
                self.trims()
            };
            return Surfaces { throttle, ..trims };
        }
        let mut estimate = *self.navigation.estimate();
        if unusable.contains(flags::SPECIFIC_FORCE) {
            estimate.side_force_mps2 = 0.0;
        }
        let (schedule, dt_s) = (self.schedule(), self.clock.step_s());
        let envelope = self.config.envelope;
        let lateral = self.heading.hold_bank(0.0, &estimate, schedule, dt_s);
        let vertical = if unusable.intersects(flags::ALTITUDE | flags::SPECIFIC_FORCE) {
            self.altitude
                .hold_level_pitch(&estimate, &envelope, schedule, dt_s)
        } else {
            self.altitude
                .hold_climb_rate(0.0, &estimate, &envelope, schedule, dt_s)
        };
        self.setpoints.climb_rate_mps = vertical.climb_rate_mps;
        self.setpoints.pitch_rad = vertical.pitch_rad;
        Surfaces {
            throttle,
            elevator: vertical.elevator,
            aileron: lateral.aileron,
            rudder: lateral.rudder,
        }
    }

    /// The trims that the loops have found, and the last throttle: an aircraft
    /// that is not measured does not roll on.
    pub(super) fn trims(&self) -> Surfaces {
        Surfaces {
            throttle: self.last.throttle,
            elevator: self.altitude.trim(),
            aileron: self.heading.aileron_trim(),
            rudder: self.heading.rudder_trim(),
        }
    }
}
