//! The autopilot seen from outside: scripted measurements in, surfaces out.
#![cfg(feature = "flight")]

use core::time::Duration;

use fcc_core::flight::{
    Attitude, Autopilot, AutopilotConfig, BodyRates, Course, Measurements, Order, Plant,
    PlantState, SpecificForce, Surfaces, flags,
};
use fcc_core::framework::{Controller, Flags, Reading, Tick, Time};

const DT_S: f64 = 0.025;
const KNOT_MPS: f64 = 1_852.0 / 3_600.0;

/// An autopilot and the aircraft that it believes to be in.
struct Cockpit {
    autopilot: Autopilot,
    tick: Tick,
    /// What the sensors say; stamped at each tick.
    feel: Feel,
    measurements: Measurements,
    silent: bool,
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
            silent: false,
        };
        for _ in 0..40 {
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
        if !self.silent {
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
                ..Measurements::default()
            };
        }
        self.autopilot.estimate(&self.tick, &self.measurements);
    }

    fn step(&mut self) -> Surfaces {
        self.observe();
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
fn each_silent_sensor_is_a_fault_once_it_is_too_old() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.step();
    cockpit.silent = true;
    // 250 ms are allowed.
    for _ in 0..10 {
        cockpit.step();
        assert_eq!(cockpit.faults(), Flags::NONE);
    }
    cockpit.step();
    let all = flags::ATTITUDE
        | flags::HEADING
        | flags::BODY_RATES
        | flags::SPECIFIC_FORCE
        | flags::AIRSPEED
        | flags::ALTITUDE;
    assert_eq!(cockpit.faults(), all);
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
    let before = cockpit.steps(20);
    cockpit.feel.plant = Some(PlantState::Paused);
    let after = cockpit.steps(400);
    assert_eq!(before, after);
    assert!(cockpit.blockers().contains(flags::PLANT_HALTED));
    assert_eq!(cockpit.faults(), Flags::NONE);
}

#[test]
fn a_jump_of_the_simulator_is_a_fault() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.feel.plant = Some(PlantState::Jumped);
    cockpit.step();
    assert!(cockpit.faults().contains(flags::PLANT_JUMPED));
}

#[test]
fn failsafe_levels_the_wings_while_the_attitude_is_known() {
    let mut cockpit = Cockpit::engaged(Course::Hold);
    cockpit.step();
    cockpit.feel.roll_deg = 20.0;
    for _ in 0..40 {
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
    cockpit.silent = true;
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
