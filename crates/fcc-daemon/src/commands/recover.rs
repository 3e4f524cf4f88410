//! `fccd recover FILE`.

use std::fmt::Write as _;
use std::fs;

use fcc_telemetry::recording;

use super::{fail, progress};
use crate::cli::RecoverArgs;
use crate::exit::Exit;
use crate::output;

/// Makes a whole recording of one that was cut off.
pub(super) fn recover(args: &RecoverArgs) -> Exit {
    let bytes = fs::metadata(&args.file).map_or(0, |metadata| metadata.len());
    let bar = progress::bar(bytes, "recovering");
    let recovered = recording::recover(&args.file, |read| bar.set_position(read));
    bar.finish_and_clear();
    match recovered {
        Err(error) => fail(&error.to_string()),
        Ok(recovered) if args.json => output::json(&recovered, Exit::Success),
        Ok(recovered) => {
            let file = recovered.path.display();
            let ticks = recovered.ticks;
            let mut text = match recovered.cut {
                None => format!("{file}: is whole: {ticks} ticks"),
                Some(cut) => format!("{file}: was {cut}; is whole now: {ticks} ticks"),
            };
            if let Some(kept) = recovered.kept {
                let _ = write!(
                    text,
                    "\n{}: the file as it was, as there may be more behind the damage",
                    kept.display()
                );
            }
            output::result(text, Exit::Success)
        }
    }
}
