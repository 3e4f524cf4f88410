//! Structs with a schema as classes of Python: their attributes, columns and
//! checks follow from the declaration.

#[macro_use]
mod class;
mod flight;
mod shape;

pub(crate) use class::{
    Attributes, Values, are_equal, as_row, from_array, from_keywords, from_row, names, register,
    to_array, written,
};
pub(crate) use flight::{PyEstimate, PyMeasurements, PySetpoints, PySurfaces, PyTruth, with_plant};
pub(crate) use shape::{Shape, checked};
