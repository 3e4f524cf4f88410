//! A guided calibration, in a thread of its own: what the person is to do next, for the
//! screen, and the result in the file that flights use.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use fcc_calibration::{Coverage, GuidedCalibration, Place};
use fcc_core::framework::Tick;
use fcc_device::monotonic;
use fcc_flight::calibrate::{
    CalibrationKind, CalibrationSession, Extent, LockedCalibrationFile, beforehand, words,
};
use fcc_flight::config::Config;
use fcc_phone::Phone;
use serde::Serialize;

use crate::failure::Failure;
use crate::phone::AppPhone;

/// Time between two states.
const SHOWN_EVERY: Duration = Duration::from_millis(100);

/// What the screen shows. Its JSON is described in android/README.md.
#[derive(Clone, Debug, Default, Serialize)]
struct Shown {
    kind: &'static str,
    /// What to do before it begins.
    beforehand: &'static str,
    /// What to do next; empty before the first reading.
    next: String,
    /// 0 to 1.
    progress: f64,
    at_rest: bool,
    /// Of an accelerometer: which sides were up, and which were not.
    held: Vec<String>,
    missing: Vec<String>,
    /// Of a magnetometer: the part of the directions that were covered.
    covered: Option<f64>,
    /// What was found and stored; none while it goes on, or if it was refused.
    found: Option<String>,
    /// Why nothing was found or stored; none while it goes on, or if something was.
    refused: Option<String>,
}

/// A calibration that goes on, or has ended.
pub(crate) struct Calibration {
    shown: Arc<Mutex<Shown>>,
    is_cancelled: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// A phone's gyroscope is not turned over: its bias is found, as Android does.
const fn extent(kind: CalibrationKind) -> Extent {
    match kind {
        CalibrationKind::Gyroscope => Extent::Part,
        _ => Extent::Whole,
    }
}

impl Calibration {
    /// Begins. The kind has the name of the command line; the folder and the package are
    /// those of a flight.
    ///
    /// # Errors
    /// When there is no such kind, or no thread.
    pub(crate) fn begin(config: Config, package: &str, kind: &str) -> Result<Self, Failure> {
        let mut kinds = CalibrationKind::ALL.into_iter();
        let kind = kinds.find(|of| of.name() == kind).ok_or_else(|| {
            let names = CalibrationKind::ALL.map(CalibrationKind::name).join(", ");
            Failure::Calibration(format!("there is no calibration {kind}: choose of {names}"))
        })?;
        let shown = Arc::new(Mutex::new(Shown {
            kind: kind.name(),
            beforehand: beforehand(kind, extent(kind)),
            ..Shown::default()
        }));
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let guide = Guide {
            config,
            kind,
            phone: AppPhone(Phone::new(package)),
            shown: Arc::clone(&shown),
            is_cancelled: Arc::clone(&is_cancelled),
        };
        let thread = thread::Builder::new()
            .name("fcc-calibrate".to_owned())
            .spawn(|| guide.run())
            .map_err(|error| Failure::Calibration(format!("no thread for it: {error}")))?;
        Ok(Self {
            shown,
            is_cancelled,
            thread: Some(thread),
        })
    }

    /// The state now, as JSON.
    pub(crate) fn state(&self) -> String {
        let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        serde_json::to_string(&*shown).unwrap_or_default()
    }
}

/// What is not complete is given up.
impl Drop for Calibration {
    fn drop(&mut self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The kinds for which a configuration has sensors, in the order in which they are best
/// done, as JSON: `kind`, and what `found` is used, none if nothing is.
pub(crate) fn kinds(config: &Config) -> Result<String, Failure> {
    #[derive(Serialize)]
    struct Offered {
        kind: &'static str,
        found: Option<String>,
    }
    let mut flown = config.clone();
    let applied = fcc_flight::calibrate::apply(&mut flown, unix_s())
        .map_err(|(file, error)| Failure::Calibration(format!("{}: {error}", file.display())))?;
    let sources = config.raw_sources();
    let is_given = |kind: CalibrationKind| match kind {
        CalibrationKind::Airspeed => sources
            .iter()
            .any(|of| of.is_servo_board() || of.is_built_in()),
        _ => sources.iter().any(|of| !of.is_servo_board()),
    };
    let offered: Vec<_> = CalibrationKind::ALL
        .into_iter()
        .filter(|kind| is_given(*kind))
        .map(|kind| {
            let used = applied.used.iter().rev().find(|entry| entry.kind == kind);
            Offered {
                kind: kind.name(),
                found: used.map(fcc_flight::calibrate::Entry::describe),
            }
        })
        .collect();
    serde_json::to_string(&offered).map_err(|error| Failure::Calibration(error.to_string()))
}

struct Guide {
    config: Config,
    kind: CalibrationKind,
    phone: AppPhone,
    shown: Arc<Mutex<Shown>>,
    is_cancelled: Arc<AtomicBool>,
}

impl Guide {
    fn run(mut self) {
        let became = self.guide();
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        match became {
            Ok(found) => shown.found = Some(found),
            Err(why) => shown.refused = Some(why),
        }
    }

    /// To its end; what was found, in words, or why nothing was.
    fn guide(&mut self) -> Result<String, String> {
        let path = self.config.calibration_file();
        let wrong = |error| in_file(&path, &error);
        // Before the first step: what cannot be stored need not be measured.
        let mut file = LockedCalibrationFile::open(path.clone()).map_err(wrong)?;
        let mut session = CalibrationSession::open_on_phone(
            &self.config,
            self.kind,
            extent(self.kind),
            unix_s(),
            &mut self.phone,
        )
        .map_err(|error| error.to_string())?;
        self.read(&mut session)?;
        let entry = session
            .finish()
            .map_err(|refusal| format!("{refusal}. Nothing was changed"))?;
        let found = entry.describe();
        file.add(entry).map_err(wrong)?;
        Ok(found)
    }

    /// Reads the sensors at the loop's rate until all is there.
    fn read(&self, session: &mut CalibrationSession) -> Result<(), String> {
        let period = Duration::from_secs_f64(1.0 / self.config.tick.rate_hz);
        let mut due = Instant::now();
        let mut number = 0;
        let mut shown_at = None;
        loop {
            if self.is_cancelled.load(Ordering::Relaxed) {
                return Err("cancelled: nothing was changed".to_owned());
            }
            due += period;
            thread::sleep(due.saturating_duration_since(Instant::now()));
            number += 1;
            // Nothing is used that was taken after the tick.
            let now = monotonic();
            let tick = Tick {
                number,
                scheduled: now,
                woke: now,
                dt_s: period.as_secs_f64(),
                ..Tick::default()
            };
            session.tick(&tick).map_err(|error| error.to_string())?;
            let Some(guided) = session.guided() else {
                continue;
            };
            let is_complete = guided.is_complete();
            if is_complete || shown_at.is_none_or(|at: Instant| at.elapsed() >= SHOWN_EVERY) {
                shown_at = Some(Instant::now());
                self.show(guided);
            }
            if is_complete {
                return Ok(());
            }
        }
    }

    fn show(&self, guided: &GuidedCalibration) {
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        shown.next = words(guided.next());
        shown.progress = guided.progress();
        shown.at_rest = guided.is_at_rest();
        match guided.coverage() {
            Coverage::Places(held) => {
                let names = |wanted: bool| {
                    let of = Place::ALL.into_iter().zip(held);
                    let chosen = of.filter(|(_, is_held)| *is_held == wanted);
                    chosen.map(|(place, _)| place.to_string()).collect()
                };
                shown.held = names(true);
                shown.missing = names(false);
            }
            Coverage::Cells(cells) => {
                let covered = cells.iter().filter(|is_covered| **is_covered).count();
                shown.covered = Some(covered as f64 / cells.len() as f64);
            }
            // Of a gyroscope that is turned over, which a phone's is not.
            Coverage::Turns(_) | Coverage::None => {}
        }
    }
}

fn in_file(path: &Path, error: &dyn std::fmt::Display) -> String {
    format!("{}: {error}", path.display())
}

fn unix_s() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}
