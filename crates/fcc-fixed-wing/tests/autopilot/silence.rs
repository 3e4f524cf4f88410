//! A simulator that falls silent, stops, shows a replay, or is loaded anew.

use core::time::Duration;

use fcc_core::flight::{BodyRates, PlantState};
use fcc_core::framework::{Controller, Flags, Notice};
use fcc_fixed_wing::{Autopilot, AutopilotConfig, flags};
use fcc_guidance::GuidanceConfig;

use crate::cockpit::{Cockpit, DT_S, SENSORS, STANDING};

/// Engaged on a simulator, in a turn to the right and a climb.
pub(crate) fn manoeuvring() -> Cockpit {
    let mut cockpit = Cockpit::engaged_on_a_simulator(60);
    fly(&mut cockpit, 40);
    cockpit
}

/// Ticks of a turn by 5 °/s with a climb by 3 m/s; asserts that nothing is
/// wrong.
pub(crate) fn fly(cockpit: &mut Cockpit, ticks: u32) {
    for _ in 0..ticks {
        move_on(cockpit);
        cockpit.step();
        assert_eq!(cockpit.faults(), Flags::NONE);
        assert_eq!(cockpit.must_release(), Flags::NONE);
    }
}

pub(crate) fn move_on(cockpit: &mut Cockpit) {
    let rolling_degps = 20.0 - cockpit.feel.roll_deg;
    cockpit.feel.roll_deg += rolling_degps * DT_S;
    let (roll_rad, turning_radps) = (cockpit.feel.roll_deg.to_radians(), 5.0_f64.to_radians());
    cockpit.rates = BodyRates {
        roll_radps: rolling_degps.to_radians(),
        pitch_radps: turning_radps * roll_rad.sin(),
        yaw_radps: turning_radps * roll_rad.cos(),
    };
    cockpit.feel.heading_deg += 5.0 * DT_S;
    cockpit.feel.altitude_m += 3.0 * DT_S;
    cockpit.north_deg += 50.0 * DT_S / 111_120.0;
}

/// Ticks without a datagram; in a freeze the aircraft stands still, in a cut it
/// flies on.
pub(crate) fn silence(cockpit: &mut Cockpit, ticks: u32, flies_on: bool) {
    for _ in 0..ticks {
        if flies_on {
            move_on(cockpit);
        } else {
            cockpit.stood_s += DT_S;
        }
        cockpit.receive_nothing();
        cockpit.act();
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
}

pub(crate) fn noticed(cockpit: &Cockpit) -> Option<(u8, f64)> {
    let notice = cockpit.autopilot.notices().first()?;
    Some((notice.kind, notice.lasted_s()))
}

const STOOD_STILL: u8 = 1;
pub(crate) const LINK_LOST: u8 = 2;

/// To the last digit as if nothing had happened, whatever the length.
#[test]
fn a_freeze_changes_nothing() {
    for ticks in [4, 8, 12, 40, 120, 1_000] {
        let (mut frozen, mut other) = (manoeuvring(), manoeuvring());
        silence(&mut frozen, ticks, false);
        move_on(&mut frozen);
        frozen.step();
        let (kind, lasted_s) = noticed(&frozen).unwrap();
        assert_eq!(kind, STOOD_STILL);
        assert!((lasted_s - f64::from(ticks) * DT_S).abs() < 1e-3);
        fly(&mut other, 1);
        for _ in 0..200 {
            fly(&mut frozen, 1);
            fly(&mut other, 1);
            let (ours, theirs) = (frozen.autopilot.estimated(), other.autopilot.estimated());
            assert!((ours.climb_rate_mps - theirs.climb_rate_mps).abs() < 1e-6);
            assert!((ours.heading_rad - theirs.heading_rad).abs() < 1e-6);
            assert_eq!(noticed(&frozen), None);
        }
    }
}

#[test]
fn several_freezes_a_tenth_of_a_second_apart_are_flown_through() {
    let mut cockpit = manoeuvring();
    for ticks in [12, 4, 60, 5, 20, 4] {
        silence(&mut cockpit, ticks, false);
        fly(&mut cockpit, 1);
        let (kind, lasted_s) = noticed(&cockpit).unwrap();
        assert_eq!(kind, STOOD_STILL);
        assert!((lasted_s - f64::from(ticks) * DT_S).abs() < 1e-3);
        fly(&mut cockpit, 3);
    }
}

#[test]
fn after_a_cut_the_estimate_is_that_of_the_aircraft_at_once() {
    for ticks in [4, 9, 12, 40, 120] {
        let mut cockpit = manoeuvring();
        let elapsed_s = |cockpit: &Cockpit| cockpit.autopilot.setpoints().guidance.elapsed_s;
        let (before_s, bank) = (elapsed_s(&cockpit), cockpit.autopilot.setpoints().roll_rad);
        silence(&mut cockpit, ticks, true);
        assert_eq!(cockpit.autopilot.setpoints().roll_rad, bank);
        move_on(&mut cockpit);
        let mut last = bank;
        for tick in 0..80 {
            cockpit.step();
            if tick == 0 {
                let (kind, lasted_s) = noticed(&cockpit).unwrap();
                assert_eq!(kind, LINK_LOST);
                assert!((lasted_s - f64::from(ticks + 1) * DT_S).abs() < 1e-3);
            }
            assert_eq!(cockpit.faults(), Flags::NONE);
            let bank = cockpit.autopilot.setpoints().roll_rad;
            assert!((bank - last).to_degrees().abs() < 5.0, "{last} to {bank}");
            last = bank;
            move_on(&mut cockpit);
        }
        let passed_s = elapsed_s(&cockpit) - before_s;
        assert!((passed_s - f64::from(ticks + 80) * DT_S).abs() < 0.026);
        let estimated = cockpit.autopilot.estimated();
        let off_deg = estimated.heading_rad.to_degrees() - cockpit.feel.heading_deg;
        assert!(off_deg.abs() < 10.0, "{off_deg}°");
        assert!((estimated.climb_rate_mps - 3.0).abs() < 1.0);
        assert!((estimated.altitude_m - cockpit.feel.altitude_m).abs() < 1.0);
    }
}

/// What is measured returns in several datagrams, tick by tick.
#[test]
fn what_a_network_held_back_may_come_in_two_parts() {
    for (held_ticks, is_position_late) in [(200, false), (320, true), (800, false), (800, true)] {
        let mut cockpit = manoeuvring();
        // The first part of it is of the first second.
        silence(&mut cockpit, 40, true);
        silence(&mut cockpit, held_ticks, false);
        fly(&mut cockpit, 1);
        let north_deg = cockpit.north_deg;
        cockpit.stood_s -= f64::from(held_ticks) * DT_S;
        for _ in 0..held_ticks {
            move_on(&mut cockpit);
        }
        if is_position_late {
            let there = core::mem::replace(&mut cockpit.north_deg, north_deg);
            fly(&mut cockpit, 1);
            cockpit.north_deg = there;
        }
        fly(&mut cockpit, 200);
    }
}

#[test]
fn readings_that_return_one_after_the_other_are_waited_for() {
    for flies_on in [false, true] {
        let mut cockpit = manoeuvring();
        silence(&mut cockpit, 40, flies_on);
        let mut silent = SENSORS.into_iter().fold(Flags::NONE, |all, one| all | one);
        for sensor in SENSORS {
            cockpit.silent = silent;
            fly(&mut cockpit, 1);
            silent = Flags::from_bits(silent.bits() & !sensor.bits());
        }
        cockpit.silent = Flags::NONE;
        fly(&mut cockpit, 40);
    }
}

/// A sensor that is lost while all are silent is lost when the others return.
#[test]
fn a_sensor_that_does_not_return_is_lost_after_its_own_limit() {
    for (sensor, flies_on) in SENSORS
        .into_iter()
        .flat_map(|one| [(one, false), (one, true)])
    {
        let mut cockpit = manoeuvring();
        silence(&mut cockpit, 40, flies_on);
        cockpit.silent = sensor;
        // 250 ms are permitted.
        fly(&mut cockpit, 8);
        for _ in 0..4 {
            cockpit.step();
        }
        assert_eq!(cockpit.faults(), sensor);
    }
}

/// 200 ms before a freeze of a second, and as long after it as is left.
#[test]
fn a_lost_sensor_does_not_age_in_a_freeze() {
    let mut cockpit = manoeuvring();
    cockpit.silent = flags::AIRSPEED;
    fly(&mut cockpit, 8);
    silence(&mut cockpit, 40, false);
    fly(&mut cockpit, 1);
    for _ in 0..3 {
        cockpit.step();
    }
    assert_eq!(cockpit.faults(), flags::AIRSPEED);
}

#[test]
fn a_silent_simulator_is_a_fault_after_its_limit() {
    let mut cockpit = manoeuvring();
    cockpit.autopilot = Autopilot::new(AutopilotConfig {
        max_silence: Duration::from_secs(2),
        ..*cockpit.autopilot.config()
    });
    for _ in 0..80 {
        cockpit.observe();
    }
    silence(&mut cockpit, 80, false);
    cockpit.receive_nothing();
    let lost = SENSORS.into_iter().fold(Flags::NONE, |all, one| all | one);
    assert_eq!(cockpit.faults(), lost | flags::PLANT_SILENT);
    // It cannot be engaged long before.
    let mut cockpit = manoeuvring();
    silence(&mut cockpit, 11, false);
    assert!(cockpit.engage_inhibits().contains(lost));
}

/// Real sensors have no clock that could have stood still.
#[test]
fn silence_without_a_simulators_clock_is_a_loss_at_once() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    for _ in 0..11 {
        cockpit.receive_nothing();
        assert!(!cockpit.withholds());
    }
    assert!(cockpit.faults().contains(flags::ATTITUDE | flags::ALTITUDE));
}

#[test]
fn a_silent_simulator_gets_the_trims_and_then_nothing() {
    let mut cockpit = manoeuvring();
    let before = cockpit.step();
    // 250 ms as they were, 250 ms the trims.
    for tick in 1..=120 {
        cockpit.receive_nothing();
        let out = cockpit.act();
        assert_eq!(cockpit.withholds(), tick > 20, "tick {tick}");
        // Then that of the level flight in which it engaged.
        let throttle = if tick <= 10 {
            before.throttle
        } else {
            STANDING.throttle
        };
        assert!((out.throttle - throttle).abs() < 1e-6, "tick {tick}");
        if tick <= 10 {
            assert!((out.aileron - before.aileron).abs() < 1e-9);
        }
    }
    // The failsafe does not move the throttle of a simulator that is silent.
    let (tick, measured) = (cockpit.tick, cockpit.measurements);
    let throttle = cockpit.autopilot.failsafe(&tick, &measured).throttle;
    assert!((throttle - STANDING.throttle).abs() < 1e-6, "{throttle}");
}

#[test]
fn a_pause_may_be_silent_for_any_time() {
    let mut cockpit = manoeuvring();
    let time_s = cockpit.measurements.plant.value.time_s;
    for _ in 0..20 {
        cockpit.pause(time_s);
        cockpit.act();
    }
    for _ in 0..4_000 {
        cockpit.receive_nothing();
        cockpit.act();
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
    cockpit.stood_s += f64::from(4_020) * DT_S;
    fly(&mut cockpit, 40);
}

/// A map, or an alert: time stops, and `paused` does not say so.
#[test]
fn stopped_time_is_waited_out_and_the_flight_continues_where_it_was() {
    let mut cockpit = manoeuvring();
    for _ in 0..1_000 {
        cockpit.stood_s += DT_S;
        cockpit.step();
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
    assert!(cockpit.engage_inhibits().contains(flags::PLANT_STALLED));
    fly(&mut cockpit, 40);
}

#[test]
fn in_a_replay_nothing_is_accepted_and_nothing_is_sent() {
    let mut cockpit = manoeuvring();
    let before = cockpit.autopilot.estimated();
    let flown = cockpit.feel;
    cockpit.feel.plant = Some(PlantState::Replaying);
    for second in 0..400 {
        cockpit.feel.altitude_m = 500.0;
        cockpit.feel.roll_deg = -20.0;
        cockpit.north_deg += 0.001;
        // Its clock may show anything.
        cockpit.stood_s += f64::from(second % 7) - 3.0;
        cockpit.step();
        assert!(cockpit.withholds());
        assert_eq!(cockpit.faults(), Flags::NONE);
        assert_eq!(cockpit.must_release(), Flags::NONE);
    }
    assert_eq!(cockpit.engage_inhibits(), flags::PLANT_REPLAYING);
    assert_eq!(cockpit.autopilot.estimated(), before);
    cockpit.north_deg -= 0.4;
    cockpit.feel = flown;
    fly(&mut cockpit, 40);
    assert!(!cockpit.withholds());
}

#[test]
fn another_flight_is_not_flown_on() {
    // Its clock was set back, whether it says so or not; its overrides were
    // cleared.
    for (state, set_back_s, condition) in [
        (PlantState::Jumped, 0.0, flags::PLANT_JUMPED),
        (PlantState::Running, 2.0, flags::PLANT_JUMPED),
        (PlantState::Reloaded, 0.0, flags::PLANT_RELOADED),
    ] {
        let mut cockpit = manoeuvring();
        cockpit.feel.plant = Some(state);
        cockpit.stood_s += set_back_s;
        cockpit.step();
        assert_eq!(cockpit.must_release(), condition);
        assert!(cockpit.engage_inhibits().contains(condition));
        cockpit.feel.plant = Some(PlantState::Running);
        cockpit.step();
        assert_eq!(cockpit.must_release(), Flags::NONE);
        assert_eq!(cockpit.engage_inhibits(), flags::SETTLING);
    }
}

#[test]
fn notices_are_in_words() {
    struct Text(Notice);
    impl core::fmt::Display for Text {
        fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
            Autopilot::write_notice(&self.0, f)
        }
    }
    let of = |kind| {
        let lasted_ns = 1_200_000_000;
        std::format!(
            "{}",
            Text(Notice {
                kind,
                lasted_ns,
                ..Notice::default()
            })
        )
    };
    assert_eq!(of(STOOD_STILL), "the simulator stood still for 1.2 s");
    assert_eq!(
        of(LINK_LOST),
        "link lost for 1.2 s: the simulator ran on meanwhile"
    );
}
