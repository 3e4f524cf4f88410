//! Live telemetry of a flight.

use std::path::PathBuf;
use std::sync::Arc;

use fcc_core::framework::{Controller, EventOf, RecordOf};
use fcc_fixed_wing::{AutopilotCommand, Setpoints};
use fcc_live::{
    Command, Commandable, Event, Info, PublisherOf, RecorderState, RecorderStatus, SentCommands,
    StartPublisher, Text, Verdict,
};
use fcc_record as recording;
use fcc_telemetry::Instance;

use super::limits::FlownPlan;
use super::observer::{Access, Facts, FlightTime, Observer, Report, Reports};
use super::outcome::Outcome;
use super::plan_reader::{PlanReader, first_of};
use crate::config::Config;

/// How long the publishing thread may be delayed before records are left out, at
/// 1 kHz or less.
const PUBLISHED_WITHIN_S: f64 = 2.0;
const MOST_WAITING: usize = 2_048;

/// Publishes the run of a loop and receives commands; without effect if that is
/// not possible.
pub(super) struct Live<C: Commandable> {
    instance: Instance,
    takes_commands: bool,
    /// The most records that wait to be published.
    waiting: usize,
    /// Starts the process that publishes; a thread does without it.
    process: Option<StartPublisher>,
    publisher: Option<PublisherOf<C>>,
    commands: SentCommands<C>,
    plans: PlanReader,
    flown: FlownPlan,
    /// The newest tick.
    at: FlightTime,
}

impl<C: Commandable> Live<C> {
    pub(super) fn new(
        config: &Config,
        commands: SentCommands<C>,
        process: Option<StartPublisher>,
    ) -> Self {
        Self {
            instance: config.telemetry.instance.clone(),
            takes_commands: config.telemetry.commands,
            waiting: config.tick.ticks_in(PUBLISHED_WITHIN_S, MOST_WAITING),
            process,
            publisher: None,
            commands,
            plans: PlanReader::new(config),
            flown: FlownPlan::default(),
            at: FlightTime::default(),
        }
    }
}

impl<C> Observer<C> for Live<C>
where
    C: Commandable + Controller<Command = AutopilotCommand, Setpoints = Setpoints>,
{
    /// Begins to publish. Without shared memory the flight continues, and this
    /// is reported.
    fn prepare(&mut self, reports: &mut Reports) {
        let (instance, waiting) = (&self.instance, self.waiting);
        let started = match self.process.take() {
            Some(process) => {
                PublisherOf::start_process(process, instance, waiting, self.takes_commands)
            }
            None if self.takes_commands => PublisherOf::start_with_commands(instance, waiting),
            None => PublisherOf::start(instance, waiting),
        };
        match started {
            Ok(publisher) => self.publisher = Some(publisher),
            Err(error) => reports.mention(format!("no live telemetry for this flight: {error}")),
        }
    }

    /// Publishes the flight's facts: from here on it can be watched.
    fn begin(&mut self, facts: &Facts<'_>, _: &mut Reports) {
        let Some((publisher, granted)) = self.publisher.as_mut().zip(facts.granted) else {
            return;
        };
        let refusals: Vec<_> = granted.denied.iter().map(ToString::to_string).collect();
        publisher.describe(Info {
            rate_hz: facts.rate_hz,
            timer: Text::new(facts.timer),
            software: Text::new(env!("CARGO_PKG_VERSION")),
            commit: Text::new(env!("FCCD_GIT_HASH")),
            policy: Text::new(granted.policy),
            priority: granted.priority,
            memory_locked: granted.memory_locked.into(),
            requests_denied: refusals.len() as u32,
            refusals: Text::new(&refusals.join("\n")),
            // Named by its sensors.
            plant: Text::new(&facts.sensors.join(", ")),
            ..Info::of_this_process()
        });
    }

    fn record(&mut self, record: &RecordOf<C>, at: &FlightTime) {
        self.at = *at;
        if let Some(publisher) = &mut self.publisher {
            publisher.record(record);
            self.flown.follow(&record.setpoints, &mut self.commands);
            let (tick, state) = (record.tick.number, record.state.state());
            while let Some((id, verdict)) = self.commands.verdict(tick, state) {
                publisher.answer(id, verdict);
            }
        }
    }

    fn event(&mut self, event: &EventOf<C>, words: &str, _: &FlightTime) {
        if let Some(publisher) = &mut self.publisher {
            publisher.event(Event::new(event, words));
            self.commands.event(event);
        }
    }

    fn report(&mut self, report: &Report, at: &FlightTime) {
        let Some(publisher) = &mut self.publisher else {
            return;
        };
        match report {
            Report::Remark(words) => {
                publisher.event(Event::remark(at.tick, at.woke_ns, words));
            }
            Report::Recording(status) => publisher.recorder(recorder(status)),
            Report::Mention(_) | Report::Plan(_) => {}
        }
    }

    /// Sends other programs' commands to the loop, a plan when it was read, and
    /// publishes what was collected.
    fn poll(&mut self, access: &mut Access<'_, C::Command>) {
        let Some(publisher) = &mut self.publisher else {
            return;
        };
        let mut send = |command| {
            let sent = access.commands.send(command);
            sent.map_err(|error| error.to_string())
        };
        while let Some(asked) = publisher.next_command() {
            if let Some(words) = access.reports.commander(&asked.sender) {
                publisher.event(Event::remark(self.at.tick, self.at.woke_ns, &words));
            }
            let known = if let Command::ReplacePlan { file, item } = &asked.command {
                let (file, item) = (PathBuf::from(file), *item);
                self.plans.begin(asked, file, item)
            } else {
                self.commands.send(asked, &mut send)
            };
            if let Some((id, verdict)) = known {
                publisher.answer(id, verdict);
            }
        }
        if let Some((asked, read)) = self.plans.take() {
            let known = match read {
                Ok(plan) => {
                    let command = plan.command();
                    for words in first_of(&plan.remarks) {
                        publisher.event(Event::remark(self.at.tick, self.at.woke_ns, &words));
                        access.reports.remark(words);
                    }
                    access.reports.plan(Arc::new(plan));
                    self.commands.send_prepared(asked, command, &mut send)
                }
                Err(why) => Some((asked.id, Verdict::Refused(why))),
            };
            if let Some((id, verdict)) = known {
                publisher.answer(id, verdict);
            }
        }
        publisher.flush();
        if let Some(words) = publisher.poll() {
            // Others receive it as a report.
            publisher.event(Event::remark(self.at.tick, self.at.woke_ns, &words));
            access.reports.remark(words);
        }
    }

    /// Publishes the last messages and ends.
    fn end(&mut self, _: &str, _: &mut Outcome, _: &mut Reports) {
        self.publisher = None;
    }
}

/// The recorder's status, for live telemetry.
fn recorder(now: &recording::RecorderStatus) -> RecorderStatus {
    let name = now.file.as_ref().and_then(|file| file.file_name());
    RecorderStatus {
        state: match (&now.stopped, name) {
            (None, Some(_)) => RecorderState::Recording,
            (None, None) => RecorderState::Off,
            (Some(_), _) => RecorderState::Stopped,
        },
        recorded: now.ticks,
        not_recorded: now.not_recorded,
        bytes: now.bytes,
        name: match &now.stopped {
            Some(why) => Text::new(why),
            None => Text::new(&name.unwrap_or_default().to_string_lossy()),
        },
    }
}
