//! The module itself.

use fcc_sim::Truth;
use fcc_telemetry::FlightRecord;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

#[cfg(feature = "live")]
use crate::live;
use crate::{
    aircraft, autopilot, blocks, calibrate, config, errors, events, fleet, flight, formulas,
    machine, navigate, plan, raw_sensors, recordings, structured, timers, values,
};

/// The flight control computer: its autopilot and aircraft in lockstep, its
/// recordings, a running daemon. SI and radians throughout.
#[pymodule]
fn fcc(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    structured::check_numpy(py)?;
    errors::register(module)?;

    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("MEASUREMENTS", columns::<values::PyMeasurements>(py)?)?;
    module.add("SURFACES", columns::<values::PySurfaces>(py)?)?;
    module.add("TRUTH", columns::<values::PyTruth>(py)?)?;
    module.add(
        "STATES",
        PyTuple::new(py, ["standby", "engaged", "failsafe", "stopped"])?,
    )?;
    module.add("RECORD", structured::dtype::<FlightRecord>(py)?)?;
    module.add("TRUTH_RECORD", structured::dtype::<Truth>(py)?)?;

    values::register::<values::PyMeasurements>(module)?;
    values::register::<values::PySurfaces>(module)?;
    values::register::<values::PySetpoints>(module)?;
    values::register::<values::PyEstimate>(module)?;
    values::register::<values::PyTruth>(module)?;
    values::register::<values::PyRawTruth>(module)?;
    module.add_class::<raw_sensors::PyRawSensors>()?;
    module.add_class::<events::PyEvent>()?;
    module.add_class::<config::PyConfig>()?;
    module.add_class::<plan::PyPlan>()?;
    module.add_class::<autopilot::PyAutopilot>()?;
    module.add_class::<fleet::PyFleet>()?;
    module.add_class::<machine::PyMachine>()?;
    module.add_class::<aircraft::PyAircraft>()?;
    module.add_class::<flight::PyFlight>()?;
    module.add_function(wrap_pyfunction!(flight::fly, module)?)?;

    module.add_class::<blocks::PyPid>()?;
    module.add_class::<blocks::PyLowPass>()?;
    module.add_class::<blocks::PyHighPass>()?;
    module.add_class::<blocks::PyRateLimit>()?;
    module.add_class::<blocks::PyComplementary>()?;
    module.add_class::<blocks::PySquareRootProfile>()?;
    module.add_function(wrap_pyfunction!(formulas::pressure_pa, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::pressure_altitude_m, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::density_ratio, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::true_airspeed_mps, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::wrap_pi, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::wrap_two_pi, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::quaternion_from_euler, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::euler_from_quaternion, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::body_to_earth, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::earth_to_body, module)?)?;

    module.add_function(wrap_pyfunction!(calibrate::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(calibrate::calibrate_gyroscope, module)?)?;
    module.add_function(wrap_pyfunction!(calibrate::levelled, module)?)?;
    module.add_function(wrap_pyfunction!(calibrate::level_and_nose_up, module)?)?;
    module.add_function(wrap_pyfunction!(calibrate::constant_dip, module)?)?;
    module.add_function(wrap_pyfunction!(navigate::navigate, module)?)?;

    module.add_class::<timers::PyTimer>()?;
    module.add_class::<timers::PyExpiry>()?;
    module.add_class::<timers::PyTimingSummary>()?;
    recordings::register(module)?;
    module.add_function(wrap_pyfunction!(recordings::report, module)?)?;
    module.add_function(wrap_pyfunction!(recordings::replay_flight, module)?)?;
    #[cfg(feature = "conformance")]
    module.add_function(wrap_pyfunction!(crate::conformance::conformance, module)?)?;
    #[cfg(feature = "live")]
    live::register(module)?;
    Ok(())
}

/// The names of a class's values.
fn columns<V: values::Values>(py: Python<'_>) -> PyResult<Bound<'_, PyTuple>> {
    PyTuple::new(py, values::names::<V>().collect::<Vec<_>>())
}
