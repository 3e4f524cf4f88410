//! The loops of control, what they have found, and what was sent last.

use super::AutopilotConfig;
use super::actuation::Actuation;
use super::failsafe::KeptTrims;
use super::silence::StraightTrims;
use crate::control::{AirspeedLoop, AltitudeLoop, ElevatorTrim, HeadingLoop, Recovery, Schedule};
use fcc_core::flight::Surfaces;
use fcc_guidance::path::BankCommand;

/// The loops of control.
#[derive(Clone, Debug)]
pub(super) struct Loops {
    pub(super) heading: HeadingLoop,
    pub(super) altitude: AltitudeLoop,
    pub(super) airspeed: AirspeedLoop,
    /// The bank that a mode over the ground commands.
    pub(super) bank: BankCommand,
    pub(super) recovery: Recovery,
    pub(super) trim: ElevatorTrim,
    pub(super) actuation: Actuation,
    pub(super) kept_trims: KeptTrims,
    pub(super) straight: StraightTrims,
    /// The last outputs.
    pub(super) last: Surfaces,
    /// Whether the controls are those of a glide.
    pub(super) glides: bool,
}

impl Loops {
    pub(super) fn new(config: &AutopilotConfig) -> Self {
        Self {
            heading: HeadingLoop::new(config.heading),
            altitude: AltitudeLoop::new(config.altitude, &config.envelope),
            airspeed: AirspeedLoop::new(config.airspeed),
            bank: BankCommand::new(config.route.bank_rad, config.route.bank_rate_radps),
            recovery: Recovery::new(),
            trim: ElevatorTrim::new(None),
            actuation: Actuation::new(config.assumed_latency_s, config.pace),
            kept_trims: KeptTrims::default(),
            straight: StraightTrims::default(),
            last: Surfaces::default(),
            glides: false,
        }
    }

    /// The gains for an airspeed and the present latency.
    pub(super) fn schedule_at(&self, config: &AutopilotConfig, airspeed_mps: f64) -> Schedule {
        let schedule = Schedule::at(airspeed_mps, config.reference_airspeed_mps);
        self.actuation.slowed(schedule)
    }

    /// The trims that the loops have found, and the last throttle: an aircraft
    /// that is not measured does not roll on.
    pub(super) fn trims(&self) -> Surfaces {
        Surfaces {
            throttle: self.last.throttle,
            elevator: self.altitude.trim(),
            aileron: self.heading.aileron_trim(),
            rudder: self.heading.rudder_trim(),
            elevator_trim: self.trim.position(),
            ..Surfaces::IDLE
        }
    }
}
