//! What MAVLink stations want from a daemon: done by the same way as for the page.
//!
//! It runs in a thread of its own, for a command may take seconds.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender};
use std::sync::{PoisonError, Weak};
use std::time::{Instant, UNIX_EPOCH};

use fcc_live::Commander;
use fcc_mavlink::{Action, Log, LogWanted, Outcome, Parameter};
use fcc_plan::Plan;
use fcc_telemetry::Instance;

use crate::commands::{Order, utc_ms};
use crate::failure::Failure;
use crate::files;
use crate::station::Station;
use crate::upload::{Upload, content};

/// What is to be done.
#[derive(Debug)]
pub(super) enum Job {
    /// A request, with who asks, and until when it may be done.
    Do {
        ticket: u32,
        sender: String,
        deadline: Instant,
        action: Action,
    },
    /// Find the content of the plan with this hash.
    Find(u64),
    /// List or read recordings.
    Log(LogWanted),
}

/// What came of it.
#[derive(Debug)]
pub(super) enum Done {
    Outcome(u32, Outcome),
    Found(u64, Option<Box<Plan>>),
    Logs(Vec<Log>),
    LogData(u16, u32, Vec<u8>),
}

/// Does what comes, one after the other, until nobody asks any more.
pub(super) fn run(
    station: &Weak<Station>,
    instance: &Instance,
    jobs: &Receiver<Job>,
    done: &Sender<Done>,
) {
    // Numbers that no page uses by chance: pages count from the time in ms.
    let mut number = u64::MAX;
    let mut line = None;
    let mut recordings = Vec::new();
    while let Ok(job) = jobs.recv() {
        let Some(station) = station.upgrade() else {
            return;
        };
        let came = match job {
            Job::Find(hash) => {
                let plan = content(&station, instance, hash);
                Done::Found(hash, plan.map(Box::new))
            }
            Job::Log(LogWanted::List) => {
                recordings = listed(&station);
                Done::Logs(recordings.iter().map(|path| log(path)).collect())
            }
            Job::Log(LogWanted::Data { log, at, bytes }) => {
                if recordings.is_empty() {
                    recordings = listed(&station);
                }
                let path = usize::from(log)
                    .checked_sub(1)
                    .and_then(|n| recordings.get(n));
                let read = path.map(|path| files::read_part(path, at.into(), bytes.into()));
                Done::LogData(log, at, read.and_then(Result::ok).unwrap_or_default())
            }
            Job::Do {
                ticket,
                sender,
                deadline,
                action,
            } => {
                number -= 1;
                let carried_out = carry_out(
                    &station,
                    instance,
                    (number, deadline, &sender),
                    &mut line,
                    action,
                );
                Done::Outcome(ticket, carried_out.map_err(|why| why.words().to_owned()))
            }
        };
        if done.send(came).is_err() {
            return;
        }
    }
}

/// The connection to a daemon: opening it takes longer than a command.
struct Line {
    sender: String,
    commander: Commander,
}

impl Line {
    /// The line that there is, if it leads to the daemon that runs now; or another one.
    fn to<'a>(
        line: &'a mut Option<Self>,
        station: &Station,
        instance: &Instance,
        sender: &str,
    ) -> Result<&'a mut Commander, Failure> {
        let process_id = station.feed(instance)?.info.process_id;
        let is_usable =
            |line: &Self| line.sender == sender && line.commander.info().process_id == process_id;
        let usable = line.take().filter(is_usable);
        let opened = match usable {
            Some(usable) => usable,
            None => Self {
                sender: sender.to_owned(),
                commander: Commander::open(instance, sender).map_err(Failure::refused)?,
            },
        };
        Ok(&mut line.insert(opened).commander)
    }
}

fn carry_out(
    station: &Station,
    instance: &Instance,
    (number, deadline, sender): (u64, Instant, &str),
    line: &mut Option<Line>,
    action: Action,
) -> Result<u64, Failure> {
    let turn = station.orders.turn.lock();
    let _turn = turn.unwrap_or_else(PoisonError::into_inner);
    let left = deadline.checked_duration_since(Instant::now());
    let left = left.ok_or_else(|| {
        Failure::refused("it waited too long: look at the aircraft, and send it again")
    })?;
    let order = Order {
        number,
        deadline_ms_utc: utc_ms() + left.as_millis() as u64,
    };
    station.orders.take(order, utc_ms())?;
    match action {
        Action::Commands(commands) => {
            for command in commands {
                let commander = Line::to(line, station, instance, sender)?;
                order.in_time(utc_ms())?;
                commander.command(&command).map_err(Failure::refused)?;
            }
            Ok(0)
        }
        Action::Plan { plan, item } => {
            let from = (order, sender.to_owned());
            let upload = Upload::new(station, instance.clone(), (&plan, item), from)?;
            upload.carry_out()?;
            Ok(upload.hash)
        }
    }
}

/// The recordings that have a number, the oldest first.
fn listed(station: &Station) -> Vec<PathBuf> {
    let mut recordings = fcc_record::files(&station.recordings).unwrap_or_default();
    recordings.truncate(u16::MAX.into());
    recordings
}

/// A recording as stations list it.
fn log(path: &Path) -> Log {
    let found = path.metadata().ok();
    let written = found.as_ref().and_then(|found| found.modified().ok());
    let since = written.and_then(|written| written.duration_since(UNIX_EPOCH).ok());
    let bytes = found.map_or(0, |found| found.len());
    Log {
        utc_s: since.map_or(0, |since| since.as_secs() as u32),
        bytes: u32::try_from(bytes).unwrap_or(u32::MAX),
    }
}

/// The parameters of a daemon: of its configuration. Names have 16 characters.
pub(super) fn parameters(station: &Station, instance: &Instance) -> Vec<Parameter> {
    let config = station.configs.of(Some(instance));
    let autopilot = config.autopilot_config();
    let (envelope, conditions) = (&autopilot.envelope, config.plan_conditions());
    let fixed = [
        ("SPD_STALL_MPS", envelope.stall_airspeed_mps),
        ("SPD_MIN_MPS", envelope.min_airspeed_mps),
        ("SPD_MAX_MPS", envelope.max_airspeed_mps),
        ("SPD_NE_MPS", envelope.never_exceed_airspeed_mps),
        ("SPD_GLIDE_MPS", envelope.best_glide_airspeed_mps),
        ("SPD_CRUISE_MPS", conditions.airspeed_mps),
        ("BANK_MAX_DEG", envelope.max_bank_rad.to_degrees()),
        ("PITCH_MAX_DEG", envelope.max_pitch_rad.to_degrees()),
        ("PITCH_MIN_DEG", envelope.min_pitch_rad.to_degrees()),
        ("CLIMB_MAX_MPS", conditions.climb_mps),
        ("SINK_MAX_MPS", conditions.descent_mps),
        ("FLOOR_M", envelope.floor_m),
        ("WIND_MAX_MPS", conditions.wind_mps),
        ("LOITER_RAD_M", conditions.loiter_radius_m),
        ("RATE_HZ", config.tick.rate_hz),
    ];
    let altimeter = Parameter {
        name: "QNH_HPA",
        value: autopilot.altimeter.setting_pa / 100.0,
        setpoint: Some(("altimeter_setting_pa", 100.0)),
    };
    let fixed = fixed.map(|(name, value)| Parameter {
        name,
        value,
        setpoint: None,
    });
    [altimeter].into_iter().chain(fixed).collect()
}
