//! Controllers whose set points other programs can command.

use std::ops::RangeInclusive;

use fcc_core::framework::LoopCommand;
use fcc_telemetry::Telemetry;

use super::{Command, InvalidCommand, OutsideLimits};

/// A controller whose set points other programs can command.
pub trait Commanded: Telemetry<Command: PartialEq> {
    /// These set points.
    const SETPOINTS: &'static [CommandedSetpoint<Self::Command>];
}

/// A set point that can be commanded.
#[derive(Clone, Debug)]
pub struct CommandedSetpoint<R> {
    /// Its name, with the unit at the end: `heading_rad`.
    pub name: &'static str,
    /// The permitted values.
    pub limits: RangeInclusive<f64>,
    /// The command to the controller.
    pub command: fn(f64) -> R,
}

/// Narrower limits than a controller's own, by the set point's name: those of an
/// aircraft's envelope.
pub type NarrowerLimits = Vec<(&'static str, RangeInclusive<f64>)>;

impl Command {
    /// The loop's commands for it, in their order; all of its values are within
    /// their limits.
    ///
    /// # Errors
    /// When it has no value, one that is out of its limits, or an unknown one.
    pub fn for_the_loop<C: Commanded>(
        &self,
        narrower: &NarrowerLimits,
    ) -> Result<Vec<LoopCommand<C::Command>>, InvalidCommand> {
        let given = match self {
            Self::Engage => return Ok(vec![LoopCommand::Engage]),
            Self::Disengage => return Ok(vec![LoopCommand::Disengage]),
            Self::Stop => return Ok(vec![LoopCommand::Stop]),
            Self::Set(given) => given,
        };
        let names = || {
            let names = C::SETPOINTS.iter().map(|known| known.name);
            names.collect::<Vec<_>>().join(", ")
        };
        if given.is_empty() {
            return Err(InvalidCommand::NoSetpoint(names()));
        }
        let command = |(name, value): &(String, f64)| {
            let mut known = C::SETPOINTS.iter();
            let known = known.find(|known| known.name == name).ok_or_else(|| {
                InvalidCommand::UnknownSetpoint {
                    name: name.clone(),
                    known: names(),
                }
            })?;
            let own = narrower.iter().find(|(narrower, _)| narrower == name);
            let limits = own.map_or(&known.limits, |(_, limits)| limits);
            match OutsideLimits::of(name, *value, limits) {
                Some(outside) => Err(outside.into()),
                None => Ok(LoopCommand::Controller((known.command)(*value))),
            }
        };
        given.iter().map(command).collect()
    }
}

#[cfg(feature = "flight")]
mod flight {
    use fcc_core::flight::{Autopilot, AutopilotCommand};
    use fcc_telemetry::units::{COMMANDED_ALTITUDE_M, COMMANDED_HEADING_RAD};

    use super::{Commanded, CommandedSetpoint};

    impl Commanded for Autopilot {
        const SETPOINTS: &'static [CommandedSetpoint<AutopilotCommand>] = &[
            // Limits for any aircraft; each has its own.
            CommandedSetpoint {
                name: "airspeed_mps",
                limits: 5.0..=340.0,
                command: AutopilotCommand::Airspeed,
            },
            CommandedSetpoint {
                name: "heading_rad",
                limits: COMMANDED_HEADING_RAD,
                command: AutopilotCommand::Heading,
            },
            CommandedSetpoint {
                name: "altitude_m",
                limits: COMMANDED_ALTITUDE_M,
                command: AutopilotCommand::Altitude,
            },
        ];
    }
}

#[cfg(all(test, feature = "flight"))]
mod tests {
    use fcc_core::flight::{Autopilot, AutopilotCommand};

    use super::*;

    fn refused(command: &Command, narrower: &NarrowerLimits) -> String {
        let given = command.for_the_loop::<Autopilot>(narrower);
        given.map_or_else(|refused| refused.to_string(), |_| "accepted".to_owned())
    }

    #[test]
    fn invalid_commands_are_refused_with_a_reason() {
        let none = NarrowerLimits::new();
        for (command, word) in [
            (
                Command::set([]),
                "no set point is given: choose of airspeed_mps, heading_rad, altitude_m",
            ),
            (
                Command::set([("airspeed_mps", f64::NAN)]),
                "airspeed is NaN m/s: choose 5 to 340 m/s",
            ),
            (Command::set([("airspeed_mps", -1.0)]), "airspeed is -1"),
            (Command::set([("heading_rad", 7.0)]), "heading is 7 rad"),
            (
                Command::set([("altitude_m", 900.0), ("room_c", 7.0)]),
                "there is no set point 'room_c': choose of airspeed_mps",
            ),
        ] {
            let words = refused(&command, &none);
            assert!(words.contains(word), "{words}");
        }
        let slow = vec![("airspeed_mps", 60.0..=70.0)];
        let words = refused(&Command::set([("airspeed_mps", 50.0)]), &slow);
        assert!(words.contains("choose 60 to 70 m/s"), "{words}");
        let stop = Command::Stop.for_the_loop::<Autopilot>(&slow);
        assert_eq!(stop, Ok(vec![LoopCommand::Stop]));
    }

    #[test]
    fn each_set_point_is_a_separate_command() {
        let set = Command::set([("airspeed_mps", 50.0), ("heading_rad", 1.0)]);
        assert_eq!(
            set.for_the_loop::<Autopilot>(&vec![("airspeed_mps", 40.0..=60.0)]),
            Ok(vec![
                LoopCommand::Controller(AutopilotCommand::Airspeed(50.0)),
                LoopCommand::Controller(AutopilotCommand::Heading(1.0))
            ])
        );
    }
}
