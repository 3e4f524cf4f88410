//! The sensors of a board: their threads, and what is wrong with them.

use std::time::{Duration, Instant};

use fcc_core::flight::Measurements;
use fcc_core::framework::{Controller, Sensor};
use fcc_linux::iio::Iio;
use fcc_linux::{DeviceOwner, DeviceSensor, DeviceStatus, DeviceThread, RawValues};

use super::assemble::AssemblyError;
use super::calibrated::Calibrated;
use super::observer::{Access, Observer};
use crate::config::BoardSensor;

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

/// Starts the thread that reads a device. One that is not connected is no error:
/// it may be, later.
pub(super) fn board_sensor(
    board: &BoardSensor<'_>,
) -> Result<(Box<dyn Sensor<Measurements>>, WatchedDevice), AssemblyError> {
    let (sensor, watched) = uncalibrated(board)?;
    let sensor: Box<dyn Sensor<Measurements>> = match board.calibration().to_core() {
        Some(calibration) => Box::new(Calibrated::new(Box::new(sensor), &calibration)),
        None => Box::new(sensor),
    };
    Ok((sensor, watched))
}

/// The same without its calibration.
pub(crate) fn uncalibrated(
    board: &BoardSensor<'_>,
) -> Result<(DeviceSensor<RawValues>, WatchedDevice), AssemblyError> {
    let (kind, name) = (board.name(), board.describe());
    let (silent_after, fallback_after) = board.patience();
    let thread = DeviceThread::new(kind)
        .named(name.clone())
        .silent_after(silent_after)
        .fallback_after(fallback_after);
    let status = thread.status();
    let started = match board {
        BoardSensor::Chip(kind, section) => {
            let config = section.to_linux(*kind);
            thread.start(move || config.open())
        }
        BoardSensor::Iio(section) => {
            let config = section.to_linux();
            let mut owner = DeviceOwner::default();
            thread.start(move || {
                owner.claim(&config.folder()?)?;
                Iio::open(&config)
            })
        }
        BoardSensor::Phone(_) => return Err(AssemblyError::NoPhone),
    };
    match started {
        Ok(sensor) => Ok((sensor, WatchedDevice::new(kind, name, status))),
        Err(source) => Err(AssemblyError::Device { name, source }),
    }
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
