//! Commands and answers in shared memory.

#![expect(unsafe_code, reason = "iceoryx2 asks for a promise about layouts")]

use iceoryx2::prelude::ZeroCopySend;

use super::super::Text;
use super::{COMMANDS_VERSION, FlightCommand, NewSetpoints, OutsideLimits, Quantity, Verdict};

/// A command in shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct CommandRequest {
    /// [`COMMANDS_VERSION`].
    pub(super) version: u32,
    /// 0 engage, 1 disengage, 2 stop, 3 set.
    pub(super) code: u32,
    /// NaN: unchanged.
    pub(super) airspeed_mps: f64,
    /// NaN: unchanged.
    pub(super) heading_rad: f64,
    /// NaN: unchanged.
    pub(super) altitude_m: f64,
    /// NaN: unchanged.
    pub(super) pressure_altitude_m: f64,
    /// NaN: unchanged.
    pub(super) height_m: f64,
    /// NaN: unchanged.
    pub(super) altimeter_setting_pa: f64,
}

/// An answer in shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Answer {
    /// 0 carried out, 1 refused, 2 refused because of the airspeed's limits.
    pub(super) code: u32,
    /// [`COMMANDS_VERSION`].
    pub(super) version: u32,
    /// The tick that read the command; 0 if none did.
    pub(super) tick: u64,
    /// The smallest airspeed of this aircraft, m/s; with code 2 only.
    pub(super) least_mps: f64,
    /// The largest airspeed.
    pub(super) most_mps: f64,
    /// The reason for refusing it.
    pub(super) text: Text<224>,
}

// SAFETY: repr(C), numbers only.
unsafe impl ZeroCopySend for CommandRequest {
    unsafe fn type_name() -> &'static str {
        "fcc.v2.Command"
    }
}

// SAFETY: repr(C), numbers and bytes only.
unsafe impl ZeroCopySend for Answer {
    unsafe fn type_name() -> &'static str {
        "fcc.v2.CommandAnswer"
    }
}

const ENGAGE: u32 = 0;
const DISENGAGE: u32 = 1;
const STOP: u32 = 2;
const SET: u32 = 3;

const CARRIED_OUT: u32 = 0;
const REFUSED: u32 = 1;
const OUTSIDE: u32 = 2;

impl From<FlightCommand> for CommandRequest {
    fn from(command: FlightCommand) -> Self {
        let (code, set) = match command {
            FlightCommand::Engage => (ENGAGE, NewSetpoints::default()),
            FlightCommand::Disengage => (DISENGAGE, NewSetpoints::default()),
            FlightCommand::Stop => (STOP, NewSetpoints::default()),
            FlightCommand::Set(set) => (SET, set),
        };
        let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Self {
            version: COMMANDS_VERSION,
            code,
            airspeed_mps: number(set.airspeed_mps),
            heading_rad: number(set.heading_rad),
            altitude_m: number(set.altitude_m),
            pressure_altitude_m: number(set.pressure_altitude_m),
            height_m: number(set.height_m),
            altimeter_setting_pa: number(set.altimeter_setting_pa),
        }
    }
}

impl CommandRequest {
    /// Another program may have written anything.
    ///
    /// # Errors
    /// Why it is not a valid command, as text.
    pub(super) fn command(&self) -> Result<FlightCommand, String> {
        if self.version != COMMANDS_VERSION {
            return Err(format!(
                "the command has version {}, and this daemon accepts version {COMMANDS_VERSION}: use \
                 the fccd that belongs to it",
                self.version
            ));
        }
        let given = |value: f64| (!value.is_nan()).then_some(value);
        let command = match self.code {
            ENGAGE => FlightCommand::Engage,
            DISENGAGE => FlightCommand::Disengage,
            STOP => FlightCommand::Stop,
            SET => FlightCommand::Set(NewSetpoints {
                airspeed_mps: given(self.airspeed_mps),
                heading_rad: given(self.heading_rad),
                altitude_m: given(self.altitude_m),
                pressure_altitude_m: given(self.pressure_altitude_m),
                height_m: given(self.height_m),
                altimeter_setting_pa: given(self.altimeter_setting_pa),
            }),
            other => return Err(format!("there is no command with the number {other}")),
        };
        command
            .check()
            .map(|()| command)
            .map_err(|error| error.to_string())
    }
}

impl From<&Verdict> for Answer {
    fn from(verdict: &Verdict) -> Self {
        let answer = Self {
            code: CARRIED_OUT,
            version: COMMANDS_VERSION,
            tick: 0,
            least_mps: 0.0,
            most_mps: 0.0,
            text: Text::default(),
        };
        match verdict {
            Verdict::CarriedOut { tick } => Self {
                tick: *tick,
                ..answer
            },
            Verdict::Refused(words) => Self {
                code: REFUSED,
                text: Text::new(words),
                ..answer
            },
            Verdict::Outside(outside) => Self {
                code: OUTSIDE,
                least_mps: outside.least,
                most_mps: outside.most,
                text: Text::new(&outside.to_string()),
                ..answer
            },
        }
    }
}

impl Answer {
    /// The result of this command.
    pub(super) fn verdict(&self, command: &FlightCommand) -> Verdict {
        match (self.code, command) {
            (CARRIED_OUT, _) => Verdict::CarriedOut { tick: self.tick },
            (
                OUTSIDE,
                FlightCommand::Set(NewSetpoints {
                    airspeed_mps: Some(value),
                    ..
                }),
            ) => Verdict::Outside(OutsideLimits {
                quantity: Quantity::Airspeed,
                value: *value,
                least: self.least_mps,
                most: self.most_mps,
            }),
            _ => Verdict::Refused(self.text.as_str().to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_layouts_are_as_documented() {
        assert_eq!(
            (size_of::<CommandRequest>(), size_of::<Answer>()),
            (56, 256)
        );
        assert_eq!(
            [
                offset_of!(CommandRequest, version),
                offset_of!(CommandRequest, code),
                offset_of!(CommandRequest, airspeed_mps),
                offset_of!(CommandRequest, heading_rad),
                offset_of!(CommandRequest, altitude_m),
                offset_of!(CommandRequest, pressure_altitude_m),
                offset_of!(CommandRequest, height_m),
                offset_of!(CommandRequest, altimeter_setting_pa),
            ],
            [0, 4, 8, 16, 24, 32, 40, 48]
        );
        assert_eq!(
            [
                offset_of!(Answer, code),
                offset_of!(Answer, version),
                offset_of!(Answer, tick),
                offset_of!(Answer, least_mps),
                offset_of!(Answer, most_mps),
                offset_of!(Answer, text),
            ],
            [0, 4, 8, 16, 24, 32]
        );
    }

    #[test]
    fn commands_and_results_are_read_back() {
        for command in [
            FlightCommand::Engage,
            FlightCommand::Disengage,
            FlightCommand::Stop,
            FlightCommand::Set(NewSetpoints {
                heading_rad: Some(1.5),
                height_m: Some(100.0),
                altimeter_setting_pa: Some(101_000.0),
                ..NewSetpoints::default()
            }),
        ] {
            assert_eq!(CommandRequest::from(command).command(), Ok(command));
        }
        for verdict in [
            Verdict::CarriedOut { tick: 9 },
            Verdict::Refused("why".to_owned()),
            Verdict::Outside(OutsideLimits {
                quantity: Quantity::Airspeed,
                value: 90.0,
                least: 40.0,
                most: 60.0,
            }),
        ] {
            let command = FlightCommand::Set(NewSetpoints {
                airspeed_mps: Some(90.0),
                ..NewSetpoints::default()
            });
            assert_eq!(Answer::from(&verdict).verdict(&command), verdict);
        }
    }

    #[test]
    fn another_version_is_refused() {
        let mut request = CommandRequest::from(FlightCommand::Engage);
        request.version = 1;
        let words = request.command().unwrap_err();
        assert!(
            words.contains("version 2") && words.contains("version 1"),
            "{words}"
        );
    }

    proptest! {
        /// Invalid bytes in shared memory never give an invalid command.
        #[test]
        fn any_bytes_are_a_valid_command_or_refused(version in 0..3_u32, code in 0..6_u32, bits: [u64; 6]) {
            let [
                airspeed_mps,
                heading_rad,
                altitude_m,
                pressure_altitude_m,
                height_m,
                altimeter_setting_pa,
            ] = bits.map(f64::from_bits);
            let request = CommandRequest {
                version,
                code,
                airspeed_mps,
                heading_rad,
                altitude_m,
                pressure_altitude_m,
                height_m,
                altimeter_setting_pa,
            };
            if let Ok(command) = request.command() {
                prop_assert!(command.check().is_ok());
            }
        }
    }
}
