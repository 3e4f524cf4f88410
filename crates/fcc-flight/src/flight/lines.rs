//! Receivers and switches: their threads.

use std::io;

use fcc_core::flight::Measurements;
use fcc_core::framework::Sensor;
use fcc_linux::gpio::{GpioLine, GpioSwitch};
use fcc_linux::gpsd::Gpsd;
use fcc_linux::serial::{GnssReceiver, RcReceiver};
use fcc_linux::{Clock, DeviceOwner, DeviceThread, monotonic};

use super::assemble::AssemblyError;
use super::board::WatchedDevice;
use super::calibrated::Calibrated;
use crate::config::{CalibrationSection, LineSensor};

/// Starts the thread that reads a receiver or a switch. One that is not there is no error: it may
/// be, later.
pub(crate) fn line_sensor(
    line: &LineSensor<'_>,
) -> Result<(Box<dyn Sensor<Measurements>>, WatchedDevice), AssemblyError> {
    let (silent_after, fallback_after) = line.patience();
    let (kind, name) = (line.name(), line.describe());
    let thread = DeviceThread::new(kind)
        .named(name.clone())
        .silent_after(silent_after)
        .fallback_after(fallback_after);
    let watched = WatchedDevice::new(kind, name.clone(), thread.status());
    let sensor = started(line, thread).map_err(|source| AssemblyError::Device { name, source })?;
    Ok((sensor, watched))
}

fn started(
    line: &LineSensor<'_>,
    thread: DeviceThread,
) -> io::Result<Box<dyn Sensor<Measurements>>> {
    match line {
        LineSensor::Gnss(section) => {
            let settings = section.to_linux();
            let mut owner = DeviceOwner::default();
            let sensor = thread.start(move || {
                owner.claim(&settings.line.path)?;
                GnssReceiver::open(&settings, monotonic)
            })?;
            Ok(calibrated(Box::new(sensor), &section.calibration))
        }
        LineSensor::Gpsd(section) => {
            let settings = section.to_linux();
            let sensor = thread.start(move || Gpsd::open(&settings, monotonic))?;
            Ok(calibrated(Box::new(sensor), &section.calibration))
        }
        LineSensor::Rc(section) => {
            let (protocol, channels) = (section.protocol(), section.channels());
            let line = protocol.line(&section.path);
            let mut owner = DeviceOwner::default();
            let open = move || {
                owner.claim(&line.path)?;
                RcReceiver::open(&line, protocol, channels, monotonic)
            };
            Ok(Box::new(thread.start(open)?))
        }
        LineSensor::Switch(section) => {
            let (pin, pull, settles_in) = (section.pin(), section.pull(), section.settles_in());
            let open = move || {
                let line = GpioLine::input(&pin, pull)?;
                Ok(GpioSwitch::new(line, settles_in, Clock::default()))
            };
            Ok(Box::new(thread.start(open)?))
        }
    }
}

fn calibrated(
    sensor: Box<dyn Sensor<Measurements>>,
    calibration: &CalibrationSection,
) -> Box<dyn Sensor<Measurements>> {
    match calibration.to_core() {
        Some(calibration) => Box::new(Calibrated::new(sensor, &calibration)),
        None => sensor,
    }
}
