//! `fccd replay --navigation FILE`: runs the raw readings of a recording
//! through navigation.

use fcc_fixed_wing::Autopilot;
use fcc_flight::replay::{navigation_by_raw, recorded_config, recorded_pattern};
use fcc_record::Recording;
use fcc_replay::Chain;
use fcc_report::{FlightAddition, FlightSurvey, NavigationReplay};
use fcc_telemetry::FlightMessage;
use serde::Serialize;

use super::failure::{Failure, not_opened};
use super::progress;
use crate::cli::ReplayArgs;
use crate::exit::Exit;
use crate::output;

/// Runs one file.
pub(super) fn replay_navigation(args: &ReplayArgs) -> Result<Exit, Failure> {
    #[derive(Serialize)]
    struct Outcome<'a> {
        navigation: &'a NavigationReplay,
    }
    let [file] = args.files.as_slice() else {
        let message = "fccd: --navigation takes one file: give the parts of a recording one by one";
        return Err(Failure::usage(message));
    };
    let chain = Chain::open::<Autopilot>(&args.files).map_err(not_opened)?;
    let config = recorded_config(&chain).map_err(|error| Failure::of(Exit::NotReplayed, error))?;
    let recording = Recording::open_as::<FlightMessage>(file)?;
    let addition = FlightAddition::new(recorded_pattern(recording.about()))
        .with_navigation(NavigationReplay::new(navigation_by_raw(&config)));
    let bar = progress::bar(recording.bytes(), "replaying");
    let report = FlightSurvey::read(&recording, addition, None, |read| bar.set_position(read))
        .map_err(Failure::new)?;
    bar.finish_and_clear();
    let navigation = report.addition.navigation.as_ref();
    let Some(navigation) = navigation.filter(|navigation| navigation.has_readings()) else {
        let message = format!(
            "{}: has no raw readings of gyroscopes or accelerometers: record a flight with raw \
             sensors, such as [built-in] raw_sensors = \"board\"",
            file.display()
        );
        return Err(Failure::of(Exit::NotReplayed, message));
    };
    let mut written = String::new();
    if let Some(page) = &args.html {
        let written_page = report.write_page(page, std::slice::from_ref(file));
        written_page.map_err(Failure::new)?;
        written = format!("\n\nwritten: {}", page.display());
    }
    let exit = if report.is_complete() {
        Exit::Success
    } else {
        Exit::Incomplete
    };
    Ok(if args.json {
        output::json(&Outcome { navigation }, exit)
    } else {
        output::result(format!("{}{written}", navigation.to_text()), exit)
    })
}
