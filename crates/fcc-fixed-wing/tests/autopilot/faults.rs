//! The autopilot's faults and its failsafe.

use core::time::Duration;

use fcc_core::flight::{PlantState, Surfaces};
use fcc_core::framework::{Controller, Flags, Switch};
use fcc_fixed_wing::{Autopilot, AutopilotConfig, flags};
use fcc_guidance::GuidanceConfig;

use crate::cockpit::{Cockpit, DT_S, Feel, LEVEL, SENSORS, STANDING};

#[test]
fn each_silent_sensor_is_its_own_fault_once_it_is_too_old() {
    for sensor in SENSORS {
        let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
        cockpit.step();
        cockpit.silent = sensor;
        // 250 ms are permitted.
        for _ in 0..10 {
            cockpit.step();
            assert_eq!(cockpit.faults(), Flags::NONE);
        }
        cockpit.step();
        assert_eq!(cockpit.faults(), sensor);
    }
}

#[test]
fn a_switch_that_falls_silent_is_a_fault() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.switch = Some(Switch::On);
    cockpit.step();
    cockpit.switch = None;
    // 1 s is permitted.
    cockpit.steps(40);
    assert_eq!(cockpit.faults(), Flags::NONE);
    cockpit.step();
    assert_eq!(cockpit.faults(), flags::ENGAGE_SWITCH);
}

/// The simulator's clock is lost while everything else continues: the loops
/// must not freeze with the last command held, once the aircraft moves.
#[test]
fn a_stopped_clock_of_an_aircraft_that_moves_is_a_fault_and_not_a_pause() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.observe();
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit.step();
    cockpit.silent = flags::PLANT_STALLED;
    for _ in 0..400 {
        cockpit.step();
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
    // The controls move again: 20° of bank are levelled.
    for _ in 0..4 {
        cockpit.feel.roll_deg += 5.0;
        cockpit.step();
        assert_eq!(cockpit.faults(), flags::PLANT_STALLED);
    }
    let first = cockpit.steps(1);
    let later = cockpit.steps(20);
    assert!(later.aileron < first.aileron - 0.05);
    assert_eq!(cockpit.faults(), flags::PLANT_STALLED);
}

#[test]
fn implausible_values_count_as_silence_and_never_reach_a_surface() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30] {
        let mut cockpit = Cockpit::engaged(AutopilotConfig::default().guidance);
        cockpit.step();
        cockpit.feel = Feel {
            pitch_deg: bad,
            roll_deg: bad,
            heading_deg: bad,
            airspeed_kt: bad,
            altitude_m: bad,
            plant: None,
        };
        for _ in 0..20 {
            let out = cockpit.step();
            assert!(cockpit.autopilot.outputs_are_valid(&out), "{out:?}");
        }
        assert!(
            cockpit
                .faults()
                .contains(flags::ATTITUDE | flags::HEADING | flags::AIRSPEED | flags::ALTITUDE)
        );
    }
}

/// Paused during a manoeuvre: the climb rate is not settled, and altitude and
/// bank differ from their set points.
#[test]
fn a_paused_simulator_changes_nothing() {
    let mut cockpit = Cockpit::engaged_on_a_simulator(1);
    cockpit.feel.altitude_m += 14.0;
    cockpit.feel.roll_deg = 5.0;
    let before = cockpit.steps(20);
    let estimated = cockpit.autopilot.estimated();
    assert!(estimated.climb_rate_mps.abs() > 0.5);

    // The plant's clock does not advance after the last running tick.
    let time_s = cockpit.measurements.plant.value.time_s;
    cockpit.feel.plant = Some(PlantState::Paused);
    for _ in 0..400 {
        cockpit.pause(time_s);
        let held = cockpit.act();
        for (held, before) in [
            (held.throttle, before.throttle),
            (held.elevator, before.elevator),
            (held.aileron, before.aileron),
            (held.rudder, before.rudder),
        ] {
            assert!((held - before).abs() < 1e-12);
        }
    }
    assert_eq!(cockpit.autopilot.estimated(), estimated);
    assert_eq!(cockpit.engage_inhibits(), flags::PLANT_PAUSED);
    assert_eq!(cockpit.faults(), Flags::NONE);
}

#[test]
fn a_jump_of_the_simulator_is_a_fault() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.feel.plant = Some(PlantState::Jumped);
    cockpit.step();
    assert!(cockpit.faults().contains(flags::PLANT_JUMPED));
    assert_eq!(cockpit.must_release(), flags::PLANT_JUMPED);
}

/// 300 m in a tick: rejected at first, and a loss of the sensor when the last
/// good altitude is too old.
#[test]
fn a_jump_of_a_sensor_is_its_loss() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    cockpit.feel.altitude_m += 300.0;
    for _ in 0..10 {
        cockpit.step();
        assert_eq!(cockpit.faults(), Flags::NONE);
        let altitude_m = cockpit.autopilot.estimated().altitude_m;
        assert!((altitude_m - LEVEL.altitude_m).abs() < 1.0, "{altitude_m}");
    }
    cockpit.step();
    assert_eq!(cockpit.faults(), flags::ALTITUDE | flags::REJECTED);
}

#[test]
fn failsafe_levels_the_wings_while_the_attitude_is_known() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    for _ in 0..40 {
        cockpit.feel.roll_deg += 0.5;
        cockpit.observe();
    }
    let out = (0..8).fold(Surfaces::default(), |_, _| {
        cockpit.observe();
        cockpit.failsafe()
    });
    assert!(out.aileron < STANDING.aileron - 0.05, "{}", out.aileron);
    // The airspeed is held, too: not a throttle for some other airspeed.
    assert!((out.throttle - STANDING.throttle).abs() < 0.05);
}

/// A step that lasts as long as the failsafe: flown by its value, the aircraft
/// would bank as far as the reading is wrong.
#[test]
fn failsafe_does_not_believe_what_was_rejected() {
    for (name, wrong) in [
        (
            "bank",
            Feel {
                roll_deg: 50.0,
                ..LEVEL
            },
        ),
        (
            "airspeed",
            Feel {
                airspeed_kt: 150.0,
                ..LEVEL
            },
        ),
        (
            "altitude",
            Feel {
                altitude_m: 1_200.0,
                ..LEVEL
            },
        ),
    ] {
        let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
        let before = cockpit.step();
        cockpit.feel = wrong;
        cockpit.steps(11);
        let cause = cockpit.faults();
        assert!(cause.contains(flags::REJECTED), "{name}: {cause:?}");
        for _ in 0..200 {
            cockpit.observe();
            let out = cockpit.failsafe();
            assert!(
                (out.aileron - before.aileron).abs() < 0.01,
                "{name}: {out:?}"
            );
            assert!(
                (out.elevator - before.elevator).abs() < 0.01,
                "{name}: {out:?}"
            );
            assert!(cockpit.faults().contains(cause), "{name}");
        }
        // It ends: the reading may have been right, and the old value wrong.
        cockpit.autopilot.disengage();
        cockpit.observe();
        assert_eq!(cockpit.engage_inhibits(), flags::SETTLING, "{name}");
        for _ in 0..40 {
            cockpit.observe();
        }
        assert_eq!(cockpit.engage_inhibits(), Flags::NONE, "{name}");
    }
}

#[test]
fn failsafe_uses_a_rejected_reading_again_when_it_returns_to_where_it_was() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    cockpit.feel.roll_deg = 50.0;
    cockpit.steps(11);
    for _ in 0..80 {
        cockpit.observe();
        cockpit.failsafe();
    }
    cockpit.feel.roll_deg = 10.0;
    let out = (0..8).fold(Surfaces::default(), |_, _| {
        cockpit.observe();
        cockpit.failsafe()
    });
    assert!(out.aileron < STANDING.aileron - 0.05, "{}", out.aileron);
}

/// The gyroscopes freeze in a roll; the loops integrate the difference for as
/// long as it takes to notice. The wings are levelled by the derivative of the
/// attitude.
#[test]
fn failsafe_with_frozen_rates_begins_with_the_trim_from_before() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    let config = AutopilotConfig {
        frozen_after: Duration::from_secs(2),
        ..*cockpit.autopilot.config()
    };
    cockpit.autopilot = Autopilot::new(config);
    for _ in 0..80 {
        cockpit.rates.roll_radps = 1e-4 * f64::from(cockpit.tick.number as u32 % 2);
        cockpit.observe();
    }
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit.rates.roll_radps = 0.05;
    // The bank changes by 8°, and the rates say 0.05 rad/s all the time.
    let mut last = Surfaces::default();
    for n in 0..200 {
        cockpit.feel.roll_deg = (8.0 * f64::from(n) / 40.0).min(8.0) * f64::from(n % 2 + 9) / 10.0;
        last = cockpit.step();
        if cockpit.faults().contains(flags::FROZEN_BODY_RATES) {
            break;
        }
    }
    assert!(cockpit.faults().contains(flags::FROZEN_BODY_RATES));
    assert!((last.aileron - STANDING.aileron).abs() > 0.05, "{last:?}");
    let out = cockpit.failsafe();
    let to_the_left = STANDING.aileron - out.aileron;
    assert!((0.0..0.05).contains(&to_the_left), "{out:?}");
    assert!((out.elevator - STANDING.elevator).abs() < 0.05, "{out:?}");
    cockpit.feel.roll_deg = 0.0;
    for _ in 0..120 {
        cockpit.observe();
        last = cockpit.failsafe();
    }
    assert!((last.aileron - STANDING.aileron).abs() < 0.03, "{last:?}");
}

#[test]
fn failsafe_without_attitude_keeps_the_trim() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    cockpit.silent = SENSORS.into_iter().fold(Flags::NONE, |all, one| all | one);
    let out = (0..40).fold(Surfaces::default(), |_, _| {
        cockpit.observe();
        cockpit.failsafe()
    });
    assert!((out.elevator - STANDING.elevator).abs() < 0.01, "{out:?}");
    assert!((out.aileron - STANDING.aileron).abs() < 0.01, "{out:?}");
    assert!((out.rudder - STANDING.rudder).abs() < 0.01, "{out:?}");
}

#[test]
fn engage_inhibits_are_named() {
    let mut slow = Cockpit::new(GuidanceConfig::Hold);
    slow.feel.airspeed_kt = 40.0;
    for _ in 0..400 {
        slow.observe();
    }
    assert_eq!(slow.engage_inhibits(), flags::TOO_SLOW);

    let mut upset = Cockpit::new(GuidanceConfig::Hold);
    upset.feel.roll_deg = 75.0;
    for _ in 0..400 {
        upset.observe();
    }
    assert_eq!(upset.engage_inhibits(), flags::UPSET);
    assert_eq!(
        Autopilot::flag_name(9),
        "bank or pitch is beyond 60 degrees, or it spins"
    );
}

#[test]
fn it_engages_only_after_a_second_of_settling() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.autopilot = Autopilot::new(*cockpit.autopilot.config());
    for _ in 0..40 {
        cockpit.observe();
        assert_eq!(cockpit.engage_inhibits(), flags::SETTLING);
    }
    cockpit.observe();
    assert_eq!(cockpit.engage_inhibits(), Flags::NONE);
}

/// Engaged with the nose 12° up; the failsafe does not keep that pitch.
#[test]
fn failsafe_flies_level_whatever_the_pitch_was() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.feel.pitch_deg = 12.0;
    for _ in 0..400 {
        cockpit.observe();
    }
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit.step();
    // The altimeter shows a climb of 5 m/s.
    for _ in 0..400 {
        cockpit.feel.altitude_m += 5.0 * DT_S;
        cockpit.observe();
        cockpit.failsafe();
    }
    let aims = cockpit.autopilot.setpoints();
    assert_eq!(aims.climb_rate_mps, 0.0);
    assert!(aims.pitch_rad.to_degrees() < 5.0, "{}", aims.pitch_rad);
}

/// A failsafe because of overruns does not end this way, however good all is.
#[test]
fn that_all_is_good_again_is_said_once_when_the_loop_continues() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.steps(40);
    let mut said = Vec::new();
    // 2 s without a fault are enough; the loop does not continue for 4 s.
    for _ in 0..160 {
        cockpit.observe();
        cockpit.failsafe();
        said.extend(cockpit.autopilot.notices().iter().copied());
    }
    assert_eq!(said, []);
    assert!(cockpit.autopilot.has_recovered());
    let (tick, measurements) = (cockpit.tick, cockpit.measurements);
    cockpit.autopilot.recover(&tick, &measurements);
    for _ in 0..40 {
        cockpit.step();
        said.extend(cockpit.autopilot.notices().iter().copied());
    }
    let [notice] = said[..] else {
        panic!("{said:?}");
    };
    let after_s = notice.lasted_ns as f64 * 1e-9;
    assert!((after_s - 160.0 * DT_S).abs() < 2.0 * DT_S, "{after_s}");
}
