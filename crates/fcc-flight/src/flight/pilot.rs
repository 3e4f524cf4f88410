//! What the loop runs, and by which sensors: with faults on purpose, if the
//! program is built so.

type Sensors = Vec<Box<dyn fcc_core::framework::Sensor<fcc_core::flight::Measurements>>>;

/// What the loop runs.
#[cfg(not(feature = "fault-injection"))]
pub type Pilot = fcc_core::flight::Autopilot;
/// What the loop runs: an autopilot that goes wrong when it is told to.
#[cfg(feature = "fault-injection")]
pub type Pilot = super::injection::Faulty;

#[cfg(not(feature = "fault-injection"))]
pub(super) fn sensors(sensors: Sensors) -> Sensors {
    sensors
}

#[cfg(feature = "fault-injection")]
pub(super) fn sensors(mut sensors: Sensors) -> Sensors {
    sensors.push(Box::new(super::injection::Blocking::default()));
    sensors
}

#[cfg(not(feature = "fault-injection"))]
pub(super) fn pilot(autopilot: fcc_core::flight::Autopilot) -> Pilot {
    autopilot
}

#[cfg(feature = "fault-injection")]
pub(super) fn pilot(autopilot: fcc_core::flight::Autopilot) -> Pilot {
    super::injection::Faulty::new(autopilot)
}
