//! `fccd calibrate` of the built-in aircraft's raw sensors, in simulated hands.

use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};

use super::fccd;

const CONFIG: &str = "[built-in]\nraw_sensors = \"phone\"\n\
                      [navigation]\nmethod = \"kalman\"\n";

fn with_config(folder: &Path, more: &str) {
    fs::write(folder.join("raw.toml"), format!("{CONFIG}{more}")).unwrap();
}

fn calibrate(folder: &Path, words: &[&str]) -> Output {
    let all = [&["calibrate"], words, &["raw.toml", "--lockstep"]].concat();
    fccd(folder, &all).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const FILE: &str = "recordings/fccd.calibration.toml";

/// In the order in which they are best done; then they are flown, and the
/// recording has them.
#[test]
fn all_kinds_are_found_stored_and_flown() {
    let folder = tempfile::tempdir().unwrap();
    with_config(folder.path(), "");
    for kind in [
        "accelerometer",
        "gyroscope",
        "mounting",
        "magnetometer",
        "airspeed",
    ] {
        let done = calibrate(folder.path(), &[kind]);
        assert!(done.status.success(), "{kind}: {}", said(&done));
        let printed = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(
            printed.contains("stored in recordings/fccd.calibration.toml"),
            "{printed}"
        );
    }
    let stored = fs::read_to_string(folder.path().join(FILE)).unwrap();
    assert!(stored.starts_with("# fccd-calibration 1 "), "{stored}");
    let table: toml::Table = stored.parse().unwrap();
    let entries = table["calibration"].as_array().unwrap();
    assert_eq!(entries.len(), 5, "{stored}");
    assert!(
        folder
            .path()
            .join("recordings/fccd.calibration.old.toml")
            .exists()
    );
    let words = [
        "fly",
        "--config",
        "raw.toml",
        "--lockstep",
        "--seconds",
        "20",
        "--quiet",
    ];
    let flown = fccd(folder.path(), &words).output().unwrap();
    assert!(flown.status.success(), "{}", said(&flown));
    assert!(
        said(&flown).contains("calibrated by recordings/fccd.calibration.toml: accelerometer of")
    );
    // The recording has the configuration in full: it replays without the file.
    fs::remove_file(folder.path().join(FILE)).unwrap();
    let recording = fs::read_dir(folder.path().join("recordings")).unwrap();
    let recording = recording
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|of| of == "mcap"))
        .unwrap();
    let words = ["replay", recording.to_str().unwrap()];
    let replayed = fccd(folder.path(), &words).output().unwrap();
    assert!(replayed.status.success(), "{}", said(&replayed));
}

#[test]
fn poor_handling_is_refused_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // As if its accelerometer had been calibrated and mounted.
    let given = "[built-in.calibration.accelerometer]\nbias_mps2 = [1.25, 1.23, 0.18]\n\
                 rotation_deg = [-0.6, 0.5, 0.0]\n";
    with_config(folder.path(), given);
    for (kind, fault, expected) in [
        ("accelerometer", "ends-early", "of 12 are there"),
        ("gyroscope", "restless", "while it was to lie still"),
        ("gyroscope", "one-axis", "1 of 3 are there"),
        (
            "magnetometer",
            "magnet",
            "by which the samples have one strength",
        ),
    ] {
        let refused = calibrate(folder.path(), &[kind, "--fault", fault]);
        assert_eq!(
            refused.status.code(),
            Some(18),
            "{kind}: {}",
            said(&refused)
        );
        assert!(said(&refused).contains(expected), "{}", said(&refused));
        assert!(said(&refused).contains("Nothing was changed"));
    }
    let words = ["gyroscope", "--bias-only", "--dry-run", "--json"];
    let tried = calibrate(folder.path(), &words);
    assert!(tried.status.success(), "{}", said(&tried));
    let found: serde_json::Value = serde_json::from_slice(&tried.stdout).unwrap();
    assert!(
        found["file"].is_null() && found["found"]["unit"] == "°/s",
        "{found}"
    );
    assert!(!folder.path().join(FILE).exists());
}

/// The bias alone keeps scale and misalignment that were found before.
#[test]
fn a_bias_alone_keeps_what_turning_found() {
    let folder = tempfile::tempdir().unwrap();
    with_config(folder.path(), "");
    assert!(
        calibrate(folder.path(), &["accelerometer"])
            .status
            .success()
    );
    let found = |words: &[&str]| {
        let done = calibrate(folder.path(), &[words, &["--json"]].concat());
        assert!(done.status.success(), "{}", said(&done));
        let printed: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
        let found = &printed["found"];
        (found["unit"].clone(), found["keys"]["gyroscope"].clone())
    };
    let (unit, turned) = found(&["gyroscope"]);
    assert_eq!(unit, "%");
    let (unit, alone) = found(&["gyroscope", "--bias-only"]);
    assert_eq!(unit, "°/s");
    for key in ["scale", "misalignment"] {
        assert!(
            turned[key].is_array() && turned[key] == alone[key],
            "{key}: {alone}"
        );
    }
    assert!(alone["bias_degps"].is_array());
}

#[test]
fn a_damaged_file_and_another_sensors_are_not_used() {
    let folder = tempfile::tempdir().unwrap();
    with_config(folder.path(), "");
    let words = ["gyroscope", "--bias-only"];
    assert!(calibrate(folder.path(), &words).status.success());
    let fly = |more: &[&str]| {
        let words = [
            "fly",
            "--config",
            "raw.toml",
            "--lockstep",
            "--seconds",
            "1",
            "--quiet",
        ];
        fccd(folder.path(), &[&words, more].concat())
            .output()
            .unwrap()
    };
    let other = fly(&["--seed", "2"]);
    assert!(other.status.success());
    let expected = "not used: it was made for simulated phone, seed 1, and here is simulated \
                    phone, seed 2";
    assert!(said(&other).contains(expected), "{}", said(&other));
    let path = folder.path().join(FILE);
    let good = fs::read_to_string(&path).unwrap();
    fs::write(&path, good.replace("unix_s = 1", "unix_s = 2")).unwrap();
    let check = || {
        let words = ["check", "raw.toml"];
        fccd(folder.path(), &words).output().unwrap()
    };
    for refused in [fly(&[]), calibrate(folder.path(), &["airspeed"]), check()] {
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        // There is no copy of a first one.
        let expected = "is damaged, or was edited: remove it and calibrate again";
        assert!(said(&refused).contains(expected), "{}", said(&refused));
    }
    // A folder in its place cannot be read.
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    for refused in [fly(&[]), calibrate(folder.path(), &["airspeed"])] {
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        assert!(
            said(&refused).contains("cannot be read"),
            "{}",
            said(&refused)
        );
    }
    with_config(folder.path(), "[calibration]\nenabled = false\n");
    let without = fly(&[]);
    assert!(without.status.success() && !said(&without).contains("calibrat"));
}

#[test]
fn a_configuration_without_raw_sensors_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("raw.toml"), "[built-in]\n").unwrap();
    let refused = calibrate(folder.path(), &["gyroscope"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        said(&refused).contains("has no raw sensors"),
        "{}",
        said(&refused)
    );
}

/// On a terminal there is a picture; Ctrl-C ends it and changes nothing.
#[test]
fn a_terminal_shows_the_coverage_and_an_interruption_changes_nothing() {
    use std::io::Read as _;
    use std::time::{Duration, Instant};

    use nix::sys::signal::{Signal, kill};

    let folder = tempfile::tempdir().unwrap();
    with_config(folder.path(), "");
    let (mut ours, theirs) = super::top::terminal(["40", "120"]);
    let mut child = fccd(folder.path(), &["calibrate", "accelerometer", "raw.toml"])
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(theirs)
        .spawn()
        .unwrap();
    let (mut seen, begun) = (String::new(), Instant::now());
    let mut bytes = [0; 4096];
    while !(seen.contains("edges, two of each row") && seen.contains("[+x]")) {
        assert!(begun.elapsed() < Duration::from_secs(60), "{seen}");
        let length = ours.read(&mut bytes).unwrap();
        seen += &String::from_utf8_lossy(&bytes[..length]);
    }
    kill(super::top::id(&child), Signal::SIGINT).unwrap();
    // The terminal is read until it is closed.
    while ours.read(&mut bytes).is_ok_and(|length| {
        seen += &String::from_utf8_lossy(&bytes[..length]);
        length > 0
    }) {}
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert!(seen.contains("interrupted: nothing was changed"), "{seen}");
    assert!(!folder.path().join(FILE).exists());
}

#[test]
fn an_order_in_which_errors_remain_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    with_config(folder.path(), "");
    let refused = |kind: &str, expected: &str| {
        let refused = calibrate(folder.path(), &[kind]);
        assert_eq!(refused.status.code(), Some(18), "{}", said(&refused));
        assert!(said(&refused).contains(expected), "{}", said(&refused));
    };
    let first = "calibrate the accelerometer of built-in first";
    refused("magnetometer", first);
    refused("mounting", first);
    refused("gyroscope", first);
    assert!(
        calibrate(folder.path(), &["accelerometer"])
            .status
            .success()
    );
    refused("magnetometer", "calibrate the mounting of built-in first");
    assert!(calibrate(folder.path(), &["mounting"]).status.success());
    let done = calibrate(folder.path(), &["magnetometer"]);
    assert!(done.status.success(), "{}", said(&done));
    // What was found counts only where it is used.
    with_config(folder.path(), "[calibration]\nenabled = false\n");
    refused("mounting", "calibration.enabled is false");
    let done = calibrate(folder.path(), &["gyroscope", "--bias-only"]);
    let printed = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(printed.contains("flights do not use it"), "{printed}");
}

#[test]
fn what_cannot_be_stored_is_refused_before_the_first_step() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    for (file, code, expected) in [
        ("/proc/x.toml", 1, "fccd: /proc/x.toml: cannot be written: "),
        ("file/x.toml", 1, "fccd: file/x.toml: cannot be written: "),
        ("", 2, "calibration.file: is no name of a file"),
    ] {
        let section = format!("[calibration]\nfile = {file:?}\n");
        with_config(folder.path(), &section);
        let refused = calibrate(folder.path(), &["gyroscope"]);
        assert_eq!(refused.status.code(), Some(code), "{}", said(&refused));
        assert!(said(&refused).contains(expected), "{}", said(&refused));
        assert!(!said(&refused).contains("hands off"), "{}", said(&refused));
    }
    with_config(folder.path(), "");
    for words in [["gyroscope", "--level-only"], ["mounting", "--bias-only"]] {
        let refused = calibrate(folder.path(), &words);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    }
}

/// The disk becomes full while the sensor is turned: no file may be longer than nothing.
#[test]
fn what_cannot_be_stored_in_the_end_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    with_config(folder.path(), "");
    let calibrate = "ulimit -f 0; exec \"$0\" calibrate accelerometer raw.toml --lockstep \"$@\"";
    for json in [&["--json"][..], &[]] {
        let done = std::process::Command::new("sh")
            .args(["-c", calibrate, env!("CARGO_BIN_EXE_fccd")])
            .args(json)
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(done.status.code(), Some(1), "{}", said(&done));
        assert!(
            said(&done).contains("cannot be written: "),
            "{}",
            said(&done)
        );
        let printed = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(printed.contains("bias"), "{printed}");
        assert!(!folder.path().join(FILE).exists());
        assert!(!folder.path().join(format!("{FILE}.new")).exists());
    }
}

/// A gyroscope of the kernel's Industrial I/O: what devices give has the time of
/// the loop's clock.
#[test]
fn a_sensor_of_the_kernel_is_calibrated_in_real_time() {
    let folder = tempfile::tempdir().unwrap();
    let device = folder.path().join("iio:device0");
    fs::create_dir(&device).unwrap();
    for (file, content) in [
        ("name", "imu"),
        ("in_anglvel_x_raw", "10"),
        ("in_anglvel_y_raw", "0"),
        ("in_anglvel_z_raw", "-20"),
        ("in_anglvel_scale", "0.001"),
    ] {
        fs::write(device.join(file), content).unwrap();
    }
    let sensor = format!(
        "actuator = []\n[[sensor]]\nkind = \"iio\"\ndevice = \"imu\"\nsysfs = {:?}\n",
        folder.path()
    );
    fs::write(folder.path().join("raw.toml"), sensor).unwrap();
    let turned = fccd(folder.path(), &["calibrate", "gyroscope", "raw.toml"]);
    let refused = { turned }.output().unwrap();
    assert_eq!(refused.status.code(), Some(1), "{}", said(&refused));
    assert!(said(&refused).contains("--bias-only"), "{}", said(&refused));
    let words = [
        "calibrate",
        "gyroscope",
        "--bias-only",
        "raw.toml",
        "--json",
    ];
    let done = fccd(folder.path(), &words).output().unwrap();
    assert!(done.status.success(), "{}", said(&done));
    let found: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(found["found"]["place"], "sensor[0]");
    // 0.01 and -0.02 rad/s.
    let bias = &found["found"]["keys"]["gyroscope"]["bias_degps"];
    assert_eq!(bias.to_string(), "[0.5729578,0.0,-1.14591559]");
}

/// A servo board over UDP that gives 6 Pa, as X-Plane gives a dataref: a
/// subscription is `RREF`, a zero, the frequency, a number and the name, and the
/// answer the number and the value.
#[test]
fn the_pitot_tube_of_a_servo_board_is_calibrated() {
    use std::net::UdpSocket;
    use std::thread;
    use std::time::Duration;

    let board = UdpSocket::bind("127.0.0.1:0").unwrap();
    let every = Some(Duration::from_millis(20));
    board.set_read_timeout(every).unwrap();
    let address = board.local_addr().unwrap();
    thread::spawn(move || {
        let mut subscribed = None;
        let mut bytes = [0; 2048];
        loop {
            if let Ok((length, from)) = board.recv_from(&mut bytes) {
                let name = b"fccd/servo_board/differential_pressure_pa";
                let asked = bytes[..length].windows(name.len()).any(|part| part == name);
                if asked && bytes.starts_with(b"RREF\0") && bytes[5..9] != [0; 4] {
                    subscribed = Some((from, [bytes[9], bytes[10], bytes[11], bytes[12]]));
                }
            }
            if let Some((to, number)) = subscribed {
                let value = 6.0_f32.to_le_bytes();
                let answer = [b"RREF,".as_slice(), &number, &value].concat();
                let _ = board.send_to(&answer, to);
            }
        }
    });
    let folder = tempfile::tempdir().unwrap();
    let config = format!(
        "[servo-board]\naddress = \"{address}\"\n[[sensor]]\nkind = \"servo-board\"\n\
         [[sensor]]\nkind = \"x-plane\"\nsimulator = \"127.0.0.1:9\"\n\
         [[actuator]]\nkind = \"servo-board\"\n"
    );
    fs::write(folder.path().join("raw.toml"), config).unwrap();
    let words = ["calibrate", "airspeed", "raw.toml"];
    let done = fccd(folder.path(), &words).output().unwrap();
    assert!(done.status.success(), "{}", said(&done));
    let stored = fs::read_to_string(folder.path().join(FILE)).unwrap();
    assert!(stored.contains("place = \"servo-board\""), "{stored}");
    assert!(stored.contains("bias_pa = 6.0"), "{stored}");
}
