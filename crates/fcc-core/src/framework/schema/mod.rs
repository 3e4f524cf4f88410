//! What the values of a struct are: declared once, beside the struct.
//!
//! [`schema!`](crate::schema) wraps a struct and takes, per field, the number
//! that stands for it in files, its meaning (the doc comment) and, where there
//! is one, its range; the [unit](unit::of) follows from the end of its name.
//! From that declaration follow the messages of a recording and their
//! description, the layout in shared memory, the columns of tables and arrays,
//! and the comparison of a replay: each is a [`Sink`] that is handed every
//! value with its [`Field`], or a [`Source`] that gives them back.
//!
//! ```
//! use fcc_core::framework::schema::{Field, Kind, Schema, Type, Value, Values};
//!
//! fcc_core::schema! {
//!     /// What a tank's sensors measure.
//!     #[derive(Clone, Copy, PartialEq, Debug, Default)]
//!     pub struct Tank {
//!         /// Height of the water above the outlet.
//!         #[field(1, range = 0.0..=2.0)]
//!         pub level_m: f64,
//!         /// Whether the inlet is open.
//!         #[field(2)]
//!         pub filling: bool,
//!     }
//! }
//!
//! assert_eq!(Tank::FIELDS[0].unit(), "m");
//! assert_eq!(Tank::FIELDS[1].of, Type::Leaf(Kind::Bool));
//! let mut values = Values::<2>::default();
//! Tank { level_m: 1.5, filling: true }.visit(&mut values);
//! assert_eq!(values.as_slice(), [Value::Number(1.5), Value::Bool(true)]);
//! ```
//!
//! A number is never given to another field, and never changes: a field that
//! goes takes its number with it.

use core::fmt;

mod declare;
mod field;
mod leaves;
mod range;
pub mod unit;
mod value;
mod values;

pub use field::{Enumeration, Field, Kind, Structure, Type, Variant};
#[doc(hidden)]
pub use field::{are_distinct, inner, numbered};
pub use range::{bounds, in_range};
pub use value::{Unknown, Value};
pub use values::Values;

/// Plain data whose values are declared: see [`schema!`](crate::schema).
pub trait Schema: Copy + Default + fmt::Debug + Send + 'static {
    /// What it is, for whoever describes it.
    const TYPE: Type;

    /// Its fields, in their order; none for a single value.
    const FIELDS: &'static [Field] = &[];

    /// What is worked out from its fields for those who read or plot them, and
    /// never read back.
    const DERIVED: &'static [Field] = &[];

    /// What it is where it is in no other struct.
    const ROOT: &'static Field = &Field {
        of: Self::TYPE,
        ..Field::ROOT
    };

    /// Hands its values to a sink, in their order; `field` is what it is in the
    /// struct around it.
    fn write<W: Sink>(&self, field: &'static Field, sink: &mut W);

    /// Takes its values from a source, in their order. What the source does not
    /// have stays as it is.
    ///
    /// # Errors
    /// When a value is none of those that are declared.
    fn read<R: Source>(&mut self, field: &'static Field, source: &mut R) -> Result<(), Unknown>;

    /// Hands all its values to a sink, for a struct that is in no other.
    fn visit<W: Sink>(&self, sink: &mut W) {
        self.write(Self::ROOT, sink);
    }

    /// One of the values that a source has; the default where it has none.
    ///
    /// # Errors
    /// When a value is none of those that are declared.
    fn from_source<R: Source>(source: &mut R) -> Result<Self, Unknown> {
        let mut value = Self::default();
        value.read(Self::ROOT, source)?;
        Ok(value)
    }
}

/// Takes the values of a struct, in the order of its fields.
pub trait Sink {
    /// A struct begins: `field` is what it is in the struct around it.
    fn begin(&mut self, _field: &'static Field) {}

    /// That struct ends.
    fn end(&mut self, _field: &'static Field) {}

    /// A value.
    fn value(&mut self, field: &'static Field, value: Value);

    /// A number worked out from the values before it.
    fn derived(&mut self, _field: &'static Field, _value: f64) {}
}

/// Gives the values of a struct, in the order of its fields.
pub trait Source {
    /// A struct begins: `field` is what it is in the struct around it.
    fn begin(&mut self, _field: &'static Field) {}

    /// That struct ends.
    fn end(&mut self, _field: &'static Field) {}

    /// The value of a field; none if it is not there.
    fn value(&mut self, field: &'static Field) -> Option<Value>;

    /// Which of the fields of an enum that carries data is there, by its number.
    fn variant(&mut self, _field: &'static Field) -> Option<u32> {
        None
    }
}
