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
mod wire;

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use fcc_core::flight::AutopilotCommand;
use fcc_core::framework::LoopCommand;

pub(super) use command_server::{CommandServer, Ends, Rings};
pub use commander::Commander;
pub use error::CommandError;

/// The version of commands and answers, apart from the layouts': whoever changes
/// one of them, or what it means, counts this up, the names of the types with
/// it.
pub const COMMANDS_VERSION: u32 = 1;

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
    /// Indicated airspeed, m/s, 5 to 340; held to what the envelope allows.
    pub airspeed_mps: Option<f64>,
    /// Magnetic heading, rad, -2π to 2π; turned to the shorter way.
    pub heading_rad: Option<f64>,
    /// Barometric altitude, m, -500 to 20,000.
    pub altitude_m: Option<f64>,
}

const AIRSPEED_MPS: RangeInclusive<f64> = 5.0..=340.0;
const HEADING_RAD: RangeInclusive<f64> = -TAU..=TAU;
const ALTITUDE_M: RangeInclusive<f64> = -500.0..=20_000.0;

impl FlightCommand {
    /// Checks its numbers.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check(&self) -> Result<(), String> {
        let Self::Set(set) = self else {
            return Ok(());
        };
        if *set == NewSetpoints::default() {
            return Err(
                "no set point is given: give an airspeed, a heading or an altitude".to_owned(),
            );
        }
        within("airspeed", "m/s", set.airspeed_mps, &AIRSPEED_MPS)?;
        within("heading", "rad", set.heading_rad, &HEADING_RAD)?;
        within("altitude", "m", set.altitude_m, &ALTITUDE_M)
    }

    /// What goes to the loop for it, in this sequence.
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

fn within(
    what: &str,
    unit: &str,
    value: Option<f64>,
    range: &RangeInclusive<f64>,
) -> Result<(), String> {
    match value {
        Some(value) if !range.contains(&value) => Err(format!(
            "{what} is {value} {unit}: choose {:.6} to {:.6}",
            range.start(),
            range.end()
        )
        .replace(".000000", "")),
        _ => Ok(()),
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
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// It was carried out in this tick.
    CarriedOut {
        /// The tick that read it.
        tick: u64,
    },
    /// It was not, for this reason.
    Refused(String),
}

#[cfg(test)]
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
                "airspeed is NaN m/s: choose 5 to 340",
            ),
            (set(Some(-1.0), None), "airspeed is -1"),
            (set(None, Some(7.0)), "heading is 7 rad"),
        ] {
            let words = command.check().unwrap_err();
            assert!(words.contains(word), "{words}");
        }
        assert_eq!(set(Some(50.0), Some(1.0)).check(), Ok(()));
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
