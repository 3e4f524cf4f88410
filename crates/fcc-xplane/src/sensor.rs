//! X-Plane as a sensor.

mod beacons;

use core::hint::black_box;
use core::mem;
use core::time::Duration;
use std::net::SocketAddr;
use std::sync::Arc;

use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, SensorFault, Tick, Time};

use crate::beacon_group::BeaconGroup;
use crate::config::{DataRows, Input, XPlaneConfig};
use crate::controls::Controls;
use crate::counters::count;
use crate::inbox::Inbox;
use crate::link::{Control, SharedState};
use crate::port::{Errno, Port};
use crate::protocol::{Kind, PathError};
use crate::release_monitor::ReleaseMonitor;
use crate::reply_port::{ReplyPorts, Situation};
use crate::simulator::SimulatorState;
use crate::source_filter::SourceFilter;
use crate::status::XPlaneStatus;
use crate::subscriptions::Subscriptions;
use crate::udp_port::UdpPort;

/// Longer than what X-Plane sends: 1,469 bytes of values, or 134 rows.
const BUFFER_BYTES: usize = 8_192;
/// More than wait in a socket at Linux's default size, 212,992 bytes, of which
/// the shortest datagram takes 768.
const DISCARDED_PER_TICK: usize = 300;
/// After this loop itself stood still for longer, s, what waits in the socket is
/// old, and its end may be missing: it is discarded.
const OLD_AFTER_S: f64 = 0.1;
/// Some address translations forget, after 30 s at the earliest, an address to
/// which nothing is sent, although datagrams arrive from it (Windows':
/// github.com/microsoft/WSL, issue 8369).
const OPEN_EVERY: Duration = Duration::from_secs(20);

/// X-Plane as a sensor: reads the values that arrived and requests those that
/// did not.
///
/// In a tick it makes system calls to receive (at most as many datagrams as
/// configured; the rest are discarded) and to send (a few requests), none of
/// which waits. Readings are stamped with the time of the tick in which they
/// arrived. Only datagrams from
/// the simulator's IP address are accepted, from the first of its ports that
/// answers: X-Plane does not answer from the port on which it listens.
#[derive(Debug)]
pub struct XPlaneSensor<P: Port = UdpPort> {
    port: Arc<P>,
    /// Where beacons are received, if the simulator is found by its beacon.
    beacons: Option<P>,
    link: Arc<SharedState>,
    /// The connection whose actuator writes: this one, unless the sensor is
    /// [beside](Self::beside) another.
    writing: Arc<SharedState>,
    inbox: Inbox,
    reply_ports: ReplyPorts,
    subscriptions: Subscriptions,
    /// The port from which X-Plane is expected to answer; 0 if that is not
    /// known.
    expected_reply_port: u16,
    /// When a datagram was last sent there.
    opened: Time,
    engage_switch: Arc<str>,
    rows: Option<DataRows>,
    release_monitor: ReleaseMonitor,
    datagrams_per_tick: usize,
    silent_after: Duration,
    fallback_after: Duration,
    /// When a beacon last led to another simulator.
    chosen: Time,
    /// The first tick: until something arrives, silence is measured from here.
    began: Time,
    buffer: Box<[u8; BUFFER_BYTES]>,
    /// For the warm-up: the last datagram with values in it, whole or not.
    last_values: Box<[u8; BUFFER_BYTES]>,
    last_values_bytes: usize,
}

impl<P: Port> XPlaneSensor<P> {
    pub(crate) fn new(
        config: &XPlaneConfig,
        port: Arc<P>,
        beacons: Option<P>,
        link: Arc<SharedState>,
    ) -> Result<Self, PathError> {
        let rows = match config.input {
            Input::Rref => None,
            Input::Data(rows) => Some(rows),
        };
        Ok(Self {
            port,
            beacons,
            writing: Arc::clone(&link),
            link,
            inbox: Inbox::new(config.plant, rows, config.silent_after),
            reply_ports: ReplyPorts::new(config.reply_port, rows.is_some()),
            subscriptions: Subscriptions::new(config)?,
            expected_reply_port: config.reply_port,
            opened: Time::NEVER,
            engage_switch: config.engage_switch.as_str().into(),
            rows,
            release_monitor: ReleaseMonitor::new(Controls::new(config)?),
            datagrams_per_tick: usize::from(config.datagrams_per_tick),
            silent_after: config.silent_after,
            fallback_after: config.fallback_after,
            chosen: Time::NEVER,
            began: Time::NEVER,
            buffer: Box::new([0; BUFFER_BYTES]),
            last_values: Box::new([0; BUFFER_BYTES]),
            last_values_bytes: 0,
        })
    }

    /// The connection's status, readable from any thread while the sensor is in
    /// a loop.
    pub fn status(&self) -> XPlaneStatus {
        let engage_switch = Arc::clone(&self.engage_switch);
        XPlaneStatus::new(Arc::clone(&self.link), engage_switch, self.rows)
    }

    /// For a second connection to the simulator that is flown over another one,
    /// of which this is the status: what is written there is not another
    /// program's.
    #[must_use]
    pub fn beside(mut self, flown: &XPlaneStatus) -> Self {
        self.writing = flown.link();
        self.writing.add_beside(Arc::clone(&self.link));
        self
    }

    pub(crate) fn set_socket(&self, local_port: u16, filter: Option<SourceFilter>) {
        self.link.set_socket(local_port, filter);
    }

    pub(crate) fn set_beacon_group(&self, group: BeaconGroup) {
        self.link.set_beacon_group(group);
    }

    fn receive(&mut self, now: Time, simulator: Option<SocketAddr>) -> Result<(), SensorFault> {
        let mut outcome = Ok(());
        for _ in 0..self.datagrams_per_tick {
            let received = self.port.receive(self.buffer.as_mut_slice());
            let (length, from) = match received {
                Ok(Some(received)) => received,
                Ok(None) => return outcome,
                Err(errno) => return Err(SensorFault::Io { errno }),
            };
            if simulator.is_none_or(|simulator| simulator.ip() != from.ip()) {
                count(&self.link.counters.foreign);
                continue;
            }
            count(&self.link.counters.received);
            let datagram = self.buffer.get(..length).unwrap_or_default();
            let kind = Kind::of(datagram);
            let port = from.port();
            if kind.is_some_and(|kind| !self.reply_ports.accepts(kind, port, now)) {
                count(&self.link.counters.foreign);
                continue;
            }
            match self.inbox.accept(datagram, now, &self.link) {
                Ok(true) => {
                    if let Some(kind) = kind {
                        let is_restarted = self.reply_ports.hold(kind, port, now);
                        if kind == Kind::Rref || self.link.reply_port().is_none() {
                            self.link.set_reply_port(port);
                            if is_restarted {
                                self.link.set_flown_port(Some(port));
                            }
                        }
                    }
                }
                Ok(false) => {}
                Err(_) => {
                    count(&self.link.counters.malformed);
                    outcome = Err(SensorFault::Malformed);
                }
            }
            if let Some(Kind::Rref | Kind::Data) = kind {
                mem::swap(&mut self.buffer, &mut self.last_values);
                self.last_values_bytes = length;
            }
        }
        if let Some(length) = self.discard_rest(now) {
            // Of many that waited, as after a disturbance of the network, the
            // newest counts.
            let newest = self.last_values.get(..length).unwrap_or_default();
            if self.inbox.accept(newest, now, &self.link).is_err() {
                count(&self.link.counters.malformed);
                outcome = Err(SensorFault::Malformed);
            }
        }
        outcome
    }

    /// Left until the next tick, datagrams would be stamped with a time at which
    /// they did not arrive, and each tick would read older ones. Returns the
    /// length of the last one with values, if there was one.
    fn discard_rest(&mut self, now: Time) -> Option<usize> {
        let simulator = self.link.address.simulator().map(|at| at.ip());
        let mut newest = None;
        for _ in 0..DISCARDED_PER_TICK {
            let Ok(Some((length, from))) = self.port.receive(self.buffer.as_mut_slice()) else {
                break;
            };
            count(&self.link.counters.discarded);
            let datagram = self.buffer.get(..length).unwrap_or_default();
            if let Some(kind @ (Kind::Rref | Kind::Data)) = Kind::of(datagram)
                && Some(from.ip()) == simulator
                && self.reply_ports.accepts(kind, from.port(), now)
            {
                mem::swap(&mut self.buffer, &mut self.last_values);
                self.last_values_bytes = length;
                newest = Some(length);
            }
        }
        newest
    }

    /// Which ports may be adopted depends on whether controls are held.
    fn follow_control(&mut self) {
        let link = &self.link;
        let is_held = self.writing.is_held();
        if !link.is_held() {
            link.set_flown_port(None);
        } else if link.flown_port().is_none() {
            link.set_flown_port(link.reply_port());
        }
        let (gone, is_gone_known) = link.gone_ports();
        self.reply_ports.situation = Situation {
            is_held,
            is_written: self.writing.control() == Control::Held,
            flown: link.flown_port(),
            gone,
            is_gone_known,
        };
    }

    fn send_requests(&mut self, now: Time, simulator: SocketAddr) -> Result<(), Errno> {
        let (port, link) = (&self.port, &self.link);
        let outcome = self.subscriptions.send_due(now, &self.inbox, |request| {
            count(&link.counters.requests);
            send(port.as_ref(), link, request, simulator)
        });
        let is_due = self.subscriptions.restarted(now) || now.since(self.opened) >= OPEN_EVERY;
        if is_due && let Some(reply_port) = self.reply_address(simulator) {
            self.opened = now;
            // Without it a firewall may drop every reply, and with it nothing
            // is certain: no failure.
            let _ = port.send(self.subscriptions.without_effect(), reply_port);
        }
        outcome
    }

    /// Where a datagram is sent so that a firewall or an address translation on
    /// this side, which lets in only what comes from an address that was written
    /// to, lets the replies in. None on this machine: nothing is in between.
    fn reply_address(&self, simulator: SocketAddr) -> Option<SocketAddr> {
        let port = self.link.reply_port().unwrap_or(self.expected_reply_port);
        let is_needed = port != 0 && port != simulator.port() && !simulator.ip().is_loopback();
        is_needed.then(|| SocketAddr::new(simulator.ip(), port))
    }

    fn poll_release_monitor(&mut self, now: Time, simulator: SocketAddr) -> Result<(), Errno> {
        let (port, link) = (&self.port, &self.link);
        self.release_monitor.poll(now, link, |write| {
            count(&link.counters.writes);
            send(port.as_ref(), link, write, simulator)
        })
    }
}

/// Sends, and counts what the operating system refuses.
pub(crate) fn send<P: Port>(
    port: &P,
    link: &SharedState,
    datagram: &[u8],
    to: SocketAddr,
) -> Result<(), Errno> {
    port.send(datagram, to)
        .inspect_err(|_| count(&link.counters.refused))
}

impl<P: Port> Sensor<Measurements> for XPlaneSensor<P> {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let now = tick.woke;
        if self.began.is_never() {
            self.began = now;
        }
        self.listen_for_beacons(now);
        let simulator = self.link.address.simulator();

        self.follow_control();
        self.inbox.begin();
        let missed_s = tick.dt_s - tick.dt_s / tick.missed.saturating_add(1) as f64;
        let received = if missed_s > OLD_AFTER_S {
            self.discard_rest(now);
            Ok(())
        } else {
            self.receive(now, simulator)
        };
        let ports = &self.reply_ports;
        self.link.set_delivered_ports(ports.to_deliver(now));
        self.link
            .set_held_ports(ports.known(), ports.is_silent(now));
        let state = self.inbox.publish(now, into, &self.link, &self.writing);
        self.link.set_state(state);
        if let Some(missing) = self.subscriptions.missing(now, &self.inbox) {
            self.link.set_missing(missing);
        }

        let mut sent = Ok(());
        if let Some(simulator) = simulator {
            sent = self.send_requests(now, simulator);
            if self.link.address.is_allowed(simulator) {
                sent = sent.and(self.poll_release_monitor(now, simulator));
            }
        }

        let silent = state == SimulatorState::Silent && now.since(self.began) > self.silent_after;
        match (received, sent) {
            (Err(SensorFault::Io { errno }), _) | (_, Err(errno)) => Err(SensorFault::Io { errno }),
            _ if silent => Err(SensorFault::Silent),
            (received, Ok(())) => received,
        }
    }

    fn fallback_after(&self) -> Duration {
        self.fallback_after
    }

    /// Decodes the last values again, into copies of the state that a tick
    /// changes.
    fn warm_up(&self, tick: &Tick) {
        self.port.warm_up_receive();
        let link = SharedState::new(self.link.address.simulator());
        let mut inbox = self.inbox.clone();
        let mut measurements = Measurements::default();
        let datagram = self.last_values.get(..self.last_values_bytes);
        inbox.begin();
        let _ = inbox.accept(datagram.unwrap_or_default(), tick.woke, &link);
        inbox.publish(tick.woke, &mut measurements, &link, &link);
        black_box((&inbox, &measurements, &link));
        self.subscriptions.warm_up();
    }

    fn name(&self) -> &'static str {
        "X-Plane"
    }
}

impl<P: Port> Drop for XPlaneSensor<P> {
    /// Ends the subscriptions; otherwise X-Plane would keep sending until it
    /// quits.
    fn drop(&mut self) {
        if let Some(simulator) = self.link.address.simulator() {
            // A failure can no longer be reported and has no consequence.
            self.subscriptions.end(|request| {
                let _ = self.port.send(request, simulator);
            });
        }
    }
}
