//! What is permitted and said, and what is not there to be checked.

use super::fccd;

fn printed(folder: &std::path::Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = fccd(folder, arguments).output().unwrap();
    let both = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(both).unwrap())
}

#[test]
fn a_flight_that_moves_nothing_says_so() {
    const WORDS: &str = "f.toml: remark: there is no actuator: engaging moves nothing";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("f.toml"), "actuator = []\n[built-in]\n").unwrap();
    let (exit, checked) = printed(folder.path(), &["check", "f.toml"]);
    assert_eq!(
        (exit, checked.contains(WORDS)),
        (Some(0), true),
        "{checked}"
    );
    let fly = ["fly", "--lockstep", "--seconds", "1", "--config", "f.toml"];
    let (_, flown) = printed(folder.path(), &fly);
    assert!(
        flown.contains("there is no actuator: engaging moves nothing"),
        "{flown}"
    );
}

/// Control commands NaN; failsafe's time does not pass.
#[cfg(feature = "fault-injection")]
#[test]
fn a_flight_that_failsafe_ends_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let flight = ["fly", "--lockstep", "--no-recording"];
    let mut command = fccd(folder.path(), &flight);
    let ended = command.env("FCCD_NAN_AT_S", "5").output().unwrap();
    assert_eq!(ended.status.code(), Some(3));
    let flown = String::from_utf8([ended.stdout, ended.stderr].concat()).unwrap();
    assert!(
        flown.contains("ended: it entered failsafe, which ends a flight of a given length"),
        "{flown}"
    );
    assert!(!flown.contains("failsafe -> standby"), "{flown}");
}

#[test]
fn a_machine_without_a_folder_is_not_checked() {
    let (exit, words) = printed(".".as_ref(), &["doctor", "--root", "/no/such/folder"]);
    assert_eq!(
        (exit, words.contains("there is no folder `proc` in it")),
        (Some(2), true),
        "{words}"
    );
}

/// A configuration may be for another machine.
#[test]
fn users_and_groups_that_this_machine_does_not_have_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let rights = "[built-in]\n[rights]\nuser = \"no-such-user\"\ncommanders = [\"root\", \
                  \"no-such-one\"]\ncommander_groups = [\"no-such-group\"]\n";
    std::fs::write(folder.path().join("f.toml"), rights).unwrap();
    let (exit, checked) = printed(folder.path(), &["check", "f.toml"]);
    assert_eq!(exit, Some(0), "{checked}");
    for words in [
        "rights.user is \"no-such-user\": there is no such user on this machine",
        "rights.commanders has \"no-such-one\": there is no such user on this machine",
        "rights.commander_groups has \"no-such-group\": there is no such group on this machine",
    ] {
        assert!(checked.contains(words), "{checked}");
    }
    assert!(!checked.contains("\"root\""), "{checked}");
}
