//! Guided calibration of the simulated raw sensors, against their true errors.

use std::fmt::Display;
use std::fs::File;
use std::io::Write as _;
use std::ops::Range;

use fcc_calibration::{
    Axes, AxesCalibration, EarthField, Found, GuidedCalibration, GuidedKind, MountingWay, Refusal,
    Rotation, Values,
};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor as _, Tick, Time};
use fcc_sim::units::DEGREE_RAD;
use fcc_sim::{HandledSensors, HandlingFault, HandlingTask, RawSensorSet, SimConfig, TrueErrors};

const G: f64 = 9.806_65;

/// Appends a figure to the file that results are written from.
fn measured(what: &str, value: impl Display) {
    let Some(path) = std::env::var_os("FCC_MEASURED") else {
        return;
    };
    let mut file = File::options()
        .append(true)
        .create(true)
        .open(path)
        .unwrap();
    // One write, so that tests that run at once do not mix their lines.
    file.write_all(format!("{what}\t{value}\n").as_bytes())
        .unwrap();
}

/// Some, or the eight that results are measured with.
fn seeds(some: u64) -> Range<u64> {
    let first = std::env::var("FCC_FIRST_SEED").map(|first| first.parse().unwrap());
    let seeds = first.map_or(1..some + 1, |first| first..first + 8);
    seeds.clone().for_each(|seed| measured("seed", seed));
    seeds
}

fn config(set: &RawSensorSet, seed: u64) -> SimConfig {
    SimConfig {
        raw_sensors: Some(*set),
        seed,
        ..SimConfig::default()
    }
}

fn sets() -> [(&'static str, RawSensorSet); 2] {
    [
        ("phone", RawSensorSet::phone()),
        ("board", RawSensorSet::board()),
    ]
}

/// Handles the sensors until the calibration is complete, or the person is done.
fn calibrate(
    config: &SimConfig,
    kind: &GuidedKind,
    task: HandlingTask,
    fault: Option<HandlingFault>,
) -> (Result<Found, Refusal>, HandledSensors) {
    let mut sensors = HandledSensors::new(config, task, fault).unwrap();
    let mut calibration = GuidedCalibration::new(kind);
    let mut measured = Measurements::default();
    for number in 1..=(sensors.length_s() * 40.0) as u64 {
        let tick = Tick {
            number,
            woke: Time::from_nanos(number as i64 * 25_000_000),
            dt_s: 0.025,
            ..Tick::default()
        };
        sensors.sample(&tick, &mut measured).unwrap();
        calibration.take(&measured);
        if calibration.is_complete() {
            break;
        }
    }
    (calibration.finish(), sensors)
}

/// What is found of the accelerometer.
fn accelerometer(config: &SimConfig) -> Axes {
    let places = HandlingTask::Places;
    let (found, _) = calibrate(config, &GuidedKind::Accelerometer, places, None);
    match found.unwrap().values {
        Values::Accelerometer(axes) => axes,
        other => panic!("{other:?}"),
    }
}

fn given(errors: &TrueErrors<3>, truth: [f64; 3]) -> [f64; 3] {
    let dot = |row: [f64; 3]| {
        row.iter()
            .zip(truth)
            .map(|(share, part)| share * part)
            .sum()
    };
    let shaped: [f64; 3] = errors.shape.map(dot);
    [0, 1, 2].map(|axis| shaped[axis] + errors.bias[axis])
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// The directions of a cube's faces, edges and corners.
fn directions() -> impl Iterator<Item = [f64; 3]> {
    let parts = || [-1.0, 0.0, 1.0].into_iter();
    let all = parts().flat_map(move |x| parts().flat_map(move |y| parts().map(move |z| [x, y, z])));
    all.filter(|vector| length(*vector) > 0.0).map(|vector| {
        let long = length(vector);
        vector.map(|part| part / long)
    })
}

/// By how much the strength of a calibrated truth is wrong, at most.
fn worst(axes: &Axes, errors: &TrueErrors<3>, strength: f64) -> f64 {
    let calibration = AxesCalibration::new(axes);
    directions()
        .map(|to| {
            let truth = to.map(|part| strength * part);
            (length(calibration.applied(given(errors, truth))) - strength).abs()
        })
        .fold(0.0, f64::max)
}

/// 80 and 20 mg of bias are 785 and 196 mm/s². While they are held for a minute
/// they warm up by 1 K: 1 mg of the phone, 0.15 mg of the board, and flicker of
/// 0.5 and 0.05 mg.
#[test]
fn an_accelerometers_bias_scale_and_misalignment_are_found() {
    for ((name, set), most_mps2) in sets().into_iter().zip([0.06, 0.015]) {
        for seed in seeds(2) {
            let config = config(&set, seed);
            let places = HandlingTask::Places;
            let (found, sensors) = calibrate(&config, &GuidedKind::Accelerometer, places, None);
            let found = found.unwrap();
            let Values::Accelerometer(axes) = found.values else {
                panic!("{found:?}");
            };
            let [errors, ..] = sensors.sensors().true_errors();
            let left_mps2 = worst(&axes, &errors, G);
            let left = format!("{left_mps2:.4}");
            measured(&format!("{name}: accelerometer's strength, m/s²"), left);
            assert!(left_mps2 < most_mps2, "{name} {seed}: {left_mps2}");
            for (found, truth) in axes.bias.into_iter().zip(errors.bias) {
                let left = format!("{:.4}", (found - truth).abs());
                measured(&format!("{name}: accelerometer's bias, m/s²"), left);
                assert!((found - truth).abs() < most_mps2, "{name} {seed}: {axes:?}");
            }
        }
    }
}

/// Of the phone 0.005°/s of warming in 15 s, and flicker of 0.01°/s; of the board
/// a tenth of it.
#[test]
fn a_gyroscopes_bias_is_found() {
    for ((name, set), most_degps) in sets().into_iter().zip([0.05, 0.006]) {
        for seed in seeds(2) {
            let alone = HandlingTask::LeaveAlone;
            let config = config(&set, seed);
            let (found, sensors) = calibrate(&config, &GuidedKind::GyroscopeBias, alone, None);
            let Values::GyroscopeBias { bias_radps } = found.unwrap().values else {
                panic!("{name}");
            };
            let [_, errors, _] = sensors.sensors().true_errors();
            for (found, truth) in bias_radps.into_iter().zip(errors.bias) {
                let left_degps = (found - truth).abs() / DEGREE_RAD;
                let left = format!("{left_degps:.4}");
                measured(&format!("{name}: gyroscope's bias, °/s"), left);
                assert!(left_degps < most_degps, "{name} {seed}: {left_degps}");
            }
        }
    }
}

/// What the calibrated sensors make of a rate and of a force of 1 along an axis:
/// by how much they differ, at most.
fn worst_rate(rates: &Axes, forces: &Axes, errors: &[TrueErrors<3>; 3]) -> f64 {
    let [force_errors, rate_errors, _] = errors;
    let calibrated = |axes: &Axes, errors: &TrueErrors<3>, truth| {
        let free = Axes {
            bias: errors.bias,
            ..*axes
        };
        AxesCalibration::new(&free).applied(given(errors, truth))
    };
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let pairs = axes.map(|axis| {
        let rate = calibrated(rates, rate_errors, axis);
        let force = calibrated(forces, force_errors, axis);
        [0, 1, 2].map(|part| (rate[part] - force[part]).abs())
    });
    pairs.into_iter().flatten().fold(0.0, f64::max)
}

/// Scale and cross axes of 2 % of the phone, of 0.5 and 1.25 % of the board. While
/// it is turned for a minute the phone's accelerometer warms up by another 1 mg or
/// so, 0.06°, and the board's by a tenth of it.
#[test]
fn a_gyroscopes_scale_and_misalignment_are_found() {
    for ((name, set), most) in sets().into_iter().zip([3e-3, 5e-4]) {
        for seed in seeds(3) {
            let config = config(&set, seed);
            let accelerometer = accelerometer(&config);
            let kind = turned(accelerometer);
            let (found, sensors) = calibrate(&config, &kind, HandlingTask::TurnOver, None);
            let found = found.unwrap();
            let Values::Gyroscope { axes, .. } = found.values else {
                panic!("{found:?}");
            };
            let errors = sensors.sensors().true_errors();
            let before = worst_rate(&Axes::default(), &accelerometer, &errors);
            let left = worst_rate(&axes, &accelerometer, &errors);
            let what = format!("{name}: gyroscope's scale and cross axes, %");
            measured(&what, format!("{:.3}", 100.0 * left));
            assert!(
                before > 0.01 && left < most,
                "{name} {seed}: {before} {left}"
            );
            assert!(found.sigma < most, "{name} {seed}: {found:?}");
        }
    }
}

fn turned(accelerometer: Axes) -> GuidedKind {
    GuidedKind::Gyroscope {
        accelerometer,
        turn: Rotation::NONE,
    }
}

#[test]
fn a_magnetometer_is_found_and_aligned() {
    for ((name, set), most_ut) in sets().into_iter().zip([0.6, 0.05]) {
        for seed in seeds(2) {
            let config = config(&set, seed);
            let accelerometer = accelerometer(&config);
            let kind = GuidedKind::Magnetometer {
                earth: EarthField::Strength(50.0),
                accelerometer: Some(accelerometer),
            };
            let (found, sensors) = calibrate(&config, &kind, HandlingTask::Tumble, None);
            let found = found.unwrap();
            let Values::Magnetometer { axes, mounting, .. } = found.values else {
                panic!("{found:?}");
            };
            let [_, _, errors] = sensors.sensors().true_errors();
            let left_ut = worst(&axes, &errors, 50.0);
            let left = format!("{left_ut:.3}");
            measured(&format!("{name}: magnetometer's strength, µT"), left);
            assert!(left_ut < most_ut, "{name} {seed}: {left_ut} {found:?}");
            let (mounting, rotation) = mounting.unwrap();
            assert_eq!(mounting.to_string(), "forward-right-down");
            // Misalignments of 2 % turn it by 1° or so.
            assert!(rotation.angle_rad() < 4.0 * DEGREE_RAD, "{name} {seed}");
        }
    }
}

#[test]
fn a_pitot_tubes_zero_is_found() {
    for (name, set) in sets() {
        for seed in seeds(2) {
            let alone = HandlingTask::LeaveAlone;
            let config = config(&set, seed);
            let (found, sensors) = calibrate(&config, &GuidedKind::Airspeed, alone, None);
            let Values::Airspeed { bias_pa } = found.unwrap().values else {
                panic!("{name}");
            };
            let [truth] = sensors.sensors().pitot_errors().bias;
            let left = format!("{:.2}", (bias_pa - truth).abs());
            measured(&format!("{name}: pitot tube's zero, Pa"), left);
            // 2 Pa of noise, and 0.1 Pa of warming.
            assert!((bias_pa - truth).abs() < 0.7, "{name} {seed}: {bias_pa}");
        }
    }
}

#[test]
fn a_mounting_is_found_to_what_misalignment_leaves() {
    for seed in seeds(2) {
        let config = config(&RawSensorSet::board(), seed);
        let accelerometer = accelerometer(&config);
        let kind = GuidedKind::Mounting {
            way: MountingWay::LevelAndNoseUp,
            accelerometer,
        };
        let task = HandlingTask::LevelAndNoseUp;
        let (found, sensors) = calibrate(&config, &kind, task, None);
        let Values::Mounting { mounting, rotation } = found.unwrap().values else {
            panic!("{seed}");
        };
        assert_eq!(mounting.to_string(), "forward-right-down");
        // After it, the force of a level aircraft points up.
        let [errors, ..] = sensors.sensors().true_errors();
        let axes = Axes {
            mounting,
            rotation,
            ..accelerometer
        };
        let calibration = AxesCalibration::new(&axes);
        let [x, y, z] = calibration.applied(given(&errors, [0.0, 0.0, -G]));
        let tilt_deg = x.hypot(y).atan2(-z) / DEGREE_RAD;
        assert!(tilt_deg < 0.1, "{seed}: {tilt_deg}");
    }
}

#[test]
fn poor_handling_is_refused_with_the_reason() {
    type Case = (
        GuidedKind,
        HandlingTask,
        HandlingFault,
        fn(&Refusal) -> bool,
    );
    let magnetometer = GuidedKind::Magnetometer {
        earth: EarthField::Strength(50.0),
        accelerometer: None,
    };
    let mounting = GuidedKind::Mounting {
        way: MountingWay::LevelAndNoseUp,
        accelerometer: Axes::default(),
    };
    let alone = HandlingTask::LeaveAlone;
    let is_early: fn(&Refusal) -> bool = |of| matches!(of, Refusal::TooFew { .. });
    let cases: [Case; 9] = [
        (
            GuidedKind::Accelerometer,
            HandlingTask::Places,
            HandlingFault::EndsEarly,
            is_early,
        ),
        (
            GuidedKind::Accelerometer,
            HandlingTask::Places,
            HandlingFault::Restless,
            |of| matches!(of, Refusal::Moved { .. } | Refusal::TooFew { .. }),
        ),
        (
            GuidedKind::GyroscopeBias,
            alone,
            HandlingFault::EndsEarly,
            is_early,
        ),
        (
            GuidedKind::GyroscopeBias,
            alone,
            HandlingFault::Restless,
            |of| matches!(of, Refusal::Moved { .. } | Refusal::TooFew { .. }),
        ),
        (
            magnetometer,
            HandlingTask::Tumble,
            HandlingFault::EndsEarly,
            is_early,
        ),
        (
            magnetometer,
            HandlingTask::Tumble,
            HandlingFault::Magnet,
            |of| {
                matches!(
                    of,
                    Refusal::Poor { .. } | Refusal::Strength { .. } | Refusal::Fit(_)
                )
            },
        ),
        (
            GuidedKind::Airspeed,
            alone,
            HandlingFault::EndsEarly,
            is_early,
        ),
        (GuidedKind::Airspeed, alone, HandlingFault::Restless, |of| {
            matches!(of, Refusal::Moved { .. } | Refusal::TooFew { .. })
        }),
        (
            mounting,
            HandlingTask::LevelAndNoseUp,
            HandlingFault::EndsEarly,
            is_early,
        ),
    ];
    for (name, set) in sets() {
        for (kind, task, fault, is_expected) in &cases {
            let (found, _) = calibrate(&config(&set, 1), kind, *task, Some(*fault));
            let refused = found.unwrap_err();
            assert!(
                is_expected(&refused),
                "{name} {kind:?} {fault:?}: {refused}"
            );
        }
    }
}

#[test]
fn poor_turning_is_refused_with_the_reason() {
    for (name, set) in sets() {
        let config = config(&set, 1);
        let kind = turned(accelerometer(&config));
        for fault in [
            HandlingFault::EndsEarly,
            HandlingFault::OneAxis,
            HandlingFault::Restless,
        ] {
            let (found, _) = calibrate(&config, &kind, HandlingTask::TurnOver, Some(fault));
            let refused = found.unwrap_err();
            let is_expected = match refused {
                Refusal::TooFew { have, needed } => needed == 1 || have <= 1,
                Refusal::Moved { .. } => fault == HandlingFault::Restless,
                _ => false,
            };
            assert!(is_expected, "{name} {fault:?}: {refused}");
        }
    }
}
