//! The columns of a record as data: with them a program reads the records of a
//! plant whose types it does not have.

use std::collections::{BTreeMap, BTreeSet};

use fcc_core::framework::schema::{Kind, Schema};
use serde::{Deserialize, Serialize};

use super::layout::{spaced, type_of};
use super::{Column, columns, words};

/// The columns of a record, and the layout of a row of them. As JSON it is in
/// every recording and in live telemetry.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct RecordDescription {
    /// Bytes of a row, a multiple of 8.
    pub row_bytes: usize,
    /// The columns, in the order of the record.
    pub columns: Vec<DescribedColumn>,
}

/// One column.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct DescribedColumn {
    /// Its name in tables and arrays, with the unit at the end.
    pub name: String,
    /// Its path in the record: `measurements.attitude.value.pitch_rad`.
    pub path: String,
    /// The numbers of the fields of this path, in a message.
    pub numbers: Vec<u32>,
    /// Bytes from the beginning of a row.
    pub offset: usize,
    /// The type in a row: a letter, u, i or f, and the number of bits.
    #[serde(rename = "type")]
    pub kind: String,
    /// The path of the reading that contains it, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reading: Option<String>,
    /// Its unit; empty if it has none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// What it means.
    #[serde(default)]
    pub meaning: String,
    /// The smallest and the largest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<(f64, f64)>,
    /// The names of its codes; empty for what is no code.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub codes: BTreeMap<u8, String>,
}

/// An aircraft's record has 1 kB.
const MOST_ROW_BYTES: usize = 1 << 16;
/// An aircraft's record has 4.
const MOST_LEVELS: usize = 16;

impl RecordDescription {
    /// The description of a struct.
    pub fn of<T: Schema>() -> Self {
        Self {
            row_bytes: words::<T>() * size_of::<u64>(),
            columns: columns::<T>().into_iter().map(described).collect(),
        }
    }

    /// As JSON.
    pub fn to_json(&self) -> String {
        // Numbers, texts and maps of them can be written.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// From untrusted JSON.
    ///
    /// # Errors
    /// Why it is no description, as text.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let read: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if read.columns.is_empty() {
            return Err("no columns".to_owned());
        }
        if read.row_bytes > MOST_ROW_BYTES || !read.row_bytes.is_multiple_of(size_of::<u64>()) {
            return Err(format!("a row of {} bytes", read.row_bytes));
        }
        let mut names = BTreeSet::new();
        for column in &read.columns {
            let is_valid = column.layout().is_some_and(|(_, bytes)| {
                let end = column.offset.checked_add(bytes);
                column.offset.is_multiple_of(bytes) && end.is_some_and(|end| end <= read.row_bytes)
            });
            let is_named = !column.name.is_empty() && names.insert(&column.name);
            let levels = column.numbers.len();
            if !is_valid || !is_named || levels == 0 || levels > MOST_LEVELS {
                return Err(format!("the column '{}' is invalid", column.name));
            }
        }
        Ok(read)
    }

    /// Whether the rows of both have the same values in the same places.
    pub fn has_layout_of(&self, other: &Self) -> bool {
        let layout = |of: &Self| {
            let columns = of.columns.iter();
            let columns =
                columns.map(|column| (column.path.clone(), column.offset, column.kind.clone()));
            (of.row_bytes, columns.collect::<Vec<_>>())
        };
        layout(self) == layout(other)
    }

    /// Whether this is the record of another plant: no measurement or no output
    /// is the same.
    pub fn is_of_another_plant(&self, other: &Self) -> bool {
        fn paths<'a>(of: &'a RecordDescription, part: &str) -> BTreeSet<&'a str> {
            let paths = of.columns.iter().map(|column| column.path.as_str());
            paths.filter(|path| path.starts_with(part)).collect()
        }
        ["measurements", "outputs"].into_iter().any(|part| {
            let (own, others) = (paths(self, part), paths(other, part));
            !own.is_empty() && !others.is_empty() && own.is_disjoint(&others)
        })
    }
}

impl DescribedColumn {
    /// The letter of its type, and the number of bytes; none if it is invalid.
    pub fn layout(&self) -> Option<(char, usize)> {
        let letter = self.kind.chars().next()?;
        let bits: usize = self.kind.get(1..)?.parse().ok()?;
        let is_known = match letter {
            'u' | 'i' => [8, 16, 32, 64].contains(&bits),
            'f' => bits == 64,
            _ => false,
        };
        is_known.then_some((letter, bits / 8))
    }
}

fn described(column: Column) -> DescribedColumn {
    let variants = match column.kind {
        Kind::Code(of) => of.variants,
        _ => &[],
    };
    let codes = variants
        .iter()
        .map(|variant| (variant.number, spaced(variant.name)));
    DescribedColumn {
        name: column.name,
        path: column.path,
        numbers: column.numbers,
        offset: column.offset,
        kind: type_of(column.kind),
        reading: column.reading,
        unit: column.unit.to_owned(),
        meaning: column.meaning,
        range: column.range,
        codes: codes.collect(),
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Reading, Record, State, Tick, Time};

    use super::*;
    use crate::schema::protobuf::{RowDecoder, decode, encode};
    use crate::schema::{read_words, write_words};

    type TestRecord = Record<Reading<f64>, (), f64, f64>;

    fn record() -> TestRecord {
        let tick = Tick {
            number: 7,
            scheduled: Time::from_nanos(-3),
            ..Tick::default()
        };
        let reading = Reading::new(21.5, Time::from_nanos(5));
        Record {
            measurements: Reading {
                source: 2,
                ..reading
            },
            outputs: -0.0,
            sent: true,
            ..Record::new(tick, State::Engaged)
        }
    }

    /// A program without the types makes the same row of a message as the loop of
    /// the struct.
    #[test]
    fn a_message_is_read_by_its_description() {
        let text = RecordDescription::of::<TestRecord>().to_json();
        let description = RecordDescription::from_json(&text).unwrap();
        assert_eq!(description, RecordDescription::of::<TestRecord>());
        let mut message = Vec::new();
        encode(&record(), &mut message);
        let mut row = vec![0; description.row_bytes / 8];
        let decoder = RowDecoder::new(&description);
        decoder.decode(&message, &mut row).unwrap();
        let mut own = vec![0; row.len()];
        write_words(&record(), &mut own);
        assert_eq!(row, own);
        assert_eq!(read_words::<TestRecord>(&row), Ok(record()));
        assert!(decoder.decode(&[9, 1], &mut row).is_err());

        // Without a reading nothing is written of it.
        let empty = TestRecord {
            measurements: Reading::default(),
            ..record()
        };
        let mut short = Vec::new();
        encode(&empty, &mut short);
        // Its key and length, and keys and values of value, time and source.
        assert_eq!(message.len() - short.len(), 2 + 9 + 9 + 2);
        row.fill(0);
        decoder.decode(&short, &mut row).unwrap();
        own.fill(0);
        write_words(&empty, &mut own);
        assert_eq!(row, own);
        assert_eq!(decode::<TestRecord>(&short), Ok(empty));

        // A zero that was taken at the clock's beginning is a reading.
        let zero = TestRecord {
            measurements: Reading::new(0.0, Time::from_nanos(0)),
            ..record()
        };
        let mut message = Vec::new();
        encode(&zero, &mut message);
        assert_eq!(decode::<TestRecord>(&message), Ok(zero));

        let taken = &description.columns[description
            .columns
            .iter()
            .position(|column| column.path == "measurements.taken")
            .unwrap()];
        assert_eq!((taken.layout(), &*taken.unit), (Some(('i', 8)), "ns"));
        assert_eq!(taken.numbers, [3, 2]);
    }

    /// Another process reads each byte of a row.
    #[test]
    fn what_is_no_value_is_zero_in_a_row() {
        let description = RecordDescription::of::<TestRecord>();
        let mut row = vec![0; description.row_bytes / 8];
        let mut all_ones = record();
        all_ones.tick.number = u64::MAX;
        all_ones.measurements.source = u8::MAX;
        write_words(&all_ones, &mut row);
        let mut bytes: Vec<u8> = row.iter().flat_map(|word| word.to_ne_bytes()).collect();
        assert!(bytes.iter().any(|byte| *byte != 0));
        for column in &description.columns {
            let (_, size) = column.layout().unwrap();
            bytes[column.offset..column.offset + size].fill(0);
        }
        assert!(bytes.iter().all(|byte| *byte == 0), "{bytes:?}");
    }

    #[test]
    fn an_invalid_description_is_refused() {
        let good = RecordDescription::of::<TestRecord>();
        let refused = |change: fn(&mut RecordDescription)| {
            let mut bad = good.clone();
            change(&mut bad);
            assert!(RecordDescription::from_json(&bad.to_json()).is_err());
        };
        refused(|bad| bad.row_bytes = 1 << 40);
        refused(|bad| bad.row_bytes = 12);
        refused(|bad| bad.columns[3].offset = usize::MAX - 3);
        refused(|bad| bad.columns[3].offset = bad.row_bytes);
        refused(|bad| bad.columns[3].kind = "f7".to_owned());
        refused(|bad| bad.columns[3].numbers.clear());
        refused(|bad| bad.columns[3].name = bad.columns[4].name.clone());
        assert!(RecordDescription::from_json("{}").is_err());
    }

    #[test]
    fn plants_differ_by_what_is_measured_or_sent() {
        fcc_core::schema! {
            /// Another plant's output.
            #[derive(Clone, Copy, Debug, Default)]
            struct Valve {
                /// Opening.
                #[field(1)]
                opening: f64,
            }
        }
        let room = RecordDescription::of::<TestRecord>();
        let same = RecordDescription::of::<Record<Reading<f64>, (), (), f64>>();
        let other = RecordDescription::of::<Record<Reading<f64>, (), f64, Valve>>();
        let any = RecordDescription::of::<Record<(), (), (), ()>>();
        assert!(!room.is_of_another_plant(&same));
        assert!(room.is_of_another_plant(&other));
        assert!(!room.is_of_another_plant(&any));
    }
}
