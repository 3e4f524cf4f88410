//! The latency from the simulator's datagram to ours, through the daemon as
//! installed: `fccd run` in a separate process, with telemetry and recording,
//! against a simulated X-Plane on loopback.
//!
//! The simulator stamps each frame with the monotonic clock when it sends it;
//! the kernel stamps each datagram of ours when it arrives; the recording has
//! each tick's wake-up and the durations of its stages.
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

/// Time until the autopilot may engage: it settles for a second, and the daemon
/// must first find the simulator.
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
    let report = analysis::report(&records, &wire.times(), cli.rate)?;
    println!("{}", report.markdown());
    if let Some(file) = cli.json {
        std::fs::write(file, serde_json::to_string_pretty(&report.json())?)?;
    }
    Ok(())
}
