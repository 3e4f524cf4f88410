//! The process that publishes, as seen by the daemon: started, given messages,
//! and started again when it has ended.
//!
//! Other programs of the user can do anything to shared memory; the kernel
//! then ends the process that uses it (`SIGBUS`, `SIGSEGV`). So the daemon uses
//! none: it sends messages over a socket, of which it waits for no answer.

use std::collections::VecDeque;
use std::fmt;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use fcc_core::framework::schema::Schema;

use super::command::{PendingCommand, Verdict};
use super::item::Item;
use super::message::{self, Encoded, FromPublisher, Received, ToPublisher, pair, put, take};
use super::publishing_thread::{NO_RESPONSE, PATIENCE};
use super::{EVENT_HISTORY, Event, Info, PublishError};
use fcc_telemetry::{Instance, Telemetry, not_started};

/// Makes the command that starts the process; its standard input is given to
/// it here.
pub type StartPublisher = Box<dyn FnMut() -> io::Result<Command> + Send>;

/// Between two looks while it is waited for.
const LOOK_EVERY: Duration = Duration::from_millis(2);
/// Without a sign of life for this long, in which this process was not delayed
/// itself, it is ended. A watcher that joins may delay it by a second.
const SILENT_POLLS: u32 = 75;
const SILENT_FOR: Duration = Duration::from_millis(1_500);
/// The same until it publishes: its program is loaded first, which takes a slow or
/// busy machine seconds.
const BEGINS_WITHIN: Duration = Duration::from_secs(30);
/// One that ended sooner, or never published, is started again later, twice as late
/// each time.
const SHORT_LIFE: Duration = Duration::from_millis(500);
const FIRST_DELAY: Duration = Duration::from_millis(20);
const LONGEST_DELAY: Duration = Duration::from_secs(10);
/// Further ends are reported together, after this time.
const REPORT_EVERY: Duration = Duration::from_secs(10);
/// Messages read in one poll, so that a process that sends without end delays
/// nothing.
const MOST_READ: usize = 64;

/// The process that publishes.
pub(super) struct PublisherProcess {
    program: StartPublisher,
    instance: Instance,
    waiting: usize,
    takes_commands: bool,
    running: Option<Running>,
    /// What a process that is started again is told.
    info: Option<Info>,
    events: VecDeque<Event>,
    commands: VecDeque<PendingCommand>,
    texts: VecDeque<String>,
    /// Records that earlier processes could not publish.
    lost: u64,
    starts: u64,
    again_at: Instant,
    delay: Duration,
    unreported: u32,
    report_at: Instant,
    encoded: Encoded,
    room: Vec<u8>,
}

struct Running {
    child: Child,
    socket: OwnedFd,
    began: Instant,
    publishes: bool,
    /// Why it does not publish.
    refused: Option<String>,
    /// When it last told that it makes progress, and the polls since.
    alive: Instant,
    polls: u32,
    not_published: u64,
}

impl fmt::Debug for PublisherProcess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PublisherProcess")
            .field("instance", &self.instance)
            .field("starts", &self.starts)
            .finish_non_exhaustive()
    }
}

impl PublisherProcess {
    /// Starts it, and waits until it publishes, or for a limited time: one that is
    /// slow publishes later, which is reported.
    pub(super) fn start(
        program: StartPublisher,
        instance: &Instance,
        waiting: usize,
        takes_commands: bool,
    ) -> Result<Self, PublishError> {
        let now = Instant::now();
        let mut this = Self {
            program,
            instance: instance.clone(),
            waiting,
            takes_commands,
            running: None,
            info: None,
            events: VecDeque::with_capacity(EVENT_HISTORY),
            commands: VecDeque::new(),
            texts: VecDeque::new(),
            lost: 0,
            starts: 0,
            again_at: now,
            delay: FIRST_DELAY,
            unreported: 0,
            report_at: now,
            encoded: Encoded::default(),
            room: message::room(),
        };
        let failed = |words: String| PublishError::NoSharedMemory(words);
        this.run().map_err(|error| {
            let why = not_started(error);
            failed(format!("its process cannot be started: {why}"))
        })?;
        let deadline = now + PATIENCE;
        while let Some(running) = &mut this.running {
            match take(&running.socket, &mut this.room) {
                Received::Other(FromPublisher::Started(Ok(()))) => {
                    running.publishes = true;
                    return Ok(this);
                }
                Received::Other(FromPublisher::Started(Err(error))) => return Err(error),
                Received::Closed => {
                    return Err(failed("its process has ended".to_owned()));
                }
                _ if Instant::now() > deadline => break,
                _ => std::thread::sleep(LOOK_EVERY),
            }
        }
        this.texts
            .push_back(format!("no live telemetry yet: {NO_RESPONSE}"));
        Ok(this)
    }

    fn run(&mut self) -> io::Result<()> {
        let (socket, theirs) = pair()?;
        let child = (self.program)()?.stdin(Stdio::from(theirs)).spawn()?;
        let now = Instant::now();
        let begin = ToPublisher::Begin {
            instance: self.instance.clone(),
            takes_commands: self.takes_commands,
            // The answer to a command of an earlier process is none of this.
            first_command: self.starts << u32::BITS,
            waiting: self.waiting,
        };
        self.starts += 1;
        put(&socket, self.encoded.other(&begin));
        if let Some(info) = self.info {
            put(&socket, self.encoded.other(&ToPublisher::Info(info)));
        }
        for event in &self.events {
            put(&socket, self.encoded.other(&ToPublisher::Event(*event)));
        }
        self.running = Some(Running {
            child,
            socket,
            began: now,
            publishes: false,
            refused: None,
            alive: now,
            polls: 0,
            not_published: 0,
        });
        Ok(())
    }

    /// Hands over a record; whether there was room.
    pub(super) fn record<T: Schema>(&mut self, record: &T) -> bool {
        match &self.running {
            Some(running) => put(&running.socket, self.encoded.record(record)),
            None => false,
        }
    }

    /// Hands over another item.
    pub(super) fn put<C: Telemetry>(&mut self, item: &Item<C>) {
        let message = match item {
            Item::Record(_) => return,
            Item::Event(event) => {
                if self.events.len() == EVENT_HISTORY {
                    self.events.pop_front();
                }
                self.events.push_back(*event);
                ToPublisher::Event(*event)
            }
            Item::Info(info) => {
                self.info = Some(*info);
                ToPublisher::Info(*info)
            }
            Item::Status(status) => ToPublisher::Status(*status),
        };
        self.send(&message);
    }

    pub(super) fn next_command(&mut self) -> Option<PendingCommand> {
        self.commands.pop_front()
    }

    pub(super) fn answer(&mut self, id: u64, verdict: Verdict) {
        self.send(&ToPublisher::Answer(id, verdict));
    }

    /// Records that earlier processes could not publish.
    pub(super) const fn lost(&self) -> u64 {
        self.lost
    }

    fn send(&mut self, message: &ToPublisher) {
        if let Some(running) = &self.running {
            put(&running.socket, self.encoded.other(message));
        }
    }

    /// Reads what it sent, and starts it again if it has ended. Returns a text
    /// for the user if there is one.
    pub(super) fn poll(&mut self) -> Option<String> {
        self.read();
        if let Some(running) = &mut self.running {
            if let Some(why) = running.has_ended() {
                self.ended(&why);
            }
        } else if Instant::now() >= self.again_at
            && let Err(error) = self.run()
        {
            self.later(true);
            self.ended_because(&format!("cannot be started: {}", not_started(error)));
        }
        self.texts.pop_front()
    }

    fn read(&mut self) {
        for _ in 0..MOST_READ {
            let Some(running) = &mut self.running else {
                return;
            };
            match take(&running.socket, &mut self.room) {
                // It ends; the reason is reported with its end.
                Received::Other(FromPublisher::Started(Err(error))) => {
                    running.refused = Some(error.to_string());
                }
                Received::Other(FromPublisher::Alive(not_published)) => {
                    (running.alive, running.polls) = (Instant::now(), 0);
                    running.not_published = not_published;
                }
                Received::Other(FromPublisher::Text(text)) => {
                    if self.texts.len() < MOST_READ {
                        self.texts.push_back(text);
                    }
                }
                Received::Other(FromPublisher::Command(command)) => {
                    if self.commands.len() < MOST_READ {
                        self.commands.push_back(command);
                    }
                }
                Received::Other(FromPublisher::Started(Ok(()))) => {
                    (running.alive, running.polls) = (Instant::now(), 0);
                    running.publishes = true;
                }
                Received::Record(_) | Received::Invalid => {}
                Received::Nothing | Received::Closed => return,
            }
        }
    }

    fn ended(&mut self, why: &str) {
        let Some(running) = self.running.take() else {
            return;
        };
        self.lost = self.lost.saturating_add(running.not_published);
        self.later(!running.publishes || running.began.elapsed() < SHORT_LIFE);
        self.ended_because(why);
    }

    fn later(&mut self, soon: bool) {
        let now = Instant::now();
        if soon {
            self.again_at = now + self.delay;
            self.delay = LONGEST_DELAY.min(self.delay * 2);
        } else {
            self.again_at = now;
            self.delay = FIRST_DELAY;
        }
    }

    /// The first at once, and those of each further ten seconds together.
    fn ended_because(&mut self, why: &str) {
        self.unreported += 1;
        let now = Instant::now();
        if now < self.report_at {
            return;
        }
        self.report_at = now + REPORT_EVERY;
        let often = match std::mem::take(&mut self.unreported) {
            1 => String::new(),
            times => format!(", {times} times since the last such message"),
        };
        self.texts.push_back(format!(
            "the process that publishes live telemetry {why}{often}: it is started again, and \
             the flight is not affected"
        ));
    }
}

impl Running {
    /// Why it has ended; ends it if it hangs.
    fn has_ended(&mut self) -> Option<String> {
        if let Ok(Some(status)) = self.child.try_wait() {
            return Some(match self.refused.take() {
                Some(why) => format!("has ended ({why})"),
                None => ending(status),
            });
        }
        self.polls += 1;
        let silent_for = if self.publishes {
            SILENT_FOR
        } else {
            BEGINS_WITHIN
        };
        if self.polls > SILENT_POLLS && self.alive.elapsed() > silent_for {
            let _ = self.child.kill();
            self.polls = 0;
        }
        None
    }
}

fn ending(status: ExitStatus) -> String {
    match (status.signal(), status.code()) {
        (Some(signal), _) => format!("was ended by signal {signal}"),
        (None, Some(1)) => {
            "has ended, because its shared memory was removed, changed or damaged".to_owned()
        }
        (None, Some(code)) => format!("has ended with code {code}"),
        (None, None) => "has ended".to_owned(),
    }
}

impl Drop for PublisherProcess {
    /// It publishes what is in the socket, and ends.
    fn drop(&mut self) {
        let Some(Running {
            mut child, socket, ..
        }) = self.running.take()
        else {
            return;
        };
        drop(socket);
        let deadline = Instant::now() + PATIENCE;
        while matches!(child.try_wait(), Ok(None)) {
            if Instant::now() > deadline {
                let _ = child.kill();
                let _ = child.wait();
                return;
            }
            std::thread::sleep(LOOK_EVERY);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_that_begins_late_is_neither_done_without_nor_ended() {
        let program: StartPublisher = Box::new(|| {
            let mut command = Command::new("sleep");
            command.arg("60");
            Ok(command)
        });
        let instance = Instance::default();
        let mut process = PublisherProcess::start(program, &instance, 8, false).unwrap();
        let said = process.poll().unwrap();
        assert!(said.starts_with("no live telemetry yet: "), "{said}");
        let begun = Instant::now();
        while begun.elapsed() < SILENT_FOR * 2 {
            assert_eq!(process.poll(), None);
            std::thread::sleep(LOOK_EVERY);
        }
        assert_eq!(process.starts, 1);
        assert!(process.running.is_some());
    }
}
