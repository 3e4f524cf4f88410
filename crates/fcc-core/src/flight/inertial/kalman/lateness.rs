//! A receiver that becomes late: fixes that say the time of now, and show where this was
//! seconds ago.
//!
//! At the first of them the position falls back by the way that was flown in that time, along
//! the path and nowhere else. An error of the filter or of the receiver does that by accident
//! only. From then on a fix is compared with the state of the time that it belongs to, and the
//! difference corrects the present state, and those before it with it (the extrapolated
//! measurement of Larsen, Andersen, Ravn and Poulsen 1998, *Incorporation of time delayed
//! measurements in a discrete-time Kalman filter*, IEEE Conference on Decision and Control).

use core::time::Duration;

use nalgebra::Vector3;

use super::motion::Motion;
use super::signed_s;
use crate::flight::inertial::GeodeticPosition;
use crate::framework::Time;

/// States of the latest seconds, and how far apart they are.
const STATES: usize = 56;
const APART: Duration = Duration::from_millis(100);
/// Fixes are later than this, s, or not late: the path of that time is no longer than the
/// errors of a position.
const LEAST_S: f64 = 0.1;
/// Slower than this, m/s, and further from the path, m, nothing is said of a fix.
const LEAST_MPS: f64 = 8.0;
const BESIDE_M: f64 = 6.0;
/// Fixes of this time, s, are late by the same, s.
const CONFIRMED_S: f64 = 0.8;
const SAME_S: f64 = 0.15;
/// Velocities that are rather of now than of the time of late fixes, by this log-likelihood
/// ratio, show that it was the position alone that jumped; one fix counts by the other at most.
/// Then no fix is late for a time, s.
const OF_NOW: f64 = 10.0;
const ONE_FIX: f64 = 5.0;
const NOT_LATE_S: f64 = 60.0;
/// What was seen longer ago, s, does not count.
const FORGOTTEN_S: f64 = 1.5;

/// Where this was, and how it moved.
#[derive(Clone, Copy, Debug)]
struct Past {
    time: Time,
    place: GeodeticPosition,
    velocity: Vector3<f64>,
    /// What had been corrected until then: m, m/s.
    corrected: (Vector3<f64>, Vector3<f64>),
}

/// What is known of the age of fixes.
#[derive(Clone, Debug)]
pub(super) struct Lateness {
    past: [Option<Past>; STATES],
    next: usize,
    corrected: (Vector3<f64>, Vector3<f64>),
    /// By how much fixes are later than they say, s.
    late_s: f64,
    /// By how much those refused seem to be, from when to when.
    seems: Option<(f64, Time, Time)>,
    /// How much rather velocities are of now, and when that was sure.
    of_now: f64,
    sure: Time,
}

impl Default for Lateness {
    fn default() -> Self {
        Self {
            past: [None; STATES],
            next: 0,
            corrected: (Vector3::zeros(), Vector3::zeros()),
            late_s: 0.0,
            seems: None,
            of_now: 0.0,
            sure: Time::NEVER,
        }
    }
}

impl Lateness {
    /// By how much fixes are later than they say, s; 0 if they are not.
    pub(super) const fn late_s(&self) -> f64 {
        self.late_s
    }

    /// By how much the variance of a fix is larger: the present error is not that of its time,
    /// and what is corrected shows only after this.
    pub(super) fn excess(&self) -> f64 {
        1.0 + self.late_s * self.late_s
    }

    /// Keeps the state of a time, unless the last one that was kept is as good.
    pub(super) fn keep(&mut self, time: Time, motion: &Motion) {
        let last = self.newest(0);
        if last.is_some_and(|last| time.since(last.time) < APART) {
            return;
        }
        if let Some(past) = self.past.get_mut(self.next) {
            *past = Some(Past {
                time,
                place: motion.place,
                velocity: motion.velocity,
                corrected: self.corrected,
            });
        }
        self.next = (self.next + 1) % STATES;
    }

    /// Takes what position, m, and velocity, m/s, were corrected by.
    pub(super) fn corrected(&mut self, position: Vector3<f64>, velocity: Vector3<f64>) {
        self.corrected.0 += position;
        self.corrected.1 += velocity;
    }

    /// The one that was kept so many before the last.
    fn newest(&self, before: usize) -> Option<&Past> {
        let at = (self.next + 2 * STATES).checked_sub(1 + before)? % STATES;
        self.past.get(at)?.as_ref()
    }

    /// What a place differs by from where this was at a time, m, and how this moved then, m/s;
    /// nothing if that is not known any more.
    pub(super) fn then(
        &self,
        motion: &Motion,
        then: Time,
        place: GeodeticPosition,
    ) -> Option<[Vector3<f64>; 2]> {
        (0..STATES).find_map(|before| {
            let past = self.newest(before).filter(|past| past.time <= then)?;
            let after_s = signed_s(then, past.time);
            let [difference, velocity] = self.seen_from(past, motion, place);
            let next = before.checked_sub(1).and_then(|next| self.newest(next));
            let gained = next.map_or(Vector3::zeros(), |next| {
                let next_velocity = next.velocity + self.corrected.1 - next.corrected.1;
                (next_velocity - velocity) * (after_s / signed_s(next.time, past.time))
            });
            Some([difference - velocity * after_s, velocity + gained])
        })
    }

    /// Whether the state of a time is still known.
    pub(super) fn knows(&self, then: Time) -> bool {
        let mut past = (0..STATES).map_while(|before| self.newest(before));
        past.any(|past| past.time <= then)
    }

    fn seen_from(
        &self,
        past: &Past,
        motion: &Motion,
        place: GeodeticPosition,
    ) -> [Vector3<f64>; 2] {
        let moved = self.corrected.0 - past.corrected.0;
        [
            motion.to_place(place) - motion.to_place(past.place) - moved,
            past.velocity + self.corrected.1 - past.corrected.1,
        ]
    }

    /// By how much a fix is late, if it was on the path of the latest seconds.
    fn on_path(&self, motion: &Motion, taken: Time, place: GeodeticPosition) -> Option<f64> {
        let now = (motion.to_place(place), motion.velocity, 0.0);
        let past = (0..STATES)
            .map_while(|before| self.newest(before))
            .map(|past| {
                let [difference, velocity] = self.seen_from(past, motion, place);
                (difference, velocity, signed_s(taken, past.time))
            });
        let (difference, velocity, late_s) = core::iter::once(now).chain(past).min_by(|a, b| {
            let [a, b] = [a, b].map(|one| one.0.xy().norm_squared());
            a.total_cmp(&b)
        })?;
        let (difference, velocity) = (difference.xy(), velocity.xy());
        let speed = velocity.norm();
        let ahead_s = difference.dot(&velocity) / (speed * speed).max(1.0);
        let is_on = speed > LEAST_MPS && (difference - velocity * ahead_s).norm() < BESIDE_M;
        (is_on && ahead_s.abs() * speed < BESIDE_M).then(|| (late_s - ahead_s).max(0.0))
    }

    /// Takes a position that was refused because it is far off.
    pub(super) fn refused(&mut self, motion: &Motion, taken: Time, place: GeodeticPosition) {
        let is_not_late = taken.since(self.sure).as_secs_f64() < NOT_LATE_S;
        let late_s = self.on_path(motion, taken, place);
        let Some(late_s) = late_s.filter(|late_s| *late_s <= LEAST_S || !is_not_late) else {
            self.seems = None;
            return;
        };
        let since = match self.seems {
            Some((seems_s, since, last))
                if (late_s - seems_s).abs() < SAME_S
                    && taken.since(last).as_secs_f64() < FORGOTTEN_S =>
            {
                since
            }
            _ => taken,
        };
        self.seems = Some((late_s, since, taken));
        if taken.since(since).as_secs_f64() >= CONFIRMED_S {
            self.late_s = if late_s > LEAST_S { late_s } else { 0.0 };
            self.seems = None;
            self.of_now = 0.0;
        }
    }

    /// Takes by how much farther a velocity is from that of the time of late fixes than from
    /// that of now, as squares of numbers of standard deviations. Whether it is of now.
    pub(super) fn compare(&mut self, taken: Time, farther: f64) -> bool {
        self.of_now = (self.of_now + (0.5 * farther).clamp(-ONE_FIX, ONE_FIX)).max(0.0);
        if self.of_now > OF_NOW {
            self.sure = taken;
            self.late_s = 0.0;
            self.of_now = 0.0;
        }
        self.late_s == 0.0
    }

    /// Takes a position that was accepted.
    pub(super) fn accepted(&mut self) {
        self.seems = None;
    }

    /// Whether fixes seem to be later, or less late, than they are taken for.
    pub(super) fn is_suspected(&self, now: Time) -> bool {
        let is_recent = |last| now.since(last).as_secs_f64() < FORGOTTEN_S;
        self.seems.is_some_and(|(_, _, last)| is_recent(last))
    }
}
