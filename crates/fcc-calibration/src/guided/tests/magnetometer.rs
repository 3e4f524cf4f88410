use super::*;

/// The field at 80° north on the equator of longitudes at the beginning of 2025:
/// a test value of the World Magnetic Model's report, 55,178.5 nT.
#[test]
fn a_magnetometer_is_scaled_to_the_model_where_it_is() {
    let kind = GuidedKind::Magnetometer {
        earth: EarthField::InYear(2025.0),
        accelerometer: None,
    };
    let mut hand = Hand::new(&kind);
    hand.earth_ut = [6.5216, 0.1459, 54.7915];
    hand.field = |[x, y, z]| [1.05 * x + 30.0, 0.97 * y + 0.02 * x - 80.0, z + 12.0];
    hand.fix = Some(GnssFix {
        position: Position {
            latitude_rad: 80.0_f64.to_radians(),
            ..Position::default()
        },
        velocity: Velocity::default(),
        ..GnssFix::default()
    });
    hand.tumble(2.0);
    assert!(matches!(hand.calibration.next(), Next::Turn(_)));
    hand.tumble(90.0);
    let found = hand.finish().unwrap();
    let Values::Magnetometer {
        axes,
        mounting,
        strength_ut,
        is_of_model,
    } = found.values
    else {
        panic!("{found:?}");
    };
    assert!((strength_ut - 55.1785).abs() < 1e-3 && is_of_model);
    assert_eq!(mounting, None);
    near(axes.bias, [30.0, -80.0, 12.0], 0.5);
    near(axes.scale, [1.0 / 1.05, 1.0 / 0.97, 1.0], 0.01);
    // The noise is 0.5 µT.
    assert!((0.3..0.8).contains(&found.quality.error), "{found:?}");
}

/// Its axes are turned against the accelerometer's, which is on its side.
#[test]
fn a_magnetometer_is_aligned_with_the_accelerometer() {
    let accelerometer = Axes {
        mounting: "forward-down-left".parse().unwrap(),
        ..Axes::default()
    };
    let kind = GuidedKind::Magnetometer {
        earth: EarthField::Unknown,
        accelerometer: Some(accelerometer),
    };
    let mut hand = Hand::new(&kind);
    // Body y is the accelerometer's -z, and body z its y; the magnetometer is
    // turned by 5° to the right of backward-left-down.
    hand.force = |[x, y, z]| [x, z, -y];
    hand.field = |[x, y, z]| {
        let (sin, cos) = 5.0_f64.to_radians().sin_cos();
        [-cos * x - sin * y, sin * x - cos * y, z]
    };
    hand.tumble(90.0);
    let found = hand.finish().unwrap();
    let Values::Magnetometer {
        mounting: Some((mounting, rotation)),
        strength_ut,
        is_of_model,
        ..
    } = found.values
    else {
        panic!("{found:?}");
    };
    assert_eq!(mounting.to_string(), "backward-left-down");
    let angles = rotation.angles();
    let degrees = [angles.roll_rad, angles.pitch_rad, angles.heading_rad].map(f64::to_degrees);
    near(degrees, [0.0, 0.0, 5.0], 0.3);
    // As measured.
    assert!((strength_ut - 49.66).abs() < 0.5 && !is_of_model);
}

#[test]
fn a_poor_field_is_refused() {
    let kind = |earth| GuidedKind::Magnetometer {
        earth,
        accelerometer: None,
    };
    let known = kind(EarthField::Strength(49.66));
    let mut hand = Hand::new(&known);
    hand.place([0.0, 0.0, -1.0], 10.0);
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::TooFew { needed: 30, .. }));
    // Twice the field: a magnet beneath.
    let mut hand = Hand::new(&known);
    hand.field = |field| field.map(|part| 2.0 * part);
    hand.tumble(90.0);
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::Strength { .. }), "{refused}");
    // A piece of steel that the sensor comes near to and leaves.
    let mut hand = Hand::new(&kind(EarthField::Unknown));
    hand.field = |[x, y, z]| {
        let near = if x > 20.0 { 15.0 } else { 0.0 };
        [x + near, y, z - near]
    };
    hand.tumble(90.0);
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::Poor { .. }), "{refused}");
    // At the end of its range in one direction.
    let mut hand = Hand::new(&kind(EarthField::Unknown));
    hand.field = |[x, y, z]| [x + 790.0, y, z];
    hand.tumble(90.0);
    assert_eq!(hand.finish(), Err(Refusal::Saturated { axis: 0 }));
}
