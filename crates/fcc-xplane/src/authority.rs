//! Who has control of X-Plane, seen from outside the loop.

use core::fmt;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use fcc_core::framework::{ActuatorFault, ControlAuthority, PlantId, Released};

use crate::config::XPlaneConfig;
use crate::link::Control;
use crate::missing::Missing;
use crate::open::{OpenError, XPlane};
use crate::simulator::SimulatorState;
use crate::status::{Trouble, XPlaneStatus};

/// Begins the name of a plant that is an X-Plane; its address follows.
const NAME: &str = "X-Plane at ";

/// Trouble that lasts this long is reported: at the start, X-Plane has not had
/// the time to answer.
const PATIENCE: Duration = Duration::from_secs(1);

/// Watches who has control of X-Plane, and gives it back by a socket of its
/// own.
#[derive(Debug)]
pub struct XPlaneAuthority {
    config: XPlaneConfig,
    status: Option<XPlaneStatus>,
    reported: Mutex<Reported>,
}

impl XPlaneAuthority {
    /// Of the connection that a sensor's or actuator's
    /// [`status`](crate::XPlaneSensor::status) is of.
    pub fn of(status: XPlaneStatus, config: &XPlaneConfig) -> Self {
        Self {
            status: Some(status),
            ..Self::without_connection(config)
        }
    }

    /// For a program that controls nothing, and only gives back what another
    /// one held.
    pub fn without_connection(config: &XPlaneConfig) -> Self {
        Self {
            config: config.clone(),
            status: None,
            reported: Mutex::default(),
        }
    }
}

impl ControlAuthority for XPlaneAuthority {
    fn plant(&self) -> Option<PlantId> {
        self.status.as_ref()?.simulator().and_then(name)
    }

    fn held(&self) -> Option<PlantId> {
        self.status.as_ref()?.held_at().and_then(name)
    }

    fn require_permission(&self) {
        if let Some(status) = &self.status {
            status.ask_first();
        }
    }

    fn permit(&self, plant: &PlantId) {
        if let Some((status, simulator)) = self.status.as_ref().zip(address(plant)) {
            status.allow(simulator);
        }
    }

    /// X-Plane listens at every address of its machine, so one on this machine
    /// has one name, whichever of them it goes by.
    fn unique(&self, plant: &PlantId) -> PlantId {
        address(plant)
            .filter(|simulator| simulator.ip().is_loopback() || is_of_this_machine(*simulator))
            .and_then(|simulator| name((Ipv4Addr::LOCALHOST, simulator.port()).into()))
            .unwrap_or(*plant)
    }

    fn report(&self, report: &mut dyn FnMut(fmt::Arguments<'_>)) {
        let mut reported = self.reported.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(words) = self
            .status
            .as_ref()
            .and_then(|status| reported.news(status))
        {
            report(format_args!("{words}"));
        }
    }

    fn release(
        &self,
        plant: &PlantId,
        within: Duration,
        is_called_off: &mut dyn FnMut() -> bool,
    ) -> Result<Released, ActuatorFault> {
        let simulator = address(plant).ok_or(ActuatorFault::NotConnected)?;
        XPlane::release_unless(&self.config, simulator, within, is_called_off).map_err(|error| {
            match error {
                OpenError::Bind { source, .. } => ActuatorFault::Io {
                    errno: source.raw_os_error().unwrap_or(0),
                },
                _ => ActuatorFault::NotConnected,
            }
        })
    }

    fn by_hand(&self) -> &'static str {
        "switch off override_joystick and override_throttles there"
    }
}

fn name(simulator: SocketAddr) -> Option<PlantId> {
    PlantId::new(format_args!("{NAME}{simulator}"))
}

fn address(plant: &PlantId) -> Option<SocketAddr> {
    plant.as_str().strip_prefix(NAME)?.parse().ok()
}

/// The kernel binds a socket to no other.
fn is_of_this_machine(mut address: SocketAddr) -> bool {
    address.set_port(0);
    UdpSocket::bind(address).is_ok()
}

/// What was reported last.
#[derive(Debug)]
struct Reported {
    trouble: Option<(Trouble, Instant)>,
    last: Last,
    pace: SimulatorState,
    missing: Vec<Missing>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Last {
    Nothing,
    Trouble(Trouble),
    Good,
}

impl Default for Reported {
    fn default() -> Self {
        Self {
            trouble: None,
            last: Last::Nothing,
            pace: SimulatorState::Running,
            missing: Vec::new(),
        }
    }
}

impl Reported {
    /// What has changed, in words; none if there is nothing to report.
    fn news(&mut self, status: &XPlaneStatus) -> Option<String> {
        let now = status.trouble();
        if self.trouble.map(|(trouble, _)| trouble) != now {
            self.trouble = now.map(|trouble| (trouble, Instant::now()));
        }
        match self.trouble {
            Some((trouble, since)) => {
                let worth = since.elapsed() >= PATIENCE && self.last != Last::Trouble(trouble);
                worth.then(|| {
                    self.last = Last::Trouble(trouble);
                    trouble.to_string()
                })
            }
            None => self
                .good_news(status)
                .or_else(|| self.change_of_pace(status))
                .or_else(|| self.change_of_missing(status)),
        }
    }

    /// Nothing is wrong; in words if something was, or at the first contact.
    fn good_news(&mut self, status: &XPlaneStatus) -> Option<String> {
        let simulator = status.simulator()?;
        match std::mem::replace(&mut self.last, Last::Good) {
            Last::Good => None,
            // Who no longer writes does not know whether it would work now.
            Last::Trouble(Trouble::Unconfirmed(_)) => (status.control() == Control::Held)
                .then(|| format!("the controls written to X-Plane at {simulator} take effect")),
            Last::Nothing => Some(format!(
                "X-Plane at {simulator} answers; what engages is {}",
                status.engage_switch()
            )),
            Last::Trouble(_) => Some(format!("X-Plane at {simulator} answers")),
        }
    }

    /// Whether X-Plane is paused or slow, if that has changed.
    fn change_of_pace(&mut self, status: &XPlaneStatus) -> Option<String> {
        let now = status.state();
        let words = match now {
            // The loop reports both itself, one as a sensor and one as a plant.
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
    fn change_of_missing(&mut self, status: &XPlaneStatus) -> Option<String> {
        let now = status.missing();
        if let Some(lost) = now.iter().find(|what| !self.missing.contains(what)) {
            self.missing.push(lost.clone());
            return Some(lost.to_string());
        }
        let back = self.missing.iter().position(|what| !now.contains(what))?;
        let what = self.missing.swap_remove(back).what();
        Some(format!("X-Plane now sends {what}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_address_of_this_machine_is_the_same_simulator() {
        let authority = XPlaneAuthority::without_connection(&XPlaneConfig::default());
        let unique = |address: &str| {
            let plant = name(address.parse().unwrap()).unwrap();
            authority.unique(&plant).as_str().to_owned()
        };
        for here in ["127.0.0.1:49000", "127.9.9.9:49000", "[::1]:49000"] {
            assert_eq!(unique(here), "X-Plane at 127.0.0.1:49000");
        }
        // Of blocks kept for documents (RFC 5737, RFC 3849), so nobody's.
        for elsewhere in ["192.0.2.1:49000", "[2001:db8::1]:49000"] {
            assert_eq!(unique(elsewhere), format!("X-Plane at {elsewhere}"));
        }
    }
}
