//! `fccd doctor`, asked about machines that are folders.
#![cfg(test)]

mod machines;

use std::path::Path;

use fcc_daemon::doctor::{Diagnosis, Finding, Grade};
use fcc_timer::{CpuRequest, RealtimeRequest};
use machines::{BEAGLEBONE, PI_4, VIRTUAL, machine, put};
use proptest::prelude::*;

fn examined(files: &[(&str, &str)]) -> Diagnosis {
    looked_at(machine(files).path())
}

/// For a loop that is configured like this.
fn looked_at_for(root: &Path, cpu: Option<CpuRequest>) -> Diagnosis {
    let request = RealtimeRequest {
        priority: Some(80),
        cpu,
        ..RealtimeRequest::default()
    };
    Diagnosis::of(root, &request)
}

fn looked_at(root: &Path) -> Diagnosis {
    looked_at_for(root, None)
}

fn finding<'d>(diagnosis: &'d Diagnosis, id: &str) -> &'d Finding {
    diagnosis.findings.iter().find(|f| f.id == id).unwrap()
}

fn lines(finding: &Finding) -> Vec<(&str, &str)> {
    finding
        .remedies
        .iter()
        .map(|remedy| (remedy.place.as_str(), remedy.line.as_str()))
        .collect()
}

fn ids(diagnosis: &Diagnosis, grade: Grade) -> Vec<&str> {
    let findings = diagnosis.findings.iter();
    findings
        .filter(|finding| finding.grade == grade)
        .map(|finding| finding.id)
        .collect()
}

#[test]
fn a_pi_set_up_for_flying_lacks_nothing() {
    let pi = examined(PI_4);
    assert_eq!(pi.machine, "Raspberry Pi 4 Model B Rev 1.4");
    assert!(
        pi.kernel
            .starts_with("6.12.25+rpt-rpi-v8-rt #1 SMP PREEMPT_RT")
    );
    assert_eq!(ids(&pi, Grade::CouldBeBetter), [""; 0]);
    assert_eq!(ids(&pi, Grade::Lacks), [""; 0]);
    assert_eq!(ids(&pi, Grade::NotKnown), [""; 0]);
    assert!(!pi.lacks_something());
    assert_eq!(finding(&pi, "isolated_cpus").found, "CPU 3");
    assert_eq!(
        finding(&pi, "realtime_priority").found,
        "priorities up to 90"
    );
    assert_eq!(finding(&pi, "heat").found, "48 °C");
}

#[test]
fn a_beaglebone_as_it_comes_lacks_rights_and_is_told_which() {
    let bone = examined(BEAGLEBONE);
    assert_eq!(
        ids(&bone, Grade::Lacks),
        ["realtime_priority", "locked_memory"]
    );
    assert_eq!(
        ids(&bone, Grade::CouldBeBetter),
        [
            "preemption",
            "clock_source",
            "governor",
            "idle_states",
            "swap"
        ]
    );
    assert_eq!(
        lines(finding(&bone, "realtime_priority")),
        [
            ("/etc/security/limits.d/fccd.conf", "fccd - rtprio 90"),
            ("fccd.service, [Service]", "LimitRTPRIO=90"),
        ]
    );
    assert_eq!(
        lines(finding(&bone, "locked_memory"))[0],
        (
            "/etc/security/limits.d/fccd.conf",
            "fccd - memlock unlimited"
        )
    );
    assert_eq!(finding(&bone, "locked_memory").found, "8192 KiB");
    assert_eq!(
        finding(&bone, "idle_states").found,
        "mpu_gate, 130 µs to wake"
    );
    assert_eq!(finding(&bone, "governor").found, "ondemand on 1");
    assert_eq!(finding(&bone, "swap").found, "/dev/zram0");
    // There is no second CPU to isolate.
    assert_eq!(finding(&bone, "isolated_cpus").grade, Grade::Ok);
}

#[test]
fn a_virtual_machine_is_called_one() {
    let virt = examined(VIRTUAL);
    assert!(!virt.lacks_something(), "{:?}", ids(&virt, Grade::Lacks));
    assert_eq!(
        ids(&virt, Grade::CouldBeBetter),
        [
            "preemption",
            "clock_source",
            "isolated_cpus",
            "interrupts",
            "hyper_threads",
            "compaction",
            "virtual_machine",
            "container",
            "cpu_quota",
        ]
    );
    assert_eq!(finding(&virt, "virtual_machine").found, "QEMU");
    assert_eq!(finding(&virt, "container").found, "docker");
    // The group above allows less than the own one.
    assert_eq!(finding(&virt, "cpu_quota").found, "1.50 CPUs");
    assert_eq!(
        finding(&virt, "preemption").found,
        "PREEMPT_DYNAMIC, mode: full"
    );
    assert_eq!(finding(&virt, "realtime_priority").found, "CAP_SYS_NICE");
    assert_eq!(
        lines(finding(&virt, "clock_source")),
        [(
            "/etc/default/grub, then update-grub",
            "at the end of GRUB_CMDLINE_LINUX=: clocksource=tsc tsc=reliable"
        )]
    );
}

/// The words are those of the kernel's admin-guide/kernel-parameters.
#[test]
fn the_kernels_command_line_is_where_the_board_keeps_it() {
    for (files, place) in [
        (PI_4, "/boot/firmware/cmdline.txt"),
        (BEAGLEBONE, "/boot/uEnv.txt"),
    ] {
        let root = machine(files);
        put(root.path(), "sys/devices/system/cpu/online", "0-3\n");
        put(root.path(), "sys/devices/system/cpu/isolated", "\n");
        let found = looked_at(root.path());
        let [(file, line)] = lines(finding(&found, "isolated_cpus"))[..] else {
            panic!("one line");
        };
        assert_eq!(file, place);
        assert!(
            line.ends_with(
                ": isolcpus=managed_irq,domain,3 nohz_full=3 rcu_nocbs=3 irqaffinity=0-2"
            ),
            "{line}"
        );
    }
}

/// Debian's own system for the board has its raspi-firmware(7) write the
/// command line, and none of Raspberry Pi's packages.
#[test]
fn a_pi_with_plain_debian_is_told_where_that_keeps_it() {
    let root = machine(PI_4);
    put(root.path(), "etc/default/raspi-firmware", "#CMA=64M\n");
    put(root.path(), "sys/devices/system/cpu/isolated", "\n");
    put(root.path(), "sys/kernel/realtime", "0\n");
    put(
        root.path(),
        "proc/sys/kernel/version",
        "#1 SMP Debian 6.1.140-1 (2025-05-22)\n",
    );
    let found = looked_at(root.path());
    assert_eq!(
        lines(finding(&found, "isolated_cpus"))[0].0,
        "/etc/default/raspi-extra-cmdline"
    );
    assert_eq!(
        lines(finding(&found, "preemption")),
        [(
            "shell",
            "apt install linux-image-rt-$(dpkg --print-architecture)"
        )]
    );
}

/// The modes are those of the kernel's parameter `preempt=`.
#[test]
fn the_preemption_mode_is_what_is_in_force_or_what_the_kernel_began_with() {
    const MODES: &str = "sys/kernel/debug/sched/preempt";
    let root = machine(VIRTUAL);
    let of = |root: &Path| finding(&looked_at(root), "preemption").clone();
    assert!(of(root.path()).found.ends_with("mode: full"));
    std::fs::remove_file(root.path().join(MODES)).unwrap();
    assert!(of(root.path()).found.ends_with("mode: none"));
    put(
        root.path(),
        "proc/cmdline",
        "root=/dev/vda preempt=none preempt=full\n",
    );
    assert!(of(root.path()).found.ends_with("mode: full"));
    put(root.path(), "proc/cmdline", "root=/dev/vda\n");
    let not_told = of(root.path());
    assert!(not_told.found.ends_with("mode: not told"));
    assert!(
        not_told.why.contains("nothing is mounted"),
        "{}",
        not_told.why
    );
    assert_eq!(
        lines(&not_told)[0],
        ("shell", "mount -t debugfs debugfs /sys/kernel/debug")
    );
}

const DISK_ON_CPU_1: &str = "           CPU0       CPU1\n\
     \x2034:        404          0 PCI-MSIX-0000:00:05.0   1-edge      virtio4-input\n\
     \x2036:          0   15745011 PCI-MSIX-0000:00:02.0   1-edge      virtio1-req.0\n\
     LOC:    7761385    8227841   Local timer interrupts\n";

#[test]
fn a_device_that_interrupts_often_is_named_with_its_cpu() {
    let root = machine(VIRTUAL);
    put(root.path(), "proc/interrupts", DISK_ON_CPU_1);
    let found = looked_at(root.path());
    let interrupts = finding(&found, "interrupts");
    assert_eq!(interrupts.grade, Grade::Ok);
    assert_eq!(interrupts.found, "CPU 1: virtio1-req.0 100 %");
    assert!(
        interrupts.why.contains("CPU 0 has none"),
        "{}",
        interrupts.why
    );
    assert_eq!(
        lines(interrupts),
        [("fccd's configuration, [realtime]", "cpu = \"auto\"")]
    );
}

/// `smp_affinity_list` is of the kernel's core-api/irq/irq-affinity, the line of
/// tmpfiles.d(5), the last of irqbalance(1).
#[test]
fn a_device_that_interrupts_an_isolated_cpu_is_to_be_moved() {
    let root = machine(VIRTUAL);
    put(root.path(), "proc/interrupts", DISK_ON_CPU_1);
    put(root.path(), "sys/devices/system/cpu/isolated", "1\n");
    put(root.path(), "etc/default/irqbalance", "");
    let of = |root: &Path| finding(&looked_at(root), "interrupts").clone();
    let there = of(root.path());
    assert_eq!(there.grade, Grade::CouldBeBetter);
    assert_eq!(
        lines(&there),
        [
            (
                "/etc/tmpfiles.d/fccd.conf, for virtio1-req.0",
                "w /proc/irq/36/smp_affinity_list - - - - 0"
            ),
            (
                "/etc/default/irqbalance, or it moves them back",
                "IRQBALANCE_BANNED_CPULIST=1"
            ),
            ("fccd's configuration, [realtime]", "cpu = \"auto\""),
        ]
    );
    // Where it comes now counts, and not where it came before.
    put(root.path(), "proc/irq/36/effective_affinity_list", "0\n");
    let moved = of(root.path());
    assert_eq!(moved.grade, Grade::Ok);
    assert_eq!(moved.found, "CPU 0: virtio1-req.0 100 %");
}

/// What each finding tells to do about a CPU is about the one that the loop is
/// on: the CPUs named in all remedies.
fn cpus_named(diagnosis: &Diagnosis) -> Vec<String> {
    let all = diagnosis.findings.iter().flat_map(lines);
    let of_isolation = |line: &str| {
        let (_, rest) = line.split_once("nohz_full=")?;
        Some(rest.split_whitespace().next()?.to_owned())
    };
    let named = |line: &str| {
        let number = line.strip_prefix("cpu = ").map(str::to_owned);
        let banned = line.strip_prefix("IRQBALANCE_BANNED_CPULIST=");
        number.or(banned.map(str::to_owned)).or(of_isolation(line))
    };
    let mut cpus: Vec<String> = all.filter_map(|(_, line)| named(line)).collect();
    cpus.dedup();
    cpus
}

const EVEN: &str = "           CPU0       CPU1\n\
     \x2034:     700000          0 PCI-MSIX-0000:00:05.0   1-edge      virtio4-input\n\
     \x2036:          0     800000 PCI-MSIX-0000:00:02.0   1-edge      virtio1-req.0\n";

#[test]
fn all_findings_are_about_the_cpu_that_the_loop_would_be_on() {
    let root = machine(VIRTUAL);
    put(root.path(), "etc/default/irqbalance", "");
    for (interrupts, request, expected) in [
        // None is better by far, and the first one keeps the time.
        (EVEN, None, &["1"][..]),
        (EVEN, Some(CpuRequest::Auto), &["1"]),
        (EVEN, Some(CpuRequest::Number(1)), &["1"]),
        (EVEN, Some(CpuRequest::Number(0)), &["0"]),
        // The first one is good as it is, and cannot be isolated.
        (DISK_ON_CPU_1, Some(CpuRequest::Auto), &[]),
        (DISK_ON_CPU_1, Some(CpuRequest::Number(0)), &[]),
    ] {
        put(root.path(), "proc/interrupts", interrupts);
        let found = looked_at_for(root.path(), request);
        assert_eq!(cpus_named(&found), expected, "{request:?}");
    }
    let isolation = finding(&looked_at(root.path()), "isolated_cpus").clone();
    assert!(
        isolation.why.contains("cannot be isolated"),
        "{}",
        isolation.why
    );
}

#[test]
fn the_loops_own_choice_is_what_the_doctor_says() {
    let root = machine(PI_4);
    let of = |cpu| finding(&looked_at_for(root.path(), cpu), "loop_cpu").clone();
    let chosen = of(Some(CpuRequest::Auto));
    assert!(
        chosen
            .found
            .starts_with("CPU 3, by cpu = \"auto\": it is isolated")
    );
    assert_eq!(lines(&chosen), []);
    assert_eq!(of(Some(CpuRequest::Number(3))).grade, Grade::Ok);

    let worse = of(Some(CpuRequest::Number(0)));
    assert_eq!(worse.grade, Grade::CouldBeBetter);
    assert!(worse.why.contains("CPU 3 is better"), "{}", worse.why);
    let none = of(Some(CpuRequest::Number(9)));
    assert_eq!(none.grade, Grade::Lacks);

    // A service or a container that may use some of the CPUs only.
    put(root.path(), "sys/devices/system/cpu/isolated", "\n");
    put(root.path(), "proc/self/status", "Cpus_allowed_list:\t0-1\n");
    let allowed = of(Some(CpuRequest::Auto));
    assert!(allowed.found.starts_with("CPU 1"), "{}", allowed.found);
}

#[test]
fn cpus_without_interrupts_of_devices_are_not_called_one() {
    let root = machine(VIRTUAL);
    let quiet = "           CPU0       CPU1\nLOC:    3461567    3545716   Local timer interrupts\n";
    put(root.path(), "proc/interrupts", quiet);
    let found = looked_at(root.path());
    assert_eq!(
        finding(&found, "interrupts").found,
        "no device has interrupted yet"
    );
}

/// A Pi 5 has the address of its bus in the name of the firmware's folder.
#[test]
fn the_firmware_of_a_pi_5_is_asked_too() {
    let root = machine(PI_4);
    let driver = "sys/bus/platform/drivers/raspberrypi-firmware";
    let file = format!("{driver}/soc@107c000000:firmware/get_throttled");
    put(root.path(), &file, "50005\n");
    let found = looked_at(root.path());
    assert_eq!(finding(&found, "power").grade, Grade::Lacks);
}

/// The bits are those of the Raspberry Pi's documentation of `vcgencmd`.
#[test]
fn a_weak_power_supply_is_found_out() {
    for (bits, grade, words) in [
        ("0", Grade::Ok, "enough"),
        (
            "50000",
            Grade::CouldBeBetter,
            "since the start: undervoltage, throttled",
        ),
        ("50005", Grade::Lacks, "now: undervoltage, throttled"),
        ("0x20002", Grade::Lacks, "now: speed capped"),
        (
            "80000",
            Grade::CouldBeBetter,
            "since the start: soft temperature limit",
        ),
    ] {
        let root = machine(PI_4);
        let file = "sys/devices/platform/soc/soc:firmware/get_throttled";
        put(root.path(), file, bits);
        let found = looked_at(root.path());
        let power = finding(&found, "power");
        assert_eq!(power.grade, grade, "{bits}");
        assert!(power.found.contains(words), "{bits}: {}", power.found);
    }
}

#[test]
fn what_stops_a_loop_is_lacking() {
    for (file, text, id) in [
        (
            "proc/sys/kernel/sched_rt_runtime_us",
            "0",
            "realtime_throttling",
        ),
        (
            "proc/timer_list",
            "  .hres_active    : 0\n",
            "high_resolution_timers",
        ),
        (
            "sys/devices/system/clocksource/clocksource0/current_clocksource",
            "jiffies",
            "clock_source",
        ),
    ] {
        let root = machine(PI_4);
        put(root.path(), file, text);
        let found = looked_at(root.path());
        assert_eq!(ids(&found, Grade::Lacks), [id]);
        assert!(found.lacks_something());
    }
}

#[test]
fn an_empty_machine_is_not_known_and_lacks_nothing() {
    let nothing = examined(&[]);
    assert_eq!(ids(&nothing, Grade::Lacks), [""; 0]);
    assert!(ids(&nothing, Grade::NotKnown).contains(&"preemption"));
}

#[test]
fn the_table_says_what_is_wrong_and_what_to_do() {
    let text = examined(BEAGLEBONE).to_text();
    for words in [
        "TI AM335x BeagleBone Black",
        " ✗ Real-time right  none",
        " ~ CPU sleep",
        "\nLacking:\n",
        "     /etc/security/limits.d/fccd.conf\n       fccd - rtprio 90\n",
        "2 lacking",
    ] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
}

/// Whatever this machine is, it can be looked at.
#[test]
fn this_machine_is_told_about() {
    let here = looked_at(Path::new("/"));
    assert!(!here.kernel.is_empty());
    let json = serde_json::to_value(&here).unwrap();
    assert_eq!(
        json["findings"].as_array().unwrap().len(),
        here.findings.len()
    );
}

/// A kernel, or a card that is going bad, may put anything into a file.
#[test]
fn any_file_may_hold_anything() {
    let all: Vec<_> = [PI_4, BEAGLEBONE, VIRTUAL].concat();
    let root = machine(&all);
    let any_words = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..200),
        "[ 0-9a-fx:,.()/\\n-]{0,80}".prop_map(String::into_bytes),
    ];
    let one_of_them = prop::sample::select(all);
    proptest!(ProptestConfig::with_cases(100), |(words in any_words, file in one_of_them)| {
        let (path, usual) = file;
        std::fs::write(root.path().join(path), words).unwrap();
        let found = looked_at(root.path());
        prop_assert!(!found.to_text().is_empty());
        prop_assert!(serde_json::to_string(&found).is_ok());
        put(root.path(), path, usual);
    });
}
