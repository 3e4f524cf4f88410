//! Where this was in the latest seconds, for fixes that come late.

use core::time::Duration;

use nalgebra::Vector3;

use super::motion::Motion;
use super::signed_s;
use crate::inertial::GeodeticPosition;
use fcc_core::framework::Time;

/// States of the latest seconds, and how far apart they are.
const STATES: usize = 56;
const APART: Duration = Duration::from_millis(100);
/// Where this was, and how it moved.
#[derive(Clone, Copy, Debug)]
struct Past {
    time: Time,
    place: GeodeticPosition,
    velocity: Vector3<f64>,
    /// What had been corrected until then: m, m/s.
    corrected: (Vector3<f64>, Vector3<f64>),
}

/// The states of the latest seconds, with all that was corrected since.
#[derive(Clone, Debug)]
pub(super) struct Path {
    past: [Option<Past>; STATES],
    next: usize,
    corrected: (Vector3<f64>, Vector3<f64>),
}

impl Path {
    pub(super) fn new() -> Self {
        Self {
            past: [None; STATES],
            next: 0,
            corrected: (Vector3::zeros(), Vector3::zeros()),
        }
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

    /// What a place differs by from where this was at a time, m, how this moved then, m/s, and
    /// its acceleration, m/s²; nothing if that is not known any more.
    pub(super) fn then(
        &self,
        motion: &Motion,
        then: Time,
        place: GeodeticPosition,
    ) -> Option<[Vector3<f64>; 3]> {
        (0..STATES).find_map(|before| {
            let past = self.newest(before).filter(|past| past.time <= then)?;
            let after_s = signed_s(then, past.time);
            let [difference, velocity] = self.seen_from(past, motion, place);
            let next = before.checked_sub(1).and_then(|next| self.newest(next));
            let acceleration = next.map_or(Vector3::zeros(), |next| {
                let next_velocity = next.velocity + self.corrected.1 - next.corrected.1;
                (next_velocity - velocity) / signed_s(next.time, past.time)
            });
            Some([
                difference - velocity * after_s,
                velocity + acceleration * after_s,
                acceleration,
            ])
        })
    }

    /// The mean acceleration of the latest moment, m/s².
    pub(super) fn acceleration(&self, time: Time, motion: &Motion) -> Vector3<f64> {
        self.newest(1).map_or(Vector3::zeros(), |past| {
            let velocity = past.velocity + self.corrected.1 - past.corrected.1;
            (motion.velocity - velocity) / signed_s(time, past.time).max(1e-3)
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
}
