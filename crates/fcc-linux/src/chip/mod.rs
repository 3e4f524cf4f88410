//! Drivers of chips on I²C and SPI, for those without a driver of the kernel.
//!
//! Each has a file: its registers, how it is set up and recognized, and how its
//! numbers become SI units, with the data sheet that they are from. They are
//! written for the traits of `embedded-hal` and know nothing of threads and
//! clocks, which [`ChipSource`] adds.

pub mod bmp180;
pub mod bmp3;
mod bus;
pub mod icm42688;
mod inertial;
mod kind;
pub mod mpu6050;
pub mod ms4525do;
mod polled;
pub mod qmc5883l;
pub mod sdp3x;

pub use bus::{BusError, I2cBus, Registers, SpiBus};
pub(crate) use kind::open_spi;
pub use kind::{ChipConfig, ChipKind, Wiring};
pub use polled::{Chip, ChipSource, Measurement};
