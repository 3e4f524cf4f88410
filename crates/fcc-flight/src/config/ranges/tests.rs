use super::*;
use crate::config::BuiltInSection;

fn check(config: &Config) -> Vec<Problem> {
    let text = config.to_toml().unwrap();
    super::check(config, &super::super::read::read(&text).places, &[])
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
