//! Physical behaviour of the aircraft and sign conventions.

use crate::pilot::Pilot;
use fcc_core::flight::Surfaces;
use fcc_sim::aerodynamics::Deflections;
use fcc_sim::airframe::{Inertia, Propulsion};
use fcc_sim::atmosphere::Air;
use fcc_sim::motion::{AirMotion, State};
use fcc_sim::units::DEGREE_RAD;
use fcc_sim::{Aircraft, Airframe, SimConfig, Truth, Wind};
use nalgebra::{UnitQuaternion, Vector3};

const G: f64 = 9.806_65;

fn default_aircraft() -> Aircraft {
    Aircraft::new(&SimConfig::default()).unwrap()
}

/// The truth a second after surfaces moved away from trim.
fn after_a_second(change: Surfaces) -> Truth {
    let mut aircraft = default_aircraft();
    let throttle = aircraft.hands_off().throttle + change.throttle;
    aircraft.step(&Surfaces { throttle, ..change }, 1.0);
    aircraft.truth()
}

#[test]
fn with_hands_off_it_flies_straight_and_level() {
    let mut aircraft = default_aircraft();
    let start = aircraft.truth();
    let hands_off = aircraft.hands_off();
    for _ in 0..4_000 {
        aircraft.step(&hands_off, 0.025);
    }
    let end = aircraft.truth();
    assert!((end.altitude_m - start.altitude_m).abs() < 0.01);
    assert!(end.roll_rad.abs() < 1e-9 && end.east_m.abs() < 1e-6);
    assert!((end.specific_force.z_mps2 + G).abs() < 0.01);
    // 100 kt indicated at 3,000 ft are 104.5 kt true, for 100 s.
    assert!((end.north_m - 104.5 * 0.514_444 * 100.0).abs() < 2.0);
}

#[test]
fn elevator_raises_the_nose() {
    let truth = after_a_second(Surfaces {
        elevator: 0.1,
        ..Surfaces::default()
    });
    assert!(truth.rates.pitch_radps > 0.05 && truth.pitch_rad > 0.05);
    assert!(truth.specific_force.z_mps2 < -1.2 * G);
}

#[test]
fn aileron_rolls_right_with_adverse_yaw() {
    let truth = after_a_second(Surfaces {
        aileron: 0.1,
        ..Surfaces::default()
    });
    assert!(truth.rates.roll_radps > 0.05 && truth.roll_rad > 0.05);
    assert!(truth.sideslip_rad > 0.0);
}

#[test]
fn rudder_yaws_right_and_slips_left() {
    let truth = after_a_second(Surfaces {
        rudder: 0.1,
        ..Surfaces::default()
    });
    assert!(
        (0.01..1.0).contains(&truth.heading_rad),
        "{}",
        truth.heading_rad
    );
    assert!(truth.sideslip_rad < -0.01);
}

#[test]
fn throttle_accelerates() {
    let truth = after_a_second(Surfaces {
        throttle: 0.1,
        ..Surfaces::default()
    });
    let trimmed = default_aircraft().truth();
    assert!(truth.indicated_airspeed_mps > trimmed.indicated_airspeed_mps);
    assert!(truth.specific_force.x_mps2 > trimmed.specific_force.x_mps2);
}

/// ψ̇ = g·tan φ/V and n = 1/cos φ: any textbook's coordinated turn.
#[test]
fn a_steady_turn_has_the_rate_of_a_coordinated_turn() {
    let mut aircraft = default_aircraft();
    let bank_rad = 30.0 * DEGREE_RAD;
    let mut pilot = Pilot::default();
    let pitch = |now: &Truth| {
        let climb_mps = 0.2 * (914.4 - now.altitude_m) + 0.5 * now.velocity.down_mps;
        now.angle_of_attack_rad + climb_mps.clamp(-5.0, 5.0) / 50.0
    };
    pilot.fly(&mut aircraft, 60.0, 0.95, bank_rad, pitch);
    let before = aircraft.truth();
    pilot.fly(&mut aircraft, 5.0, 0.95, bank_rad, pitch);
    let after = aircraft.truth();
    let turned = (after.heading_rad - before.heading_rad).rem_euclid(std::f64::consts::TAU);
    let speed = 0.5 * (before.true_airspeed_mps + after.true_airspeed_mps);
    let expected = G * after.roll_rad.tan() / speed;
    assert!(
        (after.roll_rad - bank_rad).abs() < 0.02,
        "{}",
        after.roll_rad
    );
    assert!((turned / 5.0 / expected - 1.0).abs() < 0.01, "{turned}");
    let load_factor = -after.specific_force.z_mps2 / G;
    assert!((load_factor * after.roll_rad.cos() - 1.0).abs() < 0.01);
}

/// Heading north with 15 m/s from the south-west: the wind adds to the
/// velocity over the ground and changes nothing else.
#[test]
fn the_wind_triangle_holds() {
    let calm = default_aircraft().truth();
    let mut aircraft = Aircraft::new(&SimConfig {
        wind: Wind {
            from_rad: 225.0 * DEGREE_RAD,
            speed_mps: 15.0,
        },
        ..SimConfig::default()
    })
    .unwrap();
    let hands_off = aircraft.hands_off();
    for _ in 0..400 {
        aircraft.step(&hands_off, 0.025);
    }
    let windy = aircraft.truth();
    let part = 15.0 / 2.0_f64.sqrt();
    assert!((windy.velocity.north_mps - calm.velocity.north_mps - part).abs() < 1e-3);
    assert!((windy.velocity.east_mps - part).abs() < 1e-3);
    assert!((windy.east_m - 10.0 * part).abs() < 0.01);
    assert!((windy.indicated_airspeed_mps - 51.444).abs() < 1e-3);
    assert!(windy.sideslip_rad.abs() < 1e-9);
}

/// A body without aerodynamic forces tumbles about all axes and conserves its
/// energy and its angular momentum.
#[test]
fn without_air_energy_and_angular_momentum_are_conserved() {
    let airframe = Airframe {
        wing_area_m2: 0.0,
        inertia: Inertia {
            xz: 200.0,
            ..Airframe::SKYHAWK.inertia
        },
        propulsion: Propulsion {
            rated_torque_nm: 0.0,
            polar_intercept: 0.0,
            ..Airframe::SKYHAWK.propulsion
        },
        ..Airframe::SKYHAWK
    };
    let inertia = nalgebra::Matrix3::new(
        airframe.inertia.xx,
        0.0,
        -airframe.inertia.xz,
        0.0,
        airframe.inertia.yy,
        0.0,
        -airframe.inertia.xz,
        0.0,
        airframe.inertia.zz,
    );
    let mut state = State {
        position_m: Vector3::new(0.0, 0.0, -5_000.0),
        velocity_mps: Vector3::new(40.0, 5.0, -80.0),
        attitude: UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1),
        rates_radps: Vector3::new(0.5, 1.5, 0.3),
    };
    let energy = |state: &State| {
        0.5 * airframe.mass_kg * state.velocity_mps.norm_squared()
            + 0.5 * state.rates_radps.dot(&(inertia * state.rates_radps))
            + airframe.mass_kg * G * state.altitude_m()
    };
    let momentum = |state: &State| state.attitude * (inertia * state.rates_radps);
    let start = state;
    for _ in 0..2_400 {
        state = state.after(
            1.0 / 120.0,
            &airframe,
            &Deflections::default(),
            &AirMotion::CALM,
            &Air::at(5_000.0),
            None,
        );
    }
    // Thrown up with 80 m/s: 20 s later at h + 80·20 - g·20²/2.
    let height = 5_000.0 + 80.0 * 20.0 - 0.5 * G * 400.0;
    assert!((state.altitude_m() - height).abs() < 1e-6);
    assert!((energy(&state) / energy(&start) - 1.0).abs() < 1e-9);
    let turned = (momentum(&state) - momentum(&start)).norm();
    assert!(turned / momentum(&start).norm() < 1e-6, "{turned}");
    assert!((state.attitude.into_inner().norm() - 1.0).abs() < 1e-12);
}

/// Full deflections of all controls, back and forth, for minutes: it stalls and
/// spins, and its state stays valid.
#[test]
fn full_deflections_leave_the_state_valid() {
    let mut aircraft = default_aircraft();
    for step in 0..8_000_u32 {
        let sign = |period: u32| {
            if (step / period).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            }
        };
        aircraft.step(
            &Surfaces {
                throttle: 0.5 + 0.5 * sign(300),
                elevator: sign(70),
                aileron: sign(110),
                rudder: sign(170),
                ..Surfaces::IDLE
            },
            0.025,
        );
        let truth = aircraft.truth();
        assert!(truth.true_airspeed_mps < 200.0, "{truth:?}");
        assert!((aircraft.state().attitude.into_inner().norm() - 1.0).abs() < 1e-12);
    }
    assert!(!aircraft.has_diverged());
}

/// Beyond the stall the wing has less lift, the nose drops without command, and
/// with hands off the aircraft recovers.
#[test]
fn it_recovers_from_a_stall() {
    let mut aircraft = default_aircraft();
    let pull = Surfaces {
        elevator: 0.6,
        ..Surfaces::default()
    };
    let mut highest_alpha: f64 = 0.0;
    for _ in 0..600 {
        aircraft.step(&pull, 0.025);
        highest_alpha = highest_alpha.max(aircraft.truth().angle_of_attack_rad);
    }
    assert!(highest_alpha > 18.0 * DEGREE_RAD, "{highest_alpha}");
    let hands_off = aircraft.hands_off();
    for _ in 0..4_800 {
        aircraft.step(&hands_off, 0.025);
    }
    let truth = aircraft.truth();
    assert!(truth.angle_of_attack_rad < 5.0 * DEGREE_RAD);
    assert!(
        (truth.indicated_airspeed_mps - 51.4).abs() < 10.0,
        "{truth:?}"
    );
}

/// Sub-steps of half the length make no relevant difference: the integration is
/// accurate enough.
#[test]
fn substeps_are_short_enough() {
    let fly = |substep_s: f64| {
        let mut aircraft = Aircraft::new(&SimConfig {
            substep_s,
            ..SimConfig::default()
        })
        .unwrap();
        for step in 0..400_u32 {
            let doublet = if (step / 20).is_multiple_of(2) {
                0.3
            } else {
                -0.3
            };
            aircraft.step(
                &Surfaces {
                    throttle: 0.8,
                    elevator: 0.3 * doublet,
                    aileron: doublet,
                    rudder: -doublet,
                    ..Surfaces::IDLE
                },
                0.025,
            );
        }
        aircraft.truth()
    };
    let (coarse, fine) = (fly(1.0 / 120.0), fly(1.0 / 960.0));
    assert!((coarse.roll_rad - fine.roll_rad).abs() < 0.02);
    assert!((coarse.altitude_m - fine.altitude_m).abs() < 0.3);
    assert!((coarse.heading_rad - fine.heading_rad).abs() < 0.02);
}
