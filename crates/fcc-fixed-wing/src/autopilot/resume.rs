//! Continues a flight that was interrupted by a crash, a kill or a watchdog.

use core::f64::consts::TAU;

use libm::round;

use super::Autopilot;
use fcc_core::flight::{AltitudeReference, Surfaces};
use fcc_core::schema;
use fcc_guidance::route::TookOff;
use fcc_guidance::{ActiveMode, ModeInput, Progress};

schema! {
    /// What was flown when a flight was interrupted. Commanded directly after
    /// engaging, it restores the autopilot's state.
    ///
    /// ```
    /// use fcc_guidance::{Mode, Progress};
    /// use fcc_fixed_wing::{AutopilotCommand, Resume};
    /// use fcc_core::flight::Surfaces;
    ///
    /// // 65 s into the pattern when the power failed.
    /// let resume = Resume {
    ///     progress: Progress { mode: Mode::TimedPattern, elapsed_s: 65.0, ..Progress::default() },
    ///     surfaces: Surfaces { throttle: 0.7, ..Surfaces::default() },
    ///     ..Resume::default()
    /// };
    /// let command = AutopilotCommand::Resume(resume);
    /// assert_eq!(command, AutopilotCommand::Resume(resume));
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Resume {
        /// The progress of guidance as in the record: the captured heading is
        /// 0..2π.
        #[field(4)]
        pub progress: Progress,
        /// The last outputs; a release may have centred the surfaces since.
        #[field(3)]
        pub surfaces: Surfaces,
        /// The altimeter setting, Pa; none if it is to stay as it is.
        #[field(5)]
        pub altimeter_setting_pa: Option<f64>,
        /// What the altitude refers to.
        #[field(6)]
        pub altitude_reference: AltitudeReference,
        /// Where it took off, to land there again.
        #[field(7, column = "took_off_*")]
        pub took_off: TookOff,
    }
}

impl Autopilot {
    /// Continues what was flown. The compass does not give the number of full
    /// turns, so the target heading is taken within half a turn of the present
    /// heading.
    pub(super) fn resume(&mut self, resume: &Resume) {
        let (config, mut progress) = (self.config.guidance, resume.progress);
        if !progress.is_valid() || !resume.surfaces.is_valid() {
            return;
        }
        let input = ModeInput::Resume(progress.mode);
        if self
            .guidance
            .mode
            .mode()
            .after(input, config.mode())
            .is_none()
        {
            return;
        }
        self.supervisor.took_off = resume.took_off.known().or(self.supervisor.took_off);
        if self.resume_over_ground(progress.mode, progress.item) {
            self.guidance.resume_altimeter(resume);
            self.take_over(&resume.surfaces);
            return;
        }
        let Some(aimed) = ActiveMode::resume(&config, &progress).targets() else {
            return;
        };
        let off_rad = self.estimator.estimate().heading_rad - aimed.heading_rad;
        progress.captured.heading_rad += round(off_rad / TAU) * TAU;
        let airspeed_mps = progress.captured.airspeed_mps;
        progress.captured.airspeed_mps = self.config.envelope.allowed_airspeed(airspeed_mps);
        self.guidance.mode = ActiveMode::resume(&config, &progress);
        self.guidance.targets = self.guidance.mode.targets().unwrap_or(aimed);
        self.guidance.resume_altimeter(resume);
        let reference = resume.altitude_reference;
        let is_known = self.guidance.altimeter.datum_m(reference).is_some();
        self.guidance.reference = if is_known {
            reference
        } else {
            AltitudeReference::PressureLevel
        };
        // The captured altitude is not refined any further.
        self.guidance.capture = None;
        self.take_over(&resume.surfaces);
    }
}
