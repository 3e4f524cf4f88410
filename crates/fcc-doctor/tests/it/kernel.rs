//! The kernel's command line, preemption and settings.

use std::path::Path;

use fcc_doctor::Grade;

use crate::machines::{BEAGLEBONE, PI_4, VIRTUAL, machine, put};
use crate::{check, finding, ids, lines};

/// The options are from the kernel's admin-guide/kernel-parameters.
#[test]
fn kernel_options_go_to_the_file_of_the_board() {
    for (files, place) in [
        (PI_4, "/boot/firmware/cmdline.txt"),
        (BEAGLEBONE, "/boot/uEnv.txt"),
    ] {
        let root = machine(files);
        put(root.path(), "sys/devices/system/cpu/online", "0-3\n");
        put(root.path(), "sys/devices/system/cpu/isolated", "\n");
        let found = check(root.path());
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

/// On Debian's own system for the board raspi-firmware(7) writes the command
/// line, and Raspberry Pi's packages are missing.
#[test]
fn kernel_options_of_a_pi_with_plain_debian_go_to_debians_file() {
    let root = machine(PI_4);
    put(root.path(), "etc/default/raspi-firmware", "#CMA=64M\n");
    put(root.path(), "sys/devices/system/cpu/isolated", "\n");
    put(root.path(), "sys/kernel/realtime", "0\n");
    put(
        root.path(),
        "proc/sys/kernel/version",
        "#1 SMP Debian 6.1.140-1 (2025-05-22)\n",
    );
    let found = check(root.path());
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
fn the_preemption_mode_is_the_present_one_or_that_of_the_command_line() {
    const MODES: &str = "sys/kernel/debug/sched/preempt";
    let root = machine(VIRTUAL);
    let of = |root: &Path| finding(&check(root), "preemption").clone();
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
    let unknown = of(root.path());
    assert!(unknown.found.ends_with("mode: unknown"));
    assert!(unknown.why.contains("is not mounted"), "{}", unknown.why);
    assert_eq!(
        lines(&unknown)[0],
        ("shell", "mount -t debugfs debugfs /sys/kernel/debug")
    );
}

#[test]
fn conditions_that_stop_a_loop_are_lacking() {
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
        let found = check(root.path());
        assert_eq!(ids(&found, Grade::Lacks), [id]);
        assert!(found.lacks_something());
    }
}
