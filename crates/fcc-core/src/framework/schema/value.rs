//! A single value, and the error for an unknown one.

use core::fmt;

use super::{Field, Kind, Type};

/// A single value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Value {
    /// Of [`Kind::Bool`].
    Bool(bool),
    /// Of [`Kind::Code`].
    Code(u8),
    /// Of [`Kind::Flags`].
    Flags(u64),
    /// Of [`Kind::Count`].
    Count(u64),
    /// Of [`Kind::Signed`].
    Signed(i64),
    /// Of [`Kind::Instant`].
    Instant(i64),
    /// Of [`Kind::Number`].
    Number(f64),
}

impl Value {
    /// Its bits, which are equal only for identical values, a NaN and the sign
    /// of zero included.
    pub const fn bits(self) -> u64 {
        match self {
            Self::Bool(value) => value as u64,
            Self::Code(value) => value as u64,
            Self::Flags(value) | Self::Count(value) => value,
            Self::Signed(value) | Self::Instant(value) => value as u64,
            Self::Number(value) => value.to_bits(),
        }
    }

    /// The value of a kind from its bits, of which those above the kind's size
    /// are ignored; none for bits of a `bool` that are neither 0 nor 1.
    pub const fn from_bits(kind: Kind, bits: u64) -> Option<Self> {
        Some(match kind {
            Kind::Bool => match bits as u8 {
                0 => Self::Bool(false),
                1 => Self::Bool(true),
                _ => return None,
            },
            Kind::Code(_) => Self::Code(bits as u8),
            Kind::Flags => Self::Flags(bits),
            Kind::Count(bytes) => Self::Count(bits & (u64::MAX >> (64 - 8 * bytes as u32))),
            Kind::Signed(bytes) => {
                let above = 64 - 8 * bytes as u32;
                Self::Signed(((bits << above) as i64) >> above)
            }
            Kind::Instant => Self::Instant(bits as i64),
            Kind::Number => Self::Number(f64::from_bits(bits)),
        })
    }

    /// Whether it is the instant `never`.
    pub const fn is_never(self) -> bool {
        matches!(self, Self::Instant(i64::MIN))
    }
}

/// A value that its field cannot have.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unknown {
    /// The expected type.
    pub of: Type,
    /// The field.
    pub field: &'static Field,
}

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.of {
            Type::Leaf(Kind::Code(of)) => of.name,
            Type::Leaf(_) => "value",
            Type::Struct(of) | Type::Choice(of) => of.name,
        };
        match self.field.name {
            "" => write!(f, "not a known {kind}"),
            name => write!(f, "{name} is not a known {kind}"),
        }
    }
}

impl core::error::Error for Unknown {}
