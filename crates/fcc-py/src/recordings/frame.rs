//! Records as a table of pandas.

use fcc_telemetry::{FIELDS, FieldKind};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What ends the name of a reading's time.
const TAKEN: &str = "_taken_ns";

/// A table of records; what was never measured is NaN.
pub(super) fn of<'py>(records: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = records.py();
    let pandas = py.import("pandas")?;
    let numpy = py.import("numpy")?;
    let columns = PyDict::new(py);
    // Values come before the time that they were taken at.
    let mut waiting: Vec<&str> = Vec::new();
    for field in FIELDS {
        columns.set_item(field.name, records.get_item(field.name)?)?;
        if field.name.ends_with(TAKEN) {
            let never = records
                .get_item(field.name)?
                .call_method1("__eq__", (i64::MIN,))?;
            for name in waiting.drain(..) {
                let masked =
                    numpy.call_method1("where", (&never, f64::NAN, records.get_item(name)?))?;
                columns.set_item(name, masked)?;
            }
        } else if field.name.ends_with("_ns") || field.kind == FieldKind::U32 {
            waiting.clear();
        } else if field.kind == FieldKind::F64 {
            waiting.push(field.name);
        }
    }
    let settings = PyDict::new(py);
    if records.len()? > 0 {
        let scheduled = records.get_item("scheduled_ns")?;
        let since = scheduled.call_method1("__sub__", (scheduled.get_item(0)?,))?;
        settings.set_item("index", since.call_method1("__mul__", (1e-9,))?)?;
    }
    let frame = pandas.call_method("DataFrame", (columns,), Some(&settings))?;
    frame.call_method1("rename_axis", ("time_s",))
}
