//! `fccd doctor`: whether the machine suits a real-time loop.

use fcc_flight::config::{Config, RealtimeSection};
use fcc_timer::RealtimeRequest;

use crate::cli::DoctorArgs;
use crate::doctor::Diagnosis;
use crate::exit::Exit;
use crate::output;

/// Checks the machine, for the configured loop.
pub(super) fn doctor(args: &DoctorArgs) -> Exit {
    if !args.root.is_dir() {
        output::message(format!(
            "--root {}: there is no such folder: give the one with the machine's files",
            args.root.display()
        ));
        return Exit::Usage;
    }
    let configured = args.config.as_ref().map(|file| Config::load(file));
    let realtime = match configured.transpose() {
        Ok(config) => config.map_or_else(RealtimeSection::default, |config| config.realtime),
        Err(error) => {
            output::message(error);
            return Exit::Usage;
        }
    };
    let diagnosis = Diagnosis::of(&args.root, &RealtimeRequest::from(&realtime));
    let exit = if diagnosis.lacks_something() {
        Exit::MachineLacks
    } else {
        Exit::Success
    };
    if args.json {
        output::json(&diagnosis, exit)
    } else {
        output::result(diagnosis.to_text(), exit)
    }
}
