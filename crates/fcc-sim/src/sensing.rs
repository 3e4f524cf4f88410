//! Sensors: measurements from the truth.
//!
//! A measurement is the truth some milliseconds ago, plus a bias, plus noise,
//! rounded to the sensor's resolution. The reading is stamped with the tick
//! that received it: as on a real bus, the delay is unknown to the loop.

use fcc_core::flight::atmosphere::differential_pressure_pa;
use fcc_core::flight::{Attitude, BodyRates, Measurements, SpecificForce, Velocity};
use fcc_core::framework::{Reading, Time};
use libm::round;

use crate::atmosphere::Air;
use crate::config::{Channels, SensorConfig, SimConfig};
use crate::gauss::{Gauss, Stream};
use crate::ground::GroundBelow;
use crate::local_earth::LocalEarth;
use crate::raw::{RawSensors, RawTruth};
use crate::truth::{Truth, half_turn, turn};

/// The sensors of one aircraft.
#[derive(Clone, Debug)]
pub(crate) struct Sensors {
    config: SensorConfig,
    gauss: Gauss,
    earth: LocalEarth,
    magnetic_variation_rad: f64,
}

impl Sensors {
    pub(crate) fn new(config: &SimConfig) -> Self {
        Self {
            config: config.sensors,
            gauss: Gauss::new(config.seed, Stream::Sensors),
            earth: LocalEarth::new(config.latitude_rad, config.longitude_rad),
            magnetic_variation_rad: config.magnetic_variation_rad,
        }
    }

    /// Measures a truth, stamping it `taken`.
    pub(crate) fn measure(&mut self, truth: &Truth, taken: Time, into: &mut Measurements) {
        let SensorConfig {
            noise,
            bias,
            resolution,
            ..
        } = self.config;
        let gauss = &mut self.gauss;
        let mut seen = |value: f64, kind: fn(&Channels) -> f64| {
            let sigma = kind(&noise);
            let mut value = value + kind(&bias);
            if sigma > 0.0 {
                value += sigma * gauss.draw();
            }
            let step = kind(&resolution);
            if step > 0.0 {
                value = step * round(value / step);
            }
            value
        };
        into.attitude = Reading::new(
            Attitude {
                pitch_rad: seen(truth.pitch_rad, |c| c.attitude_rad),
                roll_rad: half_turn(seen(truth.roll_rad, |c| c.attitude_rad)),
            },
            taken,
        );
        let magnetic = truth.heading_rad - self.magnetic_variation_rad;
        into.heading_rad = Reading::new(turn(seen(magnetic, |c| c.heading_rad)), taken);
        into.body_rates = Reading::new(
            BodyRates {
                roll_radps: seen(truth.rates.roll_radps, |c| c.rates_radps),
                pitch_radps: seen(truth.rates.pitch_radps, |c| c.rates_radps),
                yaw_radps: seen(truth.rates.yaw_radps, |c| c.rates_radps),
            },
            taken,
        );
        into.specific_force = Reading::new(
            SpecificForce {
                x_mps2: seen(truth.specific_force.x_mps2, |c| c.specific_force_mps2),
                y_mps2: seen(truth.specific_force.y_mps2, |c| c.specific_force_mps2),
                z_mps2: seen(truth.specific_force.z_mps2, |c| c.specific_force_mps2),
            },
            taken,
        );
        let airspeed_mps = seen(truth.indicated_airspeed_mps, |c| c.airspeed_mps);
        into.airspeed_mps = Reading::new(airspeed_mps.max(0.0), taken);
        into.altitude_m = Reading::new(seen(truth.altitude_m, |c| c.altitude_m), taken);
        into.angle_of_attack_rad = Reading::new(
            seen(truth.angle_of_attack_rad, |c| c.angle_of_attack_rad),
            taken,
        );
        let north_m = seen(truth.north_m, |c| c.position_m);
        let east_m = seen(truth.east_m, |c| c.position_m);
        let height_m = seen(truth.altitude_m, |c| c.position_m);
        into.position = Reading::new(self.earth.position(north_m, east_m, height_m), taken);
        into.velocity = Reading::new(
            Velocity {
                north_mps: seen(truth.velocity.north_mps, |c| c.velocity_mps),
                east_mps: seen(truth.velocity.east_mps, |c| c.velocity_mps),
                down_mps: seen(truth.velocity.down_mps, |c| c.velocity_mps),
            },
            taken,
        );
    }
}

/// The raw sensors of the built-in aircraft.
#[derive(Clone, Debug)]
pub(crate) struct BuiltInRaw {
    sensors: RawSensors,
    earth: LocalEarth,
    ground: GroundBelow,
}

impl BuiltInRaw {
    /// None if there are none.
    pub(crate) fn new(config: &SimConfig, start: &Truth) -> Option<Self> {
        let set = config.raw_sensors.as_ref()?;
        let earth = LocalEarth::new(config.latitude_rad, config.longitude_rad);
        let ground = GroundBelow::new(config);
        let start = raw_truth(start, &earth, &ground);
        Some(Self {
            sensors: RawSensors::new(set, config.seed, &start, config.magnetic_field_ut()),
            earth,
            ground,
        })
    }

    pub(crate) fn step(&mut self, truth: &Truth) {
        self.sensors
            .step(&raw_truth(truth, &self.earth, &self.ground));
    }

    pub(crate) fn read(&mut self, now: Time, into: &mut Measurements) {
        self.sensors.read(now, into);
    }
}

fn raw_truth(truth: &Truth, earth: &LocalEarth, ground: &GroundBelow) -> RawTruth {
    let air = Air::at(truth.altitude_m);
    RawTruth {
        time_s: truth.time_s,
        attitude: Attitude {
            pitch_rad: truth.pitch_rad,
            roll_rad: truth.roll_rad,
        },
        heading_rad: truth.heading_rad,
        rates: truth.rates,
        specific_force: truth.specific_force,
        static_pressure_pa: air.pressure_pa,
        differential_pressure_pa: differential_pressure_pa(truth.indicated_airspeed_mps),
        air_temperature_k: air.temperature_k,
        position: earth.position(truth.north_m, truth.east_m, truth.altitude_m),
        velocity: truth.velocity,
        height_m: truth.altitude_m - ground.elevation_m(truth.north_m, truth.east_m),
        throttle: truth.throttle,
    }
}

/// The truths of the recent past, for delayed sensors.
#[derive(Clone, Debug)]
pub(crate) struct History {
    truths: Box<[Truth]>,
    newest: usize,
    delay_s: f64,
}

/// The shortest interval between stored truths, s. One more truth than the
/// delay has milliseconds is then enough, for any length of sub-steps.
const SPACING_S: f64 = 0.000_999;

impl History {
    /// `None` without a delay.
    pub(crate) fn new(delay_ms: u16, start: &Truth) -> Option<Self> {
        (delay_ms > 0).then(|| Self {
            truths: vec![*start; usize::from(delay_ms) + 3].into_boxed_slice(),
            newest: 0,
            delay_s: f64::from(delay_ms) * 1e-3,
        })
    }

    /// Stores a truth.
    pub(crate) fn store(&mut self, truth: &Truth) {
        let since_s = truth.time_s - self.at(0).time_s;
        if since_s < SPACING_S {
            return;
        }
        self.newest = (self.newest + 1) % self.truths.len();
        if let Some(place) = self.truths.get_mut(self.newest) {
            *place = *truth;
        }
    }

    /// The truth one delay before `now`.
    pub(crate) fn delayed(&self, now: &Truth) -> Truth {
        let wanted_s = now.time_s - self.delay_s;
        let mut after = *now;
        for age in 0..self.truths.len() {
            let before = self.at(age);
            if before.time_s <= wanted_s {
                let span_s = after.time_s - before.time_s;
                if span_s <= 0.0 {
                    return before;
                }
                return before.towards(&after, (wanted_s - before.time_s) / span_s);
            }
            after = before;
        }
        after
    }

    /// The truth stored `age` entries ago.
    fn at(&self, age: usize) -> Truth {
        let length = self.truths.len();
        let index = (self.newest + length - age) % length;
        self.truths.get(index).copied().unwrap_or_default()
    }
}
