//! MAVLink: the second face of the station, for other ground stations.
//!
//! ```text
//! Wires ─► Protocol ─► Request ─► vehicle::run ─► commands, upload, as for the page
//!   ▲          ▲                        │
//!   └── bytes ─┴── Outcome ◄────────────┘     newest record, events ─► Protocol
//! ```
//!
//! One thread owns the protocol and all links; it waits for nobody.

mod address;
mod state;
mod vehicle;
mod wires;

use std::net::IpAddr;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Weak};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use axum::extract::ws::Utf8Bytes;
use fcc_fixed_wing::ITEM_REACHED;
use fcc_live::EventCode;
use fcc_mavlink::{Identity, Key, Now, Protocol, Settings, Severity, VehicleState, read_key};
use fcc_plan::Plan;
use fcc_telemetry::schema::read_words;
use fcc_telemetry::{FlightRecord, Instance};
use serde_json::Value;
use tokio::sync::{broadcast, watch};

use crate::files;
use crate::live::{Feed, Newest};
use crate::station::Station;

pub use address::MavlinkLink;
use vehicle::{Done, Job};
use wires::{Heard, Wires};

/// How often links and records are looked at.
const STEP: Duration = Duration::from_millis(5);
/// How often the time stamp of signatures is kept.
const KEEP_EVERY: Duration = Duration::from_secs(30);
/// How often a daemon is looked for, and the magnetic field is looked up.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// Without a record for so long, what is known of the aircraft is old.
const OLD_AFTER: Duration = Duration::from_millis(1_500);
/// The longest file of a key.
const KEY_BYTES: u64 = 1_024;
/// A year of the World Magnetic Model, s.
const YEAR_S: f64 = 365.25 * 86_400.0;

/// What the command line says about MAVLink.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    pub(crate) links: Vec<MavlinkLink>,
    pub(crate) allowed: Vec<IpAddr>,
    pub(crate) system: u8,
    pub(crate) identity: Identity,
    pub(crate) key: Option<PathBuf>,
    pub(crate) instance: Instance,
}

/// Starts it; it ends with the station.
///
/// # Errors
/// What cannot be opened, and what to do.
pub(crate) fn start(station: &Arc<Station>, options: &Options) -> Result<(), String> {
    let exposed = options.links.iter().any(MavlinkLink::is_open_to_others);
    if exposed && options.allowed.is_empty() && options.key.is_none() {
        return Err(
            "a link listens to other machines: give --mavlink-allow ADDRESS, or --mavlink-key FILE"
                .to_owned(),
        );
    }
    let key = options.key.as_deref().map(key_of).transpose()?;
    let kept = station.state.join("mavlink-time");
    let newest = match files::read_limited(&kept, KEY_BYTES) {
        Ok(text) => text.trim().parse().unwrap_or(0),
        Err(_) => 0,
    };
    let clock = Clock(Instant::now());
    let settings = Settings {
        system: options.system,
        identity: options.identity,
        key: key.clone(),
        newest_time_stamp: newest,
    };
    let mut protocol = Protocol::new(settings, clock.now());
    protocol.set_parameters(vehicle::parameters(
        station.configs.of(Some(&options.instance)),
    ));
    let opened = Wires::open(&options.links, &options.allowed);
    let (wires, heard) = opened.map_err(|error| format!("--mavlink: {error}"))?;
    let (jobs, to_do) = channel();
    let (done, came) = channel();
    let instance = options.instance.clone();
    let mut face = Face {
        station: Arc::downgrade(station),
        instance: instance.clone(),
        protocol,
        wires,
        clock,
        watched: None,
        plan: None,
        asked_for: 0,
        jobs,
        came,
    };
    face.hear(heard);
    let worker = Arc::downgrade(station);
    thread::Builder::new()
        .name("ground-mav-do".to_owned())
        .spawn(move || vehicle::run(&worker, &instance, &to_do, &done))
        .and_then(|_| {
            let keep = key.is_some().then_some(kept);
            let loop_ = move || face.run(keep.as_deref());
            thread::Builder::new()
                .name("ground-mavlink".to_owned())
                .spawn(loop_)
        })
        .map(drop)
        .map_err(|error| format!("no thread for MAVLink: {error}"))
}

/// The key of a file that nobody else can read.
fn key_of(path: &Path) -> Result<Key, String> {
    let wrong = |what: String| format!("--mavlink-key {}: {what}", path.display());
    let text = files::read_limited(path, KEY_BYTES).map_err(|error| wrong(error.to_string()))?;
    let mode = path.metadata().map(|found| found.permissions().mode());
    if mode.map_or(true, |mode| mode & 0o077 != 0) {
        return Err(wrong("others may read it: chmod 600".to_owned()));
    }
    read_key(&text).map_err(wrong)
}

/// Monotonic time since the start, and the time of day.
#[derive(Clone, Copy, Debug)]
struct Clock(Instant);

impl Clock {
    fn now(self) -> Now {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        Now {
            ms: self.0.elapsed().as_millis() as u64,
            utc_us: since.map_or(0, |since| since.as_micros() as u64),
        }
    }

    /// The instant of a time in ms.
    fn instant(self, ms: u64) -> Instant {
        self.0 + Duration::from_millis(ms)
    }
}

/// A daemon that is followed.
struct Watched {
    feed: Arc<Feed>,
    records: watch::Receiver<Newest>,
    events: broadcast::Receiver<Utf8Bytes>,
    variation_rad: f64,
    /// When the newest record came.
    came: Instant,
}

/// The thread that owns the protocol.
struct Face {
    station: Weak<Station>,
    instance: Instance,
    protocol: Protocol,
    wires: Wires,
    clock: Clock,
    watched: Option<Watched>,
    /// The content of the vehicle's plan, and the hash that was asked for last.
    plan: Option<Box<Plan>>,
    asked_for: u64,
    jobs: Sender<Job>,
    came: Receiver<Done>,
}

impl Face {
    fn run(&mut self, keep: Option<&Path>) {
        let (mut looked, mut kept) = (Instant::now(), Instant::now());
        self.look();
        while let Some(station) = self.station.upgrade() {
            if self.watched.is_none() || looked.elapsed() > LOOK_EVERY {
                looked = Instant::now();
                self.look();
            }
            self.follow();
            let heard = self.wires.read();
            self.hear(heard);
            self.pass_on();
            let owner = self.protocol.owner().unwrap_or(0);
            station.orders.mavlink_owner.store(owner, Ordering::Release);
            drop(station);
            let wires = &mut self.wires;
            self.protocol
                .step(self.clock.now(), |link, frame| wires.write(link, frame));
            if let Some(path) = keep.filter(|_| kept.elapsed() > KEEP_EVERY) {
                kept = Instant::now();
                let newest = self.protocol.newest_time_stamp().to_string();
                // Without it, the clock of this machine stands for it.
                let _ = files::replace(path, newest.as_bytes());
            }
            thread::sleep(STEP);
        }
    }

    fn hear(&mut self, heard: Vec<Heard>) {
        for one in heard {
            let now = self.clock.now();
            match one {
                Heard::Opened(link, options) => self.protocol.open(link, options, now),
                Heard::Bytes(link, bytes) => {
                    if self.protocol.receive(link, &bytes, now) {
                        self.wires.know(link);
                    }
                }
                Heard::Closed(link) => self.protocol.close(link),
            }
        }
    }

    /// Looks for the daemon, which may be another process now.
    fn look(&mut self) {
        let Some(station) = self.station.upgrade() else {
            return;
        };
        if self
            .watched
            .as_ref()
            .is_some_and(|one| one.feed.has_ended())
        {
            self.watched = None;
        }
        let feed = station.daemons.feed(&self.instance);
        let feed = feed.filter(|feed| feed.is_flight && self.watched.is_none());
        if let Some(feed) = feed {
            let (mut records, (_, events)) = (feed.records(), feed.events());
            // The one that is there is new here.
            records.mark_changed();
            self.watched = Some(Watched {
                feed,
                records,
                events,
                variation_rad: 0.0,
                came: Instant::now(),
            });
        }
        let year = 1_970.0 + self.clock.now().utc_us as f64 * 1e-6 / YEAR_S;
        // The built-in aircraft's compass points to true north.
        let is_true = station.configs.of(Some(&self.instance)).built_in.is_some();
        if let Some(watched) = self.watched.as_mut().filter(|_| !is_true)
            && let Ok(record) = read_words::<FlightRecord>(&watched.records.borrow().row)
            && let Some(position) = state::state(&record, None, 0.0).motion.position
        {
            watched.variation_rad = state::variation_rad(position, year);
        }
    }

    /// Takes the newest record and events of the daemon.
    fn follow(&mut self) {
        let Some(watched) = &mut self.watched else {
            return;
        };
        if watched.feed.has_ended() {
            self.watched = None;
            self.protocol.set_state(VehicleState {
                plan_hash: self.protocol.plan_hash(),
                ..VehicleState::default()
            });
            return;
        }
        if watched.came.elapsed() > OLD_AFTER {
            self.protocol.set_old();
        }
        if watched.records.has_changed().unwrap_or(false) {
            watched.came = Instant::now();
            let newest = watched.records.borrow_and_update().clone();
            if let Ok(record) = read_words::<FlightRecord>(&newest.row) {
                let state = state::state(&record, self.plan.as_deref(), watched.variation_rad);
                let hash = state.plan_hash;
                self.protocol.set_state(state);
                self.find_plan(hash);
            }
        }
        for _ in 0..fcc_live::EVENT_HISTORY {
            let event = self
                .watched
                .as_mut()
                .map(|watched| watched.events.try_recv());
            match event {
                Some(Ok(told)) => self.tell(&told),
                Some(Err(broadcast::error::TryRecvError::Lagged(_))) => {}
                _ => break,
            }
        }
    }

    /// Another plan than the one that is known here: its content is looked for.
    fn find_plan(&mut self, hash: u64) {
        if hash == self.asked_for {
            return;
        }
        self.asked_for = hash;
        // It has ended: so will this thread.
        let _ = self.jobs.send(Job::Find(hash));
    }

    fn tell(&mut self, told: &str) {
        let Ok(told) = serde_json::from_str::<Value>(told) else {
            return;
        };
        let Some(event) = told.get("event") else {
            return;
        };
        let number = |key: &str| event.get(key).and_then(Value::as_u64);
        let code = number("code").and_then(|code| u32::try_from(code).ok());
        let is_reached = code == Some(EventCode::Noticed as u32)
            && number("index") == Some(u64::from(ITEM_REACHED));
        if is_reached {
            let item = event
                .get("values")
                .and_then(|values| values.get(2)?.as_u64());
            let item = item.and_then(|item| u16::try_from(item).ok());
            self.protocol.item_reached(item.unwrap_or(0));
        }
        if let Some(text) = event.get("text").and_then(Value::as_str) {
            self.protocol.event(severity(code), text);
        }
    }

    /// Passes requests to the other thread, and what came of them back.
    fn pass_on(&mut self) {
        for request in self.protocol.requests() {
            let (system, component) = request.sender;
            let link = self.wires.name(request.link);
            let job = Job::Do {
                ticket: request.ticket,
                sender: format!("mavlink {system}/{component} at {link}"),
                deadline: self.clock.instant(request.deadline_ms),
                action: request.action,
            };
            // As above.
            let _ = self.jobs.send(job);
        }
        if let Some(wanted) = self.protocol.wanted_log() {
            // As above.
            let _ = self.jobs.send(Job::Log(wanted));
        }
        while let Ok(came) = self.came.try_recv() {
            match came {
                Done::Outcome(ticket, outcome) => self.protocol.finish(ticket, &outcome),
                Done::Logs(all) => self.protocol.set_logs(all),
                Done::LogData(log, at, bytes) => self.protocol.set_log_data(log, at, bytes),
                Done::Found(hash, plan) => {
                    if hash != self.protocol.plan_hash() {
                        self.protocol.set_plan(hash, plan.as_deref());
                    }
                    self.plan = plan;
                }
            }
        }
    }
}

fn severity(code: Option<u32>) -> Severity {
    use EventCode as Code;
    let is = |codes: &[Code]| codes.iter().any(|one| code == Some(*one as u32));
    if is(&[
        Code::Panicked,
        Code::TimerFailed,
        Code::Hung,
        Code::StoppedByOverload,
        Code::ReleasedAtOnce,
    ]) {
        Severity::Critical
    } else if is(&[
        Code::EngageRefused,
        Code::SensorFault,
        Code::ActuatorFault,
        Code::Overloaded,
        Code::SwitchedOnUnseen,
        Code::EngageRefusedBySwitch,
    ]) {
        Severity::Warning
    } else if is(&[
        Code::StateChanged,
        Code::ModeChanged,
        Code::ConditionsChanged,
        Code::Noticed,
    ]) {
        Severity::Notice
    } else {
        Severity::Info
    }
}
