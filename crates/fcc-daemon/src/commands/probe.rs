//! `fccd probe`: what is connected to a board.

use std::fmt::Write as _;

use fcc_flight::probe::{Connected, connected};

use crate::cli::ProbeArgs;
use crate::exit::Exit;
use crate::output;

/// Lists what is connected, and the lines of a configuration that read it.
pub(super) fn probe(args: &ProbeArgs) -> Exit {
    let found = connected(&args.root);
    if args.json {
        output::json(&found, Exit::Success)
    } else {
        output::result(text(&found), Exit::Success)
    }
}

fn text(found: &[Connected]) -> String {
    if found.is_empty() {
        return "nothing is connected that is known: no I²C bus in /dev and no device in \
                /sys/bus/iio/devices. Switch the buses on (docs/boards.md)"
            .to_owned();
    }
    let width = |of: fn(&Connected) -> &str| {
        let lengths = found.iter().map(|one| of(one).chars().count());
        lengths.max().unwrap_or_default()
    };
    let (at, name) = (width(|one| &one.at), width(|one| &one.name));
    let mut text = String::new();
    for one in found {
        let _ = writeln!(text, "{:at$}  {:name$}  {}", one.at, one.name, one.remark);
    }
    let entries: Vec<&str> = found
        .iter()
        .filter_map(|one| one.entry.as_deref())
        .collect();
    if !entries.is_empty() {
        let _ = write!(
            text,
            "\nin a configuration, the most preferred first:\n\n{}",
            entries.join("\n")
        );
    }
    text.truncate(text.trim_end().len());
    text
}
