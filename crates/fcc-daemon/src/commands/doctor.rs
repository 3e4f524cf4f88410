//! `fccd doctor`: whether the machine suits a real-time loop.

use fcc_flight::config::{Config, RealtimeSection};
use fcc_timer::RealtimeRequest;

use super::failure::Failure;
use crate::cli::DoctorArgs;
use crate::exit::Exit;
use crate::output;
use fcc_doctor::Diagnosis;

/// Checks the machine, for the configured loop.
pub(super) fn doctor(args: &DoctorArgs) -> Result<Exit, Failure> {
    if !args.root.join("proc").is_dir() {
        return Err(Failure::usage(format_args!(
            "--root {}: there is no folder `proc` in it: give the one with the machine's files",
            args.root.display()
        )));
    }
    let config = args.config.as_deref().map(Config::load).transpose()?;
    let realtime = config.map_or_else(RealtimeSection::default, |config| config.realtime);
    let diagnosis = Diagnosis::of(&args.root, &RealtimeRequest::from(&realtime));
    let exit = if diagnosis.lacks_something() {
        Exit::MachineLacks
    } else {
        Exit::Success
    };
    Ok(if args.json {
        output::json(&diagnosis, exit)
    } else {
        output::result(diagnosis.to_text(), exit)
    })
}
