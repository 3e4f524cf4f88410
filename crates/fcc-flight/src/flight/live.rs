//! Live telemetry of a flight.

use std::path::PathBuf;
use std::sync::Arc;

use fcc_core::framework::{Controller, EventOf, RecordOf};
use fcc_fixed_wing::Autopilot;
use fcc_live::{
    Command, Commandable, Event, Info, PendingCommand, PublisherOf, RecorderState, RecorderStatus,
    SentCommands, StartPublisher, Text, Verdict,
};
use fcc_record as recording;

use super::limits::FlownPlan;
use super::observer::{Access, Facts, FlightTime, Observer, Report, Reports};
use super::outcome::Outcome;
use super::plan_reader::{PlanReader, first_of};
use crate::config::{Config, LoopSection, PreparedPlan, TelemetrySection};

/// How long the publishing thread may be delayed before records are left out, at
/// 1 kHz or less.
const PUBLISHED_WITHIN_S: f64 = 2.0;
const MOST_WAITING: usize = 2_048;

/// The plans that commands replace; `()` has none.
pub(crate) trait Plans<C: Commandable> {
    /// Follows what is flown.
    fn follow(&mut self, _record: &RecordOf<C>, _commands: &mut SentCommands<C>) {}

    /// Begins to read a plan; an answer if that is not possible.
    fn begin(&mut self, asked: PendingCommand, _: PathBuf, _: u16) -> Option<(u64, Verdict)> {
        let refused = "the plan of this vehicle is not replaced in flight".to_owned();
        Some((asked.id, Verdict::Refused(refused)))
    }

    /// A plan that was read, and its command.
    fn read(&mut self) -> Option<(PendingCommand, Result<Prepared<C>, String>)> {
        None
    }
}

type Prepared<C> = (PreparedPlan, <C as Controller>::Command);

impl<C: Commandable> Plans<C> for () {}

/// Those of an aeroplane.
pub(super) struct FlightPlans {
    reader: PlanReader,
    flown: FlownPlan,
}

impl FlightPlans {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            reader: PlanReader::new(config),
            flown: FlownPlan::default(),
        }
    }
}

impl Plans<Autopilot> for FlightPlans {
    fn follow(&mut self, record: &RecordOf<Autopilot>, commands: &mut SentCommands<Autopilot>) {
        self.flown.follow(&record.setpoints, commands);
    }

    fn begin(&mut self, asked: PendingCommand, file: PathBuf, item: u16) -> Option<(u64, Verdict)> {
        self.reader.begin(asked, file, item)
    }

    fn read(&mut self) -> Option<(PendingCommand, Result<Prepared<Autopilot>, String>)> {
        let (asked, read) = self.reader.take()?;
        let with_command = |plan: PreparedPlan| {
            let command = plan.command();
            (plan, command)
        };
        Some((asked, read.map(with_command)))
    }
}

/// Publishes the run of a loop and receives commands; without effect if that is
/// not possible.
pub(crate) struct Live<C: Commandable, P = ()> {
    telemetry: TelemetrySection,
    /// The vehicle; without a name, that of the sensors.
    plant: Option<&'static str>,
    /// The most records that wait to be published.
    waiting: usize,
    /// Starts the process that publishes; a thread does without it.
    process: Option<StartPublisher>,
    publisher: Option<PublisherOf<C>>,
    commands: SentCommands<C>,
    plans: P,
    /// The newest tick.
    at: FlightTime,
}

impl<C: Commandable, P: Plans<C>> Live<C, P> {
    pub(crate) fn new(
        telemetry: &TelemetrySection,
        tick: &LoopSection,
        plant: Option<&'static str>,
        commands: SentCommands<C>,
        process: Option<StartPublisher>,
        plans: P,
    ) -> Self {
        Self {
            telemetry: telemetry.clone(),
            plant,
            waiting: tick.ticks_in(PUBLISHED_WITHIN_S, MOST_WAITING),
            process,
            publisher: None,
            commands,
            plans,
            at: FlightTime::default(),
        }
    }
}

impl<C: Commandable, P: Plans<C>> Observer<C> for Live<C, P> {
    /// Begins to publish. Without shared memory the flight continues, and this
    /// is reported.
    fn prepare(&mut self, reports: &mut Reports) {
        let (instance, waiting) = (&self.telemetry.instance, self.waiting);
        let takes_commands = self.telemetry.commands;
        let started = match self.process.take() {
            Some(process) => PublisherOf::start_process(process, instance, waiting, takes_commands),
            None if takes_commands => PublisherOf::start_with_commands(instance, waiting),
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
            plant: match self.plant {
                Some(name) => Text::new(name),
                None => Text::new(&facts.sensors.join(", ")),
            },
            ..Info::of_this_process()
        });
    }

    fn record(&mut self, record: &RecordOf<C>, at: &FlightTime) {
        self.at = *at;
        if let Some(publisher) = &mut self.publisher {
            publisher.record(record);
            self.plans.follow(record, &mut self.commands);
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
        if let Some((asked, read)) = self.plans.read() {
            let known = match read {
                Ok((plan, command)) => {
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
