use super::*;
use crate::Mounting;

/// Every right-angled mounting, with a free rotation of some degrees.
#[test]
fn a_mounting_is_found_from_level_and_nose_up() {
    for mounting in Mounting::all() {
        let axes = Axes {
            mounting,
            rotation: Rotation::of_angles(EulerAngles {
                roll_rad: 0.03,
                pitch_rad: -0.05,
                heading_rad: 0.10,
            }),
            ..Axes::default()
        };
        let kind = GuidedKind::Mounting {
            way: MountingWay::LevelAndNoseUp,
            accelerometer: Axes::default(),
        };
        let mut calibration = GuidedCalibration::new(&kind);
        let to_sensor = axes.turn().back();
        let mut now = 0;
        for pitch_deg in [0.0, 10.0, 30.0_f64] {
            for _ in 0..200 {
                now += STEP_NS;
                let attitude = of(0.0, pitch_deg.to_radians(), 1.0);
                let body = earth_to_body(attitude, [0.0, 0.0, -G]);
                let [x_mps2, y_mps2, z_mps2] = to_sensor.turned(body);
                let force = SpecificForce {
                    x_mps2,
                    y_mps2,
                    z_mps2,
                };
                calibration.take(&Measurements {
                    raw_specific_force: Reading::new(force, Time::from_nanos(now)),
                    ..Measurements::default()
                });
            }
            // 10° are too few.
            let expected = if pitch_deg < 20.0 {
                Next::RaiseNose
            } else {
                Next::Done
            };
            assert_eq!(calibration.next(), expected, "{mounting}");
        }
        let Values::Mounting {
            mounting: found,
            rotation,
        } = calibration.finish().unwrap().values
        else {
            panic!("{mounting}");
        };
        assert_eq!(found, mounting);
        near(
            rotation.after(&axes.rotation.back()).0[0],
            [1.0, 0.0, 0.0],
            1e-6,
        );
        near(
            rotation.after(&axes.rotation.back()).0[1],
            [0.0, 1.0, 0.0],
            1e-6,
        );
    }
}

#[test]
fn level_alone_keeps_where_the_sensor_points() {
    let before = Axes {
        mounting: "left-forward-down".parse().unwrap(),
        ..Axes::default()
    };
    let kind = GuidedKind::Mounting {
        way: MountingWay::LevelOnly,
        accelerometer: before,
    };
    let mut hand = Hand::new(&kind);
    // Its y axis points 5° above the aircraft's forward.
    hand.force = |[_, _, z]| {
        let (sin, cos) = 5.0_f64.to_radians().sin_cos();
        [0.0, -sin * z, cos * z]
    };
    hand.hold(of(0.0, 0.0, 0.0), 5.0);
    let found = hand.finish().unwrap();
    let Values::Mounting { mounting, rotation } = found.values else {
        panic!("{found:?}");
    };
    assert_eq!(mounting, before.mounting);
    assert!((rotation.angles().pitch_rad.to_degrees() - 5.0).abs() < 0.1);
    assert!(rotation.angles().heading_rad.abs() < 0.01);
    // An accelerometer that is not calibrated.
    let mut hand = Hand::new(&kind);
    hand.force = |force| force.map(|part| 1.05 * part);
    hand.hold(of(0.0, 0.0, 0.0), 5.0);
    assert!(matches!(hand.finish(), Err(Refusal::Strength { .. })));
}

#[test]
fn a_sensor_that_gives_nothing_is_silent() {
    let mut calibration = GuidedCalibration::new(&GuidedKind::GyroscopeBias);
    calibration.take(&Measurements::default());
    assert_eq!(calibration.next(), Next::Wait);
    assert_eq!(calibration.finish(), Err(Refusal::Silent));
    assert!(calibration.is_silent());
}

/// Rotations and angles are each other's inverse, as those of
/// `quaternion_from_euler` are.
#[test]
fn the_angles_of_a_rotation_are_those_it_was_made_of() {
    for angles in [[0.1, 0.2, 0.3], [-2.0, 1.2, -3.0], [3.0, -1.5, 1.0]] {
        let [roll_rad, pitch_rad, heading_rad] = angles;
        let rotation = Rotation::of_angles(EulerAngles {
            roll_rad,
            pitch_rad,
            heading_rad,
        });
        let again = rotation.angles();
        let found = [again.roll_rad, again.pitch_rad, again.heading_rad];
        near(found, angles, 1e-12);
        let cosine = 0.5 * ((0..3).map(|n| rotation.0[n][n]).sum::<f64>() - 1.0);
        assert!((rotation.angle_rad() - cosine.acos()).abs() < 1e-12);
        near(
            rotation.back().after(&rotation).0[2],
            [0.0, 0.0, 1.0],
            1e-12,
        );
    }
}

#[test]
fn a_force_that_points_down_is_not_levelled() {
    assert_eq!(levelled([0.0, 0.0, G]), None);
    assert_eq!(levelled([0.0; 3]), None);
    let turned = levelled([G * FRAC_1_SQRT_2, 0.0, -G * FRAC_1_SQRT_2]).unwrap();
    assert!((turned.angle_rad() - PI / 4.0).abs() < 1e-12);
    let attitude = of(0.0, PI / 4.0, 0.0);
    near(
        body_to_earth(attitude, [1.0, 0.0, 0.0]),
        turned.turned([1.0, 0.0, 0.0]),
        1e-12,
    );
}
