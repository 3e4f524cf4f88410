//! The connection to X-Plane, as people see it from outside the loop.

use std::time::{Duration, Instant};

use fcc_xplane::{
    Control, Missing, Released, SimulatorState, Trouble, XPlane, XPlaneConfig, XPlaneStatus,
};

use super::guard::Guard;
use super::relief::{Relief, relieve};
use crate::config::XPlaneSection;

/// Trouble that lasts this long is worth a word: at the start, X-Plane has
/// not had the time to answer.
const PATIENCE: Duration = Duration::from_secs(1);

/// How long the end of a flight waits for X-Plane to show that it has its
/// controls back.
const GIVE_BACK_WITHIN: Duration = Duration::from_secs(5);

/// While control is held, it is looked this often for a guard of an earlier
/// daemon that gives it away; looking is one refused connection.
const RELIEVE_EVERY: Duration = Duration::from_secs(1);

/// Watches the connection to X-Plane, and keeps the guard informed.
pub(super) struct Connection {
    status: XPlaneStatus,
    section: XPlaneSection,
    guard: Option<Guard>,
    /// What is to be reported next.
    waiting: Option<String>,
    trouble: Option<(Trouble, Instant)>,
    told: Told,
    pace: SimulatorState,
    /// What was last reported as missing.
    missing: Vec<Missing>,
    /// When a guard was last looked for.
    relieved: Instant,
}

/// What was said last of the connection.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Told {
    Nothing,
    Trouble(Trouble),
    Good,
}

impl Connection {
    /// Watches from now on. Without a guard the flight goes on, and says so.
    pub(super) fn watch(status: XPlaneStatus, section: &XPlaneSection) -> Self {
        let (guard, waiting) = match Guard::start(section) {
            Ok(guard) => (Some(guard), None),
            Err(error) => (
                None,
                Some(format!(
                    "no guard process ({error}): if this process is killed, release X-Plane's \
                     overrides by hand"
                )),
            ),
        };
        Self {
            status,
            section: section.clone(),
            guard,
            waiting,
            trouble: None,
            told: Told::Nothing,
            pace: SimulatorState::Running,
            missing: Vec::new(),
            relieved: Instant::now(),
        }
    }

    /// What has changed, in words; none if there is nothing to say.
    pub(super) fn poll(&mut self) -> Option<String> {
        if self.status.control() == Control::Held && self.relieved.elapsed() >= RELIEVE_EVERY {
            self.take_over_from_release_helper();
        }
        if let Some(guard) = &mut self.guard {
            guard.tell(self.status.held_at());
        }
        let now = self.status.trouble();
        if let Some(words) = self.waiting.take() {
            return Some(words);
        }
        if self.trouble.map(|(trouble, _)| trouble) != now {
            self.trouble = now.map(|trouble| (trouble, Instant::now()));
        }
        match self.trouble {
            Some((trouble, since)) => {
                let worth = since.elapsed() >= PATIENCE && self.told != Told::Trouble(trouble);
                worth.then(|| {
                    self.told = Told::Trouble(trouble);
                    trouble.to_string()
                })
            }
            None => self
                .good_news()
                .or_else(|| self.change_of_pace())
                .or_else(|| self.change_of_missing()),
        }
    }

    /// Sends away the guard of a daemon that was killed, if one still releases
    /// the controls that are, or are to be, held here.
    pub(super) fn take_over_from_release_helper(&mut self) {
        self.relieved = Instant::now();
        if let Some(simulator) = self.status.simulator()
            && relieve(simulator) == Relief::Stays
        {
            self.waiting = Some(
                "the guard of the daemon before this one does not go: it may hold X-Plane's \
                 controls back"
                    .to_owned(),
            );
        }
    }

    /// Nothing is wrong; in words if something was, or at the first contact.
    fn good_news(&mut self) -> Option<String> {
        let simulator = self.status.simulator()?;
        match std::mem::replace(&mut self.told, Told::Good) {
            Told::Good => None,
            // Who no longer writes does not know whether it would work now.
            Told::Trouble(Trouble::Unconfirmed(_)) => (self.status.control() == Control::Held)
                .then(|| format!("the controls written to X-Plane at {simulator} take effect")),
            Told::Nothing => Some(format!(
                "X-Plane at {simulator} answers; what engages is {}",
                self.status.engage_switch()
            )),
            Told::Trouble(_) => Some(format!("X-Plane at {simulator} answers")),
        }
    }

    /// Whether X-Plane is paused or slow, if that has changed.
    fn change_of_pace(&mut self) -> Option<String> {
        let now = self.status.state();
        let words = match now {
            // The loop tells of both itself, one as a sensor and one as a plant.
            SimulatorState::Silent | SimulatorState::Jumped => return None,
            SimulatorState::Running => "X-Plane's time runs again",
            SimulatorState::Paused => "X-Plane is paused",
            SimulatorState::Stalled => "X-Plane's time stands still, but it does not say paused",
            SimulatorState::Slow => {
                "X-Plane is slow: fewer than 20 frames a second, or its time falls behind"
            }
        };
        let before = std::mem::replace(&mut self.pace, now);
        (before != now).then(|| words.to_owned())
    }

    /// A value that X-Plane does not send though it was asked for, or that it
    /// sends after all: each is reported once, one at a time.
    fn change_of_missing(&mut self) -> Option<String> {
        let now = self.status.missing();
        if let Some(lost) = now.iter().find(|what| !self.missing.contains(what)) {
            self.missing.push(lost.clone());
            return Some(lost.to_string());
        }
        let back = self.missing.iter().position(|what| !now.contains(what))?;
        let what = self.missing.swap_remove(back).what();
        Some(format!("X-Plane now sends {what}"))
    }

    /// The flight is over. Waits until X-Plane shows that control is back, if
    /// it was ever taken; whether it is.
    ///
    /// Sending a release is not enough: an X-Plane that hangs loses it, and
    /// would fly on with its yoke held when it comes back.
    pub(super) fn end(self) -> bool {
        let released = match self.status.held_at() {
            None => true,
            Some(simulator) => {
                let config = XPlaneConfig::from(&self.section);
                let released = XPlane::release_and_wait(&config, simulator, GIVE_BACK_WITHIN);
                matches!(released, Ok(Released::Confirmed | Released::Gone))
            }
        };
        // A guard that is not dismissed sees the pipe end, and goes on trying.
        if let Some(guard) = self.guard.filter(|_| released) {
            guard.dismiss();
        }
        released
    }
}
