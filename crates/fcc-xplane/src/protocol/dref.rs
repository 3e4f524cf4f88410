//! `DREF`: set one dataref, or one element of an array (`name[3]`).
//!
//! Exactly 509 bytes: header, f32 value, path\[500\] closed by NUL and padded;
//! X-Plane 12 refuses shorter ones. The value is a float even for a dataref of
//! whole numbers. There is no acknowledgement.

use super::{HEADER_BYTES, PathError, check_path, fields};

/// The size of a write.
pub const WRITE_BYTES: usize = 509;
/// The field that holds the path, closing NUL included.
pub const PATH_BYTES: usize = 500;

/// Writes "set `path` to `value`" into the buffer.
///
/// # Errors
/// When the path cannot be sent; the buffer is then as it was.
pub fn write(into: &mut [u8; WRITE_BYTES], value: f32, path: &str) -> Result<(), PathError> {
    check_path(path, PATH_BYTES)?;
    fields::fill(into, &[b"DREF\0", &value.to_le_bytes(), path.as_bytes()]);
    Ok(())
}

/// Changes the value of an existing write, and nothing else.
pub fn set_value(write: &mut [u8; WRITE_BYTES], value: f32) {
    let place = write.iter_mut().skip(HEADER_BYTES);
    for (place, byte) in place.zip(value.to_le_bytes()) {
        *place = byte;
    }
}
