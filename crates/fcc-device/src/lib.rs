//! A device as a sensor of a loop.
//!
//! Devices are slow, and reading one waits: each is read in a thread of its own, and
//! the loop takes what has arrived from a ring without waiting. The adapters of a
//! Linux board and of a phone have their devices here in common.
//!
//! ```
//! use core::time::Duration;
//! use fcc_core::flight::Measurements;
//! use fcc_core::framework::Sensor;
//! use fcc_device::{DeviceError, DeviceThread, RawValues, Sample, Source, monotonic};
//!
//! /// A barometer that shows the standard atmosphere's pressure 20 times a second.
//! struct Barometer;
//!
//! impl Source for Barometer {
//!     type Value = RawValues;
//!
//!     fn read(&mut self) -> Result<Option<Sample<RawValues>>, DeviceError> {
//!         std::thread::sleep(Duration::from_millis(50));
//!         let value = RawValues { static_pressure_pa: Some(101_325.0), ..RawValues::NONE };
//!         Ok(Some(Sample::new(monotonic(), value)))
//!     }
//! }
//!
//! let sensor = DeviceThread::new("barometer").start(|| Ok(Barometer))?;
//! let sensor: Box<dyn Sensor<Measurements>> = Box::new(sensor);
//! # drop(sensor);
//! # Ok::<(), std::io::Error>(())
//! ```
//!
//! | module | contents |
//! |---|---|
//! | `source` | what a device gives: [`Source`], [`Sample`], [`Measured`], [`RawValues`] |
//! | `device_thread`, `device_sensor` | the thread that opens, reads and reopens a device; the sensor that takes what it read |
//! | `fix` | fixes of satellite navigation, and what some receivers leave out of them |
//! | `error` | [`DeviceError`]: what went wrong, where, what to do |
//! | `clock` | the loop's clock |
#![forbid(unsafe_code)]

mod clock;
mod device_sensor;
mod device_thread;
mod error;
mod fix;
mod source;

pub use clock::{Clock, monotonic};
pub use device_sensor::DeviceSensor;
pub use device_thread::{DeviceStatus, DeviceThread};
pub use error::DeviceError;
pub use fix::{EpochOrder, VerticalSpeed, velocity_over_ground};
pub use source::{Measured, NO_FIX, REPEATED_FIX, RawValues, SLOW_FIXES, Sample, Source, WAIT};
