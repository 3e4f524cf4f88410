//! A stand-in for the kernel's files of PWM.

use std::fs;
use std::path::PathBuf;

use fcc_linux::servo::PwmOutput;
use tempfile::TempDir;

/// A folder like a chip's in `/sys/class/pwm`, whose outputs are exported.
pub(crate) struct PwmFolder(pub(crate) TempDir);

impl PwmFolder {
    pub(crate) fn new(outputs: u32, period: &str) -> Self {
        let this = Self(TempDir::new().unwrap());
        for number in 0..outputs {
            fs::create_dir(this.output(number)).unwrap();
            for (file, value) in [("period", period), ("duty_cycle", "0"), ("enable", "0")] {
                fs::write(this.output(number).join(file), value).unwrap();
            }
        }
        this
    }

    pub(crate) fn chip(&self) -> PathBuf {
        self.0.path().join("pwmchip0")
    }

    pub(crate) fn output(&self, number: u32) -> PathBuf {
        let chip = self.chip();
        let _ = fs::create_dir(&chip);
        chip.join(format!("pwm{number}"))
    }

    pub(crate) fn has(&self, number: u32, file: &str) -> String {
        fs::read_to_string(self.output(number).join(file)).unwrap_or_default()
    }

    pub(crate) fn outputs(&self, count: u32) -> Vec<PwmOutput> {
        let output = |number| PwmOutput {
            chip: self.chip(),
            number,
        };
        (0..count).map(output).collect()
    }
}
