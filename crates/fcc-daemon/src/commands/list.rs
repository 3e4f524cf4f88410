//! `fccd list [DIR]`.

use fcc_record::Entry;
use fcc_report::recordings_table;

use super::{fail, progress};
use crate::cli::ListArgs;
use crate::exit::Exit;
use crate::output;

/// Lists the recordings in a folder, and says which files cannot be read.
pub(super) fn list(args: &ListArgs) -> Exit {
    let files = match fcc_record::files(&args.folder) {
        Ok(files) => files,
        Err(error) => {
            return fail(&format!(
                "{}: cannot be listed: {error}. Give the folder that flights were recorded to",
                args.folder.display()
            ));
        }
    };
    let bytes = |path: &std::path::PathBuf| path.metadata().map_or(0, |metadata| metadata.len());
    let bar = progress::bar(files.iter().map(bytes).sum(), "reading");
    let mut entries: Vec<Entry> = Vec::new();
    let mut refused = Vec::new();
    for path in &files {
        let entry = if args.quick {
            fcc_record::glance(path)
        } else {
            fcc_record::entry(path)
        };
        match entry {
            Ok(entry) => entries.push(entry),
            Err(error) => refused.push(error),
        }
        bar.inc(bytes(path));
    }
    bar.finish_and_clear();
    for error in &refused {
        output::message(error);
    }
    let is_damaged = |entry: &Entry| !entry.damages.is_empty();
    let exit = if entries.iter().any(is_damaged) || !refused.is_empty() {
        Exit::Incomplete
    } else {
        Exit::Success
    };
    if args.json {
        return output::json(&entries, exit);
    }
    for entry in &entries {
        for damage in &entry.damages {
            output::message(format!("{}: is {damage}", entry.path.display()));
        }
    }
    let text = if entries.is_empty() {
        let readable = if refused.is_empty() {
            ""
        } else {
            " that can be read"
        };
        format!("{}: no recordings{readable}", args.folder.display())
    } else {
        recordings_table(&entries)
    };
    output::result(text, exit)
}
