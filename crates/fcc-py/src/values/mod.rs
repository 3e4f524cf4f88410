//! The values that travel, as Python sees them: SI and radians.

mod estimate;
mod measurements;
mod setpoints;
mod surfaces;
mod truth;

pub(crate) use estimate::PyEstimate;
pub(crate) use measurements::{COLUMNS, Measured, PyMeasurements};
pub(crate) use setpoints::PySetpoints;
pub(crate) use surfaces::{PySurfaces, SURFACE_COLUMNS, checked_surfaces};
pub(crate) use truth::{PyTruth, TruthRow};
