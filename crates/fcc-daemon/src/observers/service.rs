//! What systemd is told of a flight, if it started the daemon (`sd_notify(3)`).
//!
//! The watchdog's sign comes from the loop's own progress: it is sent by who
//! fetches the loop's records, and only when new ones have come. A loop that
//! hangs falls silent here, and so does a daemon that no longer fetches. A
//! thread passes it on, for systemd may be busy, and then telling it takes as
//! long as that.

use std::sync::mpsc::{self, SyncSender};
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::flight::Autopilot;
use fcc_core::framework::{Controller, Flags, State, StateCode};
use fcc_flight::flight::{Access, FlightTime, Observer};
use fcc_telemetry::FlightRecord;
use sd_notify::NotifyState;

/// Signs per time-out of the watchdog: one may be late, or two.
const SIGNS_PER_TIMEOUT: u32 = 4;
/// What waits to be told; what finds no room is told next time.
const WAITING: usize = 8;
/// How long the end of a flight waits until systemd knows of it.
const PATIENCE: Duration = Duration::from_secs(1);

/// Tells systemd how the flight goes; where nobody listens, nothing comes of
/// it.
pub(crate) struct Service {
    teller: Option<Teller>,
    sign_every: Option<Duration>,
    signed: Option<Instant>,
    /// What the newest record says, if it has not been looked at.
    news: Option<Condition>,
    told: Option<Condition>,
}

/// What a status line is made of.
#[derive(Clone, Copy, PartialEq)]
struct Condition {
    state: StateCode,
    engage_inhibits: Flags,
}

impl Service {
    /// Speaks with whoever the environment names.
    pub(crate) fn from_environment() -> Self {
        Self {
            teller: std::env::var_os("NOTIFY_SOCKET").and_then(|_| Teller::start()),
            sign_every: sd_notify::watchdog_enabled().map(|within| within / SIGNS_PER_TIMEOUT),
            signed: None,
            news: None,
            told: None,
        }
    }
}

impl Observer for Service {
    fn record(&mut self, record: &FlightRecord, _: &FlightTime) {
        self.news = Some(Condition::of(record));
    }

    /// Passes on what is new: nothing if no tick came since the last time.
    fn poll(&mut self, _: &mut Access<'_>) {
        let (Some(now), Some(teller)) = (self.news.take(), &self.teller) else {
            return;
        };
        if self.told != Some(now) {
            let words = now.words();
            let news = match self.told {
                None => News::Ready(words),
                Some(_) => News::Status(words),
            };
            if teller.tell(news) {
                self.told = Some(now);
            }
        }
        if let Some(every) = self.sign_every
            && self.signed.is_none_or(|at| at.elapsed() >= every)
            && teller.tell(News::Alive)
        {
            self.signed = Some(Instant::now());
        }
    }

    /// The loop is over, and what is left may take its time.
    fn stopping(&mut self) {
        if let Some(teller) = self.teller.take() {
            teller.tell(News::Stopping);
            teller.end();
        }
    }
}

/// What there is to tell.
enum News {
    Ready(String),
    Status(String),
    Alive,
    Stopping,
}

/// The thread that tells it.
struct Teller {
    news: SyncSender<News>,
    thread: thread::JoinHandle<()>,
}

impl Teller {
    /// None where there is no thread to be had: systemd will say that it heard
    /// nothing.
    fn start() -> Option<Self> {
        let (news, heard) = mpsc::sync_channel(WAITING);
        let thread = thread::Builder::new()
            .name("fcc-notify".to_owned())
            // Where memory is locked, all of a stack is in memory.
            .stack_size(256 << 10)
            .spawn(move || heard.iter().for_each(|news| send(&news)))
            .ok()?;
        Some(Self { news, thread })
    }

    /// Whether there was room for it.
    fn tell(&self, news: News) -> bool {
        self.news.try_send(news).is_ok()
    }

    /// Waits for a while until all is told.
    fn end(self) {
        drop(self.news);
        let begun = Instant::now();
        while !self.thread.is_finished() && begun.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

impl Condition {
    fn of(record: &FlightRecord) -> Self {
        Self {
            state: record.state,
            engage_inhibits: record.engage_inhibits,
        }
    }

    fn words(self) -> String {
        let mut words = self.state.to_string();
        let because = match self.state.state() {
            State::Failsafe(_) => self.state.flags(),
            State::Standby => self.engage_inhibits,
            State::Engaged | State::Stopped => Flags::NONE,
        };
        for (n, bit) in because.iter().enumerate() {
            words.push_str(if n == 0 { ": " } else { ", " });
            words.push_str(Autopilot::flag_name(bit));
        }
        words
    }
}

fn send(news: &News) {
    // A manager that does not listen is no reason to stop flying.
    let _ = match news {
        News::Ready(words) => sd_notify::notify(&[NotifyState::Ready, NotifyState::Status(words)]),
        News::Status(words) => sd_notify::notify(&[NotifyState::Status(words)]),
        News::Alive => sd_notify::notify(&[NotifyState::Watchdog]),
        News::Stopping => {
            sd_notify::notify(&[NotifyState::Stopping, NotifyState::Status("ending")])
        }
    };
}
