//! The outputs and set points in which two configurations are compared.

use std::f64::consts::TAU;

use fcc_core::blocks::wrap_pi;
use fcc_core::framework::schema::{Kind, Value, unit};
use fcc_telemetry::Telemetry;
use fcc_telemetry::schema::{Column, Leaves};
use fcc_telemetry::units::Shown;

use crate::outputs::{TickPair, columns_of};

/// An output or a set point of a controller.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Its name in tables, without the unit: `desired heading`.
    pub name: String,
    /// Its display unit.
    pub unit: &'static str,
    /// Display units per unit of the record.
    scale: f64,
    /// Whether it is an angle that wraps after a full turn: 359° and 1° are 2°
    /// apart.
    wraps: bool,
    /// Its place among the values of a record.
    index: usize,
}

impl Quantity {
    /// All quantities of a controller, outputs first, from the schema of its
    /// record.
    pub(crate) fn all<C: Telemetry>() -> Vec<Self> {
        let parts = ["outputs", "setpoints"].into_iter();
        let columns = parts.flat_map(columns_of::<C>);
        columns
            .filter(|(_, column)| is_number(column.kind))
            .map(|(index, column)| Self::new(index, &column, C::UNITS))
            .collect()
    }

    fn new(index: usize, column: &Column, units: &[Shown]) -> Self {
        let shown = Shown::of(column, units);
        let is_full_turn = |(low, high): (f64, f64)| (high - low - TAU).abs() < 1e-9;
        Self {
            name: unit::of(&column.name).quantity.replace('_', " "),
            unit: shown.unit,
            scale: shown.scale,
            wraps: column.unit == "rad" && column.range.is_some_and(is_full_turn),
            index,
        }
    }

    /// Its value in a record, in [`unit`](Self::unit)s.
    pub(crate) fn of(&self, record: &Leaves) -> f64 {
        self.number(record) * self.scale
    }

    /// The other value less the recorded one.
    pub(crate) fn difference(&self, tick: &TickPair) -> f64 {
        let difference = self.number(&tick.other) - self.number(&tick.recorded);
        let difference = if self.wraps {
            wrap_pi(difference)
        } else {
            difference
        };
        difference * self.scale
    }

    /// Whether only one of the records has a number.
    pub(crate) fn is_in_one(&self, tick: &TickPair) -> bool {
        self.number(&tick.recorded).is_nan() != self.number(&tick.other).is_nan()
    }

    fn number(&self, record: &Leaves) -> f64 {
        match record.as_slice().get(self.index).copied() {
            Some(Value::Number(number)) => number,
            Some(Value::Bool(truth)) => f64::from(u8::from(truth)),
            Some(Value::Count(count)) => count as f64,
            Some(Value::Signed(number)) => number as f64,
            _ => f64::NAN,
        }
    }
}

const fn is_number(kind: Kind) -> bool {
    match kind {
        Kind::Number | Kind::Bool | Kind::Count(_) | Kind::Signed(_) => true,
        Kind::Code(_) | Kind::Flags | Kind::Instant => false,
    }
}
