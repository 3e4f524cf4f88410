//! Constraints between the values of a configuration, and on its lists.

use fcc_fixed_wing::control::Envelope;

use super::autopilot::{self, EnvelopeSection};
use super::{
    ActuatorEntry, AutopilotSection, Config, GuidanceSection, NavigationMethod, SensorEntry,
    contingency, device, navigation, raw_readings, servo_board, servos, shared_devices,
};

/// Of `SCHED_FIFO` (sched(7)).
const HIGHEST_PRIORITY: u8 = 99;

/// Reports the message of each violated constraint, and the keys that it is about:
/// the one to change first.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let early = &config.tick.early_wake;
    let (least, most) = (early.min_us, early.max_us);
    if least > most {
        let message = format!("is {least}: choose no more than max_us, {most}");
        let keys = ["loop.early_wake.min_us", "loop.early_wake.max_us"];
        report(&keys, message);
    }
    if config.watchdog.enabled && config.realtime.priority == HIGHEST_PRIORITY {
        report(
            &["realtime.priority", "watchdog.enabled"],
            format!(
                "is {HIGHEST_PRIORITY}: choose at most {}, so that the watchdog can have a higher \
                 one and interrupt a loop that spins",
                HIGHEST_PRIORITY - 1
            ),
        );
    }
    envelope(&config.autopilot, report);
    let (silent_s, max_age_ms) = (
        config.failsafe.all_silent_s,
        config.failsafe.sensor_max_age_ms,
    );
    if silent_s * 1e3 < max_age_ms as f64 {
        let message = format!(
            "is {silent_s}: choose at least {}, which is failsafe.sensor_max_age_ms in s",
            max_age_ms as f64 / 1e3
        );
        let keys = ["failsafe.all_silent_s", "failsafe.sensor_max_age_ms"];
        report(&keys, message);
    }
    ages(config, report);
    budgets(config, report);
    overload(config, report);
    built_in(config, report);
    if config.x_plane.is_some() && config.built_in.is_some() {
        report(
            &["built-in"],
            "is given together with [x-plane]: keep the section of the aircraft that is to be flown"
                .to_owned(),
        );
    }
    if config.x_plane.is_some()
        && !config.has_board()
        && config.navigation.method != NavigationMethod::Measured
    {
        report(
            &["navigation.method", "x-plane"],
            "computes attitude from raw readings, and X-Plane gives none: choose \"measured\", or \
             list sensors that give some"
                .to_owned(),
        );
    }
    plan(config, report);
    autopilot::launch(&config.autopilot.runway, report);
    contingency::check(config, report);
    paths(config, report);
    connections(config, report);
    rights(config, report);
    lists(config, report);
    navigation::check(config, report);
    raw_readings::check(config, report);
    device::check(config, report);
    servo_board::check(config, report);
    servos::check(config, report);
    shared_devices::check(config, report);
}

/// A plan that is to be flown is given.
fn plan(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let is_given = config.plan.file.is_some() || config.plan.content.is_some();
    if matches!(config.guidance, GuidanceSection::Plan) && !is_given {
        let message = "flies the plan of plan.file: give it, or choose another mode".to_owned();
        report(&["guidance.mode", "plan.file"], message);
    }
}

/// No file of Unix has a NUL in its name.
fn paths(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let state_file = config.restart.state_file.as_deref();
    let calibration_file = config.calibration.file.as_deref();
    let paths = [
        ("calibration.file", calibration_file),
        ("plan.file", config.plan.file.as_deref()),
        ("recording.folder", Some(config.recording.folder.as_path())),
        ("restart.state_file", state_file),
        ("terrain.folder", config.terrain.folder.as_deref()),
    ];
    for (key, path) in paths {
        if path.is_some_and(|path| path.as_os_str().as_encoded_bytes().contains(&0)) {
            report(
                &[key],
                "has a NUL character: choose a path without".to_owned(),
            );
        }
    }
    if calibration_file.is_some_and(|path| path.file_name().is_none()) {
        let message = "is no name of a file: give one, or leave it out".to_owned();
        report(&["calibration.file"], message);
    }
}

/// The lowest airspeed over the stalling speed: the margin of certification is
/// 1.2 to 1.3 (14 CFR 23.73 in force until 2017: approach at 1.3).
const OVER_STALL: f64 = 1.1;
const APPROACH_OVER_STALL: f64 = 1.2;
/// Room between the lowest and the highest airspeed, in margins: two, and one
/// to hold an airspeed in.
const MARGINS: f64 = 3.0;

/// Whether there is an airspeed to hold below the never-exceed speed.
fn has_airspeeds(
    envelope: &EnvelopeSection,
    least_never: f64,
    at: &mut impl FnMut(&[&str], f64, String),
) -> bool {
    let (never, stall) = (
        envelope.never_exceed_airspeed_kt,
        envelope.stall_airspeed_kt,
    );
    if never >= least_never {
        return true;
    }
    let wanted = format!(
        "at least {least_never}, which is {OVER_STALL} times stall_airspeed_kt ({stall}) and \
         {MARGINS} times airspeed_margin_kt ({}), or no airspeed is left to hold",
        envelope.airspeed_margin_kt
    );
    let [never_kt, stall_kt] = ["never_exceed_airspeed_kt", "stall_airspeed_kt"];
    at(&[never_kt, stall_kt, "airspeed_margin_kt"], never, wanted);
    false
}

/// A limit as it is shown, so that what a message permits is accepted.
fn tenths(kt: f64) -> f64 {
    (kt * 10.0).round() / 10.0
}

/// Of `[autopilot.envelope]`: an envelope in which an aircraft can fly, and of the airspeeds
/// of `[autopilot.runway]`, that they are in it.
fn envelope(autopilot: &AutopilotSection, report: &mut impl FnMut(&[&str], String)) {
    let envelope = &autopilot.envelope;
    let (stall, least, most, never) = (
        envelope.stall_airspeed_kt,
        envelope.min_airspeed_kt,
        envelope.max_airspeed_kt,
        envelope.never_exceed_airspeed_kt,
    );
    let mut at = |keys: &[&str], value: f64, wanted: String| {
        let whole = |key: &&str| format!("autopilot.envelope.{key}");
        let keys: Vec<_> = keys.iter().map(whole).collect();
        let keys: Vec<_> = keys.iter().map(String::as_str).collect();
        report(&keys, format!("is {value}: choose {wanted}"));
    };
    let above_stall = tenths(OVER_STALL * stall);
    let room = MARGINS * envelope.airspeed_margin_kt;
    if !has_airspeeds(envelope, tenths(above_stall + room), &mut at) {
        return;
    }
    if least >= most {
        at(
            &["min_airspeed_kt", "max_airspeed_kt"],
            least,
            format!("less than max_airspeed_kt, {most}"),
        );
        return;
    }
    if most < tenths(least + room) {
        at(
            &["max_airspeed_kt", "min_airspeed_kt", "airspeed_margin_kt"],
            most,
            format!(
                "at least {}, which is min_airspeed_kt ({least}) and {MARGINS} times \
                 airspeed_margin_kt ({}), or no airspeed is left to hold",
                tenths(least + room),
                envelope.airspeed_margin_kt
            ),
        );
    }
    if least < above_stall {
        at(
            &["min_airspeed_kt", "stall_airspeed_kt"],
            least,
            format!("at least {above_stall}: {OVER_STALL} times stall_airspeed_kt, {stall}"),
        );
    }
    if most > never {
        at(
            &["max_airspeed_kt", "never_exceed_airspeed_kt"],
            most,
            format!("at most never_exceed_airspeed_kt, {never}"),
        );
    }
    loads(envelope, &mut at);
    let runway = &autopilot.runway;
    let over_stall = |times: f64| {
        let (lowest, times) = (tenths(times * stall), format!("{times} times "));
        (lowest, times, "envelope.stall_airspeed_kt")
    };
    let slowest = (least, String::new(), "envelope.min_airspeed_kt");
    let mut approach = over_stall(APPROACH_OVER_STALL);
    if approach.0 <= least {
        approach = slowest.clone();
    }
    // With flaps an aircraft lifts off below the stalling speed without.
    let mut lift_off = (stall, String::new(), "envelope.stall_airspeed_kt");
    if runway.takeoff_flaps > 0.0 {
        lift_off.0 = 0.0;
    }
    let fastest = (most, "envelope.max_airspeed_kt");
    let never = (never, "envelope.never_exceed_airspeed_kt");
    let climb = (runway.climb_kt, "runway.climb_kt");
    let glide = envelope.best_glide_airspeed_kt;
    let maneuvering = envelope.maneuvering_airspeed_kt;
    for ((value, key), (lowest, times, of), (highest, to)) in [
        (
            (glide, "envelope.best_glide_airspeed_kt"),
            over_stall(OVER_STALL),
            fastest,
        ),
        (
            (maneuvering, "envelope.maneuvering_airspeed_kt"),
            over_stall(OVER_STALL),
            never,
        ),
        ((runway.rotate_kt, "runway.rotate_kt"), lift_off, climb),
        (climb, slowest, fastest),
        (
            (runway.approach_kt, "runway.approach_kt"),
            approach,
            fastest,
        ),
    ] {
        if lowest <= highest && !(lowest..=highest).contains(&value) {
            let keys = [key, of, to].map(|key| format!("autopilot.{key}"));
            let range = format!("{lowest} to {highest}: {times}{of} to {to}");
            report(
                &keys.each_ref().map(String::as_str),
                format!("is {value}: choose {range}"),
            );
        }
    }
}

/// Of the load factors in it.
fn loads(envelope: &EnvelopeSection, at: &mut impl FnMut(&[&str], f64, String)) {
    let (load, limit_load) = (envelope.max_load_factor_g, envelope.limit_load_factor_g);
    if load > limit_load {
        at(
            &["max_load_factor_g", "limit_load_factor_g"],
            load,
            format!("at most limit_load_factor_g, {limit_load}"),
        );
    }
    let least_load = Envelope::LEAST_MAX_LOAD_FACTOR;
    if load < least_load {
        at(
            &["max_load_factor_g"],
            load,
            format!(
                "at least {least_load:.2}: less leaves no turn, since 0.1 g are kept for the flight path"
            ),
        );
    }
}

/// The longest interval between two readings of all sensors with which JSBSim's
/// c172p was flown at 73 and 100 kt, ms: in a loop of at least this rate, Hz, and in
/// a slower one (`docs/envelope.md`, margins).
const FAST_LOOP_HZ: f64 = 40.0;
const MOST_AGE_MS: (f64, f64) = (600.0, 250.0);

/// Of `failsafe.sensor_max_age_ms`: readings of that age can be flown.
fn ages(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let (age_ms, rate_hz) = (config.failsafe.sensor_max_age_ms, config.tick.rate_hz);
    let (fast_ms, slow_ms) = MOST_AGE_MS;
    let most_ms = if rate_hz >= FAST_LOOP_HZ {
        fast_ms
    } else {
        slow_ms
    };
    if age_ms as f64 > most_ms {
        let message = format!(
            "is {age_ms}: choose at most {most_ms}: older readings cannot be flown with \
             loop.rate_hz = {rate_hz}"
        );
        report(&["failsafe.sensor_max_age_ms", "loop.rate_hz"], message);
    }
}

/// X-Plane sends the values of a frame in one datagram, and the position in
/// another.
const DATAGRAMS_PER_FRAME: f64 = 2.0;

/// Of the connections to an X-Plane.
fn connections(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let mut ports: Vec<(u16, String)> = Vec::new();
    // The rate itself may be out of range here.
    let loop_hz = config.tick.rate_hz.max(1.0);
    for (at, section) in config.x_planes() {
        let (most, rate_hz) = (section.datagrams_per_tick, section.rate_hz);
        // Twice: of the datagrams of a late tick none is lost.
        let needed = (2.0 * DATAGRAMS_PER_FRAME * f64::from(rate_hz) / loop_hz).ceil();
        if f64::from(most) < needed {
            let message = format!(
                "is {most}: choose at least {needed} = 2 x {DATAGRAMS_PER_FRAME} datagrams a frame \
                 x {rate_hz} frames a second / {loop_hz} ticks a second, or a lower {at}.rate_hz: \
                 the readings of a tick would be incomplete and old"
            );
            let [most, rate] = ["datagrams_per_tick", "rate_hz"].map(|key| format!("{at}.{key}"));
            report(&[&most, &rate, "loop.rate_hz"], message);
        }
        let port = section.local_port;
        if let Some((_, other)) = ports.iter().find(|(taken, _)| *taken == port) {
            let message = format!("is {port}, as {other}: give each connection its own port");
            report(&[&format!("{at}.local_port"), other], message);
        } else if port != 0 {
            ports.push((port, format!("{at}.local_port")));
        }
    }
}

/// Of the start of the built-in aircraft.
fn built_in(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let Some(section) = &config.built_in else {
        return;
    };
    let [airspeed, altitude] = ["built-in.airspeed_kt", "built-in.altitude_ft"];
    if section.ground_ft >= section.altitude_ft {
        report(
            &["built-in.ground_ft", altitude],
            format!(
                "is {}: choose less than altitude_ft, {}: the flight begins in the air",
                section.ground_ft, section.altitude_ft
            ),
        );
    }
    if let Some(message) = section.why_not_level() {
        report(&[airspeed, altitude], message);
    }
}

fn overload(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let section = &config.overload;
    let skip_after_s = section.skip_after_ms as f64 / 1e3;
    if section.stop_after_s > 0.0 && section.stop_after_s < skip_after_s {
        report(
            &["overload.stop_after_s", "overload.skip_after_ms"],
            format!(
                "is {}, and deadlines are skipped after {skip_after_s} s (overload.skip_after_ms): \
                 choose at least that, or 0 for never",
                section.stop_after_s
            ),
        );
    }
}

fn budgets(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let budget = &config.budget;
    let Some(tick_us) = budget.tick_us else {
        return;
    };
    let period_us = (1e6 / config.tick.rate_hz.max(0.0)).floor();
    if f64::from(tick_us) > period_us {
        report(
            &["budget.tick_us", "loop.rate_hz"],
            format!(
                "is {tick_us}: choose no more than the period, {period_us}: a longer tick misses \
                 the next period"
            ),
        );
    }
    for (key, stage_us) in [
        ("budget.sensors_us", budget.sensors_us),
        ("budget.estimate_us", budget.estimate_us),
        ("budget.guide_us", budget.guide_us),
        ("budget.control_us", budget.control_us),
        ("budget.actuators_us", budget.actuators_us),
    ] {
        if let Some(stage_us) = stage_us.filter(|stage_us| *stage_us > tick_us) {
            let message = format!("is {stage_us}: choose no more than tick_us, {tick_us}");
            report(&[key, "budget.tick_us"], message);
        }
    }
}

/// Of names of users and groups: a tenth of it is a large crew.
const MOST_NAMES: usize = 100;

fn rights(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let rights = &config.rights;
    for (key, names) in [
        ("rights.commanders", &rights.commanders),
        ("rights.commander_groups", &rights.commander_groups),
    ] {
        if names.len() > MOST_NAMES {
            let message = format!("has {} names: keep at most {MOST_NAMES}", names.len());
            report(&[key], message);
        }
        let may_command = config.telemetry.enabled && config.telemetry.commands;
        if !names.is_empty() && !may_command {
            let message = "has names, and telemetry.enabled or telemetry.commands is false, so \
                           nobody may command: remove the names, or set it true";
            report(&[key], message.to_owned());
        }
    }
}

fn lists(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let is_simulator = |entry: &ActuatorEntry| matches!(entry, ActuatorEntry::Simulator(_));
    let actuators = config.actuators().iter().map(is_simulator);
    let sensors = config.sensor.iter().map(SensorEntry::is_simulator);
    for (list, simulators) in [
        ("sensor", sensors.collect::<Vec<_>>()),
        ("actuator", actuators.collect()),
    ] {
        let entries = simulators.iter().enumerate();
        for (at, _) in entries.filter(|(_, is_simulator)| **is_simulator).skip(1) {
            let message = "is the simulator a second time: keep one".to_owned();
            report(&[&format!("{list}[{at}].kind")], message);
        }
    }
}
