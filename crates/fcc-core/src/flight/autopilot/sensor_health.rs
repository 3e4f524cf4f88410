//! Whether the autopilot's readings can be used for control.

use core::time::Duration;

use super::{Autopilot, flags};
use crate::flight::{Measurements, PlantState};
use crate::framework::{Flags, Reading, Time};

/// A switch that was read before and is silent for longer than this counts as
/// lost, since it could not be switched off.
const SWITCH_MAX_AGE: Duration = Duration::from_secs(1);

impl Autopilot {
    pub(super) fn stale(&self, now: Time) -> Flags {
        self.too_old(&self.accepted, now)
    }

    /// The frozen quantities; none while the airspeed is below the floor.
    pub(super) fn frozen(&self) -> Flags {
        if self.navigation.estimate().airspeed_mps < self.config.envelope.min_airspeed_mps {
            Flags::NONE
        } else {
            flags::frozen(self.frozen.frozen())
        }
    }

    fn too_old(&self, measurements: &Measurements, now: Time) -> Flags {
        let taken = [
            (flags::ATTITUDE, measurements.attitude.taken),
            (flags::HEADING, measurements.heading_rad.taken),
            (flags::BODY_RATES, measurements.body_rates.taken),
            (flags::SPECIFIC_FORCE, measurements.specific_force.taken),
            (flags::AIRSPEED, measurements.airspeed_mps.taken),
            (flags::ALTITUDE, measurements.altitude_m.taken),
        ];
        taken.into_iter().fold(Flags::NONE, |old, (flag, taken)| {
            let reading = Reading::new((), taken);
            old.with(flag, !reading.is_fresh(now, self.config.max_age))
        })
    }

    /// The faults that prevent both engaging and staying engaged.
    pub(super) fn unsafe_to_fly(&self, now: Time, measurements: &Measurements) -> Flags {
        let switch = self.accepted.engage_switch;
        let stale = self.stale(now);
        // The raw readings that are not too old although the accepted ones are:
        // these were rejected as implausible.
        let rejected = stale != self.too_old(measurements, now);
        (stale | self.frozen())
            .with(flags::REJECTED, rejected)
            .with(flags::PLANT_JUMPED, self.plant_is(PlantState::Jumped))
            .with(flags::PLANT_STALLED, self.clock.is_stalled())
            .with(
                flags::ENGAGE_SWITCH,
                !switch.is_never() && !switch.is_fresh(now, SWITCH_MAX_AGE),
            )
    }

    pub(super) fn plant_is(&self, state: PlantState) -> bool {
        !self.accepted.plant.is_never() && self.accepted.plant.value.state == state
    }
}
