//! Fixes that come late, by what they say or later than that, and those whose velocity is
//! wrong.

use core::time::Duration;

use super::readings::is_new;
use super::{Method, RawNavigation};
use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_core::framework::{Reading, Time};

/// A fix that is older than this when it comes is not the present place.
const LATE: Duration = Duration::from_millis(500);

/// A lateness that differs by this from what was told, s, is told.
const TOLD_S: f64 = 0.3;

/// A velocity counts as used again after this time, s, without a contradiction.
const USED_AGAIN_S: f64 = 10.0;

/// By how much fixes are later than they say, s, as it was told last, and what takes the place
/// of a late one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LateFixes {
    late_s: f64,
    /// Whether that is new since the last step.
    is_news: bool,
    /// When the velocity was last refused, whether that counts, and whether that is new.
    refused: Time,
    is_refused: bool,
    is_refusal_news: bool,
    last: Reading<GnssFix>,
    present: Option<(Reading<Position>, Reading<Velocity>)>,
}

impl RawNavigation {
    /// By how much the fixes of the receiver are later than they say, s, if that was found in
    /// the last step; 0 if they come in time again. They are used at the time that they are of.
    pub fn late_fixes_s(&self) -> Option<f64> {
        self.late_fixes.is_news.then_some(self.late_fixes.late_s)
    }

    /// Whether the receiver's velocity is refused, or used again, if that began in the last
    /// step.
    pub fn refuses_velocity(&self) -> Option<bool> {
        let late = &self.late_fixes;
        late.is_refusal_news.then_some(late.is_refused)
    }

    /// What takes the place of a fix that came late, or whose velocity is wrong: where this is
    /// by all sensors.
    pub(super) const fn present(&self) -> Option<(Reading<Position>, Reading<Velocity>)> {
        self.late_fixes.present
    }

    pub(super) fn follow_late_fixes(&mut self, now: Time) {
        let (late_s, is_contradicted) = match &self.method {
            // What comes before it is of is in time.
            Method::Kalman(navigation) => (
                navigation.late_fixes_s().max(0.0),
                navigation.refuses_velocity(),
            ),
            Method::Thesis(_) => (0.0, false),
        };
        let is_refused = is_contradicted || self.repeats.is_velocity_old();
        let late = &mut self.late_fixes;
        if is_refused {
            late.refused = now;
        }
        let was_refused = late.is_refused;
        late.is_refused =
            is_refused || was_refused && now.since(late.refused).as_secs_f64() < USED_AGAIN_S;
        late.is_refusal_news = late.is_refused != was_refused;
        late.is_news = (late_s - late.late_s).abs() > TOLD_S;
        if late.is_news {
            late.late_s = if late_s > TOLD_S { late_s } else { 0.0 };
        }
        let fix = self.used.gnss;
        if is_new(&mut late.last, &fix, now) {
            let age = fix.age(now) + Duration::from_secs_f64(late_s);
            let [north_mps, east_mps, down_mps] = self.solution.velocity_mps;
            let place = self.solution.position;
            let position = Position {
                latitude_rad: place.latitude_rad,
                longitude_rad: place.longitude_rad,
                altitude_m: place.altitude_m,
            };
            let velocity = Velocity {
                north_mps,
                east_mps,
                down_mps,
            };
            let is_known = place.latitude_rad.is_finite() && north_mps.is_finite();
            late.present = ((age > LATE || is_refused) && is_known).then(|| {
                let at = self.solution.time;
                let (mut position, mut velocity) =
                    (Reading::new(position, at), Reading::new(velocity, at));
                (position.source, velocity.source) = (fix.source, fix.source);
                (position, velocity)
            });
        }
    }
}
