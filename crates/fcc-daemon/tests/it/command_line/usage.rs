//! Words that the command line does not know.

use std::process::Command;

use super::fccd;

/// A flight needs more stack than this to begin: without raising the limit the kernel
/// would end the program.
#[test]
fn a_small_limit_on_the_stack_is_raised() {
    let folder = tempfile::tempdir().unwrap();
    let fly = "ulimit -S -s 256; exec \"$0\" fly --lockstep --quiet --seconds 1 --no-recording";
    let flown = Command::new("sh")
        .args(["-c", fly, env!("CARGO_BIN_EXE_fccd")])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(flown.status.success(), "{flown:?}");
}

/// The usage is that of the command, and no word is proposed that means
/// something else.
#[test]
fn an_unknown_option_is_answered_with_the_usage_of_its_command() {
    for (words, unknown, usage) in [
        (
            &["fly", "--lockstep", "--rate", "100"][..],
            "'--rate'",
            "Usage: fccd fly [OPTIONS]\n",
        ),
        (
            &["timing", "--lockstep", "--rate", "40"],
            "'--lockstep'",
            "Usage: fccd timing [OPTIONS]\n",
        ),
        (
            &["list", "--recordings"],
            "'--recordings'",
            "Usage: fccd list [OPTIONS] [DIR]\n",
        ),
        (
            &["x-plane", "steps", "--quiet"],
            "'--quiet'",
            "Usage: fccd x-plane steps [OPTIONS]\n",
        ),
    ] {
        let ended = fccd(".".as_ref(), words).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(2), "{said}");
        assert!(said.contains(unknown) && said.contains(usage), "{said}");
        assert!(!said.contains("as a value"), "{said}");
    }
    // A word that is nearly right is still named.
    let ended = fccd(".".as_ref(), &["fly", "--lockstp"]).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert!(said.contains("'--lockstep'"), "{said}");
}
