//! All that is known of one tick.

use std::fmt;

use fcc_core::framework::{Controller, Flags, State, Tick};

use crate::stages::StageTimes;

/// All that is known of one tick: fixed size, no pointers.
pub struct Record<C: Controller> {
    /// The tick and its times.
    pub tick: Tick,
    /// The loop's state at the tick's end.
    pub state: State,
    /// What the sensors had measured by then.
    pub measurements: C::Measurements,
    /// The controller's set points.
    pub setpoints: C::Setpoints,
    /// What was handed to the actuators; the default if nothing was.
    pub outputs: C::Outputs,
    /// Whether outputs were handed to the actuators.
    pub sent: bool,
    /// Why the loop may not engage; empty while engaged.
    pub blockers: Flags,
    /// What makes going on unsafe; empty in standby.
    pub faults: Flags,
    /// How long the stages took.
    pub stages: StageTimes,
    /// Failed samples of sensors since the loop's start.
    pub sensor_faults: u64,
    /// Failed writes and releases of actuators since the loop's start.
    pub actuator_faults: u64,
    /// Records that found no room in the ring since the loop's start.
    pub records_dropped: u64,
}

impl<C: Controller> Record<C> {
    /// The record of a tick of which nothing is known yet.
    pub(crate) fn new(tick: Tick, state: State) -> Self {
        Self {
            tick,
            state,
            measurements: C::Measurements::default(),
            setpoints: C::Setpoints::default(),
            outputs: C::Outputs::default(),
            sent: false,
            blockers: Flags::NONE,
            faults: Flags::NONE,
            stages: StageTimes::default(),
            sensor_faults: 0,
            actuator_faults: 0,
            records_dropped: 0,
        }
    }
}

// By hand: derived, these would ask `Clone` and `Copy` of the controller.
impl<C: Controller> Clone for Record<C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<C: Controller> Copy for Record<C> {}

impl<C: Controller> fmt::Debug for Record<C>
where
    C::Measurements: fmt::Debug,
    C::Setpoints: fmt::Debug,
    C::Outputs: fmt::Debug,
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Record")
            .field("tick", &self.tick)
            .field("state", &self.state)
            .field("measurements", &self.measurements)
            .field("setpoints", &self.setpoints)
            .field("outputs", &self.outputs)
            .field("sent", &self.sent)
            .field("blockers", &self.blockers)
            .field("faults", &self.faults)
            .field("stages", &self.stages)
            .field("sensor_faults", &self.sensor_faults)
            .field("actuator_faults", &self.actuator_faults)
            .field("records_dropped", &self.records_dropped)
            .finish()
    }
}
