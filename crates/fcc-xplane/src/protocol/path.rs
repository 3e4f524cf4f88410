//! Which dataref paths can be sent.

/// Why a path cannot be sent.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
pub enum PathError {
    /// It is empty.
    #[error("the dataref path is empty: write one such as sim/time/paused")]
    Empty,
    /// It contains a blank, a control character or a letter outside ASCII.
    #[error(
        "the dataref path contains a character that no dataref has: use letters, digits, / _ [ ] only"
    )]
    NotPrintable,
    /// It does not fit the message with its closing NUL.
    #[error("the dataref path is {length} bytes long: at most {limit} fit")]
    TooLong {
        /// Its length in bytes.
        length: usize,
        /// The longest path that fits.
        limit: usize,
    },
}

/// Whether `path` can be sent in a field of `field_bytes`, its closing NUL
/// included.
///
/// # Errors
/// When it is empty, too long, or holds anything but printable ASCII.
pub fn check_path(path: &str, field_bytes: usize) -> Result<(), PathError> {
    let limit = field_bytes.saturating_sub(1);
    if path.is_empty() {
        return Err(PathError::Empty);
    }
    if !path.bytes().all(|byte| byte.is_ascii_graphic()) {
        return Err(PathError::NotPrintable);
    }
    if path.len() > limit {
        return Err(PathError::TooLong {
            length: path.len(),
            limit,
        });
    }
    Ok(())
}
