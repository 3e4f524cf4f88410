//! `fccd list [DIR]`.

use std::io::ErrorKind;

use fcc_flight::config::RecordingSection;
use fcc_record::{Entry, Listed, Wholeness};
use fcc_report::recordings_table;

use super::failure::Failure;
use super::progress;
use crate::cli::ListArgs;
use crate::exit::Exit;
use crate::output;

/// Lists the recordings in a folder, and says which files cannot be read.
pub(super) fn list(args: &ListArgs) -> Result<Exit, Failure> {
    let folder = args.folder.display();
    let found = match fcc_record::files(&args.folder) {
        Err(error)
            if error.kind() == ErrorKind::NotFound
                && args.folder == RecordingSection::default().folder =>
        {
            None
        }
        found => Some(found.map_err(|error| {
            Failure::of(
                Exit::Usage,
                format_args!(
                    "{folder}: cannot be listed: {error}. Give the folder that flights were \
                     recorded to"
                ),
            )
        })?),
    };
    let is_there = found.is_some();
    let files = found.unwrap_or_default();
    let bytes = |path: &std::path::PathBuf| path.metadata().map_or(0, |metadata| metadata.len());
    let bar = progress::bar(files.iter().map(bytes).sum(), "reading");
    let mut listed = Vec::new();
    for path in files {
        let bytes = bytes(&path);
        listed.push(Listed::of(path, args.quick));
        bar.inc(bytes);
    }
    bar.finish_and_clear();
    let errors: Vec<String> = listed.iter().flat_map(Listed::errors).collect();
    for error in &errors {
        output::message(error.replace('\n', "\\n"));
    }
    let is_cut = |one: &Listed| matches!(one, Listed::Recording(one) if one.file == Wholeness::Cut);
    let exit = if errors.is_empty() && !listed.iter().any(is_cut) {
        Exit::Success
    } else {
        Exit::Incomplete
    };
    if args.json {
        return Ok(output::json(&listed, exit));
    }
    let are_some = !listed.is_empty();
    let entries: Vec<Entry> = listed.into_iter().filter_map(Listed::entry).collect();
    let text = if !is_there {
        format!(
            "no recordings: flights are recorded into the folder {folder}, which is not here yet; \
             list another one with `fccd list DIR`"
        )
    } else if entries.is_empty() {
        let readable = if are_some { " that can be read" } else { "" };
        format!("{folder}: no recordings{readable}")
    } else {
        recordings_table(&entries)
    };
    Ok(output::result(text, exit))
}
