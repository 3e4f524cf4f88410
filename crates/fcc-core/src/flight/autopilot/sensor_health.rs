//! Whether the autopilot's readings can be used for control.

use core::time::Duration;

use super::future::is_from_the_future;
use super::plant_clock::Waiting;
use super::reading_age::taken_of_needed;
use super::{Autopilot, flags, receiver, wrong_sensors};
use crate::flight::inertial::RawNavigation;
use crate::flight::navigation::is_possible_fix;
use crate::flight::{Measurements, PlantState};
use crate::framework::{Flags, Notice, Reading, Time};

/// A switch that was read before and is silent for longer than this counts as
/// lost, since it could not be switched off.
const SWITCH_MAX_AGE: Duration = Duration::from_secs(1);

/// Longer than this after its readings are too old, nothing is sent to a silent
/// plant: it has the outputs, and would have to take all that wait for it at
/// once when it continues, perhaps with another aircraft.
const SENT_FOR: Duration = Duration::from_millis(250);

impl Autopilot {
    /// The measurements of this tick, as they are flown by.
    pub(super) fn seen<'a>(&'a self, measured: &'a Measurements) -> &'a Measurements {
        self.raw.as_ref().map_or(measured, RawNavigation::found)
    }

    /// The raw sensors that are not used, and that control does not need.
    pub(super) fn unused_sensors(&self, measured: &Measurements) -> Flags {
        let has_fix = !measured.gnss.is_never();
        let is = |what: fn(&RawNavigation) -> bool| self.raw.as_ref().is_some_and(what);
        Flags::NONE
            .with(
                flags::IMPOSSIBLE_FIX,
                has_fix && !is_possible_fix(&measured.gnss.value),
            )
            .with(flags::REPEATED_FIX, is(RawNavigation::repeats_place))
            .with(flags::REPEATED_FIELD, is(RawNavigation::repeats_field))
            .with(flags::LEFT_UNIT, is(RawNavigation::left_a_unit))
            .with(flags::WRONG_SENSOR, is(RawNavigation::has_wrong_sensor))
    }

    /// The notice of a sensor that is not used any more, or otherwise than before, since this
    /// tick.
    pub(super) fn wrong_sensor_notice(&self) -> Option<Notice> {
        let raw = self.raw.as_ref()?;
        let wrong = raw.wrong_sensor().map(wrong_sensors::notice);
        wrong.or_else(|| raw.refuses_velocity().map(receiver::velocity))
    }

    /// What is told in this tick and in no other.
    pub(super) fn urgent_notice(&self) -> Option<Notice> {
        // The sender of a command waits for it.
        self.answered
            .or_else(|| self.pilot.notice())
            .or_else(|| self.clock.notice())
            .or_else(|| self.degraded_notice())
            .or_else(|| self.wrong_sensor_notice())
            .or(self.doubt_notice)
    }

    /// Whether the gyroscopes are not flown by, because the magnetic field contradicts them;
    /// not by the attitude either until it is known which of the two is wrong: an aircraft
    /// that follows wrong gyroscopes rolls over meanwhile.
    pub(super) fn doubts_gyroscopes(&self) -> bool {
        self.raw
            .as_ref()
            .is_some_and(|raw| raw.doubts_gyroscopes() || raw.questions_gyroscopes())
    }

    /// Whether what comes from raw sensors has an attitude, if it is flown by them.
    pub(super) fn knows_attitude(&self) -> bool {
        self.raw
            .as_ref()
            .is_none_or(|raw| raw.knows_attitude() && !raw.questions_gyroscopes())
    }

    /// The needed quantities whose readings are too old to be used; all of them
    /// while a simulated plant is silent.
    pub(super) fn stale(&self, now: Time) -> Flags {
        if self.is_silent(now) {
            flags::NEEDED
        } else {
            self.too_old(&self.accepted)
        }
    }

    /// Whether nothing has arrived from a simulated plant for longer than a
    /// reading may be old. A paused plant may be silent.
    pub(super) fn is_silent(&self, now: Time) -> bool {
        self.silence(now) > self.config.max_age
    }

    /// For how long a simulated plant is waited for: one that is silent, or whose
    /// time stands still although it sends and is not paused.
    fn max_silence(&self) -> Duration {
        self.config.max_silence.max(self.config.max_age)
    }

    /// For how long a simulated plant that is not paused has been silent.
    fn silence(&self, now: Time) -> Duration {
        if self.plant_is(PlantState::Paused) {
            Duration::ZERO
        } else {
            self.clock.silent_for(now)
        }
    }

    /// Whether this tick's outputs are not to be sent.
    pub(super) fn withholds(&self, now: Time) -> bool {
        self.clock.waiting() == Waiting::Replaying
            || self.clock.silent_for(now) > self.config.max_age + SENT_FOR
    }

    /// The frozen quantities; none on the ground: with an airspeed below the
    /// floor, and not engaged. A glide may be slower.
    pub(super) fn frozen(&self) -> Flags {
        let airspeed_mps = self.navigation.estimate().airspeed_mps;
        let is_slow = airspeed_mps < self.config.envelope.min_airspeed_mps;
        if is_slow && (!self.pilot.is_engaged() || self.is_on_runway()) {
            Flags::NONE
        } else {
            flags::frozen(self.frozen.frozen()).keeping(
                flags::FROZEN_AIRSPEED,
                !self.doubted().contains(flags::DOUBTED_AIRSPEED),
            )
        }
    }

    /// The readings that are too old, by the plant's time. Of a doubted sensor
    /// none is used: the airspeed and, for a time, the altitude are known without.
    pub(super) fn too_old(&self, measurements: &Measurements) -> Flags {
        let judged = self.clock.judged();
        let taken = taken_of_needed(measurements);
        let by_gyroscopes = Flags::NONE
            .with(flags::BODY_RATES, self.doubts_gyroscopes())
            .with(flags::ATTITUDE | flags::HEADING, !self.knows_attitude());
        taken.into_iter().fold(by_gyroscopes, |old, (flag, taken)| {
            let reading = Reading::new((), taken);
            let is_known = match flag {
                flags::AIRSPEED => self
                    .navigation
                    .airspeed_doubt()
                    .map(|_| true)
                    .or_else(|| self.knows_airspeed_by_forces()),
                flags::ALTITUDE => self.navigation.altitude_doubt(),
                _ => None,
            };
            let is_fresh = || {
                reading.is_fresh(judged, self.config.max_age) && !self.ages.late().contains(flag)
            };
            old.with(flag, !is_known.unwrap_or_else(is_fresh))
        })
    }

    /// The quantities rejected as implausible for so long that the accepted
    /// readings are too old although the raw ones are not.
    pub(super) fn rejected(&self, measurements: &Measurements) -> Flags {
        let raw = self.too_old(measurements);
        Flags::from_bits(self.too_old(&self.accepted).bits() & !raw.bits())
    }

    /// The faults of an engaged flight, and what comes and goes in a failsafe.
    pub(super) fn unsafe_to_fly(&self, now: Time, measurements: &Measurements) -> Flags {
        self.unsafe_now(now, measurements) | self.intermittent()
    }

    /// The faults of this tick. A silent plant is waited for.
    pub(super) fn unsafe_now(&self, now: Time, measurements: &Measurements) -> Flags {
        let lost = self.silence(now) > self.max_silence();
        let stale = if lost {
            flags::NEEDED | flags::PLANT_SILENT
        } else {
            self.too_old(&self.accepted)
        };
        self.unsafe_with(stale, now, measurements)
    }

    /// What prevents both engaging and staying engaged, with these readings too
    /// old.
    pub(super) fn unsafe_with(
        &self,
        stale: Flags,
        now: Time,
        measurements: &Measurements,
    ) -> Flags {
        let switch = self.accepted.engage_switch;
        let rejected = !self.rejected(measurements).is_empty();
        let is_lost_to_the_future = !stale.is_empty() && is_from_the_future(measurements, now);
        let is_lost_on_the_way = !stale.is_empty() && !self.ages.late().is_empty();
        (stale | self.frozen() | self.is_elsewhere() | self.doubted_motion())
            .with(flags::DOUBTED_GYROSCOPE, self.doubts_gyroscopes())
            .with(flags::REJECTED, rejected)
            .with(flags::FROM_THE_FUTURE, is_lost_to_the_future)
            .with(flags::SOURCE_CLOCK, is_lost_on_the_way)
            .with(
                flags::PLANT_STALLED,
                self.clock.is_ignored() || self.clock.stopped_for(now) > self.max_silence(),
            )
            .with(
                flags::ENGAGE_SWITCH,
                !switch.is_never() && !switch.is_fresh(self.clock.judged(), SWITCH_MAX_AGE),
            )
    }

    /// Why what was flown before must not be continued: the plant is no longer
    /// where it was.
    pub(super) fn is_elsewhere(&self) -> Flags {
        Flags::NONE
            .with(flags::PLANT_JUMPED, self.plant_is(PlantState::Jumped))
            .with(flags::PLANT_RELOADED, self.plant_is(PlantState::Reloaded))
            .with(flags::RELOCATED, self.whereabouts.was_relocated())
    }

    pub(super) fn plant_is(&self, state: PlantState) -> bool {
        self.clock.state() == Some(state)
    }
}
