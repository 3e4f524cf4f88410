//! Commands of the app: sent to the loop by the flight's thread, which finds in
//! the loop's messages what became of them.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::time::Duration;

use fcc_fixed_wing::{Autopilot, AutopilotCommand, AutopilotConfig};
use fcc_flight::flight::{Access, FlightTime, Observer, Outcome, Reports, setpoint_limits};
use fcc_telemetry::{Command, FlightEvent, FlightRecord, PendingCommand, SentCommands, Verdict};

use crate::failure::Failure;

/// Commands that may wait for the flight's thread.
const MOST_WAITING: usize = 64;
/// How long a verdict may take: ten times what it takes at the slowest rate,
/// 1 Hz.
const PATIENCE: Duration = Duration::from_secs(10);

/// Who sends commands, as recorded.
const SENDER: &str = "the phone's screen";

/// A command, and where its verdict goes.
struct Asked {
    command: Command,
    answer: Sender<Verdict>,
}

/// The app's end.
#[derive(Clone)]
pub(crate) struct Commander(SyncSender<Asked>);

impl Commander {
    /// Sends a command and waits until the loop has read it; the tick that did.
    ///
    /// # Errors
    /// When it is refused, or the flight ends.
    pub(crate) fn command(&self, command: Command) -> Result<u64, Failure> {
        let refused = |why: &str| Failure::Command(why.to_owned());
        let (answer, verdict) = channel();
        self.0
            .try_send(Asked { command, answer })
            .map_err(|_| refused("the flight has ended, or too many commands wait"))?;
        match verdict.recv_timeout(PATIENCE) {
            Ok(Verdict::CarriedOut { tick }) => Ok(tick),
            Ok(Verdict::Refused(why)) => Err(Failure::Command(why)),
            Ok(Verdict::Outside(outside)) => Err(Failure::Command(outside.to_string())),
            Err(_) => Err(refused(
                "the flight ended before the command was carried out",
            )),
        }
    }
}

/// The flight's end: an observer.
pub(crate) struct Commands {
    asked: Receiver<Asked>,
    sent: SentCommands<Autopilot>,
    waiting: BTreeMap<u64, Sender<Verdict>>,
    last_id: u64,
}

impl Commands {
    /// Both ends, for an aircraft with this autopilot.
    pub(crate) fn new(autopilot: &AutopilotConfig) -> (Commander, Self) {
        let (commander, asked) = sync_channel(MOST_WAITING);
        let flight = Self {
            asked,
            sent: SentCommands::new(setpoint_limits(autopilot)),
            waiting: BTreeMap::new(),
            last_id: 0,
        };
        (Commander(commander), flight)
    }

    fn answer(&mut self, id: u64, verdict: Verdict) {
        if let Some(answer) = self.waiting.remove(&id) {
            // Who does not wait any more needs no answer.
            let _ = answer.send(verdict);
        }
    }
}

impl Observer<Autopilot> for Commands {
    fn record(&mut self, record: &FlightRecord, _: &FlightTime) {
        let (tick, state) = (record.tick.number, record.state.state());
        while let Some((id, verdict)) = self.sent.verdict(tick, state) {
            self.answer(id, verdict);
        }
    }

    fn event(&mut self, event: &FlightEvent, _: &str, _: &FlightTime) {
        self.sent.event(event);
    }

    fn poll(&mut self, access: &mut Access<'_, AutopilotCommand>) {
        while let Ok(Asked { command, answer }) = self.asked.try_recv() {
            self.last_id += 1;
            let id = self.last_id;
            self.waiting.insert(id, answer);
            let send = |command| {
                let sent = access.commands.send(command);
                sent.map_err(|error| error.to_string())
            };
            access.reports.commander(SENDER);
            let asked = PendingCommand {
                id,
                sender: SENDER.to_owned(),
                command,
            };
            let known = self.sent.send(asked, send);
            if let Some((id, verdict)) = known {
                self.answer(id, verdict);
            }
        }
    }

    fn end(&mut self, _: &str, _: &mut Outcome, _: &mut Reports) {
        // Who waits is told that there will be no answer.
        self.waiting.clear();
    }
}
