//! What is reported about the connection, and when.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use crate::config::XPlaneConfig;
use crate::link::Control;
use crate::missing::Missing;
use crate::no_answer::{InWords, Why};
use crate::old_datagrams::OldDatagrams;
use crate::program::Program;
use crate::silence::Silence;
use crate::simulator::SimulatorState;
use crate::status::{Trouble, XPlaneStatus};

/// A problem is reported only after it has lasted this long: right after the
/// start X-Plane has not yet had time to answer.
const REPORT_AFTER: Duration = Duration::from_secs(1);
/// That nothing at all arrives is reported after this long: a beacon comes about
/// every second.
const REPORT_NOTHING_AFTER: Duration = Duration::from_millis(2_500);

/// What was reported last.
#[derive(Debug)]
pub(crate) struct Reported {
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
    old: OldDatagrams,
    axial_backwards: bool,
    left_overridden: bool,
    /// Another X-Plane that is not connected to.
    announced: Option<SocketAddr>,
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
            old: OldDatagrams::default(),
            axial_backwards: false,
            left_overridden: false,
            announced: None,
        }
    }
}

impl Reported {
    /// A description of what has changed; none if there is nothing to report. Only the
    /// end of the `program` at the simulator's port is known to be the simulator's end.
    pub(crate) fn change(
        &mut self,
        status: &XPlaneStatus,
        config: &XPlaneConfig,
        program: Option<Program>,
    ) -> Option<String> {
        if let Some(text) = self.change_of_announced(status) {
            return Some(text);
        }
        let now = status.trouble();
        if self.trouble.map(|(trouble, _)| trouble) != now {
            self.trouble = now.map(|trouble| (trouble, Instant::now()));
            self.silence = None;
            self.causes.clear();
        }
        match self.trouble {
            Some((Trouble::Silent(simulator), since)) => {
                self.cause_of_silence(status, config, program, (simulator, since))
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
                .or_else(|| self.change_of_old(status))
                .or_else(|| self.change_of_axial_load(status))
                .or_else(|| self.change_of_missing(status)),
        }
    }

    /// Why X-Plane is silent: each cause once.
    fn cause_of_silence(
        &mut self,
        status: &XPlaneStatus,
        config: &XPlaneConfig,
        program: Option<Program>,
        (simulator, since): (SocketAddr, Instant),
    ) -> Option<String> {
        let silence = self
            .silence
            .get_or_insert_with(|| Silence::begin(config, status, simulator));
        let why = silence.look(status);
        let is_gone = program.is_some_and(|program| program.has_ended());
        if why == Why::PortClosed && is_gone && status.link().free_if_gone() {
            // Nobody confirms this one.
            self.control = Control::Free;
            return Some(format!(
                "X-Plane at {simulator} has ended, and nothing holds its controls"
            ));
        }
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

    /// That X-Plane confirmed a release, and where the throttles are then: their
    /// levers have them again.
    fn change_of_control(&mut self, status: &XPlaneStatus) -> Option<String> {
        let before = std::mem::replace(&mut self.control, status.control());
        // Confirmed while it was silent, it was still held when last looked at.
        let is_free = before != Control::Free && self.control == Control::Free;
        let simulator = status
            .simulator()
            .filter(|_| is_free && status.is_clear())?;
        let lever = status.throttle_lever().map_or_else(String::new, |lever| {
            let percent = 100.0 * lever;
            format!("; the throttle follows its lever again, which is at {percent:.0} %")
        });
        Some(format!(
            "X-Plane at {simulator} confirmed the release of its controls{lever}"
        ))
    }

    /// That another X-Plane is not connected to, and when it can be.
    fn change_of_announced(&mut self, status: &XPlaneStatus) -> Option<String> {
        let announced = status.link().announced();
        if std::mem::replace(&mut self.announced, announced) == announced {
            return None;
        }
        let (simulator, other) = status.simulator().zip(announced)?;
        Some(format!(
            "another X-Plane announced itself, at {other}: X-Plane at {simulator} is kept until it \
             confirms the release of its controls, or has ended"
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

    /// That many datagrams are old ones; once.
    fn change_of_old(&mut self, status: &XPlaneStatus) -> Option<String> {
        let simulator = status.simulator()?;
        let rate = self.old.step(Instant::now(), status.counts().late)?;
        Some(format!(
            "{rate:.0} datagrams a second from X-Plane at {simulator} are older than others that \
             arrived before, and are not used: the network delivers them late or twice, as over \
             cable and Wi-Fi at once, or another program repeats them: connect both machines by \
             one cable, and end that program"
        ))
    }

    /// That the axial load is turned round; once.
    fn change_of_axial_load(&mut self, status: &XPlaneStatus) -> Option<String> {
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
