//! Who has control of X-Plane, seen from outside the loop.

use core::fmt;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use fcc_core::framework::{ActuatorFault, ControlAuthority, PlantId, Released, TakeoverNotice};

use crate::config::XPlaneConfig;
use crate::link::Control;
use crate::missing::Missing;
use crate::no_answer::{InWords, Why};
use crate::open::{OpenError, XPlane};
use crate::silence::Silence;
use crate::simulator::SimulatorState;
use crate::status::{Trouble, XPlaneStatus};
use crate::udp_port::is_of_this_machine;

/// Prefix of the name of an X-Plane plant; its address follows.
const NAME: &str = "X-Plane at ";

/// A problem is reported only after it has lasted this long: right after the
/// start X-Plane has not yet had time to answer.
const REPORT_AFTER: Duration = Duration::from_secs(1);
/// That nothing at all arrives is reported after this long: a beacon comes about
/// every second.
const REPORT_NOTHING_AFTER: Duration = Duration::from_millis(2_500);

/// Monitors who has control of X-Plane, and releases it over a separate socket.
#[derive(Debug)]
pub struct XPlaneAuthority {
    config: XPlaneConfig,
    status: Option<XPlaneStatus>,
    reported: Mutex<Reported>,
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
        }
    }
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

    fn report(&self, report: &mut dyn FnMut(fmt::Arguments<'_>)) {
        if let Some(status) = &self.status {
            status.link().adapt_filter();
        }
        let mut reported = self.reported.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(text) = self
            .status
            .as_ref()
            .and_then(|status| reported.change(status, &self.config))
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
        // Of the one that is flown; a helper learns it from the first answer.
        let reply_port = self
            .status
            .as_ref()
            .filter(|status| status.simulator() == Some(simulator))
            .and_then(XPlaneStatus::reply_port);
        XPlane::release_expecting(&self.config, simulator, reply_port, within, is_cancelled)
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

/// The X-Plane at an address, as [`XPlaneAuthority`] names it.
pub fn plant_at(simulator: SocketAddr) -> Option<PlantId> {
    PlantId::new(format_args!("{NAME}{simulator}"))
}

fn address(plant: &PlantId) -> Option<SocketAddr> {
    plant.as_str().strip_prefix(NAME)?.parse().ok()
}

/// What was reported last.
#[derive(Debug)]
struct Reported {
    trouble: Option<(Trouble, Instant)>,
    /// Since X-Plane is silent.
    silence: Option<Silence>,
    /// What was reported about this silence.
    causes: Vec<Why>,
    last: LastReport,
    /// Which X-Plane answered, and from which port.
    answered: Option<(SocketAddr, u16)>,
    pace: SimulatorState,
    missing: Vec<Missing>,
    control: Control,
    loads_differ: bool,
    axial_backwards: bool,
    left_overridden: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum LastReport {
    Nothing,
    Trouble(Trouble),
    Good,
}

impl Default for Reported {
    fn default() -> Self {
        Self {
            trouble: None,
            silence: None,
            causes: Vec::new(),
            last: LastReport::Nothing,
            answered: None,
            pace: SimulatorState::Running,
            missing: Vec::new(),
            control: Control::Free,
            loads_differ: false,
            axial_backwards: false,
            left_overridden: false,
        }
    }
}

impl Reported {
    /// A description of what has changed; none if there is nothing to report.
    fn change(&mut self, status: &XPlaneStatus, config: &XPlaneConfig) -> Option<String> {
        let now = status.trouble();
        if self.trouble.map(|(trouble, _)| trouble) != now {
            self.trouble = now.map(|trouble| (trouble, Instant::now()));
            self.silence = None;
            self.causes.clear();
        }
        match self.trouble {
            Some((Trouble::Silent(simulator), since)) => {
                self.cause_of_silence(status, config, simulator, since)
            }
            Some((trouble, since)) => {
                let worth =
                    since.elapsed() >= REPORT_AFTER && self.last != LastReport::Trouble(trouble);
                worth.then(|| {
                    self.last = LastReport::Trouble(trouble);
                    trouble.to_string()
                })
            }
            None => self
                .recovery(status)
                .or_else(|| self.change_of_reply_port(status))
                .or_else(|| self.change_of_control(status))
                .or_else(|| self.change_of_overrides(status))
                .or_else(|| self.change_of_pace(status))
                .or_else(|| self.change_of_loads(status))
                .or_else(|| self.change_of_missing(status)),
        }
    }

    /// Why X-Plane is silent: each cause once.
    fn cause_of_silence(
        &mut self,
        status: &XPlaneStatus,
        config: &XPlaneConfig,
        simulator: SocketAddr,
        since: Instant,
    ) -> Option<String> {
        let silence = self
            .silence
            .get_or_insert_with(|| Silence::begin(config, status, simulator));
        let why = silence.look(status);
        let after = match why {
            Why::NothingArrives => REPORT_NOTHING_AFTER,
            _ => REPORT_AFTER,
        };
        if since.elapsed() < after || self.causes.contains(&why) {
            return None;
        }
        self.causes.push(why);
        self.last = LastReport::Trouble(Trouble::Silent(simulator));
        let local_port = status.local_port();
        let words = InWords {
            simulator,
            local_port,
            why,
        };
        Some(words.to_string())
    }

    /// Called while nothing is wrong: a description if something was wrong
    /// before, or at the first contact.
    fn recovery(&mut self, status: &XPlaneStatus) -> Option<String> {
        let simulator = status.simulator()?;
        match std::mem::replace(&mut self.last, LastReport::Good) {
            LastReport::Good => None,
            // Without writing it is not known whether writing would take effect
            // now.
            LastReport::Trouble(Trouble::Unconfirmed(_)) => (status.control() == Control::Held)
                .then(|| format!("the controls written to X-Plane at {simulator} take effect")),
            LastReport::Nothing => {
                let ports = status.reply_port().zip(status.local_port());
                let ports = ports.map_or_else(String::new, |(reply_port, local_port)| {
                    format!(", from its UDP port {reply_port} to {local_port} here")
                });
                let engage_switch = status.engage_switch();
                Some(format!(
                    "X-Plane at {simulator} answers{ports}; the engage switch is {engage_switch}"
                ))
            }
            LastReport::Trouble(_) => Some(format!("X-Plane at {simulator} answers")),
        }
    }

    /// That it answers from another port than before.
    fn change_of_reply_port(&mut self, status: &XPlaneStatus) -> Option<String> {
        let (simulator, port) = status.simulator().zip(status.reply_port())?;
        let (_, before) = self
            .answered
            .replace((simulator, port))
            .filter(|(of, before)| *of == simulator && *before != port)?;
        Some(format!(
            "X-Plane at {simulator} answers from UDP port {port} now, before from {before}: it was \
             started again, or another program on its machine answers in its place"
        ))
    }

    /// Whether X-Plane is paused or slow, if that has changed.
    fn change_of_pace(&mut self, status: &XPlaneStatus) -> Option<String> {
        let now = status.state();
        let text = match now {
            // The loop reports these itself.
            SimulatorState::Silent | SimulatorState::Jumped | SimulatorState::Reloaded => {
                return None;
            }
            SimulatorState::Replaying => {
                "X-Plane shows a replay: nothing is written to it until that ends"
            }
            SimulatorState::Running => "X-Plane's time runs again",
            SimulatorState::Paused => "X-Plane is paused",
            SimulatorState::Stalled => {
                "X-Plane's time has stopped although it is not paused (a map, a menu, loading): \
                 it is waited for"
            }
            SimulatorState::Fast => "X-Plane's time runs more than twice as fast as real time",
            SimulatorState::Slow => {
                "X-Plane is slow: fewer than 20 frames a second, or its time falls behind"
            }
        };
        let before = std::mem::replace(&mut self.pace, now);
        (before != now).then(|| text.to_owned())
    }

    /// Where the throttles are after a release: their levers have them again.
    fn change_of_control(&mut self, status: &XPlaneStatus) -> Option<String> {
        let before = std::mem::replace(&mut self.control, status.control());
        let released = before == Control::Held && self.control != Control::Held;
        let lever = status.throttle_lever().filter(|_| released)?;
        let percent = 100.0 * lever;
        Some(format!(
            "the throttle follows its lever again, which is at {percent:.0} %"
        ))
    }

    /// That overrides are set which no program seems to use.
    fn change_of_overrides(&mut self, status: &XPlaneStatus) -> Option<String> {
        let left = status.is_left_overridden();
        let begins = left && !self.left_overridden;
        self.left_overridden = left;
        begins.then(|| {
            "X-Plane's controls are still overridden, by a program that has ended or another one: \
             the joystick there has no effect. If none flies, engage and disengage, or switch off \
             override_joystick and override_throttles there"
                .to_owned()
        })
    }

    /// That X-Plane's loads contradict each other, and which are used; each
    /// once.
    fn change_of_loads(&mut self, status: &XPlaneStatus) -> Option<String> {
        if status.do_loads_differ() && !self.loads_differ {
            self.loads_differ = true;
            return Some(
                "X-Plane's local accelerations contradict its load factor by more than 0.3 g; \
                 the accelerations are used: fly by hand, and report it with X-Plane's version \
                 and aircraft"
                    .to_owned(),
            );
        }
        let turned = status.is_axial_backwards() && !self.axial_backwards;
        self.axial_backwards |= turned;
        turned.then(|| {
            "row 4 of Data Output has an axial load that is positive backwards: taken as such"
                .to_owned()
        })
    }

    /// A requested value that X-Plane does not send, or sends again: each
    /// change is reported once, one per call.
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
