//! `fccd replay`: a recording flown again.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::time::Instant;

use fcc_telemetry::{FlightMessage, FlightRecord};
use indicatif::ProgressBar;
use serde::Serialize;

use super::{fail, progress};
use crate::cli::ReplayArgs;
use crate::exit::Exit;
use crate::output;
use fcc_flight::config::Config;
use fcc_flight::replay::{Chain, ChainMessages, Csv, Deviation, Identity, Replay, Run, run};

/// What came of it.
#[derive(Serialize)]
struct Flown {
    /// Which program recorded.
    recorded_by: String,
    #[serde(flatten)]
    run: Run,
    /// Where files ended before their recording did.
    cuts: Vec<String>,
    /// What in the files is damaged.
    damages: Vec<String>,
    /// How long it took, s.
    took_s: f64,
    /// The recorded time over that.
    times_real_time: f64,
    #[serde(flatten)]
    found: Found,
    /// What else there is to know.
    remarks: Vec<String>,
}

#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum Found {
    /// Against what was recorded, with the recorded configuration.
    Identity(Identity),
    /// Against what was recorded, with another configuration.
    Deviation(Deviation),
}

/// Flies a recording again.
pub(super) fn replay(args: &ReplayArgs) -> Exit {
    let chain = match Chain::open(&args.files) {
        Ok(chain) => chain,
        Err(error) => {
            fail(&error.to_string());
            return Exit::NotReplayed;
        }
    };
    let flown = match &args.config {
        None => compare(&chain),
        Some(path) => match Config::load(path) {
            Ok(other) => deviate(&chain, other, args.csv.as_deref()),
            Err(error) => {
                output::message(error);
                return Exit::Usage;
            }
        },
    };
    match flown {
        Ok(flown) => flown.print(args.json),
        Err(message) => fail(&message),
    }
}

/// Compares every output with the recorded one.
fn compare(chain: &Chain) -> Result<Flown, String> {
    let mut identity = Identity::default();
    let mut flown = fly(chain, chain.config(), |recorded, again| {
        identity.take(recorded, again);
    })?;
    flown.found = Found::Identity(identity);
    Ok(flown)
}

/// Compares another configuration with what was recorded.
fn deviate(chain: &Chain, mut other: Config, csv: Option<&Path>) -> Result<Flown, String> {
    let mut remarks = Vec::new();
    if other.tick.rate_hz != chain.config().tick.rate_hz {
        remarks.push(format!(
            "flown at the recorded {} Hz: the times of a recording cannot be changed",
            chain.config().tick.rate_hz
        ));
        other.tick.rate_hz = chain.config().tick.rate_hz;
    }
    let refused = |error: io::Error| {
        let name = csv.unwrap_or(Path::new("")).display();
        format!("{name}: cannot be written: {error}")
    };
    let begun = csv.map(|path| Csv::begin(BufWriter::new(File::create(path)?)));
    let mut lines = begun.transpose().map_err(refused)?;
    let mut deviation = Deviation::default();
    let mut written = Ok(());
    let mut flown = fly(chain, &other, |recorded, again| {
        deviation.take(recorded, again);
        if let (Some(lines), Ok(())) = (&mut lines, &written) {
            written = lines.take(recorded, again);
        }
    })?;
    let finished = written.and_then(|()| lines.map_or(Ok(()), Csv::finish));
    finished.map_err(refused)?;
    flown.found = Found::Deviation(deviation);
    flown.remarks.append(&mut remarks);
    Ok(flown)
}

/// Runs a recording through a loop as `config` says.
fn fly(
    chain: &Chain,
    config: &Config,
    compare: impl FnMut(&FlightRecord, &FlightRecord),
) -> Result<Flown, String> {
    let replay = Replay::new(config).map_err(|error| format!("the loop's timer: {error}"))?;
    let began = Instant::now();
    let mut watched = Watched::new(chain);
    let run = run(replay, &mut watched, compare);
    let messages = watched.finish();
    let took_s = began.elapsed().as_secs_f64();
    let about = chain.about().cloned().unwrap_or_default();
    let own = format!("fccd {}", env!("CARGO_PKG_VERSION"));
    let mut remarks = Vec::new();
    if about.software != own {
        remarks.push(format!(
            "recorded by {}, flown again by {own}: another version may compute otherwise",
            about.software
        ));
    }
    Ok(Flown {
        recorded_by: format!("{} ({})", about.software, about.git_hash),
        times_real_time: run.span_s / took_s,
        run,
        cuts: messages.cuts().to_vec(),
        damages: messages.damages().to_vec(),
        took_s,
        found: Found::Identity(Identity::default()),
        remarks,
    })
}

impl Flown {
    fn print(&self, json: bool) -> Exit {
        if json {
            output::json(self, self.exit())
        } else {
            output::result(self.to_text(), self.exit())
        }
    }

    fn exit(&self) -> Exit {
        match &self.found {
            Found::Identity(identity) if !identity.is_identical() => Exit::Differs,
            _ if self.run.unflown.is_some() || !self.cuts.is_empty() => Exit::NotReplayed,
            // All ticks are there.
            _ if !self.damages.is_empty() => Exit::Incomplete,
            _ => Exit::Success,
        }
    }

    fn to_text(&self) -> String {
        let mut lines = vec![
            format!(
                "{} ticks, {:.1} s of flight, flown again in {:.2} s: {:.0} times real time",
                self.run.ticks, self.run.span_s, self.took_s, self.times_real_time
            ),
            match &self.found {
                Found::Identity(identity) => identity.to_text(),
                Found::Deviation(deviation) => format!("\n{}", deviation.to_text()),
            },
        ];
        if let Some(unflown) = &self.run.unflown {
            let which = match (unflown.first, unflown.last) {
                (Some(first), Some(last)) => format!("{} ticks, {first} to {last}", unflown.ticks),
                _ => "what follows".to_owned(),
            };
            let compared = self.run.last_tick.map_or_else(
                || "nothing was compared".to_owned(),
                |last| format!("compared up to tick {last}"),
            );
            lines.push(format!(
                "\nNOT flown again: {which}: {}; {compared}",
                unflown.why
            ));
        }
        for cut in &self.cuts {
            lines.push(format!("\nthe recording is not whole: {cut}"));
        }
        for damage in &self.damages {
            lines.push(format!("\nthe recording is not whole: {damage}"));
        }
        for remark in &self.remarks {
            lines.push(format!("\n{remark}"));
        }
        lines.join("\n")
    }
}

/// The messages of a recording, and a bar that fills while they are read;
/// nothing where standard error is no terminal.
struct Watched<'a> {
    messages: ChainMessages<'a>,
    bar: ProgressBar,
    read: u64,
}

/// Messages between two looks at the bar.
const LOOK_EVERY: u64 = 4_096;

impl<'a> Watched<'a> {
    fn new(chain: &'a Chain) -> Self {
        Self {
            messages: chain.messages(),
            bar: progress::bar(chain.bytes(), "flying again"),
            read: 0,
        }
    }

    /// Takes the bar away; gives what was read.
    fn finish(self) -> ChainMessages<'a> {
        self.bar.finish_and_clear();
        self.messages
    }
}

impl Iterator for Watched<'_> {
    type Item = FlightMessage;

    fn next(&mut self) -> Option<FlightMessage> {
        self.read += 1;
        if self.read.is_multiple_of(LOOK_EVERY) {
            self.bar.set_position(self.messages.bytes_read());
        }
        self.messages.next()
    }
}
