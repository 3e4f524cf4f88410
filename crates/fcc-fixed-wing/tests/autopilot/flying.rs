//! The engaged autopilot.

use fcc_core::framework::Controller;
use fcc_fixed_wing::{AutopilotCommand, AutopilotConfig};
use fcc_guidance::GuidanceConfig;

use crate::cockpit::{Cockpit, KNOT_MPS, STANDING};

#[test]
fn engaging_in_steady_flight_moves_no_control() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    let first = cockpit.step();
    for (ours, standing) in [
        (first.throttle, STANDING.throttle),
        (first.elevator, STANDING.elevator),
        (first.aileron, STANDING.aileron),
        (first.rudder, STANDING.rudder),
    ] {
        assert!((ours - standing).abs() < 1e-6, "{ours} against {standing}");
    }
    let aims = cockpit.autopilot.setpoints();
    assert!((aims.heading_rad.to_degrees() - 30.0).abs() < 1e-6);
    assert!((aims.altitude_m - 914.4).abs() < 1e-6);
    assert!((aims.airspeed_mps / KNOT_MPS - 100.0).abs() < 1e-6);
}

#[test]
fn surfaces_follow_the_sign_conventions() {
    let mut right = Cockpit::engaged(GuidanceConfig::Hold);
    right
        .autopilot
        .command(&AutopilotCommand::Heading(120.0_f64.to_radians()));
    assert!(right.steps(8).aileron > STANDING.aileron + 0.01);

    let mut up = Cockpit::engaged(GuidanceConfig::Hold);
    up.autopilot
        .command(&AutopilotCommand::Altitude(914.4 + 50.0));
    let out = up.steps(8);
    assert!(out.elevator > STANDING.elevator + 0.001);
    assert!(out.throttle > STANDING.throttle + 0.01);

    let mut fast = Cockpit::engaged(GuidanceConfig::Hold);
    fast.autopilot
        .command(&AutopilotCommand::Airspeed(110.0 * KNOT_MPS));
    assert!(fast.steps(8).throttle > STANDING.throttle + 0.01);
}

#[test]
fn the_commanded_bank_is_limited() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit
        .autopilot
        .command(&AutopilotCommand::Heading((30.0_f64 - 120.0).to_radians()));
    cockpit.steps(40);
    let bank = cockpit.autopilot.setpoints().roll_rad.to_degrees();
    assert!((bank + 30.0).abs() < 1e-9, "{bank}");
}

/// The aircraft does not turn at all, so that commands accumulate past 180°.
#[test]
fn a_turn_that_accumulates_past_half_a_circle_is_not_reversed() {
    let mut cockpit = Cockpit::engaged(AutopilotConfig::default().guidance);
    for second in 0..120 {
        cockpit.steps(40);
        let bank = cockpit.autopilot.setpoints().roll_rad;
        if second > 21 {
            assert!(bank > 0.5, "after {second} s the bank is {bank} rad");
        }
    }
}

#[test]
fn below_the_lowest_airspeed_it_descends() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit
        .autopilot
        .command(&AutopilotCommand::Altitude(1_200.0));
    cockpit.feel.airspeed_kt = 55.0; // the floor is 33 m/s, 64 kt
    let out = cockpit.steps(400);
    assert!(out.throttle > 0.999, "{}", out.throttle);
    let aims = cockpit.autopilot.setpoints();
    // Level and unaccelerated as it is, it must lower the nose.
    assert!(aims.pitch_rad < -0.1, "{}", aims.pitch_rad);
}

/// The ceiling is 135 kt and the margin 8 kt: engaged above, it slows down to
/// where it can still descend, instead of climbing for ever.
#[test]
fn captured_targets_are_inside_the_envelope() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.feel.airspeed_kt = 150.0;
    for _ in 0..400 {
        cockpit.observe();
    }
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit.step();
    let aim_kt = cockpit.autopilot.setpoints().airspeed_mps / KNOT_MPS;
    assert!((aim_kt - 127.0).abs() < 0.01, "{aim_kt}");
}

/// From 64 to 70 kt in steps of a hundredth of a knot: around the floor, the
/// throttle never jumps.
#[test]
fn the_throttle_is_steady_around_the_floor() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.feel.airspeed_kt = 70.0;
    let mut last = cockpit.steps(400).throttle;
    for n in 0..600 {
        cockpit.feel.airspeed_kt = 70.0 - f64::from(n) * 0.01;
        let throttle = cockpit.step().throttle;
        assert!((throttle - last).abs() < 0.03, "{last} to {throttle}");
        last = throttle;
    }
    assert!(last > 0.999, "{last}");
}

/// From 0°, commanded to 90° and then to 260°: 100° to the left is shorter than
/// 260° to the right.
#[test]
fn a_turn_starts_from_the_present_heading() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.feel.heading_deg = 0.0;
    for _ in 0..400 {
        cockpit.observe();
    }
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    for heading_deg in [90.0_f64, 260.0] {
        cockpit
            .autopilot
            .command(&AutopilotCommand::Heading(heading_deg.to_radians()));
        cockpit.step();
    }
    assert!(cockpit.autopilot.setpoints().roll_rad < -0.5);
}

/// At engagement the altitude is known to about a foot; later measurements
/// refine it for some seconds. A commanded altitude is not changed.
#[test]
fn the_captured_altitude_is_refined_and_a_commanded_one_is_kept() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    let captured = cockpit.autopilot.setpoints().altitude_m;
    cockpit.feel.altitude_m += 0.3;
    for _ in 0..200 {
        cockpit.step();
    }
    let learnt = cockpit.autopilot.setpoints().altitude_m - captured;
    assert!((0.01..0.3).contains(&learnt), "{learnt}");

    cockpit
        .autopilot
        .command(&AutopilotCommand::Altitude(950.0));
    cockpit.feel.altitude_m += 0.3;
    for _ in 0..200 {
        cockpit.step();
    }
    assert_eq!(cockpit.autopilot.setpoints().altitude_m, 950.0);
}
