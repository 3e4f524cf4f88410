//! In-flight recovery: the conditions for continuing an interrupted flight.
//!
//! The sensors have to show that the aircraft flies, which is what the
//! [`engage_inhibits`](fcc_core::framework::Controller::engage_inhibits) check
//! before any engagement: all readings fresh, airspeed above the envelope's
//! floor, no upset. If the engage switch was switched off in the meantime, the
//! flight is not recovered. Only the sensor to which the switch belonged says
//! so: another's may deliver first after the start.

use std::sync::Arc;
use std::time::Duration;

use fcc_core::framework::{
    Controller, EventKind, Flags, LoopCommand, Message, State, Switch, Time,
};
use fcc_fixed_wing::{AutopilotCommand, Resume};
use fcc_guidance::Targets;
use fcc_runtime::CommandSender;
use fcc_telemetry::FlightMessage;
use fcc_telemetry::units::{M_FT, MPS_KT};

use super::boot_clock::BootInstant;
use super::saved::{Saved, SavedCommands};
use crate::config::PreparedPlan;
use crate::flight::pilot::Pilot;

/// A flight that is to be recovered.
#[derive(Debug)]
pub(super) struct Recovery {
    saved: Saved,
    /// The plan that was flown, if it is not the configuration's.
    plan: Option<Arc<PreparedPlan>>,
    commanded: Option<Resume>,
    /// The status in the latest tick.
    status: Option<LoopStatus>,
    /// The first of the readings in a row of the switch that are off.
    off_taken: Option<Time>,
    /// The switch is off, and no command engages.
    is_refused: bool,
}

#[derive(Clone, Copy, Debug)]
struct LoopStatus {
    state: State,
    engage_inhibits: Flags,
    switched_off: bool,
}

/// The next step of a recovery.
#[derive(Debug)]
pub(super) enum Next {
    /// Nothing yet.
    Wait,
    /// Command this now.
    Command(Resume),
    /// It was recovered.
    Recovered(String),
    /// It is not recovered.
    NotRecovered(String),
}

impl Recovery {
    pub(super) fn new(saved: Saved, plan: Option<Arc<PreparedPlan>>) -> Self {
        Self {
            saved,
            plan,
            commanded: None,
            status: None,
            off_taken: None,
            is_refused: false,
        }
    }

    /// The number of consecutive recoveries of the flight before this one.
    pub(super) const fn recoveries(&self) -> u32 {
        self.saved.recoveries
    }

    /// What was commanded besides.
    pub(super) const fn commands(&self) -> SavedCommands {
        self.saved.commanded
    }

    /// The plan that was flown, if it is not the configuration's.
    pub(super) const fn plan(&self) -> Option<&Arc<PreparedPlan>> {
        self.plan.as_ref()
    }

    /// Processes a message of the loop.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        match message {
            Message::Tick(record) => {
                let switch = record.measurements.engage_switch;
                let is_off = !switch.is_never()
                    && switch.source == self.saved.switch.source
                    && switch.value == Switch::Off;
                self.off_taken = is_off.then(|| self.off_taken.unwrap_or(switch.taken));
                self.status = Some(LoopStatus {
                    state: record.state.state(),
                    engage_inhibits: record.engage_inhibits,
                    // A single reading may be wrong.
                    switched_off: self.off_taken.is_some_and(|first| switch.taken > first),
                });
            }
            Message::Event(event) => match event.kind {
                EventKind::EngageRefused { .. } => self.commanded = None,
                EventKind::EngageRefusedBySwitch => self.is_refused = true,
                _ => {}
            },
        }
    }

    /// The next step of a recovery.
    pub(super) fn next(&self, now: Option<BootInstant>, max_age: Duration) -> Next {
        let Some(status) = self.status else {
            return Next::Wait;
        };
        let age = now.and_then(|now| now.since(&self.saved.at));
        let age = age.unwrap_or(Duration::MAX);
        if self.is_refused || self.saved.switch.on && status.switched_off {
            return Next::NotRecovered(
                "the interrupted flight is not recovered: it was switched off since".to_owned(),
            );
        }
        match (status.state, &self.commanded) {
            (State::Engaged, Some(resume)) => return Next::Recovered(recovered(resume, age)),
            (State::Standby, None) => {}
            (State::Standby, Some(_)) => return Next::Wait,
            _ => return Next::NotRecovered("the interrupted flight is not recovered".to_owned()),
        }
        if age > max_age {
            let mut message = format!(
                "the interrupted flight was not recovered within restart.max_age_s, {} s",
                max_age.as_secs_f64()
            );
            for (n, bit) in status.engage_inhibits.iter().enumerate() {
                message.push_str(if n == 0 { ": " } else { ", " });
                message.push_str(Pilot::flag_name(bit));
            }
            return Next::NotRecovered(message);
        }
        if !status.engage_inhibits.is_empty() {
            return Next::Wait;
        }
        // The mode's time continued during the interruption.
        let mut resume = self.saved.resume;
        resume.progress.elapsed_s += age.as_secs_f64();
        Next::Command(resume)
    }

    /// Sends the commands: engage first, since engaging discards earlier
    /// commands. Without room for all, none is sent, since engaging alone
    /// would fly something else; it is tried again.
    pub(super) fn command(
        &mut self,
        commands: &mut CommandSender<AutopilotCommand>,
        resume: Resume,
    ) {
        let plan = self.plan.as_ref().map(|plan| plan.command());
        let resumed = plan.into_iter().chain([AutopilotCommand::Resume(resume)]);
        let besides = self.saved.commanded.again(resume.progress.mode);
        let all: Vec<_> = std::iter::once(LoopCommand::Engage)
            .chain(resumed.chain(besides).map(LoopCommand::Controller))
            .collect();
        if commands.room() >= all.len() {
            let sent = all
                .into_iter()
                .all(|command| commands.send(command).is_ok());
            self.commanded = sent.then_some(resume);
        }
    }
}

fn recovered(resume: &Resume, age: Duration) -> String {
    let Targets {
        airspeed_mps,
        heading_rad,
        altitude_m,
    } = resume.progress.captured;
    format!(
        "the flight was recovered {:.2} s after its last stored state: {}, {:.1} s after it captured \
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
    use fcc_core::flight::Position;
    use fcc_fixed_wing::Autopilot;
    use fcc_guidance::{Mode, Progress};
    use fcc_runtime::{LoopConfig, Machine, Parts};
    use fcc_timer::ManualTimer;

    use super::super::saved::{SavedPlan, SavedSwitch};
    use super::*;
    use crate::config::Config;

    #[test]
    fn both_commands_are_sent_or_neither() {
        let resume = Resume {
            progress: Progress {
                mode: Mode::GoTo,
                ..Progress::default()
            },
            ..Resume::default()
        };
        let saved = Saved {
            at: BootInstant::now().unwrap(),
            config: 0,
            switch: SavedSwitch::default(),
            recoveries: 0,
            plan: SavedPlan::default(),
            resume,
            commanded: SavedCommands {
                go_to: Some(Position::default()),
                promised_s: Some(5.0),
            },
        };
        for (room, sent) in [(1, 0), (3, 0), (4, 4), (5, 4)] {
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
            let mut taking_up = Recovery::new(saved.clone(), None);
            taking_up.command(&mut link.commands, resume);
            assert_eq!(room - link.commands.room(), sent);
            assert_eq!(taking_up.commanded.is_some(), sent == 4);
        }
    }
}
