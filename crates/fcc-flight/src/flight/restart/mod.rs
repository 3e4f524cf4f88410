//! Restart in the air: a daemon that was killed in flight and started again
//! takes up what was flown, or stands by and says so.
//!
//! While the loop is engaged, what it flies is [kept](keeper) in a small
//! [file](state_file): at every change of the set points, and each second. A
//! flight that ends as it should takes the file away, so one that is found at
//! the start is of a flight that was cut off. How old it is, is told by the
//! kernel's own clock of this boot; what the time of day is does not matter.

mod boot_clock;
mod keeper;
mod observer;
mod state_file;
mod taking_up;

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fcc_core::flight::guidance::{Progress, Targets};
use fcc_core::flight::{AutopilotCommand, Resume};
use fcc_core::framework::{EventKind, Message, State, Switch};
use fcc_runtime::CommandSender;
use fcc_telemetry::{FlightEvent, FlightMessage, FlightRecord};

use crate::config::{Config, RestartMode};
use boot_clock::BootInstant;
use keeper::Keeper;
pub(super) use observer::RestartKeeper;
use state_file::{Saved, StateFileError};
use taking_up::{Next, TakingUp};

/// What is flown is kept at least this often.
const KEEP_EVERY: Duration = Duration::from_secs(1);
/// Set points that change by less are kept at their time, not at once.
const CHANGE: Targets = Targets {
    airspeed_mps: 0.1,
    heading_rad: 0.002,
    altitude_m: 0.3,
};
/// A flight that was taken up and then lasted so long counts as sound.
const SOUND_AFTER: Duration = Duration::from_secs(60);
/// One that is cut off so often in a row, each time before it was sound, is not
/// taken up again: what cuts it off may be what it does.
const MOST_TAKE_UPS: u32 = 3;

/// What is to be known of a flight to restart it.
#[derive(Clone, Debug)]
pub(super) struct RestartRequest {
    mode: RestartMode,
    max_age: Duration,
    path: PathBuf,
    fingerprint: u32,
}

impl RestartRequest {
    /// As a configuration says.
    pub(super) fn of(config: &Config) -> Self {
        let section = &config.restart;
        let path = section.state_file.clone().unwrap_or_else(|| {
            let folder = state_directory().unwrap_or_else(|| config.recording.folder.clone());
            folder.join(format!("{}.flight", config.telemetry.instance))
        });
        Self {
            mode: section.mode,
            max_age: Duration::from_secs_f64(section.max_age_s),
            path,
            fingerprint: fingerprint(config),
        }
    }
}

/// Where systemd says that state is to be kept.
fn state_directory() -> Option<PathBuf> {
    let folders = std::env::var_os("STATE_DIRECTORY")?;
    std::env::split_paths(&folders).next()
}

/// Tells configurations apart that fly differently.
fn fingerprint(config: &Config) -> u32 {
    let flown = Config {
        guidance: config.guidance,
        autopilot: config.autopilot.clone(),
        x_plane: config.x_plane.clone(),
        sensor: config.sensor.clone(),
        actuator: config.actuator.clone(),
        ..Config::default()
    };
    // A configuration that was read can be written.
    crc32fast::hash(toml::to_string(&flown).unwrap_or_default().as_bytes())
}

/// Keeps what is flown, and takes up what was.
pub(super) struct Restart {
    wish: RestartRequest,
    boot: Option<BootInstant>,
    /// Held until the process ends, however it does.
    _lock: File,
    keeper: Keeper,
    kept: Option<(Instant, Progress)>,
    engaged_since: Option<Instant>,
    take_ups: u32,
    switch_on: bool,
    /// The loop broke: what ends now was cut off.
    is_broken: bool,
    taking_up: Option<TakingUp>,
}

impl Restart {
    /// Looks at what the last flight left, and keeps this one from here on.
    /// Gives what there is to say; without a place to keep it, only that.
    pub(super) fn begin(wish: RestartRequest) -> (Option<Self>, Option<String>) {
        let lock = match prepare(&wish.path) {
            Ok(lock) => lock,
            Err(words) => return (None, Some(words)),
        };
        let read = state_file::read(&wish.path);
        if let Err(error @ (StateFileError::Foreign | StateFileError::Unreadable(_))) = &read {
            return (None, Some(format!("{}: {error}", wish.path.display())));
        }
        let keeper = match Keeper::start(wish.path.clone()) {
            Ok(keeper) => keeper,
            Err(error) => return (None, Some(format!("no thread for the state file: {error}"))),
        };
        let now = BootInstant::now();
        let (taking_up, words) = judge(&wish, read, now.as_ref());
        if taking_up.is_none() {
            keeper.clear();
        }
        let this = Self {
            boot: now,
            _lock: lock,
            keeper,
            kept: None,
            engaged_since: None,
            take_ups: 0,
            switch_on: false,
            is_broken: false,
            taking_up,
            wish,
        };
        (Some(this), words)
    }

    /// Takes what the loop tells.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        if let Some(taking_up) = &mut self.taking_up {
            taking_up.take(message);
        }
        match message {
            Message::Event(event) => self.event(event),
            Message::Tick(record) => {
                self.switch_on = is_on(record);
                if record.state == State::Engaged {
                    self.keep(Resume {
                        progress: record.setpoints.guidance,
                        surfaces: record.outputs,
                    });
                }
            }
        }
    }

    fn event(&mut self, event: &FlightEvent) {
        match event.kind {
            // A loop that broke did not end its flight.
            EventKind::StateChanged {
                from: State::Engaged,
                ..
            } if !self.is_broken => {
                self.kept = None;
                self.engaged_since = None;
                self.take_ups = 0;
                self.keeper.clear();
            }
            EventKind::Panicked | EventKind::TimerFailed => self.is_broken = true,
            _ => {}
        }
    }

    /// Goes on with taking up, if there is something to be taken up. `relieve`
    /// is called right before control is taken. Gives what is new, in words.
    pub(super) fn poll(
        &mut self,
        commands: &mut CommandSender<AutopilotCommand>,
        relieve: impl FnOnce(),
    ) -> Option<String> {
        if let Some(words) = self.keeper.trouble() {
            return Some(words);
        }
        let taking_up = self.taking_up.as_mut()?;
        let next = taking_up.go_on(
            self.boot.as_ref().and_then(BootInstant::again),
            self.wish.max_age,
        );
        match next {
            Next::Wait => None,
            Next::Command(resume) => {
                relieve();
                taking_up.command(commands, resume);
                None
            }
            Next::Taken(words) => {
                self.take_ups = taking_up.take_ups() + 1;
                self.taking_up = None;
                // With the number of take-ups in it.
                self.kept = None;
                Some(words)
            }
            Next::LeftAlone(words) => {
                self.taking_up = None;
                self.keeper.clear();
                Some(words)
            }
        }
    }

    /// The flight is over; waits, for a while, for the disk.
    pub(super) fn end(self) {
        self.keeper.end();
    }

    fn keep(&mut self, resume: Resume) {
        let since = *self.engaged_since.get_or_insert_with(Instant::now);
        if self.take_ups > 0 && since.elapsed() >= SOUND_AFTER {
            self.take_ups = 0;
        }
        let is_due = self.kept.is_none_or(|(at, progress)| {
            at.elapsed() >= KEEP_EVERY || differ(&progress, &resume.progress)
        });
        // What is to be taken up stays until that is decided.
        if !is_due || self.taking_up.is_some() {
            return;
        }
        self.kept = Some((Instant::now(), resume.progress));
        // The boot does not change while the process lives.
        let Some(at) = self.boot.as_ref().and_then(BootInstant::again) else {
            return;
        };
        self.keeper.keep(Saved {
            at,
            config: self.wish.fingerprint,
            switch_on: self.switch_on,
            take_ups: self.take_ups,
            resume,
        });
    }
}

/// Makes the folder, and sees to it that no other daemon keeps its flight in
/// the same file.
fn prepare(path: &Path) -> Result<File, String> {
    let words = |doing: &str, error: &dyn std::fmt::Display| {
        format!(
            "{}: {doing}, so a restart would not know of this flight: {error}",
            path.display()
        )
    };
    if let Some(folder) = path.parent()
        && !folder.as_os_str().is_empty()
    {
        fs::create_dir_all(folder).map_err(|error| words("there is no folder for it", &error))?;
    }
    let lock = File::create(path.with_extension("flight.lock"))
        .map_err(|error| words("cannot be locked", &error))?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(fs::TryLockError::WouldBlock) => Err(words(
            "another fccd keeps its flight there",
            &"give this one another restart.state_file",
        )),
        Err(fs::TryLockError::Error(error)) => Err(words("cannot be locked", &error)),
    }
}

/// What is to become of what was found, and what to say of it.
fn judge(
    wish: &RestartRequest,
    read: Result<Option<Saved>, StateFileError>,
    now: Option<&BootInstant>,
) -> (Option<TakingUp>, Option<String>) {
    let stands_by = |why: &str| {
        let words = format!("{}: {why}; standing by", wish.path.display());
        (None, Some(words))
    };
    let saved = match read {
        Ok(Some(saved)) => saved,
        Ok(None) => return (None, None),
        Err(error) => return stands_by(&error.to_string()),
    };
    let Some(age) = now.and_then(|now| now.since(&saved.at)) else {
        return stands_by("a flight was cut off before this machine was last started");
    };
    let cut_off = format!("a flight was cut off {:.1} s ago", age.as_secs_f64());
    if wish.mode == RestartMode::Cold {
        return stands_by(&format!("{cut_off}, and restart.mode is \"cold\""));
    }
    if age > wish.max_age {
        return stands_by(&format!(
            "{cut_off}, longer than restart.max_age_s, {} s",
            wish.max_age.as_secs_f64()
        ));
    }
    if saved.config != wish.fingerprint {
        return stands_by(&format!("{cut_off}, and flown by another configuration"));
    }
    if saved.take_ups >= MOST_TAKE_UPS {
        return stands_by(&format!(
            "{cut_off}, and taken up {} times in a row before",
            saved.take_ups
        ));
    }
    let words = format!("{}: {cut_off}; taking it up", wish.path.display());
    (Some(TakingUp::new(saved)), Some(words))
}

fn is_on(record: &FlightRecord) -> bool {
    let switch = record.measurements.engage_switch;
    !switch.is_never() && switch.value == Switch::On
}

/// Whether another mode is flown, or what it captured differs by more than
/// small change.
fn differ(kept: &Progress, now: &Progress) -> bool {
    let (was, is) = (kept.captured, now.captured);
    kept.mode != now.mode
        || (was.airspeed_mps - is.airspeed_mps).abs() > CHANGE.airspeed_mps
        || (was.heading_rad - is.heading_rad).abs() > CHANGE.heading_rad
        || (was.altitude_m - is.altitude_m).abs() > CHANGE.altitude_m
}

#[cfg(test)]
mod tests;
