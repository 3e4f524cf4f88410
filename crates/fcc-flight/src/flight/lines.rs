//! Receivers and switches: their threads.

use fcc_core::flight::Measurements;
use fcc_core::framework::Sensor;
use fcc_linux::gpio::{GpioLine, GpioSwitch};
use fcc_linux::gpsd::Gpsd;
use fcc_linux::serial::{GnssReceiver, RcReceiver};
use fcc_linux::{Clock, DeviceThread, monotonic};

use super::assemble::AssemblyError;
use super::board::WatchedDevice;
use super::calibrated::Calibrated;
use crate::config::{CalibrationSection, LineSensor};

const GNSS: &str = "GNSS receiver";
const GPSD: &str = "gpsd";
const RC: &str = "RC receiver";
const SWITCH: &str = "engage switch";

/// Starts the thread that reads a receiver or a switch. One that is not there is no error: it may
/// be, later.
pub(super) fn line_sensor(
    line: &LineSensor<'_>,
) -> Result<(Box<dyn Sensor<Measurements>>, WatchedDevice), AssemblyError> {
    let (silent_after, fallback_after) = line.patience();
    let thread = |name| {
        DeviceThread::new(name)
            .silent_after(silent_after)
            .fallback_after(fallback_after)
    };
    let failed = |name| move |source| AssemblyError::Device { name, source };
    match line {
        LineSensor::Gnss(section) => {
            let (thread, settings) = (thread(GNSS), section.to_linux());
            let watched = WatchedDevice::new(GNSS, thread.status());
            let sensor = thread.start(move || GnssReceiver::open(&settings, monotonic));
            let sensor = Box::new(sensor.map_err(failed(GNSS))?);
            Ok((calibrated(sensor, &section.calibration), watched))
        }
        LineSensor::Gpsd(section) => {
            let (thread, settings) = (thread(GPSD), section.to_linux());
            let watched = WatchedDevice::new(GPSD, thread.status());
            let sensor = thread.start(move || Gpsd::open(&settings, monotonic));
            let sensor = Box::new(sensor.map_err(failed(GPSD))?);
            Ok((calibrated(sensor, &section.calibration), watched))
        }
        LineSensor::Rc(section) => {
            let (thread, protocol) = (thread(RC), section.protocol());
            let (line, channels) = (protocol.line(&section.path), section.channels());
            let watched = WatchedDevice::new(RC, thread.status());
            let open = move || RcReceiver::open(&line, protocol, channels, monotonic);
            let sensor = thread.start(open).map_err(failed(RC))?;
            Ok((Box::new(sensor), watched))
        }
        LineSensor::Switch(section) => {
            let thread = thread(SWITCH);
            let watched = WatchedDevice::new(SWITCH, thread.status());
            let (pin, pull, settles_in) = (section.pin(), section.pull(), section.settles_in());
            let open = move || {
                let line = GpioLine::input(&pin, pull)?;
                Ok(GpioSwitch::new(line, settles_in, Clock::default()))
            };
            let sensor = thread.start(open).map_err(failed(SWITCH))?;
            Ok((Box::new(sensor), watched))
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
