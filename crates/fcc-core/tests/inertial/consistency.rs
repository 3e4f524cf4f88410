//! Whether the filter is as accurate as it says (Bar-Shalom, Li and Kirubarajan
//! 2001, section 5.4).

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::inertial::ObservationKind;
use fcc_core::flight::orientation::euler_from_quaternion;

use super::flight::Flight;
use super::sensors::{Fitted, Run};

const FLIGHTS: u64 = 50;
/// The upper 95 % bound of χ² with 50 degrees of freedom (tables of χ²).
const BOUND: f64 = 67.5;

/// It turns to and fro from the beginning.
fn weaving(time_s: f64) -> (f64, f64, f64) {
    (
        0.5 * (0.4 * time_s).sin(),
        0.05 * (0.3 * time_s).sin(),
        30.0,
    )
}

/// The sum of the squares of 50 errors, each over its standard deviation, is
/// below the bound for each value: the filter is not surer than it may be. It
/// expects worse sensors than those of this flight.
#[test]
fn errors_are_as_large_as_the_filter_says() {
    let mut sums = [0.0; 9];
    for seed in 0..FLIGHTS {
        let fitted = Fitted {
            slow_errors: false,
            ..Fitted::default()
        };
        let heading = seed as f64 * 0.7;
        let mut run = Run::new(Flight::new(weaving, heading, [5.0, -3.0]), fitted, seed);
        run.until(30.0, |_, _| {});
        let (truth, solution) = (run.flight.now, run.solution);
        let found = euler_from_quaternion(solution.quaternion);
        let sigma = solution.sigma;
        let angles = [
            wrap_pi(found.roll_rad - truth.angles.roll_rad) / sigma.roll_rad,
            wrap_pi(found.pitch_rad - truth.angles.pitch_rad) / sigma.pitch_rad,
            wrap_pi(found.heading_rad - truth.angles.heading_rad) / sigma.heading_rad,
        ];
        let velocity = [0, 1, 2].map(|axis| {
            (solution.velocity_mps[axis] - truth.velocity[axis]) / sigma.velocity_mps[axis]
        });
        let up = solution.position.altitude_m - truth.place.altitude_m;
        let north = solution.position.latitude_rad - truth.place.latitude_rad;
        let east = solution.position.longitude_rad - truth.place.longitude_rad;
        // Metres of a radian at 47° N and 500 m (WGS-84).
        let position = [6_370_400.0 * north, 4_364_500.0 * east, up];
        let position = [0, 1, 2].map(|axis| position[axis] / sigma.position_m[axis]);
        for (sum, ratio) in sums.iter_mut().zip([angles, velocity, position].concat()) {
            *sum += ratio * ratio;
        }
    }
    assert!(sums.iter().all(|sum| *sum < BOUND), "{sums:.1?}");
}

/// Innovations are within two of their standard deviations 95 times of 100, or
/// more often.
#[test]
fn innovations_are_as_large_as_the_filter_says() {
    let mut run = Run::new(
        Flight::new(weaving, 1.0, [5.0, -3.0]),
        Fitted::default(),
        21,
    );
    let mut counted = [(0.0, 0.0); 4];
    while run.flight.now.time_s < 60.0 {
        let next = run.flight.now.time_s + super::sensors::STEP_S;
        run.until(next, |_, _| {});
        for innovation in run.navigation.innovations() {
            let at = match innovation.kind {
                ObservationKind::Position => 0,
                ObservationKind::Velocity => 1,
                ObservationKind::StaticPressure => 2,
                _ => 3,
            };
            let (total, within) = &mut counted[at];
            for (difference, sigma) in innovation.difference.iter().zip(innovation.sigma) {
                if sigma > 0.0 {
                    *total += 1.0;
                    *within += f64::from(u8::from(difference.abs() <= 1.96 * sigma));
                }
            }
        }
    }
    for (total, within) in counted {
        assert!(total > 100.0 && within / total >= 0.95, "{counted:?}");
    }
}
