//! How long each stage of a tick took.

use fcc_timer::Timer;

/// How long each stage of a tick took, ns; 0 for one that was left out.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[repr(C)]
pub struct StageTimes {
    /// Sampling the sensors.
    pub sensors_ns: u64,
    /// [`Controller::estimate`](fcc_core::framework::Controller::estimate).
    pub navigation_ns: u64,
    /// [`Controller::guide`](fcc_core::framework::Controller::guide).
    pub guidance_ns: u64,
    /// [`Controller::control`](fcc_core::framework::Controller::control), or
    /// `failsafe`, and the check of what they give.
    pub control_ns: u64,
    /// Driving the actuators.
    pub actuators_ns: u64,
    /// All of the tick, from the wake-up to the last actuator write: the
    /// stages above, and orders, decisions and releases between them.
    pub total_ns: u64,
}

/// Times one stage after the other. What it reads goes into the record and
/// nowhere else: no decision of the loop depends on it.
pub(crate) struct Stopwatch {
    lap_ns: i64,
}

impl Stopwatch {
    pub(crate) fn start(timer: &dyn Timer) -> Self {
        Self {
            lap_ns: timer.now_ns(),
        }
    }

    /// Time since the start or the last lap.
    pub(crate) fn lap(&mut self, timer: &dyn Timer) -> u64 {
        let now_ns = timer.now_ns();
        let lap = span_ns(self.lap_ns, now_ns);
        self.lap_ns = now_ns;
        lap
    }

    /// Time from `from_ns` to the last lap.
    pub(crate) fn since(&self, from_ns: i64) -> u64 {
        span_ns(from_ns, self.lap_ns)
    }
}

fn span_ns(from_ns: i64, to_ns: i64) -> u64 {
    u64::try_from(to_ns.saturating_sub(from_ns)).unwrap_or(0)
}
