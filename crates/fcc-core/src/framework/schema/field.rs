//! The description of a field.

use super::unit;

/// A field of a struct, or the payload of an enum's variant.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Field {
    /// Its name in the struct.
    pub name: &'static str,
    /// The number that identifies it in files, unique and never reused.
    pub number: u32,
    /// What it means: the lines of its doc comment.
    pub meaning: &'static str,
    /// Its smallest and largest value, in its unit.
    pub range: Option<(f64, f64)>,
    /// The name of its column in tables and arrays, `*` standing for the name
    /// of a nested field; none for its own name.
    pub column: Option<&'static str>,
    /// Bytes from the beginning of the struct.
    pub offset: usize,
    /// What it is.
    pub of: Type,
}

/// The type of a field.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Type {
    /// A single value.
    Leaf(Kind),
    /// A struct.
    Struct(&'static Structure),
    /// An enum that carries data: one of its fields is present.
    Choice(&'static Structure),
}

/// A struct, or an enum that carries data.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Structure {
    /// Its name.
    pub name: &'static str,
    /// What it is: the lines of its doc comment.
    pub meaning: &'static str,
    /// Its fields, in their order.
    pub fields: &'static [Field],
    /// Values derived from them.
    pub derived: &'static [Field],
    /// Whether it is a [`Reading`](crate::framework::Reading).
    pub is_reading: bool,
    /// Bytes that it takes in memory.
    pub bytes: usize,
}

/// The kind of a single value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Kind {
    /// No or yes.
    Bool,
    /// One of a few, as a small number.
    Code(&'static Enumeration),
    /// A set of conditions, one bit each.
    Flags,
    /// A whole number, of so many bytes.
    Count(u8),
    /// A whole number that may be negative, of so many bytes.
    Signed(u8),
    /// An instant in ns on the loop's clock; the smallest number means never.
    Instant,
    /// Anything measured or commanded.
    Number,
}

/// An enum without data.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Enumeration {
    /// Its name.
    pub name: &'static str,
    /// What it is: the lines of its doc comment.
    pub meaning: &'static str,
    /// Its variants, 0 first.
    pub variants: &'static [Variant],
}

/// A variant of an enum.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Variant {
    /// Its name.
    pub name: &'static str,
    /// The number that identifies it, unique and never reused.
    pub number: u8,
    /// What it means: the lines of its doc comment.
    pub meaning: &'static str,
}

impl Field {
    /// A field without a declaration yet.
    pub(super) const ROOT: Self = Self {
        name: "",
        number: 0,
        meaning: "",
        range: None,
        column: None,
        offset: 0,
        of: Type::Leaf(Kind::Bool),
    };

    /// The unit, by the end of the name; empty if there is none.
    pub const fn unit(&self) -> &'static str {
        match self.of {
            Type::Leaf(Kind::Instant) => "ns",
            _ => unit::of(self.name).unit,
        }
    }

    /// The name without the unit at its end.
    pub const fn quantity(&self) -> &'static str {
        unit::of(self.name).quantity
    }
}

impl Type {
    /// The number of single values in it, nested ones included.
    pub const fn leaves(&self) -> usize {
        match self {
            Self::Leaf(_) => 1,
            Self::Struct(of) | Self::Choice(of) => {
                let mut leaves = 0;
                let mut rest = of.fields;
                while let [field, others @ ..] = rest {
                    leaves += field.of.leaves();
                    rest = others;
                }
                leaves
            }
        }
    }
}

impl Kind {
    /// Bytes that it takes in memory.
    pub const fn bytes(&self) -> usize {
        match self {
            Self::Bool | Self::Code(_) => 1,
            Self::Count(bytes) | Self::Signed(bytes) => *bytes as usize,
            Self::Flags | Self::Instant | Self::Number => 8,
        }
    }
}

impl Enumeration {
    /// The name of the variant of a number.
    pub fn name_of(&self, number: u8) -> Option<&'static str> {
        let mut variants = self.variants.iter();
        variants
            .find(|variant| variant.number == number)
            .map(|variant| variant.name)
    }
}

/// Whether numbers are 1 or more and no two are the same; for
/// [`schema!`](crate::schema).
#[doc(hidden)]
pub const fn are_distinct(numbers: &[u32]) -> bool {
    let mut rest = numbers;
    while let [number, others @ ..] = rest {
        let mut after = others;
        while let [other, more @ ..] = after {
            if *other == *number {
                return false;
            }
            after = more;
        }
        if *number == 0 {
            return false;
        }
        rest = others;
    }
    true
}

/// The field of a number; for [`schema!`](crate::schema).
#[doc(hidden)]
pub fn numbered(fields: &'static [Field], number: u32) -> Option<&'static Field> {
    fields.iter().find(|field| field.number == number)
}

/// The fields inside a field; for [`schema!`](crate::schema).
#[doc(hidden)]
pub fn inner(field: &'static Field) -> core::slice::Iter<'static, Field> {
    match field.of {
        Type::Leaf(_) => [].iter(),
        Type::Struct(of) | Type::Choice(of) => of.fields.iter(),
    }
}
