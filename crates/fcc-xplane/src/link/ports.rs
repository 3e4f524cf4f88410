//! The ports on which is received, and those that the simulator sends from.

use core::sync::atomic::{AtomicU16, AtomicU64, Ordering};

use super::SharedState;
use crate::beacon_group::BeaconGroup;
use crate::source_filter::{Ports, SourceFilter};

impl SharedState {
    pub(crate) fn reply_port(&self) -> Option<u16> {
        known_port(&self.reply_port)
    }

    pub(crate) fn set_reply_port(&self, port: u16) {
        self.reply_port.store(port, Ordering::Relaxed);
    }

    pub(crate) fn local_port(&self) -> Option<u16> {
        known_port(&self.local_port)
    }

    /// What is received on here; only the first filter counts.
    pub(crate) fn set_socket(&self, local_port: u16, filter: Option<SourceFilter>) {
        self.local_port.store(local_port, Ordering::Relaxed);
        if let Some(filter) = filter {
            let _ = self.filter.set(filter);
        }
    }

    /// Where beacons are received; only the first counts.
    pub(crate) fn set_beacon_group(&self, group: BeaconGroup) {
        let _ = self.beacon_group.set(group);
    }

    /// Joins the beacons' group where the network leads now; not in a tick.
    pub(crate) fn join_beacon_group(&self) {
        if let Some(group) = self.beacon_group.get() {
            group.join();
        }
    }

    /// The port that was flown, while controls are held.
    pub(crate) fn flown_port(&self) -> Option<u16> {
        known_port(&self.flown_port)
    }

    pub(crate) fn set_flown_port(&self, port: Option<u16>) {
        self.flown_port
            .store(port.unwrap_or_default(), Ordering::Relaxed);
    }

    /// Whether what is received now can confirm a release: not what comes from
    /// another port than the one that was flown.
    pub(crate) fn is_answer_of_flown(&self) -> bool {
        let flown = self.flown_port();
        flown.is_none() || flown == self.reply_port()
    }

    /// The simulator's ports from which the kernel is to deliver; all 0 for any.
    pub(crate) fn delivered_ports(&self) -> Ports {
        unpack(&self.delivered_ports)
    }

    pub(crate) fn set_delivered_ports(&self, ports: Ports) {
        pack(&self.delivered_ports, ports);
    }

    /// The ports that the simulator's datagrams come from, of replies first.
    pub(crate) fn held_ports(&self) -> Ports {
        unpack(&self.held_ports)
    }

    pub(crate) fn set_held_ports(&self, ports: Ports, is_silent: bool) {
        pack(&self.held_ports, ports);
        self.is_port_silent.store(is_silent, Ordering::Relaxed);
    }

    /// Whether nothing comes from one of them any more, or none is known.
    pub(crate) fn is_port_silent(&self) -> bool {
        self.is_port_silent.load(Ordering::Relaxed)
    }

    /// Those of them that are closed, or another user's; whether others are
    /// known not to be.
    pub(crate) fn gone_ports(&self) -> (Ports, bool) {
        let is_known = self.is_gone_known.load(Ordering::Relaxed);
        (unpack(&self.gone_ports), is_known)
    }

    pub(crate) fn set_gone_ports(&self, ports: Ports, is_known: bool) {
        pack(&self.gone_ports, ports);
        self.is_gone_known.store(is_known, Ordering::Relaxed);
    }

    /// Adapts the kernel's filter to what is known; not in a tick.
    pub(crate) fn adapt_filter(&self, owned: Option<&[u16]>) {
        if let Some((filter, simulator)) = self.filter.get().zip(self.address.simulator()) {
            filter.follow(simulator.ip(), self.delivered_ports(), owned);
        }
    }
}

fn pack(into: &AtomicU64, ports: Ports) {
    let packed = ports
        .into_iter()
        .rev()
        .fold(0, |packed, port| (packed << 16) | u64::from(port));
    into.store(packed, Ordering::Relaxed);
}

fn unpack(ports: &AtomicU64) -> Ports {
    let packed = ports.load(Ordering::Relaxed);
    [0, 16, 32, 48].map(|shift| (packed >> shift) as u16)
}

fn known_port(port: &AtomicU16) -> Option<u16> {
    match port.load(Ordering::Relaxed) {
        0 => None,
        port => Some(port),
    }
}
