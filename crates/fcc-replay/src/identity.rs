//! Whether a replay gives the same outputs, bit for bit.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use fcc_core::blocks::wrap_two_pi;
use fcc_core::framework::schema::{Schema, Value};
use fcc_core::framework::{Controller, Record};
use fcc_telemetry::schema::Column;
use serde::Serialize;

use crate::outputs::{TickPair, distance, outputs, text_of};

/// Whether a replay gives the same outputs, bit for bit.
#[derive(Clone, Debug, Serialize)]
pub struct Identity {
    /// Number of outputs compared, over all ticks.
    pub outputs: u64,
    /// Number of outputs that differ.
    pub differing: u64,
    /// The first difference.
    pub first: Option<Difference>,
    /// The outputs that differ, each once.
    pub fields: Vec<FieldDifference>,
    #[serde(skip)]
    compared: Vec<(usize, Column)>,
    #[serde(skip)]
    flag_name: fn(u32) -> &'static str,
    #[serde(skip)]
    tick: TickPair,
}

/// One output of one tick that differs.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Difference {
    /// The tick.
    pub tick: u64,
    /// Milliseconds since the first tick.
    pub time_ms: i64,
    /// The output, as named in the record.
    pub field: String,
    /// The recorded value, as text.
    pub recorded: String,
    /// The replayed value, as text.
    pub again: String,
    /// The recorded bits, hexadecimal.
    pub recorded_bits: String,
    /// The replayed bits, hexadecimal.
    pub again_bits: String,
}

/// The differences of one output over a recording.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct FieldDifference {
    /// The output, as named in the record.
    pub field: String,
    /// Number of ticks in which it differs.
    pub differing: u64,
    /// The first of these ticks.
    pub first_tick: u64,
    /// The largest difference, in the unit of the record; `None` if it is not a
    /// number.
    pub largest: Option<f64>,
}

impl Identity {
    /// No comparison yet, of this controller's records.
    pub fn of<C: Controller>() -> Self {
        Self {
            outputs: 0,
            differing: 0,
            first: None,
            fields: Vec::new(),
            compared: outputs::<C>(),
            flag_name: C::flag_name,
            tick: TickPair::default(),
        }
    }

    /// Compares one tick as recorded and as replayed.
    pub fn take<M: Schema, E: Schema, S: Schema, O: Schema>(
        &mut self,
        recorded: &Record<M, E, S, O>,
        again: &Record<M, E, S, O>,
    ) {
        let since_ns = self.tick.take(recorded, again);
        let (was, is) = (self.tick.recorded.as_slice(), self.tick.other.as_slice());
        for (index, output) in &self.compared {
            let (Some(&was), Some(&is)) = (was.get(*index), is.get(*index)) else {
                continue;
            };
            let was = in_one_turn(output, was);
            if was.bits() == is.bits() {
                continue;
            }
            self.differing += 1;
            if self.first.is_none() {
                self.first = Some(Difference {
                    tick: recorded.tick.number,
                    time_ms: since_ns / 1_000_000,
                    field: output.path.clone(),
                    recorded: text_of(output.kind, was, self.flag_name),
                    again: text_of(output.kind, is, self.flag_name),
                    recorded_bits: format!("{:#018x}", was.bits()),
                    again_bits: format!("{:#018x}", is.bits()),
                });
            }
            let distance = distance(was, is);
            match self.fields.iter_mut().find(|f| f.field == output.path) {
                Some(known) => {
                    known.differing += 1;
                    known.largest = known.largest.max_of(distance);
                }
                None => self.fields.push(FieldDifference {
                    field: output.path.clone(),
                    differing: 1,
                    first_tick: recorded.tick.number,
                    largest: distance,
                }),
            }
        }
        self.outputs += self.compared.len() as u64;
    }

    /// Whether nothing differs.
    pub const fn is_identical(&self) -> bool {
        self.differing == 0
    }

    /// The comparison as text.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{} outputs compared bit for bit: {} differ",
            self.outputs, self.differing
        );
        if let Some(first) = &self.first {
            let _ = write!(
                text,
                "\n\nfirst in tick {}, {:.3} s after the first tick: {}\n  \
                 recorded  {}  {}\n  replayed  {}  {}\n",
                first.tick,
                first.time_ms as f64 * 1e-3,
                first.field,
                first.recorded_bits,
                first.recorded,
                first.again_bits,
                first.again,
            );
        }
        for field in &self.fields {
            let _ = write!(
                text,
                "\n{:27} differs in {:7} ticks from {} on",
                field.field, field.differing, field.first_tick
            );
            if let Some(largest) = field.largest {
                let _ = write!(text, ", at most by {largest:e}");
            }
        }
        text
    }
}

/// A direction in one turn: earlier recordings have some that continue through full turns.
fn in_one_turn(output: &Column, value: Value) -> Value {
    match value {
        Value::Number(rad) if output.range == Some((0.0, TAU)) => Value::Number(wrap_two_pi(rad)),
        value => value,
    }
}

/// The larger of two optional values.
trait MaxOf {
    fn max_of(self, other: Self) -> Self;
}

impl MaxOf for Option<f64> {
    fn max_of(self, other: Self) -> Self {
        match (self, other) {
            (Some(one), Some(two)) => Some(one.max(two)),
            (one, two) => one.or(two),
        }
    }
}
