//! In-flight recovery: a daemon that was killed in flight and started again
//! continues what was flown, or stays in standby and reports it.
//!
//! While the loop is engaged, its state is [stored](keeper) in a small
//! [file](state_file): at every change of the set points, and each second. A
//! flight that ends regularly removes the file, so a file found at the start
//! belongs to an interrupted flight. Its age is measured by the kernel's clock
//! since boot; the time of day is not used.

mod boot_clock;
mod found;
mod keeper;
mod kept_plan;
mod observer;
mod recovery;
mod saved;
mod state_file;
mod state_page;

use std::fs::File;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use fcc_core::framework::{EventKind, LoopCommand, Message, State, Switch};
use fcc_fixed_wing::{AutopilotCommand, Resume};
use fcc_guidance::{Progress, Targets};
use fcc_runtime::{CommandSender, SwitchOwner};
use fcc_telemetry::{FlightEvent, FlightMessage};

use crate::config::{Config, RestartMode};
use boot_clock::BootInstant;
use found::{Found, Looked, Search};
use keeper::Keeper;
use kept_plan::NotedPlans;
pub(super) use observer::RestartKeeper;
use recovery::{Next, Recovery};
use saved::{Saved, SavedCommands, SavedPlan, SavedSwitch};
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

/// The state file, as far as it is known.
enum StateFile {
    /// The disk has not answered yet.
    Searched { search: Search, was_engaged: bool },
    /// It is this flight's. The lock is held until the process ends in any way.
    Ours { _lock: Option<File> },
    /// It is another program's, or cannot be used.
    Unusable,
}

/// Stores the state of the flight, and recovers an interrupted one.
pub(super) struct Restart {
    request: RestartRequest,
    boot: Option<BootInstant>,
    file: StateFile,
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
    /// only that. If the disk does not answer, that is [polled](Self::poll).
    pub(super) fn begin(request: RestartRequest) -> (Option<Self>, Option<String>) {
        let looked = request.clone();
        Self::begin_by(request, move || found::look(&looked))
    }

    fn begin_by(
        request: RestartRequest,
        look: impl FnOnce() -> Looked + Send + 'static,
    ) -> (Option<Self>, Option<String>) {
        let no_thread = |error| (None, Some(format!("no thread for the state file: {error}")));
        let keeper = match Keeper::start(request.path.clone()) {
            Ok(keeper) => keeper,
            Err(error) => return no_thread(error),
        };
        let search = match Search::begin(look) {
            Ok(search) => search,
            Err(error) => return no_thread(error),
        };
        let mut this = Self {
            boot: BootInstant::now(),
            file: StateFile::Unusable,
            keeper,
            kept: None,
            plans: NotedPlans::default(),
            engaged_since: None,
            recoveries: 0,
            switch_owner: SwitchOwner::default(),
            switch: SavedSwitch::default(),
            commanded: SavedCommands::default(),
            is_broken: false,
            left: false,
            recovery: None,
            request,
        };
        match search {
            Ok(Err(message)) => (None, Some(message)),
            Ok(Ok(found)) => {
                let message = this.found(found, false);
                (Some(this), message)
            }
            Err(search) => {
                this.file = StateFile::Searched {
                    search,
                    was_engaged: false,
                };
                (Some(this), None)
            }
        }
    }

    /// Takes up what the last flight left, unless another one `was_engaged` meanwhile.
    fn found(&mut self, found: Found, was_engaged: bool) -> Option<String> {
        self.file = StateFile::Ours { _lock: found.lock };
        self.left = found.left && !was_engaged;
        self.recovery = found.recovery.filter(|_| !was_engaged);
        if let Some(recovery) = &self.recovery {
            self.plans.recovered(recovery.plan().cloned());
            self.commanded = recovery.commands();
            return found.message;
        }
        self.clear();
        if !was_engaged {
            return found.message;
        }
        Some(format!(
            "{}: its disk answers again; the flight since then is continued after a restart, and \
             none before it",
            self.request.path.display()
        ))
    }

    const fn is_ours(&self) -> bool {
        matches!(self.file, StateFile::Ours { .. })
    }

    /// Removes the stored state, unless the file is not ours, or not known to be.
    fn clear(&self) {
        if self.is_ours() {
            self.keeper.clear();
        }
    }

    /// Looks whether the disk has answered; a message, if there is one.
    fn look_again(&mut self) -> Option<String> {
        let StateFile::Searched {
            search,
            was_engaged,
        } = &mut self.file
        else {
            return None;
        };
        let was_engaged = *was_engaged;
        let Some(looked) = search.poll() else {
            return search.late(&self.request.path);
        };
        self.file = StateFile::Unusable;
        looked.map_or_else(Some, |found| self.found(found, was_engaged))
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
        if let StateFile::Searched { was_engaged, .. } = &mut self.file {
            *was_engaged |= matches!(message, Message::Tick(tick) if tick.state == State::Engaged);
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
                    let plan = SavedPlan {
                        hash: record.setpoints.plan_hash,
                        uploaded_unix_s: record.setpoints.plan_uploaded_unix_s,
                    };
                    self.keep(resume, plan);
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
                self.clear();
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
        if let Some(message) = self.look_again() {
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
                self.clear();
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

    fn keep(&mut self, resume: Resume, plan: SavedPlan) {
        let since = *self.engaged_since.get_or_insert_with(Instant::now);
        if self.recoveries > 0 && since.elapsed() >= STABLE_AFTER {
            self.recoveries = 0;
        }
        let is_due = self.kept.is_none_or(|(at, progress, hash)| {
            at.elapsed() >= KEEP_EVERY || hash != plan.hash || differ(&progress, &resume.progress)
        });
        // The state of the flight to recover is kept until the recovery is
        // decided.
        if !is_due || self.recovery.is_some() || !self.is_ours() {
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
            plan,
            resume,
            commanded: self.commanded,
        };
        self.keeper.keep(saved, self.plans.flown(plan.hash));
    }
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
