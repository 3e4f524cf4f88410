//! The status of the connection, for users and other threads.

use core::fmt;
use core::sync::atomic::{AtomicU64, Ordering};
use std::net::SocketAddr;
use std::sync::Arc;

use fcc_core::framework::TakeoverNotice;

use crate::config::DataRows;
use crate::engage_switch::lights_if_beyond;
use crate::link::{Control, SharedState};
use crate::missing::Missing;
use crate::no_answer::{InWords, Why};
use crate::quantity::Quantity;
use crate::simulator::SimulatorState;

/// The status of the connection to X-Plane, readable from any thread without a
/// lock.
#[derive(Clone, Debug)]
pub struct XPlaneStatus {
    link: Arc<SharedState>,
    engage_switch: Arc<str>,
    /// The rows that are read, if rows are the input.
    rows: Option<DataRows>,
}

/// Counters since opening.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Counts {
    /// Datagrams from the simulator.
    pub received: u64,
    /// Datagrams beyond the number that a tick reads, dropped.
    pub discarded: u64,
    /// Datagrams from elsewhere, or from another port than the one that
    /// answers, dropped.
    pub foreign: u64,
    /// Datagrams with a wrong length or field, dropped.
    pub malformed: u64,
    /// Datagrams that are no known message, dropped.
    pub unknown: u64,
    /// Datagrams overtaken by newer ones, or older ones that arrived again, dropped.
    pub late: u64,
    /// Single implausible values, left out.
    pub implausible: u64,
    /// Jumps of the simulator's clock.
    pub jumps: u64,
    /// Requests for datarefs and for the position.
    pub requests: u64,
    /// Datagrams that write controls and overrides.
    pub writes: u64,
    /// Datagrams that the operating system refused to send.
    pub refused: u64,
}

impl XPlaneStatus {
    pub(crate) const fn new(
        link: Arc<SharedState>,
        engage_switch: Arc<str>,
        rows: Option<DataRows>,
    ) -> Self {
        Self {
            link,
            engage_switch,
            rows,
        }
    }

    pub(crate) fn link(&self) -> Arc<SharedState> {
        Arc::clone(&self.link)
    }

    /// Where the simulator is; `None` until a beacon has arrived.
    pub fn simulator(&self) -> Option<SocketAddr> {
        self.link.address.simulator()
    }

    /// The port from which it answers; `None` until it has.
    pub fn reply_port(&self) -> Option<u16> {
        self.link.reply_port()
    }

    /// The UDP port that is received on here; `None` over another
    /// [`Port`](crate::Port) than a socket.
    pub fn local_port(&self) -> Option<u16> {
        self.link.local_port()
    }

    /// From now on control is taken only where it is [allowed](Self::allow):
    /// for programs that have to check first whether another program flies
    /// there. Until then [`apply`](fcc_core::framework::Actuator::apply)
    /// reports that it is not connected.
    pub fn require_permission(&self) {
        self.link.address.allow(None);
    }

    /// Permits taking control at this address only.
    pub fn allow(&self, simulator: SocketAddr) {
        self.link.address.allow(Some(simulator));
    }

    /// From now on this is called directly before control is taken.
    pub fn notify(&self, notice: &'static dyn TakeoverNotice) {
        self.link.notify(notice);
    }

    /// The simulator's state at the last tick.
    pub fn state(&self) -> SimulatorState {
        self.link.state()
    }

    /// Who has the controls.
    pub fn control(&self) -> Control {
        self.link.control()
    }

    /// The overrides that a program that has ended left set are cleared, until
    /// X-Plane confirms it; no effect while this program controls X-Plane.
    pub fn release_left(&self) {
        self.link.set_releasing_if_free();
    }

    /// Whether an override is set that is not this program's.
    pub fn is_left_overridden(&self) -> bool {
        self.link.is_left_overridden()
    }

    /// Whether both overrides were last read as clear.
    pub(crate) fn is_clear(&self) -> bool {
        let overrides = [Quantity::OverrideJoystick, Quantity::OverrideThrottles];
        overrides
            .iter()
            .filter_map(|of| self.link.read_back.shown(*of))
            .all(|(value, _)| value < 0.5)
    }

    /// Where the controls are held, or their release is not yet confirmed, or
    /// may still be undone by a late write: for 5 s, and while one has undone it.
    pub fn held_at(&self) -> Option<SocketAddr> {
        let allowed = |at: &SocketAddr| self.link.address.is_allowed(*at);
        let held = self.link.is_held();
        self.simulator().filter(allowed).filter(|_| held)
    }

    /// Whether controls have been written for over a second without effect.
    pub fn is_unconfirmed(&self) -> bool {
        self.link.is_unconfirmed()
    }

    /// The position of the first engine's throttle lever, 0 to 1, less in
    /// reverse; once received.
    pub fn throttle_lever(&self) -> Option<f64> {
        let (lever, _) = self.link.read_back.shown(Quantity::ThrottleLever)?;
        Some(lever.into())
    }

    /// Whether the axial load in row 4 of Data Output is positive backwards: as
    /// configured, or found out.
    pub fn is_axial_backwards(&self) -> bool {
        self.link.is_axial_backwards()
    }

    /// X-Plane's version, 115501 for 11.55r01, once received.
    pub fn version(&self) -> Option<u32> {
        self.link.version()
    }

    /// Whether a wheel is on the ground, once received.
    pub fn on_ground(&self) -> Option<bool> {
        self.link.on_ground()
    }

    /// Counters since opening.
    pub fn counts(&self) -> Counts {
        let counters = &self.link.counters;
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Counts {
            received: read(&counters.received),
            discarded: read(&counters.discarded),
            foreign: read(&counters.foreign),
            malformed: read(&counters.malformed),
            unknown: read(&counters.unknown),
            late: read(&counters.late),
            implausible: read(&counters.implausible),
            jumps: read(&counters.jumps),
            requests: read(&counters.requests),
            writes: read(&counters.writes),
            refused: read(&counters.refused),
        }
    }

    /// The dataref that engages, as configured.
    pub fn engage_switch(&self) -> &str {
        &self.engage_switch
    }

    /// Requested values that do not arrive while others do: for 4 to 6 s if a
    /// value never arrived, and longer if it did.
    pub fn missing(&self) -> Vec<Missing> {
        let mut missing = Missing::of(self.link.missing(), &self.engage_switch, self.rows);
        let lights = self
            .version()
            .and_then(|version| lights_if_beyond(&self.engage_switch, version));
        if let Some(lights) = lights {
            let path = self.engage_switch().to_owned();
            missing.retain(|what| !matches!(what, Missing::EngageSwitch(_)));
            missing.push(Missing::GenericLight { path, lights });
        }
        if self.link.answers_anything() {
            let path = self.engage_switch().to_owned();
            missing.push(Missing::MaybeEngageSwitch(path));
        }
        missing
    }

    /// What is wrong with the connection now; `None` while nothing is.
    pub fn trouble(&self) -> Option<Trouble> {
        match self.simulator() {
            None => Some(Trouble::NoBeacon),
            Some(at) if self.state() == SimulatorState::Silent => Some(Trouble::Silent(at)),
            Some(at) if self.rows.is_some() && self.link.missing().has_no_answer() => {
                Some(Trouble::Unanswered(at))
            }
            Some(at) if self.is_unconfirmed() => Some(Trouble::Unconfirmed(at)),
            Some(_) => None,
        }
    }
}

/// A problem with the connection. Its text says what to do.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Trouble {
    /// No beacon has arrived.
    NoBeacon,
    /// The simulator does not answer.
    Silent(SocketAddr),
    /// The simulator sends rows of Data Output, but answers no request.
    Unanswered(SocketAddr),
    /// The simulator sends, but what is written to it has no effect.
    Unconfirmed(SocketAddr),
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoBeacon => f.write_str(
                "No X-Plane has announced itself on this network. Start X-Plane, or set its \
                 address instead of looking for its beacon: some networks do not carry multicast.",
            ),
            Self::Silent(simulator) => InWords {
                simulator: *simulator,
                local_port: None,
                why: Why::NothingArrives,
            }
            .fmt(f),
            Self::Unanswered(at) => write!(
                f,
                "X-Plane at {at} sends Data Output, but answers no request: X-Plane does not hear \
                 this program. There, in X-Plane 12 switch on Settings > Network > Accept incoming \
                 connections, and let UDP port {} through the firewall of its machine.",
                at.port()
            ),
            Self::Unconfirmed(at) => write!(
                f,
                "X-Plane at {at} sends its data, but the controls written to it have no effect. \
                 In X-Plane 12 switch on Settings > Network > Accept incoming connections; check \
                 that a firewall on its machine lets UDP port {} in; that the network takes less \
                 than half a second there and back; and that no other program or plugin holds the \
                 controls.",
                at.port()
            ),
        }
    }
}
