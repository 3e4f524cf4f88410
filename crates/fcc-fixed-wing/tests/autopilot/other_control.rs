//! What acts on the aircraft besides this autopilot, and suspect readings.

use fcc_core::flight::{OtherControl, PlantState, Suspect};
use fcc_core::framework::{Controller, Flags};
use fcc_fixed_wing::{Autopilot, AutopilotConfig, flags};
use fcc_guidance::GuidanceConfig;

use crate::cockpit::Cockpit;

const NOBODY: OtherControl = OtherControl {
    autopilot: false,
    autothrottle: false,
    fly_by_wire: false,
    stability: false,
    writer: false,
    reverse_thrust: false,
};

/// Each of them, its condition, and whether it prevents engaging and can be
/// flown.
const CASES: [(OtherControl, Flags, bool, bool); 6] = [
    (
        OtherControl {
            autopilot: true,
            ..NOBODY
        },
        flags::OTHER_AUTOPILOT,
        true,
        true,
    ),
    (
        OtherControl {
            autothrottle: true,
            ..NOBODY
        },
        flags::OTHER_AUTOTHROTTLE,
        true,
        true,
    ),
    (
        OtherControl {
            fly_by_wire: true,
            ..NOBODY
        },
        flags::FLY_BY_WIRE,
        true,
        true,
    ),
    (
        OtherControl {
            stability: true,
            ..NOBODY
        },
        flags::STABILITY,
        false,
        true,
    ),
    (
        OtherControl {
            writer: true,
            ..NOBODY
        },
        flags::OTHER_WRITER,
        true,
        true,
    ),
    (
        OtherControl {
            reverse_thrust: true,
            ..NOBODY
        },
        flags::REVERSE_THRUST,
        true,
        false,
    ),
];

#[test]
fn whoever_else_flies_prevents_engaging_by_name_and_is_reported_in_flight() {
    for (other, condition, inhibits, can_be_flown) in CASES {
        let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
        cockpit.step();
        assert_eq!(cockpit.conditions(), Flags::NONE);
        cockpit.other_control = other;
        cockpit.step();
        let only_if = |holds| Flags::NONE.with(condition, holds);
        assert_eq!(cockpit.conditions(), condition);
        assert_eq!(cockpit.engage_inhibits(), only_if(inhibits), "{other:?}");
        assert_eq!(cockpit.faults(), only_if(!can_be_flown), "{other:?}");
    }
}

#[test]
fn what_is_permitted_prevents_nothing_and_is_still_reported() {
    let permitted = flags::OTHER_AUTOPILOT | flags::OTHER_AUTOTHROTTLE | flags::FLY_BY_WIRE;
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.autopilot = Autopilot::new(AutopilotConfig {
        permitted,
        ..*cockpit.autopilot.config()
    });
    cockpit.other_control = OtherControl {
        autopilot: true,
        autothrottle: true,
        fly_by_wire: true,
        writer: true,
        ..NOBODY
    };
    for _ in 0..80 {
        cockpit.observe();
    }
    assert_eq!(cockpit.engage_inhibits(), flags::OTHER_WRITER);
    assert_eq!(cockpit.conditions(), permitted | flags::OTHER_WRITER);
}

#[test]
fn thrust_that_is_reversed_in_flight_is_idled() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    let failsafe = |cockpit: &mut Cockpit| {
        cockpit.step();
        let (tick, measured) = (cockpit.tick, cockpit.measurements);
        cockpit.autopilot.failsafe(&tick, &measured).throttle
    };
    assert!(failsafe(&mut cockpit) > 0.3);
    cockpit.other_control.reverse_thrust = true;
    assert_eq!(failsafe(&mut cockpit), 0.0);
}

/// A pitot tube that ices up: the airspeed falls, and is no longer used once its
/// source contradicts it.
#[test]
fn a_suspect_airspeed_is_a_fault_and_is_not_used() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.steps(40);
    let before = cockpit.autopilot.estimated().airspeed_mps;
    cockpit.suspect = Suspect {
        airspeed: true,
        ..Suspect::default()
    };
    cockpit.feel.airspeed_kt = 95.0;
    cockpit.step();
    assert_eq!(cockpit.faults(), flags::SUSPECT_AIRSPEED);
    assert_eq!(cockpit.engage_inhibits(), flags::SUSPECT_AIRSPEED);
    cockpit.steps(11);
    assert!(
        cockpit
            .faults()
            .contains(flags::AIRSPEED | flags::SUSPECT_AIRSPEED)
    );
    let after = cockpit.autopilot.estimated().airspeed_mps;
    assert!((after - before).abs() < 0.5, "{before} m/s, then {after}");
    cockpit.suspect = Suspect::default();
    cockpit.steps(80);
    assert_eq!(cockpit.faults(), Flags::NONE);
}

#[test]
fn time_that_runs_more_than_twice_as_fast_prevents_engaging_only() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.feel.plant = Some(PlantState::Fast);
    cockpit.observe();
    assert_eq!(cockpit.engage_inhibits(), flags::PLANT_FAST);
    assert_eq!(cockpit.conditions(), flags::PLANT_FAST);
    assert_eq!(cockpit.faults(), Flags::NONE);
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.observe();
    assert_eq!(cockpit.engage_inhibits(), Flags::NONE);
}
