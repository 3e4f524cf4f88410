//! Records as a table of pandas.

use fcc_telemetry::schema::RecordDescription;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A table of records; values that were never measured are NaN.
pub(super) fn of<'py>(
    records: &Bound<'py, PyAny>,
    described: &RecordDescription,
) -> PyResult<Bound<'py, PyAny>> {
    let py = records.py();
    let pandas = py.import("pandas")?;
    let numpy = py.import("numpy")?;
    let columns = PyDict::new(py);
    let taken_at = |reading: &str| {
        let path = format!("{reading}.taken");
        let mut columns = described.columns.iter();
        columns.find(|column| column.path == path)
    };
    for column in &described.columns {
        let mut values = records.get_item(&column.name)?;
        let is_number = column.kind == "f64";
        let reading = column.reading.as_deref().filter(|_| is_number);
        if let Some(taken_at) = reading.and_then(taken_at) {
            let taken = records.get_item(&taken_at.name)?;
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
