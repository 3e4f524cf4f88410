//! The kinds of sensors, and their events as values.

use fcc_device::RawValues;
use serde::Serialize;

use crate::Accuracy;

/// hPa, in which a barometer gives pressure (`ASENSOR_TYPE_PRESSURE`).
const PA_PER_HPA: f64 = 100.0;

/// What an event says if one of its values is no number.
const NO_NUMBER: &str = "what it gives is no number";
/// What it says if no sensor of a phone can measure that: what would integrate it would
/// not be rid of it for minutes.
const BEYOND_MEASURE: &str =
    "it gives what no such sensor can measure: it is broken, or has another unit";

/// A sensor that Android gives events of.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Specific force.
    Accelerometer,
    /// Turn rates.
    Gyroscope,
    /// The magnetic field.
    Magnetometer,
    /// Static pressure.
    Barometer,
}

/// The values of an event, in SI units and µT, in the phone's axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Reading {
    values: [f64; 3],
    /// What the phone takes its bias for; none of a kind that it has subtracted it
    /// from.
    pub(crate) bias: Option<[f64; 3]>,
    pub(crate) accuracy: Option<Accuracy>,
}

impl Kind {
    /// The name of its thread, and of its device in messages.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Accelerometer => "phone accelerometer",
            Self::Gyroscope => "phone gyroscope",
            Self::Magnetometer => "phone magnetometer",
            Self::Barometer => "phone barometer",
        }
    }

    /// Its types (`ASENSOR_TYPE_...`), the preferred first: one from which the phone
    /// subtracts nothing. What it subtracts it estimates anew in flight, which is a
    /// jump, and navigation estimates the bias itself.
    pub(crate) const fn types(self) -> &'static [i32] {
        match self {
            Self::Accelerometer => &[ACCELEROMETER_UNCALIBRATED, 1],
            Self::Gyroscope => &[GYROSCOPE_UNCALIBRATED, 4],
            Self::Magnetometer => &[MAGNETIC_FIELD_UNCALIBRATED, 2],
            Self::Barometer => &[6],
        }
    }

    /// A sensor that is slower is not used, Hz: a loop at 40 Hz needs a sample of
    /// acceleration and rates in each tick. What changes slowly may come slowly.
    pub(crate) const fn lowest_rate_hz(self) -> f64 {
        match self {
            Self::Accelerometer | Self::Gyroscope => 50.0,
            Self::Magnetometer => 5.0,
            Self::Barometer => 1.0,
        }
    }

    /// The most that a sensor of a phone can measure along an axis, and some times that:
    /// 16 g, 2,000 °/s, 4,912 µT, 1,100 hPa.
    const fn most(self) -> f64 {
        match self {
            Self::Accelerometer => 1_000.0,
            Self::Gyroscope => 100.0,
            Self::Magnetometer => 20_000.0,
            Self::Barometer => 2_000.0 * PA_PER_HPA,
        }
    }

    /// What an event of a type says.
    ///
    /// # Errors
    /// When it is no number, or nothing that can be measured: what is wrong.
    pub(crate) fn read(self, of_type: i32, data: &[f32; 16]) -> Result<Reading, &'static str> {
        let [x, y, z, bias_x, bias_y, bias_z, ..] = data.map(f64::from);
        let has_bias = matches!(
            of_type,
            ACCELEROMETER_UNCALIBRATED | GYROSCOPE_UNCALIBRATED | MAGNETIC_FIELD_UNCALIBRATED
        );
        let reading = match self {
            Self::Barometer => Reading {
                values: [x * PA_PER_HPA, 0.0, 0.0],
                bias: None,
                accuracy: None,
            },
            _ if has_bias => Reading {
                values: [x, y, z],
                bias: Some([bias_x, bias_y, bias_z]),
                accuracy: None,
            },
            // The accuracy is the byte after the three numbers.
            _ => Reading {
                values: [x, y, z],
                bias: None,
                accuracy: Accuracy::of(bias_byte(data)),
            },
        };
        let numbers = reading.bias.unwrap_or_default();
        let mut all = reading.values.iter().chain(&numbers);
        if !all.clone().all(|number| number.is_finite()) {
            return Err(NO_NUMBER);
        }
        if all.any(|number| number.abs() > self.most()) {
            return Err(BEYOND_MEASURE);
        }
        Ok(reading)
    }

    /// A reading as the measured value, less a bias.
    pub(crate) fn raw_values(self, reading: &Reading, bias: [f64; 3]) -> RawValues {
        let [x, y, z] = reading.values;
        let [bias_x, bias_y, bias_z] = bias;
        let vector = Some([x - bias_x, y - bias_y, z - bias_z]);
        match self {
            Self::Accelerometer => RawValues {
                specific_force_mps2: vector,
                ..RawValues::NONE
            },
            Self::Gyroscope => RawValues {
                rates_radps: vector,
                ..RawValues::NONE
            },
            Self::Magnetometer => RawValues {
                field_ut: vector,
                ..RawValues::NONE
            },
            Self::Barometer => RawValues {
                static_pressure_pa: Some(x),
                ..RawValues::NONE
            },
        }
    }
}

const MAGNETIC_FIELD_UNCALIBRATED: i32 = 14;
const GYROSCOPE_UNCALIBRATED: i32 = 16;
/// Since API level 26.
const ACCELEROMETER_UNCALIBRATED: i32 = 35;

/// `ASensorVector::status`, which lies where a fourth number would.
fn bias_byte(data: &[f32; 16]) -> i8 {
    let [_, _, _, fourth, ..] = data;
    let [first, ..] = fourth.to_ne_bytes();
    first as i8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(values: &[f32]) -> [f32; 16] {
        let mut data = [0.0; 16];
        for (place, value) in data.iter_mut().zip(values) {
            *place = *value;
        }
        data
    }

    /// The example of Android's page *Motion sensors*: flat on a table, the screen up,
    /// acceleration is +9.81 along z. Standard pressure is 1013.25 hPa.
    #[test]
    fn values_are_in_si_units() {
        let read = |kind: Kind, of_type, values: &[f32]| {
            let reading = kind.read(of_type, &data(values)).unwrap();
            kind.raw_values(&reading, [0.0; 3])
        };
        let flat = read(Kind::Accelerometer, 1, &[0.0, 0.0, 9.81]);
        let [x, y, z] = flat.specific_force_mps2.unwrap();
        assert!(x == 0.0 && y == 0.0 && (z - 9.81).abs() < 1e-6);
        let pressure = read(Kind::Barometer, 6, &[1_013.25]);
        assert_eq!(pressure.static_pressure_pa, Some(101_325.0));
        let field = read(Kind::Magnetometer, 2, &[21.0, 0.0, -45.0]);
        assert_eq!(field.field_ut, Some([21.0, 0.0, -45.0]));
    }

    #[test]
    fn an_uncalibrated_event_has_its_bias_and_a_calibrated_one_its_accuracy() {
        let uncalibrated = data(&[0.11, 0.02, 0.03, 0.1, 0.0, 0.0]);
        let reading = Kind::Gyroscope.read(16, &uncalibrated).unwrap();
        let bias = reading.bias.unwrap();
        assert_eq!(reading.accuracy, None);
        let rates = Kind::Gyroscope.raw_values(&reading, bias).rates_radps;
        assert!((rates.unwrap()[0] - 0.01).abs() < 1e-7);
        let mut calibrated = data(&[1.0, 2.0, 3.0]);
        calibrated[3] = f32::from_ne_bytes([1, 0, 0, 0]);
        let reading = Kind::Magnetometer.read(2, &calibrated).unwrap();
        assert_eq!(reading.accuracy, Some(Accuracy::Low));
        assert_eq!(reading.bias, None);
    }

    #[test]
    fn what_is_no_number_is_no_reading() {
        assert_eq!(Kind::Barometer.read(6, &data(&[f32::NAN])), Err(NO_NUMBER));
        let no_bias = data(&[0.0, 0.0, 0.0, f32::INFINITY]);
        assert_eq!(Kind::Gyroscope.read(16, &no_bias), Err(NO_NUMBER));
    }

    /// The largest number, a pressure in Pa, milligravities, and such a bias.
    #[test]
    fn what_nothing_can_measure_is_no_reading() {
        for (kind, of_type, values) in [
            (Kind::Accelerometer, 35, [0.0, f32::MAX, 0.0, 0.0]),
            (Kind::Accelerometer, 1, [0.0, 0.0, -1_001.0, 0.0]),
            (Kind::Gyroscope, 16, [0.0, 0.0, 0.0, f32::MIN]),
            (Kind::Magnetometer, 14, [f32::MAX; 4]),
            (Kind::Barometer, 6, [101_325.0, 0.0, 0.0, 0.0]),
        ] {
            assert_eq!(kind.read(of_type, &data(&values)), Err(BEYOND_MEASURE));
        }
        // 16 g, 2,000 °/s and a magnet beside the phone.
        assert!(Kind::Accelerometer.read(35, &data(&[157.0; 3])).is_ok());
        assert!(Kind::Gyroscope.read(16, &data(&[34.9; 3])).is_ok());
        assert!(Kind::Magnetometer.read(14, &data(&[4_912.0; 3])).is_ok());
    }
}
