//! `RREF`: request a dataref's value at a given rate, and read the values that
//! arrive.
//!
//! A request is 413 bytes: header, i32 frequency in Hz, i32 index of the
//! caller's choice, path\[400\]. The values are sent to the requester's address
//! and port, as any number of pairs (i32 index, f32 value) in any order;
//! datagrams with up to 183 pairs have been observed.

use super::{HEADER_BYTES, Kind, Malformed, PathError, body, check_path, fields};

/// The size of a request.
pub const REQUEST_BYTES: usize = 413;
/// The field that holds the path, closing NUL included.
pub const PATH_BYTES: usize = 400;
/// i32 index and f32 value.
const PAIR_BYTES: usize = 8;

/// Writes a request: send the value of `path` under `index`, `frequency_hz`
/// times a second; 0 ends the subscription under this index. A new request
/// under an index replaces the previous one.
///
/// # Errors
/// When the path cannot be sent; the buffer is then as it was.
pub fn request(
    into: &mut [u8; REQUEST_BYTES],
    frequency_hz: u16,
    index: i32,
    path: &str,
) -> Result<(), PathError> {
    check_path(path, PATH_BYTES)?;
    fields::fill(
        into,
        &[
            b"RREF\0",
            &i32::from(frequency_hz).to_le_bytes(),
            &index.to_le_bytes(),
            path.as_bytes(),
        ],
    );
    Ok(())
}

/// Changes the frequency of an existing request, and nothing else.
pub fn set_frequency(request: &mut [u8; REQUEST_BYTES], frequency_hz: u16) {
    let place = request.iter_mut().skip(HEADER_BYTES);
    for (place, byte) in place.zip(i32::from(frequency_hz).to_le_bytes()) {
        *place = byte;
    }
}

/// Reads a datagram of values.
///
/// # Errors
/// When it is another message, or is not a whole number of pairs.
pub fn parse(datagram: &[u8]) -> Result<Pairs<'_>, Malformed> {
    let (pairs, rest) = body(datagram, Kind::Rref)?.as_chunks::<PAIR_BYTES>();
    if !rest.is_empty() {
        return Err(Malformed::Length);
    }
    Ok(Pairs(pairs.iter()))
}

/// The pairs (index, value) of a datagram, in its order. A value that is not
/// finite is left out.
#[derive(Clone, Debug)]
pub struct Pairs<'a>(core::slice::Iter<'a, [u8; PAIR_BYTES]>);

impl Iterator for Pairs<'_> {
    type Item = (i32, f32);

    fn next(&mut self) -> Option<Self::Item> {
        self.0.find_map(|pair| {
            let mut fields = fields::Fields::of(pair);
            Some((fields.i32()?, fields.f32()?))
        })
    }
}
