//! `fccd doctor`, on machines modelled by folders.
#![cfg(test)]

mod cpus;
mod kernel;
mod machines;

use std::path::Path;

use fcc_doctor::{Diagnosis, Finding, Grade};
use fcc_timer::{CpuRequest, RealtimeRequest};
use machines::{BEAGLEBONE, PI_4, VIRTUAL, machine, put};
use proptest::prelude::*;

fn check_files(files: &[(&str, &str)]) -> Diagnosis {
    check(machine(files).path())
}

/// Checks a machine for a loop with this CPU.
fn check_for(root: &Path, cpu: Option<CpuRequest>) -> Diagnosis {
    let request = RealtimeRequest {
        priority: Some(80),
        cpu,
        ..RealtimeRequest::default()
    };
    Diagnosis::of(root, &request)
}

fn check(root: &Path) -> Diagnosis {
    check_for(root, None)
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
    let pi = check_files(PI_4);
    assert_eq!(
        pi.machine.as_deref(),
        Some("Raspberry Pi 4 Model B Rev 1.4")
    );
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
fn a_beaglebone_with_defaults_lacks_rights() {
    let bone = check_files(BEAGLEBONE);
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
fn a_virtual_machine_is_recognised() {
    let virt = check_files(VIRTUAL);
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
    // The parent group has a lower limit than the process' own.
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

/// On a Pi 5 the name of the firmware's folder contains a bus address.
#[test]
fn the_firmware_of_a_pi_5_is_read() {
    let root = machine(PI_4);
    let driver = "sys/bus/platform/drivers/raspberrypi-firmware";
    let file = format!("{driver}/soc@107c000000:firmware/get_throttled");
    put(root.path(), &file, "50005\n");
    let found = check(root.path());
    assert_eq!(finding(&found, "power").grade, Grade::Lacks);
}

/// The bits are those of the Raspberry Pi's documentation of `vcgencmd`.
#[test]
fn a_weak_power_supply_is_detected() {
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
        let found = check(root.path());
        let power = finding(&found, "power");
        assert_eq!(power.grade, grade, "{bits}");
        assert!(power.found.contains(words), "{bits}: {}", power.found);
    }
}

#[test]
fn an_empty_machine_is_unknown_and_lacks_nothing() {
    let nothing = check_files(&[]);
    assert_eq!(ids(&nothing, Grade::Lacks), [""; 0]);
    assert!(ids(&nothing, Grade::NotKnown).contains(&"preemption"));
    let json = serde_json::to_value(&nothing).unwrap();
    assert_eq!(json["machine"], serde_json::Value::Null);
}

#[test]
fn the_table_contains_findings_and_remedies() {
    let text = check_files(BEAGLEBONE).to_text();
    assert!(text.starts_with("not ready: "), "{text}");
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

/// Whatever this machine is.
#[test]
fn this_machine_can_be_checked() {
    let here = check(Path::new("/"));
    assert!(!here.kernel.is_empty());
    let json = serde_json::to_value(&here).unwrap();
    assert_eq!(
        json["findings"].as_array().unwrap().len(),
        here.findings.len()
    );
}

/// A kernel, or a failing card, may return anything.
#[test]
fn any_content_of_a_file_is_handled() {
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
        let found = check(root.path());
        prop_assert!(!found.to_text().is_empty());
        prop_assert!(serde_json::to_string(&found).is_ok());
        put(root.path(), path, usual);
    });
}
