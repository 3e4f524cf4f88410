//! A flight control computer: one configuration, flown any number of times.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_flight::calibrate;
use fcc_flight::config::Config;
use fcc_phone::PositionReport;
use fcc_record::Listed;
use fcc_telemetry::Command;

use crate::failure::Failure;
use crate::flight::Flight;
use crate::listener::Notifier;
use crate::live::{self, Live};

/// The name of the configuration in messages.
const CONFIG_NAME: &str = "configuration";

/// A configuration, and its flight if it flies.
pub(crate) struct Computer {
    config: Config,
    text: String,
    /// The app's, to which Android gives its sensors.
    package: String,
    live: Arc<Live>,
    notifier: Notifier,
    flight: Mutex<Option<Flight>>,
}

impl Computer {
    /// Checks a configuration, a text as `fccd` reads from its file; `recordings`
    /// is the folder that replaces `recording.folder`, `package` the app's name.
    ///
    /// # Errors
    /// When it cannot be flown: every problem with its line and key.
    pub(crate) fn create(
        text: String,
        recordings: PathBuf,
        package: String,
        notifier: Notifier,
    ) -> Result<Self, Failure> {
        let mut config = read(&text, recordings)?;
        let now_s = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or(0, |since| since.as_secs());
        let mut remarks = config.remarks(&text);
        let applied = calibrate::apply(&mut config, now_s)
            .map_err(|(file, error)| Failure::Config(format!("{}: {error}", file.display())))?;
        remarks.extend(applied.remarks);
        Ok(Self {
            config,
            text,
            package,
            live: Arc::new(Live::new(remarks)),
            notifier,
            flight: Mutex::new(None),
        })
    }

    /// Begins a flight; returns when its loop runs.
    ///
    /// # Errors
    /// When it flies already, or cannot.
    pub(crate) fn start(&self) -> Result<(), Failure> {
        let mut flight = self.flight();
        if flight.as_ref().is_some_and(|flight| !flight.is_over()) {
            return Err(Failure::Flight(
                "it flies already: stop it first".to_owned(),
            ));
        }
        if let Some(over) = flight.take() {
            over.stop();
        }
        if live::is_hung() {
            return Err(Failure::Flight(
                "the loop of an earlier flight hangs in this process: end the app, and start it \
                 again"
                    .to_owned(),
            ));
        }
        let begun = Flight::begin(
            &self.config,
            &self.text,
            &self.package,
            &self.live,
            &self.notifier,
        )?;
        *flight = Some(begun);
        Ok(())
    }

    /// Ends the flight, if there is one: returns when the controls are released
    /// and the recording is finished, which can take seconds if the plant does
    /// not confirm the release.
    pub(crate) fn stop(&self) {
        if let Some(flight) = self.flight().take() {
            flight.stop();
        }
    }

    /// Sends a command, as JSON, and waits until a tick has read it: its number.
    ///
    /// # Errors
    /// When it is not a command, is refused, or nothing flies.
    pub(crate) fn command(&self, json: &str) -> Result<u64, Failure> {
        #[cfg(feature = "fault-injection")]
        {
            assert!(json != "panic", "injected panic");
            if json == "allocate in the loop" {
                fcc_flight::flight::allocate_in_loop();
            }
            if json == "allocate in the loop" || json == "allocator calls" {
                return Ok(fcc_flight::flight::loop_allocator_calls());
            }
        }
        let command: Command = serde_json::from_str(json).map_err(|error| {
            Failure::Command(format!(
                "{json} is no command: give \"Engage\", \"Disengage\" or \
                 {{\"Set\": [[\"heading_rad\", 1.57]]}} ({error})"
            ))
        })?;
        let commander = self.flight().as_ref().map(Flight::commander);
        commander
            .ok_or_else(|| Failure::Command("nothing flies: start first".to_owned()))?
            .command(command)
    }

    /// Hands a position in, for a flight by the phone's sensors.
    pub(crate) fn position(&self, report: PositionReport) {
        let phone = self.flight().as_ref().map(|flight| flight.phone().clone());
        if let Some(phone) = phone {
            phone.positions().send(report);
        }
    }

    /// The state now, as JSON.
    pub(crate) fn state(&self) -> String {
        self.live.to_json()
    }

    /// The recordings in the folder, oldest first, as JSON; of finished files
    /// only the beginning and the end are read.
    ///
    /// # Errors
    /// When the folder is there and cannot be read.
    pub(crate) fn recordings(&self) -> Result<String, Failure> {
        let folder: &Path = &self.config.recording.folder;
        let files = if folder.exists() {
            fcc_record::files(folder).map_err(|error| {
                Failure::Recording(format!("{}: cannot be listed: {error}", folder.display()))
            })?
        } else {
            Vec::new()
        };
        let listed: Vec<_> = files
            .into_iter()
            .map(|file| Listed::of(file, true))
            .collect();
        serde_json::to_string(&listed).map_err(|error| Failure::Recording(error.to_string()))
    }

    fn flight(&self) -> MutexGuard<'_, Option<Flight>> {
        self.flight.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The configuration of a text, as the app flies it.
///
/// # Errors
/// When it cannot be flown: every problem with its line and key.
pub(crate) fn read(text: &str, recordings: PathBuf) -> Result<Config, Failure> {
    let mut config =
        Config::parse(text, CONFIG_NAME).map_err(|error| Failure::Config(error.to_string()))?;
    config.recording.folder = recordings;
    // There are no other programs to watch it.
    config.telemetry.enabled = false;
    Ok(config)
}

impl Drop for Computer {
    fn drop(&mut self) {
        self.stop();
    }
}
