//! On what it was measured.

use std::fs;

/// Kernel, processors and clock source in words.
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
