//! `DATA`: the rows of X-Plane's Data Output, in and out.
//!
//! Header, then any number of rows of 36 bytes: i32 row index and eight f32.
//! Datagrams with one row occur as well as with many. -999 means "not there"
//! from X-Plane, and "leave as it is" to X-Plane: both are `None` here.

use super::{HEADER_BYTES, Kind, Malformed, body};

/// The size of a row.
pub const ROW_BYTES: usize = 36;
/// The value that means "not there" and "leave as it is".
pub const ABSENT: f32 = -999.0;

/// One row. The meaning of its columns depends on its index.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Row {
    /// The number that X-Plane's Data Output page shows for it.
    pub index: i32,
    /// Its columns, counted from 0; each finite, or `None`.
    pub columns: [Option<f32>; 8],
}

/// The size of a datagram with this many rows.
pub const fn size(rows: usize) -> usize {
    HEADER_BYTES + rows * ROW_BYTES
}

/// Reads a datagram of rows.
///
/// # Errors
/// When it is another message, or is not a whole number of rows.
pub fn parse(datagram: &[u8]) -> Result<Rows<'_>, Malformed> {
    let (rows, rest) = body(datagram, Kind::Data)?.as_chunks::<ROW_BYTES>();
    if !rest.is_empty() {
        return Err(Malformed::Length);
    }
    Ok(Rows(rows.iter()))
}

/// The rows of a datagram, in its order.
#[derive(Clone, Debug)]
pub struct Rows<'a>(core::slice::Iter<'a, [u8; ROW_BYTES]>);

impl Iterator for Rows<'_> {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        self.0.find_map(|row| {
            let (index, columns) = row.split_first_chunk::<4>()?;
            let (columns, _) = columns.as_chunks::<4>();
            let mut read = columns.iter().map(|column| {
                let value = f32::from_le_bytes(*column);
                // X-Plane sends exactly this number; it is not computed.
                let there = value.is_finite() && value.to_bits() != ABSENT.to_bits();
                there.then_some(value)
            });
            Some(Row {
                index: i32::from_le_bytes(*index),
                columns: core::array::from_fn(|_| read.next().flatten()),
            })
        })
    }
}

/// Writes rows into the buffer and returns the part of it to send; `None` if
/// the buffer is smaller than [`size`] asks for.
pub fn write<'a>(into: &'a mut [u8], rows: &[Row]) -> Option<&'a [u8]> {
    let datagram = into.get_mut(..size(rows.len()))?;
    let (header, body) = datagram.split_first_chunk_mut::<HEADER_BYTES>()?;
    *header = *b"DATA\0";
    let (places, _) = body.as_chunks_mut::<ROW_BYTES>();
    for (place, row) in places.iter_mut().zip(rows) {
        let (words, _) = place.as_chunks_mut::<4>();
        let index = core::iter::once(row.index.to_le_bytes());
        let columns = row
            .columns
            .iter()
            .map(|column| column.unwrap_or(ABSENT).to_le_bytes());
        for (word, bytes) in words.iter_mut().zip(index.chain(columns)) {
            *word = bytes;
        }
    }
    Some(datagram)
}
