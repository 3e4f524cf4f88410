//! PWM outputs of the operating system, by the files of `/sys/class/pwm`
//! (Documentation/ABI/testing/sysfs-class-pwm and Documentation/driver-api/pwm.rst
//! of the Linux kernel).

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use super::PulseOutputs;
use crate::DeviceError;
use crate::claim::claim;

/// Files of a new output belong to root until a rule of udev has given them to the
/// user's group.
const EXPORTED_WITHIN: Duration = Duration::from_secs(1);
const TRIED_EVERY: Duration = Duration::from_millis(20);

/// An output: a chip's folder, such as `/sys/class/pwm/pwmchip0`, and its number
/// there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PwmOutput {
    /// The chip's folder.
    pub chip: PathBuf,
    /// From 0.
    pub number: u32,
}

impl PwmOutput {
    fn folder(&self) -> PathBuf {
        self.chip.join(format!("pwm{}", self.number))
    }
}

/// Outputs of the operating system.
#[derive(Debug)]
pub struct SysfsPwm {
    outputs: Vec<Output>,
}

#[derive(Debug)]
struct Output {
    folder: PathBuf,
    /// What was written last; none while it is not enabled.
    duty_ns: Option<u64>,
    /// That no other daemon drives it.
    claim: Option<File>,
    /// Whether this was written here.
    is_known: bool,
}

impl SysfsPwm {
    /// Exports and sets up outputs, without a pulse yet; `rate_hz` is the pulses
    /// in a second, 50 for most servos.
    ///
    /// # Errors
    /// When one cannot be exported or set.
    pub fn open(outputs: &[PwmOutput], rate_hz: f64) -> Result<Self, DeviceError> {
        let period_ns = (1e9 / rate_hz).round() as u64;
        let open = |output: &PwmOutput| Output::open(output, period_ns);
        let outputs = outputs.iter().map(open).collect::<Result<_, _>>()?;
        Ok(Self { outputs })
    }
}

impl SysfsPwm {
    /// Outputs that another process has set up, which go on until a pulse is
    /// written.
    pub fn of_another_process(outputs: &[PwmOutput]) -> Self {
        let outputs = outputs.iter().map(|output| Output {
            folder: output.folder(),
            duty_ns: None,
            is_known: false,
            claim: None,
        });
        Self {
            outputs: outputs.collect(),
        }
    }
}

impl Output {
    fn open(output: &PwmOutput, period_ns: u64) -> Result<Self, DeviceError> {
        let folder = output.folder();
        if !folder.exists() {
            let export = output.chip.join("export");
            let exported = write(&export, &output.number.to_string());
            exported.map_err(|source| DeviceError::Open {
                device: export.display().to_string(),
                source,
            })?;
        }
        let mut this = Self {
            folder,
            duty_ns: None,
            claim: None,
            is_known: true,
        };
        let mut waited = Duration::ZERO;
        while let Err(error) = this.set_up(period_ns) {
            if waited >= EXPORTED_WITHIN || matches!(error, DeviceError::Refused { .. }) {
                return Err(error);
            }
            thread::sleep(TRIED_EVERY);
            waited += TRIED_EVERY;
        }
        Ok(this)
    }

    /// Before anything is written to it, it is claimed.
    fn set_up(&mut self, period_ns: u64) -> Result<(), DeviceError> {
        if self.claim.is_none() {
            self.claim = Some(claim(&self.folder.join("period"), 0)?);
        }
        self.set_period(period_ns)
            .map_err(|error| self.error("setting up the output", error))
    }

    /// A period must never be shorter than a pulse, and none can be set before the
    /// first period.
    fn set_period(&self, period_ns: u64) -> io::Result<()> {
        let period = fs::read_to_string(self.folder.join("period"))?;
        let period: u64 = period.trim().parse().unwrap_or_default();
        if period != 0 {
            write(&self.folder.join("enable"), "0")?;
            write(&self.folder.join("duty_cycle"), "0")?;
        }
        if period != period_ns {
            write(&self.folder.join("period"), &period_ns.to_string())?;
        }
        Ok(())
    }

    fn set(&mut self, pulse_us: Option<f64>) -> io::Result<()> {
        let duty_ns = pulse_us.map(|us| (us * 1e3).round() as u64);
        if self.is_known && duty_ns == self.duty_ns {
            return Ok(());
        }
        if let Some(duty_ns) = duty_ns {
            write(&self.folder.join("duty_cycle"), &duty_ns.to_string())?;
        }
        if !self.is_known || duty_ns.is_some() != self.duty_ns.is_some() {
            let enable = if duty_ns.is_some() { "1" } else { "0" };
            write(&self.folder.join("enable"), enable)?;
        }
        (self.duty_ns, self.is_known) = (duty_ns, true);
        Ok(())
    }

    fn error(&self, doing: &'static str, source: io::Error) -> DeviceError {
        DeviceError::Io {
            device: self.folder.display().to_string(),
            doing,
            source,
        }
    }
}

impl PulseOutputs for SysfsPwm {
    fn write(&mut self, pulses_us: &[Option<f64>]) -> Result<(), DeviceError> {
        for (output, pulse_us) in self.outputs.iter_mut().zip(pulses_us) {
            let set = output.set(*pulse_us);
            set.map_err(|source| output.error("writing a pulse", source))?;
        }
        Ok(())
    }
}

/// Writes to a file that is there.
fn write(path: &PathBuf, value: &str) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).truncate(true).open(path)?;
    file.write_all(value.as_bytes())
}
