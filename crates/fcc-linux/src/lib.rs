//! The sensors and servos of a Linux board as sensors and actuators of a loop:
//! chips on I²C and SPI, the kernel's own drivers (IIO), serial lines, PWM and
//! GPIO.
//!
//! Such devices are slow, and reading one waits: each is read in a thread of its
//! own, and the loop takes what has arrived from a ring without waiting.
//!
//! ```
//! use core::time::Duration;
//! use fcc_core::flight::Measurements;
//! use fcc_core::framework::Sensor;
//! use fcc_linux::{DeviceError, DeviceThread, RawValues, Sample, Source, monotonic};
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
//! # Structure
//!
//! | module | contents |
//! |---|---|
//! | [`fcc_device`] | the thread that opens, reads and reopens a device, the sensor that takes what it read, errors, the loop's clock |
//! | [`chip`] | chips on I²C and SPI |
//! | [`serial`] | satellite and RC receivers on serial lines |
//! | [`gpsd`] | fixes from the service gpsd |
//! | [`gpio`] | a switch, and the heartbeat for a multiplexer |
//! | [`servo`] | servos |
//! | [`probe`] | what is connected |
//! | [`iio`] | the kernel's own drivers of chips |
//! | `claim` | one entry or program for each device |
//! | `pace`, `device_clock` | when a sample is due; a device's own clock on the loop's |
//! | `traffic` | how much may arrive in a second |
#![forbid(unsafe_code)]

pub mod chip;
mod claim;
mod device_clock;
pub mod gpio;
pub mod gpsd;
pub mod iio;
mod pace;
pub mod probe;
pub mod serial;
pub mod servo;
mod traffic;

pub use claim::DeviceOwner;
pub use fcc_device::{
    Clock, DeviceError, DeviceSensor, DeviceStatus, DeviceThread, Measured, RawValues, Sample,
    Source, WAIT, monotonic,
};
