//! Interrupts, and the loop's CPU.

use std::path::Path;

use fcc_doctor::{Diagnosis, Grade};
use fcc_timer::CpuRequest;

use crate::machines::{PI_4, VIRTUAL, machine, put};
use crate::{check, check_for, finding, lines};

const DISK_ON_CPU_1: &str = "           CPU0       CPU1\n\
     \x2034:        404          0 PCI-MSIX-0000:00:05.0   1-edge      virtio4-input\n\
     \x2036:          0   15745011 PCI-MSIX-0000:00:02.0   1-edge      virtio1-req.0\n\
     LOC:    7761385    8227841   Local timer interrupts\n";

#[test]
fn a_device_that_interrupts_often_is_named_with_its_cpu() {
    let root = machine(VIRTUAL);
    put(root.path(), "proc/interrupts", DISK_ON_CPU_1);
    let found = check(root.path());
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

/// CPU 0 keeps the kernel's time and cannot be isolated: what is to be isolated and what
/// is to be left by the devices is the same CPU.
#[test]
fn the_cpu_to_isolate_is_the_one_that_devices_are_moved_away_from() {
    let root = machine(VIRTUAL);
    let on_both = DISK_ON_CPU_1.replace("        404          0", "     515000          0");
    put(root.path(), "proc/interrupts", &on_both);
    let found = check(root.path());
    let isolation = finding(&found, "isolated_cpus");
    assert!(isolation.why.contains("isolate CPU 1"), "{}", isolation.why);
    let interrupts = finding(&found, "interrupts");
    assert_eq!(
        lines(interrupts)[0],
        (
            "/etc/tmpfiles.d/fccd.conf, for virtio1-req.0",
            "w /proc/irq/36/smp_affinity_list - - - - 0"
        )
    );
}

/// `smp_affinity_list` is from the kernel's core-api/irq/irq-affinity, the line
/// from tmpfiles.d(5), the last from irqbalance(1).
#[test]
fn a_device_that_interrupts_an_isolated_cpu_gets_a_remedy() {
    let root = machine(VIRTUAL);
    put(root.path(), "proc/interrupts", DISK_ON_CPU_1);
    put(root.path(), "sys/devices/system/cpu/isolated", "1\n");
    put(root.path(), "etc/default/irqbalance", "");
    let of = |root: &Path| finding(&check(root), "interrupts").clone();
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
    // The present CPU of an interrupt counts, not the former.
    put(root.path(), "proc/irq/36/effective_affinity_list", "0\n");
    let moved = of(root.path());
    assert_eq!(moved.grade, Grade::Ok);
    assert_eq!(moved.found, "CPU 0: virtio1-req.0 100 %");
}

/// The CPUs named in all remedies.
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
fn all_findings_refer_to_the_loops_cpu() {
    let root = machine(VIRTUAL);
    put(root.path(), "etc/default/irqbalance", "");
    for (interrupts, request, expected) in [
        // Neither is much better, and the first one keeps the time.
        (EVEN, None, &["1"][..]),
        (EVEN, Some(CpuRequest::Auto), &["1"]),
        (EVEN, Some(CpuRequest::Number(1)), &["1"]),
        (EVEN, Some(CpuRequest::Number(0)), &["0"]),
        // The first one is good, and cannot be isolated: another one can, which
        // the loop then chooses.
        (DISK_ON_CPU_1, Some(CpuRequest::Auto), &["1"]),
        (DISK_ON_CPU_1, Some(CpuRequest::Number(0)), &[]),
    ] {
        put(root.path(), "proc/interrupts", interrupts);
        let found = check_for(root.path(), request);
        assert_eq!(cpus_named(&found), expected, "{request:?}");
    }
}

/// What it says of the CPU of `cpu = "auto"` is followed, and it has nothing more
/// to say: the loop is then on the CPU that it named.
#[test]
fn the_advice_on_isolation_leads_to_the_loops_cpu() {
    const AUTO: (&str, &str) = ("fccd's configuration, [realtime]", "cpu = \"auto\"");
    let root = machine(VIRTUAL);
    put(root.path(), "proc/interrupts", DISK_ON_CPU_1);
    for (request, configured) in [(None, &[AUTO][..]), (Some(CpuRequest::Auto), &[])] {
        let isolation = finding(&check_for(root.path(), request), "isolated_cpus").clone();
        let words = "isolate CPU 1, and cpu = \"auto\" chooses that one";
        assert!(isolation.why.ends_with(words), "{}", isolation.why);
        let [(_, option), rest @ ..] = &lines(&isolation)[..] else {
            panic!("no remedy");
        };
        assert!(
            option.contains("isolcpus=managed_irq,domain,1 "),
            "{option}"
        );
        assert_eq!(rest, configured, "{request:?}");
    }
    put(root.path(), "sys/devices/system/cpu/isolated", "1\n");
    let found = check_for(root.path(), Some(CpuRequest::Auto));
    assert_eq!(finding(&found, "isolated_cpus").grade, Grade::Ok);
    let loop_cpu = &finding(&found, "loop_cpu").found;
    assert!(
        loop_cpu.starts_with("CPU 1, by cpu = \"auto\""),
        "{loop_cpu}"
    );
}

#[test]
fn the_doctor_reports_the_loops_own_choice() {
    let root = machine(PI_4);
    let of = |cpu| finding(&check_for(root.path(), cpu), "loop_cpu").clone();
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

    // A service or a container that may use only some of the CPUs.
    put(root.path(), "sys/devices/system/cpu/isolated", "\n");
    put(root.path(), "proc/self/status", "Cpus_allowed_list:\t0-1\n");
    let allowed = of(Some(CpuRequest::Auto));
    assert!(allowed.found.starts_with("CPU 1"), "{}", allowed.found);
}

#[test]
fn without_interrupts_of_devices_the_finding_is_ok() {
    let root = machine(VIRTUAL);
    let quiet = "           CPU0       CPU1\nLOC:    3461567    3545716   Local timer interrupts\n";
    put(root.path(), "proc/interrupts", quiet);
    let found = check(root.path());
    assert_eq!(
        finding(&found, "interrupts").found,
        "no device has interrupted yet"
    );
}
