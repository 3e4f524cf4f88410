//! Whether the aircraft is where it can have flown to.
//!
//! A simulated aircraft can be moved: by its user, by a loaded flight, while a
//! replay or a map is shown. What was flown before must not be continued there.

use libm::{cos, sqrt};

use super::plant_clock::MAX_STEP_S;
use fcc_core::blocks::wrap_pi;
use fcc_core::flight::{Attitude, Measurements, Position};
use fcc_core::framework::{Reading, Time};
use fcc_navigation::{HEIGHT_M, PlausibilityLimit, is_possible_altitude};

/// The Earth's mean radius, m (WGS 84: 6,371,009 m).
const EARTH_M: f64 = 6_371_009.0;

/// Three seconds of a light aircraft's flight, for positions that arrive late,
/// and the speed of sound with a jet stream from behind.
const POSITION_M: PlausibilityLimit = PlausibilityLimit {
    at_once: 150.0,
    per_s: 450.0,
};
/// An aircraft whose clock has stopped moves if it has changed by more than
/// this: five times the noise of a phone's sensors.
const STILL_RAD: f64 = 0.052; // 3°
const STILL_ALTITUDE_M: f64 = 8.0;
const STILL_POSITION_M: f64 = 30.0;

/// What a network held back in a gap may come in several ticks, s.
const HELD_BACK_S: f64 = 0.5;

/// Whether an aircraft can have flown to a place from `before` in this time: 150 m,
/// three seconds of a light aircraft's flight, for positions that arrive late, and
/// 450 m/s, the speed of sound with a jet stream from behind. False if either is no
/// position on the Earth.
///
/// ```
/// use fcc_core::flight::Position;
/// use fcc_fixed_wing::can_be_reached;
///
/// let milwaukee = Position { latitude_rad: 0.749, longitude_rad: -1.534, altitude_m: 900.0 };
/// let mile = Position { latitude_rad: 0.749 + 1_852.0 / 6_371_009.0, ..milwaukee };
/// assert!(!can_be_reached(&mile, &milwaukee, 3.0));
/// assert!(can_be_reached(&mile, &milwaukee, 4.0));
/// ```
pub fn can_be_reached(place: &Position, before: &Position, passed_s: f64) -> bool {
    before.is_on_earth()
        && place.is_on_earth()
        && POSITION_M.holds_over(distance_m(before, place), passed_s)
}

/// The place and attitude of the aircraft when the plant's time last advanced,
/// and its last known position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Whereabouts {
    attitude: Reading<Attitude>,
    heading_rad: Reading<f64>,
    altitude_m: Reading<f64>,
    /// The plant's time since that altitude, s.
    altitude_passed_s: f64,
    position: Reading<Position>,
    /// The plant's time since that position, s.
    passed_s: f64,
    /// The newest readings that were examined, or skipped.
    seen: Time,
    /// The last gap, s, and the plant's time since: a position that is older than its end
    /// may come a little later.
    gap_s: f64,
    since_gap_s: f64,
    /// A position that is out of reach, until the next one confirms it.
    doubtful: Option<Position>,
    was_relocated: bool,
}

impl Whereabouts {
    /// Follows the aircraft in a tick in which `passed_s` of the plant's time
    /// passed. After a long gap the altitude is compared, too; a coarse altimeter
    /// changes it by `altitude_step_m` at once. A satellite receiver's position,
    /// `by_receiver`, may jump by itself.
    pub(super) fn step(
        &mut self,
        measured: &Measurements,
        passed_s: f64,
        after_gap: bool,
        by_receiver: bool,
        altitude_step_m: f64,
    ) {
        self.altitude_passed_s += passed_s;
        self.was_relocated = after_gap && self.is_out_of_reach(measured, altitude_step_m);
        self.passed_s += passed_s;
        if passed_s > MAX_STEP_S {
            self.gap_s += passed_s;
            self.since_gap_s = 0.0;
        } else {
            self.since_gap_s += passed_s;
            if self.since_gap_s > HELD_BACK_S {
                self.gap_s = 0.0;
            }
        }
        let new = measured.position;
        if by_receiver || new.taken <= self.seen || !new.value.is_on_earth() {
            return;
        }
        self.seen = new.taken;
        let is_first = self.position.is_never() || new.source != self.position.source;
        let is_near = |to: &Position| can_be_reached(&new.value, to, self.passed_s + self.gap_s);
        if is_first || is_near(&self.position.value) {
            self.doubtful = None;
        } else if self.doubtful.as_ref().is_some_and(is_near) {
            self.doubtful = None;
            self.was_relocated = true;
        } else {
            // One position may be wrong.
            self.doubtful = Some(new.value);
            return;
        }
        self.position = new;
        self.passed_s = 0.0;
    }

    /// Skips what was measured up to a tick: it is not the aircraft's state.
    pub(super) const fn skip(&mut self, until: Time) {
        self.seen = until;
    }

    /// Stores where the aircraft is while its time advances.
    pub(super) fn keep(&mut self, accepted: &Measurements) {
        self.attitude = accepted.attitude;
        self.heading_rad = accepted.heading_rad;
        if accepted.altitude_m.taken > self.altitude_m.taken {
            self.altitude_passed_s = 0.0;
        }
        self.altitude_m = accepted.altitude_m;
    }

    /// Whether the aircraft was moved, as found in this tick.
    pub(super) const fn was_relocated(&self) -> bool {
        self.was_relocated
    }

    /// Whether the aircraft moves although the plant's time does not advance.
    pub(super) fn is_left(&self, measured: &Measurements) -> bool {
        let (was, is) = (self.attitude.value, measured.attitude.value);
        let turned = [
            wrap_pi(is.roll_rad - was.roll_rad),
            is.pitch_rad - was.pitch_rad,
            wrap_pi(measured.heading_rad.value - self.heading_rad.value),
        ];
        let climbed_m = measured.altitude_m.value - self.altitude_m.value;
        let moved_m = if self.position.is_never() {
            0.0
        } else {
            distance_m(&self.position.value, &measured.position.value)
        };
        turned.iter().any(|angle| angle.abs() > STILL_RAD)
            || climbed_m.abs() > STILL_ALTITUDE_M
            || moved_m > STILL_POSITION_M
    }

    /// Whether the altitude is new and out of reach.
    fn is_out_of_reach(&self, measured: &Measurements, altitude_step_m: f64) -> bool {
        let (was, is) = (self.altitude_m, measured.altitude_m);
        let is_new = !was.is_never() && is.taken > was.taken && is.taken > self.seen;
        let beyond_m = ((is.value - was.value).abs() - altitude_step_m).max(0.0);
        is_new
            && is_possible_altitude(is.value)
            && !HEIGHT_M.holds_over(beyond_m, self.altitude_passed_s)
    }
}

/// The distance over the ground of two positions, m; on a flat Earth, which is
/// accurate for short ones, and long for long ones.
fn distance_m(from: &Position, to: &Position) -> f64 {
    let north_m = EARTH_M * (to.latitude_rad - from.latitude_rad);
    let east_m = EARTH_M * wrap_pi(to.longitude_rad - from.longitude_rad) * cos(from.latitude_rad);
    sqrt(north_m * north_m + east_m * east_m)
}
