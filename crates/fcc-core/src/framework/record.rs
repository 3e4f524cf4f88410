//! All that is known of one tick.

use super::{Controller, Flags, State, StateCode, Tick};
use crate::schema;

schema! {
    /// All that is known of one tick of a loop with measurements `M`, estimate
    /// `E`, set points `S` and outputs `O`.
    ///
    /// Plain `repr(C)` data of a fixed size: the same struct goes through the
    /// loop's ring, shared memory and a recording.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Record<M, E, S, O> {
        /// The tick and its times.
        #[field(1)]
        pub tick: Tick,
        /// How long the stages took.
        #[field(2)]
        pub stages: StageTimes,
        /// What the sensors had measured by then, each reading with its time.
        #[field(3)]
        pub measurements: M,
        /// What the controller makes of them.
        #[field(4, column = "estimated_*")]
        pub estimate: E,
        /// The controller's set points.
        #[field(5, column = "desired_*")]
        pub setpoints: S,
        /// What was handed to the actuators; the default if nothing was.
        #[field(6, column = "commanded_*")]
        pub outputs: O,
        /// Failed samples of sensors since the loop's start.
        #[field(11)]
        pub sensor_faults: u64,
        /// Failed writes and releases of actuators since the loop's start.
        #[field(12)]
        pub actuator_faults: u64,
        /// Records that found no room in the ring since the loop's start.
        #[field(13)]
        pub records_dropped: u64,
        /// Ticks that took longer than their budget since the loop's start, this
        /// one included; missed periods are counted in `tick.missed`.
        #[field(14)]
        pub overruns: u64,
        /// Page faults of the loop's thread since the loop's start.
        #[field(15)]
        pub page_faults: u64,
        /// How long before the deadline the timer asked to be woken, ns; 0 where
        /// it does not wake early.
        #[field(16)]
        pub early_wake_ns: u64,
        /// The loop's state at the tick's end.
        #[field(7)]
        pub state: StateCode,
        /// Why the loop may not engage; empty while engaged.
        #[field(8)]
        pub engage_inhibits: Flags,
        /// What makes going on unsafe; empty in standby.
        #[field(9)]
        pub faults: Flags,
        /// Whether outputs were handed to the actuators.
        #[field(10)]
        pub sent: bool,
    }
}

/// The record of a controller's loop.
pub type RecordOf<C> = Record<
    <C as Controller>::Measurements,
    <C as Controller>::Estimate,
    <C as Controller>::Setpoints,
    <C as Controller>::Outputs,
>;

impl<M: Default, E: Default, S: Default, O: Default> Record<M, E, S, O> {
    /// The record of a tick of which nothing is known yet.
    pub fn new(tick: Tick, state: State) -> Self {
        Self {
            tick,
            state: state.into(),
            ..Self::default()
        }
    }
}

schema! {
    /// How long each stage of a tick took, ns; 0 for one that was left out.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct StageTimes {
        /// Sampling the sensors.
        #[field(1, column = "sensors_time_ns")]
        pub sensors_ns: u64,
        /// [`Controller::estimate`].
        #[field(2, column = "navigation_time_ns")]
        pub navigation_ns: u64,
        /// [`Controller::guide`].
        #[field(3, column = "guidance_time_ns")]
        pub guidance_ns: u64,
        /// [`Controller::control`], or `failsafe`, and the check of what they give.
        #[field(4, column = "control_time_ns")]
        pub control_ns: u64,
        /// Driving the actuators.
        #[field(5, column = "actuators_time_ns")]
        pub actuators_ns: u64,
        /// All of the tick, from the wake-up to the last actuator write: the
        /// stages above, and commands, decisions and releases between them.
        #[field(6, column = "total_time_ns")]
        pub total_ns: u64,
    }
}
