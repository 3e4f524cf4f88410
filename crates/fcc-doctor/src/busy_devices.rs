//! The devices that interrupt the CPUs often.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use fcc_timer::realtime::cpus::{Cpus, DeviceInterrupt, parse_devices, parse_list};

use super::machine::Machine;

/// A device with less than one interrupt in this many is not mentioned.
const WORTH_NAMING: u64 = 100;
/// A device that interrupts often, and the CPUs that it interrupts.
pub(super) struct Busy {
    pub(super) number: u32,
    pub(super) name: String,
    pub(super) count: u64,
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
pub(super) fn total(cpus: &Cpus) -> u64 {
    let counts = cpus.device_interrupts.iter();
    counts.fold(0, |sum, (_, count)| sum.saturating_add(*count))
}

/// The devices that interrupt often, by CPU, the most frequent first.
pub(super) fn busy_devices(machine: &Machine, total: u64) -> BTreeMap<usize, Vec<Busy>> {
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
