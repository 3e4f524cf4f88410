//! `fccd check-controls` with the built-in aircraft, and nobody at the terminal.

use std::process::Stdio;

use super::fccd;

/// The exit code, standard output and standard error of a check with this configuration.
fn check(config: &str, words: &[&str]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my.toml"), config).unwrap();
    let done = fccd(folder.path(), &["check-controls", "my.toml"])
        .args(words)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (done.status.code(), text(done.stdout), text(done.stderr))
}

#[test]
fn each_control_is_a_row() {
    let (code, table, _) = check("[built-in]\non_runway = true\n", &["--throttle"]);
    assert_eq!(code, Some(0), "{table}");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 8, "{table}");
    assert!(rows[0].starts_with("control") && rows[0].ends_with("result"));
    assert_eq!(
        rows[1],
        "elevator    +0.3, +1.0    +0.30, +1.00  -          ok"
    );
    assert!(rows[7].starts_with("throttle    +0.3, +1.0"));
}

#[test]
fn an_aircraft_in_flight_is_refused() {
    let (code, json, message) = check("[built-in]\n", &["--json"]);
    assert_eq!(code, Some(20));
    assert!(json.contains("\"error\": \"the aircraft moves"), "{json}");
    assert!(
        message.contains("kt): controls are checked standing still"),
        "{message}"
    );
}

#[test]
fn without_an_actuator_there_is_nothing_to_check() {
    let (code, _, message) = check("actuator = []\n[built-in]\non_runway = true\n", &[]);
    assert_eq!(code, Some(2));
    assert!(message.contains("drives no control"), "{message}");
}
