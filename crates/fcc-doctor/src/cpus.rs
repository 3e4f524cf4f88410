//! The CPUs: speed, sleep states and shared cores.

use std::collections::{BTreeMap, BTreeSet};

use super::board::Board;
use super::loop_cpu::LoopCpu;
use super::machine::Machine;
use super::{CONFIGURATION, Check, Finding};

const FOLDER: &str = "sys/devices/system/cpu";
/// Longest wake-up from a sleep state that is acceptable, µs: half of what a
/// wake-up takes anyway.
const SLOW_TO_WAKE_US: u64 = 20;

/// Whether the CPUs run at constant speed.
pub(super) fn governor(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("governor", "CPU speed");
    let mut cpus_of: BTreeMap<String, usize> = BTreeMap::new();
    for cpu in machine.entries(FOLDER, "cpu") {
        if let Some(governor) = machine.text(&format!("{cpu}/cpufreq/scaling_governor")) {
            *cpus_of.entry(governor).or_default() += 1;
        }
    }
    if cpus_of.is_empty() {
        return CHECK.ok("the kernel does not change it");
    }
    let words: Vec<String> = cpus_of
        .iter()
        .map(|(governor, count)| format!("{governor} on {count}"))
        .collect();
    let found = words.join(", ");
    if cpus_of.keys().all(|governor| governor == "performance") {
        return CHECK.ok(found);
    }
    CHECK
        .could_be_better(found)
        .because("the CPU is slowed down while the loop sleeps")
        .remedy(
            "/etc/tmpfiles.d/fccd.conf",
            "w /sys/devices/system/cpu/cpufreq/policy*/scaling_governor - - - - performance",
        )
}

/// Whether a CPU is reserved for the loop.
pub(super) fn isolation(loop_cpu: &LoopCpu, board: &Board) -> Finding {
    const CHECK: Check = Check("isolated_cpus", "Isolated CPUs");
    let cpus = &loop_cpu.cpus;
    if !cpus.isolated.is_empty() {
        let mut found = list(&cpus.isolated);
        if cpus.tickless.is_disjoint(&cpus.isolated) {
            found.push_str(", with the kernel's tick");
        }
        return CHECK.ok(found);
    }
    match (cpus.online.len(), loop_cpu.cpu) {
        (1, _) => CHECK.ok("none: there is one CPU only"),
        (several, Some(cpu)) if cpus.online.contains(&cpu) => {
            let found = format!("none of {several}");
            let finding = CHECK.could_be_better(found);
            match loop_cpu.advised() {
                // The first one keeps the kernel's time.
                Some(advised) if advised != cpu => {
                    let finding = finding.because(format!(
                        "other programs run on CPU {cpu} too, the loop's CPU, and it cannot be \
                         isolated: isolate CPU {advised}, and cpu = \"auto\" chooses that one"
                    ));
                    let option = isolating(advised, &cpus.online);
                    loop_cpu.remedy_by_choice(board.kernel_option(finding, &option))
                }
                _ if cpus.online.first() == Some(&cpu) => finding.because(format!(
                    "other programs run on CPU {cpu} too, the loop's CPU, and it cannot be \
                     isolated: configure cpu = \"auto\", and fccd doctor shows which one to isolate"
                )),
                _ => {
                    let finding = finding.because("other programs run on the loop's CPU too");
                    board.kernel_option(finding, &isolating(cpu, &cpus.online))
                }
            }
        }
        _ => CHECK.not_known("not reported by the kernel"),
    }
}

/// Keeps threads, the kernel's own work and interrupts off a CPU.
fn isolating(cpu: usize, online: &BTreeSet<usize>) -> String {
    let others: BTreeSet<usize> = online.iter().copied().filter(|c| *c != cpu).collect();
    format!(
        "isolcpus=managed_irq,domain,{cpu} nohz_full={cpu} rcu_nocbs={cpu} irqaffinity={}",
        ranges(&others)
    )
}

/// A list of CPUs in the kernel's syntax: `0-1,3`.
fn ranges(cpus: &BTreeSet<usize>) -> String {
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for cpu in cpus {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *cpu => *last = *cpu,
            _ => ranges.push((*cpu, *cpu)),
        }
    }
    let words = ranges.iter().map(|(first, last)| {
        if first == last {
            first.to_string()
        } else {
            format!("{first}-{last}")
        }
    });
    words.collect::<Vec<_>>().join(",")
}

/// The CPUs' sleep states.
pub(super) fn idle_states(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("idle_states", "CPU sleep");
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
        None => CHECK.ok("no deep states"),
        Some((latency_us, name)) if latency_us <= SLOW_TO_WAKE_US => {
            CHECK.ok(format!("{name}, {latency_us} µs to wake"))
        }
        Some((latency_us, name)) => {
            let finding = CHECK
                .could_be_better(format!("{name}, {latency_us} µs to wake"))
                .because("a CPU in a deep sleep state wakes late; preventing it costs power")
                .remedy(CONFIGURATION, "cpu_dma_latency_us = 0");
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
    const CHECK: Check = Check("hyper_threads", "Shared cores");
    match machine.text(&format!("{FOLDER}/smt/active")).as_deref() {
        Some("1") => board.kernel_option(
            CHECK
                .could_be_better("two CPUs to a core")
                .because("work on the other one makes ticks up to half longer"),
            "nosmt",
        ),
        Some("0") | None => CHECK.ok("none"),
        Some(other) => CHECK.not_known(other),
    }
}

fn list(cpus: &BTreeSet<usize>) -> String {
    let numbers: Vec<String> = cpus.iter().map(ToString::to_string).collect();
    format!("CPU {}", numbers.join(", "))
}
