//! X-Plane as an actuator.

use core::hint::black_box;
use core::sync::atomic::Ordering;
use core::time::Duration;
use std::net::SocketAddr;
use std::sync::Arc;

use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick, Time};

use crate::config::XPlaneConfig;
use crate::confirmation::Confirmation;
use crate::controls::{Controls, LET_GO_TIMES};
use crate::counters::count;
use crate::deflections::yoke_ratios;
use crate::link::{Control, SharedState};
use crate::plant::plant_at;
use crate::port::{Errno, Port};
use crate::protocol::PathError;
use crate::protocol::dref::WRITE_BYTES;
use crate::sensor::send;
use crate::traffic::WritePace;
use crate::udp_port::UdpPort;

/// The overrides are set again in such intervals until they are read back for the first
/// time: one datagram that is lost is no long round trip.
const AWAITED_AGAIN: Duration = Duration::from_millis(100);

/// X-Plane as an actuator: takes control of the yoke and the throttles, writes
/// them, and releases them.
///
/// The first [`apply`](Actuator::apply) after a release sets the overrides,
/// then writes, in every tick unless X-Plane cannot take so much in one frame
/// (in a loop above 100 Hz). [`release`](Actuator::release) centres the surfaces and
/// releases the overrides, three times; dropping does the same. A sensor that
/// is still being sampled checks that the release took effect.
#[derive(Debug)]
pub struct XPlaneActuator<P: Port = UdpPort> {
    port: Arc<P>,
    link: Arc<SharedState>,
    controls: Controls,
    assert_every: Duration,
    held: Option<HeldControl>,
}

/// The control that is held.
#[derive(Debug)]
struct HeldControl {
    /// Where it is held. It is released there, even if a beacon has since named
    /// another address.
    simulator: SocketAddr,
    /// What was put first: where the controls were.
    /// When the overrides were last set.
    asserted: Time,
    pace: WritePace,
    confirmation: Confirmation,
}

impl<P: Port> XPlaneActuator<P> {
    pub(crate) fn new(
        config: &XPlaneConfig,
        port: Arc<P>,
        link: Arc<SharedState>,
    ) -> Result<Self, PathError> {
        Ok(Self {
            port,
            link,
            controls: Controls::new(config)?,
            assert_every: config.plant.assert_every(),
            held: None,
        })
    }
}

impl<P: Port> Actuator<Surfaces> for XPlaneActuator<P> {
    fn apply(&mut self, tick: &Tick, outputs: &Surfaces) -> Result<(), ActuatorFault> {
        let now = tick.woke;
        let (port, link) = (self.port.as_ref(), self.link.as_ref());
        if link.control() != Control::Held {
            // Left by a release that could not be sent; control is taken again.
            self.held = None;
        }
        let held = match &mut self.held {
            Some(held) => held,
            none => {
                let simulator = link
                    .address
                    .simulator()
                    .filter(|at| link.address.is_allowed(*at));
                let simulator = simulator.ok_or(ActuatorFault::NotConnected)?;
                // Counts as held before the first datagram is sent: what may
                // have been taken must be released.
                link.set_control(Control::Held);
                if let Some((notice, plant)) = link.notice().zip(plant_at(simulator)) {
                    notice.taking(&plant);
                }
                none.insert(HeldControl {
                    simulator,
                    asserted: Time::NEVER,
                    pace: WritePace::begin(),
                    confirmation: Confirmation::begin(now),
                })
            }
        };
        let simulator = held.simulator;
        let write = |datagrams: &[u8]| {
            let number = datagrams.len().div_ceil(WRITE_BYTES) as u64;
            link.counters.writes.fetch_add(number, Ordering::Relaxed);
            port.send_each(datagrams, WRITE_BYTES, simulator)
                .inspect_err(|_| count(&link.counters.refused))
        };

        if link.is_maybe_reloaded() {
            // What is written now would reach another aircraft.
            return Ok(());
        }
        let mut sent = Ok(());
        let assert_every = if held.confirmation.awaits_overrides() {
            AWAITED_AGAIN
        } else {
            self.assert_every
        };
        if now.since(held.asserted) >= assert_every {
            held.asserted = now;
            sent = self.controls.take(write);
        }
        let messages = self.controls.messages(outputs);
        if held.pace.take(now, messages, link.frame_period_s()) {
            sent = sent.and(self.controls.set(outputs, write));
            held.confirmation.wrote(now, yoke_ratios(outputs));
            link.sent_yoke.add(yoke_ratios(outputs));
        }
        held.confirmation.await_overrides(now, link);
        let unconfirmed = held.confirmation.is_overdue(now, link);
        link.set_unconfirmed(unconfirmed);
        match sent {
            Err(errno) => Err(ActuatorFault::Io { errno }),
            Ok(()) if unconfirmed => Err(ActuatorFault::Unconfirmed),
            Ok(()) => Ok(()),
        }
    }

    /// Encodes the last outputs into copies of the state that a tick changes.
    fn warm_up(&self, tick: &Tick, outputs: &Surfaces) {
        let Some(held) = &self.held else {
            return;
        };
        self.controls.warm_up(outputs, |datagrams| {
            self.port.warm_up_send(datagrams, WRITE_BYTES);
        });
        let mut confirmation = held.confirmation.clone();
        confirmation.wrote(tick.woke, yoke_ratios(outputs));
        black_box(confirmation.is_overdue(tick.woke, &self.link));
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        let Some(held) = &self.held else {
            return Ok(());
        };
        let (port, link, simulator) = (self.port.as_ref(), self.link.as_ref(), held.simulator);
        let mut released = false;
        let mut failed: Errno = 0;
        for _ in 0..LET_GO_TIMES {
            let round = self.controls.release(|datagram| {
                count(&link.counters.writes);
                send(port, link, datagram, simulator)
            });
            match round {
                Ok(()) => released = true,
                Err(errno) => failed = errno,
            }
        }
        link.set_unconfirmed(false);
        link.set_control(Control::ReleaseMonitor);
        if released {
            self.held = None;
            Ok(())
        } else {
            // It may still be held, so the next release tries again.
            Err(ActuatorFault::Io { errno: failed })
        }
    }

    fn name(&self) -> &'static str {
        "X-Plane"
    }
}

impl<P: Port> Drop for XPlaneActuator<P> {
    fn drop(&mut self) {
        // A failure can no longer be reported.
        let _ = self.release();
    }
}
