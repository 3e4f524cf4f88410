//! Whether a receiver's velocities are those of its own positions.
//!
//! What its places have moved less the integral of its velocities is noise of the places if both
//! are right, and grows if one of them is wrong. A place that jumps does so once: of one fix no
//! more counts than what a wrong velocity makes.

use nalgebra::{Vector2, Vector3};

use super::motion::Motion;
use crate::inertial::GeodeticPosition;
use fcc_core::framework::Time;

/// What was longer ago, s, does not count, nor between fixes that are so far apart, s.
const FORGOTTEN_S: f64 = 4.0;
const APART_S: f64 = 1.5;
/// They contradict each other beyond the first distance, m, until they have been within the
/// second one for a time, s: velocities of which two parts are swapped are right for a moment
/// of a turn. A place of 1 m of white noise scatters by 2 m, and a velocity that is 0.2 s older than
/// its place is off by 5 m in a turn of 6 m/s².
const CONTRADICTS_M: f64 = 6.0;
const AGREES_M: f64 = 3.0;
const AGREED_S: f64 = 10.0;
/// Velocities that differ from what is believed are those that are wrong if the places have not
/// moved by this share of what they say, and by this, m: a place of white noise does that one
/// time in ten.
const AGAINST_SHARE: f64 = 0.5;
const AGAINST_M: f64 = 1.0;
/// The mean of a velocity is known to this share of what it changes by.
const BENT_SHARE: f64 = 0.25;
/// No velocity is wrong by more than this, m/s, nor is what is known of that more than this, m.
const MOST_MPS: f64 = 25.0;
const MOST_M: f64 = 20.0;

/// Places and velocities of the latest seconds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Displacement {
    place: Option<(Time, GeodeticPosition)>,
    last: Option<(Time, GeodeticPosition, Vector3<f64>)>,
    gap: Vector2<f64>,
    /// The same integral of what the velocities differ by from those that are believed.
    ahead: Vector2<f64>,
    /// When they were last apart by more than they agree within, while they contradict.
    apart: Time,
    pub(super) is_contradicted: bool,
    /// Whether the velocities are wrong, and the places are not.
    pub(super) is_velocity_wrong: bool,
}

impl Displacement {
    /// Takes the place of a fix.
    pub(super) fn take_place(&mut self, taken: Time, place: GeodeticPosition) {
        self.place = Some((taken, place));
    }

    /// Takes the velocity of a fix, m/s. Whether the velocities contradict the places.
    pub(super) fn contradicts(
        &mut self,
        motion: &Motion,
        taken: Time,
        velocity: Vector3<f64>,
    ) -> bool {
        let Some((_, place)) = self.place.filter(|(at, _)| *at == taken) else {
            return self.is_contradicted;
        };
        let last = self.last.replace((taken, place, velocity));
        let Some((before, was_at, was)) = last else {
            return false;
        };
        let since_s = taken.since(before).as_secs_f64();
        if since_s > APART_S {
            self.gap.fill(0.0);
            self.ahead.fill(0.0);
            self.is_contradicted = false;
            return false;
        }
        let moved = motion.to_place(place) - motion.to_place(was_at);
        let off = (moved - (velocity + was) * (0.5 * since_s)).xy();
        // Of a velocity that changes the mean is not that of the two.
        let known_to = BENT_SHARE * (velocity - was).norm() * since_s;
        let most = (MOST_MPS * since_s).min((off.norm() - known_to).max(0.0));
        let kept = libm::exp(-since_s / FORGOTTEN_S);
        self.ahead = self.ahead * kept + (velocity - motion.velocity).xy() * since_s;
        self.gap = self.gap * kept + off.cap_magnitude(most);
        self.gap = self.gap.cap_magnitude(MOST_M);
        let gap_m = self.gap.norm();
        if gap_m > AGREES_M {
            self.apart = taken;
        }
        let agreed_s = taken.since(self.apart).as_secs_f64();
        self.is_contradicted = gap_m > CONTRADICTS_M || self.is_contradicted && agreed_s < AGREED_S;
        self.is_contradicted
    }

    /// Whether the places have not moved as velocities say that differ by this from what is
    /// believed, m/s.
    pub(super) fn is_against(&self, difference: Vector2<f64>) -> bool {
        let along = difference.try_normalize(1e-6).unwrap_or_default();
        -self.gap.dot(&along) > AGAINST_M.max(AGAINST_SHARE * self.ahead.dot(&along))
    }

    /// By how much the places moved faster than the velocities say, m/s, if all of that was in
    /// so many seconds.
    pub(super) fn faster(&self, in_s: f64) -> Vector2<f64> {
        (self.gap / in_s.max(1.0)).cap_magnitude(MOST_MPS)
    }
}
