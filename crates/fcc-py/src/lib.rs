//! The Python module `fcc`: the autopilot in lockstep with whatever simulates
//! the aircraft, as fast as the machine can.

mod autopilot;
mod machine;
mod values;

use pyo3::prelude::*;

/// The flight control computer: its autopilot, stepped by hand.
#[pymodule]
fn fcc(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<autopilot::PyAutopilot>()?;
    module.add_class::<values::PyMeasurements>()?;
    module.add_class::<values::PySurfaces>()?;
    module.add_class::<values::PySetpoints>()?;
    machine::register(module)?;
    Ok(())
}
