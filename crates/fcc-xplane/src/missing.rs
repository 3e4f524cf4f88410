//! Values that were requested and do not arrive while other values do.
//!
//! X-Plane does not answer a request for a dataref that it does not have, nor
//! does it report that a row of Data Output is switched off: a mistyped path, a
//! plugin that is not loaded and an old version all result in silence. (A
//! version that answers such a request with 0 cannot be distinguished from a
//! switch that is off, so the switch's path is logged at the first contact. That
//! a version answers so is known by its answer to a request for a dataref that
//! does not exist; that it lacks a generic light, by the light's number.)

use core::fmt;
use core::time::Duration;

use fcc_core::framework::Time;

use crate::config::{DataRows, PlantKind};
use crate::engage_switch;
use crate::quantity::Quantity;
use crate::rows::row_of;

/// A value that has not arrived for this long, while others have, is missing:
/// until then its request was repeated each second.
const IN_VAIN: Duration = Duration::from_secs(4);
/// The interval between two checks.
const LOOK_EVERY: Duration = Duration::from_secs(1);

/// A set of values that are read from X-Plane.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct ValueSet(u64);

/// The bit of the position, which is not a [`Quantity`].
const POSITION: u64 = 1 << Quantity::COUNT;
const _: () = assert!(Quantity::COUNT < 64);

impl ValueSet {
    pub(crate) const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }

    pub(crate) const fn bits(self) -> u64 {
        self.0
    }

    /// Whether values are missing that every version has and no row: then no
    /// request is answered.
    pub(crate) fn has_no_answer(self) -> bool {
        [
            Quantity::Paused,
            Quantity::OverrideJoystick,
            Quantity::OverrideThrottles,
        ]
        .into_iter()
        .all(|quantity| self.holds(Expected::Value(quantity).bit()))
    }

    const fn holds(self, bit: u64) -> bool {
        self.0 & bit != 0
    }
}

/// A value that is expected to arrive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Expected {
    Value(Quantity),
    Position,
}

impl Expected {
    const fn bit(self) -> u64 {
        match self {
            Self::Value(quantity) => 1 << (quantity as u8),
            Self::Position => POSITION,
        }
    }

    /// Whether its absence there is reported.
    pub(crate) fn is_needed_of(self, plant: PlantKind) -> bool {
        match (plant, self) {
            (PlantKind::Simulator, Self::Value(quantity)) => quantity.is_needed(),
            (PlantKind::Simulator, Self::Position) => true,
            (PlantKind::ServoBoard, Self::Value(quantity)) => quantity.is_override(),
            (PlantKind::ServoBoard, Self::Position) => false,
        }
    }
}

/// Finds out which values are missing.
#[derive(Debug)]
pub(crate) struct MissingValues {
    expected: Vec<Expected>,
    resubscribe: Duration,
    /// Since when the simulator has been sending without interruption; never
    /// while it is silent.
    sending_since: Time,
    looked: Time,
    /// At the last check.
    missing: ValueSet,
}

impl MissingValues {
    pub(crate) const fn new(expected: Vec<Expected>, resubscribe: Duration) -> Self {
        Self {
            expected,
            resubscribe,
            sending_since: Time::NEVER,
            looked: Time::NEVER,
            missing: ValueSet::from_bits(0),
        }
    }

    /// The missing values, once a second; `None` in between. `last_received` is
    /// when anything last arrived, `arrived` when a given value last did.
    pub(crate) fn check(
        &mut self,
        now: Time,
        last_received: Time,
        arrived: impl Fn(Expected) -> Time,
    ) -> Option<ValueSet> {
        if now.since(self.looked) < LOOK_EVERY {
            return None;
        }
        self.looked = now;
        if now.since(last_received) >= LOOK_EVERY {
            // What was missing before the silence stays missing until it
            // arrives.
            self.sending_since = Time::NEVER;
            return None;
        }
        if self.sending_since.is_never() {
            self.sending_since = now;
        }
        let missing = self.expected.iter().filter(|expected| {
            let arrived = arrived(**expected);
            let patience = if arrived.is_never() {
                IN_VAIN
            } else {
                // It has arrived before, so it was not requested again during
                // this time.
                self.resubscribe + IN_VAIN
            };
            // What was missing before a silence has not arrived by its end.
            let since = if self.missing.holds(expected.bit()) {
                arrived
            } else {
                arrived.max(self.sending_since)
            };
            since.is_never() || now.since(since) >= patience
        });
        self.missing = ValueSet(missing.fold(0, |set, value| set | value.bit()));
        Some(self.missing)
    }
}

/// A value that was requested and does not arrive although others do. Its text
/// says what to do.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Missing {
    /// The dataref of [`engage_switch`](crate::XPlaneConfig::engage_switch).
    EngageSwitch(String),
    /// The same, of a generic light that this version does not have.
    GenericLight {
        /// The path.
        path: String,
        /// The number of generic lights that it has.
        lights: u32,
    },
    /// The same, of a version that answers requests for datarefs that it does
    /// not have: whether it has this one is not known.
    MaybeEngageSwitch(String),
    /// Another dataref.
    Dataref(String),
    /// A row of Data Output.
    Row(i32),
    /// The position, by RPOS.
    Position,
}

impl Missing {
    /// The values of a set, with each row once.
    pub(crate) fn of(set: ValueSet, engage_switch: &str, rows: Option<DataRows>) -> Vec<Self> {
        let mut missing = Vec::new();
        for quantity in Quantity::all() {
            if !set.holds(Expected::Value(quantity).bit()) {
                continue;
            }
            let row = rows.filter(|_| quantity.comes_in_rows());
            let what = match row.and_then(|rows| row_of(rows, quantity)) {
                Some(row) => Some(Self::Row(row)),
                None if quantity == Quantity::EngageSwitch => {
                    Some(Self::EngageSwitch(engage_switch.to_owned()))
                }
                None => quantity.path(engage_switch).map(Self::Dataref),
            };
            missing.extend(what.filter(|what| !missing.contains(what)));
        }
        if set.holds(POSITION) {
            missing.push(Self::Position);
        }
        missing
    }

    /// A short name of the value.
    pub fn what(&self) -> String {
        match self {
            Self::EngageSwitch(path)
            | Self::GenericLight { path, .. }
            | Self::MaybeEngageSwitch(path) => {
                format!("x-plane.engage_switch \"{path}\"")
            }
            Self::Dataref(path) => format!("the dataref {path}"),
            Self::Row(row) => format!("row {row} of Data Output"),
            Self::Position => "the position (RPOS)".to_owned(),
        }
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Self::GenericLight { path, lights } = self {
            return write!(
                f,
                "x-plane.engage_switch \"{path}\" does not exist in this version of X-Plane, so it \
                 cannot be used to engage: it has generic lights 0 to {}. Choose one that no \
                 aircraft uses, such as {}.",
                lights.saturating_sub(1),
                engage_switch::DEFAULT
            );
        }
        if let Self::MaybeEngageSwitch(path) = self {
            return write!(
                f,
                "x-plane.engage_switch \"{path}\" may not exist: this version of X-Plane answers \
                 requests for datarefs that it does not have, too. If it does not engage, check \
                 its spelling, and that the plugin or aircraft that provides it is loaded."
            );
        }
        write!(f, "X-Plane does not send {}", self.what())?;
        f.write_str(match self {
            Self::GenericLight { .. } | Self::MaybeEngageSwitch(_) => "",
            Self::EngageSwitch(_) => {
                ", so it cannot be used to engage. Check its spelling (X-Plane's own datarefs are \
                 listed in its Resources/plugins/DataRefs.txt), and that the plugin or aircraft \
                 that provides it is loaded."
            }
            Self::Dataref(_) => ", although it sends others: this version may not have it.",
            Self::Row(_) => {
                ", although it sends others: switch the row on in Settings > Data Output, for the \
                 network, and check that x-plane.data_version is its version."
            }
            Self::Position => ", although it sends datarefs: this version may not have it.",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::RowsVersion;

    fn seconds(s: i64) -> Time {
        Time::from_nanos(1_000_000_000_000 + s * 1_000_000_000)
    }

    fn missing_values() -> MissingValues {
        let expected = vec![
            Expected::Value(Quantity::EngageSwitch),
            Expected::Value(Quantity::Altitude),
        ];
        MissingValues::new(expected, Duration::from_secs(5))
    }

    /// The missing values after the last check.
    fn after(checks: i64, arrived: impl Fn(i64, Expected) -> Time) -> ValueSet {
        let mut missing_values = missing_values();
        let mut set = ValueSet::default();
        for second in 0..=checks {
            let now = seconds(second);
            set = missing_values
                .check(now, now, |of| arrived(second, of))
                .unwrap_or(set);
        }
        set
    }

    const SWITCH: Expected = Expected::Value(Quantity::EngageSwitch);

    #[test]
    fn a_value_that_never_arrives_is_missing_after_four_seconds() {
        let never = |second, of| {
            if of == SWITCH {
                Time::NEVER
            } else {
                seconds(second)
            }
        };
        assert_eq!(after(3, never), ValueSet::default());
        assert_eq!(after(4, never).bits(), SWITCH.bit());
    }

    #[test]
    fn a_value_that_arrived_before_is_requested_again_first() {
        let once = |second, of| seconds(if of == SWITCH { 0 } else { second });
        assert_eq!(after(8, once), ValueSet::default());
        assert_eq!(after(9, once).bits(), SWITCH.bit());
    }

    #[test]
    fn nothing_is_missing_while_the_simulator_is_silent() {
        let mut missing_values = missing_values();
        for second in 0..100 {
            let last_received = Time::NEVER;
            assert_eq!(
                missing_values.check(seconds(second), last_received, |_| Time::NEVER),
                None
            );
        }
        for second in 100..104 {
            let now = seconds(second);
            let set = missing_values.check(now, now, |_| Time::NEVER);
            assert_eq!(set, Some(ValueSet::default()), "{second}");
        }
    }

    #[test]
    fn what_never_arrived_stays_missing_after_a_silence() {
        let mut missing_values = missing_values();
        let mut last_received = seconds(0);
        for second in 0..30 {
            let now = seconds(second);
            let silent = (10..15).contains(&second);
            if !silent {
                last_received = now;
            }
            let arrives = second >= 25;
            let set = missing_values.check(now, last_received, |of| {
                if of == SWITCH && !arrives {
                    Time::NEVER
                } else {
                    last_received
                }
            });
            let expected = if (4..25).contains(&second) {
                SWITCH.bit()
            } else {
                0
            };
            let expected = (!silent).then_some(ValueSet::from_bits(expected));
            assert_eq!(set, expected, "{second}");
        }
    }

    #[test]
    fn rows_are_named_once_each_and_by_their_version() {
        let attitude = [Quantity::Pitch, Quantity::Roll, Quantity::MagneticHeading];
        let bits = attitude.map(|quantity| Expected::Value(quantity).bit());
        let set = ValueSet::from_bits(bits.iter().sum());
        let named = |version| Missing::of(set, "", Some(DataRows::of(version)));
        assert_eq!(named(RowsVersion::XPlane12), [Missing::Row(17)]);
        assert_eq!(named(RowsVersion::XPlane9), [Missing::Row(18)]);
        assert_eq!(Missing::of(set, "", None).len(), 3);
    }
}
