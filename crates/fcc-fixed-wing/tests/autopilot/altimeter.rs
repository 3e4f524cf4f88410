//! The altimeter setting and what altitudes refer to. Numbers by the pilots'
//! table of pressure altitudes (FAA-H-8083-25C, figure 11-3): add 20 ft at 29.9
//! inHg, -257 ft at 30.2.

use fcc_core::flight::{Altimeter, AltitudeReference};
use fcc_core::framework::Controller;
use fcc_fixed_wing::{Autopilot, AutopilotCommand, AutopilotConfig, Resume, Setpoints};
use fcc_guidance::{GuidanceConfig, Mode, Progress, Targets};

use crate::cockpit::{Cockpit, KNOT_MPS, STANDING};

const FOOT_M: f64 = 0.304_8;
const INHG_PA: f64 = 3_386.389;

fn setting(inhg: f64) -> AutopilotCommand {
    AutopilotCommand::AltimeterSetting(inhg * INHG_PA)
}

/// The set points after commands to an autopilot that was engaged at 3,000 ft,
/// over a field at 700 ft if it is known.
fn after(guidance: GuidanceConfig, field: bool, commands: &[AutopilotCommand]) -> Setpoints {
    let mut cockpit = Cockpit::new(guidance);
    cockpit.autopilot = Autopilot::new(AutopilotConfig {
        altimeter: Altimeter {
            field_elevation_m: field.then_some(700.0 * FOOT_M),
            ..Altimeter::default()
        },
        ..*cockpit.autopilot.config()
    });
    (0..80).for_each(|_| cockpit.observe());
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    for command in commands {
        cockpit.step();
        cockpit.autopilot.command(command);
    }
    cockpit.step();
    cockpit.autopilot.setpoints()
}

fn is_at(flown: &Setpoints, pressure_ft: f64, reference: AltitudeReference, above_ft: f64) {
    let (altitude_ft, above) = (
        flown.altitude_m / FOOT_M,
        flown.altitude_above_reference_m / FOOT_M,
    );
    assert!((altitude_ft - pressure_ft).abs() < 1.5, "{flown:?}");
    assert_eq!(flown.altitude_reference, reference, "{flown:?}");
    assert!((above - above_ft).abs() < 1e-3, "{above} ft");
}

#[test]
fn engaging_captures_a_pressure_level_that_no_setting_moves() {
    let pattern = AutopilotConfig::default().guidance;
    for guidance in [GuidanceConfig::Hold, pattern] {
        let mode = guidance.mode();
        let flown = after(guidance, false, &[setting(30.2), setting(29.0)]);
        is_at(&flown, 3_000.0, AltitudeReference::PressureLevel, 3_000.0);
        assert_eq!(flown.guidance.mode, mode, "a pattern goes on");
        assert!((flown.altimeter_setting_pa / INHG_PA - 29.0).abs() < 1e-9);
    }
}

#[test]
fn an_altitude_is_above_sea_level_by_the_setting() {
    let altitude = AutopilotCommand::Altitude(3_500.0 * FOOT_M);
    let flown = after(GuidanceConfig::Hold, false, &[setting(30.2), altitude]);
    is_at(&flown, 3_243.0, AltitudeReference::SeaLevel, 3_500.0);
    // At the standard setting it is a pressure altitude.
    let flown = after(GuidanceConfig::Hold, false, &[altitude]);
    is_at(&flown, 3_500.0, AltitudeReference::SeaLevel, 3_500.0);
}

#[test]
fn a_held_altitude_follows_the_setting_and_a_pressure_altitude_does_not() {
    let (before, more) = (setting(29.9), setting(30.2));
    let altitude = AutopilotCommand::Altitude(3_500.0 * FOOT_M);
    let flown = after(GuidanceConfig::Hold, false, &[before, altitude, more]);
    is_at(&flown, 3_243.0, AltitudeReference::SeaLevel, 3_500.0);
    let level = AutopilotCommand::PressureAltitude(3_500.0 * FOOT_M);
    let flown = after(GuidanceConfig::Hold, false, &[before, level, more]);
    is_at(&flown, 3_500.0, AltitudeReference::PressureLevel, 3_500.0);
    // Another set point does not change what the altitude refers to.
    let heading = AutopilotCommand::Heading(1.0);
    let flown = after(GuidanceConfig::Hold, false, &[altitude, heading, more]);
    is_at(&flown, 3_243.0, AltitudeReference::SeaLevel, 3_500.0);
}

#[test]
fn a_height_is_above_the_known_field_or_ignored() {
    let commands = [setting(30.2), AutopilotCommand::Height(3_000.0 * FOOT_M)];
    let flown = after(GuidanceConfig::Hold, true, &commands);
    is_at(&flown, 3_443.0, AltitudeReference::Field, 3_000.0);
    let flown = after(GuidanceConfig::Hold, false, &commands);
    is_at(&flown, 3_000.0, AltitudeReference::PressureLevel, 3_000.0);
}

#[test]
fn an_impossible_setting_is_ignored() {
    for inhg in [27.7, 31.4, -1.0, f64::NAN, f64::INFINITY] {
        let flown = after(GuidanceConfig::Hold, false, &[setting(inhg)]);
        assert_eq!(flown.altimeter_setting_pa, 101_325.0);
    }
}

#[test]
fn the_setting_is_kept_while_not_engaged() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.autopilot.command(&setting(30.2));
    let before = cockpit.autopilot.setpoints();
    assert!((before.altimeter_setting_pa / INHG_PA - 30.2).abs() < 1e-9);
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit
        .autopilot
        .command(&AutopilotCommand::Altitude(3_500.0 * FOOT_M));
    cockpit.step();
    let flown = cockpit.autopilot.setpoints();
    is_at(&flown, 3_243.0, AltitudeReference::SeaLevel, 3_500.0);
    cockpit.autopilot.disengage();
    let after = cockpit.autopilot.setpoints();
    assert_eq!(after.altimeter_setting_pa, before.altimeter_setting_pa);
    assert_eq!(after.altitude_reference, AltitudeReference::PressureLevel);
}

/// Interrupted at 3,500 ft by 30.2 inHg, and started again with a configuration
/// that has the standard setting.
#[test]
fn a_resumed_flight_has_its_setting_and_reference() {
    let resume = |reference| {
        AutopilotCommand::Resume(Resume {
            progress: Progress {
                mode: Mode::Hold,
                captured: Targets {
                    airspeed_mps: 100.0 * KNOT_MPS,
                    heading_rad: 0.5,
                    altitude_m: 3_243.0 * FOOT_M,
                },
                ..Progress::default()
            },
            surfaces: STANDING,
            altimeter_setting_pa: Some(30.2 * INHG_PA),
            altitude_reference: reference,
            ..Resume::default()
        })
    };
    let commands = [resume(AltitudeReference::SeaLevel), setting(29.9)];
    let flown = after(GuidanceConfig::Hold, false, &commands);
    assert!((flown.altitude_m / FOOT_M - 3_520.0).abs() < 1.5);
    assert!((flown.altitude_above_reference_m / FOOT_M - 3_500.0).abs() < 1.5);
    // The field is not known any more: the pressure level is kept.
    let commands = [resume(AltitudeReference::Field), setting(29.9)];
    let flown = after(GuidanceConfig::Hold, false, &commands);
    is_at(&flown, 3_243.0, AltitudeReference::PressureLevel, 3_243.0);
}
