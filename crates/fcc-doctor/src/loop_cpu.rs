//! The loop's CPU, which all findings refer to.

use fcc_timer::CpuRequest;
use fcc_timer::realtime::cpus::{BestCpu, Cpus, parse_list};

use super::busy_devices::fewest_interrupts;
use super::machine::Machine;
use super::{CONFIGURATION, Check, Finding};

/// The configuration by which the loop chooses its CPU.
const AUTO: &str = "cpu = \"auto\"";

/// The CPUs of a machine, and the loop's CPU.
#[derive(Debug)]
pub(super) struct LoopCpu {
    /// The configured CPU.
    request: Option<CpuRequest>,
    /// The choice of `cpu = "auto"` here, or why it makes none.
    best: Result<BestCpu, String>,
    /// The machine's CPUs.
    pub(super) cpus: Cpus,
    /// The loop's CPU, or, if it is not bound, the one with the fewest interrupts.
    pub(super) cpu: Option<usize>,
}

impl LoopCpu {
    /// Uses the same function as the loop.
    pub(super) fn of(machine: &Machine, request: Option<CpuRequest>) -> Self {
        let cpus = Cpus::read(machine.root());
        let allowed = machine.field("proc/self/status", "Cpus_allowed_list");
        let allowed = match allowed.map(|list| parse_list(&list)) {
            Some(allowed) if !allowed.is_empty() => allowed,
            _ => cpus.online.clone(),
        };
        let allowed: Vec<usize> = allowed.into_iter().collect();
        let best = cpus.best(&allowed, |_| true);
        let cpu = match (request, &best) {
            (Some(CpuRequest::Number(cpu)), _) => Some(cpu),
            (_, Ok(best)) => Some(best.cpu),
            (_, Err(_)) => fewest_interrupts(machine, &cpus),
        };
        Self {
            request,
            best,
            cpus,
            cpu,
        }
    }

    /// Adds the remedy: put the loop on [`cpu`](Self::cpu), unless that is
    /// configured.
    pub(super) fn remedy(&self, finding: Finding) -> Finding {
        let remedy = match (self.request, &self.best) {
            (Some(CpuRequest::Number(_)), _) | (Some(CpuRequest::Auto), Ok(_)) => None,
            (None, Ok(_)) => Some(AUTO.to_owned()),
            (_, Err(_)) => self.cpu.map(|cpu| format!("cpu = {cpu}")),
        };
        match remedy {
            Some(line) => finding.remedy(CONFIGURATION, line),
            None => finding,
        }
    }

    /// The CPU that the loop runs on once the remedies are carried out: its own, unless
    /// the kernel keeps its time there and another can be isolated.
    pub(super) fn advised(&self) -> Option<usize> {
        let cpu = self.cpu?;
        let online = &self.cpus.online;
        let isolates = self.cpus.isolated.is_empty() && online.first() == Some(&cpu);
        match online.last() {
            Some(&last) if isolates && !self.is_configured() => Some(last),
            _ => Some(cpu),
        }
    }

    /// Whether the configuration gives its number.
    pub(super) const fn is_configured(&self) -> bool {
        matches!(self.request, Some(CpuRequest::Number(_)))
    }

    /// Adds the remedy: let the loop choose its CPU, unless it does.
    pub(super) fn remedy_by_choice(&self, finding: Finding) -> Finding {
        match self.request {
            Some(CpuRequest::Auto) => finding,
            _ => finding.remedy(CONFIGURATION, AUTO),
        }
    }

    /// The finding on the loop's CPU.
    pub(super) fn finding(&self) -> Finding {
        const CHECK: Check = Check("loop_cpu", "CPU of the loop");
        let online = &self.cpus.online;
        if online.is_empty() {
            return CHECK.not_known("the kernel does not list the CPUs");
        }
        match (self.request, &self.best) {
            (Some(CpuRequest::Number(cpu)), _) if !online.contains(&cpu) => {
                let found = format!("CPU {cpu}, as configured, which does not exist");
                let finding = CHECK
                    .lacks(found)
                    .because("the kernel refuses it: the loop would not be bound");
                finding.remedy(CONFIGURATION, AUTO)
            }
            (Some(CpuRequest::Number(cpu)), Ok(best)) if best.cpu != cpu => {
                let found = format!("CPU {cpu}, as configured");
                CHECK
                    .could_be_better(found)
                    .because(format!("CPU {} is better: {}", best.cpu, best.because))
                    .remedy(CONFIGURATION, AUTO)
            }
            (Some(CpuRequest::Number(cpu)), _) => CHECK.ok(format!("CPU {cpu}, as configured")),
            (Some(CpuRequest::Auto), Ok(best)) => {
                let found = format!("CPU {}, by cpu = \"auto\": {}", best.cpu, best.because);
                CHECK.ok(found)
            }
            (None, Ok(best)) => {
                let found = format!("any; by cpu = \"auto\" CPU {}", best.cpu);
                self.remedy(CHECK.ok(found).because(best.because.clone()))
            }
            (_, Err(why)) => CHECK.ok(format!("any: {why}")),
        }
    }
}
