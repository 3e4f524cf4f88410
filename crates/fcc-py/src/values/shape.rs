//! The single values of a struct, by their index.

use std::any::TypeId;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use fcc_core::framework::Time;
use fcc_core::framework::schema::{self, Field, Kind, Schema, Source, Unknown, Value, unit};
use fcc_telemetry::schema::{Column, columns};
use pyo3::prelude::*;

use crate::arguments::{finite, within};

/// The most single values that a struct may have.
const MOST: usize = 128;

/// All single values of a struct, in their order.
type Flat = schema::Values<MOST>;

/// What the single values of a struct are.
pub(crate) struct Shape {
    pub(crate) leaves: Vec<Leaf>,
    /// The names of its readings: `heading`, `body_rates`.
    pub(crate) readings: Vec<&'static str>,
}

/// A single value of a struct.
pub(crate) struct Leaf {
    pub(crate) column: Column,
    /// The index of the reading that it is a part of.
    pub(crate) reading: Option<usize>,
    part: ReadingPart,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum ReadingPart {
    Value,
    Taken,
    Source,
}

impl Leaf {
    /// Whether it is measured or computed, and not the time or sensor of a
    /// reading.
    pub(crate) fn is_value(&self) -> bool {
        self.part == ReadingPart::Value
    }
}

impl Shape {
    /// The shape of a struct; worked out once.
    pub(crate) fn of<T: Schema>() -> &'static Self {
        static KNOWN: Mutex<Option<HashMap<TypeId, &'static Shape>>> = Mutex::new(None);
        const { assert!(T::TYPE.leaves() <= MOST, "more values than there is room") };
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        known
            .get_or_insert_default()
            .entry(TypeId::of::<T>())
            .or_insert_with(|| Box::leak(Box::new(Self::new::<T>())))
    }

    fn new<T: Schema>() -> Self {
        let mut paths: Vec<String> = Vec::new();
        let mut leaf = |column: Column| {
            let reading = column.reading.clone().map(|path| {
                let known = paths.iter().position(|known| *known == path);
                known.unwrap_or_else(|| {
                    paths.push(path);
                    paths.len() - 1
                })
            });
            let end = reading.and(column.path.rsplit('.').next());
            Leaf {
                part: match (column.kind, end) {
                    (Kind::Instant, Some("taken")) => ReadingPart::Taken,
                    (Kind::Count(_), Some("source")) => ReadingPart::Source,
                    _ => ReadingPart::Value,
                },
                reading,
                column,
            }
        };
        let leaves = columns::<T>().into_iter().map(&mut leaf).collect();
        let name = |path: &String| {
            let field = T::FIELDS.iter().find(|field| field.name == path);
            field.map_or("", |field| unit::of(field.name).quantity)
        };
        Self {
            leaves,
            readings: paths.iter().map(name).collect(),
        }
    }

    /// A struct whose numbers are NaN and whose readings are taken at 0, except
    /// those whose names are in `without`; nothing else has a value.
    pub(crate) fn blank<T: Schema>(&self, without: &[&str]) -> T {
        let mut blank = T::default();
        let given = |index: usize| {
            let leaf = self.leaves.get(index)?;
            let name = self.readings.get(leaf.reading?)?;
            match (leaf.part, leaf.column.kind) {
                _ if without.contains(name) => None,
                (ReadingPart::Taken, _) => Some(Value::Instant(0)),
                (ReadingPart::Value, Kind::Number) => Some(Value::Number(f64::NAN)),
                _ => None,
            }
        };
        let _ = fill(&mut blank, given);
        blank
    }

    /// Copies the values of all readings that `from` has; each was taken `now`,
    /// plus its own time, or when the reading in `into` was.
    pub(crate) fn copy<T: Schema>(&self, from: &T, into: &mut T, now: Option<Time>) {
        let (values, before) = (flat(from), flat(into));
        let mut taken = [false; MOST];
        for (leaf, value) in self.leaves.iter().zip(values.as_slice()) {
            if let (ReadingPart::Taken, Some(reading)) = (leaf.part, leaf.reading)
                && let Some(taken) = taken.get_mut(reading)
            {
                *taken = !value.is_never();
            }
        }
        let is_taken = |leaf: &Leaf| {
            let reading = leaf.reading.and_then(|reading| taken.get(reading));
            reading.copied().unwrap_or(true)
        };
        let given = |index: usize| {
            let leaf = self.leaves.get(index).filter(|leaf| is_taken(leaf))?;
            match (leaf.part, now) {
                (ReadingPart::Value, _) => values.as_slice().get(index).copied(),
                (ReadingPart::Taken, Some(now)) => match values.as_slice().get(index) {
                    Some(Value::Instant(from_now)) => {
                        Some(Value::Instant(now.as_nanos().saturating_add(*from_now)))
                    }
                    _ => None,
                },
                _ => before.as_slice().get(index).copied(),
            }
        };
        // Values of the same type are values that are declared.
        let _ = fill(into, given);
    }

    /// Sets when readings were taken, before a tick whose time is not known: those
    /// of which an age in ns is given.
    pub(crate) fn set_ages<T: Schema>(&self, of: &mut T, age_ns: impl Fn(&str) -> Option<i64>) {
        let values = flat(of);
        let given = |index: usize| {
            let leaf = self.leaves.get(index)?;
            let reading = leaf.reading.filter(|_| leaf.part == ReadingPart::Taken)?;
            let is_taken = values
                .as_slice()
                .get(index)
                .is_some_and(|at| !at.is_never());
            let age_ns = age_ns(self.readings.get(reading)?)?;
            is_taken.then_some(Value::Instant(-age_ns))
        };
        let _ = fill(of, given);
    }

    /// Marks as never taken the readings of which every number is NaN, and
    /// those that are `missing`.
    pub(crate) fn forget<T: Schema>(&self, of: &mut T, missing: impl Fn(&str) -> bool) {
        let values = flat(of);
        let has_number = |reading: usize| {
            let mut parts = self.leaves.iter().zip(values.as_slice());
            parts.any(|(leaf, value)| {
                let is_nan = matches!(value, Value::Number(number) if number.is_nan());
                leaf.reading == Some(reading) && leaf.is_value() && !is_nan
            })
        };
        let given = |index: usize| {
            let leaf = self.leaves.get(index)?;
            let reading = leaf.reading.filter(|_| leaf.part == ReadingPart::Taken)?;
            let name = self.readings.get(reading).copied().unwrap_or_default();
            let is_missing = missing(name) || !has_number(reading);
            is_missing.then_some(Value::Instant(Time::NEVER.as_nanos()))
        };
        let _ = fill(of, given);
    }
}

/// The single values of a struct.
pub(super) fn flat<T: Schema>(of: &T) -> Flat {
    let mut flat = Flat::default();
    of.visit(&mut flat);
    flat
}

/// Sets the single values for which `given` has another.
pub(super) fn fill<T: Schema>(
    of: &mut T,
    given: impl FnMut(usize) -> Option<Value>,
) -> Result<(), Unknown> {
    struct Given<F> {
        next: usize,
        given: F,
    }
    impl<F: FnMut(usize) -> Option<Value>> Source for Given<F> {
        fn value(&mut self, _: &'static Field) -> Option<Value> {
            self.next += 1;
            (self.given)(self.next - 1)
        }
    }
    of.read(T::ROOT, &mut Given { next: 0, given })
}

/// A struct, each of its numbers finite and in its declared range, or missing
/// where it is missing by default.
///
/// # Errors
/// When one is not.
pub fn checked<T: Schema>(of: T) -> PyResult<T> {
    let values = flat(&of);
    let blank = flat(&T::default());
    let each = values.as_slice().iter().zip(blank.as_slice());
    for (leaf, (value, blank)) in Shape::of::<T>().leaves.iter().zip(each) {
        let is_nan = |value: &Value| matches!(value, Value::Number(number) if number.is_nan());
        if is_nan(value) && is_nan(blank) {
            continue;
        }
        let Value::Number(number) = *value else {
            continue;
        };
        let name = &leaf.column.name;
        match leaf.column.range {
            Some((least, most)) => within(name, number, least, most)?,
            None => finite(name, number)?,
        };
    }
    Ok(of)
}
