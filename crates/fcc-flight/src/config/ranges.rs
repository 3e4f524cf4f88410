//! The permitted ranges of a configuration's numbers.
//!
//! One table of ranges for all numeric keys; a test shows that no key is
//! missing from it.

use fcc_telemetry::units::number;
use fcc_xplane::{XPlaneConfig, XPlaneConfigError};
use toml::de::DeValue;

use super::places::Places;
use super::{
    Config, Problem, SensorEntry, XPlaneSection, airframe, autopilot, calibration, device,
    navigation, relations, servo_board,
};

/// Key, smallest and largest value.
const RANGES: &[(&str, f64, f64)] = &[
    ("loop.rate_hz", 20.0, 2_000.0),
    ("loop.early_wake.min_us", 0.0, 10_000.0),
    ("loop.early_wake.max_us", 1.0, 10_000.0),
    ("loop.early_wake.guard_us", 0.0, 10_000.0),
    ("loop.early_wake.quantile", 0.5, 0.9999),
    ("loop.early_wake.cpu_cap_percent", 0.0, 50.0),
    ("realtime.priority", 0.0, 99.0),
    ("realtime.cpu", 0.0, 1_023.0),
    ("realtime.cpu_dma_latency_us", 0.0, 1e6),
    ("realtime.stack_prefault_kib", 0.0, 4_096.0),
    ("realtime.timer_slack_ns", 0.0, 1e9),
    ("budget.tick_us", 1.0, 1e6),
    ("budget.sensors_us", 1.0, 1e6),
    ("budget.estimate_us", 1.0, 1e6),
    ("budget.guide_us", 1.0, 1e6),
    ("budget.control_us", 1.0, 1e6),
    ("budget.actuators_us", 1.0, 1e6),
    ("budget.failsafe_after", 0.0, 1e6),
    ("overload.skip_after_ms", 0.0, 60_000.0),
    ("overload.stop_after_s", 0.0, 3_600.0),
    ("watchdog.hang_after_ms", 50.0, 60_000.0),
    ("failsafe.sensor_max_age_ms", 10.0, 10_000.0),
    ("failsafe.all_silent_s", 0.01, 600.0),
    ("failsafe.sensor_frozen_s", 0.0, 60.0),
    ("failsafe.hold_s", 0.0, 600.0),
    ("failsafe.degraded_s", 0.0, 86_400.0),
    ("failsafe.recover_s", 0.0, 600.0),
    ("release.level_and_trim_s", 0.0, 10.0),
    ("engage.stick_takeover", 0.05, 1.0),
    ("engage.stick_takeover_s", 0.0, 2.0),
    ("recording.max_file_mb", 0.0, 1e6),
    ("recording.max_file_minutes", 0.0, 1e5),
    ("recording.keep_total_mb", 0.0, 1e8),
    ("restart.max_age_s", 1.0, 600.0),
    ("calibration.stale_after_days", 1.0, 10_000.0),
    ("guidance.hold_s", 0.0, 86_400.0),
    ("guidance.leg_s", 1.0, 86_400.0),
    ("guidance.turn_deg", -179.0, 179.0),
    ("guidance.climb_ft", -5_000.0, 5_000.0),
    ("plan.wind_kt", 0.0, 200.0),
    ("plan.period_s", 2.0, 120.0),
    ("plan.max_bank_deg", 5.0, 60.0),
    ("plan.bank_rate_degps", 1.0, 180.0),
    ("plan.loiter_radius_m", 10.0, 100_000.0),
    ("plan.return_height_ft", 0.0, 20_000.0),
    ("plan.service_ceiling_ft", 100.0, 65_000.0),
    ("contingency.fence_margin_m", 0.0, 10_000.0),
    ("contingency.fence_height_margin_ft", 0.0, 1_000.0),
    ("contingency.position_lost_after_s", 0.0, 36_000.0),
    ("contingency.battery_charge_percent", 0.0, 100.0),
    ("contingency.battery_voltage_v", 0.0, 1_000.0),
    ("contingency.battery_low_after_s", 0.0, 3_600.0),
    ("contingency.engine_out_below_rpm", 0.0, 100_000.0),
    ("contingency.engine_out_after_s", 0.0, 60.0),
    ("contingency.engine_back_after_s", 0.0, 3_600.0),
    ("contingency.glide_ratio", 2.0, 60.0),
    ("contingency.glide_spare_ft", 0.0, 10_000.0),
    ("contingency.terrain_margin_m", 10.0, 3_000.0),
    ("contingency.terrain_ahead_s", 10.0, 300.0),
    ("terrain.margin_m", 0.0, 3_000.0),
    ("terrain.around_km", 1.0, 500.0),
    ("terrain.memory_mb", 1.0, 16_000.0),
    ("plan.uploaded_unix_s", 0.0, 1e11),
    ("built-in.latitude_deg", -80.0, 80.0),
    ("built-in.longitude_deg", -180.0, 180.0),
    ("altimeter.setting_hpa", 940.0, 1_060.0),
    ("altimeter.field_elevation_ft", -1_500.0, 20_000.0),
    ("autopilot.reference_airspeed_kt", 15.0, 600.0),
    ("autopilot.assumed_latency_ms", 0.0, 300.0),
    ("x-plane.local_port", 0.0, 65_535.0),
    ("x-plane.reply_port", 0.0, 65_535.0),
    ("x-plane.data_version", 9.0, 12.0),
    ("x-plane.magnetic_heading_column", 2.0, 7.0),
    ("x-plane.rate_hz", 1.0, 1_000.0),
    ("x-plane.engines", 1.0, 8.0),
    ("x-plane.resubscribe_s", 0.1, 3_600.0),
    ("x-plane.silent_after_ms", 50.0, 60_000.0),
    ("x-plane.datagrams_per_tick", 1.0, 1_000.0),
    ("x-plane.fallback_after_ms", 10.0, 60_000.0),
    ("built-in.altitude_ft", 500.0, 20_000.0),
    ("built-in.ground_ft", -1_500.0, 19_500.0),
    ("built-in.airspeed_kt", 50.0, 160.0),
    ("built-in.heading_deg", 0.0, 360.0),
    ("built-in.wind_from_deg", 0.0, 360.0),
    ("built-in.wind_kt", 0.0, 60.0),
    ("built-in.delay_ms", 0.0, 1_000.0),
    ("built-in.engage_at_s", 1.2, 31_622_400.0),
    ("built-in.engine_stops_at_s", 0.0, 86_400.0),
    ("built-in.alternator_stops_at_s", 0.0, 86_400.0),
    ("built-in.battery_charge_percent", 0.0, 100.0),
    ("built-in.battery_capacity_ah", 0.1, 1_000.0),
    ("built-in.electrical_load_a", 0.0, 60.0),
    ("built-in.seed", 0.0, 9e18),
];

/// The ranges of all numeric keys, and of the numbers in lists.
fn ranges() -> impl Iterator<Item = &'static (&'static str, f64, f64)> {
    RANGES
        .iter()
        .chain(autopilot::ranges())
        .chain(calibration::RANGES.iter().copied().flatten())
        .chain(navigation::RANGES)
        .chain(airframe::RANGES)
        .chain(device::RANGES)
        .chain(servo_board::RANGES)
}

/// Smallest and largest value of a numeric key, such as `plan.wind_kt`.
pub fn range_of(key: &str) -> Option<(f64, f64)> {
    ranges()
        .find(|(name, ..)| *name == key)
        .map(|(_, least, most)| (*least, *most))
}

/// The same of a key of a sensor of this kind.
pub(super) fn range_of_entry(kind: &str, key: &str) -> Option<(f64, f64)> {
    let is_it = |(range, ..): &&(&str, f64, f64)| {
        let (of, name) = range.split_once('.').unwrap_or_default();
        name == key && device::is_of_kind(of, name, kind)
    };
    ranges().find(is_it).map(|(_, least, most)| (*least, *most))
}

/// A range, as messages give it.
pub(super) fn in_words((least, most): (f64, f64)) -> String {
    format!("{} to {}", number(least), number(most))
}

/// All errors in the values of a configuration other than those of the reader.
pub(super) fn check(config: &Config, places: &Places<'_>, unread: &[Problem]) -> Vec<Problem> {
    let mut problems = out_of_range(places);
    problems.retain(|problem| {
        let is_same = |other: &Problem| (other.line, &other.key) == (problem.line, &problem.key);
        !unread.iter().any(is_same)
    });
    // A section that could not be read may be reported as missing: a line that
    // was reported is not reported again.
    let is_read = |line: Option<usize>| match line {
        None => unread.is_empty(),
        line => !unread.iter().any(|problem| problem.line == line),
    };
    let mut others = Vec::new();
    relations::check(config, &mut |keys: &[&str], mut message: String| {
        // A number that is out of its range says nothing about another one.
        let is_out = |problem: &Problem| {
            problem
                .key
                .as_deref()
                .is_some_and(|key| keys.contains(&key))
        };
        if let Some(first) = keys.first().filter(|_| !problems.iter().any(is_out)) {
            // Of two, at the one that the text contains, since that is the one to change.
            let written = match keys {
                [_, other] if !places.has(first) && places.has(other) => other,
                _ => first,
            };
            // One key alone contradicts no other.
            let mut absent = if keys.len() > 1 { keys } else { &[] };
            if let [_, rest @ ..] = absent
                && !places.has(first)
                && message.starts_with("is ")
            {
                // Behind the value, with which the message begins.
                let end = message.find([':', ',']).unwrap_or(message.len());
                message.insert_str(end, " by default, not in the file");
                absent = rest;
            }
            if written != first {
                message = format!("contradicts {first}, which {message}");
            }
            message.push_str(&defaults(config, places, absent));
            others.push(problem_at(places, written, message));
        }
    });
    for (at, section) in config.x_planes() {
        others.extend(x_plane(&at, section, &problems, places));
    }
    others.extend(without_aircraft(config));
    problems.extend(others.into_iter().filter(|problem| is_read(problem.line)));
    problems
}

/// The values of these keys that the text does not contain, for the end of a message.
fn defaults(config: &Config, places: &Places<'_>, keys: &[&str]) -> String {
    let absent = keys.iter().filter(|key| !places.has(key));
    let values = absent.filter_map(|key| Some((key, config.value(key).ok()?)));
    let texts = values.map(|(key, value)| format!("; {key} = {value} by default, not in the file"));
    texts.collect()
}

fn problem_at(places: &Places<'_>, key: &str, message: String) -> Problem {
    Problem {
        line: places.nearest_line(key),
        key: Some(key.to_owned()),
        message,
    }
}

/// The numbers of a text that are out of their range. Read from the text itself:
/// an error in a section or an entry hides no number in it.
fn out_of_range(places: &Places<'_>) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (key, least, most) in ranges() {
        for key in places_of(places, key) {
            let value = places.number(&key);
            if let Some(value) = value.filter(|value| !(*least..=*most).contains(value)) {
                let message = format!("is {}: choose {}", number(value), in_words((*least, *most)));
                problems.push(problem_at(places, &key, message));
            }
        }
    }
    problems
}

/// A configuration without an aircraft, and without lists that stand alone.
fn without_aircraft(config: &Config) -> Option<Problem> {
    let has_simulator = config.x_plane.is_some() || config.built_in.is_some();
    if has_simulator || config.is_without_simulator() {
        return None;
    }
    let moves_nothing = !config.sensor.is_empty()
        && config.actuator.is_none()
        && !config.sensor.iter().any(SensorEntry::is_simulator);
    let message = if moves_nothing {
        "has sensors and no actuator: add actuator = [] above all sections if nothing is to be \
         moved, or the section of the simulator that is to be flown, [x-plane] or [built-in]"
    } else {
        "has neither [x-plane] nor [built-in]: add the section of the aircraft that is to be \
         flown, or list sensors and actuators that need none"
    };
    Some(Problem {
        line: None,
        key: None,
        message: message.to_owned(),
    })
}

/// Errors found by the adapter itself, other than those of ranges.
fn x_plane(
    at: &str,
    section: &XPlaneSection,
    problems: &[Problem],
    places: &Places<'_>,
) -> Option<Problem> {
    let error = XPlaneConfig::from(section).validate().err()?;
    let key = match error {
        XPlaneConfigError::EngageSwitch { .. } | XPlaneConfigError::NoSuchLight { .. } => {
            format!("{at}.engage_switch")
        }
        XPlaneConfigError::Simulator(_) => format!("{at}.simulator"),
        XPlaneConfigError::LocalPort | XPlaneConfigError::OwnPort(_) => format!("{at}.local_port"),
        _ if problems.iter().any(|problem| problem.is_in(at)) => return None,
        _ => at.to_owned(),
    };
    Some(problem_at(places, &key, error.to_string()))
}

/// A key, and that of each sensor of that kind; of a list the
/// place of each entry.
fn places_of(places: &Places<'_>, key: &str) -> Vec<String> {
    let (kind, name) = key.split_once('.').unwrap_or((key, ""));
    let entries = places.value("sensor").and_then(DeValue::as_array);
    let of_kind = (0..entries.map_or(0, |entries| entries.len())).filter(|at| {
        let given = places.value(&format!("sensor[{at}].kind"));
        let given = given.and_then(DeValue::as_str);
        given.is_some_and(|given| device::is_of_kind(kind, name, given))
    });
    let keys = of_kind.map(|at| format!("sensor[{at}].{name}"));
    let keys = std::iter::once(key.to_owned()).chain(keys);
    let entries = |key: String| match places.value(&key).and_then(DeValue::as_array) {
        Some(list) => (0..list.len()).map(|at| format!("{key}[{at}]")).collect(),
        None => vec![key],
    };
    keys.flat_map(entries).collect()
}

#[cfg(test)]
mod tests;
