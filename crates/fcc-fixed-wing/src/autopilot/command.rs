//! Commands to the autopilot.

use core::fmt;

use super::{Autopilot, PlanReplacement, Resume};
use fcc_core::blocks::wrap_pi;
use fcc_core::flight::{AltitudeReference, Position};
use fcc_core::schema;
use fcc_core::units::{FOOT_M, HECTOPASCAL_PA, KNOT_MPS};
use fcc_guidance::{Mode, ModeInput};

schema! {
    /// A command to the autopilot. Those of a set point change it, end a pattern
    /// and leave the other set points unchanged; without being engaged they are
    /// ignored.
    ///
    /// ```
    /// use fcc_fixed_wing::{Autopilot, AutopilotCommand, AutopilotConfig};
    /// use fcc_core::framework::Controller;
    ///
    /// let mut autopilot = Autopilot::new(AutopilotConfig::default());
    /// autopilot.command(&AutopilotCommand::Altitude(960.12));
    /// // Without being engaged it ignores commands.
    /// assert_eq!(autopilot.setpoints().altitude_m, 0.0);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug)]
    #[name("Command")]
    #[non_exhaustive]
    pub enum AutopilotCommand {
        /// Indicated airspeed, m/s; limited to the envelope.
        #[field(1)]
        Airspeed(airspeed_mps: f64),
        /// Magnetic heading, rad; the turn takes the shorter way from the
        /// present heading.
        #[field(2)]
        Heading(heading_rad: f64),
        /// Altitude above mean sea level by the altimeter setting, m.
        #[field(3)]
        Altitude(altitude_m: f64),
        /// Continue what was flown before a restart.
        #[field(4)]
        Resume(resume: Resume),
        /// Pressure altitude, m.
        #[field(5)]
        PressureAltitude(pressure_altitude_m: f64),
        /// Height above the field's elevation by the altimeter setting, m;
        /// ignored if the elevation is not configured.
        #[field(6)]
        Height(height_m: f64),
        /// Altimeter setting (QNH), Pa, within [`ALTIMETER_SETTINGS_PA`], in
        /// every state; outside it is ignored. An altitude or height that is
        /// held is held by the new setting; a pattern and a pressure altitude
        /// are unaffected.
        ///
        /// [`ALTIMETER_SETTINGS_PA`]: fcc_core::flight::ALTIMETER_SETTINGS_PA
        #[field(7)]
        AltimeterSetting(altimeter_setting_pa: f64),
        /// Fly the plan from this item on, from 1; 0: from where it was left, or from
        /// its begin. Ignored without a plan, or without this item.
        #[field(8)]
        Plan(plan_item: u16),
        /// Wait: circle beside where the aircraft is. A plan is left, and is
        /// continued by `Plan`.
        #[field(9)]
        Pause,
        /// Fly to a place at an altitude above mean sea level by the altimeter
        /// setting, and circle around it. Ignored without a position.
        #[field(10)]
        GoTo(go_to: Position),
        /// Fly to the nearest of home and the plan's rally points, and circle
        /// around it. Ignored without a position.
        #[field(11)]
        ReturnHome,
        /// The next command will follow within this time, s, or this commander is lost;
        /// 0 ends the promise.
        #[field(12)]
        Heartbeat(within_s: f64),
        /// Give the landing up: climb, and land again. Ignored unless it is landing, and
        /// on the wheels.
        #[field(13)]
        GoAround,
        /// Fly another plan, which was prepared; answered by a notice. Without being
        /// engaged, low over a runway and in a landing it is refused.
        #[field(14)]
        ReplacePlan(replace_plan: PlanReplacement),
        /// Land: at the nearest landing of the plan, or without one where the aircraft
        /// took off, in the same direction.
        #[field(15)]
        Land,
    }
}

/// In the units in which commands are given: knots, degrees, feet, hectopascals.
impl fmt::Display for AutopilotCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Airspeed(mps) => write!(f, "airspeed {:.1} kt", mps / KNOT_MPS),
            Self::Heading(rad) => write!(f, "heading {:.1}°", compass_deg(*rad)),
            Self::Altitude(m) => write!(f, "altitude {:.0} ft", m / FOOT_M),
            Self::PressureAltitude(m) => write!(f, "pressure altitude {:.0} ft", m / FOOT_M),
            Self::Height(m) => write!(f, "height {:.0} ft", m / FOOT_M),
            Self::AltimeterSetting(pa) => {
                write!(f, "altimeter setting {:.2} hPa", pa / HECTOPASCAL_PA)
            }
            Self::Plan(0) => f.write_str("plan, from where it was left"),
            Self::Plan(item) => write!(f, "plan, item {item}"),
            Self::Pause => f.write_str("pause"),
            Self::GoTo(place) => write!(
                f,
                "go to {:.6}°, {:.6}°, {:.0} ft",
                place.latitude_rad.to_degrees(),
                place.longitude_rad.to_degrees(),
                place.altitude_m / FOOT_M
            ),
            Self::ReturnHome => f.write_str("return home"),
            Self::Heartbeat(0.0) => f.write_str("heartbeat: the promise ends"),
            Self::Heartbeat(within_s) => write!(f, "heartbeat: the next within {within_s:.1} s"),
            Self::GoAround => f.write_str("go around"),
            Self::Land => f.write_str("land"),
            Self::ReplacePlan(plan) => {
                // As many digits of the hash as tables have.
                let digits = plan.plan_hash >> 16;
                write!(f, "plan {digits:012x}, from item {}", plan.item)
            }
            Self::Resume(Resume { progress, .. }) => {
                write!(f, "resume {progress} after {:.1} s", progress.elapsed_s)
            }
        }
    }
}

impl AutopilotCommand {
    /// Whether it says what is flown: only while engaged.
    pub const fn is_of_mode(&self) -> bool {
        !matches!(self, Self::AltimeterSetting(_) | Self::Heartbeat(_))
    }
}

/// Tenths of a degree, 0 to 359.9, as on a compass card: headings are continuous
/// through full turns.
fn compass_deg(heading_rad: f64) -> f64 {
    let tenths = libm::round(heading_rad.to_degrees() * 10.0);
    (tenths - 3_600.0 * libm::floor(tenths / 3_600.0)) / 10.0
}

impl Autopilot {
    /// Executes a command; one that is not applicable now is refused, or without being
    /// engaged ignored.
    pub(super) fn execute(&mut self, command: &AutopilotCommand) {
        self.supervisor.contingencies.renew_promise();
        if let AutopilotCommand::ReplacePlan(replacement) = command {
            return self.replace_plan(replacement);
        }
        if self.guidance.mode.mode() != Mode::None {
            if let Err(refusal) = self.may_carry_out(command) {
                self.refuse(refusal);
                return;
            }
            if command.is_of_mode() {
                self.supervisor.contingencies.end();
            }
        }
        match *command {
            AutopilotCommand::Heartbeat(within_s) => {
                self.supervisor.contingencies.promise(within_s);
            }
            AutopilotCommand::Airspeed(mps) if mps.is_finite() => {
                self.guidance.targets.airspeed_mps = self.config.envelope.allowed_airspeed(mps);
                self.change_mode(ModeInput::SetPoint);
            }
            AutopilotCommand::Heading(rad) if rad.is_finite() => {
                let now_rad = self.estimator.estimate().heading_rad;
                self.guidance.targets.heading_rad = now_rad + wrap_pi(rad - now_rad);
                self.change_mode(ModeInput::SetPoint);
            }
            AutopilotCommand::Altitude(m) => self.fly_to(AltitudeReference::SeaLevel, m),
            AutopilotCommand::PressureAltitude(m) => {
                self.fly_to(AltitudeReference::PressureLevel, m);
            }
            AutopilotCommand::Height(m) => self.fly_to(AltitudeReference::Field, m),
            AutopilotCommand::AltimeterSetting(pa) => self.guidance.set_altimeter(pa),
            AutopilotCommand::Resume(ref resume) => self.resume(resume),
            AutopilotCommand::Plan(item) => self.fly_plan(item),
            AutopilotCommand::Pause => self.pause(),
            AutopilotCommand::GoTo(ref place) => self.go_to(place),
            AutopilotCommand::ReturnHome => self.return_home(),
            AutopilotCommand::GoAround => self.guidance.go_around(&self.config),
            AutopilotCommand::Land => {
                if !self.guidance.is_landing() {
                    self.fly_landing();
                }
            }
            AutopilotCommand::Airspeed(_)
            | AutopilotCommand::Heading(_)
            | AutopilotCommand::ReplacePlan(_) => {}
        }
    }

    /// Flies to an altitude above a reference, m.
    fn fly_to(&mut self, reference: AltitudeReference, altitude_m: f64) {
        if let Some(datum_m) = self.guidance.altimeter.datum_m(reference)
            && altitude_m.is_finite()
        {
            self.guidance.reference = reference;
            self.guidance.targets.altitude_m = altitude_m + datum_m;
            self.guidance.capture = None;
            self.change_mode(ModeInput::SetPoint);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::AutopilotCommand;

    #[test]
    fn a_heading_is_told_as_on_a_compass_card() {
        for (commanded_deg, told) in [
            (90.0, "heading 90.0°"),
            (436.5, "heading 76.5°"),
            (-5.4, "heading 354.6°"),
            (359.96, "heading 0.0°"),
            (-0.01, "heading 0.0°"),
        ] {
            let command = AutopilotCommand::Heading(f64::to_radians(commanded_deg));
            assert_eq!(command.to_string(), told);
        }
    }
}
