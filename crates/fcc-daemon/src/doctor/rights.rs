//! What the program may ask of the kernel.

use super::board::{Board, not_told};
use super::machine::Machine;
use super::{Finding, Grade};

/// The bits of a set of capabilities.
const CAP_IPC_LOCK: u32 = 14;
const CAP_SYS_NICE: u32 = 23;
/// Where rights of a login are given.
const LIMITS: &str = "/etc/security/limits.d/fccd.conf";
/// Where those of the service are.
const UNIT: &str = "fccd.service, [Service]";

/// Whether the loop's thread may be real-time.
pub(super) fn realtime_priority(machine: &Machine, priority: Option<u8>) -> Finding {
    const ID: &str = "realtime_priority";
    const NAME: &str = "Real-time right";
    let Some(priority) = priority else {
        return Finding::new(ID, NAME, Grade::Ok, "not asked for: realtime.priority = 0");
    };
    if has_capability(machine, CAP_SYS_NICE) {
        return Finding::new(ID, NAME, Grade::Ok, "CAP_SYS_NICE");
    }
    let limit = limit(machine, "Max realtime priority");
    let Some(limit) = limit else {
        return not_told(ID, NAME, "the kernel does not say");
    };
    let found = match limit {
        Limit::Unlimited => "priorities up to 99".to_owned(),
        Limit::Number(0) => "none".to_owned(),
        Limit::Number(most) => format!("priorities up to {most}"),
    };
    let graded = match limit {
        Limit::Number(0) => Finding::new(ID, NAME, Grade::Lacks, found)
            .because("the loop would run under the ordinary scheduler, milliseconds late"),
        Limit::Number(most) if most < u64::from(priority) => {
            Finding::new(ID, NAME, Grade::CouldBeBetter, found)
                .because(format!("the loop asks for {priority} (realtime.priority)"))
        }
        _ => return Finding::new(ID, NAME, Grade::Ok, found),
    };
    graded
        .remedy(LIMITS, "fccd - rtprio 90")
        .remedy(UNIT, "LimitRTPRIO=90")
}

/// Whether memory may be locked.
pub(super) fn locked_memory(machine: &Machine, _: &Board) -> Finding {
    const ID: &str = "locked_memory";
    const NAME: &str = "Locked memory";
    if has_capability(machine, CAP_IPC_LOCK) {
        return Finding::new(ID, NAME, Grade::Ok, "CAP_IPC_LOCK");
    }
    match limit(machine, "Max locked memory") {
        Some(Limit::Unlimited) => Finding::new(ID, NAME, Grade::Ok, "unlimited"),
        Some(Limit::Number(bytes)) => {
            Finding::new(ID, NAME, Grade::Lacks, format!("{} KiB", bytes / 1024))
                .because("fccd locks all or nothing: under a limit, allocations fail later")
                .remedy(LIMITS, "fccd - memlock unlimited")
                .remedy(UNIT, "LimitMEMLOCK=infinity")
        }
        None => not_told(ID, NAME, "the kernel does not say"),
    }
}

/// Whether memory may be locked, for checks that depend on it.
pub(super) fn may_lock(machine: &Machine) -> bool {
    has_capability(machine, CAP_IPC_LOCK)
        || limit(machine, "Max locked memory") == Some(Limit::Unlimited)
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Limit {
    Unlimited,
    Number(u64),
}

/// The soft limit of this name.
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
    // In a user namespace of its own a process has every capability, and none
    // that counts here.
    let whole_system = machine
        .text("proc/self/uid_map")
        .is_none_or(|map| map.split_whitespace().eq(["0", "0", "4294967295"]));
    whole_system
        && machine
            .field("proc/self/status", "CapEff")
            .and_then(|digits| u64::from_str_radix(&digits, 16).ok())
            .is_some_and(|set| set & (1 << bit) != 0)
}
