//! What is reported in flight, and is mostly a reason not to engage.

use super::future::is_from_the_future;
use super::{Autopilot, flags};
use fcc_core::flight::{Measurements, PlantState};
use fcc_core::framework::{Flags, Time};

impl Autopilot {
    /// The conditions that are reported while engaged, and prevent engaging.
    pub(super) fn external(&self, now: Time, measurements: &Measurements) -> Flags {
        Flags::NONE
            .with(
                flags::OTHER_AUTOPILOT,
                measurements.other_control.value.autopilot,
            )
            .with(flags::PLANT_FAST, self.intake.plant_is(PlantState::Fast))
            .with(flags::PLANT_STALLED, self.intake.clock.has_stopped())
            .with(flags::SOURCE_CLOCK, !self.intake.ages.late().is_empty())
            .with(flags::NOT_FOLLOWED, self.supervisor.following.is_lost())
            .with(flags::DEGRADED, self.supervisor.degraded.flies_without())
            .with(
                flags::FROM_THE_FUTURE,
                is_from_the_future(measurements, now),
            )
    }
}
