//! Which devices interrupt which CPU: each interrupt delays a loop on that CPU.

use std::collections::BTreeMap;

use super::busy_devices::{Busy, busy_devices, total};
use super::loop_cpu::LoopCpu;
use super::machine::Machine;
use super::{Check, Finding};

/// The most devices named for each CPU.
const MAX_NAMED: usize = 2;
/// Read at each start of the machine; interrupt numbers stay the same while its
/// devices do.
const AT_START: &str = "/etc/tmpfiles.d/fccd.conf";
const BALANCER: &str = "etc/default/irqbalance";

/// Which CPUs are interrupted.
pub(super) fn interrupts(machine: &Machine, loop_cpu: &LoopCpu) -> Finding {
    const CHECK: Check = Check("interrupts", "Interrupts");
    let cpus = &loop_cpu.cpus;
    let counts = &cpus.device_interrupts;
    if counts.is_empty() {
        return CHECK.not_known("not reported by the kernel");
    }
    if counts.len() == 1 {
        return CHECK.ok("there is one CPU only");
    }
    let total = total(cpus);
    if total == 0 {
        return CHECK.ok("no device has interrupted yet");
    }
    let busy = busy_devices(machine, total);
    let found = description(&busy, total);
    let of_cpu = |cpu: &usize| busy.get(cpu).map_or(&[][..], Vec::as_slice);
    let quiet = loop_cpu.cpu.filter(|cpu| of_cpu(cpu).is_empty());
    let Some(cpu) = quiet.or(loop_cpu.advised()) else {
        return CHECK.not_known("not reported by the kernel");
    };
    let on_it = of_cpu(&cpu);
    if on_it.is_empty() {
        let finding = CHECK
            .ok(found)
            .because(format!("each delays a loop; CPU {cpu} has none of them"));
        return loop_cpu.remedy(finding);
    }
    let others = || counts.iter().map(|(cpu, _)| *cpu).filter(|c| *c != cpu);
    let (kept, ordinary): (Vec<usize>, Vec<usize>) =
        others().partition(|other| cpus.isolated.contains(other));
    let others = list(if ordinary.is_empty() {
        &kept
    } else {
        &ordinary
    });
    let mut finding = CHECK.could_be_better(found).because(format!(
        "each delays a loop by some 10 µs: move those of CPU {cpu} away (a disk that refuses has \
         one for each CPU and keeps it)"
    ));
    for device in on_it {
        let line = format!(
            "w /proc/irq/{}/smp_affinity_list - - - - {others}",
            device.number
        );
        finding = finding.remedy(format!("{AT_START}, for {}", device.name), line);
    }
    if machine.exists(BALANCER) {
        finding = finding.remedy(
            format!("/{BALANCER}, or it moves them back"),
            format!("IRQBALANCE_BANNED_CPULIST={cpu}"),
        );
    }
    loop_cpu.remedy(finding)
}

/// `CPU 0: eth0 98 %, mmc0 2 %; CPU 3: xhci_hcd 1 %`.
fn description(busy: &BTreeMap<usize, Vec<Busy>>, total: u64) -> String {
    let of_cpu = |(cpu, devices): (&usize, &Vec<Busy>)| {
        let mut names: Vec<String> = devices
            .iter()
            .take(MAX_NAMED)
            .map(|device| {
                let percent = 100.0 * device.count as f64 / total as f64;
                format!("{} {percent:.0} %", device.name)
            })
            .collect();
        if devices.len() > MAX_NAMED {
            names.push(format!("{} more", devices.len() - MAX_NAMED));
        }
        format!("CPU {cpu}: {}", names.join(", "))
    };
    busy.iter().map(of_cpu).collect::<Vec<_>>().join("; ")
}

/// In the kernel's syntax: `0,1,3`.
fn list(cpus: &[usize]) -> String {
    let numbers: Vec<String> = cpus.iter().map(ToString::to_string).collect();
    numbers.join(",")
}
