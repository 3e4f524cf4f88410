//! Fixes of satellite navigation.

use std::collections::VecDeque;

use fcc_core::flight::{GnssFix, Measurements};
use fcc_core::framework::{Reading, SourceClock, Time};

use crate::{Measured, Sample};

impl Measured for GnssFix {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        into.gnss = Reading::new(sample.value, sample.taken);
    }
}

/// Receivers leave out the course of what hardly moves; faster than this they
/// have none for another reason, m/s.
const STANDING_MPS: f64 = 0.5;

/// North and east, m/s, of a speed and its course from true north, 0 to 360°; a receiver
/// that stands has no course. None of what is no speed, and no course.
pub fn velocity_over_ground(speed_mps: f64, course_deg: Option<f64>) -> Option<[f64; 2]> {
    let is_course = course_deg.is_none_or(|course| (0.0..=360.0).contains(&course));
    if speed_mps.is_nan() || speed_mps < 0.0 || !is_course {
        return None;
    }
    let Some(course_deg) = course_deg else {
        return (speed_mps < STANDING_MPS).then_some([0.0; 2]);
    };
    let (sin, cos) = libm::sincos(course_deg.to_radians());
    Some([speed_mps * cos, speed_mps * sin])
}

/// A fix that is earlier by less is an older one that arrives again; by more, the
/// receiver has set its clock, s.
const OLDER_S: f64 = 10.0;

/// When fixes were taken, by the times of their epochs. Of a receiver, or of what passes its
/// messages on, that hangs, the last fix arrives again and again; and of one that is
/// overloaded, fixes arrive later and later.
///
/// ```
/// use fcc_core::framework::Time;
/// use fcc_device::EpochOrder;
///
/// let at_ms = |ms: i64| Time::from_nanos(ms * 1_000_000);
/// // By the seconds of a week.
/// let mut order = EpochOrder::within(604_800.0);
/// assert_eq!(order.taken(604_799.8, at_ms(5_000)), Some(at_ms(5_000)));
/// assert_eq!(order.taken(0.0, at_ms(5_200)), Some(at_ms(5_200)));
/// assert_eq!(order.taken(0.0, at_ms(5_400)), None, "again");
/// assert_eq!(order.taken(604_799.8, at_ms(5_600)), None, "an older one");
/// // One after 1 s arrives after 3 s: 2 s late, less what clocks may drift apart by.
/// order.taken(10.0, at_ms(6_000));
/// let taken = order.taken(11.0, at_ms(9_000)).unwrap();
/// assert!(taken.since(at_ms(7_000)).as_micros() < 1_000);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct EpochOrder {
    period_s: f64,
    last_s: Option<f64>,
    clock: SourceClock,
}

impl EpochOrder {
    /// Of times that begin anew after this long, s.
    pub fn within(period_s: f64) -> Self {
        Self {
            period_s,
            last_s: None,
            clock: SourceClock::default(),
        }
    }

    /// Of times of day.
    pub fn of_day() -> Self {
        Self::within(DAY_S)
    }

    /// When the fix of an epoch, s, was taken that has arrived at a time: earlier than that by
    /// as much as it is later than the fastest before. `None` if its epoch is not later than
    /// the last one. What all fixes are late by is not seen: it is the calibration's.
    pub fn taken(&mut self, time_s: f64, arrived: Time) -> Option<Time> {
        let age = self.clock.step(arrived, time_s);
        let is_later = self.last_s.is_none_or(|last_s| {
            let ahead_s = (time_s - last_s).rem_euclid(self.period_s);
            ahead_s > 0.0 && ahead_s < self.period_s - OLDER_S
        });
        if is_later {
            self.last_s = Some(time_s);
        }
        is_later.then(|| arrived - age)
    }
}

const DAY_S: f64 = 86_400.0;
/// The mean is over this time, s. The quarter is for receivers that are not exactly
/// on time.
const CLIMB_OVER_S: f64 = 1.25;
/// At most 25 a second.
const MOST_ALTITUDES: usize = 32;

/// The vertical speed of a receiver that gives none: the change of its altitude over
/// the last second. There is none with the first altitude, and it is half a second
/// late.
///
/// ```
/// use fcc_device::VerticalSpeed;
///
/// let mut speed = VerticalSpeed::default();
/// assert_eq!(speed.down_mps(10.0, 500.0), None);
/// assert_eq!(speed.down_mps(11.0, 503.0), Some(-3.0));
/// ```
#[derive(Clone, Debug, Default)]
pub struct VerticalSpeed {
    /// With their times, the oldest first.
    altitudes: VecDeque<(f64, f64)>,
}

impl VerticalSpeed {
    /// Takes an altitude, m, at a time, s, which may begin anew at midnight; the
    /// speed down, m/s.
    pub fn down_mps(&mut self, time_s: f64, altitude_m: f64) -> Option<f64> {
        let since = |then: f64| (time_s - then).rem_euclid(DAY_S);
        while let Some((then, _)) = self.altitudes.front()
            && (since(*then) > CLIMB_OVER_S || self.altitudes.len() >= MOST_ALTITUDES)
        {
            self.altitudes.pop_front();
        }
        let first = self.altitudes.front().copied();
        self.altitudes.push_back((time_s, altitude_m));
        let (then, before_m) = first?;
        let passed_s = since(then);
        (passed_s > 0.0).then(|| (before_m - altitude_m) / passed_s)
    }
}
