//! A line of a GPIO chip.

use std::io;
use std::path::PathBuf;

use gpiocdev::Request;
use gpiocdev::line::{Bias, Value};
use nix::errno::Errno;
use serde::{Deserialize, Serialize};

use crate::DeviceError;
use crate::servo::HeartbeatLine;

/// Which line.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct GpioPin {
    /// Such as `/dev/gpiochip0`.
    pub chip: PathBuf,
    /// The line's number there, which is not that of the header's pin.
    pub line: u32,
    /// Whether it is active while it is low.
    pub is_active_low: bool,
}

/// The resistor of a line that is read.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pull {
    /// To the supply.
    Up,
    /// To ground.
    Down,
    /// None on the board's side.
    None,
}

/// A level that can be read.
pub trait LevelLine {
    /// Whether it is active.
    ///
    /// # Errors
    /// When it cannot be read.
    fn is_active(&mut self) -> Result<bool, DeviceError>;
}

/// A line that this program has claimed.
#[derive(Debug)]
pub struct GpioLine {
    request: Request,
    device: String,
}

impl GpioLine {
    /// Claims a line to read it.
    ///
    /// # Errors
    /// When there is no such line, or another program has it.
    pub fn input(pin: &GpioPin, pull: Pull) -> Result<Self, DeviceError> {
        let bias = match pull {
            Pull::Up => Bias::PullUp,
            Pull::Down => Bias::PullDown,
            Pull::None => Bias::Disabled,
        };
        Self::open(pin, |request| {
            request.as_input().with_bias(bias);
        })
    }

    /// Claims a line to drive it, inactive.
    ///
    /// # Errors
    /// See [`input`](Self::input).
    pub fn output(pin: &GpioPin) -> Result<Self, DeviceError> {
        Self::open(pin, |request| {
            request.as_output(Value::Inactive);
        })
    }

    fn open(
        pin: &GpioPin,
        set: impl FnOnce(&mut gpiocdev::request::Builder),
    ) -> Result<Self, DeviceError> {
        let device = format!("{}, line {}", pin.chip.display(), pin.line);
        let mut builder = Request::builder();
        builder
            .on_chip(&pin.chip)
            .with_consumer("fccd")
            .with_line(pin.line);
        set(&mut builder);
        if pin.is_active_low {
            builder.as_active_low();
        }
        match builder.request() {
            Ok(request) => Ok(Self { request, device }),
            Err(error) => Err(not_claimed(device, io_error(&error))),
        }
    }

    fn failed(&self, doing: &'static str, error: &gpiocdev::Error) -> DeviceError {
        DeviceError::Io {
            device: self.device.clone(),
            doing,
            source: io_error(error),
        }
    }
}

impl LevelLine for GpioLine {
    fn is_active(&mut self) -> Result<bool, DeviceError> {
        let value = self.request.lone_value();
        let value = value.map_err(|error| self.failed("reading", &error))?;
        Ok(value == Value::Active)
    }
}

impl HeartbeatLine for GpioLine {
    fn set(&mut self, is_high: bool) -> Result<(), DeviceError> {
        let value = if is_high {
            Value::Active
        } else {
            Value::Inactive
        };
        let set = self.request.set_lone_value(value);
        set.map_err(|error| self.failed("writing", &error))
    }
}

/// Why a line could not be claimed: what the kernel says of lines in particular.
fn not_claimed(device: String, source: io::Error) -> DeviceError {
    let what = match source.raw_os_error().map(Errno::from_raw) {
        Some(Errno::EBUSY) => {
            "another program or a driver of the kernel has this line, `gpioinfo` shows which: end \
             that, or choose another line"
        }
        Some(Errno::EINVAL) => {
            "the chip has no such line, `gpioinfo` lists them, or no resistor for it: choose \
             pull = \"none\", with one of your own"
        }
        _ => return DeviceError::Open { device, source },
    };
    DeviceError::Refused {
        device,
        what: what.to_owned(),
    }
}

/// The operating system's error behind one of the crate's.
fn io_error(error: &gpiocdev::Error) -> io::Error {
    match error {
        gpiocdev::Error::Os(errno) | gpiocdev::Error::Uapi(_, gpiocdev_uapi::Error::Os(errno)) => {
            io::Error::from_raw_os_error(errno.0)
        }
        // What is there is no chip of GPIO.
        gpiocdev::Error::GpioChip(..) => Errno::ENOTTY.into(),
        other => io::Error::other(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The errors of `GPIO_V2_GET_LINE_IOCTL` (the kernel's userspace API manual).
    #[test]
    fn a_line_that_is_taken_or_missing_is_explained() {
        for (errno, expected) in [
            (Errno::EBUSY, "/dev/gpiochip0, line 7: another program or a"),
            (
                Errno::EINVAL,
                "/dev/gpiochip0, line 7: the chip has no such line, ",
            ),
            (
                Errno::EACCES,
                "cannot open /dev/gpiochip0, line 7: Permission denied",
            ),
        ] {
            let error = not_claimed("/dev/gpiochip0, line 7".to_owned(), errno.into());
            assert!(error.to_string().starts_with(expected), "{error}");
        }
    }

    #[test]
    fn a_chip_that_is_missing_or_none_is_explained() {
        for (chip, expected) in [
            (
                "/dev/gpiochip-none",
                "cannot open /dev/gpiochip-none, line 7: No such file or directory (os error 2); \
                 check the path",
            ),
            ("/dev/null", "cannot open /dev/null, line 7: "),
        ] {
            let pin = GpioPin {
                chip: chip.into(),
                line: 7,
                is_active_low: true,
            };
            let errors = [
                GpioLine::input(&pin, Pull::Up).unwrap_err(),
                GpioLine::output(&pin).unwrap_err(),
            ];
            for error in errors {
                let message = error.to_string();
                assert!(message.starts_with(expected), "{message}");
            }
        }
    }
}
