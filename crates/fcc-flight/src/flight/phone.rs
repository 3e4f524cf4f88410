//! The sensors of the phone that the program runs on: what opens them is the host's.

use std::io;

use fcc_core::flight::Measurements;
use fcc_core::framework::Sensor;
use fcc_linux::DeviceStatus;

use crate::config::PhoneSection;

/// A host that runs on a phone.
pub trait PhoneHost {
    /// Starts the threads that read the phone's sensors. One that the phone lacks is no
    /// error.
    ///
    /// # Errors
    /// When a thread cannot be started.
    fn open(&mut self, phone: &PhoneSection) -> io::Result<OpenPhone>;
}

/// The phone's sensors, uncalibrated.
pub struct OpenPhone {
    /// All of them as one, in Android's axes.
    pub sensor: Box<dyn Sensor<Measurements>>,
    /// The name and the state of each.
    pub devices: Vec<(&'static str, DeviceStatus)>,
}
