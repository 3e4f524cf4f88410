//! Where the aircraft is and how it moves over the ground, for the modes that fly
//! there.
//!
//! Navigation by raw readings has a position of its own. Otherwise positions and
//! velocities are those of a receiver or a simulator, with their age; between two of
//! them, and when they end, the aircraft is taken on by its velocity, and after a
//! second without one by airspeed, heading and the last wind (dead reckoning).

use core::time::Duration;

use libm::{atan2, cos, exp, hypot, sin};
use nalgebra::Vector2;

use super::ground_below::GroundBelow;
use super::place_monitor::{Moving, PlaceDoubt, PlaceMonitor, STANDS_MPS, Verdict};
use fcc_core::blocks::{limit, wrap_pi};
use fcc_core::flight::earth::metres_per_radian;
use fcc_core::flight::{Measurements, Position};
use fcc_core::framework::{Reading, Time};
use fcc_guidance::route::OverGround;
use fcc_navigation::Estimate;
use fcc_navigation::inertial::Solution;

/// A reading is taken on by its velocity for so long at most.
const LONGEST_AGE: Duration = Duration::from_secs(1);
/// A force is used for so long.
const FORCE_AGE: Duration = Duration::from_millis(250);
/// Faster than this on its wheels the aircraft moves where it points, m/s.
const ROLLS_MPS: f64 = 5.0;
/// The receiver's altitude has noise: what the altimeter is off it is followed with this
/// time constant, s.
const ALTITUDE_FOLLOWS_S: f64 = 5.0;
/// An altitude that differs more from that of the last tick, by its climb rate, has
/// stepped, m.
const STEPS_M: f64 = 4.0;
/// Positions have noise: they are followed with this time constant, s, unless they
/// are farther off than this, m.
const FOLLOWS_S: f64 = 1.0;
const FAR_M: f64 = 50.0;
/// After so long without a position it is one of dead reckoning, s.
const RECKONED_AFTER_S: f64 = 3.0;
/// For so long without a receiver the velocity of navigation by raw readings is better
/// than that by airspeed and the last wind, s: gyroscopes and accelerometers know it.
const INERTIAL_FOR_S: f64 = 30.0;
/// Its wind has the gusts in it: the last wind is followed with this time constant, s.
const WIND_FOLLOWS_S: f64 = 30.0;
/// Standard deviations: of a satellite receiver's horizontal position, m; of a velocity by
/// dead reckoning the part of the airspeed (a compass that is 2° off, an airspeed that is
/// 2 % off), and that of a wind that is another one than the last, m/s.
const RECEIVER_M: f64 = 3.0;
const AIR_SHARE: f64 = 0.04;
const WIND_MPS: f64 = 1.5;

/// The aircraft over the ground.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GroundMotion {
    here: OverGround,
    position_taken: Time,
    place: PlaceMonitor,
    velocity_taken: Time,
    /// True north minus magnetic north, as the last velocity showed it, rad.
    variation_rad: f64,
    /// Since the last position, s.
    lost_s: f64,
    /// The wind of navigation by raw readings, without gusts, as it was with a receiver.
    last_wind_mps: Option<Vector2<f64>>,
    ground: GroundBelow,
    /// Of the last tick, m.
    pressure_altitude_m: Option<f64>,
    altimeter_is_doubted: bool,
    /// By how much a receiver showed the aircraft lower than the altimeter, m: it stays when
    /// the receiver is lost, as the air and the altimeter's setting do.
    below_altimeter_m: f64,
    /// It has just begun to be.
    adopts_altitude: bool,
    /// What the range finder shows, m, upright.
    below_m: Option<f64>,
}

impl GroundMotion {
    /// Compares positions with motion, of an aircraft that flies from this airspeed on, m/s.
    pub(super) fn judging(flies_mps: f64) -> Self {
        Self {
            place: PlaceMonitor::new(flies_mps),
            ..Self::default()
        }
    }

    /// Why the measured position is not used, if it is not.
    pub(super) const fn place_doubt(&self) -> Option<PlaceDoubt> {
        self.place.doubt()
    }

    /// The aircraft is elsewhere: the next position is no jump.
    pub(super) fn forget_place(&mut self) {
        self.place = self.place.anew();
    }

    /// Where the aircraft is, if it was ever known.
    pub(super) fn here(&self) -> Option<&OverGround> {
        (!self.position_taken.is_never() && self.here.is_finite()).then_some(&self.here)
    }

    /// The estimate with what is known of the place.
    pub(super) fn shown_in(&self, estimate: &Estimate) -> Estimate {
        let Some(here) = self.here() else {
            return *estimate;
        };
        Estimate {
            latitude_rad: here.latitude_rad,
            longitude_rad: here.longitude_rad,
            north_mps: here.ground_velocity_mps.x,
            east_mps: here.ground_velocity_mps.y,
            wind_north_mps: here.wind_mps.x,
            wind_east_mps: here.wind_mps.y,
            position_uncertainty_m: self.uncertainty_m(),
            ..*estimate
        }
    }

    /// Standard deviation of the horizontal position, m: errors of dead reckoning last, so
    /// that it grows in proportion to the time since the last position.
    fn uncertainty_m(&self) -> f64 {
        let velocity_mps = hypot(AIR_SHARE * self.here.true_airspeed_mps, WIND_MPS);
        hypot(RECEIVER_M, velocity_mps * self.lost_s)
    }

    /// How long ago the last position was, s of the plant's time.
    pub(super) const fn lost_s(&self) -> f64 {
        self.lost_s
    }

    /// Whether the wheels bear weight; none where it is not measured.
    pub(super) const fn on_wheels(&self) -> Option<bool> {
        self.here.on_wheels
    }

    /// Whether they are known to.
    pub(super) fn stands_on_wheels(&self) -> bool {
        self.here.on_wheels == Some(true)
    }

    /// Speed over the ground, m/s.
    pub(super) fn speed_mps(&self) -> f64 {
        hypot(
            self.here.ground_velocity_mps.x,
            self.here.ground_velocity_mps.y,
        )
    }

    /// Whether it moves over the ground, by a velocity that is measured: without one, wind is
    /// not told from motion.
    pub(super) fn moves(&self, now: Time) -> bool {
        now.since(self.velocity_taken) <= LONGEST_AGE && self.speed_mps() > STANDS_MPS
    }

    /// Standing, the range finder shows `on_wheels_m`; whether it begins to show something
    /// else. In motion a switch that shows weight may be wrong.
    pub(super) fn check_range(&mut self, on_wheels_m: f64) -> bool {
        let stands = self.stands_on_wheels() && self.speed_mps() < STANDS_MPS;
        stands && self.ground.stand(self.below_m, on_wheels_m)
    }

    /// The range finder does not show the ground, though it is near.
    pub(super) const fn expect_no_range(&mut self) {
        self.ground.expect_nothing();
    }

    /// The range finder contradicts what it showed before.
    pub(super) const fn leave_range(&mut self) {
        self.ground.leave();
    }

    /// Whether the position is one of dead reckoning.
    pub(super) fn is_reckoned(&self) -> bool {
        self.here().is_some() && self.lost_s > RECKONED_AFTER_S
    }

    /// Whether there is a position that was measured.
    pub(super) fn is_measured(&self) -> bool {
        self.here().is_some() && !self.is_reckoned()
    }

    /// Whether the altimeter is doubted from now on.
    pub(super) const fn doubt_altimeter(&mut self, is_doubted: bool) {
        self.adopts_altitude = is_doubted && !self.altimeter_is_doubted;
        self.altimeter_is_doubted = is_doubted;
    }

    /// By how much the aircraft is lower than the altimeter shows, m, as far as a receiver
    /// said so: in cold air, or with the setting of another pressure.
    pub(super) const fn below_altimeter_m(&self) -> f64 {
        self.below_altimeter_m
    }

    /// `dt_s` seconds of the plant's time pass. `wind` is navigation's, m/s towards
    /// north and east, with what true north is off the compass, rad; mean sea level is
    /// at a pressure altitude, m.
    pub(super) fn step(
        &mut self,
        now: Time,
        measured: &Measurements,
        estimate: &Estimate,
        wind: Option<([f64; 2], f64)>,
        sea_level_m: f64,
        dt_s: f64,
    ) {
        let taken_heading_rad = self.here.heading_rad;
        self.here.true_airspeed_mps = estimate.true_airspeed_mps;
        self.here.airspeed_mps = estimate.airspeed_mps;
        self.here.altitude_m = estimate.altitude_m - sea_level_m;
        self.here.roll_rad = estimate.roll_rad;
        self.here.climb_rate_mps = estimate.climb_rate_mps;
        let force = measured.specific_force.fresh(now, FORCE_AGE);
        self.here.forward_mps2 = force.map_or(0.0, |force| force.x_mps2);
        let below_m = measured.height_by_range_m(now, estimate.roll_rad, estimate.pitch_rad);
        let stepped_m = self.altimeter_step_m(estimate, dt_s);
        self.here.stepped_m = stepped_m;
        if self.adopts_altitude {
            self.ground.adopt(estimate.altitude_m, below_m);
        }
        self.here.height_m = self
            .ground
            .step(estimate.altitude_m, stepped_m, below_m, dt_s);
        self.here.ranges = self.ground.shows();
        self.below_m = below_m;
        self.here.on_wheels = measured
            .weight_on_wheels
            .fresh(now, LONGEST_AGE)
            .map(|weight| weight >= 0.5);
        let velocity = measured.velocity;
        self.place.take_velocity(&velocity);
        // Of a velocity that is repeated no wind is learned.
        if let Some(([north, east], variation_rad)) = wind
            && (self.place.has_new_velocity() || now.since(velocity.taken) > LONGEST_AGE)
        {
            self.here.wind_mps = Vector2::new(north, east);
            if !self.stands_on_wheels() {
                self.variation_rad = variation_rad;
            }
        }
        self.follow_variation(estimate, dt_s);
        self.here.heading_rad = estimate.heading_rad + self.variation_rad;
        if velocity.taken > self.velocity_taken && !self.place.doubts_velocity() {
            self.velocity_taken = velocity.taken;
            let (north, east) = (velocity.value.north_mps, velocity.value.east_mps);
            self.here.ground_velocity_mps = Vector2::new(north, east);
        } else if now.since(self.velocity_taken) > LONGEST_AGE {
            // Navigation by raw readings knows true north, and the wind without a turn.
            let heading = match self.last_wind_mps {
                Some(wind_mps) => {
                    self.here.wind_mps = wind_mps;
                    taken_heading_rad
                }
                None => estimate.heading_rad + self.variation_rad,
            };
            let flown_mps = through_air(&self.here, heading) + self.here.wind_mps;
            self.here.ground_velocity_mps = if self.stands_on_wheels() {
                // The wheels do not slip.
                let ahead = Vector2::new(cos(heading), sin(heading));
                ahead * ahead.dot(&flown_mps).max(0.0)
            } else {
                flown_mps
            };
        }
        let here = self.here;
        self.place.advance(
            here.ground_velocity_mps,
            || through_air(&here, here.heading_rad),
            dt_s,
        );
        self.move_by(here.ground_velocity_mps * dt_s);
        self.lost_s += dt_s;
        if self.lost_s > RECKONED_AFTER_S {
            self.here.above_receiver_m = None;
        }
        self.take_position(now, &measured.position);
    }

    /// By how much the pressure altitude has stepped since the last tick, m.
    fn altimeter_step_m(&mut self, estimate: &Estimate, dt_s: f64) -> f64 {
        let expected_m = self
            .pressure_altitude_m
            .replace(estimate.altitude_m)
            .map(|was_m| was_m + estimate.climb_rate_mps * dt_s);
        let off_m = expected_m.map_or(0.0, |m| estimate.altitude_m - m);
        if off_m.abs() > STEPS_M { off_m } else { 0.0 }
    }

    /// Follows a position that is new, unless it does not move as the aircraft.
    fn take_position(&mut self, now: Time, position: &Reading<Position>) {
        if position.taken > self.position_taken && position.value.is_on_earth() {
            let is_first = self.position_taken.is_never();
            let age_s = now.since(position.taken).min(LONGEST_AGE).as_secs_f64();
            let since_s = self.lost_s;
            let moved = self.here.ground_velocity_mps * age_s;
            let off = self.way_to(position.value.latitude_rad, position.value.longitude_rad);
            let off_m = off + moved;
            let expected = !is_first && since_s <= RECKONED_AFTER_S;
            let moving = Moving {
                on_wheels: self.stands_on_wheels(),
                airspeed_mps: self.here.airspeed_mps,
                ground_mps: self.speed_mps(),
                off_m: expected.then(|| hypot(off_m.x, off_m.y)),
            };
            match self.place.judge(position, &moving) {
                Verdict::Use => {}
                Verdict::Leave => return,
                Verdict::LeaveSince([latitude_rad, longitude_rad], moved_m) => {
                    let off_m = self.way_to(latitude_rad, longitude_rad) + moved_m;
                    return self.move_by(off_m);
                }
            }
            let above_m = self.here.altitude_m - position.value.altitude_m;
            let was_m = self.here.above_receiver_m.unwrap_or(above_m);
            let followed_m = was_m + (above_m - was_m) * (1.0 - exp(-since_s / ALTITUDE_FOLLOWS_S));
            self.here.above_receiver_m = Some(followed_m).filter(|off_m| off_m.is_finite());
            self.below_altimeter_m = self.here.above_receiver_m.unwrap_or(0.0).max(0.0);
            self.position_taken = position.taken;
            self.lost_s = 0.0;
            let is_far = is_first || hypot(off_m.x, off_m.y) > FAR_M;
            let share = if is_far {
                1.0
            } else {
                1.0 - exp(-since_s / FOLLOWS_S)
            };
            self.move_by(off_m * share);
        }
    }

    /// A rolling aircraft moves where it points.
    fn follow_variation(&mut self, estimate: &Estimate, dt_s: f64) {
        let ground = self.here.ground_velocity_mps;
        if self.stands_on_wheels() && hypot(ground.x, ground.y) > ROLLS_MPS {
            let track_rad = atan2(ground.y, ground.x);
            let off_rad = wrap_pi(track_rad - estimate.heading_rad - self.variation_rad);
            self.variation_rad += off_rad * dt_s.min(1.0);
        }
    }

    /// The solution of navigation by raw readings, `dt_s` after the last one, takes the
    /// place of all that it has, as long as a receiver, or a short time without one, has
    /// made its velocity.
    pub(super) fn take(&mut self, solution: &Solution, dt_s: f64) {
        let [w, x, y, z] = solution.quaternion;
        let heading_rad = atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
        if heading_rad.is_finite() {
            self.here.heading_rad = heading_rad;
        }
        if self.here().is_some() && self.lost_s > INERTIAL_FOR_S {
            return;
        }
        let place = &solution.position;
        let [north, east, _] = solution.velocity_mps;
        if place.latitude_rad.is_finite() && place.longitude_rad.is_finite() {
            self.here.latitude_rad = place.latitude_rad;
            self.here.longitude_rad = place.longitude_rad;
        }
        if north.is_finite() && east.is_finite() {
            self.here.ground_velocity_mps = Vector2::new(north, east);
        }
        let [north, east] = solution.wind_mps;
        if north.is_finite() && east.is_finite() {
            let wind_mps = Vector2::new(north, east);
            self.here.wind_mps = wind_mps;
            if self.is_measured() {
                let last = self.last_wind_mps.get_or_insert(wind_mps);
                *last += (wind_mps - *last) * (1.0 - exp(-dt_s / WIND_FOLLOWS_S));
            }
        }
    }

    /// The way from here to a place, m north and east.
    fn way_to(&self, latitude_rad: f64, longitude_rad: f64) -> Vector2<f64> {
        let (north, east) = metres_per_radian(self.here.latitude_rad, 0.0);
        Vector2::new(
            (latitude_rad - self.here.latitude_rad) * north,
            wrap_pi(longitude_rad - self.here.longitude_rad) * east,
        )
    }

    fn move_by(&mut self, by_m: Vector2<f64>) {
        let (north, east) = metres_per_radian(self.here.latitude_rad, 0.0);
        let latitude = self.here.latitude_rad + by_m.x / north;
        let most = core::f64::consts::FRAC_PI_2;
        self.here.latitude_rad = limit(latitude, -most, most);
        self.here.longitude_rad = wrap_pi(self.here.longitude_rad + by_m.y / east);
    }
}

/// The velocity through the air on a true heading, rad, m/s.
fn through_air(here: &OverGround, heading_rad: f64) -> Vector2<f64> {
    Vector2::new(cos(heading_rad), sin(heading_rad)) * here.true_airspeed_mps
}
