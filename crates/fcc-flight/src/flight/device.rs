//! Devices: their threads, and what is wrong with them.

use std::io;
use std::time::{Duration, Instant};

use fcc_core::flight::Measurements;
use fcc_core::framework::{Controller, Sensor};
use fcc_linux::gpio::{GpioLine, GpioSwitch};
use fcc_linux::gpsd::Gpsd;
use fcc_linux::iio::Iio;
use fcc_linux::serial::{GnssReceiver, RcReceiver};
use fcc_linux::{Clock, DeviceOwner, DeviceStatus, DeviceThread, monotonic};

use super::assembly_error::AssemblyError;
use super::observer::{Access, Observer};
use super::phone::PhoneHost;
use crate::config::{DeviceEntry, PhoneSection};

/// A device, and its state for programs.
pub(crate) struct WatchedDevice {
    /// Its kind: what is wrong with it says where.
    kind: &'static str,
    name: String,
    status: DeviceStatus,
    /// What was reported last, and when something else may be.
    reported: Option<String>,
    quiet_until: Option<Instant>,
}

impl WatchedDevice {
    pub(super) const fn new(kind: &'static str, name: String, status: DeviceStatus) -> Self {
        Self {
            kind,
            name,
            status,
            reported: None,
            quiet_until: None,
        }
    }
}

/// For how long nothing more of a device is reported: one of which every
/// hundredth value is damaged would fill the recording.
const QUIET: Duration = Duration::from_secs(5);

/// A sensor, and the devices that it is made of.
pub(crate) type WatchedSensor = (Box<dyn Sensor<Measurements>>, Vec<WatchedDevice>);

/// Starts the thread that reads a device, uncalibrated. One that is not connected is no
/// error: it may be, later.
pub(crate) fn open_device(
    device: &DeviceEntry,
    phone: &mut Option<&mut dyn PhoneHost>,
) -> Result<WatchedSensor, AssemblyError> {
    if let DeviceEntry::Phone(section) = device {
        return open_phone(section, phone.take());
    }
    let (kind, name) = (device.name(), device.describe());
    let (silent_after, fallback_after) = device.patience();
    let thread = DeviceThread::new(kind)
        .named(name.clone())
        .silent_after(silent_after)
        .fallback_after(fallback_after);
    let watched = WatchedDevice::new(kind, name.clone(), thread.status());
    match started(device, thread) {
        Ok(sensor) => Ok((sensor, vec![watched])),
        Err(source) => Err(AssemblyError::Device { name, source }),
    }
}

/// The phone's sensors, uncalibrated.
fn open_phone(
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

fn started(
    device: &DeviceEntry,
    thread: DeviceThread,
) -> io::Result<Box<dyn Sensor<Measurements>>> {
    let mut owner = DeviceOwner::default();
    Ok(match device {
        DeviceEntry::Chip(section) => {
            let config = section.to_linux();
            Box::new(thread.start(move || config.open())?)
        }
        DeviceEntry::Iio(section) => {
            let config = section.to_linux();
            Box::new(thread.start(move || {
                owner.claim(&config.folder()?)?;
                Iio::open(&config)
            })?)
        }
        DeviceEntry::GnssSerial(section) => {
            let settings = section.to_linux();
            Box::new(thread.start(move || {
                owner.claim(&settings.line.path)?;
                GnssReceiver::open(&settings, monotonic)
            })?)
        }
        DeviceEntry::Gpsd(section) => {
            let settings = section.to_linux();
            Box::new(thread.start(move || Gpsd::open(&settings, monotonic))?)
        }
        DeviceEntry::RcReceiver(section) => {
            let (protocol, channels) = (section.protocol, section.channels());
            let line = protocol.line(&section.path);
            Box::new(thread.start(move || {
                owner.claim(&line.path)?;
                RcReceiver::open(&line, protocol, channels, monotonic)
            })?)
        }
        DeviceEntry::GpioSwitch(section) => {
            let (pin, pull, settles_in) = (section.pin(), section.pull, section.settles_in());
            Box::new(thread.start(move || {
                let line = GpioLine::input(&pin, pull)?;
                Ok(GpioSwitch::new(line, settles_in, Clock::default()))
            })?)
        }
        DeviceEntry::Phone(_) => return Err(io::ErrorKind::Unsupported.into()),
    })
}

/// Reports what is wrong with a device, and when it is read again: the loop's
/// events say that it is silent, and not why.
pub(super) struct DeviceReporter(Vec<WatchedDevice>);

impl DeviceReporter {
    pub(super) const fn new(devices: Vec<WatchedDevice>) -> Self {
        Self(devices)
    }
}

impl<C: Controller> Observer<C> for DeviceReporter {
    fn poll(&mut self, access: &mut Access<'_, C::Command>) {
        for device in &mut self.0 {
            let (kind, name) = (device.kind, &device.name);
            let trouble = device.status.trouble();
            let trouble = trouble.map(|trouble| format!("{kind}: {trouble}"));
            let waits_for = device.status.waits_for();
            let trouble = trouble.or_else(|| waits_for.map(|what| format!("{name}: {what}")));
            let is_quiet = device
                .quiet_until
                .is_some_and(|until| Instant::now() < until);
            if is_quiet || trouble == device.reported {
                continue;
            }
            let is_read = || format!("{name} is read");
            access
                .reports
                .remark(trouble.clone().unwrap_or_else(is_read));
            device.reported = trouble;
            device.quiet_until = Some(Instant::now() + QUIET);
        }
    }
}

#[cfg(test)]
mod tests {
    use fcc_linux::DeviceStatus;

    use super::*;
    use crate::flight::conformance::observer_conforms;

    #[test]
    fn an_observer_of_devices_conforms() {
        observer_conforms(|| {
            let name = "BMP388 at /dev/i2c-1 0x76".to_owned();
            let device = WatchedDevice::new("BMP388", name, DeviceStatus::default());
            Box::new(DeviceReporter::new(vec![device]))
        });
    }
}
