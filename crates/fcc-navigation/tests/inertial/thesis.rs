//! The way of the thesis against its own formulas (section 5.6).

use fcc_core::flight::atmosphere::pressure_pa;
use fcc_core::flight::orientation::{
    EulerAngles, earth_to_body, euler_from_quaternion, quaternion_from_euler,
};
use fcc_navigation::inertial::{
    InertialNavigation, Observation, PHONE_BELOW, Solution, ThesisNavigation,
};

use super::sensors::{FIELD_UT, time};

fn navigated(force: [f64; 3], field: [f64; 3]) -> Solution {
    let mut navigation = ThesisNavigation::new();
    navigation.observe(time(0.0), Observation::MagneticField(field));
    navigation.observe(time(0.0), Observation::SpecificForce(force));
    navigation.step(time(0.0))
}

/// At rest the specific force is against gravity, and the field is the earth's:
/// roll, pitch and the magnetic heading are those that the body has.
#[test]
fn at_rest_gravity_and_field_give_the_orientation() {
    let declination = FIELD_UT[1].atan2(FIELD_UT[0]);
    for (roll_deg, pitch_deg, heading_deg) in [
        (0.0, 0.0, 0.0),
        (30.0, -10.0, 100.0),
        (-60.0, 45.0, 350.0),
        (170.0, 5.0, 200.0),
    ] {
        let angles = EulerAngles {
            roll_rad: f64::to_radians(roll_deg),
            pitch_rad: f64::to_radians(pitch_deg),
            heading_rad: f64::to_radians(heading_deg) + declination,
        };
        let body = quaternion_from_euler(angles);
        let force = earth_to_body(body, [0.0, 0.0, -9.81]);
        let solution = navigated(force, earth_to_body(body, FIELD_UT));
        let found = euler_from_quaternion(solution.quaternion);
        assert!((found.roll_rad.to_degrees() - roll_deg).abs() < 1e-9);
        assert!((found.pitch_rad.to_degrees() - pitch_deg).abs() < 1e-9);
        let off = found.heading_rad.to_degrees() - heading_deg;
        assert!((off + 180.0).rem_euclid(360.0) - 180.0 < 1e-9, "{off}");
        // The wind is neglected: the angle of attack is the pitch.
        assert!((solution.angle_of_attack_rad - angles.pitch_rad).abs() < 1e-9);
    }
}

/// `output += 0.15 * (input - output)` at 40 Hz: after a step of the input from
/// 0 to 1 the output is 1 - 0.85ⁿ. Here it is the share of gravity that has
/// turned from down to the right.
#[test]
fn gravity_is_what_the_low_pass_leaves() {
    let mut navigation = ThesisNavigation::new();
    let (down, right) = ([0.0, 0.0, -9.81], [0.0, -9.81, 0.0]);
    navigation.observe(time(0.0), Observation::SpecificForce(down));
    for (sample, left) in [(1, 0.85), (2, 0.7225), (3, 0.614_125), (4, 0.522_006_25)] {
        let now = time(0.025 * f64::from(sample));
        navigation.observe(now, Observation::SpecificForce(right));
        let roll = euler_from_quaternion(navigation.step(now).quaternion).roll_rad;
        assert!(
            (roll.tan() - (1.0 - left) / left).abs() < 1e-6,
            "sample {sample}"
        );
    }
}

/// In a coordinated turn the force is square to the wings: the thesis' way shows
/// no bank, which is why it is not the one to fly with.
#[test]
fn it_does_not_see_a_coordinated_turn() {
    let solution = navigated(
        [0.0, 0.0, -9.81 / 30.0_f64.to_radians().cos()],
        [20.0, 0.0, 40.0],
    );
    let found = euler_from_quaternion(solution.quaternion);
    assert!(found.roll_rad.abs() < 1e-12);
}

/// Figure 5.9 with ISO 2533's 898.746 hPa at 1,000 m.
#[test]
fn altitude_is_that_of_the_barometer() {
    let mut navigation = ThesisNavigation::new();
    navigation.observe(time(0.0), Observation::StaticPressure(89_874.6));
    let altitude_m = navigation.step(time(0.0)).position.altitude_m;
    assert!((altitude_m - 1_000.0).abs() < 0.1);
    assert!((pressure_pa(altitude_m) - 89_874.6).abs() < 1e-6);
}

/// The phone hangs below the aircraft, its screen down and its top to the nose:
/// seen from above it lies on its face, and its right edge (x) is to the left.
#[test]
fn the_axes_of_the_phone_become_those_of_the_body() {
    let body = |phone: [f64; 3]| {
        PHONE_BELOW.map(|row| row.iter().zip(phone).map(|(a, b)| a * b).sum::<f64>())
    };
    assert_eq!(body([0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]);
    assert_eq!(body([1.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
    assert_eq!(body([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
}

/// As Android's `getRotationMatrix` returns false in free fall: the orientation
/// stays what it was.
#[test]
fn in_free_fall_the_orientation_stays() {
    let mut navigation = ThesisNavigation::new();
    navigation.observe(time(0.0), Observation::MagneticField([20.0, 0.0, 40.0]));
    navigation.observe(time(0.0), Observation::SpecificForce([0.0, -4.905, -8.496]));
    let before = navigation.step(time(0.0)).quaternion;
    navigation.observe(time(60.0), Observation::SpecificForce([0.0; 3]));
    assert_eq!(navigation.step(time(60.0)).quaternion, before);
}
