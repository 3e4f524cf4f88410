//! Which CPU the loop is on: the one answer that all findings are about.

use fcc_timer::CpuRequest;
use fcc_timer::realtime::cpus::{BestCpu, Cpus, parse_list};

use super::board::not_told;
use super::interrupts::fewest_interrupts;
use super::machine::Machine;
use super::{CONFIGURATION, Finding, Grade};

/// The CPUs of a machine, and which of them the loop is on.
#[derive(Debug)]
pub(super) struct LoopCpu {
    /// What is configured.
    request: Option<CpuRequest>,
    /// What `cpu = "auto"` chooses here, or why it does not.
    best: Result<BestCpu, String>,
    /// What the machine tells of its CPUs.
    pub(super) cpus: Cpus,
    /// The CPU that remedies are about: where the loop is, or, where it is not
    /// bound, the one that devices interrupt least.
    pub(super) cpu: Option<usize>,
}

impl LoopCpu {
    /// By the function that the loop itself chooses by.
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

    /// Says how to have the loop on [`cpu`](Self::cpu), unless that is
    /// configured already.
    pub(super) fn remedy(&self, finding: Finding) -> Finding {
        let remedy = match (self.request, &self.best) {
            (Some(CpuRequest::Number(_)), _) | (Some(CpuRequest::Auto), Ok(_)) => None,
            (None, Ok(_)) => Some("cpu = \"auto\"".to_owned()),
            (_, Err(_)) => self.cpu.map(|cpu| format!("cpu = {cpu}")),
        };
        match remedy {
            Some(line) => finding.remedy(CONFIGURATION, line),
            None => finding,
        }
    }

    /// The finding itself.
    pub(super) fn finding(&self) -> Finding {
        const ID: &str = "loop_cpu";
        const NAME: &str = "CPU of the loop";
        let online = &self.cpus.online;
        if online.is_empty() {
            return not_told(ID, NAME, "the kernel does not say which CPUs there are");
        }
        match (self.request, &self.best) {
            (Some(CpuRequest::Number(cpu)), _) if !online.contains(&cpu) => {
                let found = format!("CPU {cpu}, as configured, and there is none");
                let finding = Finding::new(ID, NAME, Grade::Lacks, found)
                    .because("the kernel refuses it: the loop would not be bound");
                finding.remedy(CONFIGURATION, "cpu = \"auto\"")
            }
            (Some(CpuRequest::Number(cpu)), Ok(best)) if best.cpu != cpu => {
                let found = format!("CPU {cpu}, as configured");
                Finding::new(ID, NAME, Grade::CouldBeBetter, found)
                    .because(format!("CPU {} is better: {}", best.cpu, best.because))
                    .remedy(CONFIGURATION, "cpu = \"auto\"")
            }
            (Some(CpuRequest::Number(cpu)), _) => {
                Finding::new(ID, NAME, Grade::Ok, format!("CPU {cpu}, as configured"))
            }
            (Some(CpuRequest::Auto), Ok(best)) => {
                let found = format!("CPU {}, by cpu = \"auto\": {}", best.cpu, best.because);
                Finding::new(ID, NAME, Grade::Ok, found)
            }
            (None, Ok(best)) => {
                let found = format!("any; by cpu = \"auto\" CPU {}", best.cpu);
                self.remedy(Finding::new(ID, NAME, Grade::Ok, found).because(best.because.clone()))
            }
            (_, Err(why)) => Finding::new(ID, NAME, Grade::Ok, format!("any: {why}")),
        }
    }
}
