//! The daemon as a process: what a flight needs of the program around it.
//!
//! | module | what it does |
//! |---|---|
//! | `release_helper`, `release_handover` | a second process that releases the controls if this one is killed |
//! | `daemon_pipe` | that process' end of the pipe from this one |
//! | `kept_helper` | starts that process again if it has ended |
//! | `notice` | tells that process, and the plant's file, before control is taken |
//! | `own_program` | starts this program again, as one of its helpers |
//! | `plant_file` | a file of this user alone: who may control a plant, and whether it was left held |
//! | `instance_lock` | keeps two daemons from one plant |
//! | `left_held` | releases what a killed daemon left held |
//! | `rights` | gives up the rights of root before a flight |
//! | `signals` | the signals that end a flight, and those that must not |
//! | `stack` | the limit on the stack |

mod daemon_pipe;
mod instance_lock;
mod kept_helper;
mod left_held;
mod notice;
mod own_program;
mod plant_file;
mod release_handover;
mod release_helper;
mod rights;
mod signals;
mod stack;
pub(crate) mod standard_output;

use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use fcc_core::framework::{ControlAuthority, PlantId, Released, TakeoverNotice};
use fcc_flight::config::Config;
use fcc_flight::flight::Host;
use fcc_runtime::StopHandle;
use fcc_telemetry::RunFolder;

use crate::exit::Exit;
use crate::output;
pub(crate) use daemon_pipe::DaemonPipe;
use instance_lock::InstanceLock;
use kept_helper::KeptHelper;
use left_held::LeftHeld;
pub(crate) use notice::Notice;
#[cfg(fuzzing)]
pub use notice::use_plant_file;
#[cfg(feature = "live")]
pub(crate) use own_program::own_program;
pub(crate) use own_program::{begin_helper, outlive_signals};
pub(crate) use plant_file::{Mark, is_flown};
pub(crate) use release_helper::{ReleaseHelper, run_release_helper};
pub(crate) use rights::{RightsError, give_up, unknown_names};
use signals::{BlockedSignals, Caught};
pub(crate) use signals::{end_with_parent, survive_file_size_limit, tolerate};
pub(crate) use stack::raise_stack_limit;

/// The interval of checks of the lock's file and, while control is held, for a
/// release helper of an earlier daemon, which would release it.
const CHECK_EVERY: Duration = Duration::from_secs(1);

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
    notice: &'static Notice,
    lock: InstanceLock,
    left_held: LeftHeld,
    helper: KeptHelper,
    was_held: bool,
    /// Where a plant's answers come from, as the helper knows it.
    answers: Option<(PlantId, u16)>,
    /// When an earlier daemon's helper was last looked for.
    checked: Instant,
    /// When the lock was last looked at.
    lock_checked: Instant,
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
        let plant = authority.map(|authority| Plant::of(Arc::clone(authority), self.config));
        self.blocked_signals =
            Some(BlockedSignals::in_new_threads().map_err(|error| uncaught(&error))?);
        self.plant = plant;
        if let Some(plant) = &mut self.plant
            && plant.lock.taken().is_none()
        {
            plant.helper.start(self.config, plant.notice, None);
        }
        Ok(())
    }

    fn attach(&mut self, stop: &StopHandle) -> io::Result<()> {
        self.caught = signals::stop_by(stop).map_err(|error| uncaught(&error))?;
        Ok(())
    }

    fn started(&mut self) {
        self.blocked_signals = None;
    }

    fn poll(&mut self, report: &mut dyn FnMut(String)) {
        if self.caught.suspended.swap(false, Ordering::Relaxed) {
            output::message("Ctrl-Z does not stop a flight; Ctrl-C ends it");
        }
        if let Some(plant) = &mut self.plant {
            plant.poll(self.config, report);
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
        match self.plant.as_ref().and_then(|plant| plant.helper.id()) {
            Some(_) => "; the release helper continues for two minutes",
            None => "",
        }
    }

    /// The end of this process may come late: its output and its disk may wait.
    fn continue_release(&mut self) -> &'static str {
        if let Some(plant) = &self.plant {
            plant.notice.end();
        }
        self.continues_release()
    }

    /// A helper that is not ended here releases after the end of the process:
    /// only then can nothing take control again.
    fn end(&mut self, released: Released) {
        if let Some(plant) = self.plant.as_mut().filter(|_| released.is_over()) {
            // One that has ended may have been a relay: the next start looks again.
            if released == Released::Confirmed {
                plant.notice.release(plant.notice.number());
            }
            plant.helper.end();
            plant.lock.remove_files();
        }
    }

    fn interrupted_by(&self) -> Option<&'static str> {
        self.caught.interrupted_by()
    }
}

impl Plant {
    fn of(authority: Arc<dyn ControlAuthority>, config: &Config) -> Self {
        let folder = RunFolder::of_this_process(&mut |why| output::message(why));
        if folder.is_none() {
            output::message("without a folder of this user, a second fccd is not prevented");
        }
        if std::process::id() == 1 {
            output::message(FIRST_PROCESS);
        }
        let notice = Notice::of_this_process();
        authority.notify(notice);
        let now = Instant::now();
        let mut this = Self {
            lock: InstanceLock::of(Arc::clone(&authority), folder, notice),
            authority,
            notice,
            left_held: LeftHeld::new(&config.restart),
            helper: KeptHelper::none(),
            was_held: false,
            answers: None,
            checked: now,
            lock_checked: now,
        };
        this.follow();
        this
    }

    fn follow(&mut self) {
        if self.lock.follow() {
            self.left_held.found();
        }
    }

    fn poll(&mut self, config: &Config, report: &mut dyn FnMut(String)) {
        self.follow();
        // In this order: a takeover in between is then not counted as released.
        let number = self.notice.number();
        let held = self.authority.held();
        match held {
            // What an earlier program left is being released.
            Some(plant) if self.notice.is_released() => self.notice.taking(&plant),
            Some(_) => {}
            None => self.notice.release(number),
        }
        if self.lock_checked.elapsed() >= CHECK_EVERY {
            self.lock_checked = Instant::now();
            if let Some(removed) = self.lock.make_anew_if_removed(held) {
                report(removed.to_string());
            }
        }
        self.left_held.poll(self.authority.as_ref(), held, report);
        let begins = held.is_some() && !self.was_held;
        self.was_held = held.is_some();
        if begins || (held.is_some() && self.checked.elapsed() >= CHECK_EVERY) {
            self.checked = Instant::now();
            self.end_earlier_helper();
            if let Some(plant) = &held {
                self.notice.store_again(plant);
            }
        }
        if let Some(plant) = held.filter(|_| begins) {
            self.authority.prepare_release(&plant);
        }
        if self.lock.taken().is_none() && self.helper.keep(config, self.notice, held, report) {
            self.answers = None;
        }
        self.tell_helper_reply_port(held);
    }

    /// Tells the helper by what it knows the plant that it may have to release.
    fn tell_helper_reply_port(&mut self, held: Option<PlantId>) {
        let plant = held.or_else(|| self.authority.plant());
        let found = plant.zip(self.authority.answers_from());
        if let Some((plant, from)) = found.filter(|_| found != self.answers) {
            self.answers = found;
            self.notice.answers(plant, from);
        }
    }

    /// Ends the helper of a daemon that was killed, if it still releases the
    /// controls that are, or are to be, held here.
    fn end_earlier_helper(&self) {
        let Some((plant, folder)) = self.authority.plant().zip(self.lock.folder()) else {
            return;
        };
        let unique = self.authority.unique(&plant);
        match release_handover::end_helper(folder, &unique, self.helper.id()) {
            Ok(false) => {}
            Ok(true) => output::message("the release helper of the previous daemon was ended"),
            Err(_) => output::message(
                "the release helper of the previous daemon does not end: it may release the \
                 controls",
            ),
        }
    }
}

/// Whose end ends all others (`pid_namespaces(7)`).
const FIRST_PROCESS: &str = "this is the first process of its container: if it is killed, its \
                             release helper ends with it, and the controls stay held until the \
                             next start; start it below an init process (docker run --init)";

const BY_HAND: &str = "if this process is killed, release the controls by hand";

/// Without a helper the flight continues, and this is reported.
pub(crate) fn start_helper(
    config: &Config,
    notice: &Notice,
    held: Option<PlantId>,
) -> Option<ReleaseHelper> {
    ReleaseHelper::start(config, notice, held)
        .inspect_err(|error| {
            output::message(format!("no release helper ({error}): {BY_HAND}"));
        })
        .ok()
}

fn uncaught(error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("signals cannot be caught: {error}"))
}
