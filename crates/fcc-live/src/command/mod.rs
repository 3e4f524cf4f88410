//! Commands to a daemon from another program on the machine.
//!
//! ```text
//! Commander ─► service ─► fcc-live ─► ring ─► who flies ─► the loop's ring
//!    ▲         request     looks             sends, and sees in what the loop
//!    └──────── response ◄─ answers ◄─ ring ◄ tells what became of the command
//! ```
//!
//! The loop's thread only reads its ring of commands, as it always does. The
//! sender learns the result and the tick that read the command. Only the
//! daemon's own user can open the service: iceoryx2 creates its files for their
//! owner alone.

mod command_server;
mod commander;
mod error;
mod limits;
mod wire;

use std::ops::RangeInclusive;

#[cfg(feature = "flight")]
use fcc_core::flight::AutopilotCommand;
#[cfg(feature = "flight")]
use fcc_core::framework::LoopCommand;

pub(super) use command_server::{CommandServer, Ends, Rings};
pub use commander::Commander;
pub use error::{CommandError, InvalidCommand};
pub use limits::{OutsideLimits, Quantity};

/// The version of commands and answers, independent of the layouts'. Increase
/// it, and the version in the types' names, with every change of one of them or
/// of its meaning.
pub const COMMANDS_VERSION: u32 = 2;

/// A command to a flight from another program.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum FlightCommand {
    /// Take control with the present state as set points, if nothing inhibits
    /// it.
    Engage,
    /// Release the controls.
    Disengage,
    /// Release the controls and end the daemon.
    Stop,
    /// Fly to other set points; ends a pattern.
    Set(NewSetpoints),
}

/// The set points to change; the others keep their value.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct NewSetpoints {
    /// Indicated airspeed, m/s, 5 to 340, and within the aircraft's envelope.
    pub airspeed_mps: Option<f64>,
    /// Magnetic heading, rad, -2π to 2π; turned to the shorter way.
    pub heading_rad: Option<f64>,
    /// Barometric altitude, m, -500 to 20,000.
    pub altitude_m: Option<f64>,
}

impl FlightCommand {
    /// Checks the values against the limits for any aircraft.
    ///
    /// # Errors
    /// The value that is out of range.
    pub fn check(&self) -> Result<(), InvalidCommand> {
        let Self::Set(set) = self else {
            return Ok(());
        };
        let given = [
            (Quantity::Airspeed, set.airspeed_mps),
            (Quantity::Heading, set.heading_rad),
            (Quantity::Altitude, set.altitude_m),
        ];
        let mut given = given
            .into_iter()
            .filter_map(|(quantity, value)| Some((quantity, value?)))
            .peekable();
        given.peek().ok_or(InvalidCommand::NoSetpoint)?;
        given
            .find_map(|(quantity, value)| OutsideLimits::of(quantity, value, &quantity.range()))
            .map_or(Ok(()), |outside| Err(outside.into()))
    }

    /// Checks the airspeed against an aircraft's envelope, m/s.
    ///
    /// # Errors
    /// The limits.
    pub fn check_airspeed(&self, allowed_mps: &RangeInclusive<f64>) -> Result<(), OutsideLimits> {
        let Self::Set(NewSetpoints {
            airspeed_mps: Some(mps),
            ..
        }) = self
        else {
            return Ok(());
        };
        OutsideLimits::of(Quantity::Airspeed, *mps, allowed_mps).map_or(Ok(()), Err)
    }

    /// The loop's commands for it, in order.
    #[cfg(feature = "flight")]
    pub fn for_the_loop(&self) -> Vec<LoopCommand<AutopilotCommand>> {
        match self {
            Self::Engage => vec![LoopCommand::Engage],
            Self::Disengage => vec![LoopCommand::Disengage],
            Self::Stop => vec![LoopCommand::Stop],
            Self::Set(set) => [
                set.airspeed_mps.map(AutopilotCommand::Airspeed),
                set.heading_rad.map(AutopilotCommand::Heading),
                set.altitude_m.map(AutopilotCommand::Altitude),
            ]
            .into_iter()
            .flatten()
            .map(LoopCommand::Controller)
            .collect(),
        }
    }
}

/// A command from another program that waits for its answer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PendingCommand {
    /// Its identifier, for [`Publisher::answer`](super::Publisher::answer).
    pub id: u64,
    /// The command.
    pub command: FlightCommand,
}

/// The result of a command.
#[derive(Clone, PartialEq, Debug)]
pub enum Verdict {
    /// It was carried out in this tick.
    CarriedOut {
        /// The tick that read it.
        tick: u64,
    },
    /// It was refused, for this reason.
    Refused(String),
    /// It was refused because it is outside this aircraft's envelope.
    Outside(OutsideLimits),
}

#[cfg(all(test, feature = "flight"))]
mod tests {
    use super::*;

    fn set(airspeed_mps: Option<f64>, heading_rad: Option<f64>) -> FlightCommand {
        FlightCommand::Set(NewSetpoints {
            airspeed_mps,
            heading_rad,
            altitude_m: None,
        })
    }

    #[test]
    fn invalid_commands_are_refused_with_a_reason() {
        for (command, word) in [
            (set(None, None), "no set point"),
            (
                set(Some(f64::NAN), None),
                "airspeed is NaN m/s: choose 5 to 340 m/s",
            ),
            (set(Some(-1.0), None), "airspeed is -1"),
            (set(None, Some(7.0)), "heading is 7 rad"),
        ] {
            let words = command.check().unwrap_err().to_string();
            assert!(words.contains(word), "{words}");
        }
        let command = set(Some(50.0), Some(1.0));
        assert_eq!(command.check(), Ok(()));
        assert_eq!(command.check_airspeed(&(40.0..=60.0)), Ok(()));
        assert!(command.check_airspeed(&(60.0..=70.0)).is_err());
        assert_eq!(FlightCommand::Stop.check_airspeed(&(60.0..=70.0)), Ok(()));
    }

    #[test]
    fn each_set_point_is_a_separate_command() {
        assert_eq!(
            set(Some(50.0), Some(1.0)).for_the_loop(),
            [
                LoopCommand::Controller(AutopilotCommand::Airspeed(50.0)),
                LoopCommand::Controller(AutopilotCommand::Heading(1.0))
            ]
        );
        assert_eq!(FlightCommand::Stop.for_the_loop(), [LoopCommand::Stop]);
    }
}
