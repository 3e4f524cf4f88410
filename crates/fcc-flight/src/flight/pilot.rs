//! The controller and sensors of the loop, with injected faults if the program
//! is built with that feature.

type Sensors = Vec<Box<dyn fcc_core::framework::Sensor<fcc_core::flight::Measurements>>>;

/// The loop's controller.
#[cfg(not(feature = "fault-injection"))]
pub type Pilot = fcc_core::flight::Autopilot;
/// The loop's controller: an autopilot with injected faults.
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
