//! The autopilot seen from outside: scripted measurements in, surfaces out.
#![cfg(feature = "flight")]

use core::time::Duration;

use fcc_core::flight::{
    Attitude, Autopilot, AutopilotConfig, BodyRates, Course, Measurements, Order, Plant,
    PlantState, Resume, SpecificForce, Surfaces, flags, guidance::Targets,
};
use fcc_core::framework::{Controller, Flags, Reading, Switch, Tick, Time};

/// Every sensor that control needs, by its fault.
const SENSORS: [Flags; 6] = [
    flags::ATTITUDE,
    flags::HEADING,
    flags::BODY_RATES,
    flags::SPECIFIC_FORCE,
    flags::AIRSPEED,
    flags::ALTITUDE,
];

const DT_S: f64 = 0.025;
const KNOT_MPS: f64 = 1_852.0 / 3_600.0;

/// An autopilot and the aircraft that it believes to be in.
struct Cockpit {
    autopilot: Autopilot,
    tick: Tick,
    /// What the sensors say; stamped at each tick.
    feel: Feel,
    measurements: Measurements,
    silent: Flags,
    switch: Option<Switch>,
}

#[derive(Clone, Copy)]
struct Feel {
    pitch_deg: f64,
    roll_deg: f64,
    heading_deg: f64,
    airspeed_kt: f64,
    altitude_m: f64,
    plant: Option<PlantState>,
}

const LEVEL: Feel = Feel {
    pitch_deg: 0.0,
    roll_deg: 0.0,
    heading_deg: 30.0,
    airspeed_kt: 100.0,
    altitude_m: 914.4,
    plant: None,
};

const STANDING: Surfaces = Surfaces {
    throttle: 0.62,
    elevator: 0.05,
    aileron: -0.02,
    rudder: 0.01,
};

impl Cockpit {
    fn new(course: Course) -> Self {
        let config = AutopilotConfig {
            course,
            // What it feels here is the same to the last bit until it is told
            // otherwise.
            frozen_after: Duration::ZERO,
            ..AutopilotConfig::default()
        };
        let mut cockpit = Self {
            autopilot: Autopilot::new(config),
            tick: Tick {
                dt_s: DT_S,
                scheduled: Time::from_nanos(0),
                woke: Time::from_nanos(0),
                ..Tick::default()
            },
            feel: LEVEL,
            measurements: Measurements::default(),
            silent: Flags::NONE,
            switch: None,
        };
        for _ in 0..80 {
            cockpit.observe();
        }
        cockpit
    }

    fn engaged(course: Course) -> Self {
        let mut cockpit = Self::new(course);
        assert_eq!(cockpit.blockers(), Flags::NONE);
        cockpit
            .autopilot
            .engage(&cockpit.tick, &cockpit.measurements);
        cockpit
    }

    fn observe(&mut self) {
        self.tick.number += 1;
        self.tick.woke = self.tick.woke + Duration::from_millis(25);
        self.tick.scheduled = self.tick.woke;
        let (feel, now) = (self.feel, self.tick.woke);
        let before = self.measurements;
        self.measurements = Measurements {
            attitude: Reading::new(
                Attitude {
                    pitch_rad: feel.pitch_deg.to_radians(),
                    roll_rad: feel.roll_deg.to_radians(),
                },
                now,
            ),
            heading_rad: Reading::new(feel.heading_deg.to_radians(), now),
            body_rates: Reading::new(BodyRates::default(), now),
            specific_force: Reading::new(
                SpecificForce {
                    z_mps2: -9.806_65,
                    ..SpecificForce::default()
                },
                now,
            ),
            airspeed_mps: Reading::new(feel.airspeed_kt * KNOT_MPS, now),
            altitude_m: Reading::new(feel.altitude_m, now),
            surfaces: Reading::new(STANDING, now),
            plant: feel.plant.map_or_else(Reading::default, |state| {
                Reading::new(
                    Plant {
                        time_s: now.as_nanos() as f64 * 1e-9,
                        state,
                    },
                    now,
                )
            }),
            engage_switch: self
                .switch
                .map_or(before.engage_switch, |switch| Reading::new(switch, now)),
            ..Measurements::default()
        };
        let (silent, now) = (self.silent, &mut self.measurements);
        if silent.contains(flags::ATTITUDE) {
            now.attitude = before.attitude;
        }
        if silent.contains(flags::HEADING) {
            now.heading_rad = before.heading_rad;
        }
        if silent.contains(flags::BODY_RATES) {
            now.body_rates = before.body_rates;
        }
        if silent.contains(flags::SPECIFIC_FORCE) {
            now.specific_force = before.specific_force;
        }
        if silent.contains(flags::AIRSPEED) {
            now.airspeed_mps = before.airspeed_mps;
        }
        if silent.contains(flags::ALTITUDE) {
            now.altitude_m = before.altitude_m;
        }
        if silent.contains(flags::PLANT_STALLED) {
            now.plant.value.time_s = before.plant.value.time_s;
            now.plant.value.state = PlantState::Stalled;
        }
        self.autopilot.estimate(&self.tick, &self.measurements);
    }

    /// A tick on which everything speaks, but the plant's clock stands still.
    fn pause(&mut self, time_s: f64) {
        self.tick.number += 1;
        self.tick.woke = self.tick.woke + Duration::from_millis(25);
        self.tick.scheduled = self.tick.woke;
        let now = self.tick.woke;
        let measured = &mut self.measurements;
        measured.attitude.taken = now;
        measured.heading_rad.taken = now;
        measured.body_rates.taken = now;
        measured.specific_force.taken = now;
        measured.airspeed_mps.taken = now;
        measured.altitude_m.taken = now;
        let paused = Plant {
            time_s,
            state: PlantState::Paused,
        };
        measured.plant = Reading::new(paused, now);
        self.autopilot.estimate(&self.tick, &self.measurements);
    }

    fn step(&mut self) -> Surfaces {
        self.observe();
        self.act()
    }

    fn act(&mut self) -> Surfaces {
        self.autopilot.guide(&self.tick, &self.measurements);
        self.autopilot.control(&self.tick, &self.measurements)
    }

    fn steps(&mut self, count: u32) -> Surfaces {
        (0..count).fold(Surfaces::default(), |_, _| self.step())
    }

    fn blockers(&self) -> Flags {
        self.autopilot.blockers(&self.tick, &self.measurements)
    }

    fn faults(&self) -> Flags {
        self.autopilot.faults(&self.tick, &self.measurements)
    }
}

#[test]
fn taking_over_in_steady_flight_moves_nothing() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
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
fn surfaces_act_in_the_directions_of_the_house() {
    let mut right = Cockpit::engaged(Course::Hold);
    right
        .autopilot
        .command(&Order::Heading(120.0_f64.to_radians()));
    assert!(right.steps(8).aileron > STANDING.aileron + 0.01);

    let mut up = Cockpit::engaged(Course::Hold);
    up.autopilot.command(&Order::Altitude(914.4 + 50.0));
    let out = up.steps(8);
    assert!(out.elevator > STANDING.elevator + 0.001);
    assert!(out.throttle > STANDING.throttle + 0.01);

    let mut fast = Cockpit::engaged(Course::Hold);
    fast.autopilot.command(&Order::Airspeed(110.0 * KNOT_MPS));
    assert!(fast.steps(8).throttle > STANDING.throttle + 0.01);
}

#[test]
fn the_bank_asked_for_ends_at_the_limit() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit
        .autopilot
        .command(&Order::Heading((30.0_f64 - 120.0).to_radians()));
    cockpit.steps(40);
    let bank = cockpit.autopilot.setpoints().roll_rad.to_degrees();
    assert!((bank + 30.0).abs() < 1e-9, "{bank}");
}

/// The aircraft does not turn at all, so that commands pile up past 180°.
#[test]
fn a_turn_that_piles_up_past_half_a_circle_is_not_reversed() {
    let mut cockpit = Cockpit::engaged(AutopilotConfig::default().course);
    for second in 0..120 {
        cockpit.steps(40);
        let bank = cockpit.autopilot.setpoints().roll_rad;
        if second > 21 {
            assert!(bank > 0.5, "after {second} s the bank is {bank} rad");
        }
    }
}

#[test]
fn too_slow_trades_altitude_for_speed() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.autopilot.command(&Order::Altitude(1_200.0));
    cockpit.feel.airspeed_kt = 55.0; // the floor is 33 m/s, 64 kt
    let out = cockpit.steps(400);
    assert!(out.throttle > 0.999, "{}", out.throttle);
    let aims = cockpit.autopilot.setpoints();
    assert!(aims.climb_rate_mps < -1.0, "{}", aims.climb_rate_mps);
}

#[test]
fn each_silent_sensor_is_its_own_fault_once_it_is_too_old() {
    for sensor in SENSORS {
        let mut cockpit = Cockpit::engaged(Course::Hold);
        cockpit.step();
        cockpit.silent = sensor;
        // 250 ms are allowed.
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
    let mut cockpit = Cockpit::new(Course::Hold);
    cockpit.switch = Some(Switch::On);
    cockpit.step();
    cockpit.switch = None;
    // 1 s is allowed.
    cockpit.steps(40);
    assert_eq!(cockpit.faults(), Flags::NONE);
    cockpit.step();
    assert_eq!(cockpit.faults(), flags::ENGAGE_SWITCH);
}

/// The simulator's clock is lost while everything else goes on: the loops must
/// not freeze with the last command standing.
#[test]
fn a_clock_that_stands_still_is_a_fault_and_not_a_pause() {
    let mut cockpit = Cockpit::new(Course::Hold);
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.observe();
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit.step();
    cockpit.silent = flags::PLANT_STALLED;
    for _ in 0..10 {
        cockpit.step();
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
    cockpit.steps(2);
    assert_eq!(cockpit.faults(), flags::PLANT_STALLED);
    // And the controls move again: 20° of bank is flown off.
    cockpit.feel.roll_deg = 20.0;
    let first = cockpit.steps(1);
    let later = cockpit.steps(20);
    assert!(later.aileron < first.aileron - 0.05);
}

#[test]
fn nonsense_counts_as_silence_and_never_reaches_a_surface() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30] {
        let mut cockpit = Cockpit::engaged(AutopilotConfig::default().course);
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

/// Paused in the middle of things: the climb rate is not settled, the
/// altitude is off, the bank is not where it is asked to be.
#[test]
fn a_paused_simulator_leaves_everything_as_it_is() {
    let mut cockpit = Cockpit::new(Course::Hold);
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.observe();
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit
        .autopilot
        .command(&Order::Heading(100.0_f64.to_radians()));
    cockpit.feel.altitude_m += 14.0;
    cockpit.feel.roll_deg = 5.0;
    let before = cockpit.steps(20);
    let estimated = *cockpit.autopilot.estimated();
    assert!(estimated.climb_rate_mps.abs() > 0.5);

    // The plant's clock stands still from the last running tick on.
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
    assert_eq!(*cockpit.autopilot.estimated(), estimated);
    assert_eq!(cockpit.blockers(), flags::PLANT_PAUSED);
    assert_eq!(cockpit.faults(), Flags::NONE);
}

#[test]
fn a_jump_of_the_simulator_is_a_fault() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.feel.plant = Some(PlantState::Jumped);
    cockpit.step();
    assert!(cockpit.faults().contains(flags::PLANT_JUMPED));
}

/// 300 m in a tick: not believed while it is news, and a loss when the last good
/// altitude is too old.
#[test]
fn a_jump_of_a_sensor_is_its_loss() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
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
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.step();
    for _ in 0..40 {
        cockpit.feel.roll_deg += 0.5;
        cockpit.observe();
    }
    let out = (0..8).fold(Surfaces::default(), |_, _| {
        cockpit.observe();
        cockpit
            .autopilot
            .failsafe(&cockpit.tick, &cockpit.measurements)
    });
    assert!(out.aileron < STANDING.aileron - 0.05, "{}", out.aileron);
    let trim = cockpit.autopilot.config().airspeed.trim_throttle;
    assert!((out.throttle - trim).abs() < 1e-12);
}

#[test]
fn failsafe_without_attitude_keeps_the_trim() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.step();
    cockpit.silent = SENSORS.into_iter().fold(Flags::NONE, |all, one| all | one);
    let out = (0..40).fold(Surfaces::default(), |_, _| {
        cockpit.observe();
        cockpit
            .autopilot
            .failsafe(&cockpit.tick, &cockpit.measurements)
    });
    assert!((out.elevator - STANDING.elevator).abs() < 0.01, "{out:?}");
    assert!((out.aileron - STANDING.aileron).abs() < 0.01, "{out:?}");
    assert!((out.rudder - STANDING.rudder).abs() < 0.01, "{out:?}");
}

#[test]
fn what_blocks_engaging_is_said() {
    let mut slow = Cockpit::new(Course::Hold);
    slow.feel.airspeed_kt = 40.0;
    for _ in 0..400 {
        slow.observe();
    }
    assert_eq!(slow.blockers(), flags::TOO_SLOW);

    let mut upset = Cockpit::new(Course::Hold);
    upset.feel.roll_deg = 75.0;
    for _ in 0..400 {
        upset.observe();
    }
    assert_eq!(upset.blockers(), flags::UPSET);
    assert_eq!(
        Autopilot::flag_name(9),
        "bank or pitch is beyond 60 degrees"
    );
}

#[test]
fn it_engages_only_after_it_has_watched_for_a_second() {
    let mut cockpit = Cockpit::new(Course::Hold);
    cockpit.autopilot = Autopilot::new(*cockpit.autopilot.config());
    for _ in 0..40 {
        cockpit.observe();
        assert_eq!(cockpit.blockers(), flags::SETTLING);
    }
    cockpit.observe();
    assert_eq!(cockpit.blockers(), Flags::NONE);
}

/// The ceiling is 135 kt and the margin 8 kt: engaged above, it slows down to
/// where it can still descend, instead of climbing for ever.
#[test]
fn what_is_captured_is_inside_the_envelope() {
    let mut cockpit = Cockpit::new(Course::Hold);
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
    let mut cockpit = Cockpit::engaged(Course::Hold);
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

/// From 0°, told 90° and then 260°: 100° to the left is shorter than 260° to
/// the right.
#[test]
fn a_heading_is_turned_to_from_where_the_nose_points() {
    let mut cockpit = Cockpit::new(Course::Hold);
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
            .command(&Order::Heading(heading_deg.to_radians()));
        cockpit.step();
    }
    assert!(cockpit.autopilot.setpoints().roll_rad < -0.5);
}

/// Engaged with the nose 12° up; the failsafe does not keep that pitch.
#[test]
fn failsafe_flies_level_whatever_the_pitch_was() {
    let mut cockpit = Cockpit::new(Course::Hold);
    cockpit.feel.pitch_deg = 12.0;
    for _ in 0..400 {
        cockpit.observe();
    }
    cockpit
        .autopilot
        .engage(&cockpit.tick, &cockpit.measurements);
    cockpit.step();
    // The altimeter says that it climbs at 5 m/s.
    for _ in 0..400 {
        cockpit.feel.altitude_m += 5.0 * DT_S;
        cockpit.observe();
        cockpit
            .autopilot
            .failsafe(&cockpit.tick, &cockpit.measurements);
    }
    let aims = cockpit.autopilot.setpoints();
    assert_eq!(aims.climb_rate_mps, 0.0);
    assert!(aims.pitch_rad.to_degrees() < 5.0, "{}", aims.pitch_rad);
}

/// Cut off 65 s into the pattern, whose start was at 350° and 3,000 ft: in
/// leg 3, which the thesis flies 270° further and 150 ft higher.
#[test]
fn a_pattern_is_gone_on_with_where_it_was() {
    let mut cockpit = Cockpit::engaged(AutopilotConfig::default().course);
    cockpit.step();
    let resume = Resume {
        targets: Targets {
            airspeed_mps: 95.0 * KNOT_MPS,
            heading_rad: 350.0_f64.to_radians(),
            altitude_m: 914.4,
        },
        pattern_s: Some(65.0),
        surfaces: STANDING,
    };
    cockpit.autopilot.command(&Order::Resume(resume));
    let aims_at = |cockpit: &mut Cockpit, heading_deg: f64, altitude_ft: f64| {
        cockpit.step();
        let aims = cockpit.autopilot.setpoints();
        assert!((aims.heading_rad.to_degrees() - heading_deg).abs() < 1e-6);
        assert!((aims.altitude_m / 0.304_8 - altitude_ft).abs() < 1e-6);
        assert!((aims.airspeed_mps / KNOT_MPS - 95.0).abs() < 1e-6);
    };
    aims_at(&mut cockpit, 260.0, 3_150.0);
    // From 30° to 260°: the shorter way is to the left.
    cockpit.steps(40);
    assert!(cockpit.autopilot.setpoints().roll_rad < -0.5);
    // 15 s to the next leg, of which 41 ticks are over.
    cockpit.steps(15 * 40);
    aims_at(&mut cockpit, 350.0, 3_000.0);
}

#[test]
fn what_was_held_is_held_again_with_the_surfaces_that_flew_it() {
    let mut cockpit = Cockpit::engaged(AutopilotConfig::default().course);
    let flew = Surfaces {
        throttle: 0.8,
        elevator: 0.11,
        aileron: 0.03,
        rudder: -0.04,
    };
    let resume = Resume {
        targets: Targets {
            airspeed_mps: 100.0 * KNOT_MPS,
            heading_rad: 30.0_f64.to_radians(),
            altitude_m: 914.4,
        },
        pattern_s: None,
        surfaces: flew,
    };
    cockpit.autopilot.command(&Order::Resume(resume));
    let first = cockpit.step();
    for (ours, was) in [
        (first.throttle, flew.throttle),
        (first.elevator, flew.elevator),
        (first.aileron, flew.aileron),
        (first.rudder, flew.rudder),
    ] {
        assert!((ours - was).abs() < 1e-6, "{ours} against {was}");
    }
    cockpit.steps(40 * 60);
    let aims = cockpit.autopilot.setpoints();
    assert!((aims.heading_rad.to_degrees() - 30.0).abs() < 1e-6, "held");
}

#[test]
fn a_flight_that_cannot_have_been_is_not_taken_up() {
    let sane = Resume {
        targets: Targets {
            airspeed_mps: 50.0,
            heading_rad: 3.0,
            altitude_m: 2_000.0,
        },
        pattern_s: None,
        surfaces: STANDING,
    };
    let mut no_altitude = sane;
    no_altitude.targets.altitude_m = f64::NAN;
    let mut too_much_throttle = sane;
    too_much_throttle.surfaces.throttle = 1.5;
    let a_pattern = Resume {
        pattern_s: Some(10.0),
        ..sane
    };
    for resume in [no_altitude, too_much_throttle, a_pattern] {
        let mut cockpit = Cockpit::engaged(Course::Hold);
        cockpit.autopilot.command(&Order::Resume(resume));
        cockpit.step();
        let aims = cockpit.autopilot.setpoints();
        assert!((aims.altitude_m - 914.4).abs() < 1e-6, "{resume:?}");
    }
}

/// At engagement the altitude is known to a foot or so; what is measured in
/// the seconds after says where that was. An altitude that is ordered stays.
#[test]
fn the_captured_altitude_is_learnt_and_an_ordered_one_is_kept() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.step();
    let captured = cockpit.autopilot.setpoints().altitude_m;
    cockpit.feel.altitude_m += 0.3;
    for _ in 0..200 {
        cockpit.step();
    }
    let learnt = cockpit.autopilot.setpoints().altitude_m - captured;
    assert!((0.01..0.3).contains(&learnt), "{learnt}");

    cockpit.autopilot.command(&Order::Altitude(950.0));
    cockpit.feel.altitude_m += 0.3;
    for _ in 0..200 {
        cockpit.step();
    }
    assert_eq!(cockpit.autopilot.setpoints().altitude_m, 950.0);
}
