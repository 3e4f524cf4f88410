//! What has arrived: the last plausible measurements, the plant's clock, and the ages of
//! readings.

use super::plant_clock::PlantClock;
use super::reading_age::ReadingAges;
use super::whereabouts::Whereabouts;
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;
use fcc_navigation::{Quantities, ReturningAltitude};

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
    pub(super) distrusted: Quantities,
    pub(super) returning_altitude: ReturningAltitude,
}

impl Intake {
    /// Before the first tick.
    pub(super) fn new() -> Self {
        Self {
            accepted: Measurements::default(),
            clock: PlantClock::default(),
            ages: ReadingAges::default(),
            whereabouts: Whereabouts::default(),
            before: Time::NEVER,
            settled_s: None,
            renewed_since: Time::NEVER,
            distrusted: Quantities::NONE,
            returning_altitude: ReturningAltitude::default(),
        }
    }
}
