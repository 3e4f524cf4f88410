//! `fccd recover FILE`.

use std::fs;

use fcc_record::{RecoverError, Recovered};

use super::failure::Failure;
use super::progress;
use crate::cli::RecoverArgs;
use crate::exit::Exit;
use crate::output;

/// Recovers a recording that is unfinished or damaged.
pub(super) fn recover(args: &RecoverArgs) -> Result<Exit, Failure> {
    let bytes = fs::metadata(&args.file).map_or(0, |metadata| metadata.len());
    let bar = progress::bar(bytes, "recovering");
    let recovered = fcc_record::recover(&args.file, |read| bar.set_position(read));
    bar.finish_and_clear();
    let recovered = recovered.map_err(|error| match error {
        RecoverError::Open(error) => error.into(),
        error => Failure::new(error),
    })?;
    let exit = if recovered.damages.is_empty() && recovered.ticks > 0 {
        Exit::Success
    } else {
        Exit::Incomplete
    };
    Ok(if args.json {
        output::json(&recovered, exit)
    } else {
        output::result(description(&recovered), exit)
    })
}

fn description(recovered: &Recovered) -> String {
    let file = recovered.path.display();
    let ticks = recovered.ticks;
    if recovered.was_whole {
        return format!("{file}: is complete: {ticks} ticks");
    }
    let cut = recovered
        .cut
        .as_ref()
        .map(|cut| format!("{file}: was {cut}"));
    let damages = recovered
        .damages
        .iter()
        .map(|damage| format!("{file}: was {damage}"));
    let now = format!("{file}: is recovered: {ticks} ticks");
    let kept = recovered
        .kept
        .as_ref()
        .map(|kept| format!("{}: the original file", kept.display()));
    let lines: Vec<String> = cut
        .into_iter()
        .chain(damages)
        .chain([now])
        .chain(kept)
        .collect();
    lines.join("\n")
}
