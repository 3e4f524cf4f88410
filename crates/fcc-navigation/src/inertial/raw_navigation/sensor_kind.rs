//! What several sensors of a loop may measure, and how far two of them are from each other.

use core::time::Duration;

use nalgebra::Vector3;

use super::super::Observation;
use super::readings::{field_in, force_in, place_in, rates_in, velocity_in};
use fcc_core::blocks::wrap_pi;
use fcc_core::flight::Measurements;
use fcc_core::flight::atmosphere::pressure_altitude_m;
use fcc_core::flight::earth::metres_per_radian;
use fcc_core::framework::{Reading, ReadingSet, Readings, Time};

/// Two sound sensors differ by less: rates, rad/s (3 °/s); specific force, m/s²; magnetic
/// field, µT; altitude by static pressure, m; a receiver's position, m, and velocity, m/s.
/// Each is more than what the datasheets of consumer sensors allow after a calibration.
const RATES_RADPS: f64 = 0.052;
const FORCE_MPS2: f64 = 1.5;
const FIELD_UT: f64 = 10.0;
const ALTITUDE_M: f64 = 20.0;
const POSITION_M: f64 = 20.0;
const VELOCITY_MPS: f64 = 3.0;
/// ... and by this share of the smaller one: scale and axes.
const SHARE: f64 = 0.05;
/// The acceleration of an aircraft between two samples, m/s²: a turn with 27° of bank.
const ACCELERATION_MPS2: f64 = 5.0;
/// Samples that were taken within this time of each other are compared; fixes of receivers
/// come once a second.
const TOGETHER: Duration = Duration::from_millis(100);
const FIXES_TOGETHER: Duration = Duration::from_secs(1);

/// A kind of raw sensor of which there may be several.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SensorKind {
    /// Gyroscopes and accelerometers.
    InertialUnit,
    /// Magnetometers.
    Magnetometer,
    /// Barometers: static pressure.
    Barometer,
    /// Satellite receivers.
    Receiver,
}

/// What a sensor measured of one quantity, the number of the sensor, and when.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) sensor: u8,
    pub(super) taken: Time,
    pub(super) observation: Observation,
}

impl Sample {
    /// The velocity, if it is one: north, east, down, m/s.
    pub(super) const fn velocity(&self) -> [f64; 3] {
        match self.observation {
            Observation::Velocity(velocity) => velocity,
            _ => [0.0; 3],
        }
    }
}

/// Of the two quantities that a sensor may measure: rates and specific force, position and
/// velocity; of others the first alone.
pub(super) type Samples = [Option<Sample>; 2];

impl SensorKind {
    pub(super) const ALL: [Self; 4] = [
        Self::InertialUnit,
        Self::Magnetometer,
        Self::Barometer,
        Self::Receiver,
    ];

    /// The kind that an observation is of, and which of its two quantities it is.
    pub(super) const fn of(observation: &Observation) -> Option<(Self, usize)> {
        Some(match observation {
            Observation::Rates(_) => (Self::InertialUnit, 0),
            Observation::SpecificForce(_) => (Self::InertialUnit, 1),
            Observation::MagneticField(_) => (Self::Magnetometer, 0),
            Observation::StaticPressure(_) => (Self::Barometer, 0),
            Observation::Position(_) => (Self::Receiver, 0),
            Observation::Velocity(_) => (Self::Receiver, 1),
            Observation::DifferentialPressure(_) | Observation::Airspeed(_) => return None,
        })
    }

    /// Its readings.
    pub(super) const fn readings(self) -> ReadingSet {
        const fn named(names: &[&str]) -> ReadingSet {
            ReadingSet::named(Measurements::NAMES, names)
        }
        const UNIT: ReadingSet = named(&["raw acceleration", "raw body rates"]);
        const MAGNETOMETER: ReadingSet = named(&["magnetic field"]);
        const BAROMETER: ReadingSet = named(&["static pressure"]);
        const RECEIVER: ReadingSet = named(&["satellite navigation"]);
        match self {
            Self::InertialUnit => UNIT,
            Self::Magnetometer => MAGNETOMETER,
            Self::Barometer => BAROMETER,
            Self::Receiver => RECEIVER,
        }
    }

    /// Its samples among the measurements.
    pub(super) fn samples(self, measured: &Measurements) -> Samples {
        let m = measured;
        match self {
            Self::InertialUnit => [
                sample(&m.raw_body_rates, |of| Observation::Rates(rates_in(of))),
                sample(&m.raw_specific_force, |of| {
                    Observation::SpecificForce(force_in(of))
                }),
            ],
            Self::Magnetometer => [
                sample(&m.magnetic_field, |of| {
                    Observation::MagneticField(field_in(of))
                }),
                None,
            ],
            Self::Barometer => [
                sample(&m.static_pressure_pa, |pa| Observation::StaticPressure(*pa)),
                None,
            ],
            Self::Receiver => [
                sample(&m.gnss, |fix| Observation::Position(place_in(fix))),
                sample(&m.gnss, |fix| Observation::Velocity(velocity_in(fix))),
            ],
        }
    }
}

fn sample<T>(reading: &Reading<T>, says: impl FnOnce(&T) -> Observation) -> Option<Sample> {
    (!reading.is_never()).then(|| Sample {
        sensor: reading.source,
        taken: reading.taken,
        observation: says(&reading.value),
    })
}

/// How far a sample is from another of the same quantity that was taken at about the same
/// time, as a share of what two sound sensors differ by at most: at 1 and above they
/// disagree. The aircraft moves with a velocity, north, east, down, m/s.
pub(super) fn difference(of: &Sample, from: &Sample, velocity: [f64; 3]) -> Option<Vector3<f64>> {
    let dt_s = if of.taken >= from.taken {
        of.taken.since(from.taken).as_secs_f64()
    } else {
        -from.taken.since(of.taken).as_secs_f64()
    };
    let (of, from, most, together) = match (of.observation, from.observation) {
        (Observation::Rates(of), Observation::Rates(from)) => (of, from, RATES_RADPS, TOGETHER),
        (Observation::SpecificForce(of), Observation::SpecificForce(from)) => {
            (of, from, FORCE_MPS2, TOGETHER)
        }
        (Observation::MagneticField(of), Observation::MagneticField(from)) => {
            (of, from, FIELD_UT, TOGETHER)
        }
        (Observation::StaticPressure(of), Observation::StaticPressure(from)) => {
            let apart = pressure_altitude_m(of) - pressure_altitude_m(from);
            ([apart, 0.0, 0.0], [0.0; 3], ALTITUDE_M, TOGETHER)
        }
        (Observation::Position(of), Observation::Position(from)) => {
            let (north, east) = metres_per_radian(from.latitude_rad, from.altitude_m);
            let apart = [
                (of.latitude_rad - from.latitude_rad) * north,
                wrap_pi(of.longitude_rad - from.longitude_rad) * east,
                from.altitude_m - of.altitude_m,
            ];
            (
                apart,
                velocity.map(|v| v * dt_s),
                POSITION_M,
                FIXES_TOGETHER,
            )
        }
        (Observation::Velocity(of), Observation::Velocity(from)) => {
            let most = VELOCITY_MPS + ACCELERATION_MPS2 * dt_s.abs();
            (of, from, most, FIXES_TOGETHER)
        }
        _ => return None,
    };
    let (of, from) = (Vector3::from(of), Vector3::from(from));
    let apart = (of - from) / (most + SHARE * of.norm().min(from.norm()));
    let are_comparable = dt_s.abs() <= together.as_secs_f64() && apart.norm().is_finite();
    are_comparable.then_some(apart)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertial::GeodeticPosition;

    /// On the equator, of 6,378,137 m, 2e-6 rad are 12.756 m: 0.638 of 20 m.
    #[test]
    fn receivers_on_both_sides_of_180_degrees_are_as_far_apart_as_elsewhere() {
        let at = |longitude_rad| Sample {
            sensor: 0,
            taken: Time::from_nanos(0),
            observation: Observation::Position(GeodeticPosition {
                latitude_rad: 0.0,
                longitude_rad,
                altitude_m: 0.0,
            }),
        };
        let west = core::f64::consts::PI - 1e-6;
        let apart = difference(&at(-west), &at(west), [0.0; 3]).unwrap();
        assert!((apart.y - 0.638).abs() < 1e-3 && apart.x == 0.0, "{apart}");
    }
}
