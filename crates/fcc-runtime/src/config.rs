//! The parts of a loop and its configuration.

use std::time::Duration;

use fcc_core::framework::{Actuator, AfterRelease, Controller, Sensor};
use fcc_timer::{RealtimeRequest, Timer};

use crate::overload::Overload;
use crate::overruns::Budget;

/// The parts of a loop.
pub struct Parts<C: Controller> {
    /// When to wake.
    pub timer: Box<dyn Timer>,
    /// Sampled in this order: where two write the same reading, the later wins.
    pub sensors: Vec<Box<dyn Sensor<C::Measurements>>>,
    /// What the loop runs.
    pub controller: C,
    /// Driven, and released, in this order.
    pub actuators: Vec<Box<dyn Actuator<C::Outputs>>>,
}

/// The configuration of a loop.
#[derive(Clone, Debug)]
pub struct LoopConfig {
    /// What switching off the engage switch means.
    pub switch_off: AfterRelease,
    /// A reading of the engage switch older than this is no reading. 1 s by
    /// default.
    pub switch_max_age: Duration,
    /// Whether a command engages only while the engage switch is on, if one is
    /// read. Yes by default: a switch that is off is off, however the loop was
    /// engaged. If not, a command engages although it is off, and only a movement
    /// to off ends that.
    pub command_needs_switch: bool,
    /// How long failsafe holds the actuators before it releases them. 10 s by
    /// default; zero releases at once.
    pub failsafe_hold: Duration,
    /// What comes when failsafe is over.
    pub after_failsafe: AfterRelease,
    /// How long ticks may take. A period, and no budget for single stages, by
    /// default.
    pub budget: Budget,
    /// What is done if ticks leave no time to sleep.
    pub overload: Overload,
    /// How many commands may wait to be read; at least 1. 64 by default.
    pub commands_capacity: usize,
    /// How many ticks' records may wait to be fetched; at least 1. 4,096 by
    /// default: 102 s at 40 Hz. Events have slots of their own beside these.
    pub messages_capacity: usize,
    /// Whether a timer that wakes early does so only if the kernel grants the
    /// loop's thread a real-time priority. No by default: it wakes as it was
    /// built. Concerns [`Loop::spawn`](crate::Loop::spawn) alone.
    pub early_wake_needs_priority: bool,
    /// What [`Loop::spawn`](crate::Loop::spawn) requests of the kernel for its
    /// thread.
    pub realtime: RealtimeRequest,
}

impl Default for LoopConfig {
    fn default() -> Self {
        Self {
            switch_off: AfterRelease::Standby,
            switch_max_age: Duration::from_secs(1),
            command_needs_switch: true,
            failsafe_hold: Duration::from_secs(10),
            after_failsafe: AfterRelease::Standby,
            budget: Budget::default(),
            overload: Overload::default(),
            commands_capacity: 64,
            messages_capacity: 4_096,
            early_wake_needs_priority: false,
            realtime: RealtimeRequest::default(),
        }
    }
}
