//! The tables: figures, comparison with the goals, and every round.

use std::fmt::Write as _;

use crate::peer::Peer;
use crate::results::{Case, Results};

/// Goals for our lateness at p99, µs, and as a share of the best peer's.
const ASKED_P99_US: f64 = 1.0;
const ASKED_SHARE: f64 = 0.1;
/// Goal for the CPU time of spinning, % of a core, and up to which rate it
/// applies.
const ASKED_CPU_PERCENT: f64 = 1.0;
const ASKED_CPU_AT_HZ: u32 = 40;

/// All tables as Markdown.
pub(crate) fn tables(results: &Results) -> String {
    let cases = results.cases();
    [
        about(results),
        figures(&cases),
        asked(&cases),
        rounds(&cases),
    ]
    .join("\n")
}

fn about(results: &Results) -> String {
    let mut scheduling: Vec<&str> = results
        .runs
        .iter()
        .map(|run| run.scheduling.as_str())
        .collect();
    scheduling.sort_unstable();
    scheduling.dedup();
    format!(
        "{}. {}; {} rounds of {} s each, in turn; medians over the rounds.\n",
        results.machine,
        scheduling.join(", "),
        results.rounds,
        results.seconds
    )
}

fn figures(cases: &[Case<'_>]) -> String {
    let mut text = String::from(
        "| load | Hz | clock | late p50 µs | p99 | p99.9 | max | p99 without drift \
         | drift µs/s | period error p99 µs | within ±2 % | missed | CPU % |\n\
         |---|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for case in cases {
        let late = case.spread(|figures| figures.lateness_us);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.2} % | {} | {:.2} |",
            case.load.name(),
            case.rate_hz,
            case.peer.name(),
            us(late.p50),
            us(late.p99),
            us(late.p99_9),
            us(late.max),
            us(case.median(|figures| figures.undrifted_us.p99)),
            us(case.median(|figures| figures.drift_us_per_s)),
            us(case.median(|figures| figures.period_error_us.p99)),
            case.median(|figures| figures.kept_percent),
            case.median(|figures| figures.missed as f64),
            case.median(|figures| figures.cpu_percent),
        );
    }
    text
}

/// Our clocks that spin compared with the goals and the best peer of each case.
fn asked(cases: &[Case<'_>]) -> String {
    let mut text = String::from(
        "| load | Hz | clock | late p99 µs | asked ≤ 1 | best peer | its p99 without drift µs | asked ≤ 1/10 \
         | drift µs/s | CPU % |\n|---|---:|---|---:|---|---|---:|---|---:|---:|\n",
    );
    let p99 = |case: &Case<'_>| case.median(|figures| figures.lateness_us.p99);
    // A peer's drift has its own column, and does not count here.
    let kind_p99 = |case: &Case<'_>| {
        case.median(|figures| figures.lateness_us.p99.min(figures.undrifted_us.p99))
    };
    for ours in cases.iter().filter(|case| case.peer.spins()) {
        let best = cases
            .iter()
            .filter(|case| (case.load, case.rate_hz) == (ours.load, ours.rate_hz))
            .filter(|case| !case.peer.is_ours())
            .min_by(|a, b| kind_p99(a).total_cmp(&kind_p99(b)));
        let (name, theirs) = best.map_or(("none", f64::NAN), |best| {
            (best.peer.name(), kind_p99(best))
        });
        let cpu_percent = ours.median(|figures| figures.cpu_percent);
        let cpu_kept = if ours.rate_hz <= ASKED_CPU_AT_HZ {
            verdict(cpu_percent <= ASKED_CPU_PERCENT)
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {name} | {} | {} | {} | {cpu_percent:.2} {cpu_kept} |",
            ours.load.name(),
            ours.rate_hz,
            ours.peer.name(),
            us(p99(ours)),
            verdict(p99(ours) <= ASKED_P99_US),
            us(theirs),
            verdict(p99(ours) <= ASKED_SHARE * theirs),
            us(ours.median(|figures| figures.drift_us_per_s)),
        );
    }
    text
}

const fn verdict(kept: bool) -> &'static str {
    if kept { "yes" } else { "**no**" }
}

/// p99 and largest lateness of every round, which a median hides.
fn rounds(cases: &[Case<'_>]) -> String {
    let mut text = String::from(
        "| load | Hz | clock | p99 µs of each round | largest µs of each round |\n\
         |---|---:|---|---|---|\n",
    );
    for case in cases {
        let each = |figure: &dyn Fn(&crate::results::Run) -> f64| {
            let words: Vec<String> = case.runs.iter().map(|run| us(figure(run))).collect();
            words.join(", ")
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            case.load.name(),
            case.rate_hz,
            Peer::name(case.peer),
            each(&|run| run.figures.lateness_us.p99),
            each(&|run| run.figures.lateness_us.max),
        );
    }
    text
}

/// Three significant digits.
fn us(us: f64) -> String {
    match us.abs() {
        small if small < 0.0005 => "0".to_owned(),
        small if small < 10.0 => format!("{us:.3}"),
        middle if middle < 100.0 => format!("{us:.1}"),
        _ => format!("{us:.0}"),
    }
}
