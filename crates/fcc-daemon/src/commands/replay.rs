//! `fccd replay`: replays a recording.

use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::time::Instant;

use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{AirframeSection, Config};
use fcc_flight::replay::{recorded_config, replay as replay_of};
use fcc_record::{create_output, unless_left};
use fcc_replay::{Chain, Comparison, Csv, Deviation, Identity, Replay, Replayed};
use fcc_telemetry::Telemetry;
use serde::Serialize;

use super::failure::{Failure, not_opened};
use super::progress;
use super::replay_navigation::replay_navigation;
use crate::cli::ReplayArgs;
use crate::exit::Exit;
use crate::output;

/// Result of a replay.
#[derive(Serialize)]
pub(super) struct Outcome {
    /// The program that recorded.
    recorded_by: String,
    #[serde(flatten)]
    replayed: Replayed,
    /// Duration of the replay, s.
    took_s: f64,
    /// Recorded time over replay time.
    times_real_time: f64,
    #[serde(flatten)]
    comparison: Comparison,
    /// Other remarks.
    remarks: Vec<String>,
}

/// Replays a recording.
pub(super) fn replay(args: &ReplayArgs) -> Result<Exit, Failure> {
    if args.navigation {
        return replay_navigation(args);
    }
    let chain = Chain::open::<Autopilot>(&args.files).map_err(not_opened)?;
    let recorded =
        recorded_config(&chain).map_err(|error| Failure::of(Exit::NotReplayed, error))?;
    let other = args.config.as_deref().map(Config::load).transpose()?;
    let outcome = run(&chain, &recorded, other, args).map_err(Failure::new)?;
    Ok(outcome.print(args.json))
}

/// Replays with the recorded configuration or another, and compares.
fn run(
    chain: &Chain,
    recorded: &Config,
    other: Option<Config>,
    args: &ReplayArgs,
) -> Result<Outcome, String> {
    let mut remarks = remarks(chain);
    let mut comparison = Comparison::Identity(Identity::of::<Autopilot>());
    let mut config = recorded.clone();
    if let Some(other) = other {
        comparison = Comparison::Deviation(Deviation::of::<Autopilot>());
        config = other;
        let flies_plan = config.fly_plan_of(recorded).map_err(|problems| {
            let problems: Vec<_> = problems.iter().map(ToString::to_string).collect();
            format!(
                "the recorded plan cannot be flown by it: {}",
                problems.join("; ")
            )
        })?;
        if flies_plan {
            remarks.push("both fly the recorded plan".to_owned());
        }
        if config.tick.rate_hz != recorded.tick.rate_hz {
            remarks.push(format!(
                "replayed at the recorded {} Hz: the times of a recording cannot be changed",
                recorded.tick.rate_hz
            ));
            config.tick.rate_hz = recorded.tick.rate_hz;
        }
    }
    let mut replay = replay_of(&config).map_err(|error| format!("the loop's timer: {error}"))?;
    let began = Instant::now();
    let mut outcome = compare(chain, &mut replay, comparison, args, began)?;
    remarks.append(&mut outcome.remarks);
    if args.airframe {
        remarks.push(learned(replay.controller()));
    }
    Ok(Outcome { remarks, ..outcome })
}

/// Replays the recording of any vehicle, and compares.
pub(super) fn compare<C: Telemetry>(
    chain: &Chain,
    replay: &mut Replay<C>,
    mut comparison: Comparison,
    args: &ReplayArgs,
    began: Instant,
) -> Result<Outcome, String> {
    let csv = args.csv.as_deref();
    let inputs: Vec<&PathBuf> = args.files.iter().chain(&args.config).collect();
    let refused = |error: io::Error| {
        let name = csv.unwrap_or(Path::new("")).display();
        format!("{name}: cannot be written: {error}")
    };
    let begin = |path| Csv::begin::<C>(BufWriter::new(create_output(path, &inputs)?));
    let mut table = csv.map(begin).transpose().map_err(refused)?;
    let mut written = Ok(());
    let bar = progress::bar(chain.bytes(), "replaying");
    let replayed = chain.replay(
        replay,
        |recorded, again| {
            comparison.take(recorded, again);
            if let (Some(table), Ok(())) = (&mut table, &written) {
                written = table.take(recorded, again);
            }
        },
        |bytes| bar.set_position(bytes),
    );
    bar.finish_and_clear();
    let finished = written.and_then(|()| table.map_or(Ok(()), Csv::finish));
    unless_left(finished).map_err(refused)?;
    let took_s = began.elapsed().as_secs_f64();
    let about = chain.about();
    Ok(Outcome {
        recorded_by: format!("{} ({})", about.software, about.git_hash),
        times_real_time: replayed.run.span_s / took_s,
        replayed,
        took_s,
        comparison,
        remarks: csv
            .map(|csv| format!("written: {}", csv.display()))
            .into_iter()
            .collect(),
    })
}

/// What the flight has learned of the aircraft, as a section of a configuration.
fn learned(autopilot: &Autopilot) -> String {
    autopilot.learned_airframe().map_or_else(
        || {
            "nothing was learned of the aircraft: it takes a minute with an airspeed sensor \
             that is believed, and a throttle that is read back"
                .to_owned()
        },
        |learned| {
            let section = AirframeSection::from(learned).to_toml();
            format!("learned of the aircraft, for flights without an airspeed sensor:\n{section}")
        },
    )
}

fn remarks(chain: &Chain) -> Vec<String> {
    let own = format!("fccd {}", env!("CARGO_PKG_VERSION"));
    let by = &chain.about().software;
    let another = (*by != own).then(|| {
        format!("recorded by {by}, replayed by {own}: another version may compute different values")
    });
    another.into_iter().collect()
}

impl Outcome {
    pub(super) fn print(&self, json: bool) -> Exit {
        if json {
            output::json(self, self.exit())
        } else {
            output::result(self.to_text(), self.exit())
        }
    }

    fn exit(&self) -> Exit {
        match &self.comparison {
            // What is not in the file, as a command, may be the difference.
            Comparison::Identity(identity)
                if !identity.is_identical() && self.replayed.cuts.is_empty() =>
            {
                Exit::Differs
            }
            _ if !self.replayed.is_complete() => Exit::NotReplayed,
            Comparison::Deviation(deviation) if deviation.is_of_nothing() => Exit::NotReplayed,
            // All ticks are there.
            _ if !self.replayed.damages.is_empty() => Exit::Incomplete,
            _ => Exit::Success,
        }
    }

    fn to_text(&self) -> String {
        let run = &self.replayed.run;
        let mut text = format!(
            "{} ticks, {:.1} s of flight, replayed in {:.2} s: {:.0} times real time\n{}{}",
            run.ticks,
            run.span_s,
            self.took_s,
            self.times_real_time,
            self.comparison.to_text(),
            self.replayed.missing()
        );
        for remark in &self.remarks {
            text.push_str("\n\n");
            text.push_str(remark);
        }
        text
    }
}
