//! Any plan at any place, flown by a point mass over a sphere: the commands are finite,
//! and the flight gets on.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use fcc_guidance::path::{BankCommand, LocalPlane};
use fcc_guidance::route::{Destination, Follower, OverGround, Route, RouteConfig, Step, Until};
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;

const EARTH_M: f64 = 6_371_009.0;
const DT_S: f64 = 0.1;
const AIRSPEED_MPS: f64 = 50.0;

/// A point mass on a sphere, by its place and the direction of its nose as vectors:
/// without a date line and poles.
struct PointMass {
    at: Vector3<f64>,
    nose: Vector3<f64>,
    bank: BankCommand,
    altitude_m: f64,
    /// Towards here the wind blows, m/s.
    wind_mps: Vector3<f64>,
}

impl PointMass {
    fn new(latitude_rad: f64, longitude_rad: f64, heading_rad: f64, wind_mps: f64) -> Self {
        let (north, east) = axes(latitude_rad, longitude_rad);
        let mut bank = BankCommand::new(0.52, 0.26);
        bank.reset(0.0);
        Self {
            at: north.cross(&east).scale(-1.0),
            nose: north * heading_rad.cos() + east * heading_rad.sin(),
            bank,
            altitude_m: 500.0,
            wind_mps: (north + east).normalize() * wind_mps,
        }
    }

    fn here(&self) -> OverGround {
        let (latitude_rad, longitude_rad) = (self.at.z.asin(), self.at.y.atan2(self.at.x));
        let (north, east) = axes(latitude_rad, longitude_rad);
        let flat = |v: Vector3<f64>| Vector2::new(v.dot(&north), v.dot(&east));
        let wind_mps = flat(self.wind_mps);
        OverGround {
            latitude_rad,
            longitude_rad,
            altitude_m: self.altitude_m,
            ground_velocity_mps: flat(self.nose) * AIRSPEED_MPS + wind_mps,
            wind_mps,
            true_airspeed_mps: AIRSPEED_MPS,
            airspeed_mps: AIRSPEED_MPS,
            ..OverGround::default()
        }
    }

    fn fly(&mut self, follower: &Follower) {
        let bank = self.bank.step(follower.acceleration_mps2(), DT_S);
        let right = self.nose.cross(&self.at);
        let turned = 9.806_65 * bank.tan() / AIRSPEED_MPS * DT_S;
        self.nose = self.nose * turned.cos() + right * turned.sin();
        let way = (self.nose * AIRSPEED_MPS + self.wind_mps) * DT_S;
        self.at = (self.at + way / EARTH_M).normalize();
        for vector in [&mut self.nose, &mut self.wind_mps] {
            let length = vector.norm();
            *vector -= self.at * vector.dot(&self.at);
            *vector = vector.try_normalize(1e-12).unwrap_or_default() * length;
        }
        let climb_m = follower.altitude_m() - self.altitude_m;
        self.altitude_m += climb_m.clamp(-5.0 * DT_S, 5.0 * DT_S);
    }
}

fn axes(latitude: f64, longitude: f64) -> (Vector3<f64>, Vector3<f64>) {
    (
        Vector3::new(
            -latitude.sin() * longitude.cos(),
            -latitude.sin() * longitude.sin(),
            latitude.cos(),
        ),
        Vector3::new(-longitude.sin(), longitude.cos(), 0.0),
    )
}

/// A place at a distance in m in a direction, by spherical trigonometry.
fn ahead((latitude, longitude): (f64, f64), course: f64, distance_m: f64) -> (f64, f64) {
    let (north, east) = axes(latitude, longitude);
    let up = north.cross(&east).scale(-1.0);
    let way = north * course.cos() + east * course.sin();
    let angle = distance_m / EARTH_M;
    let there = up * angle.cos() + way * angle.sin();
    (there.z.asin(), there.y.atan2(there.x))
}

#[derive(Clone, Debug)]
struct Drawn {
    kind: u8,
    course: f64,
    distance_m: f64,
    value: f64,
    flag: bool,
}

fn drawn() -> impl Strategy<Value = Drawn> {
    (0..9_u8, -PI..PI, 0.0..6_000.0, 0.0..1.0, any::<bool>()).prop_map(
        |(kind, course, distance_m, value, flag)| Drawn {
            kind,
            course,
            distance_m,
            value,
            flag,
        },
    )
}

/// Steps one after the other; returns the length of their legs as well, m.
fn steps(drawn: &[Drawn], begin: (f64, f64)) -> (Vec<Step>, f64) {
    let (mut at, mut length_m) = (begin, 0.0);
    let mut steps = Vec::new();
    for each in drawn {
        let there = ahead(at, each.course, each.distance_m);
        let altitude_m = 500.0 + 200.0 * each.value;
        let plane = LocalPlane::at(there.0, there.1);
        let loiter = |until| Step::Loiter {
            at: each.flag.then_some(plane),
            altitude_m,
            radius_m: 600.0 + 1_000.0 * each.value,
            clockwise: each.flag,
            until,
            leave_towards_next: !each.flag,
        };
        steps.push(match each.kind {
            0..=2 => Step::Waypoint {
                at: plane,
                altitude_m,
                within_m: if each.flag {
                    f64::INFINITY
                } else {
                    100.0 * each.value
                },
            },
            3 => loiter(Until::Turned(TAU * each.value)),
            4 => loiter(Until::Elapsed(60.0 * each.value)),
            5 => loiter(Until::AtAltitude),
            6 => Step::Delay(60.0 * each.value),
            7 => Step::Altitude(altitude_m),
            _ => Step::GroundSpeed(40.0 + 20.0 * each.value),
        });
        if steps.last().is_some_and(Step::is_flown) {
            at = there;
            length_m += each.distance_m + 40_000.0;
        }
    }
    (steps, length_m)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn any_plan_anywhere_is_flown_to_its_end(
        drawn in proptest::collection::vec(drawn(), 1..7),
        latitude in -FRAC_PI_2..FRAC_PI_2,
        longitude in -PI..PI,
        near_pole in any::<bool>(),
        heading in -PI..PI,
        wind_mps in 0.0..15.0,
    ) {
        let latitude = if near_pole { latitude.signum() * (FRAC_PI_2 - 1e-4) } else { latitude };
        let (steps, length_m) = steps(&drawn, (latitude, longitude));
        let last = steps.iter().rposition(Step::is_flown);
        let home = [Destination { at: LocalPlane::at(latitude, longitude), altitude_m: 600.0 }];
        let route = Route {
            steps: steps.leak(),
            returns: Box::leak(Box::new(home)),
            ..Route::default()
        };
        let config = RouteConfig::default();
        let mut follower = Follower::along(route, 0, config, AIRSPEED_MPS);
        let mut aircraft = PointMass::new(latitude, longitude, heading, wind_mps);
        let mut reached = None;
        let ticks = (length_m / (AIRSPEED_MPS - wind_mps) / DT_S) as usize;
        for _ in 0..ticks {
            follower.advance(&aircraft.here(), DT_S);
            prop_assert!(follower.acceleration_mps2().is_finite());
            prop_assert!(follower.altitude_m().is_finite());
            prop_assert!((0.0..500.0).contains(&follower.airspeed_mps()));
            aircraft.fly(&follower);
            reached = follower.reached().map(usize::from).or(reached);
            if reached == last {
                return Ok(());
            }
        }
        prop_assert_eq!(reached, last, "of {:?}", drawn);
    }
}
