//! Taking up a flight that was cut off: when, and when not.
//!
//! The sensors have to say that the aircraft flies, which is what
//! [`engage_inhibits`](fcc_core::framework::Controller::engage_inhibits) look at before any
//! engaging: everything fresh, faster than the envelope's floor, not upset. And
//! a hand that has switched off in the meantime has the last word.

use std::time::Duration;

use fcc_core::flight::guidance::Targets;
use fcc_core::flight::{AutopilotCommand, Resume};
use fcc_core::framework::{Controller, EventKind, Flags, LoopCommand, Message, State, Switch};
use fcc_runtime::CommandSender;
use fcc_telemetry::FlightMessage;

use super::boot_clock::BootInstant;
use super::state_file::Saved;
use crate::flight::pilot::Pilot;

const M_FT: f64 = 1.0 / 0.304_8;
const MPS_KT: f64 = 3_600.0 / 1_852.0;

/// A flight that is to be taken up.
#[derive(Debug)]
pub(super) struct TakingUp {
    saved: Saved,
    ordered: Option<Resume>,
    /// Of the newest tick.
    seen: Option<Seen>,
}

#[derive(Clone, Copy, Debug)]
struct Seen {
    state: State,
    engage_inhibits: Flags,
    switched_off: bool,
}

/// What comes next.
#[derive(Debug)]
pub(super) enum Next {
    /// Nothing yet.
    Wait,
    /// Now is the time to command this.
    Command(Resume),
    /// It is flown again.
    Taken(String),
    /// It is not.
    LeftAlone(String),
}

impl TakingUp {
    pub(super) const fn new(saved: Saved) -> Self {
        Self {
            saved,
            ordered: None,
            seen: None,
        }
    }

    /// How often in a row the flight had been taken up before.
    pub(super) const fn take_ups(&self) -> u32 {
        self.saved.take_ups
    }

    /// Takes what the loop tells.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        match message {
            Message::Tick(record) => {
                let switch = record.measurements.engage_switch;
                self.seen = Some(Seen {
                    state: record.state.state(),
                    engage_inhibits: record.engage_inhibits,
                    switched_off: !switch.is_never() && switch.value == Switch::Off,
                });
            }
            Message::Event(event) => {
                if matches!(event.kind, EventKind::EngageRefused { .. }) {
                    self.ordered = None;
                }
            }
        }
    }

    /// What comes next.
    pub(super) fn go_on(&self, now: Option<BootInstant>, max_age: Duration) -> Next {
        let Some(seen) = self.seen else {
            return Next::Wait;
        };
        let age = now.and_then(|now| now.since(&self.saved.at));
        let age = age.unwrap_or(Duration::MAX);
        match (seen.state, &self.ordered) {
            (State::Engaged, Some(resume)) => return Next::Taken(taken_up(resume, age)),
            (State::Standby, None) => {}
            (State::Standby, Some(_)) => return Next::Wait,
            _ => return Next::LeftAlone("the flight that was cut off is not taken up".to_owned()),
        }
        if self.saved.switch_on && seen.switched_off {
            return Next::LeftAlone(
                "the flight that was cut off is not taken up: it was switched off since".to_owned(),
            );
        }
        if age > max_age {
            let mut words = format!(
                "the flight that was cut off was not taken up within restart.max_age_s, {} s",
                max_age.as_secs_f64()
            );
            for (n, bit) in seen.engage_inhibits.iter().enumerate() {
                words.push_str(if n == 0 { ": " } else { ", " });
                words.push_str(Pilot::flag_name(bit));
            }
            return Next::LeftAlone(words);
        }
        if !seen.engage_inhibits.is_empty() {
            return Next::Wait;
        }
        // The mode's time went on while nobody flew it.
        let mut resume = self.saved.resume;
        resume.progress.elapsed_s += age.as_secs_f64();
        Next::Command(resume)
    }

    /// Commands it: engage first, for engaging forgets what was ordered before.
    /// Without room for both neither is sent, for engaged alone it would fly
    /// something else; it is tried again.
    pub(super) fn command(
        &mut self,
        commands: &mut CommandSender<AutopilotCommand>,
        resume: Resume,
    ) {
        let both = [
            LoopCommand::Engage,
            LoopCommand::Controller(AutopilotCommand::Resume(resume)),
        ];
        if commands.room() >= both.len() {
            let sent = both
                .into_iter()
                .all(|command| commands.send(command).is_ok());
            self.ordered = sent.then_some(resume);
        }
    }
}

fn taken_up(resume: &Resume, age: Duration) -> String {
    let Targets {
        airspeed_mps,
        heading_rad,
        altitude_m,
    } = resume.progress.captured;
    format!(
        "the flight was taken up {:.2} s after it was last kept: {}, {:.1} s after it captured \
         heading {:.0}°, altitude {:.0} ft, airspeed {:.1} kt",
        age.as_secs_f64(),
        resume.progress.mode,
        resume.progress.elapsed_s,
        heading_rad.to_degrees(),
        altitude_m * M_FT,
        airspeed_mps * MPS_KT
    )
}

#[cfg(test)]
mod tests {
    use fcc_core::flight::guidance::{Mode, Progress};
    use fcc_core::flight::{Autopilot, Surfaces};
    use fcc_runtime::{LoopConfig, Machine, Parts};
    use fcc_timer::ManualTimer;

    use super::*;
    use crate::config::Config;

    #[test]
    fn both_orders_are_sent_or_neither() {
        let resume = Resume {
            progress: Progress {
                mode: Mode::Hold,
                ..Progress::default()
            },
            surfaces: Surfaces::default(),
        };
        let saved = Saved {
            at: BootInstant::now().unwrap(),
            config: 0,
            switch_on: true,
            take_ups: 0,
            resume,
        };
        for (room, sent) in [(1, 0), (2, 2), (3, 2)] {
            let config = LoopConfig {
                commands_capacity: room,
                ..LoopConfig::default()
            };
            let parts = Parts {
                timer: Box::new(ManualTimer::new(Duration::from_millis(25)).unwrap()),
                sensors: Vec::new(),
                controller: Autopilot::new(Config::default().autopilot_config()),
                actuators: Vec::new(),
            };
            let (_machine, mut link) = Machine::new(parts, &config).unwrap();
            let mut taking_up = TakingUp::new(saved.clone());
            taking_up.command(&mut link.commands, resume);
            assert_eq!(room - link.commands.room(), sent);
            assert_eq!(taking_up.ordered.is_some(), sent == 2);
        }
    }
}
