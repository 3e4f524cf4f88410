//! What MAVLink stations want from a daemon: done by the same way as for the page.
//!
//! It runs in a thread of its own, for a command may take seconds.

use std::iter::once;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender};
use std::sync::{PoisonError, Weak};
use std::time::{Instant, UNIX_EPOCH};

use fcc_core::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};
use fcc_flight::config::{Config, range_of};
use fcc_live::Commander;
use fcc_mavlink::{Action, Log, LogWanted, Outcome, Parameter};
use fcc_plan::Plan;
use fcc_telemetry::Instance;
use fcc_telemetry::units::number;

use crate::failure::Failure;
use crate::files;
use crate::orders::{Order, utc_ms};
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

/// Parameters, by names of at most 16 characters: the key of the configuration, and how much
/// of the parameter's unit one of the key's is.
const PARAMETERS: [(&str, &str, f64); 15] = [
    (
        "SPD_STALL_MPS",
        "autopilot.envelope.stall_airspeed_kt",
        KNOT_MPS,
    ),
    (
        "SPD_MIN_MPS",
        "autopilot.envelope.min_airspeed_kt",
        KNOT_MPS,
    ),
    (
        "SPD_MAX_MPS",
        "autopilot.envelope.max_airspeed_kt",
        KNOT_MPS,
    ),
    (
        "SPD_NE_MPS",
        "autopilot.envelope.never_exceed_airspeed_kt",
        KNOT_MPS,
    ),
    (
        "SPD_GLIDE_MPS",
        "autopilot.envelope.best_glide_airspeed_kt",
        KNOT_MPS,
    ),
    (
        "SPD_CRUISE_MPS",
        "autopilot.reference_airspeed_kt",
        KNOT_MPS,
    ),
    ("BANK_MAX_DEG", "autopilot.envelope.max_bank_deg", 1.0),
    ("PITCH_MAX_DEG", "autopilot.envelope.max_pitch_deg", 1.0),
    ("PITCH_MIN_DEG", "autopilot.envelope.min_pitch_deg", 1.0),
    (
        "CLIMB_MAX_MPS",
        "autopilot.envelope.max_climb_fpm",
        FOOT_PER_MINUTE_MPS,
    ),
    (
        "SINK_MAX_MPS",
        "autopilot.envelope.max_sink_fpm",
        FOOT_PER_MINUTE_MPS,
    ),
    ("FLOOR_M", "autopilot.envelope.floor_ft", FOOT_M),
    ("WIND_MAX_MPS", "plan.wind_kt", KNOT_MPS),
    ("LOITER_RAD_M", "plan.loiter_radius_m", 1.0),
    ("RATE_HZ", "loop.rate_hz", 1.0),
];

/// The parameters of a daemon: of its configuration.
pub(super) fn parameters(config: &Config) -> Vec<Parameter> {
    let keys = serde_json::to_value(config).unwrap_or_default();
    let fixed = PARAMETERS.into_iter().filter_map(|(name, key, unit)| {
        let value = keys.pointer(&format!("/{}", key.replace('.', "/")))?;
        let (least, most) = range_of(key)?;
        let range = format!("{} to {}", number(least), number(most));
        Some(Parameter {
            name,
            value: value.as_f64()? * unit,
            origin: format!("fccd reads it when it starts, from {key}, {range}"),
            setpoint: None,
        })
    });
    let altimeter = Parameter {
        name: "QNH_HPA",
        value: config.autopilot_config().altimeter.setting_pa / 100.0,
        origin: String::new(),
        setpoint: Some(("altimeter_setting_pa", 100.0)),
    };
    once(altimeter).chain(fixed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 53 kt are 27.27 m/s, 965 ft/min 4.902 m/s.
    #[test]
    fn each_parameter_has_its_value_in_si_units_and_its_range() {
        let all = parameters(&Config::default());
        assert_eq!(all.len(), 1 + PARAMETERS.len());
        let found = |name| all.iter().find(|one| one.name == name).unwrap();
        assert!((found("SPD_STALL_MPS").value - 27.27).abs() < 0.005);
        assert!((found("CLIMB_MAX_MPS").value - 4.902).abs() < 0.000_5);
        assert_eq!(found("RATE_HZ").value, 40.0);
        assert!(
            found("SPD_STALL_MPS")
                .origin
                .ends_with("stall_airspeed_kt, 5 to 300")
        );
        assert!(all.iter().all(|one| one.name.len() <= 16));
    }
}
