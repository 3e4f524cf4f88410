//! Commands to a daemon from another program on the machine.
//!
//! ```text
//! Commander ─► service ─► fcc-live ─► ring ─► who flies ─► the loop's ring
//!    ▲         request     looks             sends, and sees in what the loop
//!    └──────── response ◄─ answers ◄─ ring ◄ tells what became of the command
//! ```
//!
//! The loop's thread takes no part but that it reads its ring of commands, as it
//! always does. Whoever asks learns what became of the command in the tick that
//! read it. Only the daemon's own user can open the service: iceoryx2 makes
//! its files for their owner alone.

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
pub use error::{CommandError, Unflyable};
pub use limits::{OutsideLimits, Quantity};

/// The version of commands and answers, apart from the layouts': whoever changes
/// one of them, or what it means, counts this up, the names of the types with
/// it.
pub const COMMANDS_VERSION: u32 = 2;

/// What may be asked of a flight from outside.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum FlightCommand {
    /// Take over as things are, if nothing blocks it.
    Engage,
    /// Give the controls back.
    Disengage,
    /// Give the controls back and end the daemon.
    Stop,
    /// Fly by other set points; ends a pattern.
    Set(NewSetpoints),
}

/// The set points that are to change; the others stay.
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
    /// Checks its numbers by what no aircraft flies.
    ///
    /// # Errors
    /// What cannot be flown.
    pub fn check(&self) -> Result<(), Unflyable> {
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
        given.peek().ok_or(Unflyable::NoSetpoint)?;
        given
            .find_map(|(quantity, value)| OutsideLimits::of(quantity, value, &quantity.range()))
            .map_or(Ok(()), |outside| Err(outside.into()))
    }

    /// Checks its airspeed by what an aircraft's envelope allows, m/s.
    ///
    /// # Errors
    /// What is allowed.
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

    /// What goes to the loop for it, in this sequence.
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

/// A command that came from another program, and waits for its answer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Asked {
    /// Which, for [`Publisher::answer`](super::Publisher::answer).
    pub id: u64,
    /// What is asked.
    pub command: FlightCommand,
}

/// What became of a command.
#[derive(Clone, PartialEq, Debug)]
pub enum Verdict {
    /// It was carried out in this tick.
    CarriedOut {
        /// The tick that read it.
        tick: u64,
    },
    /// It was not, for this reason.
    Refused(String),
    /// It was not, for it asks for more than this aircraft may fly.
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
    fn what_cannot_be_flown_is_refused_in_words() {
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
    fn each_set_point_is_an_order_of_its_own() {
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
