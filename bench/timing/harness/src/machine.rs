//! The machine.

use std::{fs, thread};

use anyhow::anyhow;
use fcc_timer::{CpuRequest, RealtimeRequest};

/// The CPU that all are bound to, and why: the one that `fccd` would choose for
/// its loop, an isolated one or one with few interrupts; the last if none is
/// better than the others.
pub(crate) fn quiet_cpu() -> anyhow::Result<(usize, String)> {
    let auto = RealtimeRequest {
        cpu: Some(CpuRequest::Auto),
        ..RealtimeRequest::default()
    };
    // In a separate thread, because choosing binds the thread.
    let granted = thread::spawn(move || auto.apply())
        .join()
        .map_err(|_| anyhow!("choosing a CPU panicked"))??;
    let last = thread::available_parallelism()?.get() - 1;
    Ok((granted.cpu.unwrap_or(last), granted.cpu_reason))
}

/// Kernel, processors and clock source, as text.
pub(crate) fn describe() -> String {
    let kernel = read("/proc/sys/kernel/osrelease");
    let version = read("/proc/sys/kernel/version");
    let preemption = version
        .split_whitespace()
        .find(|word| word.starts_with("PREEMPT"))
        .unwrap_or("no preemption");
    let source = read("/sys/devices/system/clocksource/clocksource0/current_clocksource");
    let cpuinfo = read("/proc/cpuinfo");
    let model = cpuinfo
        .lines()
        .find_map(|line| {
            line.strip_prefix("model name")
                .or(line.strip_prefix("Model"))
        })
        .map_or("unknown", |rest| rest.trim_start_matches([' ', '\t', ':']));
    let processors = cpuinfo
        .lines()
        .filter(|line| line.starts_with("processor"))
        .count();
    let virtual_machine = if cpuinfo.contains(" hypervisor ") {
        ", a virtual machine"
    } else {
        ""
    };
    format!(
        "{processors} × {model}{virtual_machine}, Linux {kernel} {preemption}, clock source {source}"
    )
}

fn read(path: &str) -> String {
    fs::read_to_string(path).map_or_else(|_| "unknown".to_owned(), |text| text.trim().to_owned())
}
