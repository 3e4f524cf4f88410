//! X-Plane's messages as bytes: parsing and building only.
//!
//! All functions work on slices owned by the caller. None reads a socket or a
//! clock, allocates, or can panic: every length, tag, count and field is
//! checked; what is not understood is reported as an error or left out. All
//! numbers are packed and little-endian.
//!
//! Messages begin with four letters and a fifth byte. From X-Plane that byte
//! is for X-Plane's own use and differs by version (`DATA@` and `DATA*`,
//! `RREFO` and `RREF,`, `RPOS4`), so only the four letters are matched; to
//! X-Plane it is NUL.

pub mod beacon;
pub mod cmnd;
pub mod data;
pub mod dref;
mod fields;
mod path;
pub mod rpos;
pub mod rref;

pub use path::{PathError, check_path};

/// Four letters and the byte after them.
pub const HEADER_BYTES: usize = 5;

/// The messages that X-Plane sends and this crate reads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Rows of Data Output: [`data`].
    Data,
    /// Values of subscribed datarefs: [`rref`].
    Rref,
    /// Position and attitude: [`rpos`].
    Rpos,
    /// "Here I am", by multicast: [`beacon`].
    Beacon,
}

impl Kind {
    /// The kind of a datagram by its first four bytes; `None` if it is unknown
    /// or shorter than a header.
    pub fn of(datagram: &[u8]) -> Option<Self> {
        let (header, _) = datagram.split_first_chunk::<HEADER_BYTES>()?;
        let [a, b, c, d, _] = *header;
        match &[a, b, c, d] {
            b"DATA" => Some(Self::Data),
            b"RREF" => Some(Self::Rref),
            b"RPOS" => Some(Self::Rpos),
            b"BECN" => Some(Self::Beacon),
            _ => None,
        }
    }
}

/// Why a datagram was not understood.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Malformed {
    /// The first four bytes are those of another message, or there are fewer
    /// than five.
    #[error("the datagram is another message")]
    Tag,
    /// The length is not a whole number of entries: it was cut, or has another
    /// layout.
    #[error("the datagram's length is not a whole number of entries")]
    Length,
    /// A field is out of its range.
    #[error("a field is out of its range")]
    Field,
}

/// The bytes after the header, if the datagram is of this kind.
fn body(datagram: &[u8], kind: Kind) -> Result<&[u8], Malformed> {
    if Kind::of(datagram) != Some(kind) {
        return Err(Malformed::Tag);
    }
    datagram.get(HEADER_BYTES..).ok_or(Malformed::Tag)
}
