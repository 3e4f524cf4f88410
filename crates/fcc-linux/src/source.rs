//! What a device gives.

use core::time::Duration;

use fcc_core::flight::{BodyRates, MagneticField, Measurements, SpecificForce};
use fcc_core::framework::{Reading, Time};

use crate::DeviceError;

/// How long [`Source::read`] waits at most: its thread has to notice that it is
/// to end.
pub const WAIT: Duration = Duration::from_millis(100);

/// An open device.
pub trait Source {
    /// What it measures.
    type Value: Measured;

    /// Waits for the next sample; `None` if there is none within about
    /// [`WAIT`]. Runs in a thread of its own, and may allocate.
    ///
    /// # Errors
    /// After [`DeviceError::Malformed`] it is read again, after any other error
    /// closed, and opened anew after a pause.
    fn read(&mut self) -> Result<Option<Sample<Self::Value>>, DeviceError>;
}

/// What was measured, and when, on the loop's clock.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sample<V> {
    /// When it was taken.
    pub taken: Time,
    /// What was measured, as the sensor gives it: in SI units, in its own axes,
    /// without calibration.
    pub value: V,
}

impl<V> Sample<V> {
    /// A value that was taken at a time.
    pub const fn new(taken: Time, value: V) -> Self {
        Self { taken, value }
    }
}

/// A measured value, and where it belongs in the measurements.
pub trait Measured: Copy + Send + 'static {
    /// Writes a sample to its place.
    fn write(sample: &Sample<Self>, into: &mut Measurements);

    /// Two samples of the same tick as one, such as their mean. `None`, the
    /// default, writes them one after the other.
    fn merged(_earlier: &Sample<Self>, _later: &Sample<Self>) -> Option<Sample<Self>> {
        None
    }
}

/// Specific force and turn rates of an inertial sensor, the mean of so many
/// samples.
///
/// A loop is slower than such a sensor. The mean of all samples since the last
/// tick keeps what the aircraft turned by, and averages its vibration, where a
/// single sample would alias it.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Inertial {
    /// m/s², in the sensor's axes.
    pub specific_force_mps2: [f64; 3],
    /// rad/s, in the sensor's axes.
    pub rates_radps: [f64; 3],
    /// How many samples this is the mean of.
    pub samples: u32,
}

impl Measured for Inertial {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        let [x_mps2, y_mps2, z_mps2] = sample.value.specific_force_mps2;
        let force = SpecificForce {
            x_mps2,
            y_mps2,
            z_mps2,
        };
        let [roll_radps, pitch_radps, yaw_radps] = sample.value.rates_radps;
        let rates = BodyRates {
            roll_radps,
            pitch_radps,
            yaw_radps,
        };
        into.raw_specific_force = Reading::new(force, sample.taken);
        into.raw_body_rates = Reading::new(rates, sample.taken);
    }

    fn merged(earlier: &Sample<Self>, later: &Sample<Self>) -> Option<Sample<Self>> {
        let (a, b) = (&earlier.value, &later.value);
        let samples = a.samples.saturating_add(b.samples);
        if samples == 0 {
            return None;
        }
        let weight = f64::from(b.samples) / f64::from(samples);
        let mean = |[x, y, z]: [f64; 3], [u, v, w]: [f64; 3]| {
            [
                x + weight * (u - x),
                y + weight * (v - y),
                z + weight * (w - z),
            ]
        };
        let between_ns = (later.taken - earlier.taken) as f64 * weight;
        let after = Duration::from_nanos(between_ns.max(0.0) as u64);
        Some(Sample {
            taken: earlier.taken + after,
            value: Self {
                specific_force_mps2: mean(a.specific_force_mps2, b.specific_force_mps2),
                rates_radps: mean(a.rates_radps, b.rates_radps),
                samples,
            },
        })
    }
}

/// The magnetic field, of a magnetometer.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Field {
    /// µT, in the sensor's axes.
    pub field_ut: [f64; 3],
}

impl Measured for Field {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        let [x_ut, y_ut, z_ut] = sample.value.field_ut;
        into.magnetic_field = Reading::new(MagneticField { x_ut, y_ut, z_ut }, sample.taken);
    }
}

/// Static pressure, of a barometer.
///
/// The temperature that a barometer measures as well is its own, and not that
/// of the air outside.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct StaticPressure {
    /// Pa.
    pub pressure_pa: f64,
}

impl Measured for StaticPressure {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        into.static_pressure_pa = Reading::new(sample.value.pressure_pa, sample.taken);
    }
}

/// Total minus static pressure, of a pitot tube.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct DifferentialPressure {
    /// Pa.
    pub pressure_pa: f64,
}

impl Measured for DifferentialPressure {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        into.differential_pressure_pa = Reading::new(sample.value.pressure_pa, sample.taken);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inertial(ns: i64, samples: u32, value: f64) -> Sample<Inertial> {
        Sample::new(
            Time::from_nanos(ns),
            Inertial {
                specific_force_mps2: [value; 3],
                rates_radps: [-value; 3],
                samples,
            },
        )
    }

    /// One sample of 1 and three of 5: their mean is 4.
    #[test]
    fn batches_are_weighted_by_their_samples() {
        let merged = Inertial::merged(&inertial(1_000, 1, 1.0), &inertial(5_000, 3, 5.0));
        assert_eq!(merged, Some(inertial(4_000, 4, 4.0)));
    }
}
