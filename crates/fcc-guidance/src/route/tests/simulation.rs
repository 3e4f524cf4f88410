//! Plans flown by a point mass in wind.

use std::boxed::Box;
use std::vec::Vec;

use nalgebra::Vector2;

use super::*;
use crate::path::LocalPlane;
use crate::path::simulation::{DT_S, KT, PointMass, rms, wind};
use fcc_core::flight::earth::metres_per_radian;

const LATITUDE: f64 = 0.75;
const LONGITUDE: f64 = -1.53;

/// A place so far north and east of where a flight begins, m.
fn place(origin: (f64, f64), north_m: f64, east_m: f64) -> (f64, f64) {
    let latitude = origin.0 + north_m / metres_per_radian(origin.0, 0.0).0;
    let middle = 0.5 * (latitude + origin.0);
    (
        latitude,
        origin.1 + east_m / metres_per_radian(middle, 0.0).1,
    )
}

struct Flight {
    aircraft: PointMass,
    follower: Follower,
    origin: (f64, f64),
    wind_mps: Vector2<f64>,
    altitude_m: f64,
}

impl Flight {
    fn new(steps: Vec<Step>, origin: (f64, f64), wind_mps: Vector2<f64>) -> Self {
        let route = Route {
            steps: Box::leak(steps.into_boxed_slice()),
            ..Route::default()
        };
        let config = RouteConfig::default();
        Self {
            aircraft: PointMass::new(100.0, wind_mps, 0.5),
            follower: Follower::along(route, 0, config, 100.0 * KT),
            origin,
            wind_mps,
            altitude_m: 900.0,
        }
    }

    fn here(&self) -> OverGround {
        let motion = self.aircraft.motion();
        let (latitude_rad, longitude_rad) =
            place(self.origin, motion.position_m.x, motion.position_m.y);
        OverGround {
            latitude_rad,
            longitude_rad,
            altitude_m: self.altitude_m,
            ground_velocity_mps: motion.ground_velocity_mps,
            wind_mps: self.wind_mps,
            true_airspeed_mps: 100.0 * KT,
            airspeed_mps: 100.0 * KT,
            ..OverGround::default()
        }
    }

    fn tick(&mut self) {
        let here = self.here();
        self.follower.advance(&here, DT_S);
        self.aircraft.fly(self.follower.acceleration_mps2());
        let climb = self.follower.altitude_m() - self.altitude_m;
        self.altitude_m += climb.clamp(-3.0 * DT_S, 3.0 * DT_S);
    }
}

fn waypoint(origin: (f64, f64), north_m: f64, east_m: f64, within_m: f64) -> Step {
    let (latitude, longitude) = place(origin, north_m, east_m);
    Step::Waypoint {
        at: LocalPlane::at(latitude, longitude),
        altitude_m: 900.0,
        within_m,
    }
}

/// Turns of 30° to 150°, as the issue has them, in 20 kt from any side: the legs are
/// held from the end of each turn, and no waypoint is left out.
#[test]
fn turns_of_30_to_150_degrees_are_flown_in_20_kt() {
    let origin = (LATITUDE, LONGITUDE);
    // Courses 0°, 30°, 90°, 180°, 300°, 90° (by 150°), 330°.
    let courses_deg: [f64; 7] = [0.0, 30.0, 90.0, 180.0, 300.0, 90.0, 330.0];
    let mut at = Vector2::zeros();
    let mut steps = Vec::new();
    for course in courses_deg.map(f64::to_radians) {
        at += Vector2::new(course.cos(), course.sin()) * 3_500.0;
        steps.push(waypoint(origin, at.x, at.y, f64::INFINITY));
    }
    for (from_deg, kt) in [(0, 0.0), (0, 20.0), (90, 20.0), (180, 20.0), (270, 20.0)] {
        let mut flight = Flight::new(steps.clone(), origin, wind(from_deg, kt));
        let mut errors = Vec::new();
        let mut arcs = Vec::new();
        let mut reached = Vec::new();
        let mut since_turn_s = 0.0;
        for _ in 0..100_000 {
            flight.tick();
            reached.extend(flight.follower.reached());
            if reached.len() == steps.len() {
                break;
            }
            let off = flight.follower.track().cross_track_m;
            if flight.follower.is_on_leg() {
                since_turn_s += DT_S;
                errors.push(off);
            } else {
                since_turn_s = 0.0;
                arcs.push(off);
            }
            assert!(since_turn_s < 120.0, "leg {} has no end", reached.len());
        }
        assert_eq!(reached, [0, 1, 2, 3, 4, 5, 6], "{from_deg}");
        let (on_legs, on_arcs) = (rms(&errors), rms(&arcs));
        std::println!("{from_deg} {kt}: legs {on_legs:.1} m, arcs {on_arcs:.1} m");
        assert!(on_legs < 5.0, "{from_deg} {kt}: {on_legs}");
    }
}
