//! Reads the ticks and events of a recording.

use fcc_live::Event;
use fcc_record::{AnyPlantMessage, Item, Recording};
use fcc_telemetry::schema::RecordDescription;
use fcc_telemetry::schema::protobuf::RowDecoder;
use serde_json::{Value, json};

use crate::columns::{Columns, PageColumn};
use crate::failure::Failure;

/// Values of a table in memory, at most: 10 columns of an hour at 1 kHz.
const MOST_VALUES: usize = 40_000_000;

/// The columns of a recording, and how its rows are read.
pub(super) struct Scanner {
    description: RecordDescription,
    pub(super) columns: Columns,
}

impl Scanner {
    pub(super) fn of(recording: &Recording) -> Result<Self, Failure> {
        let damaged = || Failure::bad("the columns of this recording are damaged");
        let description = recording.columns().ok_or_else(damaged)?.clone();
        let columns = Columns::of(&description);
        Ok(Self {
            description,
            columns,
        })
    }

    /// Gives each row, and each event; ends early when `take` returns false.
    pub(super) fn read(
        &self,
        recording: &Recording,
        mut take: impl FnMut(Found<'_>) -> bool,
    ) -> Result<(), Failure> {
        let decoder = RowDecoder::new(&self.description);
        let mut row = vec![0; self.description.row_bytes / 8];
        let items = recording.items::<AnyPlantMessage>().map_err(Failure::bad)?;
        for item in items {
            let goes_on = match item {
                Item::Message(AnyPlantMessage::Record(record, bytes)) => {
                    row.fill(0);
                    if decoder.decode(&bytes, &mut row).is_err() {
                        continue;
                    }
                    take(Found::Row(record.tick.woke.as_nanos(), &row))
                }
                Item::Message(AnyPlantMessage::Event(event, text)) => {
                    take(Found::Event(&Event::new(&event, &text), &text))
                }
                Item::Remark(remark) => take(Found::Remark(remark.time.as_nanos(), &remark.text)),
                Item::Document(_) | Item::Damage(_) => true,
            };
            if !goes_on {
                break;
            }
        }
        Ok(())
    }
}

/// What is in a recording.
pub(super) enum Found<'a> {
    /// A tick: its time in ns, and its row.
    Row(i64, &'a [u64]),
    Event(&'a Event, &'a str),
    /// A text that is no event, and its time in ns.
    Remark(i64, &'a str),
}

/// Some columns of a recording, `time_s` first.
pub(super) struct Table {
    /// Of `time_s`, and of each further column.
    header: Vec<Value>,
    /// Whether it is thinned to its smallest and largest values; otherwise to samples.
    has_range: Vec<bool>,
    values: Vec<Vec<f64>>,
    start_utc_s: f64,
}

/// Reads some columns.
pub(super) fn table(recording: &Recording, names: &[&str]) -> Result<Table, Failure> {
    let scanner = Scanner::of(recording)?;
    let columns = &scanner.columns;
    let wanted = names.iter().map(|name| {
        columns
            .index(name)
            .ok_or_else(|| Failure::bad(format!("{name:?}: there is no such column")))
    });
    let wanted: Vec<usize> = wanted.collect::<Result<_, _>>()?;
    let described = wanted.iter().filter_map(|index| columns.all.get(*index));
    let time = json!({ "name": "time_s", "unit": "s", "kind": "f64" });
    let header = [time]
        .into_iter()
        .chain(described.clone().map(|column| json!(column)));
    let has_range = described.map(PageColumn::has_range);
    let mut table = Table {
        header: header.collect(),
        has_range: std::iter::once(false).chain(has_range).collect(),
        values: vec![Vec::new(); wanted.len() + 1],
        start_utc_s: 0.0,
    };
    let most_rows = MOST_VALUES / table.values.len();
    let mut first_ns = None;
    let mut rows = 0;
    scanner.read(recording, |found| {
        let Found::Row(woke_ns, row) = found else {
            return true;
        };
        let first_ns = *first_ns.get_or_insert(woke_ns);
        let time_s = (woke_ns - first_ns) as f64 * 1e-9;
        let values = wanted.iter().map(|index| columns.value(*index, row));
        let values = std::iter::once(time_s).chain(values);
        for (column, value) in table.values.iter_mut().zip(values) {
            column.push(value);
        }
        rows += 1;
        rows < most_rows
    })?;
    if rows >= most_rows {
        return Err(Failure::bad(
            "these are too many values at once: give fewer columns",
        ));
    }
    table.start_utc_s = utc_s(recording, first_ns.unwrap_or(0));
    Ok(table)
}

pub(super) fn utc_s(recording: &Recording, time_ns: i64) -> f64 {
    recording.about().clock_offset_ns.saturating_add(time_ns) as f64 * 1e-9
}

impl Table {
    /// At most so many rows: two for each of equal spans, in which a curve has its smallest
    /// and its largest value in their order.
    pub(super) fn thinned(self, points: usize) -> Self {
        let rows = self.values.first().map_or(0, Vec::len);
        let spans = points / 2;
        if rows <= points || spans == 0 {
            return self;
        }
        let edges: Vec<usize> = (0..=spans).map(|span| span * rows / spans).collect();
        let values = self
            .values
            .iter()
            .zip(&self.has_range)
            .map(|(column, has_range)| {
                let parts = edges.iter().zip(edges.iter().skip(1));
                let parts = parts.filter_map(|(from, to)| column.get(*from..*to));
                parts
                    .flat_map(|part| {
                        if *has_range {
                            range(part)
                        } else {
                            samples(part)
                        }
                    })
                    .collect()
            });
        Self {
            values: values.collect(),
            ..self
        }
    }

    /// As it is sent.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let rows = self.values.first().map_or(0, Vec::len);
        let header = json!({
            "columns": self.header,
            "rows": rows,
            "start_utc_s": self.start_utc_s,
        });
        let header = header.to_string();
        let mut bytes = Vec::with_capacity(16 + header.len() + 8 * rows * self.values.len());
        bytes.extend_from_slice(&(header.len() as u32).to_le_bytes());
        bytes.extend_from_slice(header.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        for value in self.values.iter().flatten() {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        bytes
    }
}

/// The smallest and the largest value, in their order.
fn range(part: &[f64]) -> [f64; 2] {
    let known = || {
        part.iter()
            .copied()
            .enumerate()
            .filter(|(_, value)| !value.is_nan())
    };
    let least = known().min_by(|(_, a), (_, b)| a.total_cmp(b));
    let most = known().max_by(|(_, a), (_, b)| a.total_cmp(b));
    match (least, most) {
        (Some((least_at, least)), Some((most_at, most))) if least_at <= most_at => [least, most],
        (Some((_, least)), Some((_, most))) => [most, least],
        _ => [f64::NAN; 2],
    }
}

/// The first, and that in the middle.
fn samples(part: &[f64]) -> [f64; 2] {
    let at = |index: usize| part.get(index).copied().unwrap_or(f64::NAN);
    [at(0), at(part.len() / 2)]
}

/// The events and remarks, by their time since the first tick.
pub(super) fn events(recording: &Recording) -> Result<Value, Failure> {
    let scanner = Scanner::of(recording)?;
    let mut found = Vec::new();
    let mut first_ns = None;
    let mut tick = 0;
    let number = scanner.columns.index("tick");
    scanner.read(recording, |one| {
        match one {
            Found::Row(woke_ns, row) => {
                first_ns.get_or_insert(woke_ns);
                let number = number.and_then(|number| scanner.columns.word(number, row));
                tick = number.unwrap_or(tick);
            }
            Found::Event(event, text) => {
                found.push((event.tick, event.time_ns, event.code, text.to_owned()));
            }
            Found::Remark(time_ns, text) => found.push((tick, time_ns, 0, text.to_owned())),
        }
        true
    })?;
    let first_ns = first_ns.unwrap_or(0);
    let listed = found.into_iter().map(|(tick, time_ns, code, text)| {
        let time_s = time_ns.saturating_sub(first_ns) as f64 * 1e-9;
        // What came before the first tick.
        json!({ "tick": tick, "time_s": time_s.max(0.0), "code": code, "text": text })
    });
    Ok(listed.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_curve_keeps_its_extremes() {
        let mut curve: Vec<f64> = vec![0.0; 10_000];
        curve[1_234] = 7.0;
        curve[5_678] = -7.0;
        let table = Table {
            header: Vec::new(),
            has_range: vec![false, true],
            values: vec![(0..10_000).map(f64::from).collect(), curve],
            start_utc_s: 0.0,
        };
        let thinned = table.thinned(200);
        assert_eq!(thinned.values[0].len(), 200);
        assert_eq!(thinned.values[1].len(), 200);
        assert!(thinned.values[0].is_sorted());
        let at = |value: f64| {
            thinned.values[1]
                .iter()
                .position(|found| *found == value)
                .unwrap()
        };
        let time_of = |value: f64| thinned.values[0][at(value)];
        assert!((time_of(7.0) - 1_234.0).abs() <= 100.0);
        assert!((time_of(-7.0) - 5_678.0).abs() <= 100.0);
    }

    #[test]
    fn a_table_is_sent_column_by_column() {
        let table = Table {
            header: vec![json!({ "name": "time_s" })],
            has_range: vec![false],
            values: vec![vec![0.0, 0.025]],
            start_utc_s: 5.0,
        };
        let bytes = table.to_bytes();
        let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        let header: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
        assert_eq!(header["rows"], 2);
        let begin = (4 + length).next_multiple_of(8);
        assert_eq!(bytes.len(), begin + 16);
        assert_eq!(bytes[begin + 8..], 0.025_f64.to_le_bytes());
    }
}
