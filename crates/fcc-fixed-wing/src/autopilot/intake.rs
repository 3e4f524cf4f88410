//! What has arrived: the last plausible measurements, the plant's clock, and the ages of
//! readings.

use core::time::Duration;

use super::plant_clock::{PlantClock, Waiting};
use super::reading_age::ReadingAges;
use super::whereabouts::Whereabouts;
use super::{AutopilotConfig, flags};
use fcc_core::flight::{Measurements, PlantState};
use fcc_core::framework::{Flags, Time};
use fcc_navigation::{Quantities, ReturningAltitude};

/// Longer than this after its readings are too old, nothing is sent to a silent
/// plant: it has the outputs, and would have to take all that wait for it at
/// once when it continues, perhaps with another aircraft.
const SENT_FOR: Duration = Duration::from_millis(250);
/// The greatest delay of all readings that was flown with a Cessna 172 at 73 and
/// 100 kt: 250 ms and a period of 25 ms. A slower aircraft stands more in
/// proportion.
const FLYABLE: Duration = Duration::from_millis(275);

/// What has arrived.
#[derive(Clone, Debug)]
pub(super) struct Intake {
    /// The last plausible measurements.
    pub(super) accepted: Measurements,
    pub(super) clock: PlantClock,
    pub(super) ages: ReadingAges,
    pub(super) whereabouts: Whereabouts,
    /// The previous tick.
    pub(super) before: Time,
    /// For how long of the plant's time all that control needs has been good, s;
    /// none while it is not.
    pub(super) settled_s: Option<f64>,
    /// When a plant that was not heard returned, until all that control needs
    /// has been measured since.
    pub(super) renewed_since: Time,
    /// The quantities that were rejected as implausible in this failsafe.
    pub(super) rejected_by_gate: Quantities,
    pub(super) returning_altitude: ReturningAltitude,
}

impl Intake {
    pub(super) fn new() -> Self {
        Self {
            accepted: Measurements::default(),
            clock: PlantClock::default(),
            ages: ReadingAges::default(),
            whereabouts: Whereabouts::default(),
            before: Time::NEVER,
            settled_s: None,
            renewed_since: Time::NEVER,
            rejected_by_gate: Quantities::NONE,
            returning_altitude: ReturningAltitude::default(),
        }
    }

    /// Follows the ages of a tick's readings.
    pub(super) fn follow_ages(
        &mut self,
        config: &AutopilotConfig,
        now: Time,
        measured: &Measurements,
    ) {
        let judged = self.clock.judged();
        let flyable = FLYABLE.div_f64(config.pace.clamp(0.1, 1.0));
        let (max_age, dt_s) = (config.max_age.min(flyable), self.clock.step_s());
        self.ages.step(now, judged, measured, max_age, dt_s);
    }

    /// Whether nothing has arrived from a simulated plant for longer than a
    /// reading may be old. A paused plant may be silent.
    pub(super) fn is_silent(&self, config: &AutopilotConfig, now: Time) -> bool {
        self.silence(now) > config.max_age
    }

    /// For how long a simulated plant that is not paused has been silent.
    pub(super) fn silence(&self, now: Time) -> Duration {
        if self.plant_is(PlantState::Paused) {
            Duration::ZERO
        } else {
            self.clock.silent_for(now)
        }
    }

    /// Whether this tick's outputs are not to be sent.
    pub(super) fn withholds(&self, config: &AutopilotConfig, now: Time) -> bool {
        self.clock.waiting() == Waiting::Replaying
            || self.clock.silent_for(now) > config.max_age + SENT_FOR
    }

    /// Why what was flown before must not be continued: the plant is no longer
    /// where it was.
    pub(super) fn is_elsewhere(&self) -> Flags {
        Flags::NONE
            .with(flags::PLANT_JUMPED, self.plant_is(PlantState::Jumped))
            .with(flags::PLANT_RELOADED, self.plant_is(PlantState::Reloaded))
    }

    pub(super) fn plant_is(&self, state: PlantState) -> bool {
        self.clock.state() == Some(state)
    }
}
