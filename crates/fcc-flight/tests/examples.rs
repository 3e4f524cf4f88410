//! The commented examples say what is so: with every comment sign before a key
//! taken away, they are the defaults.
#![cfg(test)]

use fcc_flight::config::{BudgetSection, BuiltInSection, Config, CpuChoice, XPlaneSection};

const BUILT_IN: &str = include_str!("../../../config/built-in.toml");
const X_PLANE: &str = include_str!("../../../config/x-plane.toml");

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
fn the_built_in_example_contains_every_default() {
    let mut expected = Config {
        built_in: Some(BuiltInSection::default()),
        ..Config::default()
    };
    expected.navigation.magnetic_field_ut = Some([21.1, 0.0, 45.3]);
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
