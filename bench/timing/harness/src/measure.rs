//! One run of one peer.

use std::process::{Command, Output, Stdio};
use std::time::Instant;

use anyhow::{Context as _, bail, ensure};
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike as _;
use ticklog::Ticks;

use crate::peer::{Conditions, Peer};
use crate::stats::Figures;

/// Earlier ticks are not counted: caches and branch predictors are cold, and an
/// early wake has not measured enough.
pub(crate) const WARM_UP_S: f64 = 1.0;

/// The result of a run, and its scheduling.
pub(crate) struct Measured {
    pub(crate) figures: Figures,
    pub(crate) scheduling: String,
}

/// Runs a peer under these conditions, after a warm-up.
pub(crate) fn measure(peer: Peer, under: Conditions) -> anyhow::Result<Measured> {
    let whole = Conditions {
        seconds: under.seconds + WARM_UP_S,
        ..under
    };
    let ticks = if peer == Peer::Cyclictest {
        run_cyclictest(whole)?
    } else {
        let output = output(peer.command(whole)?)?;
        serde_json::from_slice(&output.stdout)
            .with_context(|| format!("{} did not print its ticks", peer.name()))?
    };
    let period_ns = 1_000_000_000 / i64::from(under.rate_hz);
    let (Some(first), Some(last)) = (ticks.ticks_ns.first(), ticks.ticks_ns.last()) else {
        bail!("{} never ticked", peer.name());
    };
    let from = first + (WARM_UP_S * 1e9) as i64;
    let counted: Vec<i64> = ticks
        .ticks_ns
        .iter()
        .copied()
        .filter(|&tick| tick >= from)
        .collect();
    let mut figures = Figures::of(&counted, period_ns, ticks.origin_ns)
        .with_context(|| format!("{} hardly ticked: let it run for longer", peer.name()))?;
    figures.cpu_percent = 100.0 * ticks.cpu_ns as f64 / (last - first) as f64;
    Ok(Measured {
        figures,
        scheduling: format!("{} {}", ticks.policy, ticks.priority),
    })
}

/// It prints the lateness of each tick, and no times; its CPU time is that of
/// the whole process, known after it has ended.
fn run_cyclictest(under: Conditions) -> anyhow::Result<Ticks> {
    let before_ns = children_cpu_ns()?;
    let output = output(Peer::Cyclictest.command(under)?)?;
    let cpu_ns = children_cpu_ns()? - before_ns;
    let text = String::from_utf8(output.stdout).context("cyclictest printed no text")?;
    let period_ns = 1_000_000_000 / i64::from(under.rate_hz);
    let ticks_ns = times_of(text.lines().filter_map(latency), period_ns);
    let (policy, priority) = under.priority.map_or(("SCHED_OTHER", 0), |priority| {
        ("SCHED_FIFO", i32::from(priority))
    });
    Ok(Ticks {
        policy: policy.to_owned(),
        priority,
        origin_ns: Some(0),
        cpu_ns,
        ticks_ns,
    })
}

/// The times of ticks from their lateness, ns. If a tick is later than further
/// deadlines, cyclictest skips these, and counts one.
fn times_of(latencies: impl Iterator<Item = (i64, i64)>, period_ns: i64) -> Vec<i64> {
    let mut skipped = 0;
    latencies
        .map(|(number, late_ns)| {
            let tick_ns = (number + skipped) * period_ns + late_ns;
            skipped += late_ns / period_ns;
            tick_ns
        })
        .collect()
}

/// Number and lateness of a line such as `0: 17: 14091`; no other line has
/// three numbers.
fn latency(line: &str) -> Option<(i64, i64)> {
    let mut numbers = line
        .split(':')
        .map(|number| number.trim().parse::<i64>().ok());
    let found = (numbers.next()??, numbers.next()??, numbers.next()??);
    numbers.next().is_none().then_some((found.1, found.2))
}

/// CPU time of all ended child processes.
fn children_cpu_ns() -> anyhow::Result<i64> {
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN)?;
    Ok(usage.user_time().num_nanoseconds() + usage.system_time().num_nanoseconds())
}

fn output(mut command: Command) -> anyhow::Result<Output> {
    let program = command.get_program().to_string_lossy().into_owned();
    let began = Instant::now();
    let output = command
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("{program} does not start: is it installed?"))?;
    ensure!(
        output.status.success(),
        "{program} failed after {:.1} s ({}): {}",
        began.elapsed().as_secs_f64(),
        output.status,
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(output)
}

/// Whether `SCHED_FIFO` with this priority is granted here.
pub(crate) fn is_granted(priority: u8) -> bool {
    Command::new("chrt")
        .args(["--fifo", &priority.to_string(), "true"])
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cyclictests_lines_are_read_as_it_prints_them() {
        assert_eq!(latency("       0:       3:   14362"), Some((3, 14_362)));
        assert_eq!(latency("# /dev/cpu_dma_latency set to 0us"), None);
        assert_eq!(latency("Thread 0 Interval: 10500"), None);
        let summary = "T: 0 ( 2699) P:80 I:10000 C: 5 Min: 13991 Act: 14207";
        assert_eq!(latency(summary), None);
    }

    #[test]
    fn what_cyclictest_skips_moves_the_ticks_after_it() {
        // Due at 0, 10, 20 and then, 32 ms late, after 30, 40 and 50, at 60.
        let latencies = [(0, 1), (1, 2), (2, 32), (3, 1)];
        let times = times_of(latencies.into_iter(), 10);
        assert_eq!(times, [1, 12, 52, 61]);
    }
}
