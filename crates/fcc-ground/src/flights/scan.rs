//! Reads the ticks and events of a recording.

use fcc_live::Event;
use fcc_record::{AnyPlantMessage, Item, Recording};
use fcc_telemetry::schema::RecordDescription;
use fcc_telemetry::schema::protobuf::RowDecoder;
use serde_json::{Value, json};

use crate::columns::{Columns, PageColumn};
use crate::failure::Failure;

/// Values of a table in memory, at most: 27 columns of an hour at 40 Hz.
pub(super) const MOST_VALUES: usize = 4_000_000;

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
    columns: Vec<TableColumn>,
    start_utc_s: f64,
}

#[derive(Clone)]
struct TableColumn {
    header: Value,
    /// Whether it is thinned to its smallest and largest values; otherwise to samples.
    has_range: bool,
    values: Vec<f64>,
}

impl TableColumn {
    /// Two values in place of many.
    fn thinned(&self, part: &[f64]) -> [f64; 2] {
        if self.has_range {
            range(part)
        } else {
            samples(part)
        }
    }
}

fn no_column(name: &str) -> Failure {
    Failure::bad(format!("{name:?}: there is no such column"))
}

/// Reads some columns, every tick.
pub(super) fn table(recording: &Recording, names: &[&str]) -> Result<Table, Failure> {
    let scanner = Scanner::of(recording)?;
    let mut reader = TableReader::new(&scanner.columns, names, 1)?;
    let mut has_room = true;
    scanner.read(recording, |found| {
        if let Found::Row(woke_ns, row) = found {
            has_room = reader.take(woke_ns, row);
        }
        has_room
    })?;
    if !has_room {
        let what = "these are too many values at once: give fewer columns";
        return Err(Failure::bad(what));
    }
    Ok(reader.finish(recording))
}

/// Collects columns tick by tick.
pub(super) struct TableReader<'a> {
    columns: &'a Columns,
    wanted: Vec<usize>,
    /// So many ticks become two rows; 1: each stays.
    span: usize,
    /// The present span.
    part: Vec<Vec<f64>>,
    first_ns: Option<i64>,
    table: Table,
}

impl<'a> TableReader<'a> {
    pub(super) fn new(columns: &'a Columns, names: &[&str], span: usize) -> Result<Self, Failure> {
        let wanted = names.iter().map(|name| {
            let found = columns.index(name);
            found.ok_or_else(|| no_column(name))
        });
        let wanted: Vec<usize> = wanted.collect::<Result<_, _>>()?;
        let column = |header, has_range| TableColumn {
            header,
            has_range,
            values: Vec::new(),
        };
        let time = column(
            json!({ "name": "time_s", "unit": "s", "kind": "f64" }),
            false,
        );
        let described = wanted.iter().filter_map(|index| columns.all.get(*index));
        let described = described.map(|one| column(json!(one), one.has_range()));
        let count = wanted.len() + 1;
        let table = Table {
            columns: std::iter::once(time).chain(described).collect(),
            start_utc_s: 0.0,
        };
        Ok(Self {
            columns,
            wanted,
            span,
            part: vec![Vec::new(); count],
            first_ns: None,
            table,
        })
    }

    /// Takes a tick; returns whether there is room for more.
    pub(super) fn take(&mut self, woke_ns: i64, row: &[u64]) -> bool {
        let first_ns = *self.first_ns.get_or_insert(woke_ns);
        let time_s = (woke_ns - first_ns) as f64 * 1e-9;
        let values = self
            .wanted
            .iter()
            .map(|index| self.columns.value(*index, row));
        let values = std::iter::once(time_s).chain(values);
        for (column, value) in self.part.iter_mut().zip(values) {
            column.push(value);
        }
        if self
            .part
            .first()
            .is_some_and(|part| part.len() >= self.span)
        {
            self.end_span();
        }
        self.table.rows() * self.part.len() < MOST_VALUES
    }

    fn end_span(&mut self) {
        for (column, part) in self.table.columns.iter_mut().zip(&mut self.part) {
            match part.len() {
                0..=2 => column.values.append(part),
                _ => column.values.extend(column.thinned(part)),
            }
            part.clear();
        }
    }

    pub(super) fn finish(mut self, recording: &Recording) -> Table {
        self.end_span();
        self.table.start_utc_s = utc_s(recording, self.first_ns.unwrap_or(0));
        self.table
    }
}

pub(super) fn utc_s(recording: &Recording, time_ns: i64) -> f64 {
    recording.about().clock_offset_ns.saturating_add(time_ns) as f64 * 1e-9
}

impl Table {
    /// What [`to_bytes`](Self::to_bytes) has made.
    pub(super) fn of_bytes(bytes: &[u8]) -> Option<Self> {
        let (length, rest) = bytes.split_first_chunk()?;
        let length = u32::from_le_bytes(*length) as usize;
        let header: Value = serde_json::from_slice(rest.get(..length)?).ok()?;
        let rows = usize::try_from(header.get("rows")?.as_u64()?).ok()?;
        let described = header.get("columns")?.as_array()?;
        let words = bytes.get((4 + length).next_multiple_of(8)..)?.as_chunks().0;
        let values: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
        (values.len() == rows * described.len()).then_some(())?;
        let mut parts = values.chunks(rows.max(1));
        let columns = described.iter().map(|header| {
            let described: PageColumn = serde_json::from_value(header.clone()).ok()?;
            Some(TableColumn {
                header: header.clone(),
                has_range: described.has_range(),
                values: parts.next().unwrap_or_default().to_vec(),
            })
        });
        Some(Self {
            columns: columns.collect::<Option<_>>()?,
            start_utc_s: header.get("start_utc_s")?.as_f64()?,
        })
    }

    fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    fn column(&self, name: &str) -> Option<&TableColumn> {
        let is_it =
            |column: &&TableColumn| column.header.get("name").is_some_and(|found| found == name);
        self.columns.iter().find(is_it)
    }

    pub(super) fn has(&self, names: &[&str]) -> bool {
        names.iter().all(|name| self.column(name).is_some())
    }

    /// The time and these columns.
    pub(super) fn select(&self, names: &[&str]) -> Result<Self, Failure> {
        let all = std::iter::once("time_s").chain(names.iter().copied());
        let columns = all.map(|name| {
            let found = self.column(name).cloned();
            found.ok_or_else(|| no_column(name))
        });
        Ok(Self {
            columns: columns.collect::<Result<_, _>>()?,
            start_utc_s: self.start_utc_s,
        })
    }

    /// At most so many rows: two for each of equal spans, in which a curve has its smallest
    /// and its largest value in their order.
    pub(super) fn thinned(mut self, points: usize) -> Self {
        let rows = self.rows();
        let spans = points / 2;
        if rows <= points || spans == 0 {
            return self;
        }
        let edges: Vec<usize> = (0..=spans).map(|span| span * rows / spans).collect();
        for column in &mut self.columns {
            let parts = edges.iter().zip(edges.iter().skip(1));
            let parts = parts.filter_map(|(from, to)| column.values.get(*from..*to));
            column.values = parts.flat_map(|part| column.thinned(part)).collect();
        }
        self
    }

    /// As it is sent.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let rows = self.rows();
        let headers = self.columns.iter().map(|column| &column.header);
        let header = json!({
            "columns": headers.collect::<Vec<_>>(),
            "rows": rows,
            "start_utc_s": self.start_utc_s,
        });
        let header = header.to_string();
        let mut bytes = Vec::with_capacity(16 + header.len() + 8 * rows * self.columns.len());
        bytes.extend_from_slice(&(header.len() as u32).to_le_bytes());
        bytes.extend_from_slice(header.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        for value in self.columns.iter().flat_map(|column| &column.values) {
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

/// The events and remarks of a recording.
pub(super) struct Events {
    number: Option<usize>,
    tick: u64,
    first_ns: Option<i64>,
    /// Tick, time in ns, code, text.
    found: Vec<(u64, i64, u32, String)>,
}

impl Events {
    pub(super) fn new(columns: &Columns) -> Self {
        Self {
            number: columns.index("tick"),
            tick: 0,
            first_ns: None,
            found: Vec::new(),
        }
    }

    pub(super) fn take(&mut self, found: &Found<'_>, columns: &Columns) {
        match *found {
            Found::Row(woke_ns, row) => {
                self.first_ns.get_or_insert(woke_ns);
                let number = self.number.and_then(|number| columns.word(number, row));
                self.tick = number.unwrap_or(self.tick);
            }
            Found::Event(event, text) => {
                let (tick, code) = (event.tick, event.code);
                self.found
                    .push((tick, event.time_ns, code, text.to_owned()));
            }
            Found::Remark(time_ns, text) => {
                self.found.push((self.tick, time_ns, 0, text.to_owned()));
            }
        }
    }

    /// By their time since the first tick.
    pub(super) fn listed(self) -> Value {
        let first_ns = self.first_ns.unwrap_or(0);
        let listed = self.found.into_iter().map(|(tick, time_ns, code, text)| {
            let time_s = time_ns.saturating_sub(first_ns) as f64 * 1e-9;
            // What came before the first tick.
            json!({ "tick": tick, "time_s": time_s.max(0.0), "code": code, "text": text })
        });
        listed.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, has_range: bool, values: Vec<f64>) -> TableColumn {
        TableColumn {
            header: json!({ "name": name }),
            has_range,
            values,
        }
    }

    #[test]
    fn a_thinned_curve_keeps_its_extremes() {
        let mut curve: Vec<f64> = vec![0.0; 10_000];
        curve[1_234] = 7.0;
        curve[5_678] = -7.0;
        let table = Table {
            columns: vec![
                column("time_s", false, (0..10_000).map(f64::from).collect()),
                column("curve", true, curve),
            ],
            start_utc_s: 0.0,
        };
        let thinned = table.thinned(200).columns;
        let (time, curve) = (&thinned[0].values, &thinned[1].values);
        assert_eq!((time.len(), curve.len()), (200, 200));
        assert!(time.is_sorted());
        let at = |value: f64| curve.iter().position(|found| *found == value).unwrap();
        let time_of = |value: f64| time[at(value)];
        assert!((time_of(7.0) - 1_234.0).abs() <= 100.0);
        assert!((time_of(-7.0) - 5_678.0).abs() <= 100.0);
    }

    #[test]
    fn a_table_is_sent_column_by_column() {
        let table = Table {
            columns: vec![column("time_s", false, vec![0.0, 0.025])],
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
