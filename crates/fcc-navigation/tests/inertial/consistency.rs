//! Whether the filter is as accurate as it says (Bar-Shalom, Li and Kirubarajan
//! 2001, section 5.4).

use std::ops::RangeInclusive;

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::orientation::euler_from_quaternion;
use fcc_navigation::inertial::{ObservationKind, Solution};

use super::flight::{Flight, Truth};
use super::matched::Matched;
use super::sensors::{Fitted, Run};

const FLIGHTS: u64 = 50;
/// The upper 95 % bound of χ² with 50 degrees of freedom (tables of χ²).
const BOUND: f64 = 67.5;

/// Both 95 % bounds of χ² with 150 degrees of freedom, three for each flight (the
/// same tables).
const BOTH_BOUNDS_OF_150: RangeInclusive<f64> = 117.985..=185.800;
/// The bounds of 0.1 % on either side of χ² with 50 degrees of freedom (NIST/SEMATECH
/// e-Handbook of Statistical Methods, table 1.3.6.7.4).
const WIDE_BOUNDS: RangeInclusive<f64> = 24.674..=86.661;

/// It turns to and fro from the beginning.
fn weaving(time_s: f64) -> (f64, f64, f64) {
    (
        0.5 * (0.4 * time_s).sin(),
        0.05 * (0.3 * time_s).sin(),
        30.0,
    )
}

/// The squares of the errors of roll, pitch, heading, velocity and position, each
/// over its standard deviation.
fn normalized_squares(truth: &Truth, solution: &Solution) -> [f64; 9] {
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
    let ([roll, pitch, heading], [vn, ve, vd], [n, e, u]) = (angles, velocity, position);
    [roll, pitch, heading, vn, ve, vd, n, e, u].map(|ratio| ratio * ratio)
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
        add(
            &mut sums,
            normalized_squares(&run.flight.now, &run.solution),
        );
    }
    assert!(sums.iter().all(|sum| *sum < BOUND), "{sums:.1?}");
}

fn add(sums: &mut [f64; 9], squares: [f64; 9]) {
    for (sum, square) in sums.iter_mut().zip(squares) {
        *sum += square;
    }
}

/// Of sensors that have the very errors that the filter expects, attitude, velocity
/// and position are within both bounds: the filter is neither surer than it may be
/// nor less sure than it could be. Also each axis by itself, within 99.8 %.
#[test]
fn with_the_errors_that_it_expects_the_filter_is_as_accurate_as_it_says() {
    let mut sums = [0.0; 9];
    for seed in 0..FLIGHTS {
        let heading = seed as f64 * 0.7;
        let mut run = Matched::new(Flight::new(weaving, heading, [5.0, -3.0]), seed);
        run.until(60.0);
        add(
            &mut sums,
            normalized_squares(&run.flight.now, &run.solution),
        );
    }
    let groups: Vec<f64> = sums.chunks(3).map(|axes| axes.iter().sum()).collect();
    assert!(
        groups.iter().all(|sum| BOTH_BOUNDS_OF_150.contains(sum))
            && sums.iter().all(|sum| WIDE_BOUNDS.contains(sum)),
        "{groups:.1?} of {sums:.1?}"
    );
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
