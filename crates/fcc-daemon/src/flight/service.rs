//! What systemd is told of a flight, if it started the daemon (`sd_notify(3)`).
//!
//! The watchdog's sign comes from the loop's own progress: it is sent by who
//! fetches the loop's records, and only when new ones have come. A loop that
//! hangs falls silent here, and so does a daemon that no longer fetches.

use std::time::{Duration, Instant};

use fcc_core::framework::{Controller, Flags, Message, State, StateCode};
use fcc_telemetry::{FlightMessage, FlightRecord};
use sd_notify::NotifyState;

use super::Pilot;

/// Signs per time-out of the watchdog: one may be late, or two.
const SIGNS_PER_TIMEOUT: u32 = 4;

/// Tells systemd how the flight goes; where nobody listens, nothing comes of
/// it.
pub(super) struct Service {
    listens: bool,
    sign_every: Option<Duration>,
    signed: Option<Instant>,
    /// What the newest record says, if it has not been looked at.
    news: Option<Condition>,
    told: Option<Condition>,
}

/// What a status line is made of.
#[derive(Clone, Copy, PartialEq)]
struct Condition {
    state: StateCode,
    blockers: Flags,
}

impl Service {
    /// Speaks with whoever the environment names.
    pub(super) fn from_environment() -> Self {
        Self {
            listens: std::env::var_os("NOTIFY_SOCKET").is_some(),
            sign_every: sd_notify::watchdog_enabled().map(|within| within / SIGNS_PER_TIMEOUT),
            signed: None,
            news: None,
            told: None,
        }
    }

    /// Takes what the loop tells.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        if let Message::Tick(record) = message {
            self.news = Some(Condition::of(record));
        }
    }

    /// Passes on what is new: nothing if no tick came since the last time.
    pub(super) fn tell(&mut self) {
        let Some(now) = self.news.take().filter(|_| self.listens) else {
            return;
        };
        if self.told != Some(now) {
            let status = now.words();
            let status = NotifyState::Status(&status);
            match self.told.replace(now) {
                None => send(&[NotifyState::Ready, status]),
                Some(_) => send(&[status]),
            }
        }
        if let Some(every) = self.sign_every
            && self.signed.is_none_or(|at| at.elapsed() >= every)
        {
            self.signed = Some(Instant::now());
            send(&[NotifyState::Watchdog]);
        }
    }

    /// The loop is over, and what is left may take its time.
    pub(super) fn stopping(&self) {
        if self.listens {
            send(&[NotifyState::Stopping, NotifyState::Status("ending")]);
        }
    }
}

impl Condition {
    fn of(record: &FlightRecord) -> Self {
        Self {
            state: record.state,
            blockers: record.blockers,
        }
    }

    fn words(self) -> String {
        let mut words = self.state.to_string();
        let because = match self.state.state() {
            State::Failsafe(_) => self.state.flags(),
            State::Standby => self.blockers,
            State::Engaged | State::Stopped => Flags::NONE,
        };
        for (n, bit) in because.iter().enumerate() {
            words.push_str(if n == 0 { ": " } else { ", " });
            words.push_str(Pilot::flag_name(bit));
        }
        words
    }
}

/// A manager that does not listen is no reason to stop flying.
fn send(states: &[NotifyState<'_>]) {
    let _ = sd_notify::notify(states);
}
