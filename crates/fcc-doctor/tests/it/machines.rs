//! Machines made of files, as their kernels write them.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

/// Path and text of each file.
pub(crate) type Files = &'static [(&'static str, &'static str)];

/// A folder with these files.
pub(crate) fn machine(files: &[(&str, &str)]) -> TempDir {
    let root = tempfile::tempdir().unwrap();
    for (path, text) in files {
        put(root.path(), path, text);
    }
    root
}

pub(crate) fn put(root: &Path, path: &str, text: &str) {
    let path = root.join(path);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

const LIMITS_OF_A_PILOT: &str = "\
Limit                     Soft Limit           Hard Limit           Units
Max cpu time              unlimited            unlimited            seconds
Max locked memory         unlimited            unlimited            bytes
Max nice priority         0                    0
Max realtime priority     90                   90
Max realtime timeout      unlimited            unlimited            us
";
const LIMITS_OF_ANYBODY: &str = "\
Limit                     Soft Limit           Hard Limit           Units
Max cpu time              unlimited            unlimited            seconds
Max locked memory         8388608              8388608              bytes
Max nice priority         0                    0
Max realtime priority     0                    0
Max realtime timeout      unlimited            unlimited            us
";
const WHOLE_SYSTEM: &str = "         0          0 4294967295\n";
const NO_CAPABILITIES: &str = "Name:\tfccd\nCapEff:\t0000000000000000\n";
const NO_SWAP: &str = "Filename\t\t\t\tType\t\tSize\t\tUsed\t\tPriority\n";

/// A Raspberry Pi 4 set up for flying.
pub(crate) const PI_4: Files = &[
    ("proc/device-tree/model", "Raspberry Pi 4 Model B Rev 1.4\0"),
    (
        "boot/firmware/cmdline.txt",
        "console=tty1 root=/dev/mmcblk0p2\n",
    ),
    ("proc/sys/kernel/osrelease", "6.12.25+rpt-rpi-v8-rt\n"),
    (
        "proc/sys/kernel/version",
        "#1 SMP PREEMPT_RT Debian 1:6.12.25-1+rpt1 (2025-04-30)\n",
    ),
    ("sys/kernel/realtime", "1\n"),
    ("proc/self/limits", LIMITS_OF_A_PILOT),
    ("proc/self/status", NO_CAPABILITIES),
    ("proc/self/uid_map", WHOLE_SYSTEM),
    ("proc/self/timerslack_ns", "50000\n"),
    ("proc/self/cgroup", "0::/system.slice/fccd.service\n"),
    (
        "sys/fs/cgroup/system.slice/fccd.service/cpu.max",
        "max 100000\n",
    ),
    ("proc/sys/kernel/sched_rt_runtime_us", "950000\n"),
    ("proc/sys/kernel/sched_rt_period_us", "1000000\n"),
    (
        "boot/config-6.12.25+rpt-rpi-v8-rt",
        "CONFIG_HIGH_RES_TIMERS=y\nCONFIG_HZ=250\n",
    ),
    (
        "sys/devices/system/clocksource/clocksource0/current_clocksource",
        "arch_sys_counter\n",
    ),
    ("sys/devices/system/cpu/online", "0-3\n"),
    ("sys/devices/system/cpu/isolated", "3\n"),
    ("sys/devices/system/cpu/nohz_full", "3\n"),
    (
        "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor",
        "performance\n",
    ),
    (
        "sys/devices/system/cpu/cpu1/cpufreq/scaling_governor",
        "performance\n",
    ),
    (
        "sys/devices/system/cpu/cpu2/cpufreq/scaling_governor",
        "performance\n",
    ),
    (
        "sys/devices/system/cpu/cpu3/cpufreq/scaling_governor",
        "performance\n",
    ),
    (
        "proc/interrupts",
        "           CPU0       CPU1       CPU2       CPU3\n 11:    3031286    1287391    1127402     992338     GICv2  30 Level     arch_timer\n 40:    9483302          0          0          0     GICv2 189 Level     eth0\n",
    ),
    ("sys/devices/platform/soc/soc:firmware/get_throttled", "0\n"),
    ("sys/class/thermal/thermal_zone0/temp", "48192\n"),
    ("proc/swaps", NO_SWAP),
    ("proc/sys/vm/compact_unevictable_allowed", "0\n"),
    (
        "proc/cpuinfo",
        "processor\t: 0\nFeatures\t: fp asimd evtstrm crc32 cpuid\n",
    ),
];

/// A board with one CPU as it comes.
pub(crate) const BEAGLEBONE: Files = &[
    ("proc/device-tree/model", "TI AM335x BeagleBone Black\0"),
    ("proc/sys/kernel/osrelease", "5.10.168-ti-r72\n"),
    (
        "proc/sys/kernel/version",
        "#1bullseye SMP PREEMPT Wed Sep 13 17:09:18 UTC 2023\n",
    ),
    ("proc/self/limits", LIMITS_OF_ANYBODY),
    ("proc/self/status", NO_CAPABILITIES),
    ("proc/self/uid_map", WHOLE_SYSTEM),
    ("proc/sys/kernel/sched_rt_runtime_us", "950000\n"),
    ("proc/sys/kernel/sched_rt_period_us", "1000000\n"),
    (
        "proc/timer_list",
        "Timer List Version: v0.8\nHRTIMER_MAX_CLOCK_BASES: 8\n  .hres_active    : 1\n",
    ),
    (
        "sys/devices/system/clocksource/clocksource0/current_clocksource",
        "dmtimer\n",
    ),
    (
        "sys/devices/system/clocksource/clocksource0/available_clocksource",
        "dmtimer \n",
    ),
    ("sys/devices/system/cpu/online", "0\n"),
    ("sys/devices/system/cpu/isolated", "\n"),
    (
        "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor",
        "ondemand\n",
    ),
    ("sys/devices/system/cpu/cpu0/cpuidle/state0/name", "WFI\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state0/latency", "1\n"),
    (
        "sys/devices/system/cpu/cpu0/cpuidle/state1/name",
        "mpu_gate\n",
    ),
    (
        "sys/devices/system/cpu/cpu0/cpuidle/state1/latency",
        "130\n",
    ),
    (
        "proc/interrupts",
        "           CPU0\n 16:     162530      INTC  68 Level     gp_timer\n",
    ),
    (
        "proc/swaps",
        "Filename Type Size Used Priority\n/dev/zram0                              partition\t245756\t0\t100\n",
    ),
];

/// A virtual machine with two CPUs, run by root.
pub(crate) const VIRTUAL: Files = &[
    ("sys/class/dmi/id/sys_vendor", "QEMU\n"),
    (
        "sys/class/dmi/id/product_name",
        "Standard PC (i440FX + PIIX, 1996)\n",
    ),
    ("proc/sys/kernel/osrelease", "6.18.44\n"),
    ("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC @0\n"),
    (
        "sys/kernel/debug/sched/preempt",
        "none voluntary (full) lazy\n",
    ),
    ("proc/cmdline", "root=/dev/vda preempt=none\n"),
    ("proc/self/limits", LIMITS_OF_ANYBODY),
    (
        "proc/self/status",
        "Name:\tfccd\nCapEff:\t000001ffffffffff\n",
    ),
    ("proc/self/uid_map", WHOLE_SYSTEM),
    ("proc/sys/kernel/sched_rt_runtime_us", "-1\n"),
    (
        "sys/devices/system/clocksource/clocksource0/current_clocksource",
        "hpet\n",
    ),
    (
        "sys/devices/system/clocksource/clocksource0/available_clocksource",
        "tsc hpet acpi_pm \n",
    ),
    ("sys/devices/system/cpu/online", "0-1\n"),
    ("sys/devices/system/cpu/isolated", "\n"),
    ("sys/devices/system/cpu/smt/active", "1\n"),
    (
        "proc/interrupts",
        "           CPU0       CPU1\n 36:     500000     510000   PCI-MSIX  1-edge      virtio1-req.0\nLOC:    3461567    3545716   Local timer interrupts\n",
    ),
    (
        "proc/cpuinfo",
        "flags\t\t: fpu vme de pse tsc msr hypervisor lahf_lm\n",
    ),
    ("proc/self/cgroup", "0::/docker/1f2e/app\n"),
    ("sys/fs/cgroup/docker/cpu.max", "150000 100000\n"),
    ("sys/fs/cgroup/docker/1f2e/cpu.max", "max 100000\n"),
    ("proc/sys/vm/compact_unevictable_allowed", "1\n"),
    ("proc/sys/kernel/numa_balancing", "0\n"),
];
