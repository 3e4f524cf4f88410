//! The commented examples say what is so: with every comment sign before a key
//! taken away, they are the defaults.
#![cfg(test)]

use fcc_flight::config::{
    BudgetSection, BuiltInSection, ChipSection, Config, CpuChoice, DeviceEntry, IioSection,
    SensorEntry, ServoBoardSection, XPlaneSection,
};
use fcc_linux::chip::ChipKind;

const BUILT_IN: &str = include_str!("../../../config/built-in.toml");
const BOARD: &str = include_str!("../../../config/board.toml");
const X_PLANE: &str = include_str!("../../../config/x-plane.toml");
const SERVO_BOARD: &str = include_str!("../../../config/servo-board.toml");

/// `#key = value` becomes `key = value`; what begins with `# ` is prose.
fn uncommented(text: &str) -> String {
    text.lines()
        .map(|line| match line.strip_prefix('#') {
            Some(rest) if !rest.starts_with(' ') && rest.contains(" = ") => rest,
            _ => line,
        })
        .collect::<Vec<_>>()
        .join("\n")
}

/// What is only said where there is a choice to make. Of the budgets, the
/// tick's and how many are failsafe are what they would be at 40 Hz.
fn write_the_choices(config: &mut Config) {
    config.realtime.cpu = Some(CpuChoice::Number(3));
    config.realtime.cpu_dma_latency_us = Some(0);
    config.engage.stick_takeover = Some(0.3);
    config.restart.state_file = Some("recordings/fccd.flight".into());
    config.rights.user = Some("fccd".to_owned());
    config.altimeter.field_elevation_ft = Some(723.0);
    config.budget = BudgetSection {
        tick_us: Some(25_000),
        sensors_us: Some(5_000),
        estimate_us: Some(1_000),
        guide_us: Some(1_000),
        control_us: Some(1_000),
        actuators_us: Some(5_000),
        failsafe_after: Some(20),
    };
}

fn as_value(config: &Config) -> toml::Value {
    toml::Value::try_from(config).unwrap()
}

#[test]
fn the_servo_boards_example_contains_every_default() {
    Config::parse(SERVO_BOARD, "servo-board.toml").unwrap();
    // With the address, there is no serial line.
    let full = uncommented(&SERVO_BOARD.replace("serial =", "# serial ="));
    let full = Config::parse(&full, "servo-board.toml").unwrap();
    let expected = ServoBoardSection {
        address: Some("192.168.4.1".parse().unwrap()),
        ..ServoBoardSection::default()
    };
    let values = |section| toml::Value::try_from(section).unwrap();
    assert_eq!(values(full.servo_board.unwrap()), values(expected));
}

#[test]
fn the_built_in_example_contains_every_default() {
    let mut expected = Config {
        built_in: Some(BuiltInSection::default()),
        ..Config::default()
    };
    if let Some(section) = &mut expected.built_in {
        section.engage_at_s = Some(2.0);
    }
    expected.navigation.magnetic_field_ut = Some([21.1, 0.0, 45.3]);
    expected.calibration.file = Some("recordings/fccd.calibration.toml".into());
    write_the_choices(&mut expected);
    let full = Config::parse(&uncommented(BUILT_IN), "built-in.toml").unwrap();
    assert_eq!(as_value(&full), as_value(&expected));
    let keys = uncommented(BUILT_IN)
        .lines()
        .filter(|line| !line.starts_with('#') && line.contains(" = "))
        .count();
    let leaves = leaves(&as_value(&expected));
    assert_eq!(keys, leaves, "a key of the configuration is not explained");
}

#[test]
fn the_x_plane_example_contains_every_default() {
    let mut expected = Config {
        x_plane: Some(XPlaneSection::default()),
        ..Config::default()
    };
    write_the_choices(&mut expected);
    let full = Config::parse(&uncommented(X_PLANE), "x-plane.toml").unwrap();
    assert_eq!(as_value(&full), as_value(&expected));
}

#[test]
fn the_examples_as_they_stand_are_good() {
    for text in [BUILT_IN, X_PLANE] {
        Config::parse(text, "example").unwrap();
    }
}

fn leaves(value: &toml::Value) -> usize {
    match value {
        toml::Value::Table(table) => table.values().map(leaves).sum(),
        _ => 1,
    }
}

/// Every key of a board's sensors is explained, with its default.
#[test]
fn the_example_of_a_board_is_a_configuration() {
    let config = Config::parse(BOARD, "board.toml").unwrap();
    let kinds: Vec<_> = config
        .sensor
        .iter()
        .filter_map(SensorEntry::device)
        .filter(|device| device.is_board())
        .collect();
    let [DeviceEntry::Chip(imu), _, DeviceEntry::Chip(section), _] = kinds[..] else {
        panic!("{kinds:?}");
    };
    let usual = ChipSection::default();
    let kind = imu.kind;
    assert_eq!((kind, kind.rate_hz()), (ChipKind::Icm42688, 200.0));
    assert_eq!(imu.silent_after_ms, usual.silent_after_ms);
    let i2c = usual.to_linux().wiring.to_string();
    assert_eq!(i2c, "/dev/i2c-1, address 0x68");
    assert_eq!(section.to_linux().range_psi, 1.0);
    let written = [
        format!("#rate_hz = {:.1} ", kind.rate_hz()),
        format!("#silent_after_ms = {}\n", usual.silent_after_ms),
        format!("#fallback_after_ms = {}\n", usual.fallback_after_ms),
        "#i2c = \"/dev/i2c-1\"\n#address = 0x68\n".to_owned(),
        format!("#   rate_hz = {:.1}\n", IioSection::default().rate_hz),
    ];
    for line in written {
        assert!(BOARD.contains(&line), "{line}");
    }
}
