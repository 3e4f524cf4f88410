use std::vec::Vec;

use super::*;
use fcc_core::flight::orientation::EulerAngles;
use fcc_core::framework::Time;

fn near(found: [f64; 3], expected: [f64; 3], within: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(
            (found - expected).abs() < within,
            "{found} is not {expected}"
        );
    }
}

/// The faults of a sensor are made here by themselves, axis by axis.
#[test]
fn a_calibration_undoes_what_the_sensor_did() {
    let bias = [0.4, -0.2, 0.1];
    // What 1 is shown as, and how far each axis points beside its own: y 1° and
    // 2° towards x and z.
    let gain = [1.02, 0.98, 1.01];
    let calibration = AxesCalibration::new(&Axes {
        bias,
        scale: gain.map(|gain| 1.0 / gain),
        ..Axes::default()
    });
    let truth = [1.5, -2.5, -9.81];
    let given = [0, 1, 2].map(|at: usize| truth[at] * gain[at] + bias[at]);
    near(calibration.applied(given), truth, 1e-12);
}

/// A sensor whose y axis points 1° towards x gives cos 1° of y and sin 1° of x:
/// T is the inverse of that, to the first order.
#[test]
fn misalignment_is_that_of_small_angles() {
    let angle = 1.0_f64.to_radians();
    let calibration = AxesCalibration::new(&Axes {
        misalignment: [0.0, 0.0, -angle, 0.0, 0.0, 0.0],
        ..Axes::default()
    });
    let (x, y) = (9.81, 0.0);
    let given = [x, y * angle.cos() + x * angle.sin(), 0.0];
    near(
        calibration.applied(given),
        [x, y, 0.0],
        9.81 * angle * angle,
    );
}

/// An accelerometer on a shelf that rises by 5° forward: level, it measures
/// g sin 5° forward and g cos 5° up.
#[test]
fn a_free_rotation_turns_the_sensor_back() {
    let pitch_rad = 5.0_f64.to_radians();
    let calibration = AxesCalibration::new(&Axes {
        rotation: Rotation::of_angles(EulerAngles {
            pitch_rad,
            ..EulerAngles::default()
        }),
        ..Axes::default()
    });
    let given = [9.81 * pitch_rad.sin(), 0.0, -9.81 * pitch_rad.cos()];
    near(calibration.applied(given), [0.0, 0.0, -9.81], 1e-12);
}

/// First the faults of the sensor in its own axes, then the mounting, then the
/// free rotation in those of the aircraft.
#[test]
fn the_order_is_that_of_the_documentation() {
    let calibration = AxesCalibration::new(&Axes {
        mounting: "right-backward-down".parse().unwrap(),
        rotation: Rotation::of_angles(EulerAngles {
            roll_rad: core::f64::consts::FRAC_PI_2,
            ..EulerAngles::default()
        }),
        bias: [1.0, 0.0, 0.0],
        scale: [2.0, 1.0, 1.0],
        ..Axes::default()
    });
    // 3 along x: (3 - 1) · 2 to the right, which the roll turns down.
    near(calibration.applied([3.0, 0.0, 0.0]), [0.0, 0.0, 4.0], 1e-12);
}

#[test]
fn every_raw_reading_is_calibrated_once_and_no_other() {
    let (arrived, taken) = (Time::from_nanos(200_000_000), Time::from_nanos(80_000_000));
    let late = Duration::from_millis(120);
    let axes = AxesCalibration::new(&Axes {
        scale: [3.0; 3],
        delay: late,
        ..Axes::default()
    });
    let scalar = ScalarCalibration {
        bias: 1.0,
        scale: 3.0,
        delay: late,
    };
    let calibration = Calibration {
        accelerometer: axes,
        gyroscope: axes,
        magnetometer: axes,
        static_pressure: scalar,
        differential_pressure: scalar,
        air_temperature: scalar,
        range: scalar,
        gnss_delay: late,
    };
    assert_eq!(
        calibration.applied(&Measurements::default()),
        Measurements::default()
    );
    let force = |z_mps2| SpecificForce {
        z_mps2,
        ..SpecificForce::default()
    };
    let rates = |yaw_radps| BodyRates {
        yaw_radps,
        ..BodyRates::default()
    };
    let field = |y_ut| MagneticField {
        y_ut,
        ..MagneticField::default()
    };
    let processed = Measurements {
        specific_force: Reading::new(force(-9.0), arrived),
        body_rates: Reading::new(rates(0.5), arrived),
        altitude_m: Reading::new(7.0, arrived),
        ..Measurements::default()
    };
    let raw = |time, force, rates, field, scalar| Measurements {
        raw_specific_force: Reading::new(force, time),
        raw_body_rates: Reading::new(rates, time),
        magnetic_field: Reading::new(field, time),
        static_pressure_pa: Reading::new(scalar, time),
        differential_pressure_pa: Reading::new(scalar, time),
        air_temperature_k: Reading::new(scalar, time),
        range_m: Reading::new(scalar, time),
        gnss: Reading::new(fcc_core::flight::GnssFix::default(), time),
        ..processed
    };
    let given = raw(arrived, force(-3.0), rates(0.1), field(20.0), 5.0);
    let expected = raw(taken, force(-9.0), rates(0.3), field(60.0), 12.0);
    let measured = calibration.applied(&given);
    assert!((measured.raw_body_rates.value.yaw_radps - 0.3).abs() < 1e-12);
    let measured = Measurements {
        raw_body_rates: expected.raw_body_rates,
        ..measured
    };
    assert_eq!(measured, expected);
}

/// Gravity in directions spread evenly (a spiral on the sphere), as a sensor with
/// these errors gives it.
fn given(directions: usize, sensor: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    let golden = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..directions)
        .map(|n| {
            let z = 1.0 - (2.0 * n as f64 + 1.0) / directions as f64;
            let (sin, cos) = (golden * n as f64).sin_cos();
            let across = (1.0 - z * z).sqrt();
            sensor([across * cos * 9.81, across * sin * 9.81, z * 9.81])
        })
        .collect()
}

/// What a fit gives, applied to what it was made from, has one strength.
#[test]
fn a_fit_undoes_bias_scale_and_misalignment() {
    let samples = given(40, |[x, y, z]| {
        [
            1.03 * x + 0.02 * y + 0.8,
            0.97 * y + 0.01 * z - 0.5,
            z + 0.015 * x + 0.3,
        ]
    });
    let fit = fit_strength(&samples, 9.81).unwrap();
    assert!(fit.residual < 1e-9 && fit.spread > 0.3, "{fit:?}");
    for (found, expected) in fit.axes.bias.into_iter().zip([0.8, -0.5, 0.3]) {
        assert!((found - expected).abs() < 1e-9, "{fit:?}");
    }
    let calibration = AxesCalibration::new(&fit.axes);
    for sample in samples {
        let [x, y, z] = calibration.applied(sample);
        assert!(((x * x + y * y + z * z).sqrt() - 9.81).abs() < 1e-9);
    }
}

/// A hard iron many times as strong as the field.
#[test]
fn a_bias_larger_than_the_strength_is_found() {
    let samples = given(40, |[x, y, z]| [x + 300.0, y - 200.0, z + 100.0]);
    let fit = fit_strength(&samples, 9.81).unwrap();
    assert!((fit.axes.bias[0] - 300.0).abs() < 1e-6, "{fit:?}");
}

/// The standard deviation that a fit states is that of its biases: 200 fits of 60
/// samples with noise of 0.05 m/s².
#[test]
fn the_stated_deviation_is_the_true_one() {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut squares = 0.0;
    for _ in 0..200 {
        let clean = given(60, |sample| sample);
        let noisy: Vec<_> = clean
            .iter()
            // Twelve uniform numbers have a variance of 1.
            .map(|sample| sample.map(|part| part + 0.05 * (0..12).map(|_| uniform()).sum::<f64>()))
            .collect();
        let fit = fit_strength(&noisy, 9.81).unwrap();
        let errors = fit.axes.bias.into_iter().zip(fit.bias_sigma);
        squares += errors
            .map(|(error, sigma)| (error / sigma).powi(2))
            .sum::<f64>();
    }
    // Chi-square of 600: 600 within 4 standard deviations of 35.
    assert!((460.0..740.0).contains(&squares), "{squares}");
}

#[test]
fn what_gives_no_calibration_is_refused_with_the_reason() {
    let samples = given(40, |sample| sample);
    assert_eq!(fit_strength(&samples[..5], 9.81), Err(FitError::TooFew(12)));
    let mut bad = samples.clone();
    bad[3][1] = f64::NAN;
    assert_eq!(fit_strength(&bad, 9.81), Err(FitError::NotFinite));
    let flat = given(40, |[x, y, z]| [x, y, 0.05 * z]);
    let refused = fit_strength(&flat, 9.81).unwrap_err();
    assert!(matches!(refused, FitError::NotSpread(..)), "{refused:?}");
    // One that moved while it was sampled.
    let moved = |&[x, y, z]: &[f64; 3]| [x, y, z + 6.0 * x.signum() * y.signum()];
    let moving: Vec<_> = samples.iter().map(moved).collect();
    assert_eq!(fit_strength(&moving, 9.81), Err(FitError::NoFit));
}

/// 1 g is 9.81 m/s².
#[test]
fn samples_of_another_unit_are_told_from_a_bad_fit() {
    let in_g = given(40, |sample| sample.map(|part| part / 9.81));
    let refused = fit_strength(&in_g, 9.81).unwrap_err();
    let FitError::OtherUnit(given, wanted) = refused else {
        panic!("{refused:?}");
    };
    assert!((given - 1.0).abs() < 1e-9 && wanted == 9.81);
}

/// A sample that is three times too long, near nothing, or of another world.
#[test]
fn one_outlier_is_named() {
    let noise = |part: f64, at: usize| part + 0.02 * ((at * 37 % 11) as f64 / 5.0 - 1.0);
    for factor in [0.0, 0.8, 1.2, 3.0, 100.0, -1e6] {
        let mut samples = given(40, |sample| sample);
        for (at, sample) in samples.iter_mut().enumerate() {
            *sample = sample.map(|part| noise(part, at));
        }
        assert!(fit_strength(&samples, 9.81).is_ok());
        samples[17] = samples[17].map(|part| part * factor);
        let refused = fit_strength(&samples, 9.81).unwrap_err();
        let FitError::Outlier(17, by) = refused else {
            panic!("{factor}: {refused:?}");
        };
        let expected = 9.81 * (f64::abs(factor) - 1.0).abs();
        assert!((by / expected - 1.0).abs() < 0.05, "{factor}: {by}");
    }
}
