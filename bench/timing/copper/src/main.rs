//! The loop of copper: its generated runtime at a rate target, with one task
//! that logs its times, and its own logging off.
//!
//! The runtime that a macro generates needs the task's type, so the log is
//! passed to it in a static.

use std::sync::Mutex;

use clap::Parser;
use cu29::prelude::*;
use ticklog::{Run, TickLog};

/// A generated program has no other way to receive it.
static LOG: Mutex<Option<TickLog>> = Mutex::new(None);

#[derive(Reflect)]
struct Clock {
    #[reflect(ignore)]
    log: Option<TickLog>,
}

impl Freezable for Clock {}

impl CuSrcTask for Clock {
    type Resources<'r> = ();
    type Output<'m> = output_msg!(u32);

    fn new(_: Option<&ComponentConfig>, _: Self::Resources<'_>) -> CuResult<Self> {
        let log = LOG.lock().map_or(None, |mut log| log.take());
        Ok(Self { log })
    }

    fn process(&mut self, _: &CuContext, output: &mut Self::Output<'_>) -> CuResult<()> {
        let go_on = self.log.as_mut().is_some_and(TickLog::tick);
        output.set_payload(0);
        if go_on {
            return Ok(());
        }
        // The runtime continues after a task's error, and cannot be ended from
        // within.
        let printed = self.log.take().map(TickLog::print);
        std::process::exit(i32::from(!matches!(printed, Some(Ok(())))))
    }
}

#[copper_runtime(config = "loop.ron")]
struct App {}

#[derive(Parser)]
#[command(about = "A periodic loop in copper's runtime that logs when it ticked")]
struct Cli {
    #[command(flatten)]
    run: Run,
}

fn main() -> anyhow::Result<()> {
    let run = Cli::parse().run;
    let text = include_str!("../loop.ron");
    let mut config = CuConfig::deserialize_ron(text).map_err(|error| anyhow::anyhow!("{error}"))?;
    config.runtime = Some(RuntimeConfig {
        rate_target_hz: Some(u64::from(run.rate)),
        ..RuntimeConfig::default()
    });
    *LOG.lock().map_err(|_| anyhow::anyhow!("poisoned"))? = Some(TickLog::new(run)?);
    let app = App::builder()
        .with_config(config)
        .build()
        .map_err(|error| anyhow::anyhow!("{error}"))?;
    // The task ends the process.
    let _ = app.run_until_shutdown();
    anyhow::bail!("the loop ended before its run")
}
