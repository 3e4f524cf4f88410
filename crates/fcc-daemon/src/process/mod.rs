//! The daemon as a process: what a flight needs of the program around it.
//!
//! | module | what it does |
//! |---|---|
//! | `release_helper`, `release_handover` | a second process that releases the controls if this one is killed |
//! | `instance_lock` | keeps two daemons from one plant |
//! | `signals` | the signals that end a flight, and those that must not |

mod instance_lock;
mod release_handover;
mod release_helper;
mod signals;

use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use fcc_core::framework::{ControlAuthority, PlantId};
use fcc_flight::config::Config;
use fcc_flight::flight::Host;
use fcc_runtime::StopHandle;

use crate::exit::Exit;
use crate::output;
use instance_lock::InstanceLock;
pub(crate) use release_helper::{ReleaseHelper, run_release_helper};
use signals::{BlockedSignals, Caught};
pub(crate) use signals::{end_with_parent, tolerate};

/// While control is held, this is the interval of checks for a release helper
/// of an earlier daemon, which would release it; a check is one refused
/// connection.
const CHECK_EVERY: Duration = Duration::from_secs(1);
/// A release helper that has ended is started again this often.
const HELPERS_AGAIN: u32 = 5;

/// This process, as the host of one flight.
pub(crate) struct Process<'a> {
    config: &'a Config,
    blocked_signals: Option<BlockedSignals>,
    caught: Caught,
    plant: Option<Plant>,
}

/// What outlives the process, or is shared with other processes.
struct Plant {
    authority: Arc<dyn ControlAuthority>,
    lock: InstanceLock,
    helper: Option<ReleaseHelper>,
    /// How often it may still be started again.
    helpers_again: u32,
    /// When the helpers, this daemon's and an earlier one's, were last checked.
    checked: Instant,
}

impl<'a> Process<'a> {
    /// For a flight by this configuration.
    pub(crate) fn new(config: &'a Config) -> Self {
        Self {
            config,
            blocked_signals: None,
            caught: Caught::default(),
            plant: None,
        }
    }
}

impl Host for Process<'_> {
    fn prepare(&mut self, authority: Option<&Arc<dyn ControlAuthority>>) -> io::Result<()> {
        let lock = authority.map(|authority| InstanceLock::of(Arc::clone(authority)));
        self.blocked_signals =
            Some(BlockedSignals::in_new_threads().map_err(|error| uncaught(&error))?);
        self.plant = authority.zip(lock).map(|(authority, lock)| Plant {
            authority: Arc::clone(authority),
            helper: lock
                .taken()
                .is_none()
                .then(|| start_helper(self.config))
                .flatten(),
            lock,
            helpers_again: HELPERS_AGAIN,
            checked: Instant::now(),
        });
        Ok(())
    }

    fn attach(&mut self, stop: &StopHandle) -> io::Result<()> {
        self.caught = signals::stop_by(stop).map_err(|error| uncaught(&error))?;
        Ok(())
    }

    fn started(&mut self) {
        self.blocked_signals = None;
    }

    fn poll(&mut self) {
        if self.caught.suspended.swap(false, Ordering::Relaxed) {
            output::message("Ctrl-Z does not stop a flight; Ctrl-C ends it");
        }
        if let Some(plant) = &mut self.plant {
            plant.lock.follow();
            let held = plant.authority.held();
            if plant.checked.elapsed() >= CHECK_EVERY {
                plant.checked = Instant::now();
                if held.is_some() {
                    plant.end_earlier_helper();
                }
                plant.replace_helper(self.config);
            }
            if let Some(helper) = &mut plant.helper {
                helper.report(held);
            }
        }
    }

    fn taken_by_another(&self) -> Option<PlantId> {
        self.plant.as_ref()?.lock.taken()
    }

    fn before_control(&mut self) {
        if let Some(plant) = &self.plant {
            plant.end_earlier_helper();
        }
    }

    /// Ends at once, like a crash: the orderly exit had its time, and may wait
    /// for a thread that hangs.
    fn last_resort(&self) -> Box<dyn FnOnce(bool) + Send> {
        Box::new(|released| {
            let exit = if released {
                Exit::Hung
            } else {
                Exit::NotReleased
            };
            signal_hook::low_level::exit(i32::from(exit as u8));
        })
    }

    fn continues_release(&self) -> &'static str {
        match &self.plant {
            Some(Plant {
                helper: Some(_), ..
            }) => "; the release helper continues for two minutes",
            _ => "",
        }
    }

    /// A helper that is not ended here reads the end of the pipe, and continues
    /// the release.
    fn end(&mut self, released: bool) {
        let helper = self.plant.as_mut().and_then(|plant| plant.helper.take());
        if let Some(helper) = helper.filter(|_| released) {
            helper.end();
        }
    }

    fn interrupted_by(&self) -> Option<&'static str> {
        self.caught.interrupted_by()
    }
}

impl Plant {
    /// Ends the helper of a daemon that was killed, if it still releases the
    /// controls that are, or are to be, held here.
    fn end_earlier_helper(&self) {
        if let Some(plant) = self.authority.plant() {
            release_handover::end_helper(&plant);
        }
    }

    /// Starts the helper again if it has ended: it was killed, for example for
    /// want of memory.
    fn replace_helper(&mut self, config: &Config) {
        if !self.helper.as_mut().is_some_and(ReleaseHelper::has_ended) {
            return;
        }
        self.helper = None;
        if self.helpers_again == 0 {
            output::message(format!(
                "the release helper has ended again, and is not started any more: {BY_HAND}"
            ));
            return;
        }
        self.helpers_again -= 1;
        self.helper = start_helper(config);
        if self.helper.is_some() {
            output::message("the release helper had ended, and was started again");
        }
    }
}

const BY_HAND: &str = "if this process is killed, release the controls by hand";

/// Without a helper the flight continues, and this is reported.
pub(crate) fn start_helper(config: &Config) -> Option<ReleaseHelper> {
    ReleaseHelper::start(config)
        .inspect_err(|error| {
            output::message(format!("no release helper ({error}): {BY_HAND}"));
        })
        .ok()
}

fn uncaught(error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("signals cannot be caught: {error}"))
}
