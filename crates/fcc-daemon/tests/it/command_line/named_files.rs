//! Files that are named on the command line, to be read or written.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{fccd, fly};

/// The exit code, standard output and standard error.
fn ended(folder: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    let output = fccd(folder, words).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

/// A folder, and the name of a recording in it.
fn flown() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    let file = fcc_record::files(&folder.path().join("recordings"))
        .unwrap()
        .remove(0);
    let file = file.to_str().unwrap().to_owned();
    (folder, file)
}

#[test]
fn several_configurations_are_checked_and_the_worst_counts() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("good.toml"), "[built-in]\n").unwrap();
    fs::write(folder.path().join("wrong.toml"), "[lop]\n").unwrap();
    for (words, exit) in [
        (&["check", "good.toml", "wrong.toml"][..], 2),
        (&["check", "wrong.toml", "good.toml"], 2),
        (&["check", "good.toml", "good.toml"], 0),
    ] {
        let (code, valid, said) = ended(folder.path(), words);
        assert_eq!(code, Some(exit), "{words:?}: {said}");
        assert!(valid.contains("good.toml: valid: "), "{words:?}: {valid}");
        assert_eq!(said.contains("wrong.toml:1: "), exit == 2, "{said}");
    }
    let (code, listed, _) = ended(
        folder.path(),
        &["check", "good.toml", "wrong.toml", "--json"],
    );
    assert_eq!(code, Some(2));
    let listed: Value = serde_json::from_str(&listed).unwrap();
    let of = |at: usize| (listed[at]["file"].as_str(), listed[at]["ok"].as_bool());
    assert_eq!(of(0), (Some("good.toml"), Some(true)));
    assert_eq!(of(1), (Some("wrong.toml"), Some(false)));
}

/// It would be a file of that name.
#[test]
fn a_hyphen_is_no_name_of_an_output() {
    let (folder, file) = flown();
    for words in [
        &["report", &file, "--html", "-"][..],
        &["report", &file, "--svg", "-"],
        &["report", &file, "--csv", "-"],
        &["replay", &file, "--config", "c.toml", "--csv", "-"],
        &["fly", "--lockstep", "--recordings", "-"],
        &["run", "--config", "c.toml", "--recordings", "-"],
        &["x-plane", "check", "--yes", "--report", "-"],
        &["x-plane", "identify", "--files", "-"],
    ] {
        let (code, _, said) = ended(folder.path(), words);
        assert_eq!(code, Some(2), "{words:?}: {said}");
        assert!(said.contains("standard output is for the result"), "{said}");
        assert!(!folder.path().join("-").exists(), "{words:?}");
    }
}

#[test]
fn a_report_names_what_it_wrote_and_needs_a_folder_for_plots_and_tables() {
    let (folder, file) = flown();
    let words = ["report", &file, "--html", "p.html", "--svg", "plots"];
    let (code, said, _) = ended(folder.path(), &words);
    let plots = fs::read_dir(folder.path().join("plots")).unwrap().count();
    assert_eq!(code, Some(0));
    assert!(plots > 3, "{plots}");
    assert!(
        said.ends_with(&format!("written: plots: {plots} plots\nwritten: p.html\n")),
        "{said}"
    );
    let (_, said, _) = ended(folder.path(), &["report", &file, "--csv", "tables"]);
    assert!(
        said.ends_with("written: tables: records.csv, events.csv\n"),
        "{said}"
    );
    fs::write(folder.path().join("c.toml"), "[built-in]\n").unwrap();
    let words = ["replay", &file, "--config", "c.toml", "--csv", "both.csv"];
    let (_, said, _) = ended(folder.path(), &words);
    assert!(said.contains("written: both.csv"), "{said}");

    for option in ["--svg", "--csv"] {
        let (code, _, said) = ended(folder.path(), &["report", &file, option, "p.html"]);
        assert_eq!(code, Some(1));
        assert_eq!(
            said,
            "fccd: p.html: cannot be written: it is a file, or is below one: give the name of a \
             folder\n"
        );
    }
}
