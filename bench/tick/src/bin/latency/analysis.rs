//! Figures from the times at both ends.

use std::error::Error;
use std::fmt::Write as _;

use fcc_core::framework::{State, StateCode};
use serde_json::{Value, json};

use crate::daemon::LoopRecord;
use crate::wire::Times;

/// Surfaces and throttle: datagrams of a tick without overrides.
const WRITES_PER_TICK: usize = 4;
/// Ticks after engaging that are omitted: the first of them sets overrides.
const SKIPPED_TICKS: usize = 80;

/// One figure of every tick, µs.
struct Figure {
    name: &'static str,
    us: Vec<f64>,
}

/// All figures.
pub(crate) struct Report {
    figures: Vec<Figure>,
    ticks: usize,
}

/// The figures of the ticks that steered.
pub(crate) fn report(
    records: &[LoopRecord],
    times: &Times,
    rate_hz: u32,
) -> Result<Report, Box<dyn Error>> {
    let engaged = StateCode::from(State::Engaged);
    let steered: Vec<&LoopRecord> = records
        .iter()
        .filter(|record| record.sent && record.state == engaged)
        .skip(SKIPPED_TICKS)
        .collect();
    if steered.is_empty() {
        return Err("the autopilot never engaged: is the machine too slow, or the switch?".into());
    }
    let stage = |name, of: fn(&LoopRecord) -> u64| Figure {
        name,
        us: steered
            .iter()
            .map(|record| of(record) as f64 / 1e3)
            .collect(),
    };
    let mut figures = vec![
        stage("sensors", |record| record.stages.sensors_ns),
        stage("estimate", |record| record.stages.estimate_ns),
        stage("guide", |record| record.stages.guide_ns),
        stage("control", |record| record.stages.control_ns),
        stage("actuators", |record| record.stages.actuators_ns),
        stage("whole tick, from the wake-up", |record| {
            record.stages.total_ns
        }),
    ];
    let mut first = Vec::new();
    let mut last = Vec::new();
    let mut age = Vec::new();
    let period_ns = 1_000_000_000 / i64::from(rate_hz);
    for record in &steered {
        let woke_ns = record.tick.woke.as_nanos();
        let from = times.writes_ns.partition_point(|&at| at < woke_ns);
        let to = times
            .writes_ns
            .partition_point(|&at| at < woke_ns + period_ns);
        let writes = times.writes_ns.get(from..to).unwrap_or_default();
        let newest = times.frames_ns.partition_point(|&at| at < woke_ns);
        let frame = newest.checked_sub(1).and_then(|at| times.frames_ns.get(at));
        // A tick that repeats its overrides sends more, and is omitted.
        if let ([begin, .., end], Some(frame)) = (writes, frame)
            && writes.len() == WRITES_PER_TICK
        {
            first.push((begin - woke_ns) as f64 / 1e3);
            last.push((end - woke_ns) as f64 / 1e3);
            age.push((end - frame) as f64 / 1e3);
        }
    }
    if first.is_empty() {
        return Err("no write of the daemon arrived".into());
    }
    figures.extend([
        Figure {
            name: "wake-up to our first datagram",
            us: first,
        },
        Figure {
            name: "wake-up to our last datagram",
            us: last,
        },
        Figure {
            name: "the simulator's newest datagram to our last",
            us: age,
        },
    ]);
    for figure in &mut figures {
        figure.us.sort_by(f64::total_cmp);
    }
    Ok(Report {
        figures,
        ticks: steered.len(),
    })
}

impl Figure {
    /// The value that this share does not exceed: nearest rank.
    fn at(&self, share: f64) -> f64 {
        let rank = (share * self.us.len() as f64).ceil() as usize;
        self.us.get(rank.max(1) - 1).copied().unwrap_or(0.0)
    }
}

impl Report {
    pub(crate) fn markdown(&self) -> String {
        let mut text = format!(
            "| µs, of {} ticks | least | median | p99 | largest |\n|---|---:|---:|---:|---:|\n",
            self.ticks
        );
        for figure in &self.figures {
            let [least, p50, p99, max] = [0.0, 0.5, 0.99, 1.0].map(|share| figure.at(share));
            let name = figure.name;
            let _ = writeln!(
                text,
                "| {name} | {least:.1} | {p50:.1} | {p99:.1} | {max:.1} |"
            );
        }
        text
    }

    pub(crate) fn json(&self) -> Value {
        let figures = self.figures.iter().map(|figure| {
            json!({
                "name": figure.name,
                "least_us": figure.at(0.0),
                "p50_us": figure.at(0.5),
                "p99_us": figure.at(0.99),
                "max_us": figure.at(1.0),
            })
        });
        json!({ "ticks": self.ticks, "figures": figures.collect::<Vec<_>>() })
    }
}
