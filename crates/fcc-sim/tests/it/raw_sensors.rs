//! The statistics of raw sensors, over seeds, against the figures of data sheets
//! and of the requirement: 5 Hz, 120 ms, 0.5 m white and 1.5 m over 100 s, 0.1
//! m/s; barometer 0.3 m white, 2 m slow.

use fcc_core::flight::atmosphere::{pressure_altitude_m, pressure_pa};
use fcc_core::flight::{Measurements, SpecificForce};
use fcc_core::framework::Time;
use fcc_sim::units::DEGREE_RAD;
use fcc_sim::{AxisErrors, RawSensor, RawSensorSet, RawSensors, RawTruth};

const G: f64 = 9.806_65;
const FIELD_UT: [f64; 3] = [20.0, 1.0, 45.0];
const SEEDS: u64 = 400;

/// Level and at rest in the air at 1,000 m.
fn still(time_s: f64) -> RawTruth {
    let mut truth = RawTruth {
        time_s,
        specific_force: SpecificForce {
            z_mps2: -G,
            ..SpecificForce::default()
        },
        static_pressure_pa: pressure_pa(1_000.0),
        air_temperature_k: 281.65,
        height_m: 1_000.0,
        ..RawTruth::default()
    };
    truth.position.altitude_m = 1_000.0;
    truth
}

/// The readings after each step of `step_s`, and the times at which they were
/// stamped, s: of what `of` picks.
fn flown<T>(
    set: &RawSensorSet,
    seed: u64,
    step_s: f64,
    until_s: f64,
    truth: impl Fn(f64) -> RawTruth,
    of: impl Fn(&Measurements) -> (Time, T),
) -> Vec<(f64, T)> {
    let mut sensors = RawSensors::new(set, seed, &truth(0.0), FIELD_UT);
    let mut readings = Vec::new();
    let mut measured = Measurements::default();
    let mut last = Time::NEVER;
    for step in 1..=(until_s / step_s).round() as u32 {
        let time_s = f64::from(step) * step_s;
        sensors.step(&truth(time_s));
        sensors.read(
            Time::from_nanos((time_s * 1e9).round() as i64),
            &mut measured,
        );
        let (taken, value) = of(&measured);
        if taken > last {
            readings.push((taken.as_nanos() as f64 * 1e-9, value));
            last = taken;
        }
    }
    readings
}

/// Asserts that independent normal values of mean 0 have this standard
/// deviation: their sum of squares over its square is distributed as chi-square
/// (Wilson and Hilferty 1931); 99.99 % of correct samples pass.
fn assert_deviation(values: &[f64], expected: f64, what: &str) {
    const QUANTILE: f64 = 3.89;
    let n = values.len() as f64;
    let ratio = values.iter().map(|value| value * value).sum::<f64>() / (expected * expected);
    let bound = |z: f64| {
        let part = 2.0 / (9.0 * n);
        n * (1.0 - part + z * part.sqrt()).powi(3)
    };
    assert!(
        (bound(-QUANTILE)..=bound(QUANTILE)).contains(&ratio),
        "{what}: {} instead of {expected}",
        expected * (ratio / n).sqrt()
    );
}

/// Every second difference: of independent values they are independent.
fn differences(values: &[f64]) -> Vec<f64> {
    values
        .chunks_exact(2)
        .map(|pair| pair[1] - pair[0])
        .collect()
}

#[test]
fn satellite_navigation_is_late_and_has_the_stated_errors() {
    const EARTH_M: f64 = 6_378_137.0;
    let mut set = RawSensorSet::phone();
    // Not looked at here.
    (set.accelerometer.rate_hz, set.gyroscope.rate_hz) = (1.0, 1.0);
    (set.magnetometer.rate_hz, set.pitot.rate_hz) = (1.0, 1.0);
    let (mut first, mut apart, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 1..=SEEDS {
        let fixes = flown(&set, seed, 0.1, 101.0, still, |m| {
            (m.gnss.taken, m.gnss.value)
        });
        assert_eq!(fixes.len(), 504, "5 Hz, the last under way");
        assert!(
            (fixes[0].0 - 0.32).abs() < 1e-6,
            "taken at 0.2 s, there 120 ms later"
        );
        // The equator: longitude is on the ellipsoid's largest circle.
        let east_m = |at: usize| fixes[at].1.position.longitude_rad * EARTH_M;
        let up_m = |at: usize| fixes[at].1.position.altitude_m - 1_000.0;
        first.extend([east_m(0), up_m(0)]);
        apart.extend([east_m(500) - east_m(0), up_m(500) - up_m(0)]);
        speeds.push(fixes[0].1.velocity.down_mps);
        if seed == 1 {
            let all: Vec<f64> = (0..500).map(up_m).collect();
            assert_deviation(&differences(&all), 0.5 * 2.0_f64.sqrt(), "white");
        }
    }
    assert_deviation(&first, 0.5_f64.hypot(1.5), "position");
    let correlated = 1.5 * (1.0 - (-1.0_f64).exp()).sqrt();
    assert_deviation(
        &apart,
        2.0_f64.sqrt() * 0.5_f64.hypot(correlated),
        "after 100 s",
    );
    assert_deviation(&speeds, 0.1, "velocity");
}

#[test]
fn the_barometer_has_the_stated_errors() {
    for set in [RawSensorSet::phone(), RawSensorSet::board()] {
        let mut first = Vec::new();
        for seed in 1..=SEEDS {
            let readings = flown(
                &set,
                seed,
                0.04,
                if seed == 1 { 40.0 } else { 0.2 },
                still,
                |m| {
                    let pressure = m.static_pressure_pa;
                    (
                        pressure.taken,
                        pressure_altitude_m(pressure.value) - 1_000.0,
                    )
                },
            );
            let heights: Vec<f64> = readings.iter().map(|(_, height_m)| *height_m).collect();
            first.push(heights[0]);
            if seed == 1 {
                assert_deviation(&differences(&heights), 0.3 * 2.0_f64.sqrt(), "white");
            }
        }
        assert_deviation(&first, 0.3_f64.hypot(2.0), "height");
    }
}

/// The noise of a gyroscope as its Allan deviation over 1 s: a density N per √Hz
/// gives N/√2 (IEEE 952, annex C, of a one-sided density), and a step q, dithered
/// by the noise, q/√12 in each of the samples.
#[test]
fn the_gyroscopes_noise_is_that_of_the_data_sheet() {
    for (set, density_dps, rate_hz, step_dps) in [
        (RawSensorSet::phone(), 0.01, 100.0_f64, 1.0 / 16.4),
        (RawSensorSet::board(), 0.0028, 1_000.0, 1.0 / 131.0),
    ] {
        let rates = flown(&set, 7, 0.1, 300.0, still, |m| {
            (m.raw_body_rates.taken, m.raw_body_rates.value.pitch_radps)
        });
        let degrees: Vec<f64> = rates.iter().map(|(_, rate)| rate / DEGREE_RAD).collect();
        let seconds: Vec<f64> = degrees
            .chunks_exact(10)
            .map(|s| s.iter().sum::<f64>() / 10.0)
            .collect();
        let allan_dps = (density_dps / 2.0_f64.sqrt()).hypot(step_dps / (12.0 * rate_hz).sqrt());
        assert_deviation(
            &differences(&seconds),
            2.0_f64.sqrt() * allan_dps,
            "gyroscope",
        );
    }
}

#[test]
fn aircraft_differ_by_the_tolerances_of_the_data_sheets() {
    let of = |set: &RawSensorSet, of: fn(&Measurements) -> (Time, f64)| -> Vec<f64> {
        (1..=SEEDS)
            .map(|seed| flown(set, seed, 0.05, 0.2, still, of)[1].1)
            .collect()
    };
    let rates = |m: &Measurements| (m.raw_body_rates.taken, m.raw_body_rates.value.yaw_radps);
    let forces = |m: &Measurements| {
        (
            m.raw_specific_force.taken,
            m.raw_specific_force.value.x_mps2,
        )
    };
    let (phone, board) = (RawSensorSet::phone(), RawSensorSet::board());
    // Bias, the noise of the mean of 5 or 50 samples, and of x the share of
    // gravity along z: 1 %.
    assert_deviation(
        &of(&board, rates),
        0.5 * DEGREE_RAD,
        "gyroscope of the board",
    );
    let noise = 0.01 * (0.5 * 100.0_f64 / 5.0).sqrt();
    assert_deviation(
        &of(&phone, rates),
        1.0_f64.hypot(noise) * DEGREE_RAD,
        "of the phone",
    );
    assert_deviation(
        &of(&board, forces),
        0.02_f64.hypot(0.01) * G,
        "accelerometer of the board",
    );
    assert_deviation(
        &of(&phone, forces),
        0.08_f64.hypot(0.01) * G,
        "of the phone",
    );
}

fn perfect(delay_s: f64) -> RawSensorSet {
    fn sensor<const N: usize>(rate_hz: f64, delay_s: f64) -> RawSensor<N> {
        RawSensor {
            errors: [AxisErrors::NONE; N],
            rate_hz,
            delay_s,
            jitter_s: 0.0,
        }
    }
    RawSensorSet {
        accelerometer: sensor(1_000.0, delay_s),
        gyroscope: sensor(100.0, delay_s),
        magnetometer: sensor(50.0, delay_s),
        barometer: sensor(25.0, delay_s),
        barometer_resolution_pa: 1e-6,
        pitot: sensor(100.0, delay_s),
        thermometer: Some(sensor(10.0, delay_s)),
        gnss: sensor(5.0, delay_s),
        rangefinder: Some(RawSensor {
            errors: [AxisErrors {
                limit: 40.0,
                ..AxisErrors::NONE
            }],
            ..sensor(50.0, delay_s)
        }),
    }
}

/// All quantities change linearly: without errors each is, at the time of its
/// reading less the delay, what it was, however many samples it is the mean of.
#[test]
fn without_errors_a_reading_is_the_truth_one_delay_ago() {
    let truth = |time_s: f64| {
        let mut truth = still(time_s);
        truth.specific_force.x_mps2 = 3.0 * time_s;
        truth.rates.roll_radps = 0.1 * time_s;
        truth.differential_pressure_pa = 100.0 + 10.0 * time_s;
        truth.air_temperature_k = 280.0 + time_s;
        truth.velocity.east_mps = 7.0 * time_s;
        truth.position.latitude_rad = 1e-6 * time_s;
        truth.height_m = 30.0 - time_s;
        truth
    };
    let delay_s = 0.12;
    let check =
        |name: &str, slope: f64, at_zero: f64, of: &dyn Fn(&Measurements) -> (Time, f64)| {
            let readings = flown(&perfect(delay_s), 1, 0.025, 4.0, truth, of);
            assert!(readings.len() >= 15, "{name}");
            for (taken_s, value) in readings {
                let expected = at_zero + slope * (taken_s - delay_s);
                let within = 1e-6 * slope.abs() + 1e-12 * expected.abs();
                assert!(
                    (value - expected).abs() < within,
                    "{name}: {value}, not {expected}"
                );
            }
        };
    check("force", 3.0, 0.0, &|m| {
        (
            m.raw_specific_force.taken,
            m.raw_specific_force.value.x_mps2,
        )
    });
    check("rates", 0.1, 0.0, &|m| {
        (m.raw_body_rates.taken, m.raw_body_rates.value.roll_radps)
    });
    check("pitot", 10.0, 100.0, &|m| {
        (
            m.differential_pressure_pa.taken,
            m.differential_pressure_pa.value,
        )
    });
    check("temperature", 1.0, 280.0, &|m| {
        (m.air_temperature_k.taken, m.air_temperature_k.value)
    });
    check("velocity", 7.0, 0.0, &|m| {
        (m.gnss.taken, m.gnss.value.velocity.east_mps)
    });
    check("latitude", 1e-6, 0.0, &|m| {
        (m.gnss.taken, m.gnss.value.position.latitude_rad)
    });
    check("range", -1.0, 30.0, &|m| (m.range_m.taken, m.range_m.value));
}

#[test]
fn beyond_its_range_the_rangefinder_gives_nothing() {
    let high = |time_s: f64| RawTruth {
        height_m: 40.5,
        ..still(time_s)
    };
    let readings = flown(&perfect(0.0), 1, 0.025, 1.0, high, |m| {
        (m.range_m.taken, ())
    });
    assert!(readings.is_empty());
}

/// On an eastern heading, the north part of the field is to the left.
#[test]
fn the_magnetometer_measures_in_body_axes() {
    let east = |time_s: f64| RawTruth {
        heading_rad: 90.0 * DEGREE_RAD,
        ..still(time_s)
    };
    let fields = flown(&perfect(0.0), 1, 0.025, 0.1, east, |m| {
        (m.magnetic_field.taken, m.magnetic_field.value)
    });
    let (_, field) = fields[0];
    assert!((field.x_ut - 1.0).abs() < 1e-9);
    assert!((field.y_ut + 20.0).abs() < 1e-9);
    assert!((field.z_ut - 45.0).abs() < 1e-9);
}

#[test]
fn the_phones_accelerometer_has_steps_and_an_end() {
    let pulled = |time_s: f64| {
        let mut truth = still(time_s);
        truth.specific_force.z_mps2 = -3.0 * G;
        truth
    };
    let of = |m: &Measurements| (m.raw_specific_force.taken, m.raw_specific_force.value);
    let set = RawSensorSet::phone();
    for (_, force) in flown(&set, 1, 0.01, 1.0, pulled, of) {
        assert!((force.z_mps2 + 2.0 * G).abs() < 1e-12);
    }
    // Steps of 3.9 mg, also in the mean of two samples that arrive together.
    for (_, force) in flown(&set, 1, 0.01, 1.0, still, of) {
        let steps = force.x_mps2 / (0.003_9 * G);
        let (halves, thirds) = (2.0 * steps, 3.0 * steps);
        let whole = |value: f64| (value - value.round()).abs() < 1e-6;
        assert!(whole(halves) || whole(thirds), "{steps}");
    }
}

/// Two sines of half the amplitude each: a mean square of A²/4.
#[test]
fn the_engine_shakes_the_accelerometer() {
    let mut set = perfect(0.0);
    for axis in &mut set.accelerometer.errors {
        axis.vibration = 1.0;
    }
    let square = |throttle: f64| {
        let shaken = |time_s: f64| RawTruth {
            throttle,
            ..still(time_s)
        };
        let forces = flown(&set, 1, 0.001, 6.0, shaken, |m| {
            (
                m.raw_specific_force.taken,
                m.raw_specific_force.value.x_mps2,
            )
        });
        forces.iter().map(|(_, force)| force * force).sum::<f64>() / forces.len() as f64
    };
    assert_eq!(square(0.0), 0.0);
    assert!((square(1.0) - 0.25).abs() < 0.005);
    assert!((square(0.5) - 0.25 * 0.25).abs() < 0.002);
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let flight = |seed: u64| {
        flown(&RawSensorSet::board(), seed, 1.0 / 40.0, 2.0, still, |m| {
            (m.raw_body_rates.taken, *m)
        })
    };
    assert_eq!(flight(3), flight(3));
    assert_ne!(flight(3), flight(4));
}
