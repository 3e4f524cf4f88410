//! `CMND`: run a command once, as if a key for it had been pressed.
//!
//! Header and path, closed by NUL. There is no acknowledgement, and a command
//! that X-Plane does not know has no effect. X-Plane's own commands are listed
//! in its `Resources/plugins/Commands.txt`.

use super::{HEADER_BYTES, PathError, check_path, fields};

/// The field that holds the path, closing NUL included.
pub const PATH_BYTES: usize = 500;
/// The size of the longest command.
pub const COMMAND_BYTES: usize = HEADER_BYTES + PATH_BYTES;

/// Writes "run the command `path`" into the buffer; returns the part to send.
///
/// # Errors
/// When the path cannot be sent; the buffer is then as it was.
pub fn write<'a>(into: &'a mut [u8; COMMAND_BYTES], path: &str) -> Result<&'a [u8], PathError> {
    check_path(path, PATH_BYTES)?;
    fields::fill(into, &[b"CMND\0", path.as_bytes()]);
    Ok(into
        .get(..HEADER_BYTES + path.len() + 1)
        .unwrap_or_default())
}
