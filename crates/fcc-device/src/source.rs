//! What a device gives.

use core::time::Duration;

use fcc_core::flight::{BodyRates, MagneticField, Measurements, SpecificForce};
use fcc_core::framework::{Reading, Switch, Time};

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

    /// What it waits for, if it works and says that it has no sample yet, as a
    /// receiver without a fix does: and what to do about that.
    fn waits_for(&self) -> Option<&'static str> {
        None
    }
}

/// What receivers of satellites wait for.
pub const NO_FIX: &str = "it has no three-dimensional fix: give its antenna a free view of \
                                 the sky, and wait; the first takes minutes";

/// What is said of receivers whose altitudes are too far apart for a
/// [`VerticalSpeed`](crate::VerticalSpeed).
pub const SLOW_FIXES: &str = "it has less than one fix in a second: set it to at least 1 Hz";

/// What is said of receivers whose fixes are all of an epoch that was there before.
pub const REPEATED_FIX: &str = "its fixes repeat a time, or go back in time, and are not used: \
                                start it anew, and what passes its messages on";

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

/// What a chip measures at one time, as it gives it: without calibration, in its
/// own axes, the mean of so many samples. `None`: it does not measure that.
///
/// A loop is slower than most chips. The mean of all samples since the last tick
/// keeps what the aircraft turned by, and averages its vibration, where a single
/// sample would alias it.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct RawValues {
    /// Of an accelerometer, m/s².
    pub specific_force_mps2: Option<[f64; 3]>,
    /// Of a gyroscope, rad/s.
    pub rates_radps: Option<[f64; 3]>,
    /// Of a magnetometer, µT.
    pub field_ut: Option<[f64; 3]>,
    /// Of a barometer, Pa.
    pub static_pressure_pa: Option<f64>,
    /// Of a pitot tube: total minus static pressure, Pa.
    pub differential_pressure_pa: Option<f64>,
    /// Of the air outside, K. The temperature that a barometer or an inertial
    /// sensor measures is its own.
    pub air_temperature_k: Option<f64>,
    /// To the ground, m.
    pub range_m: Option<f64>,
    /// How many samples this is the mean of.
    pub samples: u32,
}

impl RawValues {
    /// One sample, in which nothing was measured yet.
    pub const NONE: Self = Self {
        specific_force_mps2: None,
        rates_radps: None,
        field_ut: None,
        static_pressure_pa: None,
        differential_pressure_pa: None,
        air_temperature_k: None,
        range_m: None,
        samples: 1,
    };

    /// The mean of two that have the same values.
    fn mean(&self, later: &Self) -> Result<Self, Unlike> {
        let samples = self.samples.saturating_add(later.samples).max(1);
        let weight = f64::from(later.samples) / f64::from(samples);
        let number = |a: f64, b: f64| a + weight * (b - a);
        let vector =
            |[x, y, z]: [f64; 3], [u, v, w]: [f64; 3]| [number(x, u), number(y, v), number(z, w)];
        Ok(Self {
            specific_force_mps2: both(self.specific_force_mps2, later.specific_force_mps2, vector)?,
            rates_radps: both(self.rates_radps, later.rates_radps, vector)?,
            field_ut: both(self.field_ut, later.field_ut, vector)?,
            static_pressure_pa: both(self.static_pressure_pa, later.static_pressure_pa, number)?,
            differential_pressure_pa: both(
                self.differential_pressure_pa,
                later.differential_pressure_pa,
                number,
            )?,
            air_temperature_k: both(self.air_temperature_k, later.air_temperature_k, number)?,
            range_m: both(self.range_m, later.range_m, number)?,
            samples,
        })
    }
}

/// Only one of two samples has a value.
struct Unlike;

/// The mean of a value that both samples have, or neither.
fn both<T>(a: Option<T>, b: Option<T>, mean: impl Fn(T, T) -> T) -> Result<Option<T>, Unlike> {
    match (a, b) {
        (Some(a), Some(b)) => Ok(Some(mean(a, b))),
        (None, None) => Ok(None),
        _ => Err(Unlike),
    }
}

impl Measured for RawValues {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        let (taken, value) = (sample.taken, &sample.value);
        if let Some([x_mps2, y_mps2, z_mps2]) = value.specific_force_mps2 {
            let force = SpecificForce {
                x_mps2,
                y_mps2,
                z_mps2,
            };
            into.raw_specific_force = Reading::new(force, taken);
        }
        if let Some([roll_radps, pitch_radps, yaw_radps]) = value.rates_radps {
            let rates = BodyRates {
                roll_radps,
                pitch_radps,
                yaw_radps,
            };
            into.raw_body_rates = Reading::new(rates, taken);
        }
        if let Some([x_ut, y_ut, z_ut]) = value.field_ut {
            into.magnetic_field = Reading::new(MagneticField { x_ut, y_ut, z_ut }, taken);
        }
        let numbers = [
            (value.static_pressure_pa, &mut into.static_pressure_pa),
            (
                value.differential_pressure_pa,
                &mut into.differential_pressure_pa,
            ),
            (value.air_temperature_k, &mut into.air_temperature_k),
            (value.range_m, &mut into.range_m),
        ];
        for (number, place) in numbers {
            if let Some(number) = number {
                *place = Reading::new(number, taken);
            }
        }
    }

    fn merged(earlier: &Sample<Self>, later: &Sample<Self>) -> Option<Sample<Self>> {
        let value = earlier.value.mean(&later.value).ok()?;
        let weight = f64::from(later.value.samples) / f64::from(value.samples);
        let between_ns = (later.taken - earlier.taken) as f64 * weight;
        let after = Duration::from_nanos(between_ns.max(0.0) as u64);
        Some(Sample::new(earlier.taken + after, value))
    }
}

impl Measured for Switch {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        into.engage_switch = Reading::new(sample.value, sample.taken);
    }

    /// The latest: positions have no mean.
    fn merged(_: &Sample<Self>, later: &Sample<Self>) -> Option<Sample<Self>> {
        Some(*later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inertial(ns: i64, samples: u32, value: f64) -> Sample<RawValues> {
        let value = RawValues {
            specific_force_mps2: Some([value; 3]),
            rates_radps: Some([-value; 3]),
            samples,
            ..RawValues::NONE
        };
        Sample::new(Time::from_nanos(ns), value)
    }

    /// One sample of 1 and three of 5: their mean is 4.
    #[test]
    fn batches_are_weighted_by_their_samples() {
        let merged = RawValues::merged(&inertial(1_000, 1, 1.0), &inertial(5_000, 3, 5.0));
        assert_eq!(merged, Some(inertial(4_000, 4, 4.0)));
    }

    #[test]
    fn what_only_one_of_two_samples_has_is_not_averaged() {
        let mut compass = inertial(2_000, 1, 1.0);
        compass.value.field_ut = Some([20.0, 0.0, 40.0]);
        assert_eq!(RawValues::merged(&inertial(1_000, 1, 1.0), &compass), None);
    }
}
