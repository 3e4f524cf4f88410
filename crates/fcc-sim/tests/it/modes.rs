//! The modes of small motion against textbooks.
//!
//! The model is linearised by differences about its own trim; its eigenvalues
//! must be those published for the same derivatives. For the Navion these are
//! Nelson's (1998, examples 4.3 and 5.3); airplane A's are Roskam's equations
//! (1995, ch. 5) with his table, computed by `linear_modes.py` in this folder,
//! which shares no code with the model.

use fcc_sim::aerodynamics::Deflections;
use fcc_sim::airframe::{
    Drag, Inertia, LateralDerivatives, LateralRow, Lift, PitchDerivatives, Propulsion,
};
use fcc_sim::atmosphere::Air;
use fcc_sim::motion::{AirMotion, State, derivative};
use fcc_sim::units::{FOOT_M, POUND_KG, SLUG_FT2_KGM2};
use fcc_sim::{Airframe, trim};
use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};

/// Natural frequency in rad/s and damping ratio of the oscillations, fastest
/// first, and the real roots in 1/s.
struct Modes {
    oscillations: Vec<(f64, f64)>,
    real: Vec<f64>,
}

/// Velocity, small rotation and turn rates: nine numbers that are constant in
/// trimmed flight.
fn modes(airframe: &Airframe, true_mps: f64, altitude_m: f64) -> Modes {
    let air = Air::at(altitude_m);
    let trim = trim(airframe, air.indicated_mps(true_mps), altitude_m).unwrap();
    let deflections = Deflections {
        elevator_rad: trim.elevator_rad,
        throttle: trim.throttle,
        ..Deflections::default()
    };
    let state_at = |x: &SVector<f64, 9>| State {
        position_m: Vector3::new(0.0, 0.0, -altitude_m),
        velocity_mps: Vector3::new(true_mps + x[0], x[1], x[2]),
        attitude: UnitQuaternion::from_euler_angles(0.0, trim.alpha_rad, 0.0)
            * UnitQuaternion::from_scaled_axis(Vector3::new(x[3], x[4], x[5])),
        rates_radps: Vector3::new(x[6], x[7], x[8]),
    };
    let slope = |x: &SVector<f64, 9>| {
        let change = derivative(
            airframe,
            &state_at(x),
            &deflections,
            &AirMotion::CALM,
            &air,
            None,
        );
        let (a, w) = (change.acceleration_mps2, change.angular_radps2);
        // Near zero a small rotation changes by the turn rates.
        SVector::<f64, 9>::from([a.x, a.y, a.z, x[6], x[7], x[8], w.x, w.y, w.z])
    };
    let trimmed = slope(&SVector::zeros());
    assert!(trimmed.norm() < 1e-9, "not trimmed: {trimmed}");

    let mut matrix = SMatrix::<f64, 9, 9>::zeros();
    for column in 0..9 {
        let mut x = SVector::<f64, 9>::zeros();
        x[column] = 1e-5;
        matrix.set_column(column, &((slope(&x) - slope(&-x)) / 2e-5));
    }
    let mut modes = Modes {
        oscillations: Vec::new(),
        real: Vec::new(),
    };
    for root in matrix.complex_eigenvalues().iter() {
        if root.im > 1e-6 {
            let frequency = root.re.hypot(root.im);
            modes.oscillations.push((frequency, -root.re / frequency));
        } else if root.im.abs() <= 1e-6 {
            modes.real.push(root.re);
        }
    }
    modes.oscillations.sort_by(|a, b| b.0.total_cmp(&a.0));
    modes.real.sort_by(f64::total_cmp);
    modes
}

fn assert_near(value: f64, expected: f64, share: f64, what: &str) {
    assert!(
        (value - expected).abs() <= share * expected.abs(),
        "{what}: {value:.4}, expected {expected:.4}"
    );
}

/// Short period, dutch roll, phugoid; roll and spiral. The last real root is
/// heading, which has no restoring moment: 0.
#[test]
fn airplane_a_has_its_published_modes() {
    let published = Airframe::ROSKAM_A;
    let airframe = Airframe {
        propulsion: Propulsion {
            // Thrust falls with airspeed as the tabled C_Txu -0.096 says:
            // dT/dV = (C_Txu + 2·C_Tx1)·q·S/V = 2·b·ρ·d²·V.
            polar_intercept: (-0.096 + 2.0 * 0.032) * published.wing_area_m2
                / (4.0 * published.propulsion.diameter_m.powi(2)),
            ..published.propulsion
        },
        ..published
    };
    let modes = modes(&airframe, 220.1 * FOOT_M, 5_000.0 * FOOT_M);
    let [short_period, dutch_roll, phugoid] = modes.oscillations[..] else {
        panic!("{:?}", modes.oscillations);
    };
    assert_near(short_period.0, 5.272, 0.01, "short period frequency");
    assert_near(short_period.1, 0.844, 0.01, "short period damping");
    assert_near(dutch_roll.0, 3.245, 0.01, "dutch roll frequency");
    assert_near(dutch_roll.1, 0.207, 0.01, "dutch roll damping");
    assert_near(phugoid.0, 0.1713, 0.02, "phugoid frequency");
    assert_near(phugoid.1, 0.129, 0.03, "phugoid damping");
    assert_near(modes.real[0], -13.01, 0.01, "roll");
    assert_near(modes.real[1], -0.0179, 0.03, "spiral");
    assert!(modes.real[2].abs() < 1e-6, "heading: {}", modes.real[2]);
}

#[test]
fn the_navion_has_its_published_modes() {
    let modes = modes(&navion(), 176.0 * FOOT_M, 0.0);
    let [short_period, dutch_roll, phugoid] = modes.oscillations[..] else {
        panic!("{:?}", modes.oscillations);
    };
    // -2.5 ± 2.59i, -0.0171 ± 0.213i; -0.487 ± 2.335i, -8.435, -0.00877.
    assert_near(short_period.0, 3.60, 0.02, "short period frequency");
    assert_near(short_period.1, 0.695, 0.02, "short period damping");
    assert_near(phugoid.0, 0.2137, 0.02, "phugoid frequency");
    assert_near(phugoid.1, 0.080, 0.03, "phugoid damping");
    assert_near(dutch_roll.0, 2.385, 0.02, "dutch roll frequency");
    assert_near(dutch_roll.1, 0.204, 0.02, "dutch roll damping");
    assert_near(modes.real[0], -8.435, 0.01, "roll");
    assert_near(modes.real[1], -0.008_77, 0.1, "spiral");
}

/// Nelson (1998), table B.1: Navion at sea level, 176 ft/s.
fn navion() -> Airframe {
    let induced = 0.33 / (2.0 * 0.41 * 4.44);
    Airframe {
        mass_kg: 2750.0 * POUND_KG,
        inertia: Inertia {
            xx: 1048.0 * SLUG_FT2_KGM2,
            yy: 3000.0 * SLUG_FT2_KGM2,
            zz: 3530.0 * SLUG_FT2_KGM2,
            xz: 0.0,
        },
        wing_area_m2: 184.0 * FOOT_M * FOOT_M,
        wing_span_m: 33.4 * FOOT_M,
        chord_m: 5.7 * FOOT_M,
        lift: Lift {
            zero: 0.41,
            per_alpha: 4.44,
            ..Airframe::ROSKAM_A.lift
        },
        drag: Drag {
            zero: 0.05 - induced * 0.41 * 0.41,
            induced,
        },
        pitch: PitchDerivatives {
            lift_per_alpha_rate: 0.0,
            lift_per_pitch_rate: 3.8,
            lift_per_elevator: 0.355,
            zero: 0.0,
            per_alpha: -0.683,
            per_alpha_rate: -4.36,
            per_pitch_rate: -9.96,
            per_elevator: -0.923,
            tail_arm_m: 16.0 * FOOT_M,
        },
        lateral: LateralDerivatives {
            side: LateralRow {
                per_beta: -0.564,
                per_roll_rate: 0.0,
                per_yaw_rate: 0.0,
                per_aileron: 0.0,
                per_rudder: 0.157,
            },
            roll: LateralRow {
                per_beta: -0.074,
                per_roll_rate: -0.410,
                per_yaw_rate: 0.107,
                per_aileron: 0.134,
                per_rudder: 0.107,
            },
            yaw: LateralRow {
                per_beta: 0.071,
                per_roll_rate: -0.0575,
                per_yaw_rate: -0.125,
                per_aileron: -0.0035,
                per_rudder: -0.072,
            },
        },
        // Nelson neglects the dependence of thrust on airspeed.
        propulsion: Propulsion {
            polar_intercept: 0.0,
            ..Airframe::ROSKAM_A.propulsion
        },
        ..Airframe::ROSKAM_A
    }
}
