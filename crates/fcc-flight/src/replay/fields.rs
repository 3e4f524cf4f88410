//! The outputs of a tick that are compared.

use std::fmt;

use fcc_core::flight::Autopilot;
use fcc_core::framework::{Controller, Flags, StateCode};
use fcc_telemetry::FlightRecord;

/// One output of a tick: its name and how it is read.
pub(super) struct Field {
    /// As in the record.
    pub(super) name: &'static str,
    pub(super) value: fn(&FlightRecord) -> Value,
}

/// How many outputs a tick has.
pub(super) const COUNT: usize = 15;

const fn field(name: &'static str, value: fn(&FlightRecord) -> Value) -> Field {
    Field { name, value }
}

/// All outputs of a tick, causes before what they lead to, so that the first
/// that differs is the most telling.
pub(super) const FIELDS: [Field; COUNT] = [
    field("tick.dt_s", |r| Value::Number(r.tick.dt_s)),
    field("engage_inhibits", |r| Value::Flags(r.engage_inhibits)),
    field("faults", |r| Value::Flags(r.faults)),
    field("state", |r| Value::State(r.state)),
    field("setpoints.airspeed_mps", |r| {
        Value::Number(r.setpoints.airspeed_mps)
    }),
    field("setpoints.heading_rad", |r| {
        Value::Number(r.setpoints.heading_rad)
    }),
    field("setpoints.altitude_m", |r| {
        Value::Number(r.setpoints.altitude_m)
    }),
    field("setpoints.roll_rad", |r| {
        Value::Number(r.setpoints.roll_rad)
    }),
    field("setpoints.climb_rate_mps", |r| {
        Value::Number(r.setpoints.climb_rate_mps)
    }),
    field("setpoints.pitch_rad", |r| {
        Value::Number(r.setpoints.pitch_rad)
    }),
    field("outputs.throttle", |r| Value::Number(r.outputs.throttle)),
    field("outputs.elevator", |r| Value::Number(r.outputs.elevator)),
    field("outputs.aileron", |r| Value::Number(r.outputs.aileron)),
    field("outputs.rudder", |r| Value::Number(r.outputs.rudder)),
    field("sent", |r| Value::Truth(r.sent)),
];

/// The value of an output.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Number(f64),
    State(StateCode),
    Flags(Flags),
    Truth(bool),
}

impl Value {
    /// Its bits: equal only for what is the same to the last of them, a NaN
    /// and the sign of zero included.
    pub(super) fn bits(self) -> u64 {
        match self {
            Self::Number(number) => number.to_bits(),
            Self::State(state) => {
                u64::from(state.phase())
                    | u64::from(state.cause()) << 8
                    | u64::from(state.flags().bits()) << 32
            }
            Self::Flags(flags) => flags.bits().into(),
            Self::Truth(truth) => truth.into(),
        }
    }

    /// How far two numbers are apart; none for what is no number.
    pub(super) fn distance(self, other: Self) -> Option<f64> {
        match (self, other) {
            (Self::Number(one), Self::Number(two)) => {
                Some((one - two).abs()).filter(|distance| distance.is_finite())
            }
            _ => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // As many digits as tell it from every other number.
            Self::Number(number) => write!(f, "{number:?}"),
            Self::State(state) => write!(f, "{state}"),
            Self::Flags(flags) if flags.is_empty() => f.write_str("none"),
            Self::Flags(flags) => {
                for (n, bit) in flags.iter().enumerate() {
                    let separator = if n == 0 { "" } else { ", " };
                    write!(f, "{separator}{}", Autopilot::flag_name(bit))?;
                }
                Ok(())
            }
            Self::Truth(true) => f.write_str("yes"),
            Self::Truth(false) => f.write_str("no"),
        }
    }
}
