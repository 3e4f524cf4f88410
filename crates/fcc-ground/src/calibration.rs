//! The guided calibration of a sensor, by `fccd calibrate`: one at a time.

use std::io;
use std::path::Path;
use std::process::Stdio;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde::Serialize;
use serde_json::{Value, json};
use tokio::io::{AsyncBufReadExt as _, AsyncRead, AsyncReadExt as _, BufReader};
use tokio::process::{Child, Command};
use tokio::sync::Notify;

use crate::failure::Failure;

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

impl Calibration {
    fn locked(&self) -> MutexGuard<'_, Course> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How far it is.
    pub(crate) fn course(&self) -> Value {
        json!(*self.locked())
    }

    /// Begins one.
    ///
    /// # Errors
    /// When another one runs, or the program cannot be started, which `not_started` words.
    pub(crate) fn begin(
        &self,
        fccd: &Path,
        kind: String,
        config: &Path,
        not_started: impl FnOnce(&io::Error) -> Failure,
    ) -> Result<Value, Failure> {
        let mut course = self.locked();
        if course.interrupt.is_some() {
            return Err(Failure::refused("another calibration runs: end it first"));
        }
        let mut command = Command::new(fccd);
        let command = command.arg("calibrate").arg(&kind).arg(config);
        let command = command.stdin(Stdio::null()).kill_on_drop(true);
        let child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let child = child.map_err(|error| not_started(&error))?;
        let interrupt = Arc::new(Notify::new());
        *course = Course {
            kind,
            interrupt: Some(Arc::clone(&interrupt)),
            ..Course::default()
        };
        tokio::spawn(self.clone().run_to_end(child, interrupt));
        Ok(json!(*course))
    }

    /// Ends the one that runs; nothing is changed.
    ///
    /// # Errors
    /// When none runs.
    pub(crate) fn end(&self) -> Result<Value, Failure> {
        let course = self.locked();
        let running = course.interrupt.as_ref();
        let running = running.ok_or_else(|| Failure::missing("no calibration runs"))?;
        running.notify_one();
        Ok(json!(*course))
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
