//! NXP PCA9685, 16 PWM outputs of 12 bits on I²C, as on the "servo hats" of small
//! computers.
//!
//! Data sheet: NXP, *PCA9685, 16-channel, 12-bit PWM Fm+ I²C-bus LED controller*,
//! Rev. 4 (2015): registers in 7.3, the prescale value in 7.3.5.

use std::fs::File;
use std::io;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use embedded_hal::i2c::I2c;
use linux_embedded_hal::I2cdev;

use super::PulseOutputs;
use crate::DeviceError;
use crate::chip::BusError;
use crate::claim::claim;

const MODE1: u8 = 0x00;
const MODE2: u8 = 0x01;
/// The first of four registers of output 0.
const LED0_ON_L: u8 = 0x06;
const PRE_SCALE: u8 = 0xfe;

const SLEEP: u8 = 0x10;
/// The register's address is counted up within a transfer.
const AUTO_INCREMENT: u8 = 0x20;
/// Outputs drive both ways.
const TOTEM_POLE: u8 = 0x04;
/// Bit 4 of a count's high byte: always off.
const FULL_OFF: u8 = 0x10;
const COUNTS: f64 = 4_096.0;
const OUTPUTS: u8 = 16;
/// After SLEEP the oscillator needs 500 µs.
const OSCILLATOR_STARTS: Duration = Duration::from_micros(500);
/// How often it is asked whether it has lost its registers with its power.
const CHECKED_EVERY: Duration = Duration::from_secs(1);

/// A chip, and which of its outputs are used.
#[derive(Clone, PartialEq, Debug)]
pub struct Pca9685Settings {
    /// Where it is, for messages: bus and address.
    pub device: String,
    /// 0x40 to 0x7F; 0x40 without solder bridges.
    pub address: u8,
    /// Pulses in a second, 24 to 1,526; 50 for most servos.
    pub rate_hz: f64,
    /// 25 MHz by the data sheet, several percent off in most chips: pulses are as
    /// much too short or too long.
    pub oscillator_hz: f64,
    /// The output of each channel, 0 to 15.
    pub outputs: Vec<u8>,
}

/// A chip that is set up.
#[derive(Debug)]
pub struct Pca9685<B> {
    bus: B,
    settings: Pca9685Settings,
    prescale: u8,
    checked: Instant,
    /// That no other daemon drives it.
    claim: Option<File>,
}

impl Pca9685<I2cdev> {
    /// Opens the bus, and sets the chip up.
    ///
    /// # Errors
    /// See [`open`](Self::open), and when there is no such bus.
    pub fn open_at(bus: &Path, settings: Pca9685Settings) -> Result<Self, DeviceError> {
        let claim = claim(bus, settings.address.into())?;
        let mut this = Self::open(open(bus)?, settings)?;
        this.claim = Some(claim);
        Ok(this)
    }

    /// Opens the bus of a chip that another process has set up.
    ///
    /// # Errors
    /// See [`of_another_process`](Self::of_another_process).
    pub fn of_another_process_at(
        bus: &Path,
        settings: Pca9685Settings,
    ) -> Result<Self, DeviceError> {
        Self::of_another_process(open(bus)?, settings)
    }
}

fn open(bus: &Path) -> Result<I2cdev, DeviceError> {
    I2cdev::new(bus).map_err(|error| DeviceError::Open {
        device: bus.display().to_string(),
        source: io::Error::from(error),
    })
}

/// round(oscillator / (4096 x rate)) - 1, 3 at least (7.3.5, equation 1).
fn prescale(oscillator_hz: f64, rate_hz: f64) -> u8 {
    let divider = (oscillator_hz / (COUNTS * rate_hz)).round() - 1.0;
    divider.clamp(3.0, 255.0) as u8
}

impl<B: I2c<Error: BusError>> Pca9685<B> {
    /// Sets the chip up, without a pulse yet.
    ///
    /// # Errors
    /// When nothing answers, or an output is none.
    pub fn open(bus: B, settings: Pca9685Settings) -> Result<Self, DeviceError> {
        let mut this = Self::checked(bus, settings)?;
        this.set_up()?;
        Ok(this)
    }

    /// A chip that another process has set up, whose pulses go on until others are
    /// written; it is set up if it has lost that.
    ///
    /// # Errors
    /// See [`open`](Self::open).
    pub fn of_another_process(bus: B, settings: Pca9685Settings) -> Result<Self, DeviceError> {
        let mut this = Self::checked(bus, settings)?;
        if !this.is_set_up()? {
            this.set_up()?;
        }
        Ok(this)
    }

    fn checked(bus: B, settings: Pca9685Settings) -> Result<Self, DeviceError> {
        if let Some(output) = settings.outputs.iter().find(|output| **output >= OUTPUTS) {
            return Err(DeviceError::Refused {
                device: settings.device,
                what: format!("it has no output {output}: choose 0 to 15"),
            });
        }
        Ok(Self {
            bus,
            prescale: prescale(settings.oscillator_hz, settings.rate_hz),
            settings,
            checked: Instant::now(),
            claim: None,
        })
    }

    /// The rate can be set only while it sleeps.
    fn set_up(&mut self) -> Result<(), DeviceError> {
        self.send(&[MODE1, SLEEP | AUTO_INCREMENT])?;
        self.send(&[PRE_SCALE, self.prescale])?;
        self.send(&[MODE2, TOTEM_POLE])?;
        for output in self.settings.outputs.clone() {
            self.set(output, None)?;
        }
        self.send(&[MODE1, AUTO_INCREMENT])?;
        thread::sleep(OSCILLATOR_STARTS);
        Ok(())
    }

    fn set(&mut self, output: u8, pulse_us: Option<f64>) -> Result<(), DeviceError> {
        let count_us = (f64::from(self.prescale) + 1.0) / self.settings.oscillator_hz * 1e6;
        let [low, high] = match pulse_us {
            Some(us) => {
                let counts = (us / count_us).round().clamp(0.0, COUNTS - 1.0);
                (counts as u16).to_le_bytes()
            }
            None => [0, FULL_OFF],
        };
        // On at count 0, off at this one.
        self.send(&[LED0_ON_L + 4 * output, 0, 0, low, high])
    }

    /// Whether it still is as it was set up.
    fn check(&mut self) -> Result<(), DeviceError> {
        if self.checked.elapsed() < CHECKED_EVERY {
            return Ok(());
        }
        self.checked = Instant::now();
        if self.is_set_up()? {
            return Ok(());
        }
        Err(DeviceError::Refused {
            device: self.settings.device.clone(),
            what: "it has lost its settings: check the power of the chip (VCC)".into(),
        })
    }

    fn is_set_up(&mut self) -> Result<bool, DeviceError> {
        let mut mode = [0];
        let address = self.settings.address;
        let read = self.bus.write_read(address, &[MODE1], &mut mode);
        read.map_err(|error| self.error("reading MODE1", error))?;
        Ok(mode == [AUTO_INCREMENT])
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), DeviceError> {
        let sent = self.bus.write(self.settings.address, bytes);
        sent.map_err(|error| self.error("writing", error))
    }

    fn error(&self, doing: &'static str, error: B::Error) -> DeviceError {
        DeviceError::Io {
            device: self.settings.device.clone(),
            doing,
            source: error.into_io(),
        }
    }
}

impl<B: I2c<Error: BusError> + Send> PulseOutputs for Pca9685<B> {
    fn write(&mut self, pulses_us: &[Option<f64>]) -> Result<(), DeviceError> {
        self.check()?;
        for (output, pulse_us) in self.settings.outputs.clone().iter().zip(pulses_us) {
            self.set(*output, *pulse_us)?;
        }
        Ok(())
    }
}
