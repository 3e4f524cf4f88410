//! Gyroscopes whose bias jumps in flight.

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::orientation::euler_from_quaternion;

use super::flight::{Flight, Manoeuvre};
use super::sensors::{Fitted, Run};

const JUMPS_S: f64 = 60.0;

fn level(_: f64) -> (f64, f64, f64) {
    (0.0, 0.0, 50.0)
}

fn slow(_: f64) -> (f64, f64, f64) {
    (0.0, -0.05, 30.0)
}

fn turns(time_s: f64) -> (f64, f64, f64) {
    let share = (time_s / 15.0).sin();
    (25.0_f64.to_radians() * share * share * share, 0.0, 50.0)
}

/// Largest error of the tilt, and how long it is beyond 10 and 5 deg, and sigma there.
fn errors(manoeuvre: Manoeuvre, fitted: Fitted, seed: u64) -> [f64; 5] {
    let flight = Flight::new(manoeuvre, seed as f64, [-6.0, 8.0]).in_turbulence(seed);
    let mut run = Run::new(flight, fitted, seed);
    run.until(JUMPS_S, |_, _| {});
    let mut out = [0.0_f64; 5];
    run.until(JUMPS_S + 40.0, |truth, solution| {
        let found = euler_from_quaternion(solution.quaternion);
        let roll = wrap_pi(found.roll_rad - truth.angles.roll_rad).abs();
        let pitch = (found.pitch_rad - truth.angles.pitch_rad).abs();
        let heading = wrap_pi(found.heading_rad - truth.angles.heading_rad).abs();
        let tilt = roll.max(pitch).to_degrees();
        out[0] = out[0].max(tilt);
        if tilt > 10.0 {
            out[1] += 0.02;
        }
        if tilt > 5.0 {
            out[2] = truth.time_s - JUMPS_S;
        }
        out[3] = out[3].max(heading.to_degrees());
        out[4] = out[4].max((roll / solution.sigma.roll_rad).max(pitch / solution.sigma.pitch_rad));
    });
    out
}

#[test]
fn experiment() {
    for (name, compass, airspeed) in [
        ("all", true, true),
        ("no compass", false, true),
        ("no airspeed", true, false),
    ] {
        for (mname, m) in [
            ("level", level as Manoeuvre),
            ("slow", slow),
            ("turns", turns),
        ] {
            let mut line = format!("{name:12} {mname:6}");
            for dps in [0.0, 1.0, 2.0, 4.0, 8.0_f64] {
                let mut worst = [0.0_f64; 5];
                for axis in 0..3 {
                    for sign in [-1.0, 1.0] {
                        let mut jump = [0.0; 3];
                        jump[axis] = sign * dps.to_radians();
                        let fitted = Fitted {
                            compass,
                            airspeed,
                            jumps: (jump, JUMPS_S),
                            ..Fitted::default()
                        };
                        for seed in 1..=2 {
                            let e = errors(m, fitted, seed + 10 * axis as u64);
                            for i in 0..5 {
                                worst[i] = worst[i].max(e[i]);
                            }
                        }
                    }
                }
                let [a, b, c, d, e] = worst;
                line += &format!(" | {dps}: {a:4.1} {b:4.1}s {c:4.1}s h{d:4.1} {e:4.1}sd");
            }
            for axis in 0..3 {
                let mut worst = [0.0_f64; 5];
                for sign in [-1.0, 1.0] {
                    let mut jump = [0.0; 3];
                    jump[axis] = sign * 6.0_f64.to_radians();
                    let fitted = Fitted {
                        compass,
                        airspeed,
                        jumps: (jump, JUMPS_S),
                        ..Fitted::default()
                    };
                    for seed in 1..=2 {
                        let e = errors(m, fitted, seed + 10 * axis as u64);
                        for i in 0..5 {
                            worst[i] = worst[i].max(e[i]);
                        }
                    }
                }
                let [a, b, c, d, _] = worst;
                line += &format!(" || 6 {axis}: {a:4.1} {b:4.1}s {c:4.1}s h{d:4.1}");
            }
            println!("{line}");
        }
    }
}
