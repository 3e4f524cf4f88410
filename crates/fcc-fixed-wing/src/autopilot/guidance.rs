//! Where to go next: mode and targets, the altimeter, and the set points that show them.

use super::capture::Capture;
use super::runway::RunwayControl;
use super::{AutopilotConfig, Resume};
use crate::Setpoints;
use fcc_core::blocks::wrap_two_pi;
use fcc_core::flight::{ALTIMETER_SETTINGS_PA, Altimeter, AltitudeReference};
use fcc_guidance::route::{RunwayDemand, RunwayPhase, RunwayReason};
use fcc_guidance::{ActiveMode, Mode, ModeInput, OverGroundMode, Targets};

/// Where to go next.
#[derive(Clone, Debug)]
pub(super) struct GuidanceState {
    pub(super) mode: ActiveMode,
    pub(super) targets: Targets,
    pub(super) capture: Option<Capture>,
    pub(super) altimeter: Altimeter,
    /// What the target altitude refers to.
    pub(super) reference: AltitudeReference,
    pub(super) on_runway: RunwayControl,
    /// Whether the target altitude is limited by the floor.
    pub(super) is_at_floor: bool,
    pub(super) setpoints: Setpoints,
}

impl GuidanceState {
    pub(super) fn new(config: &AutopilotConfig) -> Self {
        Self {
            mode: ActiveMode::None,
            targets: Targets::default(),
            capture: None,
            altimeter: config.altimeter,
            reference: AltitudeReference::PressureLevel,
            on_runway: RunwayControl::default(),
            is_at_floor: false,
            setpoints: Setpoints::default(),
        }
    }

    /// The take-off or landing that is flown.
    pub(super) fn runway(&self) -> Option<RunwayDemand> {
        self.mode.over_ground().and_then(OverGroundMode::runway)
    }

    /// Whether it is on the glide path of a landing, or beyond.
    pub(super) fn is_landing(&self) -> bool {
        self.runway()
            .is_some_and(|demand| !demand.takes_off && demand.phase != RunwayPhase::GoAround)
    }

    /// The pressure altitude of what the target altitude refers to, m.
    pub(super) fn datum_m(&self) -> f64 {
        // Only a field whose elevation is known is referred to.
        self.altimeter.datum_m(self.reference).unwrap_or(0.0)
    }

    /// Sets the altimeter. The target altitude is shifted with what it refers
    /// to.
    pub(super) fn set_altimeter(&mut self, setting_pa: f64) {
        if ALTIMETER_SETTINGS_PA.contains(&setting_pa) {
            let before_m = self.datum_m();
            self.altimeter.setting_pa = setting_pa;
            self.mode.shift_altitude(self.datum_m() - before_m);
        }
    }

    /// The set points of this tick: the targets, and what the loops make of them.
    pub(super) fn show(&mut self, roll_rad: f64, climb_rate_mps: f64, pitch_rad: f64) {
        self.setpoints = Setpoints {
            airspeed_mps: self.targets.airspeed_mps,
            heading_rad: wrap_two_pi(self.targets.heading_rad),
            altitude_m: self.targets.altitude_m,
            altitude_reference: self.reference,
            altitude_above_reference_m: self.targets.altitude_m - self.datum_m(),
            roll_rad,
            climb_rate_mps,
            pitch_rad,
            ..self.setpoints
        };
    }

    pub(super) fn resume_altimeter(&mut self, resume: &Resume) {
        let setting_pa = resume.altimeter_setting_pa;
        if let Some(pa) = setting_pa.filter(|pa| ALTIMETER_SETTINGS_PA.contains(pa)) {
            self.altimeter.setting_pa = pa;
        }
    }

    /// The pressure altitude of mean sea level, m.
    pub(super) fn sea_level_m(&self) -> f64 {
        // At sea level there is always a datum.
        let datum_m = self.altimeter.datum_m(AltitudeReference::SeaLevel);
        datum_m.unwrap_or(0.0)
    }

    /// Gives a landing up.
    pub(super) fn go_around(&mut self, config: &AutopilotConfig) {
        if self.after(config, ModeInput::GoAround).is_some() {
            self.mode.go_around(RunwayReason::Commanded);
        }
    }

    pub(super) fn after(&self, config: &AutopilotConfig, input: ModeInput) -> Option<Mode> {
        let is_rolling = self
            .runway()
            .is_some_and(|demand| demand.phase.is_on_wheels());
        if is_rolling {
            return None;
        }
        let configured = config.guidance.mode();
        self.mode.mode().after(input, configured)
    }

    /// The target altitude before it is limited, m.
    pub(super) fn demanded_altitude_m(&self) -> f64 {
        let targets = self.mode.targets();
        targets.map_or(self.targets.altitude_m, |targets| targets.altitude_m)
    }
}
