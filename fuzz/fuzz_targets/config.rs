//! Configurations: any text is read or refused, with each problem and its line;
//! one that was read is written so that it is read again.
#![no_main]

use fcc_flight::config::{Config, ConfigError};

libfuzzer_sys::fuzz_target!(|text: &str| {
    match Config::parse(text, "fuzz") {
        Ok(config) => {
            let _ = config.remarks(text);
            let _ = config.loop_config();
            let _ = config.autopilot_config();
            let again = toml::to_string(&config).expect("what was read can be written");
            let read = Config::parse(&again, "fuzz").expect("what was written can be read");
            assert_eq!(toml::to_string(&read).expect("as before"), again);
        }
        Err(ConfigError::Invalid { problems, .. }) => {
            assert!(!problems.is_empty());
            let lines = text.lines().count().max(1) + 1;
            assert!(problems.iter().all(|problem| problem.line.is_none_or(|line| line <= lines)));
        }
        Err(_) => {}
    }
});
