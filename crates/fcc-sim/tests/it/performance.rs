//! The default aircraft against the handbook of the Cessna 172P (1981) at
//! 2,400 lb and Loftin's figures (NASA SP-468, 1985).

use crate::pilot::Pilot;
use fcc_sim::atmosphere::Air;
use fcc_sim::units::{FOOT_M, KNOT_MPS};
use fcc_sim::{Aircraft, Airframe, SimConfig, TrimError, Truth, trim};

/// The highest or lowest indicated airspeed with a trim, kt, in a bracket.
fn limit_kt(altitude_ft: f64, mut can_kt: f64, mut cannot_kt: f64) -> f64 {
    let possible = |speed_kt: f64| {
        trim(
            &Airframe::SKYHAWK,
            speed_kt * KNOT_MPS,
            altitude_ft * FOOT_M,
        )
        .is_ok()
    };
    assert!(possible(can_kt) && !possible(cannot_kt));
    for _ in 0..40 {
        let middle_kt = 0.5 * (can_kt + cannot_kt);
        if possible(middle_kt) {
            can_kt = middle_kt;
        } else {
            cannot_kt = middle_kt;
        }
    }
    can_kt
}

/// Handbook, section 5: stall with flaps up, power off: 51 KCAS. Here it is
/// flown with power, which adds a little lift.
#[test]
fn it_stalls_at_the_handbooks_speed() {
    let stall_kt = limit_kt(0.0, 70.0, 30.0);
    assert!((stall_kt - 51.0).abs() < 1.5, "{stall_kt} kt");
}

/// Handbook, section 1: 123 kt at sea level.
#[test]
fn full_throttle_at_sea_level_is_as_fast_as_in_the_handbook() {
    let fastest_kt = limit_kt(0.0, 90.0, 160.0);
    assert!((fastest_kt / 123.0 - 1.0).abs() < 0.05, "{fastest_kt} kt");
}

/// Handbook, section 1: 120 kt at 8,000 ft, where full throttle gives 75 % of
/// the torque.
#[test]
fn cruise_at_8000_ft_is_as_fast_as_in_the_handbook() {
    let air = Air::at(8_000.0 * FOOT_M);
    let torque = fcc_sim::aerodynamics::torque_ratio(&Airframe::SKYHAWK.propulsion, &air);
    assert!((torque - 0.75).abs() < 0.02, "torque {torque}");
    let indicated = limit_kt(8_000.0, 80.0, 160.0) * KNOT_MPS;
    let true_kt = air.true_of_indicated_mps(indicated) / KNOT_MPS;
    assert!((110.0..=120.0).contains(&true_kt), "{true_kt} kt");
}

/// Handbook, section 5: 700 ft/min at sea level at 76 kt.
#[test]
fn it_climbs_as_in_the_handbook() {
    let mut aircraft = Aircraft::new(&SimConfig {
        airframe: Airframe::SKYHAWK,
        altitude_m: 0.0,
        ground_m: -100.0,
        indicated_airspeed_mps: 76.0 * KNOT_MPS,
        ..SimConfig::default()
    })
    .unwrap();
    // The higher the pitch, the lower the airspeed; the angle between is found
    // by iteration.
    let mut pilot = Pilot::default();
    let pitch = |now: &Truth| 0.16 + 0.02 * (now.indicated_airspeed_mps - 76.0 * KNOT_MPS);
    pilot.fly(&mut aircraft, 40.0, 1.0, 0.0, pitch);
    let before = aircraft.truth();
    pilot.fly(&mut aircraft, 15.0, 1.0, 0.0, pitch);
    let after = aircraft.truth();
    let indicated_kt = after.indicated_airspeed_mps / KNOT_MPS;
    assert!((indicated_kt - 76.0).abs() < 2.0, "{indicated_kt} kt");
    let climb_fpm = (after.altitude_m - before.altitude_m) / FOOT_M * 60.0 / 15.0;
    assert!((climb_fpm / 700.0 - 1.0).abs() < 0.15, "{climb_fpm} ft/min");
}

/// SP-468: the Skyhawk's best lift over drag is 11.6.
#[test]
fn lift_over_drag_is_the_skyhawks() {
    let airframe = Airframe::SKYHAWK;
    let best = (55..120)
        .filter_map(|kt| trim(&airframe, f64::from(kt) * KNOT_MPS, 0.0).ok())
        .map(|trim| airframe.weight_n() / trim.thrust_n)
        .fold(0.0, f64::max);
    assert!((best / 11.6 - 1.0).abs() < 0.02, "{best}");
}

/// Roskam's airplane A flies level at zero angle of attack at 220.1 ft/s and
/// 5,000 ft, with `C_L` 0.307 and `C_D` 0.032 on 174 ft² at 49.6 lb/ft².
#[test]
fn airplane_a_is_trimmed_at_its_reference() {
    let air = Air::at(5_000.0 * FOOT_M);
    let speed_mps = air.indicated_mps(220.1 * FOOT_M);
    let trim = trim(&Airframe::ROSKAM_A, speed_mps, 5_000.0 * FOOT_M).unwrap();
    assert!(trim.alpha_rad.abs() < 0.005, "{} rad", trim.alpha_rad);
    let drag_lbf = 0.032 * 49.6 * 174.0;
    let thrust_lbf = trim.thrust_n / 4.448_222;
    assert!(
        (thrust_lbf / drag_lbf - 1.0).abs() < 0.02,
        "{thrust_lbf} lbf"
    );
}

#[test]
fn an_impossible_trim_is_reported_with_its_reason() {
    let airframe = Airframe::SKYHAWK;
    let too_slow = trim(&airframe, 20.0, 0.0).unwrap_err();
    assert!(matches!(too_slow, TrimError::TooSlow { .. }));
    assert!(too_slow.to_string().contains("stalls"));
    let too_fast = trim(&airframe, 80.0, 1_000.0).unwrap_err();
    assert!(matches!(too_fast, TrimError::Throttle { throttle, .. } if throttle > 1.0));
    let no_elevator = Airframe {
        travel: fcc_sim::airframe::Travel {
            elevator_down_rad: 0.01,
            ..airframe.travel
        },
        ..airframe
    };
    let stuck = trim(&no_elevator, 50.0, 0.0).unwrap_err();
    assert!(matches!(stuck, TrimError::Elevator { .. }));
}
