//! The outputs of a tick that are compared.

use std::fmt::Write as _;

use fcc_core::framework::schema::{Kind, Schema, Value};
use fcc_core::framework::{Controller, Flags, Record, RecordOf};
use fcc_telemetry::schema::{Column, Leaves, columns};

/// The values of a record that the loop computes, causes before effects, so
/// that the first difference is the closest to the cause. The other values are
/// inputs or durations.
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

/// All outputs of a tick, each with its place among the values of a record.
pub(super) fn outputs<C: Controller>() -> Vec<(usize, Column)> {
    let found = OUTPUTS.into_iter().flat_map(columns_of::<C>);
    found.collect()
}

/// The values of one part of a record, each with its place among all values.
pub(super) fn columns_of<C: Controller>(part: &str) -> Vec<(usize, Column)> {
    let is_in = |path: &str| {
        path.strip_prefix(part)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    let all = columns::<RecordOf<C>>().into_iter().enumerate();
    all.filter(|(_, column)| is_in(&column.path)).collect()
}

/// One tick in two runs: the values of both records. Its memory is used again.
#[derive(Clone, Debug, Default)]
pub(super) struct TickPair {
    began_ns: Option<i64>,
    pub(super) recorded: Leaves,
    pub(super) other: Leaves,
}

impl TickPair {
    /// Takes the next tick; the time since the first, ns.
    pub(super) fn take<M: Schema, E: Schema, S: Schema, O: Schema>(
        &mut self,
        recorded: &Record<M, E, S, O>,
        other: &Record<M, E, S, O>,
    ) -> i64 {
        self.recorded.take(recorded);
        self.other.take(other);
        let at_ns = recorded.tick.scheduled.as_nanos();
        at_ns.saturating_sub(*self.began_ns.get_or_insert(at_ns))
    }
}

/// The distance of two numbers; `None` if one is not a number.
pub(super) fn distance(one: Value, other: Value) -> Option<f64> {
    match (one, other) {
        (Value::Number(one), Value::Number(two)) => {
            Some((one - two).abs()).filter(|distance| distance.is_finite())
        }
        _ => None,
    }
}

/// A value as text.
pub(super) fn text_of(kind: Kind, value: Value, flag_name: fn(u32) -> &'static str) -> String {
    match (kind, value) {
        // Enough digits to distinguish it from every other number.
        (_, Value::Number(number)) => format!("{number:?}"),
        (_, Value::Bool(truth)) => if truth { "yes" } else { "no" }.to_owned(),
        (_, Value::Flags(0)) => "none".to_owned(),
        (_, Value::Flags(bits)) => {
            let mut text = String::new();
            for bit in Flags::from_bits(bits).iter() {
                let separator = if text.is_empty() { "" } else { ", " };
                let _ = write!(text, "{separator}{}", flag_name(bit));
            }
            text
        }
        (Kind::Code(of), Value::Code(number)) => {
            fcc_telemetry::schema::spaced(of.name_of(number).unwrap_or_default())
        }
        (_, value) => value.bits().to_string(),
    }
}
