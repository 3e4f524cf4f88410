//! `fccd calibrate KIND CONFIG`: a person turns the sensors or leaves them alone,
//! and is told what to do next. Nothing is engaged and no actuator is opened.

mod picture;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use fcc_calibration::{GuidedCalibration, Next};
use fcc_core::framework::{Tick, Time};
use fcc_flight::calibrate::{
    CalibrationFileError, CalibrationKind, CalibrationSession, Entry, Extent,
    LockedCalibrationFile, SessionError, apply, beforehand, not_calibrated, words,
};
use fcc_flight::config::Config;
use fcc_linux::monotonic;
use indicatif::ProgressBar;
use serde::Serialize;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};

use super::failure::Failure;
use crate::cli::CalibrateArgs;
use crate::exit::Exit;
use crate::output;

/// Time between two pictures.
const REDRAW_EVERY: Duration = Duration::from_millis(100);

/// Puts what was found over the configuration of a flight, and says so.
pub(super) fn apply_calibration(config: &mut Config) -> Result<(), Failure> {
    let applied = apply(config, unix_s()).map_err(|(file, error)| wrong_file(&file, &error))?;
    say(&applied.remarks);
    say(not_calibrated(config).as_slice());
    Ok(())
}

fn say(remarks: &[String]) {
    for remark in remarks {
        output::message(format_args!("fccd: remark: {remark}"));
    }
}

/// What is printed with `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    found: &'a Entry,
    /// Where it was stored; none if nothing was changed.
    file: Option<String>,
    /// Whether flights use what is stored.
    enabled: bool,
}

/// Calibrates a sensor.
pub(super) fn calibrate(args: &CalibrateArgs) -> Result<Exit, Failure> {
    let (config, _) = Config::load_with_text(&args.config)?;
    let extent = extent(args)?;
    let path = config.calibration_file();
    let place = args.sensor.clone();
    let session = CalibrationSession::open(&config, args.kind, extent, place, args.fault, unix_s());
    let mut session = session.map_err(failure)?;
    say(session.remarks());
    if args.lockstep && session.length_s().is_none() {
        return Err(Failure::of(
            Exit::Usage,
            "--lockstep is for the built-in aircraft, whose time follows that of the loop",
        ));
    }
    // Before the first step: what cannot be stored need not be measured.
    let file = (!args.dry_run).then(|| LockedCalibrationFile::open(path.clone()));
    let file = file.transpose();
    let file = file.map_err(|error| wrong_file(&path, &error))?;
    output::message(beforehand(args.kind, extent));
    guide(args, &config, &mut session)?;
    let found = session.finish().map_err(|refusal| {
        let kind = args.kind.name();
        let message = format_args!("no calibration of the {kind}: {refusal}. Nothing was changed");
        Failure::of(Exit::CalibrationRefused, message.to_string())
    })?;
    let stored = match file {
        Some(mut file) => file.add(found.clone()).map(|()| true),
        None => Ok(false),
    };
    let printed = Printed {
        found: &found,
        file: matches!(stored, Ok(true)).then(|| path.display().to_string()),
        enabled: config.calibration.enabled,
    };
    // What was measured is not lost with the disk that was full meanwhile.
    let exit = match &stored {
        Ok(_) => Exit::Success,
        Err(error) => {
            output::message(format_args!(
                "fccd: {}: {error}. What was found is printed, and its keys can be put into {}",
                path.display(),
                args.config.display()
            ));
            Exit::Failure
        }
    };
    if args.json {
        return Ok(output::json(&printed, exit));
    }
    Ok(output::result(text(&printed), exit))
}

/// How much is to be done.
fn extent(args: &CalibrateArgs) -> Result<Extent, Failure> {
    for (is_given, name, kind) in [
        (args.level_only, "--level-only", CalibrationKind::Mounting),
        (args.bias_only, "--bias-only", CalibrationKind::Gyroscope),
    ] {
        if is_given && args.kind != kind {
            let why = format!("{name} is for the {}: leave it out", kind.name());
            return Err(Failure::of(Exit::Usage, why));
        }
    }
    Ok(if args.level_only || args.bias_only {
        Extent::Part
    } else {
        Extent::Whole
    })
}

fn text(printed: &Printed<'_>) -> String {
    let Entry {
        sensor,
        error,
        error_limit,
        unit,
        keys,
        ..
    } = printed.found;
    let kind = printed.found.kind.name();
    let keys = toml::to_string(keys).unwrap_or_default();
    let stored = match &printed.file {
        Some(file) if printed.enabled => {
            format!("stored in {file}; flights use it instead of the same keys")
        }
        Some(file) => {
            format!("stored in {file}; flights do not use it, for calibration.enabled is false")
        }
        None => "not stored".to_owned(),
    };
    format!(
        "{kind} of {sensor}: an error of {error:.3} {unit} is left ({error_limit:.3} {unit} is \
         accepted)\n\n{keys}\n{stored}"
    )
}

/// Reads the sensors at the loop's rate until all is there, or the time is over.
fn guide(
    args: &CalibrateArgs,
    config: &Config,
    session: &mut CalibrationSession,
) -> Result<(), Failure> {
    let stopped = stopped_by_signals()?;
    let mut screen = Screen::new();
    let period = Duration::from_secs_f64(1.0 / config.tick.rate_hz);
    // A simulated person does not go on.
    let person_s = session.length_s().unwrap_or(f64::INFINITY);
    let limit_s = args.seconds.min(person_s);
    let begun = Instant::now();
    let mut number = 0;
    loop {
        number += 1;
        let due = period * u32::try_from(number).unwrap_or(u32::MAX);
        if stopped.load(Ordering::Relaxed) {
            return Err(Failure::new("interrupted: nothing was changed"));
        }
        if !args.lockstep {
            thread::sleep(due.saturating_sub(begun.elapsed()));
        }
        // Devices stamp what they give on the loop's clock, and nothing is used
        // that was taken after the tick.
        let now = if args.lockstep {
            Time::from_nanos(i64::try_from(due.as_nanos()).unwrap_or(i64::MAX))
        } else {
            monotonic()
        };
        let tick = Tick {
            number,
            scheduled: now,
            woke: now,
            dt_s: period.as_secs_f64(),
            ..Tick::default()
        };
        session.tick(&tick).map_err(failure)?;
        screen.show(args.kind, session);
        let is_complete = session.guided().is_some_and(GuidedCalibration::is_complete);
        if is_complete || due.as_secs_f64() >= limit_s {
            return Ok(());
        }
    }
}

fn failure(error: SessionError) -> Failure {
    let exit = match error {
        SessionError::File { path, error } => return wrong_file(&path, &error),
        SessionError::Silent(_) | SessionError::NoAccelerometer => Exit::Failure,
        SessionError::Order { .. } => Exit::CalibrationRefused,
        _ => Exit::Usage,
    };
    Failure::of(exit, error)
}

/// A file that is none of a calibration is wrong as a configuration is.
fn wrong_file(path: &Path, error: &CalibrationFileError) -> Failure {
    let exit = match error {
        CalibrationFileError::Unwritable(_) | CalibrationFileError::Locked => Exit::Failure,
        _ => Exit::Usage,
    };
    Failure::of(exit, format_args!("{}: {error}", path.display()))
}

fn stopped_by_signals() -> Result<Arc<AtomicBool>, Failure> {
    let stopped = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGQUIT, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&stopped))
            .map_err(|error| Failure::new(format_args!("signals cannot be caught: {error}")))?;
    }
    Ok(stopped)
}

/// A picture that is replaced all the time on a terminal; elsewhere a line for
/// each new thing to do, and each quarter of the way.
struct Screen {
    live: ProgressBar,
    drawn: Option<Instant>,
    /// The last line elsewhere: what to do, and how many quarters were there.
    said: Option<(Next, u8)>,
}

impl Screen {
    fn new() -> Self {
        Self {
            live: ProgressBar::new_spinner().with_style(plain()),
            drawn: None,
            said: None,
        }
    }

    fn show(&mut self, kind: CalibrationKind, session: &CalibrationSession) {
        let (Some(guided), Some(measured)) = (session.guided(), session.measured()) else {
            return;
        };
        let next = guided.next();
        let is_complete = guided.is_complete();
        if self.live.is_hidden() {
            let now = (next, (4.0 * guided.progress()) as u8);
            if self.said != Some(now) {
                self.said = Some(now);
                let percent = 100.0 * guided.progress();
                output::message(format_args!("{percent:3.0} %  {}", words(next)));
            }
            return;
        }
        if is_complete || self.drawn.is_none_or(|at| at.elapsed() >= REDRAW_EVERY) {
            self.drawn = Some(Instant::now());
            let drawn = picture::picture(kind, guided, &measured);
            self.live.set_message(drawn);
            self.live.tick();
        }
    }
}

/// The last picture stays.
impl Drop for Screen {
    fn drop(&mut self) {
        self.live.abandon();
    }
}

/// The message alone.
fn plain() -> indicatif::ProgressStyle {
    indicatif::ProgressStyle::with_template("{msg}")
        .unwrap_or_else(|_| indicatif::ProgressStyle::default_spinner())
}

pub(super) fn unix_s() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}
