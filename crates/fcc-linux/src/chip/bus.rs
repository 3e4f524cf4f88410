//! A chip on a bus.

use std::io;

use embedded_hal::i2c::I2c;
use embedded_hal::spi::{Operation, SpiDevice};
use linux_embedded_hal::{I2CError, SPIError};
use nix::errno::Errno;

use crate::DeviceError;

/// An error of a bus that the operating system explains.
pub trait BusError {
    /// The same as an error of the operating system.
    fn into_io(self) -> io::Error;
}

impl BusError for I2CError {
    fn into_io(self) -> io::Error {
        match self.inner() {
            linux_embedded_hal::i2cdev::linux::LinuxI2CError::Errno(errno) => {
                io::Error::from_raw_os_error(*errno)
            }
            linux_embedded_hal::i2cdev::linux::LinuxI2CError::Io(error) => again(error),
        }
    }
}

impl BusError for SPIError {
    fn into_io(self) -> io::Error {
        again(self.inner())
    }
}

impl BusError for Errno {
    fn into_io(self) -> io::Error {
        self.into()
    }
}

/// The same error once more: they cannot be copied.
fn again(error: &io::Error) -> io::Error {
    error
        .raw_os_error()
        .map_or_else(|| error.kind().into(), io::Error::from_raw_os_error)
}

/// A chip with registers of eight bits.
pub trait Registers {
    /// Reads a register, and those after it.
    ///
    /// # Errors
    /// When the chip does not answer.
    fn read(&mut self, register: u8, into: &mut [u8]) -> Result<(), DeviceError>;

    /// Writes a register.
    ///
    /// # Errors
    /// When the chip does not answer.
    fn write(&mut self, register: u8, value: u8) -> Result<(), DeviceError>;

    /// Which chip it is, for people: path and address.
    fn device(&self) -> &str;

    /// The value of one register.
    ///
    /// # Errors
    /// When the chip does not answer.
    fn value(&mut self, register: u8) -> Result<u8, DeviceError> {
        let mut value = [0];
        self.read(register, &mut value)?;
        let [value] = value;
        Ok(value)
    }

    /// Asks the chip who it is, and returns which of the known it is.
    ///
    /// # Errors
    /// When it does not answer, or is another one.
    fn identify(&mut self, chip: &str, (register, known): (u8, &[u8])) -> Result<u8, DeviceError> {
        let found = self.value(register)?;
        if known.contains(&found) {
            return Ok(found);
        }
        let numbers: Vec<String> = known.iter().map(|id| format!("{id:#04x}")).collect();
        Err(DeviceError::WrongChip {
            device: self.device().to_owned(),
            expected: format!("{chip}, which has {}", numbers.join(" or ")),
            register,
            found,
        })
    }

    /// Writes registers, and reads them back.
    ///
    /// # Errors
    /// When the chip does not answer, or does not keep what was written.
    fn configure(&mut self, settings: &[(u8, u8)]) -> Result<(), DeviceError> {
        for (register, value) in settings {
            self.write(*register, *value)?;
            let kept = self.value(*register)?;
            if kept != *value {
                return Err(DeviceError::Refused {
                    device: self.device().to_owned(),
                    what: format!(
                        "register {register:#04x} was set to {value:#04x}, and has {kept:#04x}: \
                         check its supply and the wires"
                    ),
                });
            }
        }
        Ok(())
    }

    /// What a chip gave is not valid.
    fn malformed(&self, what: &'static str) -> DeviceError {
        DeviceError::Malformed {
            device: self.device().to_owned(),
            what,
        }
    }
}

/// A chip on an I²C bus.
#[derive(Debug)]
pub struct I2cBus<B> {
    bus: B,
    address: u8,
    device: String,
}

impl<B: I2c<Error: BusError>> I2cBus<B> {
    /// The chip with a 7-bit address; `path` is the bus, for people.
    pub fn new(bus: B, path: &str, address: u8) -> Self {
        Self {
            bus,
            address,
            device: format!("{path}, address {address:#04x}"),
        }
    }

    /// Writes a command.
    ///
    /// # Errors
    /// When the chip does not answer.
    pub fn send(&mut self, bytes: &[u8]) -> Result<(), DeviceError> {
        let sent = self.bus.write(self.address, bytes);
        sent.map_err(|error| self.failed("writing", error))
    }

    /// Reads what the chip sends without a register.
    ///
    /// # Errors
    /// When the chip does not answer.
    pub fn receive(&mut self, into: &mut [u8]) -> Result<(), DeviceError> {
        let received = self.bus.read(self.address, into);
        received.map_err(|error| self.failed("reading", error))
    }

    fn failed(&self, doing: &'static str, error: B::Error) -> DeviceError {
        DeviceError::Io {
            device: self.device.clone(),
            doing,
            source: error.into_io(),
        }
    }
}

impl<B: I2c<Error: BusError>> Registers for I2cBus<B> {
    fn read(&mut self, register: u8, into: &mut [u8]) -> Result<(), DeviceError> {
        let read = self.bus.write_read(self.address, &[register], into);
        read.map_err(|error| self.failed("reading", error))
    }

    fn write(&mut self, register: u8, value: u8) -> Result<(), DeviceError> {
        self.send(&[register, value])
    }

    fn device(&self) -> &str {
        &self.device
    }
}

/// A chip on an SPI bus, with its own chip select.
#[derive(Debug)]
pub struct SpiBus<S> {
    spi: S,
    device: String,
    dummy_bytes: usize,
}

/// Set in the register's number to read it, as all chips here have it.
const READ: u8 = 0x80;

impl<S: SpiDevice<Error: BusError>> SpiBus<S> {
    /// The chip of a bus; `path` is for people.
    pub fn new(spi: S, path: &str) -> Self {
        Self {
            spi,
            device: path.to_owned(),
            dummy_bytes: 0,
        }
    }

    /// Of a chip that sends so many meaningless bytes before what was asked for.
    #[must_use]
    pub fn with_dummy_bytes(mut self, dummy_bytes: usize) -> Self {
        self.dummy_bytes = dummy_bytes;
        self
    }

    fn failed(&self, doing: &'static str, error: S::Error) -> DeviceError {
        DeviceError::Io {
            device: self.device.clone(),
            doing,
            source: error.into_io(),
        }
    }
}

impl<S: SpiDevice<Error: BusError>> Registers for SpiBus<S> {
    fn read(&mut self, register: u8, into: &mut [u8]) -> Result<(), DeviceError> {
        let dummy = [0; 4];
        let command = [register | READ];
        let mut operations = [
            Operation::Write(&command),
            Operation::Write(dummy.get(..self.dummy_bytes).unwrap_or(&dummy)),
            Operation::Read(into),
        ];
        let read = self.spi.transaction(&mut operations);
        read.map_err(|error| self.failed("reading", error))
    }

    fn write(&mut self, register: u8, value: u8) -> Result<(), DeviceError> {
        let written = self.spi.write(&[register & !READ, value]);
        written.map_err(|error| self.failed("writing", error))
    }

    fn device(&self) -> &str {
        &self.device
    }
}
