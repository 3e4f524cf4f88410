//! Records as a table of pandas.

use fcc_core::framework::schema::Kind;
use fcc_telemetry::{FlightRecord, schema};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A table of records; values that were never measured are NaN.
pub(super) fn of<'py>(records: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = records.py();
    let pandas = py.import("pandas")?;
    let numpy = py.import("numpy")?;
    let columns = PyDict::new(py);
    let declared = schema::columns::<FlightRecord>();
    let taken_at = |reading: &str| {
        let path = format!("{reading}.taken");
        let found = declared.iter().find(|column| column.path == path);
        found.map_or("", |column| column.name.as_str())
    };
    for column in &declared {
        let mut values = records.get_item(column.name.as_str())?;
        if let (Some(reading), Kind::Number) = (&column.reading, column.kind) {
            let taken = records.get_item(taken_at(reading))?;
            let never = taken.call_method1("__eq__", (i64::MIN,))?;
            values = numpy.call_method1("where", (never, f64::NAN, values))?;
        }
        columns.set_item(&column.name, values)?;
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
