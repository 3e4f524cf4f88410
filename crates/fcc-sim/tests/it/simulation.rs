//! The simulated aircraft as used by a loop: through sensor and actuator.

use std::time::Duration;

use fcc_core::flight::{Measurements, PlantState, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Switch, Tick, Time};
use fcc_sim::units::{DEGREE_RAD, FOOT_M, KNOT_MPS};
use fcc_sim::{
    Channels, LONGEST_STEP_S, SensorConfig, Severity, SimConfig, SimError, Simulation, SwitchScript,
};

const DT_S: f64 = 0.025;

fn tick(number: u64) -> Tick {
    let due = Time::from_nanos(0) + Duration::from_millis(25) * u32::try_from(number).unwrap();
    Tick {
        number,
        scheduled: due,
        woke: due,
        missed: 0,
        dt_s: DT_S,
    }
}

fn simulation(config: &SimConfig) -> Simulation {
    Simulation::new(config).unwrap()
}

#[test]
fn without_errors_measurements_are_the_truth() {
    let mut sim = simulation(&SimConfig::default());
    let mut measured = Measurements::default();
    sim.sensor.sample(&tick(1), &mut measured).unwrap();
    let now = tick(1).woke;
    assert_eq!(measured.altitude_m.taken, now);
    assert!((measured.altitude_m.value - 3_000.0 * FOOT_M).abs() < 1e-3);
    assert!((measured.airspeed_mps.value - 100.0 * KNOT_MPS).abs() < 1e-3);
    assert!((measured.specific_force.value.z_mps2 + 9.805).abs() < 0.01);
    assert!((measured.attitude.value.pitch_rad - sim.trim.alpha_rad).abs() < 1e-6);
    assert!((measured.plant.value.time_s - DT_S).abs() < 1e-12);
    assert_eq!(measured.plant.value.state, PlantState::Running);
    let truth = sim.truth.get();
    assert_eq!(
        measured.heading_rad.value.to_bits(),
        truth.heading_rad.to_bits()
    );
    assert_eq!(truth, sim.sensor.aircraft().truth());
}

/// One minute of latitude is about one nautical mile: 60 s at 104.5 kt are
/// 1.742 NM.
#[test]
fn position_moves_over_the_earth() {
    let mut sim = simulation(&SimConfig {
        latitude_rad: 0.8,
        longitude_rad: 0.2,
        magnetic_variation_rad: 5.0 * DEGREE_RAD,
        ..SimConfig::default()
    });
    let mut measured = Measurements::default();
    for number in 1..=2_400 {
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
    }
    let minutes = (measured.position.value.latitude_rad - 0.8) / DEGREE_RAD * 60.0;
    assert!((minutes / 1.742 - 1.0).abs() < 0.005, "{minutes}");
    assert!((measured.position.value.longitude_rad - 0.2).abs() < 1e-9);
    // East variation is subtracted: magnetic north lies to the right.
    assert!((measured.heading_rad.value / DEGREE_RAD - 355.0).abs() < 1e-6);
}

/// Noise has the configured standard deviation, a bias shifts, a resolution
/// rounds.
#[test]
fn errors_are_as_configured() {
    let noise = Channels::TYPICAL_NOISE;
    let mut sim = simulation(&SimConfig {
        sensors: SensorConfig {
            noise,
            bias: Channels {
                airspeed_mps: 1.5,
                ..Channels::default()
            },
            resolution: Channels {
                angle_of_attack_rad: 0.001,
                ..Channels::default()
            },
            ..SensorConfig::default()
        },
        ..SimConfig::default()
    });
    let mut measured = Measurements::default();
    let (mut airspeeds, mut pitches) = (Vec::new(), Vec::new());
    for number in 1..=10_000 {
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
        airspeeds.push(measured.airspeed_mps.value - 100.0 * KNOT_MPS);
        pitches.push(measured.attitude.value.pitch_rad - sim.trim.alpha_rad);
        let steps = measured.angle_of_attack_rad.value / 0.001;
        assert!((steps - steps.round()).abs() < 1e-9);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let sigma = |values: &[f64]| {
        let mean = mean(values);
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    };
    assert!((mean(&airspeeds) - 1.5).abs() < 0.02);
    assert!((sigma(&airspeeds) / (0.7 * KNOT_MPS) - 1.0).abs() < 0.03);
    assert!(mean(&pitches).abs() < 1e-4);
    assert!((sigma(&pitches) / (0.2 * DEGREE_RAD) - 1.0).abs() < 0.03);
}

/// With 60 ms of delay at 40 Hz a roll that began in a tick is measured whole
/// sub-steps later, and the measured roll is always that of 60 ms ago.
#[test]
fn delayed_sensors_measure_the_past() {
    let fly = |delay_ms: u16| {
        let mut sim = simulation(&SimConfig {
            sensors: SensorConfig {
                delay_ms,
                ..SensorConfig::default()
            },
            ..SimConfig::default()
        });
        let mut measured = Measurements::default();
        let mut rolls = Vec::new();
        for number in 0..200 {
            // 5 ms ticks, so that 60 ms are 12 of them.
            let tick = Tick {
                dt_s: 0.005,
                ..tick(number)
            };
            sim.sensor.sample(&tick, &mut measured).unwrap();
            rolls.push(measured.attitude.value.roll_rad);
            let turn = Surfaces {
                aileron: 0.3,
                throttle: 0.8,
                ..Surfaces::default()
            };
            sim.actuator.apply(&tick, &turn).unwrap();
        }
        rolls
    };
    let (present, past) = (fly(0), fly(60));
    assert!(present[199] > 0.1);
    for index in 12..200 {
        assert!((past[index] - present[index - 12]).abs() < 1e-9, "{index}");
    }
    // Half-way between two ticks it lies between their truths.
    let between = fly(62);
    assert!(between[150] > present[137] && between[150] < present[138]);
}

#[test]
fn the_pilot_flies_until_applied_and_after_release() {
    let mut sim = simulation(&SimConfig::default());
    let mut measured = Measurements::default();
    // Releasing what was never held does nothing.
    sim.actuator.release().unwrap();
    for number in 0..40 {
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
    }
    assert!(measured.attitude.value.roll_rad.abs() < 1e-9);
    let right = Surfaces {
        throttle: 1.0,
        aileron: 0.5,
        ..Surfaces::default()
    };
    for number in 40..60 {
        sim.actuator.apply(&tick(number), &right).unwrap();
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
    }
    assert!(sim.truth.get().aileron_rad > 0.1);
    sim.actuator.release().unwrap();
    for number in 60..140 {
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
    }
    let truth = sim.truth.get();
    assert!(truth.aileron_rad.abs() < 1e-6);
    assert!((truth.throttle - sim.trim.throttle).abs() < 0.02);
}

#[test]
fn invalid_commands_are_ignored() {
    let mut sim = simulation(&SimConfig::default());
    let mut measured = Measurements::default();
    let broken = Surfaces {
        aileron: f64::NAN,
        throttle: 7.0,
        ..Surfaces::default()
    };
    for number in 0..400 {
        sim.actuator.apply(&tick(number), &broken).unwrap();
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
    }
    assert!((measured.altitude_m.value - 3_000.0 * FOOT_M).abs() < 0.01);
}

#[test]
fn actuators_have_a_lag_and_a_rate_limit() {
    let mut sim = simulation(&SimConfig::default());
    let mut measured = Measurements::default();
    let full = Surfaces {
        throttle: sim.trim.throttle,
        aileron: 1.0,
        ..Surfaces::default()
    };
    sim.actuator.apply(&tick(0), &full).unwrap();
    sim.sensor.sample(&tick(0), &mut measured).unwrap();
    let travel_rad = 17.5 * DEGREE_RAD;
    let first = sim.truth.get().aileron_rad / travel_rad;
    assert!(first > 0.0 && first <= 2.5 * DT_S + 1e-12, "{first}");
    for number in 1..40 {
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
    }
    assert!((sim.truth.get().aileron_rad / travel_rad - 1.0).abs() < 1e-3);
}

#[test]
fn the_switch_follows_its_script_and_handle() {
    let mut sim = simulation(&SimConfig {
        switch: SwitchScript {
            on_at_s: Some(1.0),
            off_at_s: Some(2.0),
        },
        ..SimConfig::default()
    });
    let mut measured = Measurements::default();
    let mut positions = Vec::new();
    for number in 0..120 {
        sim.sensor.sample(&tick(number), &mut measured).unwrap();
        positions.push(measured.engage_switch.value);
    }
    let on = positions.iter().filter(|switch| **switch == Switch::On);
    assert_eq!(on.count(), 40);
    assert_eq!(positions[37], Switch::Off);
    assert_eq!(positions[40], Switch::On);

    sim.switch.set(Some(Switch::On));
    sim.sensor.sample(&tick(120), &mut measured).unwrap();
    assert_eq!(measured.engage_switch.value, Switch::On);
    sim.switch.set(None);
    sim.sensor.sample(&tick(121), &mut measured).unwrap();
    assert_eq!(measured.engage_switch.value, Switch::Off);
}

/// A tick after three missed ones advances by four periods; one after an hour
/// by a second, and reports that the plant is slow.
#[test]
fn late_ticks_advance_by_the_time_that_passed() {
    let mut sim = simulation(&SimConfig::default());
    let mut measured = Measurements::default();
    let late = Tick {
        missed: 3,
        dt_s: 4.0 * DT_S,
        ..tick(4)
    };
    sim.sensor.sample(&late, &mut measured).unwrap();
    assert!((measured.plant.value.time_s - 0.1).abs() < 1e-12);
    let hour = Tick {
        dt_s: 3_600.0,
        ..tick(5)
    };
    sim.sensor.sample(&hour, &mut measured).unwrap();
    assert!((measured.plant.value.time_s - 0.1 - LONGEST_STEP_S).abs() < 1e-9);
    assert_eq!(measured.plant.value.state, PlantState::Slow);
    for dt_s in [0.0, -1.0, f64::NAN] {
        let odd = Tick { dt_s, ..tick(6) };
        sim.sensor.sample(&odd, &mut measured).unwrap();
        assert!((measured.plant.value.time_s - 1.1).abs() < 1e-9);
    }
}

#[test]
fn configuration_errors_are_reported() {
    let broken = [
        (
            SimConfig {
                substep_s: 0.5,
                ..SimConfig::default()
            },
            "substep_s is 0.5; it must be 0.0001..=0.01 s",
        ),
        (
            SimConfig {
                altitude_m: f64::NAN,
                ..SimConfig::default()
            },
            "altitude_m is NaN; it must be 0..=15000 m",
        ),
        (
            SimConfig {
                sensors: SensorConfig {
                    noise: Channels {
                        altitude_m: -1.0,
                        ..Channels::default()
                    },
                    ..SensorConfig::default()
                },
                ..SimConfig::default()
            },
            "sensors.noise.altitude_m is -1; it must be 0 or more",
        ),
        (
            SimConfig {
                sensors: SensorConfig {
                    delay_ms: 1_001,
                    ..SensorConfig::default()
                },
                ..SimConfig::default()
            },
            "sensors.delay_ms is 1001; it must be 0..=1000 ms",
        ),
    ];
    for (config, message) in broken {
        let error = Simulation::new(&config).unwrap_err();
        assert!(matches!(error, SimError::Invalid { .. }));
        assert_eq!(error.to_string(), message);
    }
    let stalled = SimConfig {
        indicated_airspeed_mps: 20.0,
        ..SimConfig::default()
    };
    let error = Simulation::new(&stalled).unwrap_err();
    assert!(
        error.to_string().contains("choose a higher airspeed"),
        "{error}"
    );
}

/// Sensor and actuator are moved to the loop's thread; handles stay.
#[test]
fn the_parts_can_be_moved_to_another_thread() {
    let Simulation {
        sensor,
        actuator,
        truth,
        switch,
        ..
    } = simulation(&SimConfig {
        gusts: Some(Severity::Moderate),
        ..SimConfig::default()
    });
    let mut sensor: Box<dyn Sensor<Measurements>> = Box::new(sensor);
    let mut actuator: Box<dyn Actuator<Surfaces>> = Box::new(actuator);
    let flying = std::thread::spawn(move || {
        let mut measured = Measurements::default();
        for number in 0..2_000 {
            sensor.sample(&tick(number), &mut measured).unwrap();
            let surfaces = Surfaces {
                throttle: 0.8,
                ..Surfaces::default()
            };
            actuator.apply(&tick(number), &surfaces).unwrap();
        }
        actuator.release().unwrap();
    });
    let mut last_s = 0.0;
    while !flying.is_finished() {
        let now = truth.get();
        assert!(now.time_s >= last_s);
        last_s = now.time_s;
        switch.set(Some(Switch::On));
        std::thread::sleep(Duration::from_millis(1));
    }
    flying.join().unwrap();
    assert!((truth.get().time_s - 50.0).abs() < 1e-6);
}
