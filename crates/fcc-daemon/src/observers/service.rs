//! Notifies systemd of a flight's state, if systemd started the daemon
//! (`sd_notify(3)`).
//!
//! The watchdog notification follows the loop's progress: it is sent by the
//! thread that fetches the loop's records, and only when there are new ones. It
//! stops if the loop hangs or the daemon no longer fetches. A separate thread
//! sends it, because a busy systemd delays the sender.

use std::sync::mpsc::{self, SyncSender};
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::{Controller, EventKind, EventOf, Flags, RecordOf, State, StateCode};
use fcc_flight::flight::{Access, FlightTime, Observer};
use sd_notify::NotifyState;

/// Watchdog notifications per time-out: one or two may be late.
const ALIVE_PER_TIMEOUT: u32 = 4;
/// Notifications that may be queued; one that does not fit is sent later.
const WAITING: usize = 8;
/// How long the end of a flight waits for systemd.
const PATIENCE: Duration = Duration::from_secs(1);

/// Notifies systemd; does nothing if systemd did not start the daemon.
pub(crate) struct Service {
    notifier: Option<Notifier>,
    alive_every: Option<Duration>,
    alive_sent: Option<Instant>,
    overloaded: bool,
    /// From the newest record, if not sent yet.
    newest: Option<Condition>,
    sent: Option<Condition>,
}

/// The content of a status line.
#[derive(Clone, Copy, PartialEq)]
struct Condition {
    state: StateCode,
    engage_inhibits: Flags,
    overloaded: bool,
}

impl Service {
    /// Connects to the service manager that the environment names.
    pub(crate) fn from_environment() -> Self {
        Self {
            notifier: std::env::var_os("NOTIFY_SOCKET").and_then(|_| Notifier::start()),
            alive_every: sd_notify::watchdog_enabled().map(|within| within / ALIVE_PER_TIMEOUT),
            alive_sent: None,
            overloaded: false,
            newest: None,
            sent: None,
        }
    }
}

impl<C: Controller> Observer<C> for Service {
    fn record(&mut self, record: &RecordOf<C>, _: &FlightTime) {
        self.newest = Some(Condition {
            state: record.state,
            engage_inhibits: record.engage_inhibits,
            overloaded: self.overloaded,
        });
    }

    fn event(&mut self, event: &EventOf<C>, _: &str, _: &FlightTime) {
        match event.kind {
            EventKind::Overloaded { .. } => self.overloaded = true,
            EventKind::OverloadOver { .. } => self.overloaded = false,
            _ => {}
        }
    }

    /// Sends what is new; nothing if no tick came since the last call.
    fn poll(&mut self, _: &mut Access<'_, C::Command>) {
        let (Some(now), Some(notifier)) = (self.newest.take(), &self.notifier) else {
            return;
        };
        if self.sent != Some(now) {
            let text = now.description(C::flag_name);
            let notification = match self.sent {
                None => Notification::Ready(text),
                Some(_) => Notification::Status(text),
            };
            if notifier.notify(notification) {
                self.sent = Some(now);
            }
        }
        if let Some(every) = self.alive_every
            && self.alive_sent.is_none_or(|at| at.elapsed() >= every)
            && notifier.notify(Notification::Alive)
        {
            self.alive_sent = Some(Instant::now());
        }
    }

    /// The loop has ended: this may take time.
    fn stopping(&mut self) {
        if let Some(notifier) = self.notifier.take() {
            notifier.notify(Notification::Stopping);
            notifier.end();
        }
    }
}

/// A notification.
enum Notification {
    Ready(String),
    Status(String),
    Alive,
    Stopping,
}

/// The thread that sends notifications.
struct Notifier {
    queue: SyncSender<Notification>,
    thread: thread::JoinHandle<()>,
}

impl Notifier {
    /// `None` if no thread can be started; systemd then reports the missing
    /// notification.
    fn start() -> Option<Self> {
        let (queue, queued) = mpsc::sync_channel(WAITING);
        let thread = thread::Builder::new()
            .name("fcc-notify".to_owned())
            // With locked memory, all of a stack is resident.
            .stack_size(256 << 10)
            .spawn(move || queued.iter().for_each(|notification| send(&notification)))
            .ok()?;
        Some(Self { queue, thread })
    }

    /// Queues a notification; false if the queue is full.
    fn notify(&self, notification: Notification) -> bool {
        self.queue.try_send(notification).is_ok()
    }

    /// Waits for a limited time until all are sent.
    fn end(self) {
        drop(self.queue);
        let begun = Instant::now();
        while !self.thread.is_finished() && begun.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

impl Condition {
    fn description(self, flag_name: fn(u32) -> &'static str) -> String {
        let mut text = self.state.to_string();
        if self.overloaded {
            text.push_str(" (overload)");
        }
        let because = match self.state.state() {
            State::Failsafe(_) => self.state.flags(),
            State::Standby => self.engage_inhibits,
            State::Engaged | State::Stopped => Flags::NONE,
        };
        for (n, bit) in because.iter().enumerate() {
            text.push_str(if n == 0 { ": " } else { ", " });
            text.push_str(flag_name(bit));
        }
        text
    }
}

fn send(notification: &Notification) {
    // A failure to notify is no reason to stop flying.
    let _ = match notification {
        Notification::Ready(text) => {
            sd_notify::notify(&[NotifyState::Ready, NotifyState::Status(text)])
        }
        Notification::Status(text) => sd_notify::notify(&[NotifyState::Status(text)]),
        Notification::Alive => sd_notify::notify(&[NotifyState::Watchdog]),
        Notification::Stopping => {
            sd_notify::notify(&[NotifyState::Stopping, NotifyState::Status("ending")])
        }
    };
}
