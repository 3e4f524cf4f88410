//! A receiver whose velocities are wrong while its positions are right.

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::orientation::euler_from_quaternion;

use super::flight::{Flight, Manoeuvre};
use super::sensors::{Fitted, Run, VelocityFault};

const WRONG_S: (f64, f64) = (60.0, 140.0);
/// As `ArduPilot`'s tests of attitude have it, and the heading as an instrument pilot keeps it
/// (Instrument Rating Airman Certification Standards, FAA-S-ACS-8: ±10°).
const MOST_TILT_DEG: f64 = 3.0;
const MOST_HEADING_DEG: f64 = 10.0;

/// To the left and to the right by 25° of bank, in between straight flight.
fn turns(time_s: f64) -> (f64, f64, f64) {
    let share = (time_s / 15.0).sin();
    (25.0_f64.to_radians() * share * share * share, 0.0, 50.0)
}

/// Straight until the receiver fails; then it circles, 25° of bank.
fn circles(time_s: f64) -> (f64, f64, f64) {
    let share = ((time_s - WRONG_S.0) / 4.0).clamp(0.0, 1.0);
    (25.0_f64.to_radians() * share, 0.0, 50.0)
}

/// The largest errors of the horizon and the heading, °, from the fault on until 20 s after it.
fn errors(fault: VelocityFault, manoeuvre: Manoeuvre, heading_rad: f64, seed: u64) -> [f64; 2] {
    let fitted = Fitted {
        velocity_fault: (fault, WRONG_S),
        ..Fitted::default()
    };
    let flight = Flight::new(manoeuvre, heading_rad, [-6.0, 8.0]).in_turbulence(seed);
    let mut run = Run::new(flight, fitted, seed);
    run.until(WRONG_S.0, |_, _| {});
    let (mut tilt_deg, mut heading_deg) = (0.0_f64, 0.0_f64);
    run.until(WRONG_S.1 + 20.0, |truth, solution| {
        let found = euler_from_quaternion(solution.quaternion);
        let off = |found: f64, expected: f64| wrap_pi(found - expected).abs().to_degrees();
        let roll = off(found.roll_rad, truth.angles.roll_rad);
        let pitch = off(found.pitch_rad, truth.angles.pitch_rad);
        tilt_deg = tilt_deg.max(roll).max(pitch);
        heading_deg = heading_deg.max(off(found.heading_rad, truth.angles.heading_rad));
    });
    [tilt_deg, heading_deg]
}

fn holds(name: &str, fault: VelocityFault) {
    for manoeuvre in [turns as Manoeuvre, circles] {
        for eighth in 0_u32..8 {
            let heading_rad = f64::from(eighth) * std::f64::consts::FRAC_PI_4;
            let [tilt_deg, heading_deg] = errors(fault, manoeuvre, heading_rad, eighth.into());
            let told = format!("{name}, {heading_rad:.2}: {tilt_deg}°, {heading_deg}°");
            assert!(tilt_deg <= MOST_TILT_DEG, "{told}");
            assert!(heading_deg <= MOST_HEADING_DEG, "{told}");
        }
    }
}

/// Whatever the course is when they are swapped: that by which the velocity jumps then.
#[test]
fn north_and_east_that_are_swapped_cost_no_horizon() {
    holds("swapped", |[north, east, down], _, _| [east, north, down]);
}

#[test]
fn a_velocity_that_is_wrong_for_long_costs_no_horizon() {
    holds("off", |[north, east, down], _, _| {
        [north + 6.0, east - 4.0, down]
    });
    holds("half", |velocity, _, _| velocity.map(|part| 0.5 * part));
}

#[test]
fn a_velocity_that_becomes_noisy_costs_no_horizon() {
    holds("noisy", |velocity, since_s, random| {
        let noise = random.vector(0.1 * since_s);
        [0, 1, 2].map(|axis| velocity[axis] + noise[axis])
    });
}
/// Where north and east are the same when they are swapped, nothing jumps, and a turn begins that
/// they show the wrong way: the filter is misled for some seconds, until the places tell. The
/// attitude is not lost: the largest error is about the bank that is flown.
#[test]
fn north_and_east_that_are_swapped_while_they_are_the_same_cost_no_attitude() {
    for north_east_rad in [0.585, 4.127] {
        for step in 0_u32..16 {
            let heading_rad = north_east_rad - 0.08 + 0.01 * f64::from(step);
            let swapped: VelocityFault = |[north, east, down], _, _| [east, north, down];
            let [tilt_deg, _] = errors(swapped, circles, heading_rad, step.into());
            assert!(tilt_deg <= 30.0, "{heading_rad:.2}: {tilt_deg}°");
        }
    }
}
