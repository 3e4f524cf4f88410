//! Glides of a point mass in wind and gusts, from where the engine stops to the touch.

use std::boxed::Box;
use std::vec;

use nalgebra::Vector2;

use super::{GlideConfig, LocalPlane};
use crate::path::simulation::{DT_S, KT, PointMass, wind};
use crate::route::{Destination, Follower, OverGround, Route, RouteConfig, RunwayPhase, Step};
use fcc_core::flight::earth::metres_per_radian;

const LATITUDE: f64 = 0.82;
const LONGITUDE: f64 = 0.14;
/// Steady vertical gusts, one standard deviation and time constant: MIL-F-8785C, low
/// altitude, light: 0.1 of 20 ft/s at 20 ft, and 200 m at 65 kt.
const GUST_MPS: f64 = 0.61;
const GUST_S: f64 = 6.0;
/// The runway, from its aim.
const BEFORE_AIM_M: f64 = 300.0;
const BEHIND_AIM_M: f64 = 500.0;
/// The braking of the roll-out, m/s²: the ground roll of 540 ft in the handbook of the Cessna
/// 172P (1981), from 46 kt.
const BRAKES_MPS2: f64 = 1.7;
/// The wheels touch with this much left of the flare, m.
const TOUCHES_M: f64 = 0.5;

/// Numbers of `SplitMix64` (Steele, Lea and Flood 2014), from 0 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits ^ (bits >> 31)) as f64 / u64::MAX as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }

    /// Of a normal distribution, as the sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

fn place(at_m: Vector2<f64>) -> (f64, f64) {
    let (north, east) = metres_per_radian(LATITUDE, 0.0);
    (LATITUDE + at_m.x / north, LONGITUDE + at_m.y / east)
}

fn plane(at_m: Vector2<f64>) -> LocalPlane {
    let (latitude, longitude) = place(at_m);
    LocalPlane::at(latitude, longitude)
}

/// Where it touched, m north and east of the aim, and how far north of it it stands.
#[derive(Debug)]
struct Landed {
    touch_m: Vector2<f64>,
    stands_m: f64,
}

impl Landed {
    fn is_good(&self) -> bool {
        let fits = |north_m: f64| (-BEFORE_AIM_M..=BEHIND_AIM_M).contains(&north_m);
        fits(self.touch_m.x) && fits(self.stands_m) && self.touch_m.y.abs() < 15.0
    }
}

/// A glide from 3,000 ft, 1 to 4 km from the aim of a runway to the north, in up to 15 kt from
/// anywhere, whose glide ratio is up to a tenth off the configured one.
fn glide(seed: u64) -> Landed {
    let mut numbers = Numbers(seed);
    let bearing = numbers.between(0.0, core::f64::consts::TAU);
    let distance_m = numbers.between(1_000.0, 4_000.0);
    let from_deg = numbers.between(0.0, 360.0) as i32;
    let wind_mps = wind(from_deg, numbers.between(0.0, 15.0));
    let ratio = 9.0 * numbers.between(0.9, 1.1);
    let sine = 1.0 / libm::sqrt(1.0 + ratio * ratio);
    let mut aircraft = PointMass::new(65.0, wind_mps, 0.5);
    aircraft.position_m = Vector2::new(bearing.cos(), bearing.sin()) * distance_m;
    aircraft.heading_rad = numbers.between(0.0, core::f64::consts::TAU);
    let home_m = aircraft.position_m - aircraft.motion().ground_velocity_mps * 40.0;
    let steps = vec![
        Step::Waypoint {
            at: plane(Vector2::new(-6_000.0, 0.0)),
            altitude_m: 300.0,
            within_m: f64::INFINITY,
        },
        Step::Land {
            at: plane(Vector2::zeros()),
            elevation_m: 0.0,
            abort_altitude_m: 150.0,
        },
    ];
    let returns = vec![Destination {
        at: plane(home_m),
        altitude_m: 150.0,
    }];
    let route = Route {
        steps: Box::leak(steps.into_boxed_slice()),
        returns: Box::leak(returns.into_boxed_slice()),
        ..Route::default()
    };
    let config = GlideConfig {
        airspeed_mps: 65.0 * KT,
        ratio: 9.0,
        spare_m: 60.96,
    };
    let mut follower = Follower::gliding(route, RouteConfig::default(), config);
    let (mut altitude_m, mut gust_mps, mut bank_rad) = (940.0_f64, 0.0_f64, 0.0_f64);
    while altitude_m > TOUCHES_M {
        let motion = aircraft.motion();
        let (latitude_rad, longitude_rad) = place(motion.position_m);
        let here = OverGround {
            latitude_rad,
            longitude_rad,
            altitude_m,
            ground_velocity_mps: motion.ground_velocity_mps,
            wind_mps,
            true_airspeed_mps: aircraft.airspeed_mps,
            airspeed_mps: aircraft.airspeed_mps,
            roll_rad: bank_rad,
            height_m: (altitude_m < 40.0).then_some(altitude_m + 1.3),
            on_wheels: Some(false),
            ..OverGround::default()
        };
        follower.advance(&here, DT_S);
        bank_rad = aircraft.fly(follower.acceleration_mps2());
        gust_mps += -gust_mps * DT_S / GUST_S
            + GUST_MPS * libm::sqrt(2.0 * DT_S / GUST_S) * numbers.normal();
        let load: f64 = 1.0 / libm::cos(bank_rad);
        let glide_mps = aircraft.airspeed_mps * sine * 0.5 * (1.0 + load * load) + gust_mps;
        let flare = follower
            .runway()
            .filter(|demand| demand.phase == RunwayPhase::Flare);
        let sink_mps = match flare {
            Some(demand) => {
                let slows_mps2 = 9.81 * (glide_mps + demand.climb_rate_mps) / aircraft.airspeed_mps;
                aircraft.airspeed_mps -= slows_mps2 * DT_S;
                -demand.climb_rate_mps
            }
            None => glide_mps,
        };
        altitude_m -= sink_mps * DT_S;
    }
    let motion = aircraft.motion();
    let north_mps = motion.ground_velocity_mps.x;
    let rolls_m = north_mps * north_mps.abs() / (2.0 * BRAKES_MPS2);
    Landed {
        touch_m: motion.position_m,
        stands_m: motion.position_m.x + rolls_m,
    }
}

/// Issue: from 3,000 ft within glide on the runway, 18 of 20.
#[test]
fn from_3_000_ft_it_lands_on_the_runway() {
    let seeds = 200;
    let mut good = 0;
    for seed in 1..=seeds {
        let landed = glide(seed);
        good += u64::from(landed.is_good());
        if !landed.is_good() {
            std::println!("{seed}: {landed:?}");
        }
    }
    std::println!("{good} of {seeds}");
    assert!(good * 10 >= seeds * 9, "{good}");
}
