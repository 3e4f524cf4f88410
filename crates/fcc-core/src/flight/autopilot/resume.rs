//! Taking up a flight that was cut off: by a crash, a kill or a watchdog.

use core::f64::consts::TAU;

use libm::round;

use super::Autopilot;
use crate::flight::AutopilotCommand;
use crate::flight::Surfaces;
use crate::flight::guidance::{ActiveMode, Mode, ModeInput, Progress, Targets};
use crate::schema;

schema! {
    /// What was flown when a flight was cut off. Ordered right after engaging, it
    /// puts the autopilot where it was.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Resume {
        /// What was aimed for; of a pattern, what it had captured. The heading is
        /// on the compass, 0..2π.
        #[field(1)]
        pub targets: Targets,
        /// For how long the configured pattern had been flown by now, s; none (not
        /// a number) if the targets are to be held.
        #[field(2)]
        pub pattern_s: Option<f64>,
        /// The surfaces that flew the aircraft: whoever gave the controls back may
        /// have centred them since.
        #[field(3)]
        pub surfaces: Surfaces,
    }
}

impl Resume {
    /// How far guidance had come.
    fn progress(&self) -> Progress {
        let mode = match self.pattern_s {
            Some(_) => Mode::TimedPattern,
            None => Mode::Hold,
        };
        Progress {
            mode,
            elapsed_s: self.pattern_s.unwrap_or(0.0),
            captured: self.targets,
            ..Progress::default()
        }
    }
}

impl AutopilotCommand {
    /// Whether it ends a pattern that is flown.
    pub fn ends_pattern(&self) -> bool {
        match *self {
            Self::Airspeed(value) | Self::Heading(value) | Self::Altitude(value) => {
                value.is_finite()
            }
            Self::Resume(_) => false,
        }
    }
}

impl Autopilot {
    /// Takes up what was flown. The compass does not tell how often the
    /// aircraft has turned about: the heading that is aimed for now is taken
    /// within half a turn of where the nose points.
    pub(super) fn resume(&mut self, resume: &Resume) {
        let (config, mut progress) = (&self.config.guidance, resume.progress());
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
