//! Controllers whose set points other programs can command.

use std::ops::RangeInclusive;

use crate::Telemetry;
use fcc_core::framework::LoopCommand;

use super::{Command, InvalidCommand, OutsideLimits};

/// A controller whose set points other programs can command.
pub trait Commandable: Telemetry<Command: PartialEq> {
    /// These set points, in the order in which they are executed.
    const SETPOINTS: &'static [CommandableSetpoint<Self::Command>];
}

/// A set point that can be commanded.
#[derive(Clone, Debug)]
pub struct CommandableSetpoint<R> {
    /// Its name, with the unit at the end: `heading_rad`.
    pub name: &'static str,
    /// The permitted values.
    pub limits: RangeInclusive<f64>,
    /// The command to the controller.
    pub command: fn(f64) -> R,
    /// Whether it is accepted only while engaged.
    pub needs_control: bool,
    /// For those of which a command has one at most: the error for several, the
    /// same for all of them.
    pub alternatives: Option<&'static str>,
}

/// What one plant permits, by the names of set points, where that differs from
/// its controller's own limits: narrower limits, or why it has no such set point.
pub type PlantLimits = Vec<(&'static str, Result<RangeInclusive<f64>, &'static str>)>;

impl Command {
    /// The loop's commands for it, in the order of execution; all of its values
    /// are within their limits.
    ///
    /// # Errors
    /// When it has no value, or one that is not permitted.
    pub fn for_the_loop<C: Commandable>(
        &self,
        limits: &PlantLimits,
    ) -> Result<Vec<LoopCommand<C::Command>>, InvalidCommand> {
        let given = match self {
            Self::Engage => return Ok(vec![LoopCommand::Engage]),
            Self::Disengage => return Ok(vec![LoopCommand::Disengage]),
            Self::Stop => return Ok(vec![LoopCommand::Stop]),
            Self::Set(given) => given,
        };
        let known = || C::SETPOINTS.iter().map(|known| known.name).collect();
        if given.is_empty() {
            return Err(InvalidCommand::NoSetpoint(known()));
        }
        let is_unknown = |name: &str| !C::SETPOINTS.iter().any(|known| known.name == name);
        if let Some((name, _)) = given.iter().find(|(name, _)| is_unknown(name)) {
            return Err(InvalidCommand::UnknownSetpoint(name.clone(), known()));
        }
        let mut commands = Vec::new();
        let mut alternatives = None;
        for known in C::SETPOINTS {
            let Some(value) = self.value_of(known.name) else {
                continue;
            };
            if let Some(several) = known.alternatives
                && alternatives.replace(several) == Some(several)
            {
                return Err(InvalidCommand::Alternatives(several));
            }
            let own = limits.iter().find(|(name, _)| *name == known.name);
            let limits = match own {
                Some((_, Err(why))) => return Err(InvalidCommand::NotPermitted(why)),
                Some((_, Ok(limits))) => limits,
                None => &known.limits,
            };
            if let Some(outside) = OutsideLimits::of(known.name, value, limits) {
                return Err(outside.into());
            }
            commands.push(LoopCommand::Controller((known.command)(value)));
        }
        Ok(commands)
    }

    /// Whether it can be carried out only while engaged, or by engaging.
    pub(super) fn needs_control<C: Commandable>(&self) -> bool {
        let mut setpoints = C::SETPOINTS.iter();
        matches!(self, Self::Engage)
            || setpoints.any(|known| known.needs_control && self.value_of(known.name).is_some())
    }

    /// The value of a set point, if it changes that.
    fn value_of(&self, name: &str) -> Option<f64> {
        let Self::Set(given) = self else {
            return None;
        };
        let found = given.iter().find(|(given, _)| given == name);
        found.map(|(_, value)| *value)
    }
}

#[cfg(feature = "flight")]
mod flight {
    use crate::units::{
        COMMANDED_ALTIMETER_SETTING_PA, COMMANDED_ALTITUDE_M, COMMANDED_HEADING_RAD,
    };
    use fcc_core::flight::{Autopilot, AutopilotCommand};

    use super::{Commandable, CommandableSetpoint};

    const ALTITUDES: &str =
        "several altitudes are given: give an altitude, a pressure altitude or a height";

    const fn altitude(
        name: &'static str,
        command: fn(f64) -> AutopilotCommand,
    ) -> CommandableSetpoint<AutopilotCommand> {
        CommandableSetpoint {
            name,
            limits: COMMANDED_ALTITUDE_M,
            command,
            needs_control: true,
            alternatives: Some(ALTITUDES),
        }
    }

    impl Commandable for Autopilot {
        const SETPOINTS: &'static [CommandableSetpoint<AutopilotCommand>] = &[
            // Before an altitude is flown by it.
            CommandableSetpoint {
                name: "altimeter_setting_pa",
                limits: COMMANDED_ALTIMETER_SETTING_PA,
                command: AutopilotCommand::AltimeterSetting,
                needs_control: false,
                alternatives: None,
            },
            CommandableSetpoint {
                name: "airspeed_mps",
                // For any aircraft; each has its own.
                limits: 5.0..=340.0,
                command: AutopilotCommand::Airspeed,
                needs_control: true,
                alternatives: None,
            },
            CommandableSetpoint {
                name: "heading_rad",
                limits: COMMANDED_HEADING_RAD,
                command: AutopilotCommand::Heading,
                needs_control: true,
                alternatives: None,
            },
            altitude("altitude_m", AutopilotCommand::Altitude),
            altitude("pressure_altitude_m", AutopilotCommand::PressureAltitude),
            altitude("height_m", AutopilotCommand::Height),
        ];
    }
}

#[cfg(all(test, feature = "flight"))]
mod tests {
    use crate::units::AVIATION;
    use fcc_core::flight::{ALTIMETER_SETTINGS_PA, Autopilot, AutopilotCommand};

    use super::*;

    fn checked(
        command: &Command,
        limits: &PlantLimits,
    ) -> Result<Vec<LoopCommand<AutopilotCommand>>, InvalidCommand> {
        command.for_the_loop::<Autopilot>(limits)
    }

    fn refused(command: &Command, limits: &PlantLimits) -> String {
        checked(command, limits).map_or_else(
            |refused| refused.text_in(AVIATION),
            |_| "accepted".to_owned(),
        )
    }

    #[test]
    fn invalid_commands_are_refused_with_a_reason() {
        for (command, word) in [
            (
                Command::set([]),
                "no set point is given: choose of altimeter setting, airspeed, heading",
            ),
            (
                Command::set([("airspeed_mps", f64::NAN)]),
                "airspeed is NaN kt: choose 9.72 to 660.91 kt",
            ),
            (Command::set([("airspeed_mps", -1.0)]), "airspeed is -1.94"),
            (
                Command::set([("heading_rad", 7.0)]),
                "heading is 401.07°: choose -360 to 360°",
            ),
            (
                Command::set([("altimeter_setting_pa", 1_013.25), ("altitude_m", 900.0)]),
                "altimeter setting is 10.13 hPa: choose 940 to 1060 hPa",
            ),
            (
                Command::set([("altitude_m", 900.0), ("room_c", 7.0)]),
                "there is no set point 'room_c': choose of altimeter_setting_pa, airspeed_mps",
            ),
            (
                Command::set([("altitude_m", 900.0), ("pressure_altitude_m", 900.0)]),
                "several altitudes are given",
            ),
        ] {
            let words = refused(&command, &PlantLimits::new());
            assert!(words.contains(word), "{words}");
        }
        let limits = vec![
            ("airspeed_mps", Ok(60.0..=70.0)),
            ("height_m", Err("no field is known")),
        ];
        let words = refused(&Command::set([("airspeed_mps", 50.0)]), &limits);
        assert!(words.contains("choose 116.63 to 136.07 kt"), "{words}");
        let height = Command::set([("height_m", 300.0)]);
        assert_eq!(refused(&height, &limits), "no field is known");
        assert_eq!(refused(&height, &PlantLimits::new()), "accepted");
        assert_eq!(
            checked(&Command::Stop, &limits),
            Ok(vec![LoopCommand::Stop])
        );
    }

    #[test]
    fn each_set_point_is_a_separate_command_in_the_order_of_execution() {
        let set = Command::set([("altitude_m", 900.0), ("altimeter_setting_pa", 102_000.0)]);
        let expected = [
            AutopilotCommand::AltimeterSetting(102_000.0),
            AutopilotCommand::Altitude(900.0),
        ];
        assert_eq!(
            checked(&set, &PlantLimits::new()),
            Ok(expected.map(LoopCommand::Controller).to_vec())
        );
    }

    /// The autopilot ignores others.
    #[test]
    fn the_altimeter_settings_are_those_of_the_autopilot() {
        let mut setpoints = Autopilot::SETPOINTS.iter();
        let setting = setpoints.find(|known| known.name == "altimeter_setting_pa");
        assert_eq!(setting.unwrap().limits, ALTIMETER_SETTINGS_PA);
    }
}
