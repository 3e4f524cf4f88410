//! Structs with a schema as classes of Python: their attributes, columns and
//! checks follow from the declaration.

#[macro_use]
mod class;
#[cfg(feature = "flight")]
mod flight;
mod shape;

pub use class::{
    Attributes, Values, are_equal, from_array, from_keywords, register, to_array, written,
};
#[cfg(feature = "flight")]
pub(crate) use class::{as_row, from_row};
pub(crate) use class::{code, names};
#[cfg(feature = "flight")]
pub(crate) use flight::{
    PyEstimate, PyMeasurements, PyRawTruth, PySetpoints, PySurfaces, PyTruth, with_plant,
};
pub(crate) use shape::Shape;
pub use shape::checked;
