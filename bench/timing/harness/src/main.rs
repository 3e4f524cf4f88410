//! Runs our clocks and their peers in turn, under the same conditions, and
//! compares the times of their ticks. `docs/results/timing.md` describes the
//! method.

mod load;
mod machine;
mod markdown;
mod measure;
mod peer;
mod plot;
mod results;
mod stats;

use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use load::Load;
use measure::{WARM_UP_S, is_granted, measure};
use peer::{Conditions, Peer};
use results::{Results, Run};

/// Compares our clocks with their peers
#[derive(Parser)]
struct Cli {
    /// How long each run is measured, after a second of warm-up
    #[arg(long, default_value_t = 5.0)]
    seconds: f64,
    /// Number of rounds, in turn
    #[arg(long, default_value_t = 3)]
    rounds: u32,
    /// Ticks per second
    #[arg(long, value_delimiter = ',', default_values_t = [40, 100, 1_000])]
    rates: Vec<u32>,
    /// Load of the machine
    #[arg(long, value_delimiter = ',', value_enum, default_values_t = [Load::Idle, Load::Stress])]
    loads: Vec<Load>,
    /// Clocks and peers to compare [default: all]
    #[arg(long, value_delimiter = ',', value_enum)]
    peers: Vec<Peer>,
    /// CPU that all of them run on [default: an isolated one, or one with few
    /// interrupts of devices]
    #[arg(long)]
    cpu: Option<usize>,
    /// Their priority under `SCHED_FIFO`
    #[arg(long, default_value_t = 80, value_parser = clap::value_parser!(u8).range(1..=99))]
    priority: u8,
    /// Writes every run's figures here
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Writes the tables here, as Markdown
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// Draws the plot here, as SVG
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Reads the figures of an earlier run from here instead of measuring
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
}

fn main() -> anyhow::Result<()> {
    let cli = Cli::parse();
    let results = match &cli.from {
        Some(file) => {
            let text = fs::read_to_string(file)
                .with_context(|| format!("{} cannot be read", file.display()))?;
            serde_json::from_str(&text)
                .with_context(|| format!("{} is not of this benchmark", file.display()))?
        }
        None => run(&cli)?,
    };
    let text = markdown::tables(&results);
    println!("{text}");
    let write = |file: &PathBuf, text: String| {
        fs::write(file, text).with_context(|| format!("{} cannot be written", file.display()))
    };
    if let Some(file) = &cli.json {
        write(file, serde_json::to_string_pretty(&results)?)?;
    }
    if let Some(file) = &cli.markdown {
        write(file, text)?;
    }
    if let Some(file) = &cli.plot {
        write(file, plot::svg(&results)?)?;
    }
    Ok(())
}

fn run(cli: &Cli) -> anyhow::Result<Results> {
    let peers = if cli.peers.is_empty() {
        Peer::value_variants()
    } else {
        &cli.peers
    };
    let (cpu, because) = match cli.cpu {
        Some(cpu) => (cpu, "as requested".to_owned()),
        None => machine::quiet_cpu()?,
    };
    eprintln!("on CPU {cpu}: {because}");
    let priority = is_granted(cli.priority).then_some(cli.priority);
    if priority.is_none() {
        eprintln!(
            "SCHED_FIFO {0} is not granted, so none gets it: run as root, or with `ulimit -r {0}`",
            cli.priority
        );
    }
    let runs = cli.rounds as usize * cli.loads.len() * cli.rates.len() * peers.len();
    let minutes = runs as f64 * (cli.seconds + WARM_UP_S) / 60.0;
    eprintln!("{runs} runs, {minutes:.0} minutes");

    let bar = ProgressBar::new(runs as u64).with_style(
        ProgressStyle::with_template("{bar:30} {pos}/{len} {eta} left  {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    let mut results = Results {
        machine: format!("{}; on CPU {cpu}: {because}", machine::describe()),
        seconds: cli.seconds,
        rounds: cli.rounds,
        runs: Vec::with_capacity(runs),
    };
    for round in 0..cli.rounds {
        for &load in &cli.loads {
            let _stress = load.begin()?;
            for &rate_hz in &cli.rates {
                for (place, _) in peers.iter().enumerate() {
                    // Each round begins with another one, so that none always
                    // follows the same one.
                    let peer = peers[(place + round as usize) % peers.len()];
                    bar.set_message(format!("{} {rate_hz} Hz {}", peer.name(), load.name()));
                    let conditions = Conditions {
                        rate_hz,
                        seconds: cli.seconds,
                        priority,
                        cpu,
                    };
                    let measured = measure(peer, conditions)?;
                    results.runs.push(Run {
                        round: round + 1,
                        load,
                        rate_hz,
                        peer,
                        scheduling: measured.scheduling,
                        figures: measured.figures,
                    });
                    bar.inc(1);
                }
            }
        }
    }
    bar.finish_and_clear();
    results.runs.sort_by_key(|run| {
        let place = |of: Option<usize>| of.unwrap_or(usize::MAX);
        (
            place(cli.loads.iter().position(|&load| load == run.load)),
            place(cli.rates.iter().position(|&rate| rate == run.rate_hz)),
            place(peers.iter().position(|&peer| peer == run.peer)),
            run.round,
        )
    });
    Ok(results)
}
