//! Whether a machine suits a real-time loop.
//!
//! Each check reads a few files of `/proc`, `/sys` and `/etc` and gives one
//! [`Finding`]: a grade, what was found, and, if it could be better, the line
//! to add and where. All files are read under a root folder, so that a test can
//! model a Raspberry Pi, and the disk of another machine can be checked.
//!
//! | module | what it looks at |
//! |---|---|
//! | `machine` | the files themselves |
//! | `board` | which board this is, and where its kernel's command line is kept |
//! | `kernel` | preemption, timers, clock, real-time throttling |
//! | `rights` | what the program may ask of the kernel |
//! | `loop_cpu` | which CPU the loop is on, by its own choice or as configured |
//! | `cpus` | clock speed, sleep, isolation |
//! | `interrupts` | which devices interrupt which CPU |
//! | `host_environment` | power and heat, memory, virtual machine, container |
//! | `show` | the findings for people |

mod board;
mod busy_devices;
mod cpus;
mod host_environment;
mod interrupts;
mod kernel;
mod loop_cpu;
mod machine;
mod rights;
mod show;

use std::path::Path;

use fcc_timer::RealtimeRequest;
use serde::Serialize;

use board::Board;
use loop_cpu::LoopCpu;
use machine::Machine;

/// Where the loop's requests are configured.
const CONFIGURATION: &str = "fccd's configuration, [realtime]";

/// How well something suits a real-time loop.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Good.
    Ok,
    /// A loop runs, and would run better.
    CouldBeBetter,
    /// A loop is denied a request, or cannot keep time.
    Lacks,
    /// Not known.
    NotKnown,
}

/// The result of one check.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Finding {
    /// Identifies the check for programs: `preemption`.
    pub id: &'static str,
    /// Its name for users.
    pub name: &'static str,
    /// The grade.
    pub grade: Grade,
    /// What was found.
    pub found: String,
    /// Why it is not good; empty if it is.
    pub why: String,
    /// What to add where; empty if there is nothing to do.
    pub remedies: Vec<Remedy>,
}

/// A line that improves it, and where to add it.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Remedy {
    /// A file, or `shell` for a command.
    pub place: String,
    /// The line.
    pub line: String,
}

/// A check: its identifier for programs, and its name for users.
#[derive(Clone, Copy)]
struct Check(&'static str, &'static str);

impl Check {
    fn ok(self, found: impl Into<String>) -> Finding {
        self.finding(Grade::Ok, found.into())
    }

    fn could_be_better(self, found: impl Into<String>) -> Finding {
        self.finding(Grade::CouldBeBetter, found.into())
    }

    fn lacks(self, found: impl Into<String>) -> Finding {
        self.finding(Grade::Lacks, found.into())
    }

    /// The machine gives no information.
    fn not_known(self, found: impl Into<String>) -> Finding {
        self.finding(Grade::NotKnown, found.into())
    }

    fn finding(self, grade: Grade, found: String) -> Finding {
        let Self(id, name) = self;
        Finding {
            id,
            name,
            grade,
            found,
            why: String::new(),
            remedies: Vec::new(),
        }
    }
}

impl Finding {
    fn because(mut self, why: impl Into<String>) -> Self {
        self.why = why.into();
        self
    }

    fn remedy(mut self, place: impl Into<String>, line: impl Into<String>) -> Self {
        self.remedies.push(Remedy {
            place: place.into(),
            line: line.into(),
        });
        self
    }
}

/// All findings.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Diagnosis {
    /// The board or machine, if known.
    pub machine: Option<String>,
    /// Its kernel.
    pub kernel: String,
    /// The findings, the most important first.
    pub findings: Vec<Finding>,
}

impl Diagnosis {
    /// Checks the machine with its files under `root`, for a loop with these
    /// requests.
    pub fn of(root: &Path, request: &RealtimeRequest) -> Self {
        let machine = Machine::under(root);
        let board = Board::of(&machine);
        let loop_cpu = LoopCpu::of(&machine, request.cpu);
        let (m, b) = (&machine, &board);
        let findings = vec![
            kernel::preemption(m, b),
            rights::realtime_priority(m, request.priority),
            rights::locked_memory(m, b),
            kernel::realtime_throttling(m, b),
            kernel::high_resolution_timers(m, b),
            kernel::clock_source(m, b),
            cpus::governor(m, b),
            loop_cpu.finding(),
            cpus::isolation(&loop_cpu, b),
            interrupts::interrupts(m, &loop_cpu),
            cpus::idle_states(m, b),
            cpus::hyper_threads(m, b),
            kernel::timer_slack(m, b),
            host_environment::power(m, b),
            host_environment::heat(m, b),
            host_environment::swap(m, b),
            host_environment::compaction(m, b),
            host_environment::virtual_machine(m, b),
            host_environment::container(m, b),
            host_environment::cpu_quota(m, b),
        ];
        Self {
            machine: Some(board.name.clone()).filter(|name| !name.is_empty()),
            kernel: machine.kernel(),
            findings,
        }
    }

    /// Whether anything is lacking.
    pub fn lacks_something(&self) -> bool {
        self.count(Grade::Lacks) > 0
    }

    fn count(&self, grade: Grade) -> usize {
        let findings = self.findings.iter();
        findings.filter(|finding| finding.grade == grade).count()
    }

    /// A table, followed by what to do.
    pub fn to_text(&self) -> String {
        show::text(self)
    }
}
