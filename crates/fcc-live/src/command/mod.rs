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

/// The set points to change; the others keep their value. At most one altitude:
/// above sea level, a pressure altitude or a height.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct NewSetpoints {
    /// Indicated airspeed, m/s, 5 to 340, and within the aircraft's envelope.
    pub airspeed_mps: Option<f64>,
    /// Magnetic heading, rad, -2π to 2π; turned to the shorter way.
    pub heading_rad: Option<f64>,
    /// Altitude above mean sea level by the altimeter setting, m, -500 to
    /// 20,000.
    pub altitude_m: Option<f64>,
    /// Pressure altitude, m, -500 to 20,000.
    pub pressure_altitude_m: Option<f64>,
    /// Height above the field's elevation by the altimeter setting, m, -500 to
    /// 20,000; the elevation has to be configured.
    pub height_m: Option<f64>,
    /// Altimeter setting (QNH), Pa, 94,000 to 106,000; set before an altitude is
    /// flown by it.
    pub altimeter_setting_pa: Option<f64>,
}

impl NewSetpoints {
    /// What is given, by its quantity, in the order of execution.
    fn given(&self) -> impl Iterator<Item = (Quantity, f64)> {
        [
            (Quantity::AltimeterSetting, self.altimeter_setting_pa),
            (Quantity::Airspeed, self.airspeed_mps),
            (Quantity::Heading, self.heading_rad),
            (Quantity::Altitude, self.altitude_m),
            (Quantity::PressureAltitude, self.pressure_altitude_m),
            (Quantity::Height, self.height_m),
        ]
        .into_iter()
        .filter_map(|(quantity, value)| Some((quantity, value?)))
    }
}

/// What an aircraft and its configuration permit.
#[derive(Clone, PartialEq, Debug)]
pub struct AircraftLimits {
    /// The airspeeds that its envelope permits, m/s.
    pub airspeeds_mps: RangeInclusive<f64>,
    /// Whether the elevation is configured that heights refer to.
    pub has_field_elevation: bool,
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
        if set.given().next().is_none() {
            return Err(InvalidCommand::NoSetpoint);
        }
        if set.given().filter(|(of, _)| of.is_altitude()).count() > 1 {
            return Err(InvalidCommand::SeveralAltitudes);
        }
        set.given()
            .find_map(|(quantity, value)| OutsideLimits::of(quantity, value, &quantity.range()))
            .map_or(Ok(()), |outside| Err(outside.into()))
    }

    /// Checks the values against the limits of an aircraft.
    ///
    /// # Errors
    /// An airspeed outside its envelope, a height without a known field.
    pub fn check_for(&self, limits: &AircraftLimits) -> Result<(), InvalidCommand> {
        let Self::Set(set) = self else {
            return Ok(());
        };
        if set.height_m.is_some() && !limits.has_field_elevation {
            return Err(InvalidCommand::NoFieldElevation);
        }
        let airspeeds = &limits.airspeeds_mps;
        set.airspeed_mps
            .and_then(|mps| OutsideLimits::of(Quantity::Airspeed, mps, airspeeds))
            .map_or(Ok(()), |outside| Err(outside.into()))
    }

    /// Whether it can be carried out only while engaged, or by engaging: all but
    /// an altimeter setting, which is set in every state.
    pub const fn needs_control(&self) -> bool {
        match self {
            Self::Engage => true,
            Self::Disengage | Self::Stop => false,
            Self::Set(set) => {
                set.airspeed_mps.is_some()
                    || set.heading_rad.is_some()
                    || set.altitude_m.is_some()
                    || set.pressure_altitude_m.is_some()
                    || set.height_m.is_some()
            }
        }
    }

    /// The loop's commands for it, in order.
    #[cfg(feature = "flight")]
    pub fn for_the_loop(&self) -> Vec<LoopCommand<AutopilotCommand>> {
        match self {
            Self::Engage => vec![LoopCommand::Engage],
            Self::Disengage => vec![LoopCommand::Disengage],
            Self::Stop => vec![LoopCommand::Stop],
            Self::Set(set) => set
                .given()
                .map(|(of, value)| LoopCommand::Controller(of.command(value)))
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
            ..NewSetpoints::default()
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
        let limits = |airspeeds_mps| AircraftLimits {
            airspeeds_mps,
            has_field_elevation: false,
        };
        assert_eq!(command.check_for(&limits(40.0..=60.0)), Ok(()));
        assert!(command.check_for(&limits(60.0..=70.0)).is_err());
        assert_eq!(FlightCommand::Stop.check_for(&limits(60.0..=70.0)), Ok(()));
    }

    /// The autopilot ignores others.
    #[test]
    fn the_altimeter_settings_are_those_of_the_autopilot() {
        assert_eq!(
            Quantity::AltimeterSetting.range(),
            fcc_core::flight::ALTIMETER_SETTINGS_PA
        );
    }

    #[test]
    fn an_altitude_says_what_it_refers_to() {
        let both = FlightCommand::Set(NewSetpoints {
            altitude_m: Some(900.0),
            pressure_altitude_m: Some(900.0),
            ..NewSetpoints::default()
        });
        assert_eq!(both.check(), Err(InvalidCommand::SeveralAltitudes));
        let height = FlightCommand::Set(NewSetpoints {
            height_m: Some(300.0),
            ..NewSetpoints::default()
        });
        assert_eq!(height.check(), Ok(()));
        let mut limits = AircraftLimits {
            airspeeds_mps: 40.0..=60.0,
            has_field_elevation: false,
        };
        let words = height.check_for(&limits).unwrap_err().to_string();
        assert!(words.contains("altimeter.field_elevation_ft"), "{words}");
        limits.has_field_elevation = true;
        assert_eq!(height.check_for(&limits), Ok(()));
        let setting = |altimeter_setting_pa| {
            FlightCommand::Set(NewSetpoints {
                altimeter_setting_pa: Some(altimeter_setting_pa),
                altitude_m: Some(900.0),
                ..NewSetpoints::default()
            })
        };
        let words = setting(1_013.25).check().unwrap_err();
        assert_eq!(
            words.in_knots_degrees_feet(),
            "altimeter setting is 10.13 hPa: choose 940 to 1060 hPa"
        );
        assert_eq!(
            setting(102_000.0).for_the_loop(),
            [
                LoopCommand::Controller(AutopilotCommand::AltimeterSetting(102_000.0)),
                LoopCommand::Controller(AutopilotCommand::Altitude(900.0)),
            ]
        );
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
