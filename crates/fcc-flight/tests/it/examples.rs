//! The commented examples say what is so: with every comment sign before a key
//! taken away, they are the defaults.

use fcc_flight::config::{
    BudgetSection, BuiltInSection, ChipSection, Config, CpuChoice, DeviceEntry, IioSection,
    SensorEntry, ServoBoardSection, XPlaneSection,
};
use fcc_linux::chip::ChipKind;

const BUILT_IN: &str = include_str!("../../../../config/built-in.toml");
const BOARD: &str = include_str!("../../../../config/board.toml");
const X_PLANE: &str = include_str!("../../../../config/x-plane.toml");
const APP: &str = include_str!("../../../../android/app/src/main/res/raw/example_built_in.toml");
const SERVO_BOARD: &str = include_str!("../../../../config/servo-board.toml");

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
        "#i2c = \"/dev/i2c-1\" ".to_owned(),
        "#address = 0x68 ".to_owned(),
        format!("#   rate_hz = {:.1}\n", IioSection::default().rate_hz),
    ];
    for line in written {
        assert!(BOARD.contains(&line), "{line}");
    }
}

/// What a user takes the comment sign away from: a key, or a table with its keys.
fn commented(text: &str) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = Vec::new();
    let mut is_in_table = false;
    for (at, line) in text.lines().enumerate() {
        let is_example = line.starts_with("#   ") && !line.starts_with("#    ");
        let rest = line.trim_start_matches(['#', ' ']);
        let key = rest.split_once(" = ").map_or("", |(key, _)| key);
        let is_key = !key.is_empty() && !key.contains(' ');
        let is_commented = is_example || (line.starts_with('#') && !line.starts_with("# "));
        if is_example && is_in_table && (is_key || rest.starts_with('[')) {
            if rest.starts_with("[[sensor]]") || rest.starts_with("[[actuator]]") {
                found.push(Vec::new());
            }
            found.last_mut().unwrap().push(at);
        } else if is_commented && (is_key || rest.starts_with('[')) {
            is_in_table = rest.starts_with('[');
            found.push(vec![at]);
        } else {
            is_in_table = false;
        }
    }
    found
}

/// The text without these comment signs, and with one before what they are "instead of".
fn changed(text: &str, commented: &[usize]) -> String {
    let lines: Vec<_> = text.lines().collect();
    let uncommented = commented.iter().map(|at| lines[*at]);
    let instead = uncommented.filter_map(|line| line.split_once("# instead of "));
    let instead: Vec<_> = instead
        .filter_map(|(_, key)| key.split([' ', ';']).next())
        .map(|key| format!("{key} = "))
        .collect();
    let changed = lines.iter().enumerate().map(|(at, line)| {
        if commented.contains(&at) {
            line.trim_start_matches(['#', ' ']).to_owned()
        } else if instead.iter().any(|key| line.starts_with(key)) {
            format!("#{line}")
        } else {
            (*line).to_owned()
        }
    });
    changed.collect::<Vec<_>>().join("\n")
}

/// Three stood above their section's header, and were keys of the one before.
#[test]
fn each_commented_line_is_valid_where_it_stands() {
    for (name, text, least) in [
        ("built-in.toml", BUILT_IN, 200),
        ("x-plane.toml", X_PLANE, 70),
        ("servo-board.toml", SERVO_BOARD, 8),
        ("board.toml", BOARD, 12),
        ("example_built_in.toml", APP, 3),
    ] {
        let commented = commented(text);
        assert!(commented.len() >= least, "{name}: {}", commented.len());
        for lines in commented {
            if let Err(error) = Config::parse(&changed(text, &lines), name) {
                panic!("{error}");
            }
        }
    }
}

/// The same name is a key of the simulated battery, which nothing watches.
#[test]
fn the_limit_of_the_battery_is_one_of_the_contingencies() {
    let text = BUILT_IN.replace("#   battery_charge_percent", "battery_charge_percent");
    let config = Config::parse(&text, "built-in.toml").unwrap();
    assert_eq!(config.contingency.battery_charge_percent, Some(25.0));
    let misplaced = "[built-in]\n[terrain]\nbattery_charge_percent = 25.0\n";
    let message = Config::parse(misplaced, "f").unwrap_err().to_string();
    assert!(
        message
            .contains("`built-in.battery_charge_percent` or `contingency.battery_charge_percent`"),
        "{message}"
    );
}
