//! Readings from the future, and what must settle after an outage.

use core::time::Duration;

use fcc_core::flight::PlantState;
use fcc_core::framework::{Controller, Flags};
use fcc_fixed_wing::flags;
use fcc_guidance::GuidanceConfig;

use crate::cockpit::{Cockpit, SENSORS};

const AHEAD: Duration = Duration::from_secs(3_600);

/// A tick in which the airspeed's clock is an hour ahead.
fn airspeed_is_ahead(cockpit: &mut Cockpit) {
    cockpit.silent = flags::AIRSPEED;
    cockpit.observe();
    cockpit.silent = Flags::NONE;
    let mut measured = cockpit.measurements;
    measured.airspeed_mps.taken = cockpit.tick.woke + AHEAD;
    cockpit.measurements.airspeed_mps.taken = measured.airspeed_mps.taken;
    cockpit.autopilot.estimate(&cockpit.tick, &measured);
}

#[test]
fn one_reading_from_the_future_is_reported_and_flown_through() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.steps(10);
    airspeed_is_ahead(&mut cockpit);
    assert_eq!(cockpit.conditions(), flags::FROM_THE_FUTURE);
    assert_eq!(cockpit.faults(), Flags::NONE);
    for _ in 0..400 {
        cockpit.step();
        assert_eq!(cockpit.conditions(), Flags::NONE);
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
}

/// 250 ms are 10 ticks.
#[test]
fn a_clock_that_is_ahead_is_a_fault_with_its_name() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.steps(10);
    for _ in 0..12 {
        airspeed_is_ahead(&mut cockpit);
    }
    let faults = cockpit.faults();
    assert!(faults.contains(flags::AIRSPEED | flags::FROM_THE_FUTURE));
    assert!(!faults.intersects(flags::ATTITUDE | flags::PLANT_SILENT));
    assert!(cockpit.engage_inhibits().contains(flags::FROM_THE_FUTURE));
    cockpit.steps(1);
    assert_eq!(cockpit.faults(), Flags::NONE, "it is read again");
}

/// The simulator's silence is judged by its newest reading.
#[test]
fn a_reading_from_the_future_is_no_silence_of_the_simulator() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.steps(40);
    airspeed_is_ahead(&mut cockpit);
    for _ in 0..1_400 {
        cockpit.step();
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
}

/// A second is 40 ticks.
#[test]
fn after_an_outage_it_settles_before_it_engages() {
    for lost in SENSORS {
        let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
        cockpit.silent = lost;
        cockpit.steps(20);
        assert!(cockpit.engage_inhibits().contains(lost));
        cockpit.silent = Flags::NONE;
        cockpit.steps(1);
        assert_eq!(cockpit.engage_inhibits(), flags::SETTLING);
        cockpit.steps(38);
        assert_eq!(cockpit.engage_inhibits(), flags::SETTLING);
        cockpit.steps(2);
        assert_eq!(cockpit.engage_inhibits(), Flags::NONE);
    }
}
