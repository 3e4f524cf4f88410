//! Releasing control from outside a loop, and waiting for confirmation: at the
//! end of a program, and on behalf of a program that was killed.

use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use fcc_core::framework::Released;

use crate::address::XPLANE_PORT;
use crate::config::XPlaneConfig;
use crate::controls::Controls;
use crate::open::{OpenError, XPlane, bind, local_ports};
use crate::port_watch::{ClosedPort, MOST_PORTS};
use crate::probe::Probe;
use crate::program::Program;
use crate::protocol::rref;
use crate::quantity::{OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES};
use crate::source_filter;
use crate::udp_port::{is_of_this_machine, local_address};
use crate::udp_sockets::UdpSockets;

/// The interval between two releases.
const AGAIN_AFTER: Duration = Duration::from_millis(250);
/// X-Plane confirms a release by overrides that stay clear for this long: a
/// write from before it may arrive later.
const CLEAR_FOR: Duration = Duration::from_millis(500);
/// The receive timeout.
const LISTEN_FOR: Duration = Duration::from_millis(20);
/// After this many refusals in a row the simulator counts as unreachable.
const REFUSALS: u32 = 4;
/// The rate at which the readback is requested, Hz.
const READ_BACK_HZ: u16 = 20;
/// The indices of the readback, distinct from those of a sensor's
/// subscriptions.
const INDICES: [i32; 2] = [9_001, 9_002];

/// What is known of the simulator that was flown.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Expected {
    /// The port that answered, or the usual one: only it can confirm, unless it is
    /// gone.
    pub(crate) port: Option<u16>,
    /// Whose socket that is, of a simulator on this machine.
    pub(crate) user: Option<u32>,
    /// The program that listened at the simulator's port, if it is known: that of
    /// another user cannot be looked at.
    pub(crate) program: Option<Program>,
}

impl XPlane {
    /// Centres the surfaces and clears the overrides at `simulator`, whichever
    /// program set them, until X-Plane confirms it or `timeout` has passed.
    /// This waits, so do not call it in a loop.
    ///
    /// X-Plane never clears an override by itself, and an X-Plane that hangs
    /// loses what is sent to it, so sending once is not enough.
    ///
    /// # Errors
    /// When the configuration is refused or no socket can be opened.
    pub fn release_and_wait(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        timeout: Duration,
    ) -> Result<Released, OpenError> {
        Self::release_unless_cancelled(config, simulator, timeout, || false)
    }

    /// The same, unless it is cancelled: `is_cancelled` is called at least
    /// every 20 ms, and before anything is sent.
    ///
    /// # Errors
    /// As [`release_and_wait`](Self::release_and_wait).
    pub fn release_unless_cancelled(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        timeout: Duration,
        is_cancelled: impl FnMut() -> bool,
    ) -> Result<Released, OpenError> {
        config.validate()?;
        let expected = Expected::default();
        Self::release_expecting(config, simulator, expected, None, timeout, is_cancelled)
    }

    /// The same; only answers of what is expected are accepted. The `reserve` is
    /// used if no other port is free.
    pub(crate) fn release_expecting(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        expected: Expected,
        reserve: Option<UdpSocket>,
        timeout: Duration,
        is_cancelled: impl FnMut() -> bool,
    ) -> Result<Released, OpenError> {
        let mut conversation = Conversation::open(config, simulator, expected, reserve)?;
        let mut controls = Controls::new(config)?;
        let outcome = retry_until_released(&mut conversation, &mut controls, timeout, is_cancelled);
        conversation.end();
        Ok(outcome)
    }
}

/// X-Plane answers from another port than the one that it listens on, so a
/// connected socket receives no answer; and only a connected one learns that no
/// program listens there.
struct Conversation {
    simulator: SocketAddr,
    /// Asks whether the port that it listens on is closed.
    listening: Option<Probe>,
    /// For what is sent, and the answers.
    answers: UdpSocket,
    requests: [[u8; rref::REQUEST_BYTES]; 2],
    /// A request without effect, to the port that is expected to answer: it
    /// lets the answers through a firewall on this side.
    opening: Option<SocketAddr>,
    expected: Expected,
    /// The ports of which an answer counts, if not any.
    permitted: Option<Vec<u16>>,
    /// Those of this machine, if it is there.
    sockets: Option<UdpSockets>,
    /// Asks whether the expected port is closed, of another machine's.
    closed: Option<ClosedPort>,
    has_answered: bool,
}

impl Conversation {
    fn open(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        expected: Expected,
        reserve: Option<UdpSocket>,
    ) -> Result<Self, OpenError> {
        let ip = simulator.ip();
        let mut ports = local_ports(config.local_port, ip);
        // The daemon itself may still have its own.
        ports.push(0);
        let bound = bind(&ports, |port| UdpSocket::bind((local_address(ip), port)));
        let answers = bound.or_else(|error| reserve.ok_or(error))?;
        let refused = |source| OpenError::Bind { port: 0, source };
        // If this fails, what others send is left out below.
        let _ = source_filter::attach(&answers, ip, None);
        answers
            .set_read_timeout(Some(LISTEN_FOR))
            .map_err(refused)?;
        let mut requests = [[0; rref::REQUEST_BYTES]; 2];
        let paths = [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES];
        for ((request, index), path) in requests.iter_mut().zip(INDICES).zip(paths) {
            rref::request(request, READ_BACK_HZ, index, path)?;
        }
        // A helper does not know the port, but X-Plane's usual pair.
        let usual = (simulator.port() == XPLANE_PORT && config.reply_port != 0)
            .then_some(config.reply_port);
        let expected = Expected {
            port: expected.port.or(usual),
            ..expected
        };
        let opened = expected.port.unwrap_or(config.reply_port);
        let opens = opened != 0 && opened != simulator.port() && !ip.is_loopback();
        let asked = expected.port.map(|port| SocketAddr::new(ip, port));
        Ok(Self {
            simulator,
            listening: Probe::of(simulator).ok(),
            answers,
            requests,
            opening: opens.then(|| SocketAddr::new(ip, opened)),
            expected,
            permitted: None,
            sockets: is_of_this_machine(simulator).then(|| UdpSockets::sending_from(ip)),
            closed: asked.and_then(ClosedPort::of),
            has_answered: false,
        })
    }

    /// Finds out from which ports an answer counts: if the expected one is gone,
    /// as of a simulator that was started again, from any other one of the same
    /// user, or of the same machine.
    fn look_at_ports(&mut self) {
        let ip = self.simulator.ip();
        let mut owner = None;
        if let Some(sockets) = &mut self.sockets {
            sockets.look();
            let listens = || sockets.user_of(self.simulator.port()).ok().flatten();
            owner = self.expected.user.or_else(listens).zip(Some(sockets));
        }
        let is_gone = |port: u16| match (&mut owner, &mut self.closed) {
            (Some((user, sockets)), _) => {
                let found = sockets.user_of(port);
                found.is_ok_and(|found| found != Some(*user))
            }
            (None, Some(closed)) => closed.is_closed(self.has_answered),
            (None, None) => false,
        };
        if self.expected.port.is_some_and(is_gone) {
            self.expected.port = None;
        }
        let expected = self.expected.port.map(|port| vec![port]);
        let owned = || {
            let (user, sockets) = owner?;
            Some(sockets.ports_of(user, &[self.simulator.port()], MOST_PORTS))
        };
        self.permitted = expected.or_else(owned);
        // If this fails, what others send is left out when it is received.
        let _ = source_filter::attach(&self.answers, ip, self.permitted.as_deref());
    }

    /// Sends the release and the requests.
    fn send_release(&self, controls: &mut Controls) {
        let _ = controls.release(|bytes| {
            let sent = self.answers.send_to(bytes, self.simulator);
            sent.map(drop)
                .map_err(|error| error.raw_os_error().unwrap_or(0))
        });
        if let Some(listening) = &self.listening {
            listening.send();
        }
        if let (Some(to), Some(request)) = (self.opening, self.requests.first()) {
            let mut without_effect = *request;
            rref::set_frequency(&mut without_effect, 0);
            let _ = self.answers.send_to(&without_effect, to);
        }
        for request in &self.requests {
            let _ = self.answers.send_to(request, self.simulator);
        }
    }

    /// Receives a datagram, or waits for a moment; returns whether it was an
    /// answer.
    fn receive(&mut self, readback: &mut [Option<bool>; 2]) -> bool {
        let mut datagram = [0; 2_048];
        let Ok((length, from)) = self.answers.recv_from(&mut datagram) else {
            return false;
        };
        let is_expected = match (self.expected.port, &self.permitted) {
            (Some(port), _) => port == from.port(),
            (None, Some(permitted)) => permitted.contains(&from.port()),
            (None, None) => true,
        };
        let is_answer = from.ip() == self.simulator.ip()
            && is_expected
            && read_back(datagram.get(..length).unwrap_or_default(), readback);
        if is_answer {
            self.expected.port = Some(from.port());
            self.has_answered = true;
        }
        is_answer
    }

    /// Whether the machine there reported that no program listens.
    fn is_refused(&self) -> bool {
        self.listening.as_ref().is_some_and(Probe::is_refused)
    }

    /// Whether the simulator has ended: no program has its port, as this machine
    /// knows of its own, and the one that had it is gone. Of another machine it is not
    /// known, since a firewall that rejects what it does not let through reports the
    /// same; nor of a program that cannot be looked at.
    fn has_ended(&mut self) -> bool {
        let port = self.simulator.port();
        let is_closed = self.sockets.as_mut().is_some_and(|sockets| {
            sockets.look();
            sockets.user_of(port).is_ok_and(|user| user.is_none())
        });
        let is_gone = |program: Program| program.has_ended();
        is_closed && self.expected.program.is_some_and(is_gone)
    }

    fn end(mut self) {
        for request in &mut self.requests {
            rref::set_frequency(request, 0);
            let _ = self.answers.send_to(request, self.simulator);
        }
    }
}

fn retry_until_released(
    conversation: &mut Conversation,
    controls: &mut Controls,
    timeout: Duration,
    mut is_cancelled: impl FnMut() -> bool,
) -> Released {
    let begun = Instant::now();
    let mut sent: Option<Instant> = None;
    let mut refusals = 0;
    // Whether a refusal was counted since the release was last sent.
    let mut refused = false;
    // The readback of each override since then.
    let mut readback: [Option<bool>; 2] = [None; 2];
    let mut clear_since: Option<Instant> = None;
    let mut answered = begun;
    while begun.elapsed() < timeout {
        if is_cancelled() {
            return Released::Cancelled;
        }
        let is_clear = readback == [Some(false); 2] && answered.elapsed() < AGAIN_AFTER;
        if !is_clear && sent.is_none_or(|at| at.elapsed() >= AGAIN_AFTER) {
            conversation.look_at_ports();
            readback = [None; 2];
            conversation.send_release(controls);
            // Answers get the whole interval, however long it took to look.
            sent = Some(Instant::now());
            refused = false;
        }
        if conversation.receive(&mut readback) {
            refusals = 0;
            answered = Instant::now();
            if readback.contains(&Some(true)) {
                clear_since = None;
            } else if readback == [Some(false); 2]
                && clear_since.get_or_insert(answered).elapsed() >= CLEAR_FOR
            {
                return Released::Confirmed;
            }
        }
        if !refused && conversation.is_refused() {
            refused = true;
            refusals += 1;
        }
        if refused && refusals >= REFUSALS && conversation.has_ended() {
            return Released::Unreachable;
        }
    }
    if refusals >= REFUSALS {
        return Released::Refused;
    }
    Released::Unconfirmed
}

/// A socket for a release, to be opened while a port can be had; it receives
/// nothing from elsewhere.
///
/// # Errors
/// When no port can be had.
pub(crate) fn reserve_for(simulator: SocketAddr) -> std::io::Result<UdpSocket> {
    let ip = simulator.ip();
    let socket = UdpSocket::bind((local_address(ip), 0))?;
    // If this fails, what others send is left out when it is received.
    let _ = source_filter::attach(&socket, ip, None);
    Ok(socket)
}

/// Stores the readback in a reply; values sent before the requests have other
/// indices and are ignored. Returns whether there is one.
fn read_back(datagram: &[u8], readback: &mut [Option<bool>; 2]) -> bool {
    let mut found = false;
    let Ok(pairs) = rref::parse(datagram) else {
        return found;
    };
    for (index, value) in pairs {
        for (slot, of) in readback.iter_mut().zip(INDICES) {
            if index == of && value.is_finite() {
                *slot = Some(value >= 0.5);
                found = true;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests;
