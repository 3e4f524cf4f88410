//! `fccd probe`, on a root folder with the kernel's files.

use std::fs;

use tempfile::TempDir;

use super::fccd;

fn root() -> TempDir {
    let root = TempDir::new().unwrap();
    for (file, text) in [
        ("name", "bmp388\n"),
        ("in_pressure_input", "101.325\n"),
        ("in_temp_input", "21000\n"),
    ] {
        let path = root
            .path()
            .join("sys/bus/iio/devices/iio:device0")
            .join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    root
}

#[test]
fn what_is_connected_is_listed_with_its_configuration() {
    let root = root();
    let words = ["probe", "--root", root.path().to_str().unwrap()];
    let listed = fccd(root.path(), &words).output().unwrap();
    assert!(listed.status.success(), "{listed:?}");
    let text = String::from_utf8(listed.stdout).unwrap();
    let expected = "1 of 1 devices found can be configured:\n\niio:device0  bmp388  pressure\n    static pressure 101325.00 Pa\n\n\
                    in a configuration, the most preferred first:\n\n\
                    [[sensor]]\nkind = \"iio\"\ndevice = \"bmp388\"\n";
    assert_eq!(text, expected);

    // What it prints is a configuration.
    let (_, entries) = text.split_once("first:\n").unwrap();
    fs::write(
        root.path().join("board.toml"),
        format!("actuator = []\n{entries}"),
    )
    .unwrap();
    let checked = fccd(root.path(), &["check", "board.toml"])
        .output()
        .unwrap();
    assert!(checked.status.success(), "{checked:?}");

    let json = fccd(root.path(), &[&words[..], &["--json"]].concat())
        .output()
        .unwrap();
    let found: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(found[0]["at"], "iio:device0");
    assert_eq!(found[0]["remark"], "pressure");
    assert_eq!(found[0]["values"]["static_pressure_pa"], 101_325.0);
    assert_eq!(found[0]["values"]["rates_radps"], serde_json::Value::Null);
}

/// A configuration with it would not fly.
#[test]
fn what_cannot_be_read_is_listed_with_the_reason_and_not_proposed() {
    let root = root();
    let pressure = "sys/bus/iio/devices/iio:device0/in_pressure_input";
    let pressure = root.path().join(pressure);
    fs::remove_file(&pressure).unwrap();
    nix::unistd::mkfifo(&pressure, nix::sys::stat::Mode::S_IRWXU).unwrap();
    let words = ["probe", "--root", root.path().to_str().unwrap()];
    let listed = fccd(root.path(), &words).output().unwrap();
    let text = String::from_utf8(listed.stdout).unwrap();
    assert!(
        text.contains("in_pressure_input: reading: it is no regular file"),
        "{text}"
    );
    assert!(!text.contains("[[sensor]]"), "{text}");
}

#[test]
fn a_machine_without_sensors_is_told_what_to_do() {
    let root = TempDir::new().unwrap();
    let words = ["probe", "--root", root.path().to_str().unwrap()];
    let listed = fccd(root.path(), &words).output().unwrap();
    let text = String::from_utf8(listed.stdout).unwrap();
    assert!(text.starts_with("no sensor was found"), "{text}");
}

#[test]
fn a_root_that_is_no_folder_is_refused() {
    let root = TempDir::new().unwrap();
    fs::write(root.path().join("file"), "").unwrap();
    for path in ["nowhere", "file"] {
        let refused = fccd(root.path(), &["probe", "--root", path])
            .output()
            .unwrap();
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        let expected = format!("--root {path}: this is no folder");
        assert!(said.starts_with(&expected), "{said}");
        assert!(refused.stdout.is_empty(), "{refused:?}");
    }
}
