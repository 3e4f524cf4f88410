//! Records and truths as numpy's structured arrays: the memory that Rust
//! filled is the array's, and its columns are views.

#![expect(
    unsafe_code,
    reason = "numpy asks for a promise that a dtype says how a type is laid out"
)]

use fcc_core::framework::schema::Kind;
use fcc_sim::Truth;
use fcc_telemetry::schema::columns;
use fcc_telemetry::{FlightRecord, FlightWords};
use numpy::{Element, PyArray1, PyArrayDescr};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use crate::values::TruthRow;

/// A record, as a row of an array.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct RecordRow(FlightWords);

impl From<&FlightRecord> for RecordRow {
    fn from(record: &FlightRecord) -> Self {
        Self(FlightWords::of(record))
    }
}

/// A truth, as a row of an array.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct TruthRecord(TruthRow);

impl From<&Truth> for TruthRecord {
    fn from(truth: &Truth) -> Self {
        Self(truth.to_array())
    }
}

static RECORD: PyOnceLock<Py<PyArrayDescr>> = PyOnceLock::new();
static TRUTH: PyOnceLock<Py<PyArrayDescr>> = PyOnceLock::new();

/// The dtype of records.
pub(crate) fn record_dtype(py: Python<'_>) -> PyResult<Bound<'_, PyArrayDescr>> {
    let made = RECORD.get_or_try_init(py, || {
        let columns = columns::<FlightRecord>()
            .into_iter()
            .map(|column| (column.name, format_of(column.kind), column.offset));
        make(py, columns, size_of::<FlightRecord>())
    })?;
    Ok(made.bind(py).clone())
}

/// The dtype of truths.
pub(crate) fn truth_dtype(py: Python<'_>) -> PyResult<Bound<'_, PyArrayDescr>> {
    let made = TRUTH.get_or_try_init(py, || {
        let columns = Truth::NAMES
            .iter()
            .enumerate()
            .map(|(at, name)| ((*name).to_owned(), "f8".to_owned(), at * size_of::<f64>()));
        make(py, columns, size_of::<TruthRow>())
    })?;
    Ok(made.bind(py).clone())
}

/// Both dtypes, so that none can fail to be made later.
pub(crate) fn prepare(py: Python<'_>) -> PyResult<()> {
    record_dtype(py)?;
    truth_dtype(py)?;
    Ok(())
}

/// Records as an array; it takes over their memory.
pub(crate) fn records(py: Python<'_>, rows: Vec<RecordRow>) -> Bound<'_, PyArray1<RecordRow>> {
    PyArray1::from_vec(py, rows)
}

/// Truths as an array; it takes over their memory.
pub(crate) fn truths(py: Python<'_>, rows: Vec<TruthRecord>) -> Bound<'_, PyArray1<TruthRecord>> {
    PyArray1::from_vec(py, rows)
}

fn format_of(kind: Kind) -> String {
    let letter = match kind {
        Kind::Bool | Kind::Code(_) | Kind::Flags | Kind::Count(_) => 'u',
        Kind::Signed(_) | Kind::Instant => 'i',
        Kind::Number => 'f',
    };
    format!("{letter}{}", kind.bytes())
}

fn make(
    py: Python<'_>,
    columns: impl Iterator<Item = (String, String, usize)>,
    bytes: usize,
) -> PyResult<Py<PyArrayDescr>> {
    let (mut names, mut formats, mut offsets) = (Vec::new(), Vec::new(), Vec::new());
    for (name, format, offset) in columns {
        names.push(name);
        formats.push(format);
        offsets.push(offset);
    }
    let layout = PyDict::new(py);
    layout.set_item("names", names)?;
    layout.set_item("formats", formats)?;
    layout.set_item("offsets", offsets)?;
    layout.set_item("itemsize", bytes)?;
    Ok(PyArrayDescr::new(py, layout)?.unbind())
}

#[expect(
    clippy::expect_used,
    reason = "the module does not load where a dtype cannot be made, and later it is only looked up"
)]
fn prepared(dtype: PyResult<Bound<'_, PyArrayDescr>>) -> Bound<'_, PyArrayDescr> {
    dtype.expect("made when the module was loaded")
}

// SAFETY: plain numbers of the size and with the fields of the dtype, which
// holds no objects.
unsafe impl Element for RecordRow {
    const IS_COPY: bool = true;

    fn get_dtype(py: Python<'_>) -> Bound<'_, PyArrayDescr> {
        prepared(record_dtype(py))
    }

    fn clone_ref(&self, _: Python<'_>) -> Self {
        *self
    }
}

// SAFETY: as above.
unsafe impl Element for TruthRecord {
    const IS_COPY: bool = true;

    fn get_dtype(py: Python<'_>) -> Bound<'_, PyArrayDescr> {
        prepared(truth_dtype(py))
    }

    fn clone_ref(&self, _: Python<'_>) -> Self {
        *self
    }
}
