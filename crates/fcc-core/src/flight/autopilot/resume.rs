//! Taking up a flight that was cut off: by a crash, a kill or a watchdog.

use core::f64::consts::TAU;

use libm::round;

use super::Autopilot;
use crate::flight::Surfaces;
use crate::flight::guidance::{ActiveMode, ModeInput, Progress};
use crate::schema;

schema! {
    /// What was flown when a flight was cut off. Commanded right after engaging,
    /// it puts the autopilot where it was.
    ///
    /// ```
    /// use fcc_core::flight::guidance::{Mode, Progress};
    /// use fcc_core::flight::{AutopilotCommand, Resume, Surfaces};
    ///
    /// // 65 s into the pattern when the power went.
    /// let resume = Resume {
    ///     progress: Progress { mode: Mode::TimedPattern, elapsed_s: 65.0, ..Progress::default() },
    ///     surfaces: Surfaces { throttle: 0.7, ..Surfaces::default() },
    /// };
    /// let command = AutopilotCommand::Resume(resume);
    /// assert_eq!(command, AutopilotCommand::Resume(resume));
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Resume {
        /// How far guidance had come, as the record has it: the captured heading
        /// is on the compass, 0..2π.
        #[field(4)]
        pub progress: Progress,
        /// The surfaces that flew the aircraft: whoever gave the controls back may
        /// have centred them since.
        #[field(3)]
        pub surfaces: Surfaces,
    }
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
