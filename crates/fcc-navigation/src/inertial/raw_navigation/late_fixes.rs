//! Fixes that come late, by what they say, and those whose velocity is wrong.

use core::time::Duration;

use super::RawNavigation;
use super::readings::is_new;
use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_core::framework::{Reading, Time};

/// A fix that is older than this when it comes is not the present place.
const LATE: Duration = Duration::from_millis(500);

/// A velocity counts as used again after this time, s, without a contradiction.
const USED_AGAIN_S: f64 = 10.0;

/// Whether the velocity is refused, and what takes the place of a late fix.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LateFixes {
    /// When the velocity was last refused, whether that counts, and whether that is new.
    refused: Time,
    is_refused: bool,
    is_refusal_news: bool,
    last: Reading<GnssFix>,
    present: Option<(Reading<Position>, Reading<Velocity>)>,
}

impl RawNavigation {
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
        let is_refused = self.filter.refuses_velocity() || self.repeats.is_velocity_old();
        let late = &mut self.late_fixes;
        if is_refused {
            late.refused = now;
        }
        let was_refused = late.is_refused;
        late.is_refused =
            is_refused || was_refused && now.since(late.refused).as_secs_f64() < USED_AGAIN_S;
        late.is_refusal_news = late.is_refused != was_refused;
        let fix = self.used.gnss;
        if is_new(&mut late.last, &fix, now) {
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
            late.present = ((fix.age(now) > LATE || is_refused) && is_known).then(|| {
                let at = self.solution.time;
                let (mut position, mut velocity) =
                    (Reading::new(position, at), Reading::new(velocity, at));
                (position.source, velocity.source) = (fix.source, fix.source);
                (position, velocity)
            });
        }
    }
}
