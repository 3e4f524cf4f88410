//! `fccd timing`: the experiment of the thesis (section 6.1).
//!
//! The whole loop runs, as it did there: at each rate the built-in aircraft is
//! flown, and the wake-up times are reported.

use std::thread;
use std::time::{Duration, Instant};

use fcc_report::timing_table;
use indicatif::{ProgressBar, ProgressStyle};

use super::failure::Failure;
use crate::cli::TimingArgs;
use crate::exit::Exit;
use crate::output;
use crate::process::Process;
use fcc_flight::config::{BuiltInSection, Config, EarlyWakeSection, GuidanceSection, LoopSection};
use fcc_flight::flight::{Length, Outcome, Pace, Plan, assemble, fly};

/// Measures at each rate.
pub(super) fn timing(args: &TimingArgs) -> Result<Exit, Failure> {
    let mut reports = Vec::new();
    for rate_hz in &args.rates {
        let outcome = measure(args, *rate_hz).map_err(Failure::new)?;
        reports.push(outcome.timing);
        if outcome.interrupted {
            output::message(format_args!(
                "{}: reported until then, at {} of {} rates",
                outcome.ending,
                reports.len(),
                args.rates.len()
            ));
            break;
        }
    }
    Ok(if args.json {
        output::json(&reports, Exit::Success)
    } else {
        output::result(timing_table(&reports), Exit::Success)
    })
}

fn measure(args: &TimingArgs, rate_hz: f64) -> Result<Outcome, String> {
    let mut config = Config {
        tick: LoopSection {
            rate_hz,
            timer: args.timer,
            early_wake: early_wake(args),
        },
        guidance: GuidanceSection::Hold,
        built_in: Some(BuiltInSection::default()),
        ..Config::default()
    };
    // The loop is measured without watchers.
    config.telemetry.enabled = false;
    config.realtime.priority = args.priority;
    config.realtime.cpu = args.cpu;
    let assembly = assemble(&config).map_err(|error| error.to_string())?;
    let plan = Plan {
        pace: Pace::RealTime,
        length: Length::Whole(args.seconds),
    };
    let progress = Progress::start(rate_hz, args.seconds);
    let outcome = fly(
        assembly,
        &config.tick,
        plan,
        Vec::new(),
        &mut Process::new(&config),
    )
    .map_err(|error| error.to_string());
    progress.stop();
    outcome
}

fn early_wake(args: &TimingArgs) -> EarlyWakeSection {
    let usual = EarlyWakeSection::default();
    let max_us = args.max_margin.unwrap_or(usual.max_us);
    EarlyWakeSection {
        enabled: args.early_wake,
        min_us: usual.min_us.min(max_us),
        max_us,
        cpu_cap_percent: args.cpu_cap.unwrap_or(usual.cpu_cap_percent),
        ..usual
    }
}

/// A progress bar for a measurement; hidden if standard error is not a
/// terminal.
struct Progress {
    bar: ProgressBar,
    ticker: thread::JoinHandle<()>,
}

impl Progress {
    fn start(rate_hz: f64, seconds: f64) -> Self {
        let bar = ProgressBar::new((seconds * 1e3) as u64)
            .with_message(format!("{rate_hz} Hz"))
            .with_prefix(format!("{seconds} s"));
        if let Ok(style) = ProgressStyle::with_template("{msg:>8} {wide_bar} {elapsed} of {prefix}")
        {
            bar.set_style(style);
        }
        let moving = bar.clone();
        let began = Instant::now();
        let ticker = thread::spawn(move || {
            while !moving.is_finished() {
                moving.set_position(began.elapsed().as_millis() as u64);
                thread::sleep(Duration::from_millis(200));
            }
        });
        Self { bar, ticker }
    }

    fn stop(self) {
        self.bar.finish_and_clear();
        let _ = self.ticker.join();
    }
}
