//! Runs a [`Controller`](fcc_core::framework::Controller) on a timer.
//!
//! Make a [`Loop`] of the [`Parts`] and run it in this thread or in one of its
//! own. Once a tick, in one thread and in one direction:
//!
//! ```text
//! timer ─► commands ─► sensors ─► estimate ─► decide ─► guide ─► control ─► actuators ─► record
//! ```
//!
//! What the loop guarantees for every controller:
//!
//! - Between the wake-up and the last actuator write it allocates nothing,
//!   takes no lock and never waits. Commands come in and messages go out by
//!   one lock-free ring each; a full ring drops and counts.
//! - The actuators are released on every exit path: disengaged, switched off,
//!   the end of failsafe, a command to stop, the stop flag, a timer failure, a
//!   panic in a part, the loop being dropped.
//! - A tick that overruns its [`Budget`] is counted and reported, and the
//!   phase is kept; a configured number in a row leads to failsafe. If ticks leave
//!   no time to sleep, deadlines are skipped ([`Overload`]). A watchdog detects a
//!   loop that hangs ([`watch`]).
//! - Outputs that the controller itself calls invalid are never sent.
//! - Its state changes only by
//!   [`State::after`](fcc_core::framework::State::after), and each change is an
//!   [`Event`].
//!
//! [`Machine`] is the loop without its thread: one call, one tick. The thread,
//! tests and simulations faster than real time all run that same code.
//!
//! ```
//! use std::time::Duration;
//!
//! use fcc_core::framework::{Controller, Flags, Reading, Sensor, SensorFault, State, Tick};
//! use fcc_runtime::{LoopConfig, Machine, LoopCommand, Parts};
//! use fcc_timer::ManualTimer;
//!
//! /// A level that rises by 1 m/s.
//! struct Gauge;
//!
//! impl Sensor<Reading<f64>> for Gauge {
//!     fn sample(&mut self, tick: &Tick, into: &mut Reading<f64>) -> Result<(), SensorFault> {
//!         *into = Reading::new(into.value + tick.dt_s, tick.woke);
//!         Ok(())
//!     }
//!
//!     fn name(&self) -> &'static str {
//!         "gauge"
//!     }
//! }
//!
//! /// Opens a drain the more, the higher the level is.
//! struct Drain;
//!
//! impl Controller for Drain {
//!     type Measurements = Reading<f64>;
//!     type Estimate = ();
//!     type Setpoints = ();
//!     type Outputs = f64;
//!     type Command = ();
//!
//!     fn estimate(&mut self, _: &Tick, _: &Reading<f64>) {}
//!     fn engage_inhibits(&self, _: &Tick, level: &Reading<f64>) -> Flags {
//!         Flags::NONE.with(Flags::bit(0), level.is_never())
//!     }
//!     fn faults(&self, tick: &Tick, level: &Reading<f64>) -> Flags {
//!         self.engage_inhibits(tick, level)
//!     }
//!     fn flag_name(_: u32) -> &'static str {
//!         "no level"
//!     }
//!     fn engage(&mut self, _: &Tick, _: &Reading<f64>) {}
//!     fn control(&mut self, _: &Tick, level: &Reading<f64>) -> f64 {
//!         0.1 * level.value
//!     }
//!     fn failsafe(&mut self, _: &Tick, _: &Reading<f64>) -> f64 {
//!         1.0
//!     }
//!     fn setpoints(&self) {}
//!     fn outputs_are_valid(&self, opening: &f64) -> bool {
//!         (0.0..=1.0).contains(opening)
//!     }
//! }
//!
//! let parts = Parts {
//!     timer: Box::new(ManualTimer::new(Duration::from_millis(500))?),
//!     sensors: vec![Box::new(Gauge)],
//!     controller: Drain,
//!     actuators: Vec::new(),
//! };
//! let (mut machine, mut link) = Machine::new(parts, &LoopConfig::default())?;
//! machine.start()?;
//! link.commands.send(LoopCommand::Engage)?;
//! assert_eq!(machine.step(), State::Engaged);
//! assert_eq!(machine.record().outputs, 0.05);
//! assert!(machine.finish().released);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod actuators;
mod changes;
mod commands;
mod config;
mod decide;
mod faults;
mod heartbeat;
mod link;
mod machine;
mod overload;
mod overruns;
mod panics;
mod release;
mod report;
mod run;
mod sensors;
mod stopwatch;
mod switch;
mod telemetry_producer;
mod watchdog;

// The types of a loop's messages, so that its users need no other crate.
pub use fcc_core::framework::{
    Event, EventDescription, EventKind, EventOf, LoopCommand, Message, MessageOf, Record, RecordOf,
    StageTimes,
};

pub use config::{LoopConfig, Parts};
pub use heartbeat::{Heartbeat, HeartbeatReading};
pub use link::{CommandSender, CommandsFull, Link, MessageReceiver, StopHandle};
pub use machine::Machine;
pub use overload::Overload;
pub use overruns::Budget;
pub use report::{Ending, LoopReport};
pub use run::{Loop, LoopHandle, SpawnError, THREAD_NAME};
pub use switch::SwitchOwner;
pub use watchdog::{Hang, WatchdogConfig, watch};
