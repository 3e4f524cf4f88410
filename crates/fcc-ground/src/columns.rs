//! Records as the page reads them: one word of 8 bytes for each column.

use fcc_core::framework::Controller as _;
use fcc_fixed_wing::Autopilot;
use fcc_telemetry::schema::{DescribedColumn, RecordDescription};
use serde::{Deserialize, Serialize};

/// Columns whose bits are conditions of the autopilot.
const CONDITIONS: [&str; 3] = ["state_flags", "engage_inhibits", "faults"];

/// What a word of a column is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    F64,
    U64,
    I64,
    Bool,
    Enum,
    Flags,
}

/// A column, for the page.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
pub(crate) struct PageColumn {
    pub(crate) name: String,
    unit: String,
    kind: Kind,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    names: Vec<Option<String>>,
    #[serde(default)]
    meaning: String,
}

impl PageColumn {
    /// Whether its smallest and largest values say more than samples do.
    pub(crate) fn has_range(&self) -> bool {
        let turns = ["heading", "course", "latitude", "longitude"];
        self.kind == Kind::F64 && !turns.iter().any(|turns| self.name.contains(turns))
    }
}

/// Where a column is in a row, and how it is read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Place {
    offset: usize,
    letter: char,
    bytes: usize,
}

/// The columns of a record.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Columns {
    pub(crate) all: Vec<PageColumn>,
    places: Vec<Place>,
}

impl Columns {
    pub(crate) fn of(description: &RecordDescription) -> Self {
        let known = description
            .columns
            .iter()
            .filter_map(|column| Some((column, column.layout()?)));
        let (all, places) = known
            .map(|(column, (letter, bytes))| {
                let place = Place {
                    offset: column.offset,
                    letter,
                    bytes,
                };
                (page_column(column, letter), place)
            })
            .unzip();
        Self { all, places }
    }

    /// The number of a column.
    pub(crate) fn index(&self, name: &str) -> Option<usize> {
        self.all.iter().position(|column| column.name == name)
    }

    /// The word of a column in a row.
    pub(crate) fn word(&self, index: usize, row: &[u64]) -> Option<u64> {
        word(*self.places.get(index)?, row)
    }

    /// The value of a column in a row as a number.
    pub(crate) fn value(&self, index: usize, row: &[u64]) -> f64 {
        let found = self.places.get(index).zip(self.word(index, row));
        found.map_or(f64::NAN, |(place, word)| match place.letter {
            'f' => f64::from_bits(word),
            'i' => word.cast_signed() as f64,
            _ => word as f64,
        })
    }

    /// The value of a column in a row, if it is of integers.
    pub(crate) fn integer(&self, index: usize, row: &[u64]) -> Option<i128> {
        let (place, word) = (self.places.get(index)?, self.word(index, row)?);
        match place.letter {
            'f' => None,
            'i' => Some(word.cast_signed().into()),
            _ => Some(word.into()),
        }
    }

    /// A row as the page reads it.
    pub(crate) fn encode(&self, row: &[u64]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.places.len() * 8);
        for place in &self.places {
            bytes.extend_from_slice(&word(*place, row).unwrap_or(0).to_le_bytes());
        }
        bytes
    }
}

/// The word at a place; a number with a sign is extended to 64 bits.
fn word(place: Place, row: &[u64]) -> Option<u64> {
    let whole = *row.get(place.offset / 8)?;
    if place.bytes == 8 {
        return Some(whole);
    }
    let bits = 8 * place.bytes as u32;
    // As the row is in memory.
    let first = 8 * (place.offset % 8) as u32;
    let shift = if cfg!(target_endian = "little") {
        first
    } else {
        64 - bits - first
    };
    let low = whole.checked_shr(shift)? & (u64::MAX >> (64 - bits));
    Some(if place.letter == 'i' {
        ((low << (64 - bits)).cast_signed() >> (64 - bits)).cast_unsigned()
    } else {
        low
    })
}

fn page_column(column: &DescribedColumn, letter: char) -> PageColumn {
    let is_flags = CONDITIONS.contains(&column.name.as_str());
    let kind = match letter {
        'f' => Kind::F64,
        'i' => Kind::I64,
        _ if is_flags || column.name.ends_with("_faults") => Kind::Flags,
        _ if !column.codes.is_empty() => Kind::Enum,
        _ if is_bool(&column.name) => Kind::Bool,
        _ => Kind::U64,
    };
    let names = if is_flags {
        (0..u64::BITS)
            .map(Autopilot::flag_name)
            .map_while(|name| (name != "unknown condition").then(|| Some(name.to_owned())))
            .collect()
    } else {
        let most = column.codes.keys().max();
        let codes = most.map(|most| 0..=*most).into_iter().flatten();
        codes.map(|code| column.codes.get(&code).cloned()).collect()
    };
    PageColumn {
        name: column.name.clone(),
        unit: column.unit.clone(),
        kind,
        names,
        meaning: column.meaning.clone(),
    }
}

/// Numbers of a byte that are 0 or 1 and no code.
fn is_bool(name: &str) -> bool {
    let other = name.strip_prefix("other_");
    name == "sent" || other.is_some_and(|rest| !rest.ends_with("_source") && rest != "source")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The layout is documented in proto/layout.md: a row is as in memory.
    #[test]
    fn words_are_those_of_the_columns() {
        let column = |name: &str, offset: usize, kind: &str| {
            format!(
                r#"{{"name":"{name}","path":"{name}","numbers":[1],"offset":{offset},"type":"{kind}"}}"#
            )
        };
        let columns = [
            column("a", 0, "f64"),
            column("b", 8, "u8"),
            column("c", 9, "i8"),
            column("d", 12, "i32"),
            column("e", 16, "i64"),
        ];
        let text = format!(r#"{{"row_bytes":24,"columns":[{}]}}"#, columns.join(","));
        let columns = Columns::of(&RecordDescription::from_json(&text).unwrap());
        let mut bytes = [0_u8; 24];
        bytes[..8].copy_from_slice(&1.5_f64.to_ne_bytes());
        bytes[8] = 200;
        bytes[9] = 0xfe;
        bytes[12..16].copy_from_slice(&(-70_000_i32).to_ne_bytes());
        bytes[16..].copy_from_slice(&(-9_i64).to_ne_bytes());
        let row: Vec<u64> = bytes
            .chunks(8)
            .map(|word| u64::from_ne_bytes(word.try_into().unwrap()))
            .collect();
        let values: Vec<f64> = (0..5).map(|n| columns.value(n, &row)).collect();
        assert_eq!(values, [1.5, 200.0, -2.0, -70_000.0, -9.0]);
        let encoded = columns.encode(&row);
        assert_eq!(encoded.len(), 40);
        assert_eq!(encoded[8..16], 200_u64.to_le_bytes());
        assert_eq!(encoded[16..24], (-2_i64).to_le_bytes());
    }
}
