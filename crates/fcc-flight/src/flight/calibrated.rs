//! A sensor whose raw readings are calibrated.

use std::time::Duration;

use fcc_calibration::Calibration;
use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, SensorFault, Tick};

use crate::config::CalibrationSection;

/// A sensor, and the calibration of its raw readings: they are calibrated here
/// and nowhere else.
struct Calibrated {
    sensor: Box<dyn Sensor<Measurements>>,
    calibration: Calibration,
    /// What the sensor gave.
    given: Measurements,
}

/// The sensor with this calibration, if it has one that changes anything.
pub(super) fn calibrated(
    sensor: Box<dyn Sensor<Measurements>>,
    section: Option<&CalibrationSection>,
) -> Box<dyn Sensor<Measurements>> {
    match section.and_then(CalibrationSection::to_core) {
        Some(calibration) => Box::new(Calibrated {
            sensor,
            calibration,
            given: Measurements::default(),
        }),
        None => sensor,
    }
}

#[deny(
    clippy::missing_trait_methods,
    reason = "a method that is not passed on would have its default"
)]
impl Sensor<Measurements> for Calibrated {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let sampled = self.sensor.sample(tick, &mut self.given);
        *into = self.calibration.applied(&self.given);
        sampled
    }

    fn fallback_after(&self) -> Duration {
        self.sensor.fallback_after()
    }

    fn warm_up(&self, tick: &Tick) {
        self.sensor.warm_up(tick);
    }

    fn name(&self) -> &str {
        self.sensor.name()
    }
}

#[cfg(test)]
mod tests {
    use fcc_calibration::ScalarCalibration;
    use fcc_core::framework::{Reading, Time};

    use super::*;

    /// Gives a pressure once, and an altitude in every tick.
    struct Barometer {
        pressure_pa: Option<f64>,
    }

    impl Sensor<Measurements> for Barometer {
        fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
            into.altitude_m = Reading::new(1_000.0, tick.woke);
            let pressure_pa = self.pressure_pa.take().ok_or(SensorFault::Silent)?;
            into.static_pressure_pa = Reading::new(pressure_pa, tick.woke);
            Ok(())
        }

        fn name(&self) -> &'static str {
            "barometer"
        }
    }

    #[test]
    fn a_reading_that_stays_is_calibrated_once() {
        let calibration = Calibration {
            static_pressure: ScalarCalibration {
                bias: 30.0,
                delay: Duration::from_millis(20),
                ..ScalarCalibration::default()
            },
            ..Calibration::default()
        };
        let barometer = Barometer {
            pressure_pa: Some(90_030.0),
        };
        let mut sensor = Calibrated {
            sensor: Box::new(barometer),
            calibration,
            given: Measurements::default(),
        };
        let mut measured = Measurements::default();
        for (tick, sampled) in [(1, Ok(())), (2, Err(SensorFault::Silent))] {
            let woke = Time::from_nanos(tick * 25_000_000);
            let tick = Tick {
                woke,
                ..Tick::default()
            };
            assert_eq!(sensor.sample(&tick, &mut measured), sampled);
            let taken = Time::from_nanos(5_000_000);
            assert_eq!(measured.static_pressure_pa, Reading::new(90_000.0, taken));
            assert_eq!(measured.altitude_m, Reading::new(1_000.0, woke));
        }
    }
}
