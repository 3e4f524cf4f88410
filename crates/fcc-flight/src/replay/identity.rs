//! Whether a recording flown again gives the same outputs, bit for bit.

use std::fmt::Write as _;

use fcc_telemetry::FlightRecord;
use serde::Serialize;

use super::fields::{Output, distance, outputs, values, words};

/// Whether a recording flown again gives the same outputs, bit for bit.
#[derive(Clone, Debug, Serialize)]
pub struct Identity {
    /// Outputs compared, of all ticks.
    pub outputs: u64,
    /// How many of them differ.
    pub differing: u64,
    /// The first that differs.
    pub first: Option<Difference>,
    /// The outputs that differ anywhere, each once.
    pub fields: Vec<FieldDifference>,
    #[serde(skip)]
    began_ns: Option<i64>,
    #[serde(skip)]
    compared: Vec<Output>,
}

/// One output of one tick that differs.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Difference {
    /// The tick.
    pub tick: u64,
    /// Milliseconds since the first tick.
    pub time_ms: i64,
    /// The output, as the record calls it.
    pub field: String,
    /// What was recorded, in words for people.
    pub recorded: String,
    /// What it is when flown again.
    pub again: String,
    /// The recorded bits, hexadecimal.
    pub recorded_bits: String,
    /// The bits when flown again.
    pub again_bits: String,
}

/// How one output differs over a recording.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct FieldDifference {
    /// The output, as the record calls it.
    pub field: String,
    /// In how many ticks it differs.
    pub differing: u64,
    /// The first of them.
    pub first_tick: u64,
    /// The largest difference, in the unit of the record; none for what is no
    /// number.
    pub largest: Option<f64>,
}

impl Default for Identity {
    fn default() -> Self {
        Self {
            outputs: 0,
            differing: 0,
            first: None,
            fields: Vec::new(),
            began_ns: None,
            compared: outputs(),
        }
    }
}

impl Identity {
    /// Compares one tick as recorded and as flown again.
    pub fn take(&mut self, recorded: &FlightRecord, again: &FlightRecord) {
        let at_ns = recorded.tick.scheduled.as_nanos();
        let began_ns = *self.began_ns.get_or_insert(at_ns);
        let (recorded_values, again_values) = (values(recorded), values(again));
        for output in &self.compared {
            let (Some(was), Some(is)) = (
                recorded_values.as_slice().get(output.index).copied(),
                again_values.as_slice().get(output.index).copied(),
            ) else {
                continue;
            };
            if was.bits() == is.bits() {
                continue;
            }
            self.differing += 1;
            if self.first.is_none() {
                self.first = Some(Difference {
                    tick: recorded.tick.number,
                    time_ms: at_ns.saturating_sub(began_ns) / 1_000_000,
                    field: output.name.clone(),
                    recorded: words(output.kind, was),
                    again: words(output.kind, is),
                    recorded_bits: format!("{:#018x}", was.bits()),
                    again_bits: format!("{:#018x}", is.bits()),
                });
            }
            let distance = distance(was, is);
            match self.fields.iter_mut().find(|f| f.field == output.name) {
                Some(known) => {
                    known.differing += 1;
                    known.largest = known.largest.max_of(distance);
                }
                None => self.fields.push(FieldDifference {
                    field: output.name.clone(),
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

    /// For people.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{} outputs compared bit for bit: {} differ",
            self.outputs, self.differing
        );
        if let Some(first) = &self.first {
            let _ = write!(
                text,
                "\n\nfirst in tick {}, {:.3} s after the first tick: {}\n  \
                 recorded     {}  {}\n  flown again  {}  {}\n",
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

/// The larger of two that may not be there.
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
