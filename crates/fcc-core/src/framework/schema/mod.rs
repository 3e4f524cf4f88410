//! The schema of a struct: its values are declared once, together with the
//! struct.
//!
//! [`schema!`](crate::schema) wraps a struct and takes, per field, the number
//! that identifies it in files, its meaning (the doc comment) and, if it has
//! one, its range; the [unit](unit::of) follows from the end of its name. From
//! that declaration follow the messages of a recording and their description,
//! the layout in shared memory, the columns of tables and arrays, and the
//! comparison of a replay: each is a [`Sink`] that receives every value with
//! its [`Field`], or a [`Source`] that supplies them.
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
//! A field's number never changes and is never given to another field, even
//! after the field is removed.

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
    /// Its type, for descriptions.
    const TYPE: Type;

    /// Its fields, in their order; none for a single value.
    const FIELDS: &'static [Field] = &[];

    /// Values derived from its fields for reading and plotting; never read
    /// back.
    const DERIVED: &'static [Field] = &[];

    /// Its field when it is not nested in another struct.
    const ROOT: &'static Field = &Field {
        of: Self::TYPE,
        ..Field::ROOT
    };

    /// Passes its values to a sink, in their order; `field` is its field in the
    /// enclosing struct.
    fn write<W: Sink>(&self, field: &'static Field, sink: &mut W);

    /// Reads its values from a source, in their order. Values that the source
    /// does not have are left unchanged.
    ///
    /// # Errors
    /// When a value is not a declared one.
    fn read<R: Source>(&mut self, field: &'static Field, source: &mut R) -> Result<(), Unknown>;

    /// Passes all its values to a sink, for a struct that is not nested.
    fn visit<W: Sink>(&self, sink: &mut W) {
        self.write(Self::ROOT, sink);
    }

    /// Reads a value from a source, with the default for values that it does
    /// not have.
    ///
    /// # Errors
    /// When a value is not a declared one.
    fn from_source<R: Source>(source: &mut R) -> Result<Self, Unknown> {
        let mut value = Self::default();
        value.read(Self::ROOT, source)?;
        Ok(value)
    }
}

/// Receives the values of a struct, in the order of its fields.
pub trait Sink {
    /// A struct begins: `field` is its field in the enclosing struct.
    fn begin(&mut self, _field: &'static Field) {}

    /// That struct ends.
    fn end(&mut self, _field: &'static Field) {}

    /// A value.
    fn value(&mut self, field: &'static Field, value: Value);

    /// A number derived from the values before it.
    fn derived(&mut self, _field: &'static Field, _value: f64) {}
}

/// Supplies the values of a struct, in the order of its fields.
pub trait Source {
    /// A struct begins: `field` is its field in the enclosing struct.
    fn begin(&mut self, _field: &'static Field) {}

    /// That struct ends.
    fn end(&mut self, _field: &'static Field) {}

    /// The value of a field; none if it is absent.
    fn value(&mut self, field: &'static Field) -> Option<Value>;

    /// The number of the present field of an enum that carries data.
    fn variant(&mut self, _field: &'static Field) -> Option<u32> {
        None
    }
}
