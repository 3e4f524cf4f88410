//! Numbers that are none, in commands and in every field of the measurements, and
//! what settles after an outage.

use fcc_core::flight::{
    AltitudeReference, GnssFix, Measurements, Plant, PlantState, Surfaces, Velocity,
};
use fcc_core::framework::{Controller, Flags, Reading};
use fcc_fixed_wing::{AutopilotCommand, Resume, flags};
use fcc_guidance::{GuidanceConfig, Progress};

use crate::cockpit::{Cockpit, DT_S, SENSORS, STANDING};

const NO_NUMBERS: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Each field of the measurements that is a number, one after the other.
const FIELDS: [fn(&mut Measurements) -> &mut f64; 23] = [
    |m| &mut m.attitude.value.pitch_rad,
    |m| &mut m.attitude.value.roll_rad,
    |m| &mut m.heading_rad.value,
    |m| &mut m.body_rates.value.roll_radps,
    |m| &mut m.body_rates.value.pitch_radps,
    |m| &mut m.body_rates.value.yaw_radps,
    |m| &mut m.specific_force.value.x_mps2,
    |m| &mut m.specific_force.value.y_mps2,
    |m| &mut m.specific_force.value.z_mps2,
    |m| &mut m.airspeed_mps.value,
    |m| &mut m.altitude_m.value,
    |m| &mut m.angle_of_attack_rad.value,
    |m| &mut m.position.value.latitude_rad,
    |m| &mut m.position.value.longitude_rad,
    |m| &mut m.position.value.altitude_m,
    |m| &mut m.velocity.value.north_mps,
    |m| &mut m.velocity.value.east_mps,
    |m| &mut m.velocity.value.down_mps,
    |m| &mut m.surfaces.value.throttle,
    |m| &mut m.surfaces.value.elevator,
    |m| &mut m.surfaces.value.aileron,
    |m| &mut m.surfaces.value.rudder,
    |m| &mut m.plant.value.time_s,
];

fn assert_finite(cockpit: &Cockpit, outputs: &Surfaces, field: usize) {
    assert!(outputs.is_valid(), "field {field}: {outputs:?}");
    let estimated = cockpit.autopilot.estimated();
    let numbers = [
        estimated.roll_rad,
        estimated.pitch_rad,
        estimated.heading_rad,
        estimated.airspeed_mps,
        estimated.true_airspeed_mps,
        estimated.altitude_m,
        estimated.climb_rate_mps,
        estimated.side_force_mps2,
        estimated.load_factor,
        estimated.gust_load,
        estimated.angle_of_attack_rad,
        estimated.acceleration_mps2,
        estimated.output_latency_s,
        estimated.airspeed_uncertainty_mps,
        estimated.reading_age_s,
        estimated.reading_jitter_s,
    ];
    assert!(numbers.iter().all(|number| number.is_finite()), "{field}");
}

/// For a second, of a source that measures everything, and 3 s more.
#[test]
fn a_number_that_is_none_in_any_field_reaches_neither_estimate_nor_output() {
    for no_number in NO_NUMBERS {
        for (index, field) in FIELDS.into_iter().enumerate() {
            let mut cockpit = Cockpit::engaged_on_a_simulator(60);
            for tick in 0..160 {
                cockpit.observe_with(|measured| {
                    let now = measured.attitude.taken;
                    measured.angle_of_attack_rad = Reading::new(0.05, now);
                    measured.velocity = Reading::new(Velocity::default(), now);
                    if tick < 40 {
                        *field(measured) = no_number;
                    }
                });
                let outputs = if cockpit.faults().is_empty() {
                    cockpit.act()
                } else {
                    cockpit.failsafe()
                };
                assert_finite(&cockpit, &outputs, index);
            }
            assert_eq!(cockpit.faults(), Flags::NONE, "field {index}");
        }
    }
}

#[test]
fn a_command_that_is_no_number_changes_nothing() {
    for no_number in NO_NUMBERS {
        let resumed = |progress, surfaces| {
            AutopilotCommand::Resume(Resume {
                progress,
                surfaces,
                altimeter_setting_pa: Some(no_number),
                altitude_reference: AltitudeReference::PressureLevel,
                ..Resume::default()
            })
        };
        let mut progress = Cockpit::engaged(GuidanceConfig::Hold)
            .autopilot
            .setpoints()
            .guidance;
        progress.elapsed_s = no_number;
        let elevator = Surfaces {
            elevator: no_number,
            ..STANDING
        };
        for command in [
            AutopilotCommand::Airspeed(no_number),
            AutopilotCommand::Heading(no_number),
            AutopilotCommand::Altitude(no_number),
            AutopilotCommand::PressureAltitude(no_number),
            AutopilotCommand::Height(no_number),
            AutopilotCommand::AltimeterSetting(no_number),
            resumed(progress, STANDING),
            resumed(Progress::default(), elevator),
        ] {
            let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
            cockpit.steps(4);
            let before = cockpit.autopilot.setpoints();
            cockpit.autopilot.command(&command);
            cockpit.steps(1);
            let after = cockpit.autopilot.setpoints();
            assert_eq!(after.guidance.mode, before.guidance.mode, "{command:?}");
            assert_eq!(after.heading_rad, before.heading_rad, "{command:?}");
            assert_eq!(after.airspeed_mps, before.airspeed_mps, "{command:?}");
            assert!((after.altitude_m - before.altitude_m).abs() < 0.01);
            assert_eq!(after.altimeter_setting_pa, before.altimeter_setting_pa);
        }
    }
}

/// After so many ticks of an outage. A second is 40 ticks.
#[track_caller]
fn assert_settles_after(mut cockpit: Cockpit, outage: impl Fn(&mut Cockpit), ticks: u32) {
    for _ in 0..ticks {
        outage(&mut cockpit);
    }
    assert_ne!(cockpit.engage_inhibits(), Flags::NONE);
    cockpit.silent = Flags::NONE;
    cockpit.feel.plant = cockpit.feel.plant.map(|_| PlantState::Running);
    cockpit.observe();
    assert_eq!(cockpit.engage_inhibits(), flags::SETTLING);
    for _ in 0..37 {
        cockpit.observe();
        assert_eq!(cockpit.engage_inhibits(), flags::SETTLING);
    }
    for _ in 0..3 {
        cockpit.observe();
    }
    assert_eq!(cockpit.engage_inhibits(), Flags::NONE);
}

#[test]
fn it_settles_after_a_failsafe_that_ended_in_a_release() {
    for lost in SENSORS {
        let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
        cockpit.silent = lost;
        for _ in 0..40 {
            cockpit.observe();
            cockpit.failsafe();
        }
        cockpit.autopilot.disengage();
        assert_settles_after(cockpit, Cockpit::observe, 4);
    }
}

#[test]
fn it_settles_after_silence_a_jump_and_another_aircraft() {
    let simulator = || {
        let mut cockpit = Cockpit::engaged_on_a_simulator(60);
        cockpit.autopilot.disengage();
        cockpit
    };
    let silent = |cockpit: &mut Cockpit| {
        cockpit.stood_s += DT_S;
        cockpit.receive_nothing();
    };
    assert_settles_after(simulator(), silent, 20);
    for state in [PlantState::Jumped, PlantState::Reloaded] {
        let mut cockpit = simulator();
        cockpit.feel.plant = Some(state);
        assert_settles_after(cockpit, Cockpit::observe, 2);
    }
}

/// Nothing settles while the plant's time stands still: one that was paused before
/// anything was read from it.
#[test]
fn a_pause_is_no_time_in_which_navigation_settles() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.autopilot = fcc_fixed_wing::Autopilot::new(*cockpit.autopilot.config());
    cockpit.measurements.plant = Reading::new(
        Plant {
            time_s: 100.0,
            state: PlantState::Paused,
        },
        cockpit.tick.woke,
    );
    for _ in 0..200 {
        cockpit.pause(100.0);
        let both = flags::SETTLING | flags::PLANT_PAUSED;
        assert_eq!(cockpit.engage_inhibits(), both);
    }
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.stood_s = cockpit.tick.woke.as_nanos() as f64 * 1e-9 - 100.0;
    assert_settles_after(cockpit, |cockpit| cockpit.pause(100.0), 1);
}

#[test]
fn an_impossible_fix_is_a_condition() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    let mut condition = |north_mps: f64| {
        let mut measured = cockpit.measurements;
        let velocity = Velocity {
            north_mps,
            ..Velocity::default()
        };
        let fix = GnssFix {
            velocity,
            ..GnssFix::default()
        };
        measured.gnss = Reading::new(fix, cockpit.tick.woke);
        cockpit.autopilot.estimate(&cockpit.tick, &measured);
        let conditions = cockpit.autopilot.conditions(&cockpit.tick, &measured);
        conditions.contains(flags::IMPOSSIBLE_FIX)
    };
    assert!(!condition(50.0));
    assert!(condition(500.0));
    assert!(condition(f64::NAN));
    assert!(!condition(50.0));
}
