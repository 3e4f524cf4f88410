//! A flight whose motion is known: coordinated turns in a steady wind.

use fcc_core::flight::earth::{gravity_mps2, metres_per_radian};
use fcc_core::flight::orientation::{EulerAngles, earth_to_body, product, quaternion_from_euler};
use fcc_navigation::inertial::GeodeticPosition;

use super::noise::Random;

/// The angle of attack, which the filter is not told.
const ATTACK_RAD: f64 = 0.04;

/// What is flown at a time: bank and flight path angle, rad, airspeed, m/s.
pub(crate) type Manoeuvre = fn(f64) -> (f64, f64, f64);

/// The truth, and what ideal inertial sensors show of the step that led to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) time_s: f64,
    pub(crate) angles: EulerAngles,
    pub(crate) quaternion: [f64; 4],
    pub(crate) velocity: [f64; 3],
    pub(crate) place: GeodeticPosition,
    /// Metres north and east of the start.
    pub(crate) path: [f64; 2],
    pub(crate) airspeed: f64,
    /// Averages of the step.
    pub(crate) rates: [f64; 3],
    pub(crate) force: [f64; 3],
    /// Over the ground, m/s², of the step.
    pub(crate) acceleration: [f64; 3],
}

pub(crate) struct Flight {
    pub(crate) now: Truth,
    manoeuvre: Manoeuvre,
    wind: [f64; 2],
    turbulence: Option<Turbulence>,
}

/// Air whose horizontal velocity changes: 4 m/s over 533 m, each axis (σ of severe
/// turbulence, and the scale length of MIL-F-8785C above 2,000 ft), behind a lag of
/// 2 s, with which the aircraft is carried along.
struct Turbulence {
    random: Random,
    air: [f64; 2],
    carried: [f64; 2],
}

impl Turbulence {
    fn step(&mut self, airspeed: f64, dt_s: f64) {
        let kept = (-dt_s * airspeed / 533.0).exp();
        for (air, carried) in self.air.iter_mut().zip(&mut self.carried) {
            *air = kept * *air + self.random.normal(4.0 * (1.0 - kept * kept).sqrt());
            *carried += (*air - *carried) * dt_s / 2.0;
        }
    }
}

impl Flight {
    pub(crate) fn new(manoeuvre: Manoeuvre, heading_rad: f64, wind: [f64; 2]) -> Self {
        let mut flight = Self {
            now: Truth {
                time_s: 0.0,
                angles: EulerAngles {
                    heading_rad,
                    ..EulerAngles::default()
                },
                quaternion: [1.0, 0.0, 0.0, 0.0],
                velocity: [0.0; 3],
                place: GeodeticPosition {
                    latitude_rad: 47.0_f64.to_radians(),
                    longitude_rad: 8.0_f64.to_radians(),
                    altitude_m: 500.0,
                },
                path: [0.0; 2],
                airspeed: 0.0,
                rates: [0.0; 3],
                force: [0.0; 3],
                acceleration: [0.0; 3],
            },
            manoeuvre,
            wind,
            turbulence: None,
        };
        flight.set(0.0, heading_rad);
        flight
    }

    /// The same in turbulence.
    pub(crate) fn in_turbulence(mut self, seed: u64) -> Self {
        self.turbulence = Some(Turbulence {
            random: Random::new(seed),
            air: [0.0; 2],
            carried: [0.0; 2],
        });
        self
    }

    fn set(&mut self, time_s: f64, heading_rad: f64) {
        let (roll_rad, climb_rad, airspeed) = (self.manoeuvre)(time_s);
        let angles = EulerAngles {
            roll_rad,
            pitch_rad: climb_rad + ATTACK_RAD,
            heading_rad,
        };
        let level = airspeed * climb_rad.cos();
        let gust = self.turbulence.as_ref().map_or([0.0; 2], |air| air.carried);
        let now = &mut self.now;
        now.time_s = time_s;
        now.angles = angles;
        now.quaternion = quaternion_from_euler(angles);
        now.velocity = [
            level * heading_rad.cos() + self.wind[0] + gust[0],
            level * heading_rad.sin() + self.wind[1] + gust[1],
            -airspeed * climb_rad.sin(),
        ];
        now.airspeed = airspeed;
    }

    /// Flies on by `dt_s`.
    pub(crate) fn step(&mut self, dt_s: f64) {
        let before = self.now;
        let gravity = gravity_mps2(before.place.latitude_rad, before.place.altitude_m);
        let midway = before.time_s + 0.5 * dt_s;
        let (bank, _, airspeed) = (self.manoeuvre)(midway);
        let turn = if airspeed > 1.0 {
            gravity * bank.tan() / airspeed
        } else {
            0.0
        };
        if let Some(turbulence) = &mut self.turbulence {
            turbulence.step(airspeed, dt_s);
        }
        self.set(
            before.time_s + dt_s,
            before.angles.heading_rad + turn * dt_s,
        );
        let now = &mut self.now;
        let mean = |axis: usize| 0.5 * (before.velocity[axis] + now.velocity[axis]);
        let (north, east) = metres_per_radian(before.place.latitude_rad, before.place.altitude_m);
        now.place.latitude_rad += mean(0) * dt_s / north;
        now.place.longitude_rad += mean(1) * dt_s / east;
        now.place.altitude_m -= mean(2) * dt_s;
        now.path[0] += mean(0) * dt_s;
        now.path[1] += mean(1) * dt_s;
        let [w, x, y, z] = before.quaternion;
        let [w, x, y, z] = product([w, -x, -y, -z], now.quaternion);
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        let length = (x * x + y * y + z * z).sqrt();
        let angle = 2.0 * length.atan2(sign * w);
        let per_part = if length > 0.0 {
            sign * angle / length
        } else {
            2.0
        };
        now.rates = [x, y, z].map(|part| part * per_part / dt_s);
        let sum = [0, 1, 2, 3].map(|part| before.quaternion[part] + sign * now.quaternion[part]);
        now.acceleration =
            [0, 1, 2].map(|axis| (now.velocity[axis] - before.velocity[axis]) / dt_s);
        let [north, east, down] = now.acceleration;
        now.force = earth_to_body(sum, [north, east, down - gravity]);
    }
}
