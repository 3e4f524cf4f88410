//! What a hand moves, without airspeed and without a receiver.

use std::f64::consts::TAU;

use fcc_core::flight::earth::gravity_mps2;
use fcc_core::flight::orientation::{
    EulerAngles, body_to_earth, earth_to_body, product, quaternion_from_euler,
};
use fcc_navigation::inertial::{InertialNavigation, KalmanConfig, KalmanNavigation, Observation};

use super::noise::Random;
use super::sensors::{FIELD_UT, time};

const STEP_S: f64 = 0.01;
/// It lies still for this long, s.
const STILL_S: f64 = 5.0;

fn attitude(time_s: f64) -> [f64; 4] {
    let moving = (time_s - STILL_S).max(0.0);
    let swing = |frequency: f64| (TAU * frequency * moving).sin();
    quaternion_from_euler(EulerAngles {
        roll_rad: 1.0 * swing(0.5),
        pitch_rad: 0.7 * swing(0.8),
        heading_rad: 1.0 + 1.5 * swing(0.3),
    })
}

/// 0.25 m to and fro: up to 10 m/s² north, and half of it down.
fn acceleration(time_s: f64) -> [f64; 3] {
    if time_s < STILL_S {
        return [0.0; 3];
    }
    let omega = TAU;
    let wave = (omega * (time_s - STILL_S)).sin() * 0.25 * omega * omega;
    [-wave, 0.0, -0.5 * wave]
}

/// The rotation vector of a small turn, over its time.
fn rates(before: [f64; 4], after: [f64; 4], dt_s: f64) -> [f64; 3] {
    let [w, x, y, z] = before;
    let [w, x, y, z] = product([w, -x, -y, -z], after);
    [x, y, z].map(|part| 2.0 * part * w.signum() / dt_s)
}

/// The inclination's error: the angle between down and what is taken for it.
fn inclination_error_deg(found: [f64; 4], truth: [f64; 4]) -> f64 {
    let [_, _, cosine] = body_to_earth(found, earth_to_body(truth, [0.0, 0.0, 1.0]));
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}

/// A phone of 2013 had 3.1° and, of the heading too, 7.3° in such motion (LG
/// Nexus 5 against motion capture, 24 recordings).
#[test]
fn accelerations_of_a_hand_do_not_tip_the_horizon() {
    let mut random = Random::new(17);
    let mut navigation = KalmanNavigation::new(KalmanConfig::default());
    let (rate_bias, force_bias) = (random.vector(0.01), random.vector(0.03));
    let gravity = gravity_mps2(f64::NAN, 0.0);
    let (mut sum, mut count) = (0.0, 0.0);
    for step in 1..6_500 {
        let now = f64::from(step) * STEP_S;
        let (before, after) = (attitude(now - STEP_S), attitude(now));
        let rates = rates(before, after, STEP_S);
        let [north, east, down] = acceleration(now - 0.5 * STEP_S);
        let force = earth_to_body(attitude(now - 0.5 * STEP_S), [north, east, down - gravity]);
        let noisy = |random: &mut Random, of: [f64; 3], bias: [f64; 3], sigma: f64| {
            let noise = random.vector(sigma);
            [0, 1, 2].map(|axis| of[axis] + bias[axis] + noise[axis])
        };
        let rates = noisy(&mut random, rates, rate_bias, 0.003);
        let force = noisy(&mut random, force, force_bias, 0.05);
        let field = noisy(&mut random, earth_to_body(after, FIELD_UT), [0.0; 3], 0.5);
        navigation.observe(time(now), Observation::Rates(rates));
        navigation.observe(time(now), Observation::SpecificForce(force));
        navigation.observe(time(now), Observation::MagneticField(field));
        let solution = navigation.step(time(now));
        if now > STILL_S {
            let error = inclination_error_deg(solution.quaternion, after);
            sum += error * error;
            count += 1.0;
        }
    }
    let rms_deg = f64::sqrt(sum / count);
    assert!(rms_deg <= 3.1, "{rms_deg}°");
}
