//! The record of one tick.

use super::{Controller, Flags, State, StateCode, Tick};
use crate::schema;

schema! {
    /// The record of one tick of a loop with measurements `M`, estimate `E`,
    /// set points `S` and outputs `O`.
    ///
    /// Plain data of a fixed size. Other processes do not see the struct, which
    /// has undefined bytes between its fields, but its values: as words in shared
    /// memory, as messages in a recording.
    ///
    /// ```
    /// use fcc_core::framework::{Record, State, Tick};
    ///
    /// let tick = Tick { number: 7, ..Tick::default() };
    /// let record = Record::<f64, (), f64, f64>::new(tick, State::Engaged);
    /// assert_eq!((record.tick.number, record.sent), (7, false));
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Record<M, E, S, O> {
        /// The tick and its times.
        #[field(1)]
        pub tick: Tick,
        /// How long the stages took.
        #[field(2)]
        pub stages: StageTimes,
        /// The latest measurements of the sensors, each reading with its time.
        #[field(3)]
        pub measurements: M,
        /// The controller's estimate.
        #[field(4, column = "estimated_*")]
        pub estimate: E,
        /// The controller's set points.
        #[field(5, column = "desired_*")]
        pub setpoints: S,
        /// The outputs for the actuators; the default if none were computed.
        #[field(6, column = "commanded_*")]
        pub outputs: O,
        /// Failed samples of sensors since the loop's start.
        #[field(11)]
        pub sensor_faults: u64,
        /// Failed writes and releases of actuators since the loop's start.
        #[field(12)]
        pub actuator_faults: u64,
        /// Records lost since the loop's start because the ring was full.
        #[field(13)]
        pub records_dropped: u64,
        /// Ticks that took longer than their budget since the loop's start, this
        /// one included; missed periods are counted in `tick.missed`.
        #[field(14)]
        pub overruns: u64,
        /// Page faults of the loop's thread since the loop's start.
        #[field(15)]
        pub page_faults: u64,
        /// The margin of the early wake-up before the deadline, ns; 0 without
        /// early wake-up.
        #[field(16)]
        pub early_wake_ns: u64,
        /// The loop's state at the tick's end.
        #[field(7)]
        pub state: StateCode,
        /// The engage inhibits; empty while engaged.
        #[field(8)]
        pub engage_inhibits: Flags,
        /// The faults; empty in standby.
        #[field(9)]
        pub faults: Flags,
        /// Whether outputs were sent to the actuators.
        #[field(10)]
        pub sent: bool,
    }
}

/// The record of a controller's loop.
///
/// ```
/// # mod heating {
/// #     include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/heating.rs"));
/// # }
/// # use heating::Heating;
/// use fcc_core::framework::{RecordOf, State, Tick};
///
/// let record = RecordOf::<Heating>::new(Tick::default(), State::Standby);
/// assert_eq!(record.measurements, 0.0);
/// ```
pub type RecordOf<C> = Record<
    <C as Controller>::Measurements,
    <C as Controller>::Estimate,
    <C as Controller>::Setpoints,
    <C as Controller>::Outputs,
>;

impl<M: Default, E: Default, S: Default, O: Default> Record<M, E, S, O> {
    /// A record at the beginning of a tick.
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
    ///
    /// ```
    /// use fcc_core::framework::{Stage, StageTimes};
    ///
    /// let stages = StageTimes { control_ns: 900, total_ns: 1_500, ..StageTimes::default() };
    /// assert_eq!(stages.of(Stage::Control), 900);
    /// assert_eq!(stages.longest(), Stage::Control);
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct StageTimes {
        /// Sampling the sensors.
        #[field(1, column = "sensors_time_ns")]
        pub sensors_ns: u64,
        /// [`Controller::estimate`].
        #[field(2, column = "estimate_time_ns")]
        pub estimate_ns: u64,
        /// [`Controller::guide`].
        #[field(3, column = "guide_time_ns")]
        pub guide_ns: u64,
        /// [`Controller::control`], or `failsafe`, and the check of their
        /// outputs.
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
