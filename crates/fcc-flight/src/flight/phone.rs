//! The sensors of the phone that the program runs on: what opens them is the host's.

use std::io;

use fcc_core::flight::Measurements;
use fcc_core::framework::Sensor;
use fcc_linux::DeviceStatus;

use super::assemble::AssemblyError;
use super::device::{WatchedDevice, WatchedSensor};
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

/// The phone's sensors, uncalibrated.
pub(super) fn open_phone(
    section: &PhoneSection,
    host: Option<&mut dyn PhoneHost>,
) -> Result<WatchedSensor, AssemblyError> {
    let host = host.ok_or(AssemblyError::NoPhone)?;
    let opened = host.open(section).map_err(|source| AssemblyError::Device {
        name: "phone".to_owned(),
        source,
    })?;
    let devices = opened.devices.into_iter();
    let watched = devices.map(|(name, status)| WatchedDevice::new(name, name.to_owned(), status));
    Ok((opened.sensor, watched.collect()))
}
