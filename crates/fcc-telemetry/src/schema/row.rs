//! A struct as a row of a table.

use std::fmt::Write as _;

use fcc_core::framework::schema::{Field, Kind, Schema, Sink, Type, Value};

use super::columns::columns_and_derived;
use super::layout::spaced;

/// The names of a table's columns: values, then derived values.
pub fn header<T: Schema>() -> Vec<String> {
    let all = columns_and_derived::<T>();
    all.into_iter().map(|column| column.name).collect()
}

/// A row of a table: one cell for each value, as recorded; empty for a reading
/// that was never taken. Codes are given by name.
#[derive(Clone, Debug, Default)]
pub struct Row {
    cells: Vec<String>,
    used: usize,
    /// The first cell of each struct that has begun and not ended.
    open: Vec<usize>,
    never: bool,
}

impl Row {
    /// Replaces the previous row.
    pub fn take<T: Schema>(&mut self, value: &T) {
        self.used = 0;
        self.open.clear();
        value.visit(self);
    }

    /// The cells, in the order of [`header`].
    pub fn cells(&self) -> &[String] {
        self.cells.get(..self.used).unwrap_or_default()
    }

    fn cell(&mut self) -> Option<&mut String> {
        if self.used == self.cells.len() {
            self.cells.push(String::new());
        }
        self.used += 1;
        let cell = self.cells.get_mut(self.used - 1)?;
        cell.clear();
        Some(cell)
    }
}

impl Sink for Row {
    fn begin(&mut self, _: &'static Field) {
        self.open.push(self.used);
        self.never = false;
    }

    fn end(&mut self, field: &'static Field) {
        let first = self.open.pop().unwrap_or(self.used);
        // A reading that was never taken has no value.
        if let Type::Struct(of) = field.of
            && of.is_reading
            && std::mem::take(&mut self.never)
            && let Some(cells) = self.cells.get_mut(first..self.used)
        {
            cells.iter_mut().for_each(String::clear);
        }
    }

    fn value(&mut self, field: &'static Field, value: Value) {
        self.never |= value.is_never();
        let Some(cell) = self.cell() else {
            return;
        };
        // Writing to a string does not fail.
        let _ = match value {
            _ if value.is_never() => Ok(()),
            Value::Bool(value) => write!(cell, "{}", u8::from(value)),
            Value::Code(number) => match field.of {
                Type::Leaf(Kind::Code(of)) => {
                    write!(cell, "{}", spaced(of.name_of(number).unwrap_or_default()))
                }
                _ => write!(cell, "{number}"),
            },
            Value::Flags(bits) => write!(cell, "{bits}"),
            Value::Count(count) => write!(cell, "{count}"),
            Value::Signed(number) | Value::Instant(number) => write!(cell, "{number}"),
            Value::Number(number) => write!(cell, "{number}"),
        };
    }

    fn derived(&mut self, _: &'static Field, value: f64) {
        if let Some(cell) = self.cell() {
            let _ = write!(cell, "{value}");
        }
    }
}
