//! The daemon in a separate process, and its recording.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use fcc_core::framework::{Message, Record};
use fcc_record::Recording;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use tempfile::TempDir;

use crate::wire::Wire;

/// How long it may take to end.
const PATIENCE: Duration = Duration::from_secs(30);

/// What the loop of any plant records: ticks, stages, states.
pub(crate) type LoopRecord = Record<(), (), (), ()>;

/// A running daemon.
pub(crate) struct Daemon {
    process: Child,
    folder: TempDir,
}

impl Daemon {
    pub(crate) fn start(
        fccd: &Path,
        port: u16,
        rate_hz: u32,
        with: &str,
    ) -> Result<Self, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let config = folder.path().join("fccd.toml");
        let recordings = folder.path().join("recordings").display().to_string();
        // The simulator's values are constant; this must not count as frozen
        // sensors.
        let text = format!(
            "[failsafe]\nsensor_frozen_s = 0.0\n\n[x-plane]\nsimulator = \"127.0.0.1:{port}\"\n\n[loop]\nrate_hz = {rate_hz}\n{with}\n\n\
             [recording]\nfolder = \"{recordings}\"\n\n[telemetry]\ninstance = \"latency-{port}\"\n\n\
             [guidance]
mode = \"hold\"\n"
        );
        fs::write(&config, text)?;
        let process = Command::new(fccd)
            .arg("run")
            .arg("--config")
            .arg(&config)
            .stdout(Stdio::null())
            .spawn()
            .map_err(|error| format!("{} does not start: {error}", fccd.display()))?;
        Ok(Self { process, folder })
    }

    /// Ends it and reads its recording; the simulator continues meanwhile.
    pub(crate) fn stop(mut self, wire: &mut Wire) -> Result<Vec<LoopRecord>, Box<dyn Error>> {
        kill(
            Pid::from_raw(self.process.id().cast_signed()),
            Signal::SIGTERM,
        )?;
        let asked = Instant::now();
        let status = loop {
            if let Some(status) = self.process.try_wait()? {
                break status;
            }
            if asked.elapsed() > PATIENCE {
                return Err("the daemon does not end".into());
            }
            wire.live_until(Instant::now() + Duration::from_millis(50))?;
        };
        if !status.success() {
            return Err(format!("the daemon: {status}").into());
        }
        let mut records = Vec::new();
        for file in fs::read_dir(self.folder.path().join("recordings"))? {
            let path = file?.path();
            if path
                .extension()
                .is_some_and(|extension| extension == "mcap")
            {
                records.extend(
                    Recording::open(&path)?
                        .messages::<Message<(), (), (), (), ()>>()?
                        .filter_map(|message| match message {
                            Message::Tick(record) => Some(record),
                            Message::Event(_) => None,
                        }),
                );
            }
        }
        Ok(records)
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        // Already ended, unless an error occurred.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
