//! The way from the simulator's datagram to ours, through the daemon as it is
//! installed: `fccd run` in a process of its own, with telemetry and recording,
//! against a simulated X-Plane on loopback.
//!
//! The simulator stamps each frame with the monotonic clock as it sends it; the
//! kernel stamps each datagram of ours as it arrives; the recording tells when
//! each tick woke and how long its stages took.
#![allow(clippy::print_stdout, reason = "a program")]

mod analysis;
mod daemon;
mod wire;

use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Parser;

use daemon::Daemon;
use wire::Wire;

/// Until the autopilot may engage: it watches for a second first, and the
/// daemon has to find the simulator.
const SETTLE: Duration = Duration::from_secs(4);

/// Follows a datagram from a simulated X-Plane through fccd and back
#[derive(Parser)]
struct Cli {
    /// The daemon
    #[arg(long, default_value = "target/release/fccd")]
    fccd: PathBuf,
    /// How long it flies, s
    #[arg(long, default_value_t = 30.0)]
    seconds: f64,
    /// The loop's rate, Hz
    #[arg(long, default_value_t = 40)]
    rate: u32,
    /// The simulator's frames per second
    #[arg(long, default_value_t = 60)]
    frames: u32,
    /// Lines for the daemon's loop section, such as 'timer = "posix"'
    #[arg(long, default_value = "")]
    with: String,
    /// Writes the figures here
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let cli = Cli::parse();
    let mut wire = Wire::open(cli.frames)?;
    let daemon = Daemon::start(&cli.fccd, wire.port()?, cli.rate, &cli.with)?;
    wire.live_until(Instant::now() + SETTLE)?;
    wire.engage();
    wire.live_until(Instant::now() + Duration::from_secs_f64(cli.seconds))?;
    let records = daemon.stop(&mut wire)?;
    let report = analysis::report(&records, &wire.seen(), cli.rate)?;
    println!("{}", report.markdown());
    if let Some(file) = cli.json {
        std::fs::write(file, serde_json::to_string_pretty(&report.json())?)?;
    }
    Ok(())
}
