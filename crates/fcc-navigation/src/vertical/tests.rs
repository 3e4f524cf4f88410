//! Of a marked altitude and of the accelerometer's bias.

use super::*;
use fcc_core::flight::SpecificForce;
use fcc_core::framework::Reading;

const DT_S: f64 = 0.025;
const SAMPLES: i64 = 200;
/// The noise of a phone's sensors, one sigma in every sample.
const ALTITUDE_SIGMA_M: f64 = 0.762;
const FORCE_SIGMA_MPS2: f64 = 0.183;

/// Normal numbers: twelve uniform ones, of a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let sum: f64 = (0..12)
            .map(|_| {
                self.0 = self
                    .0
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            })
            .sum();
        sum - 6.0
    }
}

fn root_mean_square(errors: &[f64]) -> f64 {
    let sum: f64 = errors.iter().map(|error| error * error).sum();
    libm::sqrt(sum / errors.len() as f64)
}

/// Level flight at 900 m. A straight line fitted to 5 s of samples is
/// accurate to 2σ/√N at its end, 0.11 m, and after as many further samples
/// to σ/√(2N) there, 0.04 m (Bar-Shalom, Li and Kirubarajan 2001, section
/// 3.5). A filter without knowledge of slope and bias, with a noisy
/// accelerometer, cannot be better than either.
#[test]
fn a_marked_altitude_is_refined_later() {
    let mut noise = Noise(7);
    let mut at_once = [0.0; 60];
    let mut later = [0.0; 60];
    for trial in 0..at_once.len() {
        let mut channel = VerticalChannel::new(0.7);
        let mut state = VerticalState::default();
        for sample in 1..=2 * SAMPLES {
            let now = Time::from_nanos(sample * 25_000_000);
            let force = SpecificForce {
                z_mps2: -GRAVITY_MPS2 + FORCE_SIGMA_MPS2 * noise.next(),
                ..SpecificForce::default()
            };
            let measurements = Measurements {
                specific_force: Reading::new(force, now),
                altitude_m: Reading::new(900.0 + ALTITUDE_SIGMA_M * noise.next(), now),
                ..Measurements::default()
            };
            state = channel.step(now, &measurements, &Orientation::default(), DT_S);
            if sample == SAMPLES {
                channel.mark();
                at_once[trial] = state.altitude_m - 900.0;
            }
        }
        later[trial] = channel.marked_altitude_m().unwrap() - 900.0;
        assert!(state.climb_rate_mps.abs() < 0.5);
    }
    let (at_once, later) = (root_mean_square(&at_once), root_mean_square(&later));
    assert!((0.10..0.18).contains(&at_once), "{at_once}");
    assert!((0.04..0.075).contains(&later), "{later}");
}

/// A bias of 0.2 m/s² is estimated within a minute.
#[test]
fn the_bias_is_estimated() {
    let mut channel = VerticalChannel::new(0.7);
    let mut state = VerticalState::default();
    for sample in 1..=2_400 {
        let now = Time::from_nanos(sample * 25_000_000);
        let force = SpecificForce {
            z_mps2: -GRAVITY_MPS2 - 0.2,
            ..SpecificForce::default()
        };
        let measurements = Measurements {
            specific_force: Reading::new(force, now),
            // Not to the last bit, as of a coarse altimeter.
            altitude_m: Reading::new(900.0 + (sample % 2) as f64 * 1e-6, now),
            ..Measurements::default()
        };
        state = channel.step(now, &measurements, &Orientation::default(), DT_S);
    }
    assert!(
        (channel.bias_mps2 - 0.2).abs() < 0.01,
        "{}",
        channel.bias_mps2
    );
    assert!(
        (state.altitude_m - 900.0).abs() < 0.05,
        "{}",
        state.altitude_m
    );
}

/// A shift of the altimeter by 5 m or more is a change of altitude and of nothing else: no
/// climb, no bias. A single sample that is off by as much changes nothing.
#[test]
fn a_step_of_the_altimeter_is_no_climb() {
    for shift_m in [-5.0, 5.0, 10.0] {
        shift_by(shift_m);
    }
}

fn shift_by(shift_m: f64) {
    let mut channel = VerticalChannel::new(0.7);
    for sample in 1..=2_400 {
        let now = Time::from_nanos(sample * 25_000_000);
        let force = SpecificForce {
            z_mps2: -GRAVITY_MPS2,
            ..SpecificForce::default()
        };
        let off_m = if sample == 600 || sample >= 1_200 {
            shift_m
        } else {
            0.0
        };
        let measurements = Measurements {
            specific_force: Reading::new(force, now),
            altitude_m: Reading::new(900.0 + off_m + (sample % 2) as f64 * 1e-6, now),
            ..Measurements::default()
        };
        let state = channel.step(now, &measurements, &Orientation::default(), DT_S);
        assert!(state.climb_rate_mps.abs() < 0.05, "{sample}: {state:?}");
        assert!(channel.bias_mps2.abs() < 0.01);
        let is_settling = (1_200..1_203).contains(&sample);
        let shown_m = if sample < 1_200 {
            900.0
        } else {
            900.0 + shift_m
        };
        assert!(
            is_settling || (state.altitude_m - shown_m).abs() < 0.1,
            "{sample}"
        );
    }
}

/// An altimeter with a new value every two seconds, in a descent of 7 m/s: what differs by
/// 14 m each time is the descent, and no step. Before, it descended with 0.3 m/s.
#[test]
fn the_changes_of_a_slow_altimeter_are_a_descent() {
    let mut channel = VerticalChannel::new(0.7);
    let (mut down_mps, mut shown_m, mut altitude_m) = (0.0_f64, 900.0, 900.0);
    for sample in 1..=4_800_i64 {
        let now = Time::from_nanos(sample * 25_000_000);
        let faster_mps2 = if (2_400..2_680).contains(&sample) {
            1.0
        } else {
            0.0
        };
        down_mps += faster_mps2 * DT_S;
        altitude_m -= down_mps * DT_S;
        if sample % 80 == 0 {
            shown_m = altitude_m;
        }
        let force = SpecificForce {
            z_mps2: faster_mps2 - GRAVITY_MPS2,
            ..SpecificForce::default()
        };
        let measurements = Measurements {
            specific_force: Reading::new(force, now),
            altitude_m: Reading::new(shown_m, now),
            ..Measurements::default()
        };
        let state = channel.step(now, &measurements, &Orientation::default(), DT_S);
        // Its values are up to 2 s old.
        let late_m = state.altitude_m - altitude_m;
        assert!((-7.0..21.0).contains(&late_m), "{sample}: {late_m}");
        let off_mps = state.climb_rate_mps + down_mps;
        assert!(sample < 2_900 || off_mps.abs() < 2.5, "{sample}: {off_mps}");
    }
}
