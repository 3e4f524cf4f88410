//! A receiver that becomes late: fixes that say the time of now, and show where this was
//! seconds ago.
//!
//! At the first of them the position falls back by the way that was flown in that time, along
//! the path and nowhere else. An error of the filter or of the receiver does that by accident
//! only. From then on a fix is compared with the state of the time that it belongs to, and the
//! difference corrects the present state, and those before it with it (the extrapolated
//! measurement of Larsen, Andersen, Ravn and Poulsen 1998, *Incorporation of time delayed
//! measurements in a discrete-time Kalman filter*, IEEE Conference on Decision and Control).

use super::motion::Motion;
use super::path::Path;
use crate::inertial::GeodeticPosition;
use fcc_core::framework::Time;

/// Fixes are later than this, s, or not late: the path of that time is no longer than the
/// errors of a position.
const LEAST_S: f64 = 0.1;
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

/// What is known of the age of fixes.
#[derive(Clone, Debug, Default)]
pub(super) struct Lateness {
    /// By how much fixes are later than they say, s.
    late_s: f64,
    /// By how much those refused seem to be, from when to when.
    seems: Option<(f64, Time, Time)>,
    /// How much rather velocities are of now, and when that was sure.
    of_now: f64,
    sure: Time,
}

impl Lateness {
    /// By how much fixes are later than they say, s; 0 if they are not.
    pub(super) const fn late_s(&self) -> f64 {
        self.late_s
    }

    /// Takes a position that was refused because it is far off. Whether it is known now by how
    /// much fixes are late.
    pub(super) fn refused(
        &mut self,
        path: &Path,
        motion: &Motion,
        taken: Time,
        place: GeodeticPosition,
    ) -> bool {
        let is_not_late = taken.since(self.sure).as_secs_f64() < NOT_LATE_S;
        let late_s = path.late_s(motion, taken, place);
        let Some(late_s) = late_s.filter(|late_s| *late_s <= LEAST_S || !is_not_late) else {
            self.seems = None;
            return false;
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
        let is_known = taken.since(since).as_secs_f64() >= CONFIRMED_S;
        if is_known {
            self.late_s = if late_s > LEAST_S { late_s } else { 0.0 };
            self.seems = None;
            self.of_now = 0.0;
        }
        is_known
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
