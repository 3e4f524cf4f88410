//! Two sets of raw sensors, by their data sheets.
//!
//! A tolerance that a data sheet calls typical is taken as one standard
//! deviation. What a part's data sheet does not say is marked as assumed. While a
//! sensor warms up by 10 K its bias changes by its temperature coefficient. Satellite navigation and the air
//! around a static port are the same for both: 5 Hz, 120 ms late, 0.5 m white
//! and 1.5 m correlated over 100 s, 0.1 m/s; 0.3 m white and 2 m of slow bias of
//! the barometric altitude.

use libm::sqrt;

use super::channel::{AxisErrors, RawSensor};
use crate::units::{DEGREE_RAD, STANDARD_GRAVITY_MPS2};

/// The raw sensors of an aircraft.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RawSensorSet {
    /// m/s².
    pub accelerometer: RawSensor<3>,
    /// rad/s.
    pub gyroscope: RawSensor<3>,
    /// µT.
    pub magnetometer: RawSensor<3>,
    /// m of pressure altitude.
    pub barometer: RawSensor<1>,
    /// The step of the static pressure, Pa.
    pub barometer_resolution_pa: f64,
    /// Pa.
    pub pitot: RawSensor<1>,
    /// K; none if no thermometer is outside.
    pub thermometer: Option<RawSensor<1>>,
    /// m, then m/s: north, east and down.
    pub gnss: RawSensor<6>,
    /// m; none if there is none.
    pub rangefinder: Option<RawSensor<1>>,
}

const MILLI_G: f64 = 1e-3 * STANDARD_GRAVITY_MPS2;

/// By how much sensors warm up after they were switched on, K; assumed.
const WARMING_K: f64 = 10.0;

/// The correlation time of what changes slowly: flicker noise of a bias, s;
/// assumed.
const FLICKER_S: f64 = 100.0;

/// The correlation time of the error of a static port, s; assumed.
const SLOW_S: f64 = 1_000.0;

/// The amplitude of the engine's vibration where the sensors are, 0.1 g and 1°/s
/// at full throttle; assumed.
const VIBRATION_MPS2: f64 = 0.1 * STANDARD_GRAVITY_MPS2;
const VIBRATION_RADPS: f64 = DEGREE_RAD;

/// The noise of a sample, from a density per √Hz and the samples per s: of white
/// noise in the band up to half of the rate.
fn white(density: f64, rate_hz: f64) -> f64 {
    density * sqrt(0.5 * rate_hz)
}

impl RawSensorSet {
    /// The thesis' phone, a Galaxy Nexus of 2011, with a pitot tube on its servo
    /// board.
    ///
    /// | part | source | figures |
    /// |---|---|---|
    /// | BMA250 | Bosch BST-BMA250-DS002-05, 2012 | ±2 g, 3.9 mg, 0.8 mg/√Hz, zero ±80 mg and ±1 mg/K, cross axis 1 %; scale 1 % and flicker of 0.5 mg assumed |
    /// | MPU-3050 | InvenSense PS-MPU-3050A-00 | ±2000°/s, 16.4 per °/s, 0.01°/s/√Hz, ±2 %, cross axis 2 %, 0.03°/s/K; of the zero of up to ±20°/s Android leaves 1°/s, flicker 0.01°/s: assumed |
    /// | YAS530 | no public data sheet; ranges as in the sensor lists of Samsung's phones | ±800 µT, 0.3 µT; 0.6 µT of noise, 3 µT of hard iron and 2 % of soft iron left by the phone's calibration assumed |
    /// | BMP180 | Bosch BST-BMP180-DS000-09, 2013 | 1 Pa, 25.5 ms for a sample |
    /// | MS4525DO | Measurement Specialties 4525DO | ±1 psi in 80 % of 14 bits, 0.25 %; zeroed to 2 Pa, noise of 2 Pa and 5 Pa of warming assumed |
    pub fn phone() -> Self {
        let imu_hz = 100.0;
        let imu = |errors| RawSensor {
            errors: [errors; 3],
            rate_hz: imu_hz,
            delay_s: 0.015,
            jitter_s: 0.003,
        };
        Self {
            accelerometer: imu(AxisErrors {
                white: white(0.8 * MILLI_G, imu_hz),
                drift: 0.5 * MILLI_G,
                drift_tau_s: FLICKER_S,
                bias: 80.0 * MILLI_G,
                warming: WARMING_K * MILLI_G,
                scale: 0.01,
                misalignment: 0.01,
                vibration: VIBRATION_MPS2,
                resolution: 3.9 * MILLI_G,
                limit: 2.0 * STANDARD_GRAVITY_MPS2,
            }),
            gyroscope: imu(AxisErrors {
                white: white(0.01 * DEGREE_RAD, imu_hz),
                drift: 0.01 * DEGREE_RAD,
                drift_tau_s: FLICKER_S,
                bias: DEGREE_RAD,
                warming: 0.03 * WARMING_K * DEGREE_RAD,
                scale: 0.02,
                misalignment: 0.02,
                vibration: VIBRATION_RADPS,
                resolution: DEGREE_RAD / 16.4,
                limit: 2000.0 * DEGREE_RAD,
            }),
            magnetometer: RawSensor {
                errors: [AxisErrors {
                    white: 0.6,
                    bias: 3.0,
                    scale: 0.02,
                    misalignment: 0.02,
                    resolution: 0.3,
                    limit: 800.0,
                    ..AxisErrors::NONE
                }; 3],
                rate_hz: 50.0,
                delay_s: 0.02,
                jitter_s: 0.005,
            },
            barometer: barometer(0.04, 0.005),
            barometer_resolution_pa: 1.0,
            pitot: pitot(0.03, 0.005),
            thermometer: None,
            gnss: gnss(1.5),
            rangefinder: None,
        }
    }

    /// A present board.
    ///
    /// | part | source | figures |
    /// |---|---|---|
    /// | ICM-42688-P | TDK DS-000347, 2023 | accelerometer ±16 g, 8192 per g, 70 µg/√Hz, zero ±20 mg and ±0.15 mg/K, ±0.5 %, cross axis 1 %; gyroscope ±2000°/s, 131 per °/s, 0.0028°/s/√Hz, ±0.5°/s and ±0.005°/s/K, ±0.5 %, cross axis 1.25 %; flicker of 0.05 mg and 0.001°/s assumed |
    /// | MMC5983MA | MEMSIC Rev A, 2019 | ±800 µT, 0.006 µT, 0.04 µT of noise; 1 µT of hard iron and 0.5 % of soft iron left by calibration assumed |
    /// | BMP390 | Bosch BST-BMP390-DS002 | 0.016 Pa, ±0.5 K |
    /// | MS4525DO | as above | |
    /// | LIDAR-Lite v3 | Garmin 190-02088-00, 2016 | 40 m, 0.01 m, ±0.1 m |
    pub fn board() -> Self {
        let imu_hz = 1_000.0;
        let imu = |errors| RawSensor {
            errors: [errors; 3],
            rate_hz: imu_hz,
            delay_s: 0.002,
            jitter_s: 0.000_2,
        };
        Self {
            accelerometer: imu(AxisErrors {
                white: white(0.07 * MILLI_G, imu_hz),
                drift: 0.05 * MILLI_G,
                drift_tau_s: FLICKER_S,
                bias: 20.0 * MILLI_G,
                warming: 0.15 * WARMING_K * MILLI_G,
                scale: 0.005,
                misalignment: 0.01,
                vibration: VIBRATION_MPS2,
                resolution: STANDARD_GRAVITY_MPS2 / 8192.0,
                limit: 16.0 * STANDARD_GRAVITY_MPS2,
            }),
            gyroscope: imu(AxisErrors {
                white: white(0.0028 * DEGREE_RAD, imu_hz),
                drift: 0.001 * DEGREE_RAD,
                drift_tau_s: FLICKER_S,
                bias: 0.5 * DEGREE_RAD,
                warming: 0.005 * WARMING_K * DEGREE_RAD,
                scale: 0.005,
                misalignment: 0.0125,
                vibration: VIBRATION_RADPS,
                resolution: DEGREE_RAD / 131.0,
                limit: 2000.0 * DEGREE_RAD,
            }),
            magnetometer: RawSensor {
                errors: [AxisErrors {
                    white: 0.04,
                    bias: 1.0,
                    scale: 0.005,
                    misalignment: 0.005,
                    resolution: 0.006_25,
                    limit: 800.0,
                    ..AxisErrors::NONE
                }; 3],
                rate_hz: 100.0,
                delay_s: 0.01,
                jitter_s: 0.001,
            },
            barometer: barometer(0.02, 0.001),
            barometer_resolution_pa: 0.016,
            pitot: pitot(0.01, 0.001),
            thermometer: Some(RawSensor {
                errors: [AxisErrors {
                    bias: 0.5,
                    resolution: 0.01,
                    ..AxisErrors::NONE
                }],
                rate_hz: 10.0,
                delay_s: 0.1,
                jitter_s: 0.0,
            }),
            gnss: gnss(1.5),
            rangefinder: Some(RawSensor {
                errors: [AxisErrors {
                    white: 0.05,
                    bias: 0.1,
                    resolution: 0.01,
                    limit: 40.0,
                    ..AxisErrors::NONE
                }],
                rate_hz: 50.0,
                delay_s: 0.02,
                jitter_s: 0.001,
            }),
        }
    }
}

impl RawSensorSet {
    /// The board with a position that is good to 0.5 m, as that of a receiver with
    /// corrections is, or relative to a runway that was recorded in the same hour.
    pub fn board_with_precise_position() -> Self {
        Self {
            gnss: gnss(0.5),
            ..Self::board()
        }
    }
}

fn barometer(delay_s: f64, jitter_s: f64) -> RawSensor<1> {
    RawSensor {
        errors: [AxisErrors {
            white: 0.3,
            drift: 2.0,
            drift_tau_s: SLOW_S,
            ..AxisErrors::NONE
        }],
        rate_hz: 25.0,
        delay_s,
        jitter_s,
    }
}

fn pitot(delay_s: f64, jitter_s: f64) -> RawSensor<1> {
    /// 1 psi, Pa.
    const PSI_PA: f64 = 6_894.757;
    RawSensor {
        errors: [AxisErrors {
            white: 2.0,
            bias: 2.0,
            warming: 5.0,
            scale: 0.002_5,
            resolution: 2.0 * PSI_PA / (0.8 * 16_384.0),
            limit: PSI_PA,
            ..AxisErrors::NONE
        }],
        rate_hz: 100.0,
        delay_s,
        jitter_s,
    }
}

/// With a correlated error of the position, m; a third of it is white.
fn gnss(correlated_m: f64) -> RawSensor<6> {
    let position = AxisErrors {
        white: correlated_m / 3.0,
        drift: correlated_m,
        drift_tau_s: 100.0,
        ..AxisErrors::NONE
    };
    let velocity = AxisErrors {
        white: 0.1,
        ..AxisErrors::NONE
    };
    RawSensor {
        errors: [position, position, position, velocity, velocity, velocity],
        rate_hz: 5.0,
        delay_s: 0.12,
        jitter_s: 0.0,
    }
}
