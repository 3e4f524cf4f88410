//! Which devices interrupt which CPU: each interrupt delays a loop on that CPU.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use fcc_timer::realtime::cpus::{Cpus, DeviceInterrupt, parse_devices, parse_list};

use super::board::not_known;
use super::loop_cpu::LoopCpu;
use super::machine::Machine;
use super::{Finding, Grade};

/// A device with less than one interrupt in this many is not mentioned.
const WORTH_NAMING: u64 = 100;
/// The most devices named for each CPU.
const MAX_NAMED: usize = 4;
/// Read at each start of the machine; interrupt numbers stay the same while its
/// devices do.
const AT_START: &str = "/etc/tmpfiles.d/fccd.conf";
const BALANCER: &str = "etc/default/irqbalance";

/// A device that interrupts often, and the CPUs that it interrupts.
struct Busy {
    number: u32,
    name: String,
    count: u64,
}

/// Which CPUs are interrupted.
pub(super) fn interrupts(machine: &Machine, loop_cpu: &LoopCpu) -> Finding {
    const ID: &str = "interrupts";
    const NAME: &str = "Interrupts";
    let cpus = &loop_cpu.cpus;
    let counts = &cpus.device_interrupts;
    if counts.is_empty() {
        return not_known(ID, NAME, "not reported by the kernel");
    }
    if counts.len() == 1 {
        return Finding::new(ID, NAME, Grade::Ok, "there is one CPU only");
    }
    let total = total(cpus);
    if total == 0 {
        return Finding::new(ID, NAME, Grade::Ok, "no device has interrupted yet");
    }
    let busy = busy_devices(machine, total);
    let found = description(&busy, total);
    let Some(cpu) = loop_cpu.cpu else {
        return not_known(ID, NAME, "not reported by the kernel");
    };
    let on_it = busy.get(&cpu).map_or(&[][..], Vec::as_slice);
    if on_it.is_empty() {
        let finding = Finding::new(ID, NAME, Grade::Ok, found)
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
    let mut finding = Finding::new(ID, NAME, Grade::CouldBeBetter, found).because(format!(
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

/// The CPU with the fewest interrupts of devices, the last of several; not the
/// first CPU, which keeps the kernel's time, if there is another.
pub(super) fn fewest_interrupts(machine: &Machine, cpus: &Cpus) -> Option<usize> {
    let busy = busy_devices(machine, total(cpus));
    let weight = |cpu: &usize| {
        let devices = busy.get(cpu).into_iter().flatten();
        devices.fold(0_u64, |sum, device| sum.saturating_add(device.count))
    };
    let online = cpus.online.iter().copied();
    let others = usize::from(cpus.online.len() > 1);
    online.skip(others).rev().min_by_key(weight)
}

/// The number of interrupts of all devices.
fn total(cpus: &Cpus) -> u64 {
    let counts = cpus.device_interrupts.iter();
    counts.fold(0, |sum, (_, count)| sum.saturating_add(*count))
}

/// The devices that interrupt often, by CPU, the most frequent first.
fn busy_devices(machine: &Machine, total: u64) -> BTreeMap<usize, Vec<Busy>> {
    let text = machine.text("proc/interrupts").unwrap_or_default();
    let mut busy: BTreeMap<usize, Vec<Busy>> = BTreeMap::new();
    for device in parse_devices(&text) {
        let all = device
            .counts
            .iter()
            .fold(0_u64, |sum, (_, count)| sum.saturating_add(*count));
        if all < total.div_ceil(WORTH_NAMING) {
            continue;
        }
        for cpu in cpus_of(machine, &device) {
            busy.entry(cpu).or_default().push(Busy {
                number: device.number,
                name: device.name.clone(),
                count: all,
            });
        }
    }
    for devices in busy.values_mut() {
        devices.sort_by_key(|device| Reverse(device.count));
    }
    busy
}

/// The CPUs of an interrupt: as the kernel reports (not for every one), or else
/// where it came most often.
fn cpus_of(machine: &Machine, device: &DeviceInterrupt) -> Vec<usize> {
    let file = format!("proc/irq/{}/effective_affinity_list", device.number);
    let effective = machine.text(&file).map(|text| parse_list(&text));
    match effective {
        Some(cpus) if !cpus.is_empty() => cpus.into_iter().collect(),
        _ => {
            let most = device.counts.iter().max_by_key(|(_, count)| *count);
            most.map(|(cpu, _)| *cpu).into_iter().collect()
        }
    }
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
