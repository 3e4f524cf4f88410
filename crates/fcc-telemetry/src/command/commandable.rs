//! Controllers whose set points other programs can command.

use std::ops::RangeInclusive;

use crate::Telemetry;
use fcc_core::framework::{LoopCommand, Notice};

use super::{Command, InvalidCommand, OutsideLimits};

/// A controller whose set points other programs can command.
pub trait Commandable: Telemetry<Command: PartialEq> {
    /// These set points, in the order in which they are executed.
    const SETPOINTS: &'static [CommandableSetpoint<Self::Command>];

    /// What is commanded by several values at once, which are given together; executed
    /// after the set points. None by default.
    const JOINT: &'static [JointSetpoints<Self::Command>] = &[];

    /// Why a command that was read in a notice's tick is refused, if the notice says that.
    fn refusal(_: &Notice) -> Option<&'static str> {
        None
    }

    /// Whether the controller may refuse a command.
    fn may_refuse(_: &Self::Command) -> bool {
        true
    }
}

/// Set points that are commanded together.
#[derive(Clone, Debug)]
pub struct JointSetpoints<R> {
    /// Names and permitted values.
    pub parts: &'static [(&'static str, RangeInclusive<f64>)],
    /// The command to the controller, of as many values as there are parts.
    pub command: fn(&[f64]) -> Option<R>,
    /// The error if only some are given.
    pub incomplete: &'static str,
}

impl<R> JointSetpoints<R> {
    /// The values that a command gives.
    fn values<'a>(&'a self, command: &'a Command) -> impl Iterator<Item = f64> + 'a {
        let parts = self.parts.iter();
        parts.filter_map(|(name, _)| command.value_of(name))
    }
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

/// Why a plan is not replaced where nothing reads plans.
const NO_PLANS: &str = "a plan is replaced only in flight, by the daemon's own user";

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
            Self::ReplacePlan { .. } => return Err(InvalidCommand::NotPermitted(NO_PLANS)),
        };
        let joint = || C::JOINT.iter().flat_map(|joint| joint.parts);
        let known = || {
            let single = C::SETPOINTS.iter().map(|known| known.name);
            single.chain(joint().map(|(name, _)| *name)).collect()
        };
        if given.is_empty() {
            return Err(InvalidCommand::NoSetpoint(known()));
        }
        let is_unknown = |name: &str| {
            !C::SETPOINTS.iter().any(|known| known.name == name)
                && !joint().any(|(known, _)| *known == name)
        };
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
        for joint in C::JOINT {
            let values: Vec<f64> = joint.values(self).collect();
            if values.is_empty() {
                continue;
            }
            if values.len() < joint.parts.len() {
                return Err(InvalidCommand::Alternatives(joint.incomplete));
            }
            for ((name, limits), value) in joint.parts.iter().zip(&values) {
                if let Some(outside) = OutsideLimits::of(name, *value, limits) {
                    return Err(outside.into());
                }
            }
            commands.extend((joint.command)(&values).map(LoopCommand::Controller));
        }
        Ok(commands)
    }

    /// Whether it can be carried out only while engaged, or by engaging.
    pub(super) fn needs_control<C: Commandable>(&self) -> bool {
        let mut setpoints = C::SETPOINTS.iter();
        matches!(self, Self::Engage | Self::ReplacePlan { .. })
            || setpoints.any(|known| known.needs_control && self.value_of(known.name).is_some())
            || C::JOINT
                .iter()
                .any(|joint| joint.values(self).next().is_some())
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
    use core::f64::consts::{FRAC_PI_2, PI};

    use fcc_core::flight::Position;
    use fcc_core::framework::Notice;
    use fcc_core::units::KNOT_MPS;
    use fcc_fixed_wing::{Autopilot, AutopilotCommand, why_refused};

    use super::{Commandable, CommandableSetpoint, JointSetpoints};

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

    /// Without a value that matters: 1.
    const fn order(
        name: &'static str,
        command: fn(f64) -> AutopilotCommand,
    ) -> CommandableSetpoint<AutopilotCommand> {
        CommandableSetpoint {
            name,
            limits: 1.0..=1.0,
            command,
            needs_control: true,
            alternatives: Some(MODES),
        }
    }

    const MODES: &str = "several modes are given: give one of plan_item, pause and return_home";

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
                limits: 10.0 * KNOT_MPS..=650.0 * KNOT_MPS,
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
            // 0: from where it was left.
            CommandableSetpoint {
                name: "plan_item",
                limits: 0.0..=1_000.0,
                command: |item| AutopilotCommand::Plan(item as u16),
                needs_control: true,
                alternatives: Some(MODES),
            },
            order("pause", |_| AutopilotCommand::Pause),
            order("return_home", |_| AutopilotCommand::ReturnHome),
            order("go_around", |_| AutopilotCommand::GoAround),
            order("land", |_| AutopilotCommand::Land),
            // 0 ends the promise.
            CommandableSetpoint {
                name: "heartbeat_s",
                limits: 0.0..=3_600.0,
                command: AutopilotCommand::Heartbeat,
                needs_control: false,
                alternatives: None,
            },
        ];

        const JOINT: &'static [JointSetpoints<AutopilotCommand>] = &[JointSetpoints {
            parts: &[
                ("go_to_latitude_rad", -FRAC_PI_2..=FRAC_PI_2),
                ("go_to_longitude_rad", -PI..=PI),
                ("go_to_altitude_m", COMMANDED_ALTITUDE_M),
            ],
            command: |values| match *values {
                [latitude_rad, longitude_rad, altitude_m] => {
                    Some(AutopilotCommand::GoTo(Position {
                        latitude_rad,
                        longitude_rad,
                        altitude_m,
                    }))
                }
                _ => None,
            },
            incomplete: "a place needs all of go_to_latitude_rad, go_to_longitude_rad and \
                         go_to_altitude_m",
        }];

        fn refusal(notice: &Notice) -> Option<&'static str> {
            why_refused(notice)
        }

        fn may_refuse(command: &AutopilotCommand) -> bool {
            !matches!(command, AutopilotCommand::Heartbeat(_))
        }
    }
}

#[cfg(feature = "flight")]
mod multicopter {
    use fcc_multicopter::{Command, GoTo, Multicopter, Velocity};

    use super::{Commandable, CommandableSetpoint, JointSetpoints};

    const MODES: &str = "several modes are given: give one of take_off_m, plan_item, pause, circle_radius_m, \
         return_home, land and stop_motors";

    const fn mode(
        name: &'static str,
        (least, most): (f64, f64),
        command: fn(f64) -> Command,
    ) -> CommandableSetpoint<Command> {
        CommandableSetpoint {
            name,
            limits: least..=most,
            command,
            needs_control: true,
            alternatives: Some(MODES),
        }
    }

    /// Without a value that matters.
    const ORDER: (f64, f64) = (1.0, 1.0);
    const MOST_MPS: f64 = 20.0;

    impl Commandable for Multicopter {
        const SETPOINTS: &'static [CommandableSetpoint<Command>] = &[
            mode("take_off_m", (1.0, 120.0), Command::TakeOff),
            mode("plan_item", (1.0, 1_000.0), |item| {
                Command::Plan(item as u16)
            }),
            mode("pause", ORDER, |_| Command::Hover),
            mode("circle_radius_m", (1.0, 500.0), Command::Circle),
            mode("return_home", ORDER, |_| Command::Return),
            mode("land", ORDER, |_| Command::Land),
            mode("stop_motors", ORDER, |_| Command::StopMotors),
        ];

        const JOINT: &'static [JointSetpoints<Command>] = &[
            JointSetpoints {
                parts: &[
                    ("go_to_north_m", -5_000.0..=5_000.0),
                    ("go_to_east_m", -5_000.0..=5_000.0),
                    ("go_to_height_m", 1.0..=120.0),
                ],
                command: |values| match *values {
                    [north_m, east_m, height_m] => Some(Command::GoTo(GoTo {
                        north_m,
                        east_m,
                        height_m,
                        heading_rad: None,
                    })),
                    _ => None,
                },
                incomplete: "a place needs all of go_to_north_m, go_to_east_m and go_to_height_m",
            },
            JointSetpoints {
                parts: &[
                    ("forward_mps", -MOST_MPS..=MOST_MPS),
                    ("right_mps", -MOST_MPS..=MOST_MPS),
                    ("climb_mps", -MOST_MPS..=MOST_MPS),
                    ("yaw_radps", -6.0..=6.0),
                ],
                command: |values| match *values {
                    [forward_mps, right_mps, climb_mps, yaw_radps] => {
                        Some(Command::Move(Velocity {
                            forward_mps,
                            right_mps,
                            climb_mps,
                            yaw_radps,
                        }))
                    }
                    _ => None,
                },
                incomplete: "a stick needs all of forward_mps, right_mps, climb_mps and yaw_radps",
            },
        ];
    }
}

#[cfg(all(test, feature = "flight"))]
mod tests {
    use crate::units::AVIATION;
    use fcc_core::flight::ALTIMETER_SETTINGS_PA;
    use fcc_fixed_wing::{Autopilot, AutopilotCommand};

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
                "airspeed is NaN kt: choose 10 to 650 kt",
            ),
            (Command::set([("airspeed_mps", -1.0)]), "airspeed is -1.94"),
            (
                Command::set([("heading_rad", 14.0)]),
                "heading is 802.14°: choose -720 to 720°",
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
