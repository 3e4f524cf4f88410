//! The outputs of a tick that are compared.

use std::fmt::Write as _;

use fcc_core::flight::Autopilot;
use fcc_core::framework::schema::{Kind, Schema, Value, Values};
use fcc_core::framework::{Controller, Flags};
use fcc_telemetry::FlightRecord;
use fcc_telemetry::schema::columns;

/// What of a record the loop works out, causes before what they lead to, so
/// that the first that differs is the most telling. The rest is what came into
/// the loop, or how long things took.
const OUTPUTS: [&str; 8] = [
    "tick.dt_s",
    "estimate",
    "engage_inhibits",
    "faults",
    "state",
    "setpoints",
    "outputs",
    "sent",
];

/// How many single values a record has.
pub(super) const VALUES: usize = <FlightRecord as Schema>::TYPE.leaves();

/// One output of a tick: its name, and which of a record's values it is.
#[derive(Clone, Debug)]
pub(super) struct Output {
    /// As in the record.
    pub(super) name: String,
    pub(super) index: usize,
    pub(super) kind: Kind,
}

/// All outputs of a tick.
pub(super) fn outputs() -> Vec<Output> {
    let columns = columns::<FlightRecord>();
    let is_in = |path: &str, output: &str| {
        path.strip_prefix(output)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    let of = |output: &'static str| {
        let all = columns.iter().enumerate();
        all.filter(move |(_, column)| is_in(&column.path, output))
    };
    let found = OUTPUTS.into_iter().flat_map(of);
    found
        .map(|(index, column)| Output {
            name: column.path.clone(),
            index,
            kind: column.kind,
        })
        .collect()
}

/// The values of a record, one after another.
pub(super) fn values(record: &FlightRecord) -> Values<VALUES> {
    let mut values = Values::default();
    record.visit(&mut values);
    values
}

/// How far two numbers are apart; none for what is no number.
pub(super) fn distance(one: Value, other: Value) -> Option<f64> {
    match (one, other) {
        (Value::Number(one), Value::Number(two)) => {
            Some((one - two).abs()).filter(|distance| distance.is_finite())
        }
        _ => None,
    }
}

/// A value for people.
pub(super) fn words(kind: Kind, value: Value) -> String {
    match (kind, value) {
        // As many digits as tell it from every other number.
        (_, Value::Number(number)) => format!("{number:?}"),
        (_, Value::Bool(truth)) => if truth { "yes" } else { "no" }.to_owned(),
        (_, Value::Flags(0)) => "none".to_owned(),
        (_, Value::Flags(bits)) => {
            let mut text = String::new();
            for bit in Flags::from_bits(bits).iter() {
                let separator = if text.is_empty() { "" } else { ", " };
                let _ = write!(text, "{separator}{}", Autopilot::flag_name(bit));
            }
            text
        }
        (Kind::Code(of), Value::Code(number)) => {
            fcc_telemetry::schema::spaced(of.name_of(number).unwrap_or_default())
        }
        (_, value) => value.bits().to_string(),
    }
}
