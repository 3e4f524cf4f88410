//! What else acts on the aircraft, and what its source contradicts: reported in
//! flight, and mostly a reason not to engage.

use super::future::is_from_the_future;
use super::{Autopilot, flags};
use fcc_core::flight::{Measurements, PlantState};
use fcc_core::framework::{Flags, Time};
use fcc_navigation::airspeed_is_suspect;

/// Reported, but no reason not to engage: many aircraft have a yaw damper that
/// is always on, and are flown through it.
const HARMLESS: Flags = flags::STABILITY;

/// Neither can be flown: an unknown airspeed, and thrust that acts the other
/// way round.
const NOT_FLYABLE: Flags =
    Flags::from_bits(flags::SUSPECT_AIRSPEED.bits() | flags::REVERSE_THRUST.bits());

impl Autopilot {
    /// The conditions that are reported while engaged.
    pub(super) fn external(&self, now: Time, measurements: &Measurements) -> Flags {
        let other = measurements.other_control.value;
        Flags::NONE
            .with(flags::OTHER_AUTOPILOT, other.autopilot)
            .with(flags::OTHER_AUTOTHROTTLE, other.autothrottle)
            .with(flags::FLY_BY_WIRE, other.fly_by_wire)
            .with(flags::STABILITY, other.stability)
            .with(flags::OTHER_WRITER, other.writer)
            .with(flags::REVERSE_THRUST, other.reverse_thrust)
            .with(flags::PLANT_FAST, self.intake.plant_is(PlantState::Fast))
            .with(
                flags::SUSPECT_AIRSPEED,
                airspeed_is_suspect(measurements)
                    && self.estimator.navigation.airspeed_doubt().is_none(),
            )
            .with(flags::PLANT_STALLED, self.intake.clock.has_stopped())
            .with(flags::SOURCE_CLOCK, !self.intake.ages.late().is_empty())
            .with(flags::NOT_FOLLOWED, self.supervisor.following.is_lost())
            .with(flags::DEGRADED, self.supervisor.degraded.flies_without())
            .with(
                flags::FROM_THE_FUTURE,
                is_from_the_future(measurements, now),
            )
    }

    /// Those that prevent engaging.
    pub(super) fn not_permitted(&self, now: Time, measurements: &Measurements) -> Flags {
        let allowed = HARMLESS | self.config.permitted;
        Flags::from_bits(self.external(now, measurements).bits() & !allowed.bits())
    }

    /// Those that end a flight.
    pub(super) fn not_flyable(&self, now: Time, measurements: &Measurements) -> Flags {
        Flags::from_bits(self.external(now, measurements).bits() & NOT_FLYABLE.bits())
    }
}
