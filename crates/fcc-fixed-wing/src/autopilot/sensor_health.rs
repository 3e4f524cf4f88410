//! Whether the autopilot's readings can be used for control.

use core::time::Duration;

use super::future::is_from_the_future;
use super::{Autopilot, AutopilotConfig, flags, receiver, wrong_sensors};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Flags, Reading, Time};
use fcc_navigation::inertial::RawNavigation;
use fcc_navigation::{Quantities, Quantity};

/// A switch that was read before and is silent for longer than this counts as
/// lost, since it could not be switched off.
const SWITCH_MAX_AGE: Duration = Duration::from_secs(1);

/// For how long a simulated plant is waited for: one that is silent, or whose
/// time stands still although it sends and is not paused.
fn longest_silence(config: &AutopilotConfig) -> Duration {
    config.max_silence.max(config.max_age)
}

impl Autopilot {
    /// Reports what the plant's clock shows, and the sensors that are not used any more, or
    /// otherwise than before, since this tick.
    pub(super) fn report_clock_and_sensors(&mut self) {
        let by_clock = self.intake.clock.notice();
        let raw = self.estimator.raw.as_ref();
        let events = [
            by_clock,
            raw.and_then(RawNavigation::wrong_sensor)
                .map(wrong_sensors::notice),
            raw.and_then(RawNavigation::refuses_velocity)
                .map(receiver::velocity),
        ];
        events
            .into_iter()
            .flatten()
            .for_each(|event| self.journal.add(event));
    }

    /// The needed quantities whose readings are too old to be used; all of them
    /// while a simulated plant is silent.
    pub(super) fn stale(&self, now: Time) -> Quantities {
        if self.intake.is_silent(&self.config, now) {
            Quantities::ALL
        } else {
            self.too_old(&self.intake.accepted)
        }
    }

    /// The frozen quantities; none on the ground: with an airspeed below the
    /// floor, and not engaged. A glide may be slower.
    pub(super) fn frozen(&self) -> Quantities {
        let airspeed_mps = self.estimator.estimate().airspeed_mps;
        let is_slow = airspeed_mps < self.config.envelope.min_airspeed_mps;
        if is_slow && (!self.supervisor.pilot.is_engaged() || self.is_on_runway()) {
            Quantities::NONE
        } else {
            let is_excluded = self.estimator.navigation.airspeed_doubt().is_some();
            let frozen = self.estimator.frozen.frozen();
            frozen.keeping(Quantity::Airspeed, !is_excluded)
        }
    }

    /// The readings that are too old, by the plant's time. Of a doubted sensor
    /// none is used: the airspeed and, for a time, the altitude are known without.
    pub(super) fn too_old(&self, measurements: &Measurements) -> Quantities {
        let judged = self.intake.clock.judged();
        let knows_attitude = self.estimator.knows_attitude();
        let by_gyroscopes = Quantities::NONE
            .with(Quantity::BodyRates, self.estimator.doubts_gyroscopes())
            .with(Quantity::Attitude, !knows_attitude)
            .with(Quantity::Heading, !knows_attitude);
        Quantity::ALL
            .into_iter()
            .fold(by_gyroscopes, |old, quantity| {
                let reading = Reading::new((), quantity.taken(measurements));
                let is_known = match quantity {
                    Quantity::Airspeed => self
                        .estimator
                        .navigation
                        .airspeed_doubt()
                        .map(|_| true)
                        .or_else(|| self.knows_airspeed_by_forces()),
                    Quantity::Altitude => self.estimator.navigation.altitude_doubt(),
                    _ => None,
                };
                let is_fresh = || {
                    reading.is_fresh(judged, self.config.max_age)
                        && !self.intake.ages.late().contains(quantity)
                };
                old.with(quantity, !is_known.unwrap_or_else(is_fresh))
            })
    }

    /// The quantities rejected as implausible for so long that the accepted
    /// readings are too old although the raw ones are not.
    pub(super) fn rejected(&self, measurements: &Measurements) -> Quantities {
        self.too_old(&self.intake.accepted) & !self.too_old(measurements)
    }

    /// The faults of an engaged flight, and what comes and goes in a failsafe.
    pub(super) fn unsafe_to_fly(&self, now: Time, measurements: &Measurements) -> Flags {
        self.unsafe_now(now, measurements) | flags::too_old(self.supervisor.degraded.intermittent())
    }

    /// The faults of this tick. A silent plant is waited for.
    pub(super) fn unsafe_now(&self, now: Time, measurements: &Measurements) -> Flags {
        let lost = self.intake.silence(now) > longest_silence(&self.config);
        let stale = if lost {
            Quantities::ALL
        } else {
            self.too_old(&self.intake.accepted)
        };
        self.unsafe_with(stale, now, measurements)
            .with(flags::PLANT_SILENT, lost)
    }

    /// What prevents both engaging and staying engaged, with these readings too
    /// old.
    pub(super) fn unsafe_with(
        &self,
        stale: Quantities,
        now: Time,
        measurements: &Measurements,
    ) -> Flags {
        let switch = self.intake.accepted.engage_switch;
        let rejected = !self.rejected(measurements).is_empty();
        let is_lost_to_the_future = !stale.is_empty() && is_from_the_future(measurements, now);
        let is_lost_on_the_way = !stale.is_empty() && !self.intake.ages.late().is_empty();
        let unusable = flags::too_old(stale) | flags::frozen(self.frozen());
        (unusable | self.intake.is_elsewhere() | self.estimator.doubted_motion())
            .with(flags::DOUBTED_GYROSCOPE, self.estimator.doubts_gyroscopes())
            .with(flags::REJECTED, rejected)
            .with(flags::FROM_THE_FUTURE, is_lost_to_the_future)
            .with(flags::SOURCE_CLOCK, is_lost_on_the_way)
            .with(
                flags::PLANT_STALLED,
                self.intake.clock.is_ignored()
                    || self.intake.clock.stopped_for(now) > longest_silence(&self.config),
            )
            .with(
                flags::ENGAGE_SWITCH,
                !switch.is_never() && !switch.is_fresh(self.intake.clock.judged(), SWITCH_MAX_AGE),
            )
    }
}
