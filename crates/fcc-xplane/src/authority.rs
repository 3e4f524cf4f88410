//! Who has control of X-Plane, seen from outside the loop.

use core::fmt;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use fcc_core::framework::{ActuatorFault, ControlAuthority, PlantId, Released, TakeoverNotice};

use crate::config::XPlaneConfig;
use crate::open::{OpenError, XPlane};
use crate::plant::{address, plant_at};
use crate::port_watch::PortWatch;
use crate::program::Program;
use crate::release::{Expected, reserve_for};
use crate::reported::Reported;
use crate::status::XPlaneStatus;
use crate::udp_port::is_of_this_machine;
use crate::udp_sockets::UdpSockets;

/// Monitors who has control of X-Plane, and releases it over a separate socket.
#[derive(Debug)]
pub struct XPlaneAuthority {
    config: XPlaneConfig,
    status: Option<XPlaneStatus>,
    reported: Mutex<Reported>,
    /// The port that a simulator answers from, as another program told it.
    expected: Mutex<Option<(SocketAddr, u16)>>,
    /// For the release of this simulator, if no other port is free then.
    reserve: Mutex<Option<(SocketAddr, UdpSocket)>>,
    /// The program at this simulator's port, if it could be found out.
    program: Mutex<Option<(SocketAddr, Option<Program>)>>,
    /// Of the connection that is flown, and of those beside it.
    watches: Mutex<Vec<PortWatch>>,
}

impl XPlaneAuthority {
    /// For the connection to which this [`status`](crate::XPlaneSensor::status)
    /// of a sensor belongs.
    pub fn of(status: XPlaneStatus, config: &XPlaneConfig) -> Self {
        Self {
            status: Some(status),
            ..Self::without_connection(config)
        }
    }

    /// For a program that controls nothing itself and only releases what
    /// another program held.
    pub fn without_connection(config: &XPlaneConfig) -> Self {
        Self {
            config: config.clone(),
            status: None,
            reported: Mutex::default(),
            expected: Mutex::default(),
            reserve: Mutex::default(),
            program: Mutex::default(),
            watches: Mutex::default(),
        }
    }
}

impl XPlaneAuthority {
    fn watch_ports(&self, status: &XPlaneStatus) {
        let flown = status.link();
        let beside = flown.beside();
        let mut watches = locked(&self.watches);
        watches.resize_with(1 + beside.len(), PortWatch::default);
        let links = std::iter::once(&flown).chain(&beside);
        for (watch, link) in watches.iter_mut().zip(links) {
            watch.look(link, &flown);
        }
    }

    /// Finds out which program is at the simulator's port, once; again if that one has
    /// ended, since a simulator that was started again may be there.
    fn look_at_program(&self, simulator: SocketAddr) {
        let mut program = locked(&self.program);
        let is_known = matches!(*program, Some((of, found)) if of == simulator
            && found.is_none_or(|found| !found.has_ended()));
        if is_known || !is_of_this_machine(simulator) {
            return;
        }
        let mut sockets = UdpSockets::sending_from(simulator.ip());
        sockets.look();
        let found = sockets.program_at(simulator.port());
        // Without one at the port the one that has ended is still what is known.
        if found.is_some() || program.is_none_or(|(of, _)| of != simulator) {
            *program = Some((simulator, found));
        }
    }

    fn program_at(&self, simulator: SocketAddr) -> Option<Program> {
        locked(&self.program)
            .filter(|(of, _)| *of == simulator)
            .and_then(|(_, program)| program)
    }

    /// What is known of this simulator, for its release.
    fn expected(&self, simulator: SocketAddr) -> Expected {
        let flown = self
            .status
            .as_ref()
            .filter(|status| status.simulator() == Some(simulator));
        // A thread that hangs may have locked it.
        let watches = self.watches.try_lock().ok();
        let told = locked(&self.expected).filter(|(told, _)| *told == simulator);
        Expected {
            port: flown.map_or(told.map(|(_, port)| port), |status| {
                status.link().flown_port().or(status.reply_port())
            }),
            user: flown
                .and(watches)
                .and_then(|watches| watches.first().and_then(PortWatch::user)),
            program: self.program_at(simulator),
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ControlAuthority for XPlaneAuthority {
    fn plant(&self) -> Option<PlantId> {
        self.status.as_ref()?.simulator().and_then(plant_at)
    }

    fn held(&self) -> Option<PlantId> {
        self.status.as_ref()?.held_at().and_then(plant_at)
    }

    fn require_permission(&self) {
        if let Some(status) = &self.status {
            status.require_permission();
        }
    }

    fn permit(&self, plant: &PlantId) {
        if let Some((status, simulator)) = self.status.as_ref().zip(address(plant)) {
            status.allow(simulator);
        }
    }

    fn notify(&self, notice: &'static dyn TakeoverNotice) {
        if let Some(status) = &self.status {
            status.notify(notice);
        }
    }

    /// X-Plane listens at every address of its machine, so an X-Plane on this
    /// machine gets the same name for all of the machine's addresses.
    fn unique(&self, plant: &PlantId) -> PlantId {
        address(plant)
            .filter(|simulator| simulator.ip().is_loopback() || is_of_this_machine(*simulator))
            .and_then(|simulator| plant_at((Ipv4Addr::LOCALHOST, simulator.port()).into()))
            .unwrap_or(*plant)
    }

    fn answers_from(&self) -> Option<u16> {
        let status = self.status.as_ref()?;
        status.link().flown_port().or(status.reply_port())
    }

    fn expect(&self, plant: &PlantId, answers_from: u16) {
        if let Some(simulator) = address(plant) {
            *locked(&self.expected) = Some((simulator, answers_from));
        }
    }

    fn prepare_release(&self, plant: &PlantId) {
        if let Some(simulator) = address(plant) {
            self.look_at_program(simulator);
        }
        let mut reserve = locked(&self.reserve);
        if let Some(simulator) = address(plant)
            && reserve.as_ref().is_none_or(|(of, _)| *of != simulator)
        {
            *reserve = reserve_for(simulator)
                .ok()
                .map(|socket| (simulator, socket));
        }
    }

    fn report(&self, report: &mut dyn FnMut(fmt::Arguments<'_>)) {
        if let Some(status) = &self.status {
            status.link().join_beacon_group();
            self.watch_ports(status);
            // Before it answers, there may be no program.
            if let Some((simulator, _)) = status.simulator().zip(self.answers_from()) {
                self.look_at_program(simulator);
            }
        }
        let program = self
            .status
            .as_ref()
            .and_then(|status| self.program_at(status.simulator()?));
        let mut reported = locked(&self.reported);
        if let Some(text) = self
            .status
            .as_ref()
            .and_then(|status| reported.change(status, &self.config, program))
        {
            report(format_args!("{text}"));
        }
    }

    fn release(
        &self,
        plant: &PlantId,
        within: Duration,
        is_cancelled: &mut dyn FnMut() -> bool,
    ) -> Result<Released, ActuatorFault> {
        let simulator = address(plant).ok_or(ActuatorFault::NotConnected)?;
        let expected = self.expected(simulator);
        let reserve = locked(&self.reserve)
            .take_if(|(of, _)| *of == simulator)
            .map(|(_, socket)| socket);
        XPlane::release_expecting(
            &self.config,
            simulator,
            expected,
            reserve,
            within,
            is_cancelled,
        )
        .map_err(|error| match error {
            OpenError::Bind { source, .. } => ActuatorFault::Io {
                errno: source.raw_os_error().unwrap_or(0),
            },
            _ => ActuatorFault::NotConnected,
        })
    }

    fn release_left(&self) {
        if let Some(status) = &self.status {
            status.release_left();
        }
    }

    fn by_hand(&self) -> &'static str {
        "switch off override_joystick and override_throttles there"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_address_of_this_machine_is_the_same_simulator() {
        let authority = XPlaneAuthority::without_connection(&XPlaneConfig::default());
        let unique = |address: &str| {
            let plant = plant_at(address.parse().unwrap()).unwrap();
            authority.unique(&plant).as_str().to_owned()
        };
        for here in ["127.0.0.1:49000", "127.9.9.9:49000", "[::1]:49000"] {
            assert_eq!(unique(here), "X-Plane at 127.0.0.1:49000");
        }
        // Of blocks reserved for documentation (RFC 5737, RFC 3849), so not of
        // this machine.
        for elsewhere in ["192.0.2.1:49000", "[2001:db8::1]:49000"] {
            assert_eq!(unique(elsewhere), format!("X-Plane at {elsewhere}"));
        }
    }
}
