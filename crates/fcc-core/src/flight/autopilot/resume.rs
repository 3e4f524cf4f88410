//! Taking up a flight that was cut off: by a crash, a kill or a watchdog.

use core::f64::consts::TAU;

use libm::round;

use super::Autopilot;
use crate::flight::Surfaces;
use crate::flight::guidance::{ActiveMode, ModeInput, Progress};

/// What was flown when a flight was cut off. Ordered right after engaging, it
/// puts the autopilot where it was.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resume {
    /// How far guidance had come, as the record has it: the captured heading
    /// is on the compass, 0..2π.
    pub progress: Progress,
    /// The surfaces that flew the aircraft: whoever gave the controls back may
    /// have centred them since.
    pub surfaces: Surfaces,
}

impl Autopilot {
    /// Takes up what was flown. The compass does not tell how often the
    /// aircraft has turned about: the heading that is aimed for now is taken
    /// within half a turn of where the nose points.
    pub(super) fn resume(&mut self, resume: &Resume) {
        let (config, mut progress) = (&self.config.guidance, resume.progress);
        if !progress.is_valid() || !resume.surfaces.is_valid() {
            return;
        }
        let input = ModeInput::Resume(progress.mode);
        if self.guidance.mode().after(input, config.mode()).is_none() {
            return;
        }
        let Some(aimed) = ActiveMode::resume(config, &progress).targets() else {
            return;
        };
        let off_rad = self.navigation.estimate().heading_rad - aimed.heading_rad;
        progress.captured.heading_rad += round(off_rad / TAU) * TAU;
        let airspeed_mps = progress.captured.airspeed_mps;
        progress.captured.airspeed_mps = self.config.envelope.allowed_airspeed(airspeed_mps);
        self.guidance = ActiveMode::resume(config, &progress);
        self.targets = self.guidance.targets().unwrap_or(aimed);
        // What was captured is known as well as it ever will be.
        self.capture = None;
        self.take_over(&resume.surfaces);
    }
}
