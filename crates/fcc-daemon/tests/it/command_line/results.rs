//! What results say, and in which form.

use serde_json::Value;

use super::{fccd, fly};

#[test]
fn a_flight_that_is_not_engaged_says_why_at_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let slow = "[built-in]\nairspeed_kt = 60.0\nengage_at_s = 1.2\n";
    std::fs::write(folder.path().join("slow.toml"), slow).unwrap();
    let words = [
        "fly",
        "--config",
        "slow.toml",
        "--lockstep",
        "--json",
        "--quiet",
    ];
    let ended = fccd(folder.path(), &words).output().unwrap();
    let found: Value = serde_json::from_slice(&ended.stdout).unwrap();
    let ending = found["ending"].as_str().unwrap();
    assert_eq!(
        ending,
        "not engaged: airspeed is below the floor: fly faster than envelope.min_airspeed_kt; \
         a take-off begins standing, where its runway begins"
    );
    // No command ended its pattern.
    assert_eq!(found["not_scored"], "the autopilot was never engaged");
}

/// A terminal has 80 columns; a landing gear withstands 10 ft/s, 600 ft/min (14 CFR 23.473).
#[test]
fn a_flown_plan_is_told_in_80_columns_and_with_its_touch_down() {
    let folder = tempfile::tempdir().unwrap();
    let plan = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../config/plans/circuit.waypoints"
    );
    let words = ["fly", "--lockstep", "--no-recording", "--plan", plan];
    let ended = fccd(folder.path(), &words).output().unwrap();
    assert_eq!(ended.status.code(), Some(0));
    let said = String::from_utf8(ended.stderr).unwrap();
    let engaged: Vec<&str> = said.lines().filter(|line| line.contains("→")).collect();
    assert!(engaged.len() > 100, "{said}");
    for line in engaged {
        assert!(line.chars().count() <= 80, "{line}");
    }
    let text = String::from_utf8(ended.stdout).unwrap();
    assert!(text.contains("Items of the flight plan:\n"), "{text}");
    let (_, touched) = text.split_once("\nTouched down at ").unwrap();
    let sink = touched.split(' ').nth(2).unwrap();
    assert!((1.0..600.0).contains(&sink.parse().unwrap()), "{touched}");
    let json = fccd(folder.path(), &[&words[..], &["--json"]].concat())
        .output()
        .unwrap();
    let json: Value = serde_json::from_slice(&json.stdout).unwrap();
    let sink = json["flown_plan"]["touch_down"]["sink_fpm"].as_f64();
    assert!((1.0..600.0).contains(&sink.unwrap()));
}

/// A flight that touches the ground ends there, with a code of its own; its
/// recording is whole and its report shows the impact.
#[test]
fn a_flight_that_ends_on_the_ground_has_an_exit_code_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let low = "[built-in]\naltitude_ft = 1000.0\nground_ft = 995.0\ngusts = \"severe\"\nseed = \
               3\n[guidance]\nmode = \"hold\"\n";
    std::fs::write(folder.path().join("low.toml"), low).unwrap();
    let words = [
        "fly",
        "--config",
        "low.toml",
        "--lockstep",
        "--json",
        "--quiet",
        "--recordings",
        ".",
    ];
    let ended = fccd(folder.path(), &words).output().unwrap();
    assert_eq!(ended.status.code(), Some(16));
    let found: Value = serde_json::from_slice(&ended.stdout).unwrap();
    let impact = &found["impact"];
    // Its wheels are 1.35 m, or 4.4 ft, below it.
    let above_ft = impact["altitude_ft"].as_f64().unwrap() - 995.0;
    assert!((-1.0..5.5).contains(&above_ft), "{above_ft}");
    assert!(impact["sink_rate_fpm"].as_f64().unwrap() > 100.0);
    assert!((60.0..130.0).contains(&impact["airspeed_kt"].as_f64().unwrap()));
    let at_s = impact["time_s"].as_f64().unwrap();
    // Engaged after 2 s.
    assert!((2.0..60.0).contains(&at_s), "{at_s}");
    let ending = found["ending"].as_str().unwrap();
    assert!(
        ending.starts_with("the aircraft hit the ground"),
        "{ending}"
    );
    let file = found["recording"]["files"][0].as_str().unwrap();
    let report = fccd(folder.path(), &["report", file]).output().unwrap();
    assert_eq!(report.status.code(), Some(0));
    let report = String::from_utf8(report.stdout).unwrap();
    assert!(report.contains("the aircraft hit the ground"), "{report}");
}

/// A terminal obeys escape sequences, wherever they come from.
#[test]
fn control_characters_in_names_are_escaped() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("a\x1b[31m.toml"),
        "\"b\\u001b[32m\" = 1\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("c\x1b[33m\nd.mcap"), "").unwrap();
    for words in [&["check", "a\x1b[31m.toml"][..], &["list", "."]] {
        let ended = fccd(folder.path(), words).output().unwrap();
        let said = [ended.stdout, ended.stderr].concat();
        assert!(!said.contains(&0x1b), "{}", said.escape_ascii());
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains("\\u{1b}[3"), "{said}");
        assert!(
            said.lines().all(|line| !line.starts_with("d.mcap")),
            "{said}"
        );
    }
}

/// Also in JSON, which remains JSON, and in the parser's own messages.
#[test]
fn neither_c1_nor_the_direction_of_writing_reaches_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("c.toml");
    let (csi, reversed) = ('\u{9b}', '\u{202e}');
    std::fs::write(&file, format!("\"b{csi}32m\" = 1\n\"c{reversed}\" = 1\n")).unwrap();
    let hostile = format!("x{csi}31m\x1b[31m{reversed}");
    for words in [
        &["check", "c.toml"][..],
        &["check", "c.toml", "--json"],
        &["check", "c.toml", &hostile],
        &["check", &hostile, "--json"],
    ] {
        let ended = fccd(folder.path(), words).output().unwrap();
        let said = String::from_utf8([ended.stdout.clone(), ended.stderr].concat()).unwrap();
        let obeyed = |c: char| c.is_control() && c != '\n' || c == reversed;
        assert!(!said.contains(obeyed), "{}", said.escape_default());
        assert!(said.contains("202e"), "{said}");
        if words.contains(&"--json") {
            let found: Value = serde_json::from_slice(&ended.stdout).unwrap();
            let problems = found["problems"].as_array().unwrap();
            let keys: Vec<_> = problems
                .iter()
                .map(|problem| problem["key"].as_str())
                .collect();
            if words[1] == "c.toml" {
                let given = [format!("b{csi}32m"), format!("c{reversed}")];
                assert_eq!(keys, given.each_ref().map(|key| Some(key.as_str())));
            }
        }
    }
}

/// As docs/commands.md says: the key `error`, the text of standard error, and the exit
/// codes of `fccd --help`.
#[test]
fn every_command_reports_an_error_as_json() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wrong.toml"), "[lop]\n").unwrap();
    let instance = format!("json-{}", std::process::id());
    for (words, exit) in [
        (&["fly", "--config", "wrong.toml"][..], 2),
        (&["report", "none.mcap", "--html", "-"], 2),
        (&["fly", "--seconds", "-1"], 2),
        (&["run", "--config", "wrong.toml"], 2),
        (&["run"], 2),
        (&["list", "none"], 2),
        (&["recover", "none.mcap"], 2),
        (&["timing", "--rate", "0"], 2),
        (&["replay", "none.mcap"], 2),
        (&["top", "--instance", &instance], 1),
        (&["command", "engage", "--instance", &instance], 1),
        (&["command", "set", "--altitude-ft", "1e6"], 2),
        (&["doctor", "--config", "wrong.toml"], 2),
        (&["report", "none.mcap"], 2),
        (&["x-plane", "check", "--config", "wrong.toml"], 2),
        (&["x-plane", "identify", "--config", "wrong.toml"], 2),
    ] {
        let ended = fccd(folder.path(), words).arg("--json").output().unwrap();
        assert_eq!(ended.status.code(), Some(exit), "{words:?}");
        let printed: Value = serde_json::from_slice(&ended.stdout).unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        // A refused command's object has the same keys as one carried out.
        let error = printed.get("error").or(printed.get("why"));
        let error = error.and_then(Value::as_str).unwrap();
        assert!(said.is_empty() || said.contains(error), "{said}{error}");
    }
}

/// The two results whose form does not depend on success.
#[test]
fn the_forms_of_check_and_command_are_those_of_the_documents() {
    let page = include_str!("../../../../../docs/commands.md");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wrong.toml"), "[lop]\n").unwrap();
    let instance = format!("form-{}", std::process::id());
    for words in [
        &["check", "wrong.toml"][..],
        &["command", "stop", "--instance", &instance],
    ] {
        let ended = fccd(folder.path(), words).arg("--json").output().unwrap();
        assert!(ended.stderr.is_empty(), "{words:?}");
        let printed: Value = serde_json::from_slice(&ended.stdout).unwrap();
        let names = printed.as_object().unwrap().keys();
        let names: Vec<_> = names.map(|name| format!("\"{name}\"")).collect();
        let described = page.split(['{', '}']).any(|form| {
            form.split(", ").count() == names.len() && names.iter().all(|name| form.contains(name))
        });
        assert!(described, "{words:?}: {names:?}");
    }
}

/// The report, and the same as JSON beside it, are two files, and neither is
/// the configuration.
#[test]
fn a_report_overwrites_neither_the_configuration_nor_itself() {
    let folder = tempfile::tempdir().unwrap();
    for config in ["fly.toml", "fly.json"] {
        std::fs::write(folder.path().join(config), "[x-plane]\n").unwrap();
    }
    std::os::unix::fs::symlink("fly.toml", folder.path().join("link.md")).unwrap();
    for (config, report, why) in [
        ("fly.toml", "fly.toml", "overwrite the configuration"),
        ("fly.toml", "./fly.toml", "overwrite the configuration"),
        ("fly.toml", "link.md", "overwrite the configuration"),
        // The report as JSON.
        ("fly.json", "fly.md", "overwrite the configuration"),
        ("fly.toml", "x.json", "a name of its own"),
        ("fly.toml", "x.files", "a name of its own"),
    ] {
        let words = ["x-plane", "check", "--yes", "--config", config, "--report"];
        let ended = fccd(folder.path(), &words).arg(report).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(2), "{report}: {said}");
        assert!(said.contains(why), "{report}: {said}");
        let kept = std::fs::read_to_string(folder.path().join(config)).unwrap();
        assert_eq!(kept, "[x-plane]\n", "{report}");
    }
}

#[test]
fn a_list_as_json_contains_files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    let recordings = folder.path().join("recordings");
    std::fs::write(recordings.join("0.mcap"), "no recording").unwrap();
    let ended = fccd(folder.path(), &["list", "--json"]).output().unwrap();
    assert_eq!(ended.status.code(), Some(13));
    let listed: Value = serde_json::from_slice(&ended.stdout).unwrap();
    assert_eq!(listed[0]["path"], "recordings/0.mcap");
    let error = listed[0]["error"].as_str().unwrap();
    assert!(error.contains("not a recording of fccd"), "{error}");
    assert_eq!(listed[1]["file"], "whole");
}

/// A name need not be UTF-8.
#[test]
fn any_name_of_a_file_is_printed_as_json() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    let recordings = folder.path().join("recordings");
    let flown = fcc_record::files(&recordings).unwrap().remove(0);
    let name = std::ffi::OsStr::from_bytes(b"f\xff.mcap");
    std::fs::rename(flown, recordings.join(name)).unwrap();
    let listed = fccd(&recordings, &["list", ".", "--json"])
        .output()
        .unwrap();
    let recovered = fccd(&recordings, &["recover", "--json"])
        .arg(name)
        .output()
        .unwrap();
    for ended in [listed, recovered] {
        assert!(ended.status.success(), "{ended:?}");
        let json = String::from_utf8(ended.stdout).unwrap();
        assert!(json.contains("f\u{fffd}.mcap"), "{json}");
    }
}

/// Exit code 12 of `fccd --help`.
#[test]
fn a_check_against_x_plane_does_not_begin_on_another_programs_port() {
    let other = std::net::UdpSocket::bind(("0.0.0.0", 0)).unwrap();
    let port = other.local_addr().unwrap().port();
    let folder = tempfile::tempdir().unwrap();
    let text = format!("[x-plane]\nlocal_port = {port}\n");
    std::fs::write(folder.path().join("x.toml"), text).unwrap();
    let port = port.to_string();
    for (by, words) in [
        (
            ["--config", "x.toml"],
            "fccd cannot receive on x-plane.local_port, ",
        ),
        (["--local-port", &port], "cannot receive on UDP port "),
    ] {
        let check = fccd(folder.path(), &["x-plane", "check", "--yes"])
            .args(by)
            .output()
            .unwrap();
        let said = String::from_utf8(check.stderr).unwrap();
        assert!(said.contains(&format!("{words}{port}: ")), "{said}");
        assert_eq!(check.status.code(), Some(12), "{said}");
    }
}
