use fcc_core::flight::navigation::LearnedAirframe;
use fcc_linux::chip::ChipKind;

use super::*;
use crate::config::{BudgetSection, BuiltInSection, CpuChoice, ServoBoardSection};

fn check(config: &Config) -> Vec<Problem> {
    let text = config.to_toml().unwrap();
    super::check(config, &super::super::read::read(&text).places, &[])
}

/// A new key without a range would accept any value.
#[test]
fn every_number_has_a_range() {
    let mut config = Config {
        x_plane: Some(XPlaneSection::default()),
        built_in: Some(BuiltInSection::default()),
        servo_board: Some(ServoBoardSection::default()),
        ..Config::default()
    };
    config.realtime.cpu = Some(CpuChoice::Number(1));
    if let Some(section) = &mut config.built_in {
        section.calibration.gnss.delay_ms = 1.0;
        section.engage_at_s = Some(2.0);
        section.engine_stops_at_s = Some(60.0);
        section.alternator_stops_at_s = Some(60.0);
    }
    config.engage.stick_takeover = Some(0.3);
    config.autopilot.airframe = Some(
        LearnedAirframe {
            axial_offset: 0.0,
            full_thrust_ratio: 0.3,
            zero_lift_angle_rad: 0.0,
            one_g_angle_rad: 0.05,
        }
        .into(),
    );
    config.realtime.cpu_dma_latency_us = Some(0);
    let us = Some(1);
    config.budget = BudgetSection {
        tick_us: us,
        sensors_us: us,
        estimate_us: us,
        guide_us: us,
        control_us: us,
        actuators_us: us,
        failsafe_after: us,
    };
    let values = toml::Value::try_from(&config).unwrap();
    let mut missing = Vec::new();
    walk("", &values, &mut missing);
    assert!(missing.is_empty(), "without a range: {missing:?}");
}

/// The same for the sensors of a board.
#[test]
fn every_number_of_a_sensor_has_a_range() {
    let lines = ["gnss-serial", "gpsd", "rc-receiver", "gpio-switch"];
    for kind in ["iio", "phone"]
        .into_iter()
        .chain(ChipKind::ALL.map(ChipKind::key))
        .chain(lines)
    {
        let keys = match kind {
            "ms4525do" => "rate_hz = 20\nrange_psi = 1\n",
            "iio" => "rate_hz = 20\ndevice = \"mpu6050\"\n",
            "gnss-serial" | "rc-receiver" => "path = \"/dev/ttyS0\"\n",
            "gpsd" | "phone" => "",
            "gpio-switch" => "line = 17\n",
            _ => "rate_hz = 20\n",
        };
        let calibration = match kind {
            "rc-receiver" | "gpio-switch" => "",
            _ => "[sensor.calibration.gnss]\ndelay_ms = 1\n",
        };
        let text = format!("[built-in]\n[[sensor]]\nkind = \"{kind}\"\n{keys}{calibration}");
        let config = Config::parse(&text, "test").unwrap();
        let mut missing = Vec::new();
        walk(
            "",
            &toml::Value::try_from(&config.sensor[0]).unwrap(),
            &mut missing,
        );
        missing.retain(|key| {
            let is_it = |(range, ..): &&(&str, f64, f64)| {
                let (of, name) = range.split_once('.').unwrap_or_default();
                name == key && device::is_of_kind(of, name, kind)
            };
            !ranges().any(|range| is_it(&range)) && key != "address"
        });
        assert!(missing.is_empty(), "{kind} without a range: {missing:?}");
    }
}

fn walk(prefix: &str, value: &toml::Value, missing: &mut Vec<String>) {
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let separator = if prefix.is_empty() { "" } else { "." };
                walk(&format!("{prefix}{separator}{name}"), value, missing);
            }
        }
        toml::Value::Array(list) if !list.is_empty() => walk(prefix, &list[0], missing),
        toml::Value::Float(_) | toml::Value::Integer(_)
            if !ranges().any(|(key, ..)| *key == prefix) =>
        {
            missing.push(prefix.to_owned());
        }
        _ => {}
    }
}

#[test]
fn a_watchdog_has_a_priority_above_the_loop() {
    let mut config = Config {
        built_in: Some(BuiltInSection::default()),
        ..Config::default()
    };
    config.realtime.priority = 99;
    let [problem] = &check(&config)[..] else {
        panic!("one problem");
    };
    assert!(
        problem.message.contains("at most 98"),
        "{}",
        problem.message
    );
    config.watchdog.enabled = false;
    assert_eq!(check(&config), Vec::new());
}

/// The numbers are in their ranges, and the aircraft cannot fly by them: the
/// engine does not suffice.
#[test]
fn the_built_in_aircraft_begins_where_it_can_fly_level() {
    let problems = |altitude_ft, airspeed_kt| {
        let config = Config {
            built_in: Some(BuiltInSection {
                altitude_ft,
                airspeed_kt,
                ..BuiltInSection::default()
            }),
            ..Config::default()
        };
        let found = check(&config);
        let texts = found.into_iter().map(|problem| {
            assert_eq!(problem.key.as_deref(), Some("built-in.airspeed_kt"));
            problem.message
        });
        texts.collect::<Vec<_>>()
    };
    for (altitude_ft, airspeed_kt, word) in [
        (
            12_000.0,
            100.0,
            "at 12000 ft level flight takes a throttle of",
        ),
        (3_000.0, 134.0, "is 134: at 3000 ft level flight takes"),
        (3_000.0, 170.0, "is 170: choose 50 to 160"),
    ] {
        let [problem] = &problems(altitude_ft, airspeed_kt)[..] else {
            panic!("one problem at {altitude_ft} ft, {airspeed_kt} kt");
        };
        assert!(problem.contains(word), "{problem}");
    }
    for (altitude_ft, airspeed_kt) in [(3_000.0, 110.0), (8_000.0, 100.0)] {
        assert!(problems(altitude_ft, airspeed_kt).is_empty());
    }
}

#[test]
fn the_defaults_are_in_range() {
    let config = Config {
        built_in: Some(BuiltInSection::default()),
        ..Config::default()
    };
    assert_eq!(check(&config), Vec::new());
}
