//! The program's rights.

use super::board::Board;
use super::machine::Machine;
use super::{Check, Finding};

/// Bits of the capabilities.
const CAP_IPC_LOCK: u32 = 14;
const CAP_SYS_NICE: u32 = 23;
/// Configures the rights of a login.
const LIMITS: &str = "/etc/security/limits.d/fccd.conf";
/// Configures the rights of the service.
const UNIT: &str = "fccd.service, [Service]";

/// Whether the loop's thread may have a real-time priority.
pub(super) fn realtime_priority(machine: &Machine, priority: Option<u8>) -> Finding {
    const CHECK: Check = Check("realtime_priority", "Real-time right");
    let Some(priority) = priority else {
        return CHECK.ok("not requested: realtime.priority = 0");
    };
    if has_capability(machine, CAP_SYS_NICE) {
        return CHECK.ok("CAP_SYS_NICE");
    }
    let limit = limit(machine, "Max realtime priority");
    let Some(limit) = limit else {
        return CHECK.not_known("not reported by the kernel");
    };
    let found = match limit {
        Limit::Unlimited => "priorities up to 99".to_owned(),
        Limit::Number(0) => "none".to_owned(),
        Limit::Number(most) => format!("priorities up to {most}"),
    };
    let graded = match limit {
        Limit::Number(0) => CHECK
            .lacks(found)
            .because("the loop would run under the ordinary scheduler, milliseconds late"),
        Limit::Number(most) if most < u64::from(priority) => CHECK
            .could_be_better(found)
            .because(format!("the loop requests {priority} (realtime.priority)")),
        _ => return CHECK.ok(found),
    };
    graded
        .remedy(LIMITS, "fccd - rtprio 90")
        .remedy(UNIT, "LimitRTPRIO=90")
}

/// Whether memory may be locked.
pub(super) fn locked_memory(machine: &Machine, _: &Board) -> Finding {
    const CHECK: Check = Check("locked_memory", "Locked memory");
    if has_capability(machine, CAP_IPC_LOCK) {
        return CHECK.ok("CAP_IPC_LOCK");
    }
    match limit(machine, "Max locked memory") {
        Some(Limit::Unlimited) => CHECK.ok("unlimited"),
        Some(Limit::Number(bytes)) => CHECK
            .lacks(format!("{} KiB", bytes / 1024))
            .because("fccd locks all of its memory or none: with a limit, allocations fail later")
            .remedy(LIMITS, "fccd - memlock unlimited")
            .remedy(UNIT, "LimitMEMLOCK=infinity"),
        None => CHECK.not_known("not reported by the kernel"),
    }
}

/// Whether memory may be locked, for dependent checks.
pub(super) fn may_lock(machine: &Machine) -> bool {
    has_capability(machine, CAP_IPC_LOCK)
        || limit(machine, "Max locked memory") == Some(Limit::Unlimited)
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Limit {
    Unlimited,
    Number(u64),
}

/// The soft limit with this name.
fn limit(machine: &Machine, name: &str) -> Option<Limit> {
    let limits = machine.text("proc/self/limits")?;
    let soft = limits
        .lines()
        .find_map(|line| line.strip_prefix(name))?
        .split_whitespace()
        .next()?;
    match soft {
        "unlimited" => Some(Limit::Unlimited),
        number => number.parse().ok().map(Limit::Number),
    }
}

fn has_capability(machine: &Machine, bit: u32) -> bool {
    // In its own user namespace a process has every capability, without effect
    // here.
    let whole_system = machine
        .text("proc/self/uid_map")
        .is_none_or(|map| map.split_whitespace().eq(["0", "0", "4294967295"]));
    whole_system
        && machine
            .field("proc/self/status", "CapEff")
            .and_then(|digits| u64::from_str_radix(&digits, 16).ok())
            .is_some_and(|set| set & (1 << bit) != 0)
}
