//! In-flight recovery: a daemon that was killed in flight and started again
//! continues what was flown, or stays in standby and reports it.
//!
//! While the loop is engaged, its state is [stored](keeper) in a small
//! [file](state_file): at every change of the set points, and each second. A
//! flight that ends regularly removes the file, so a file found at the start
//! belongs to an interrupted flight. Its age is measured by the kernel's clock
//! since boot; the time of day is not used.

mod boot_clock;
mod keeper;
mod kept_plan;
mod observer;
mod place;
mod recovery;
mod saved;
mod state_file;
mod state_page;

use std::fs::File;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use fcc_core::flight::guidance::{Progress, Targets};
use fcc_core::flight::{AutopilotCommand, Resume};
use fcc_core::framework::{EventKind, LoopCommand, Message, State, Switch};
use fcc_runtime::{CommandSender, SwitchOwner};
use fcc_telemetry::{FlightEvent, FlightMessage};

use crate::config::{Config, RestartMode};
use boot_clock::BootInstant;
use keeper::Keeper;
use kept_plan::{NotedPlans, SavedPlan};
pub(super) use observer::RestartKeeper;
use place::SavedPlace;
use recovery::{Next, Recovery};
use saved::{Saved, SavedCommands, SavedSwitch};
use state_file::StateFileError;
#[cfg(fuzzing)]
pub use state_file::read_state;

/// The state is stored at least at this interval.
const KEEP_EVERY: Duration = Duration::from_secs(1);
/// Set points that change by less are stored at the next interval, not at once.
const CHANGE: Targets = Targets {
    airspeed_mps: 0.1,
    heading_rad: 0.002,
    altitude_m: 0.3,
};
/// A recovered flight that lasts this long counts as stable.
const STABLE_AFTER: Duration = Duration::from_secs(60);
/// A flight that is interrupted this many times in a row, each time before it
/// was stable, is not recovered again, since the flight itself may be the
/// cause.
const MAX_RECOVERIES: u32 = 3;

/// What in-flight recovery needs to know about a flight.
#[derive(Clone, Debug)]
pub(super) struct RestartRequest {
    mode: RestartMode,
    max_age: Duration,
    path: PathBuf,
    fingerprint: u32,
    release_left_held: bool,
    config: Config,
}

impl RestartRequest {
    /// The request for a configuration.
    pub(super) fn of(config: &Config) -> Self {
        let section = &config.restart;
        let path = section.state_file.clone();
        let path = path.unwrap_or_else(|| config.state_file("flight"));
        Self {
            mode: section.mode,
            max_age: Duration::from_secs_f64(section.max_age_s),
            path,
            fingerprint: fingerprint(config),
            release_left_held: section.release_left_held,
            config: config.clone(),
        }
    }
}

/// A fingerprint that differs for configurations that fly differently.
fn fingerprint(config: &Config) -> u32 {
    let flown = Config {
        guidance: config.guidance,
        autopilot: config.autopilot.clone(),
        altimeter: config.altimeter,
        x_plane: config.x_plane.clone(),
        servo_board: config.servo_board.clone(),
        sensor: config.sensor.clone(),
        actuator: config.actuator.clone(),
        contingency: config.contingency.clone(),
        ..Config::default()
    };
    // A configuration that was read can be written.
    crc32fast::hash(toml::to_string(&flown).unwrap_or_default().as_bytes())
}

/// Stores the state of the flight, and recovers an interrupted one.
pub(super) struct Restart {
    request: RestartRequest,
    boot: Option<BootInstant>,
    /// Held until the process ends in any way.
    _lock: File,
    keeper: Keeper,
    kept: Option<(Instant, Progress, u64)>,
    plans: NotedPlans,
    engaged_since: Option<Instant>,
    recoveries: u32,
    switch_owner: SwitchOwner,
    switch: SavedSwitch,
    commanded: SavedCommands,
    /// The loop failed: the flight counts as interrupted.
    is_broken: bool,
    recovery: Option<Recovery>,
    /// The interrupted flight is not recovered: what it held is to be released.
    left: bool,
}

impl Restart {
    /// Evaluates the state left by the last flight, and stores that of this one
    /// from here on. Returns a message, if there is one; without a usable file,
    /// only that.
    pub(super) fn begin(request: RestartRequest) -> (Option<Self>, Option<String>) {
        let (lock, foreign) = match prepare(&request.path) {
            Ok(prepared) => prepared,
            Err(message) => return (None, Some(message)),
        };
        let read = state_file::read(&request.path);
        if let Err(error @ (StateFileError::Foreign | StateFileError::Unreadable(_))) = &read {
            return (None, Some(format!("{}: {error}", request.path.display())));
        }
        let keeper = match Keeper::start(request.path.clone()) {
            Ok(keeper) => keeper,
            Err(error) => return (None, Some(format!("no thread for the state file: {error}"))),
        };
        let now = BootInstant::now();
        let of_this_plant = matches!(&read, Ok(Some(saved)) if saved.config == request.fingerprint);
        let (recovery, message) = evaluate(&request, read, now.as_ref());
        let message = match (foreign, message) {
            (Some(foreign), Some(message)) => Some(format!("{foreign}; {message}")),
            (foreign, message) => foreign.or(message),
        };
        if recovery.is_none() {
            keeper.clear();
        }
        let this = Self {
            boot: now,
            _lock: lock,
            keeper,
            kept: None,
            plans: NotedPlans::of(recovery.as_ref().and_then(Recovery::plan).cloned()),
            engaged_since: None,
            recoveries: 0,
            switch_owner: SwitchOwner::default(),
            switch: SavedSwitch::default(),
            commanded: recovery
                .as_ref()
                .map_or_else(SavedCommands::default, Recovery::commands),
            is_broken: false,
            left: of_this_plant && recovery.is_none(),
            recovery,
            request,
        };
        (Some(this), message)
    }

    /// Whether an interrupted flight was found not to be recovered since the
    /// last call: it may have left the controls held.
    pub(super) const fn takes_over_release(&mut self) -> bool {
        std::mem::replace(&mut self.left, false) && self.request.release_left_held
    }

    /// Processes a message of the loop.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        if let Some(recovery) = &mut self.recovery {
            recovery.take(message);
        }
        match message {
            Message::Event(event) => self.event(event),
            Message::Tick(record) => {
                let switch = record.measurements.engage_switch;
                if !switch.is_never() && self.switch_owner.owns(switch.source) {
                    self.switch = SavedSwitch {
                        on: switch.value == Switch::On,
                        source: switch.source,
                    };
                }
                if record.state == State::Engaged {
                    let resume = Resume {
                        progress: record.setpoints.guidance,
                        surfaces: record.outputs,
                        altimeter_setting_pa: Some(record.setpoints.altimeter_setting_pa),
                        altitude_reference: record.setpoints.altitude_reference,
                        took_off: record.setpoints.took_off,
                    };
                    let place = SavedPlace::of(&record.measurements, record.tick.woke);
                    let plan = SavedPlan {
                        hash: record.setpoints.plan_hash,
                        uploaded_unix_s: record.setpoints.plan_uploaded_unix_s,
                    };
                    self.keep(resume, place, plan);
                }
            }
        }
    }

    fn event(&mut self, event: &FlightEvent) {
        match event.kind {
            // A loop that failed did not end its flight regularly.
            EventKind::StateChanged {
                from: State::Engaged,
                ..
            } if !self.is_broken => {
                self.kept = None;
                self.engaged_since = None;
                self.recoveries = 0;
                self.keeper.clear();
            }
            EventKind::Panicked | EventKind::TimerFailed => self.is_broken = true,
            EventKind::CommandReceived(LoopCommand::Controller(command))
                if self.commanded.note(&command) =>
            {
                // It is stored with the next tick.
                self.kept = None;
            }
            _ => {}
        }
    }

    /// Continues the recovery, if there is a flight to recover.
    /// `before_control` is called directly before control is taken. Returns a
    /// message about new developments.
    pub(super) fn poll(
        &mut self,
        commands: &mut CommandSender<AutopilotCommand>,
        before_control: impl FnOnce(),
    ) -> Option<String> {
        if let Some(message) = self.keeper.trouble() {
            return Some(message);
        }
        let recovery = self.recovery.as_mut()?;
        let next = recovery.next(
            self.boot.as_ref().and_then(BootInstant::again),
            self.request.max_age,
        );
        match next {
            Next::Wait => None,
            Next::Command(resume) => {
                before_control();
                recovery.command(commands, resume);
                None
            }
            Next::Recovered(message) => {
                self.recoveries = recovery.recoveries() + 1;
                self.recovery = None;
                // Including the number of recoveries.
                self.kept = None;
                Some(message)
            }
            Next::NotRecovered(message) => {
                self.recovery = None;
                self.left = true;
                self.keeper.clear();
                Some(message)
            }
        }
    }

    /// The flight is over; waits for the disk, for a limited time.
    pub(super) fn end(self) {
        self.keeper.end();
    }

    /// The plans that may have replaced the configuration's.
    const fn plans(&mut self) -> &mut NotedPlans {
        &mut self.plans
    }

    fn keep(&mut self, resume: Resume, place: SavedPlace, plan: SavedPlan) {
        let since = *self.engaged_since.get_or_insert_with(Instant::now);
        if self.recoveries > 0 && since.elapsed() >= STABLE_AFTER {
            self.recoveries = 0;
        }
        let is_due = self.kept.is_none_or(|(at, progress, hash)| {
            at.elapsed() >= KEEP_EVERY || hash != plan.hash || differ(&progress, &resume.progress)
        });
        // The state of the flight to recover is kept until the recovery is
        // decided.
        if !is_due || self.recovery.is_some() {
            return;
        }
        self.kept = Some((Instant::now(), resume.progress, plan.hash));
        // The boot does not change while the process lives.
        let Some(at) = self.boot.as_ref().and_then(BootInstant::again) else {
            return;
        };
        let saved = Saved {
            at,
            config: self.request.fingerprint,
            switch: self.switch,
            recoveries: self.recoveries,
            place,
            plan,
            resume,
            commanded: self.commanded,
        };
        self.keeper.keep(saved, self.plans.flown(plan.hash));
    }
}

/// Creates the folder, and ensures that no other daemon uses the same file. A message beside
/// the lock if it is another user's: that one may hold it, without any daemon.
fn prepare(path: &Path) -> Result<(File, Option<String>), String> {
    let message = |doing: &str, error: &dyn std::fmt::Display| {
        format!(
            "{}: {doing}, so this flight cannot be recovered after a restart: {error}",
            path.display()
        )
    };
    if let Some(folder) = path.parent()
        && !folder.as_os_str().is_empty()
    {
        fcc_record::create_folder(folder)
            .map_err(|error| message("its folder cannot be created", &error))?;
    }
    let lock_path = path.with_extension("flight.lock");
    let lock =
        fcc_record::open_lock(&lock_path).map_err(|error| message("cannot be locked", &error))?;
    match fcc_telemetry::file_lock::try_lock(&lock) {
        Ok(true) => Ok((lock, None)),
        Ok(false) if other_user(&lock).is_some() => {
            let user = other_user(&lock).unwrap_or_default();
            let foreign = format!(
                "{}: belongs to the user {user}, who holds it: it is not heeded; use a \
                 restart.state_file in a folder of this user",
                lock_path.display()
            );
            Ok((lock, Some(foreign)))
        }
        Ok(false) => Err(message(
            "another fccd uses it",
            &"give this one another restart.state_file",
        )),
        Err(error) => Err(message("cannot be locked", &error)),
    }
}

/// The user of a file, if that is neither this process' nor root.
fn other_user(file: &File) -> Option<u32> {
    let user = file.metadata().ok()?.uid();
    (user != 0 && user != nix::unistd::geteuid().as_raw()).then_some(user)
}

/// What to do with the state that was found, and the message about it.
fn evaluate(
    request: &RestartRequest,
    read: Result<Option<Saved>, StateFileError>,
    now: Option<&BootInstant>,
) -> (Option<Recovery>, Option<String>) {
    let stands_by = |why: &str| {
        let message = format!("{}: {why}; staying in standby", request.path.display());
        (None, Some(message))
    };
    let saved = match read {
        Ok(Some(saved)) => saved,
        Ok(None) => return (None, None),
        Err(error) => return stands_by(&error.to_string()),
    };
    let Some(age) = now.and_then(|now| now.since(&saved.at)) else {
        return stands_by("a flight was interrupted before this machine was last started");
    };
    let interrupted = format!("a flight was interrupted {:.1} s ago", age.as_secs_f64());
    if request.mode == RestartMode::Cold {
        return stands_by(&format!("{interrupted}, and restart.mode is \"cold\""));
    }
    if age > request.max_age {
        return stands_by(&format!(
            "{interrupted}, longer than restart.max_age_s, {} s",
            request.max_age.as_secs_f64()
        ));
    }
    if saved.config != request.fingerprint {
        return stands_by(&format!(
            "{interrupted}, and flown with another configuration"
        ));
    }
    if saved.recoveries >= MAX_RECOVERIES {
        return stands_by(&format!(
            "{interrupted}, and recovered {} times in a row before",
            saved.recoveries
        ));
    }
    let plan = match kept_plan::restore(&request.path, saved.plan, &request.config) {
        Ok(plan) => plan.map(Arc::new),
        Err(why) => return stands_by(&format!("{interrupted}, and {why}")),
    };
    let message = format!("{}: {interrupted}; recovering it", request.path.display());
    (Some(Recovery::new(saved, plan)), Some(message))
}

/// Whether the mode differs, or its captured values differ by more than a small
/// change.
fn differ(kept: &Progress, now: &Progress) -> bool {
    let (was, is) = (kept.captured, now.captured);
    kept.mode != now.mode
        || (was.airspeed_mps - is.airspeed_mps).abs() > CHANGE.airspeed_mps
        || (was.heading_rad - is.heading_rad).abs() > CHANGE.heading_rad
        || (was.altitude_m - is.altitude_m).abs() > CHANGE.altitude_m
}

#[cfg(test)]
mod tests;
