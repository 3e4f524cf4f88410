//! All that is known of one tick.

use super::{Controller, Flags, State, StateCode, Tick};

/// All that is known of one tick of a loop with measurements `M`, set points
/// `S` and outputs `O`.
///
/// Plain `repr(C)` data of a fixed size: the same struct goes through the
/// loop's ring, shared memory and a recording.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Record<M, S, O> {
    /// The tick and its times.
    pub tick: Tick,
    /// How long the stages took.
    pub stages: StageTimes,
    /// What the sensors had measured by then, each reading with its time.
    pub measurements: M,
    /// The controller's set points.
    pub setpoints: S,
    /// What was handed to the actuators; the default if nothing was.
    pub outputs: O,
    /// Failed samples of sensors since the loop's start.
    pub sensor_faults: u64,
    /// Failed writes and releases of actuators since the loop's start.
    pub actuator_faults: u64,
    /// Records that found no room in the ring since the loop's start.
    pub records_dropped: u64,
    /// Ticks that took longer than their budget since the loop's start, this
    /// one included; missed periods are counted in `tick.missed`.
    pub overruns: u64,
    /// Page faults of the loop's thread since the loop's start.
    pub page_faults: u64,
    /// How long before the deadline the timer asked to be woken, ns; 0 where
    /// it does not wake early.
    pub early_wake_ns: u64,
    /// The loop's state at the tick's end.
    pub state: StateCode,
    /// Why the loop may not engage; empty while engaged.
    pub engage_inhibits: Flags,
    /// What makes going on unsafe; empty in standby.
    pub faults: Flags,
    /// Whether outputs were handed to the actuators.
    pub sent: bool,
}

/// The record of a controller's loop.
pub type RecordOf<C> = Record<
    <C as Controller>::Measurements,
    <C as Controller>::Setpoints,
    <C as Controller>::Outputs,
>;

impl<M: Default, S: Default, O: Default> Record<M, S, O> {
    /// The record of a tick of which nothing is known yet.
    pub fn new(tick: Tick, state: State) -> Self {
        Self {
            tick,
            state: state.into(),
            ..Self::default()
        }
    }
}

/// How long each stage of a tick took, ns; 0 for one that was left out.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[repr(C)]
pub struct StageTimes {
    /// Sampling the sensors.
    pub sensors_ns: u64,
    /// [`Controller::estimate`].
    pub navigation_ns: u64,
    /// [`Controller::guide`].
    pub guidance_ns: u64,
    /// [`Controller::control`], or `failsafe`, and the check of what they give.
    pub control_ns: u64,
    /// Driving the actuators.
    pub actuators_ns: u64,
    /// All of the tick, from the wake-up to the last actuator write: the
    /// stages above, and commands, decisions and releases between them.
    pub total_ns: u64,
}
