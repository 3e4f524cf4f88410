//! In-flight alignment: what was lost in aerobatics is found again.

use fcc_core::flight::orientation::earth_to_body;
use fcc_navigation::inertial::Solution;

use super::flight::{Flight, Truth};
use super::sensors::{Fitted, Run};

/// Banks of up to 95°, and paths of up to 30°.
fn aerobatics(time_s: f64) -> (f64, f64, f64) {
    let bank = 1.2 * (time_s / 3.5).sin() + 0.45 * (time_s / 1.9).sin();
    (bank, 0.5 * (time_s / 4.7).sin(), 45.0)
}

/// The angle between where down is and where it is believed to be, °.
fn tilt_deg(truth: &Truth, solution: &Solution) -> f64 {
    let down = |quaternion| earth_to_body(quaternion, [0.0, 0.0, 1.0]);
    let (is, found) = (down(truth.quaternion), down(solution.quaternion));
    let cosine: f64 = is.iter().zip(found).map(|(is, found)| is * found).sum();
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Of real flights 30 to 47 % were more than 10° off 20 s after such a loss.
#[test]
fn after_a_loss_in_aerobatics_the_attitude_is_found_within_seconds() {
    for (seed, lost_s) in [(1, 2.0), (2, 5.0), (3, 20.0), (4, 2.0), (5, 5.0), (6, 20.0)] {
        for compass in [true, false] {
            for first_s in [40.0, 47.0, 54.0] {
                let until_s = first_s + lost_s;
                let fitted = Fitted {
                    compass,
                    airspeed: false,
                    inertial_lost_s: (first_s, until_s),
                    ..Fitted::default()
                };
                let flight = Flight::new(aerobatics, 1.0, [-6.0, 8.0]);
                let mut run = Run::new(flight, fitted, seed);
                run.until(until_s + 6.0, |_, _| {});
                let mut most_deg: f64 = 0.0;
                run.until(until_s + 20.0, |truth, solution| {
                    most_deg = most_deg.max(tilt_deg(truth, solution));
                });
                assert!(
                    most_deg < 10.0,
                    "{most_deg}° after {lost_s} s at {first_s} s, seed {seed}, {compass}"
                );
            }
        }
    }
}
