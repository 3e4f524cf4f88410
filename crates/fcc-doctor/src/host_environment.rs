//! Power, heat, memory, and virtual machines and containers.

use super::board::Board;
use super::machine::Machine;
use super::rights::may_lock;
use super::{Check, Finding};

/// Bits of the Raspberry Pi's `get_throttled` (documentation of `vcgencmd`):
/// the present state, and 16 bits higher what occurred since the start.
const PI_STATES: [(u32, &str); 4] = [
    (0, "undervoltage"),
    (1, "speed capped"),
    (2, "throttled"),
    (3, "soft temperature limit"),
];
/// Chips begin to limit their speed at about this temperature, °C.
const HOT_C: f64 = 80.0;

/// Whether the power supply suffices.
pub(super) fn power(machine: &Machine, board: &Board) -> Finding {
    const CHECK: Check = Check("power", "Power");
    const SUPPLY: &str = "use the board's own power supply, and a short, thick cable";
    // The name of the firmware's folder depends on the board: `soc:firmware` on
    // a Pi 4, with the bus address on a Pi 5.
    let throttled = machine
        .entries("sys/bus/platform/drivers/raspberrypi-firmware", "soc")
        .into_iter()
        .chain(["sys/devices/platform/soc/soc:firmware".to_owned()])
        .find_map(|firmware| machine.text(&format!("{firmware}/get_throttled")))
        .and_then(|digits| u32::from_str_radix(digits.trim_start_matches("0x"), 16).ok());
    if let Some(bits) = throttled {
        let named = |shift: u32| {
            let names = PI_STATES
                .iter()
                .filter(|(bit, _)| bits >> (bit + shift) & 1 == 1);
            names.map(|(_, name)| *name).collect::<Vec<_>>().join(", ")
        };
        let (now, before) = (named(0), named(16));
        return match (now.as_str(), before.as_str()) {
            ("", "") => CHECK.ok("enough, never throttled"),
            ("", before) => CHECK
                .could_be_better(format!("since the start: {before}"))
                .because("the CPUs ran slower than they could")
                .remedy("the board", SUPPLY),
            (now, _) => CHECK
                .lacks(format!("now: {now}"))
                .because("the CPUs run slower than they could")
                .remedy("the board", SUPPLY),
        };
    }
    // On newer kernels a sensor: 1 once the voltage was too low.
    let alarm = machine
        .entries("sys/class/hwmon", "hwmon")
        .into_iter()
        .find(|sensor| machine.text(&format!("{sensor}/name")).as_deref() == Some("rpi_volt"))
        .and_then(|sensor| machine.number::<u32>(&format!("{sensor}/in0_lcrit_alarm")));
    match alarm {
        Some(0) => CHECK.ok("enough"),
        Some(_) => CHECK
            .lacks("undervoltage")
            .because("the CPUs run slower than they could")
            .remedy("the board", SUPPLY),
        None if board.is_raspberry_pi() => CHECK.not_known("not reported by the firmware"),
        None => CHECK.not_known("no sensor"),
    }
}

/// Whether it is too hot.
pub(super) fn heat(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("heat", "Heat");
    const COOL: &str = "give it a heat sink or a fan";
    let hottest_c = machine
        .entries("sys/class/thermal", "thermal_zone")
        .iter()
        .filter_map(|zone| machine.number::<f64>(&format!("{zone}/temp")))
        .map(|millidegrees| millidegrees * 1e-3)
        .filter(|degrees| degrees.is_finite())
        .max_by(f64::total_cmp);
    let slowed: u64 = machine
        .entries("sys/devices/system/cpu", "cpu")
        .iter()
        .filter_map(|cpu| {
            machine.number::<u64>(&format!("{cpu}/thermal_throttle/core_throttle_count"))
        })
        .fold(0, u64::saturating_add);
    let found = match (hottest_c, slowed) {
        (None, 0) => return CHECK.not_known("no sensor"),
        (None, times) => format!("slowed down {times} times since the start"),
        (Some(degrees), 0) => format!("{degrees:.0} °C"),
        (Some(degrees), times) => {
            format!("{degrees:.0} °C, slowed down {times} times since the start")
        }
    };
    if slowed > 0 || hottest_c.is_some_and(|degrees| degrees >= HOT_C) {
        CHECK
            .could_be_better(found)
            .because("a hot CPU is slowed down")
            .remedy("the board", COOL)
    } else {
        CHECK.ok(found)
    }
}

/// Whether memory can be swapped to a disk.
pub(super) fn swap(machine: &Machine, board: &Board) -> Finding {
    const CHECK: Check = Check("swap", "Swap");
    let Some(swaps) = machine.text("proc/swaps") else {
        return CHECK.not_known("not reported by the kernel");
    };
    let files: Vec<&str> = swaps
        .lines()
        .skip(1)
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    if files.is_empty() {
        return CHECK.ok("none");
    }
    let found = files.join(", ");
    if may_lock(machine) {
        return CHECK.ok(format!("{found}; locked memory stays"));
    }
    let finding = CHECK
        .could_be_better(found)
        .because("reading memory that is not locked from a disk takes milliseconds");
    if board.is_raspberry_pi() {
        finding.remedy("shell", "systemctl disable --now dphys-swapfile")
    } else {
        finding.remedy("shell, and remove it from /etc/fstab", "swapoff -a")
    }
}

/// Whether locked memory keeps its physical addresses.
pub(super) fn compaction(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("compaction", "Memory moves");
    const FILE: &str = "/etc/sysctl.d/fccd.conf";
    let locked = machine.number::<u32>("proc/sys/vm/compact_unevictable_allowed");
    let balancing = machine.number::<u32>("proc/sys/kernel/numa_balancing");
    let mut lines = Vec::new();
    if locked == Some(1) {
        lines.push("vm.compact_unevictable_allowed = 0");
    }
    if balancing.is_some_and(|mode| mode > 0) {
        lines.push("kernel.numa_balancing = 0");
    }
    if lines.is_empty() {
        return match (locked, balancing) {
            (None, None) => CHECK.not_known("not reported by the kernel"),
            _ => CHECK.ok("locked memory stays in its place"),
        };
    }
    let finding = CHECK
        .could_be_better("allowed")
        .because("the kernel may move locked memory, too, which costs a page fault each");
    lines
        .into_iter()
        .fold(finding, |finding, line| finding.remedy(FILE, line))
}

/// Whether this is a virtual machine.
pub(super) fn virtual_machine(machine: &Machine, board: &Board) -> Finding {
    const CHECK: Check = Check("virtual_machine", "Virtual machine");
    // Names that virtual machines' firmware uses (systemd-detect-virt(1) lists
    // more); nearly all of them also set a flag of the CPU.
    const MAKERS: [&str; 9] = [
        "QEMU",
        "KVM",
        "VMware",
        "VirtualBox",
        "innotek",
        "Xen",
        "Amazon EC2",
        "Google Compute Engine",
        "Virtual Machine",
    ];
    let maker = MAKERS.into_iter().find(|maker| board.name.contains(maker));
    let hypervisor = machine
        .text("sys/hypervisor/type")
        .or_else(|| machine.text("proc/device-tree/hypervisor/compatible"));
    let flag = machine.text("proc/cpuinfo").is_some_and(|cpus| {
        let flags = super::machine::field_of(&cpus, "flags").unwrap_or_default();
        flags.split_whitespace().any(|flag| flag == "hypervisor")
    });
    let found = match (hypervisor, maker) {
        (Some(kind), _) => kind,
        (None, Some(maker)) => maker.to_owned(),
        (None, None) if flag => "yes".to_owned(),
        (None, None) => return CHECK.ok("no"),
    };
    CHECK.could_be_better(found).because(
        "the host interrupts its CPUs for milliseconds, which cannot be prevented here: \
         suitable for trials, not for flights",
    )
}

/// Whether this is a container.
pub(super) fn container(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("container", "Container");
    let groups = machine.text("proc/self/cgroup").unwrap_or_default();
    let of_group = || {
        let names = [
            ("docker", "docker"),
            ("kubepods", "kubernetes"),
            ("/lxc", "lxc"),
        ];
        names
            .into_iter()
            .find_map(|(mark, name)| groups.contains(mark).then(|| name.to_owned()))
    };
    let found = if machine.exists("run/.containerenv") {
        Some("podman".to_owned())
    } else if machine.exists(".dockerenv") {
        Some("docker".to_owned())
    } else {
        machine.text("run/systemd/container").or_else(of_group)
    };
    match found {
        None => CHECK.ok("no"),
        Some(name) => CHECK
            .could_be_better(name)
            .because("the host determines what the kernel grants")
            .remedy(
                "docker run",
                "--cap-add sys_nice --cap-add ipc_lock --ulimit rtprio=90 --ulimit memlock=-1",
            ),
    }
}

/// Whether the program may use all CPUs without a limit.
pub(super) fn cpu_quota(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("cpu_quota", "CPU quota");
    let groups = machine.text("proc/self/cgroup").unwrap_or_default();
    let own = groups
        .lines()
        .find_map(|line| line.strip_prefix("0::"))
        .unwrap_or("/");
    // The limits of the parent groups apply, too. `..` would leave the folder.
    let mut quota: Option<f64> = None;
    let is_plain = own.split('/').all(|part| part != "..");
    for group in std::path::Path::new(own).ancestors().filter(|_| is_plain) {
        let group = group.to_string_lossy();
        let file = format!("sys/fs/cgroup/{}/cpu.max", group.trim_matches('/'));
        let Some(text) = machine.text(&file) else {
            continue;
        };
        let mut numbers = text.split_whitespace().map(str::parse::<f64>);
        if let (Some(Ok(most)), Some(Ok(period))) = (numbers.next(), numbers.next())
            && period > 0.0
        {
            let cpus = most / period;
            quota = Some(quota.map_or(cpus, |least| least.min(cpus)));
        }
    }
    match quota {
        None => CHECK.ok("none"),
        Some(cpus) => CHECK
            .could_be_better(format!("{cpus:.2} CPUs"))
            .because("when it is used up, telemetry and recorder stop until the next period")
            .remedy("fccd.service, [Service]", "CPUQuota="),
    }
}
