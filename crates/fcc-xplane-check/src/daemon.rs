//! The daemon as a process of its own: started, listened to, ended, killed.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;

use crate::configuration::Guidance;

/// How long an end by a signal may take before the process is killed.
const ENDS_WITHIN: Duration = Duration::from_secs(5);
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// A line that the daemon printed.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) at: Instant,
    pub(crate) text: String,
}

impl Line {
    /// Whether it is the line of each second, and not an event.
    pub(crate) fn is_status(&self) -> bool {
        self.text.contains("  ≤") && self.text.contains(" µs")
    }
}

/// How a daemon ended.
#[derive(Debug)]
pub(crate) struct Ended {
    /// Its exit code; none if a signal killed it.
    pub(crate) code: Option<i32>,
    /// What it printed as JSON.
    pub(crate) result: Option<Value>,
}

#[derive(Debug)]
struct Running {
    child: Child,
    guidance: Guidance,
    lines: Receiver<String>,
}

/// The daemon, running or not.
#[derive(Debug)]
pub(crate) struct Daemon {
    program: PathBuf,
    folder: PathBuf,
    /// Its name for commands: of this check only.
    instance: String,
    running: Option<Running>,
    has_ended: bool,
    log: Vec<Line>,
}

impl Daemon {
    /// `program` is `fccd`; its files go into `folder`.
    pub(crate) fn new(program: PathBuf, folder: PathBuf) -> Self {
        Self {
            program,
            folder,
            instance: format!("x-plane-check-{}", std::process::id()),
            running: None,
            has_ended: true,
            log: Vec::new(),
        }
    }

    pub(crate) fn folder(&self) -> &PathBuf {
        &self.folder
    }

    /// What it is flying, if it is running.
    pub(crate) fn guidance(&self) -> Option<Guidance> {
        self.running.as_ref().map(|running| running.guidance)
    }

    /// Starts it with this configuration.
    pub(crate) fn start(&mut self, guidance: Guidance, config: &str) -> io::Result<()> {
        let file = self.folder.join("fccd.toml");
        fs::write(&file, config)?;
        let mut child = Command::new(&self.program)
            .arg("run")
            .arg("--config")
            .arg(&file)
            .args(["--instance", &self.instance, "--json"])
            // Whatever ends the check: it does not fly on unattended.
            .args(["--end-with", &std::process::id().to_string()])
            .env_remove("NOTIFY_SOCKET")
            .stdin(Stdio::null())
            // A file: it never has to wait for a reader.
            .stdout(File::create(self.folder.join("fccd.json"))?)
            .stderr(Stdio::piped())
            .spawn()?;
        let (to, lines) = mpsc::channel();
        if let Some(messages) = child.stderr.take() {
            thread::spawn(move || {
                for line in BufReader::new(messages).lines().map_while(Result::ok) {
                    if to.send(line).is_err() {
                        break;
                    }
                }
            });
        }
        self.has_ended = false;
        self.running = Some(Running {
            child,
            guidance,
            lines,
        });
        Ok(())
    }

    /// Takes over what it has printed. Returns whether it still runs.
    pub(crate) fn read(&mut self) -> bool {
        let Some(running) = &mut self.running else {
            return false;
        };
        self.has_ended = !matches!(running.child.try_wait(), Ok(None));
        let at = Instant::now();
        let lines = running.lines.try_iter();
        self.log.extend(lines.map(|text| Line { at, text }));
        !self.has_ended
    }

    /// Whether it did not run when it was last read.
    pub(crate) const fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// What it printed since a time, oldest first.
    pub(crate) fn since(&self, time: Instant) -> &[Line] {
        let first = self.log.partition_point(|line| line.at < time);
        self.log.get(first..).unwrap_or_default()
    }

    /// The last line that is no status.
    pub(crate) fn last_message(&self) -> Option<&str> {
        let mut lines = self.log.iter().rev();
        lines
            .find(|line| !line.is_status())
            .map(|line| line.text.trim())
    }

    /// Its last status line.
    pub(crate) fn status(&self) -> Option<&Line> {
        self.log.iter().rev().find(|line| line.is_status())
    }

    /// Sends it a command, as `fccd command` does. Returns its refusal.
    pub(crate) fn command(&self, command: &str) -> Result<(), String> {
        let done = Command::new(&self.program)
            .args(["command", command, "--instance", &self.instance])
            .stdin(Stdio::null())
            .output()
            .map_err(|error| error.to_string())?;
        if done.status.success() {
            Ok(())
        } else {
            Err(String::from_utf8_lossy(&done.stderr).trim().to_owned())
        }
    }

    /// Sends it a signal.
    pub(crate) fn signal(&self, signal: Signal) {
        if let Some(running) = &self.running {
            // A failure means that it has ended.
            let _ = kill(Pid::from_raw(running.child.id() as i32), signal);
        }
    }

    /// Waits until it has ended; none if it does not.
    pub(crate) fn ended(&mut self) -> Option<Ended> {
        let until = Instant::now() + ENDS_WITHIN;
        while self.read() {
            if Instant::now() >= until {
                return None;
            }
            thread::sleep(LOOK_EVERY);
        }
        let mut running = self.running.take()?;
        let code = running.child.wait().ok()?.code();
        let text = fs::read_to_string(self.folder.join("fccd.json")).ok();
        Some(Ended {
            code,
            result: text.and_then(|text| serde_json::from_str(&text).ok()),
        })
    }

    /// Ends it, if it runs, so that it releases the controls.
    pub(crate) fn stop(&mut self) -> Option<Ended> {
        self.running.as_ref()?;
        self.signal(Signal::SIGTERM);
        let ended = self.ended();
        if ended.is_none() {
            self.signal(Signal::SIGKILL);
            return self.ended();
        }
        ended
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.stop();
    }
}
