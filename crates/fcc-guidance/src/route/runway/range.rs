//! The height over a runway, by a range finder that is compared with the altitude.

use super::{RunwayFlight, RunwayPhase};
use crate::path::Motion;
use crate::route::OverGround;

/// Ranges that show ground so much higher or lower than before are doubted, m: gradual
/// slopes are followed, and an echo of the range finder itself is smaller.
const JUMPS_M: f64 = 5.0;

impl RunwayFlight {
    /// With the ground that ranges showed in an earlier landing there: how far it was
    /// above the runway's elevation, m.
    pub(in crate::route) const fn over_ground_above(self, above_m: Option<f64>) -> Self {
        Self {
            ground_above_m: above_m,
            ..self
        }
    }

    /// How far above the runway's elevation the ground is that ranges show, m.
    pub(in crate::route) const fn ground_above_m(&self) -> Option<f64> {
        self.ground_above_m
    }

    /// Of the wheels above the ground, m: over the runway by the range finder, unless the
    /// altitude is lower and the range is doubted; otherwise by the altitude, without a
    /// range finder less what the altimeter is off the receiver.
    pub(super) fn height_m(&mut self, here: &OverGround, motion: &Motion) -> f64 {
        let by_altitude_m = self.by_altitude_m(here);
        let by_range_m = here.height_m.map(|m| m - self.config.height_on_wheels_m);
        // It is the altimeter that has stepped, not the ground.
        self.ground_above_m = self.ground_above_m.map(|m| m + here.stepped_m);
        self.compare(by_range_m.map(|m| by_altitude_m - m));
        let by_range_m = by_range_m.filter(|_| self.is_over_runway(motion));
        let lands = matches!(self.phase, RunwayPhase::Approach | RunwayPhase::Flare);
        let is_uncertain = lands && here.height_m.is_none();
        self.demand.uncertainty_m = if is_uncertain {
            self.config.height_uncertainty_m
        } else {
            0.0
        };
        match by_range_m {
            Some(by_range_m) if self.is_range_doubted => by_range_m.min(by_altitude_m),
            Some(by_range_m) => by_range_m,
            None if here.ranges || here.height_m.is_some() => by_altitude_m,
            None => by_altitude_m - here.above_receiver_m.unwrap_or(0.0),
        }
    }

    /// Of the wheels above the runway by the altitude, m.
    pub(super) fn by_altitude_m(&self, here: &OverGround) -> f64 {
        here.altitude_m - self.runway.elevation_m
    }

    /// Holds the ground that ranges show, m above the runway's elevation, against that
    /// before. Towards the runway it really steps: onto a plateau, out of a valley. Away
    /// from it only the range finder does, where it is used; and there nobody knows which
    /// of the two is right. Without power it lands on whatever is below.
    fn compare(&mut self, above_m: Option<f64>) {
        let (Some(now_m), RunwayPhase::Approach | RunwayPhase::Flare, None) =
            (above_m, self.phase, self.glide_sine)
        else {
            self.is_range_doubted = false;
            return;
        };
        self.is_range_doubted = self.ground_above_m.is_some_and(|before_m| {
            (now_m - before_m).abs() > JUMPS_M && now_m.abs() > before_m.abs()
        });
        if !self.is_range_doubted {
            self.ground_above_m = above_m;
        }
    }
}
