//! The guided calibration of a sensor, by `fccd calibrate`: one at a time.

use std::process::Stdio;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::Json;
use axum::extract::State;
use fcc_telemetry::Instance;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tokio::io::{AsyncBufReadExt as _, AsyncRead, AsyncReadExt as _, BufReader};
use tokio::process::{Child, Command};
use tokio::sync::Notify;

use crate::failure::{Failure, Sent};
use crate::station::Station;

/// Lines that are kept of its output.
const MOST_LINES: usize = 50;
/// More than it ever prints.
const MOST_BYTES: u64 = 64 << 10;

/// The calibration that runs, or the last one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Calibration(Arc<Mutex<Course>>);

/// How far it is.
#[derive(Clone, Debug, Default, Serialize)]
struct Course {
    kind: String,
    /// 0 to 100.
    percent: f64,
    /// What to do next.
    now: String,
    /// What it has printed, oldest first.
    lines: Vec<String>,
    /// What was found, as text, or nothing.
    found: String,
    /// 0: found; none while it runs.
    exit_code: Option<i32>,
    /// Ends it; none while none runs.
    #[serde(skip)]
    interrupt: Option<Arc<Notify>>,
}

/// The body of a request to begin.
#[derive(Debug, Deserialize)]
pub(crate) struct Begin {
    instance: Instance,
    kind: String,
}

impl Calibration {
    fn locked(&self) -> MutexGuard<'_, Course> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads what a child prints until it has ended.
    async fn run_to_end(self, mut child: Child, interrupt: Arc<Notify>) {
        let (messages, printed) = (child.stderr.take(), child.stdout.take());
        let found = tokio::spawn(all_of(printed));
        if let Some(messages) = messages {
            let mut lines = BufReader::new(messages.take(MOST_BYTES)).lines();
            loop {
                tokio::select! {
                    line = lines.next_line() => match line {
                        Ok(Some(line)) => self.locked().add_line(line),
                        _ => break,
                    },
                    () = interrupt.notified() => if let Some(id) = child.id() {
                        // It may have ended by itself.
                        let _ = kill(Pid::from_raw(id.cast_signed()), Signal::SIGINT);
                    },
                }
            }
        }
        let status = child.wait().await;
        let found = found.await.unwrap_or_default();
        let mut course = self.locked();
        course.found = found;
        course.interrupt = None;
        course.exit_code = Some(status.ok().and_then(|status| status.code()).unwrap_or(-1));
    }
}

async fn all_of(printed: Option<impl AsyncRead + Unpin>) -> String {
    let mut bytes = Vec::new();
    if let Some(printed) = printed {
        // What was read until then.
        let _ = printed.take(MOST_BYTES).read_to_end(&mut bytes).await;
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

impl Course {
    /// Takes a line, as ` 67 %  +y+z is up: keep it still`.
    fn add_line(&mut self, line: String) {
        let parts = line.split_once(" %  ");
        let parts = parts.and_then(|(percent, now)| Some((percent.trim().parse().ok()?, now)));
        if let Some((percent, now)) = parts {
            self.percent = percent;
            now.clone_into(&mut self.now);
        }
        if self.lines.len() == MOST_LINES {
            self.lines.remove(0);
        }
        self.lines.push(line);
    }
}

/// `GET /api/calibration`.
pub(crate) async fn course(State(station): State<Arc<Station>>) -> Json<Value> {
    Json(json!(*station.calibration.locked()))
}

/// `POST /api/calibration`.
pub(crate) async fn begin(
    State(station): State<Arc<Station>>,
    Sent(begin): Sent<Begin>,
) -> Result<Json<Value>, Failure> {
    let Begin { instance, kind } = begin;
    let config = station.configs.file(&instance).ok_or_else(|| {
        Failure::refused(format!(
            "the station does not know the configuration of '{instance}': start it with --config"
        ))
    })?;
    if station.daemons.feed(&instance).is_some() {
        return Err(Failure::refused(format!(
            "fccd '{instance}' reads these sensors: stop it first"
        )));
    }
    if kind.starts_with('-') {
        return Err(Failure::bad("kind: give the name of a calibration"));
    }
    let mut course = station.calibration.locked();
    if course.interrupt.is_some() {
        return Err(Failure::refused("another calibration runs: end it first"));
    }
    let mut command = Command::new(&station.fccd);
    let command = command.arg("calibrate").arg(&kind).arg(config);
    let command = command.stdin(Stdio::null()).kill_on_drop(true);
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let child = child.map_err(|error| station.without_fccd(&error))?;
    let interrupt = Arc::new(Notify::new());
    *course = Course {
        kind,
        interrupt: Some(Arc::clone(&interrupt)),
        ..Course::default()
    };
    tokio::spawn(station.calibration.clone().run_to_end(child, interrupt));
    Ok(Json(json!(*course)))
}

/// `DELETE /api/calibration`: nothing is changed.
pub(crate) async fn end(State(station): State<Arc<Station>>) -> Result<Json<Value>, Failure> {
    let course = station.calibration.locked();
    let running = course.interrupt.as_ref();
    let running = running.ok_or_else(|| Failure::missing("no calibration runs"))?;
    running.notify_one();
    Ok(Json(json!(*course)))
}
