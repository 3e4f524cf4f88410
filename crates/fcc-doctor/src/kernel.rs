//! The kernel: preemption, real-time share, timers and clock.

use super::board::Board;
use super::machine::Machine;
use super::{Check, Finding};

/// Where a kernel with several preemption modes shows the present one.
const PREEMPTION_MODE: &str = "sys/kernel/debug/sched/preempt";

/// Whether the kernel is interrupted for a thread that is due.
pub(super) fn preemption(machine: &Machine, board: &Board) -> Finding {
    const CHECK: Check = Check("preemption", "Preemption");
    const WORST: &str = "published worst cases at 25 ms: 60 µs with PREEMPT_RT, 320 µs without";
    let version = machine.text("proc/sys/kernel/version").unwrap_or_default();
    let has = |word: &str| version.split_whitespace().any(|found| found == word);
    if machine.text("sys/kernel/realtime").as_deref() == Some("1") || has("PREEMPT_RT") {
        return CHECK.ok("PREEMPT_RT");
    }
    if has("PREEMPT_DYNAMIC") {
        let mode = preemption_mode(machine);
        let mode = mode.as_deref().unwrap_or("unknown");
        let finding = CHECK.could_be_better(format!("PREEMPT_DYNAMIC, mode: {mode}"));
        return match mode {
            "full" => with_rt_kernel(finding.because(WORST), board),
            "unknown" if machine.is_forbidden(PREEMPTION_MODE) => board.kernel_option(
                finding.because("only root can read the mode, in /sys/kernel/debug"),
                "preempt=full",
            ),
            "unknown" => board.kernel_option(
                finding
                    .because("the mode is in /sys/kernel/debug, which is not mounted")
                    .remedy("shell", "mount -t debugfs debugfs /sys/kernel/debug"),
                "preempt=full",
            ),
            _ => board.kernel_option(
                finding.because("a long system call of another program is not interrupted"),
                "preempt=full",
            ),
        };
    }
    if has("PREEMPT") {
        let finding = CHECK.could_be_better("PREEMPT");
        return with_rt_kernel(finding.because(WORST), board);
    }
    if version.is_empty() {
        return CHECK.not_known("not reported by the kernel");
    }
    with_rt_kernel(
        CHECK
            .could_be_better("none")
            .because("a system call of another program is not interrupted, however long it takes"),
        board,
    )
}

/// The present mode of a kernel that has several, or the mode it was started
/// with, unless the present one is forbidden to read.
fn preemption_mode(machine: &Machine) -> Option<String> {
    // `none voluntary (full) lazy`: the present mode is in brackets.
    let modes = machine.text(PREEMPTION_MODE).unwrap_or_default();
    let in_force = modes
        .split_once('(')
        .and_then(|(_, rest)| rest.split_once(')'))
        .map(|(mode, _)| mode.to_owned());
    in_force.or_else(|| {
        let words = machine.text("proc/cmdline")?;
        // The last of several counts.
        let mode = words
            .split_whitespace()
            .rev()
            .find_map(|word| word.strip_prefix("preempt="))?;
        Some(mode.to_owned())
    })
}

fn with_rt_kernel(finding: Finding, board: &Board) -> Finding {
    if board.is_raspberry_pi() && !board.is_plain_debian() {
        finding.remedy("shell", "apt install linux-image-rpi-v8-rt")
    } else if board.name.contains("BeagleBo") || board.name.contains("AM335x") {
        finding.remedy(
            "shell, then apt install what it finds",
            "apt-cache search 'bbb.io-kernel.*rt'",
        )
    } else {
        finding.remedy(
            "shell",
            "apt install linux-image-rt-$(dpkg --print-architecture)",
        )
    }
}

/// The share of each second that real-time threads may use.
pub(super) fn realtime_throttling(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("realtime_throttling", "Real-time share");
    const FILE: &str = "/etc/sysctl.d/fccd.conf";
    let setting = |name| machine.number::<i64>(&format!("proc/sys/kernel/{name}"));
    let Some(runtime_us) = setting("sched_rt_runtime_us") else {
        return CHECK.not_known("not reported by the kernel");
    };
    let period_us = setting("sched_rt_period_us").unwrap_or(1_000_000).max(1);
    let share = 100.0 * runtime_us as f64 / period_us as f64;
    let found = format!("{share:.0} % of each {:.1} s", period_us as f64 * 1e-6);
    match runtime_us {
        ..0 => CHECK
            .ok("unlimited")
            .because("a loop that hangs occupies its CPU until it is killed"),
        0 => CHECK
            .lacks("none")
            .because("no real-time thread may run at all")
            .remedy(FILE, "kernel.sched_rt_runtime_us = 950000"),
        _ if share < 50.0 => CHECK
            .could_be_better(found)
            .because("real-time threads that have used their share wait until its end")
            .remedy(FILE, "kernel.sched_rt_runtime_us = 950000"),
        _ => CHECK.ok(found),
    }
}

/// Whether timers expire when due, or at the kernel's next tick.
pub(super) fn high_resolution_timers(machine: &Machine, board: &Board) -> Finding {
    const CHECK: Check = Check("high_resolution_timers", "Timers");
    let in_force = machine
        .text("proc/timer_list")
        .and_then(|list| Some(super::machine::field_of(&list, ".hres_active")? == "1"));
    let built_in = || {
        let release = machine.text("proc/sys/kernel/osrelease")?;
        let config = machine.text(&format!("boot/config-{release}"))?;
        Some(
            config
                .lines()
                .any(|line| line == "CONFIG_HIGH_RES_TIMERS=y"),
        )
    };
    match in_force.or_else(built_in) {
        Some(true) => CHECK.ok("high resolution"),
        Some(false) => board.kernel_option(
            CHECK
                .lacks("the resolution of the kernel's tick")
                .because("every wake-up waits for the next tick, 1 to 10 ms"),
            "highres=on",
        ),
        None => CHECK.not_known("only root can read it, in /proc/timer_list"),
    }
}

/// The clock source.
pub(super) fn clock_source(machine: &Machine, board: &Board) -> Finding {
    const CHECK: Check = Check("clock_source", "Clock");
    const FOLDER: &str = "sys/devices/system/clocksource/clocksource0";
    let Some(source) = machine.text(&format!("{FOLDER}/current_clocksource")) else {
        return CHECK.not_known("not reported by the kernel");
    };
    match source.as_str() {
        "tsc"
        | "arch_sys_counter"
        | "kvm-clock"
        | "hyperv_clocksource_tsc_page"
        | "riscv_clocksource" => CHECK.ok(source),
        "jiffies" | "refined-jiffies" => {
            CHECK.lacks(source).because("it counts the kernel's ticks")
        }
        _ => {
            let others = machine
                .text(&format!("{FOLDER}/available_clocksource"))
                .unwrap_or_default();
            let finding = CHECK
                .could_be_better(source)
                .because("each reading is a system call, some ten per tick");
            if others.split_whitespace().any(|other| other == "tsc") {
                board.kernel_option(finding, "clocksource=tsc tsc=reliable")
            } else {
                finding
            }
        }
    }
}

/// The timer slack of ordinary threads.
pub(super) fn timer_slack(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("timer_slack", "Timer slack");
    match machine.number::<u64>("proc/self/timerslack_ns") {
        Some(slack_ns) => CHECK.ok(format!(
            "{:.0} µs; fccd sets its own",
            slack_ns as f64 * 1e-3
        )),
        None => CHECK.not_known("not reported by the kernel; fccd sets its own"),
    }
}
