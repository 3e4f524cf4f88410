//! The CPUs: how fast they run, how deep they sleep, and what they share.

use std::collections::{BTreeMap, BTreeSet};

use fcc_timer::realtime::cpus::Cpus;

use super::board::{Board, not_told};
use super::machine::Machine;
use super::{Finding, Grade};

const FOLDER: &str = "sys/devices/system/cpu";
/// Waking from a state takes this long at most, or it shows: half of what a
/// wake-up takes anyhow.
const SLOW_TO_WAKE_US: u64 = 20;

/// Whether the CPUs keep their speed.
pub(super) fn governor(machine: &Machine, _: &Board) -> Finding {
    const ID: &str = "governor";
    const NAME: &str = "CPU speed";
    let mut cpus_of: BTreeMap<String, usize> = BTreeMap::new();
    for cpu in machine.entries(FOLDER, "cpu") {
        if let Some(governor) = machine.text(&format!("{cpu}/cpufreq/scaling_governor")) {
            *cpus_of.entry(governor).or_default() += 1;
        }
    }
    if cpus_of.is_empty() {
        return not_told(ID, NAME, "nothing here changes it");
    }
    let words: Vec<String> = cpus_of
        .iter()
        .map(|(governor, count)| format!("{governor} on {count}"))
        .collect();
    let found = words.join(", ");
    if cpus_of.keys().all(|governor| governor == "performance") {
        return Finding::new(ID, NAME, Grade::Ok, found);
    }
    Finding::new(ID, NAME, Grade::CouldBeBetter, found)
        .because("a loop that sleeps most of the time finds its CPU slowed down")
        .remedy(
            "/etc/tmpfiles.d/fccd.conf",
            "w /sys/devices/system/cpu/cpufreq/policy*/scaling_governor - - - - performance",
        )
}

/// Whether a CPU is kept for the loop.
pub(super) fn isolation(machine: &Machine, board: &Board) -> Finding {
    const ID: &str = "isolated_cpus";
    const NAME: &str = "Isolated CPUs";
    let cpus = Cpus::read(machine.root());
    if !cpus.isolated.is_empty() {
        let mut finding = Finding::new(ID, NAME, Grade::Ok, list(&cpus.isolated));
        if cpus.tickless.is_disjoint(&cpus.isolated) {
            finding.found.push_str(", with the kernel's tick");
        }
        return finding.remedy("fccd's configuration, [realtime]", "cpu = \"auto\"");
    }
    match cpus.online.last() {
        None => not_told(ID, NAME, "the kernel does not say"),
        Some(0) => Finding::new(ID, NAME, Grade::Ok, "none: there is one CPU only"),
        Some(last) => board.kernel_option(
            Finding::new(
                ID,
                NAME,
                Grade::CouldBeBetter,
                format!("none of {}", cpus.online.len()),
            )
            .because("other programs run where the loop is to run"),
            &isolating(*last),
        ),
    }
}

/// What keeps threads, the kernel's own work and interrupts off the last CPU;
/// the first one has to keep the time.
fn isolating(last: usize) -> String {
    let others = match last {
        1 => "0".to_owned(),
        _ => format!("0-{}", last.saturating_sub(1)),
    };
    format!(
        "isolcpus=managed_irq,domain,{last} nohz_full={last} rcu_nocbs={last} irqaffinity={others}"
    )
}

/// How deep the CPUs sleep.
pub(super) fn idle_states(machine: &Machine, _: &Board) -> Finding {
    const ID: &str = "idle_states";
    const NAME: &str = "CPU sleep";
    let deepest = machine
        .entries(&format!("{FOLDER}/cpu0/cpuidle"), "state")
        .iter()
        .filter(|state| machine.number(&format!("{state}/disable")) != Some(1))
        .filter_map(|state| {
            let latency_us: u64 = machine.number(&format!("{state}/latency"))?;
            let name = machine.text(&format!("{state}/name")).unwrap_or_default();
            Some((latency_us, name))
        })
        .max();
    match deepest {
        None => Finding::new(ID, NAME, Grade::Ok, "no deep states"),
        Some((latency_us, name)) if latency_us <= SLOW_TO_WAKE_US => Finding::new(
            ID,
            NAME,
            Grade::Ok,
            format!("{name}, {latency_us} µs to wake"),
        ),
        Some((latency_us, name)) => {
            let finding = Finding::new(
                ID,
                NAME,
                Grade::CouldBeBetter,
                format!("{name}, {latency_us} µs to wake"),
            )
            .because("a CPU that sleeps deeply wakes late; not to let it costs power")
            .remedy("fccd's configuration, [realtime]", "cpu_dma_latency_us = 0");
            if machine.exists("dev/cpu_dma_latency") {
                finding.remedy(
                    "/etc/udev/rules.d/99-fccd.rules",
                    "KERNEL==\"cpu_dma_latency\", GROUP=\"fccd\", MODE=\"0660\"",
                )
            } else {
                finding
            }
        }
    }
}

/// Whether two CPUs share a core.
pub(super) fn hyper_threads(machine: &Machine, board: &Board) -> Finding {
    const ID: &str = "hyper_threads";
    const NAME: &str = "Shared cores";
    match machine.text(&format!("{FOLDER}/smt/active")).as_deref() {
        Some("1") => board.kernel_option(
            Finding::new(ID, NAME, Grade::CouldBeBetter, "two CPUs to a core")
                .because("what the other one does makes ticks longer by up to half"),
            "nosmt",
        ),
        Some("0") | None => Finding::new(ID, NAME, Grade::Ok, "none"),
        Some(other) => not_told(ID, NAME, other),
    }
}

fn list(cpus: &BTreeSet<usize>) -> String {
    let numbers: Vec<String> = cpus.iter().map(ToString::to_string).collect();
    format!("CPU {}", numbers.join(", "))
}
