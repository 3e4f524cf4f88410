//! Structs with a schema as numpy's structured arrays: the memory that Rust
//! filled is the array's, and its columns are views.

use std::any::TypeId;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::{Mutex, PoisonError};

use fcc_core::framework::schema::Schema;
use fcc_telemetry::schema::{RecordDescription, words, write_words};
use numpy::{PyArray1, PyArrayDescr, get_array_module};
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Whether there is a numpy whose arrays can be made; to be asked before the first one,
/// which would panic without it.
///
/// # Errors
/// An `ImportError` with what to do, whose cause is Python's own.
pub(crate) fn check_numpy(py: Python<'_>) -> PyResult<()> {
    let found = get_array_module(py).and_then(|module| module.getattr("_ARRAY_API"));
    found.map(drop).map_err(|cause| {
        let error = PyImportError::new_err(format!(
            "numpy, 1.23 or newer, cannot be imported ({}): install it for this Python (`python \
             -m pip install numpy`); a file numpy.py of your own needs another name",
            cause.value(py)
        ));
        error.set_cause(py, Some(cause));
        error
    })
}

/// Structs, as the words of the rows of an array.
pub struct Rows<T> {
    words: Vec<u64>,
    of: PhantomData<fn() -> T>,
}

impl<T: Schema> Rows<T> {
    /// None yet, and room for some.
    pub(crate) fn with_room(rows: usize) -> Self {
        Self {
            words: Vec::with_capacity(rows * words::<T>()),
            of: PhantomData,
        }
    }

    pub(crate) fn push(&mut self, row: &T) {
        let begin = self.words.len();
        self.words.resize(begin + words::<T>(), 0);
        if let Some(words) = self.words.get_mut(begin..) {
            write_words(row, words);
        }
    }

    /// The rows as an array, which takes their memory.
    ///
    /// # Errors
    /// Those of numpy.
    pub fn into_array(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        array(py, self.words, &dtype::<T>(py)?)
    }
}

impl<T: Schema> Default for Rows<T> {
    fn default() -> Self {
        Self::with_room(0)
    }
}

impl<'a, T: Schema> FromIterator<&'a T> for Rows<T> {
    fn from_iter<I: IntoIterator<Item = &'a T>>(rows: I) -> Self {
        let mut all = Self::default();
        rows.into_iter().for_each(|row| all.push(row));
        all
    }
}

/// The dtype of a struct; made once.
pub(crate) fn dtype<T: Schema>(py: Python<'_>) -> PyResult<Bound<'_, PyArrayDescr>> {
    static KNOWN: Mutex<Option<HashMap<TypeId, Py<PyArrayDescr>>>> = Mutex::new(None);
    // No other thread of Python can wait for the lock while it is held: numpy is
    // called between the two.
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known().as_ref().and_then(|known| {
        let found = known.get(&TypeId::of::<T>());
        found.map(|dtype| dtype.clone_ref(py))
    });
    if let Some(dtype) = found {
        return Ok(dtype.into_bound(py));
    }
    let made = dtype_of(py, &RecordDescription::of::<T>())?;
    let kept = made.clone().unbind();
    known()
        .get_or_insert_default()
        .insert(TypeId::of::<T>(), kept);
    Ok(made)
}

/// The dtype of a described record.
pub(crate) fn dtype_of<'py>(
    py: Python<'py>,
    record: &RecordDescription,
) -> PyResult<Bound<'py, PyArrayDescr>> {
    let (mut names, mut formats, mut offsets) = (Vec::new(), Vec::new(), Vec::new());
    for column in &record.columns {
        // No description has another type.
        if let Some((letter, bytes)) = column.layout() {
            names.push(&*column.name);
            formats.push(format!("{letter}{bytes}"));
            offsets.push(column.offset);
        }
    }
    let layout = PyDict::new(py);
    layout.set_item("names", names)?;
    layout.set_item("formats", formats)?;
    layout.set_item("offsets", offsets)?;
    layout.set_item("itemsize", record.row_bytes)?;
    PyArrayDescr::new(py, layout)
}

/// The words of rows as an array, which takes their memory.
pub(crate) fn array<'py>(
    py: Python<'py>,
    words: Vec<u64>,
    dtype: &Bound<'py, PyArrayDescr>,
) -> PyResult<Bound<'py, PyAny>> {
    PyArray1::from_vec(py, words).call_method1("view", (dtype,))
}

/// The columns of a record by their names, each as a dict.
pub(crate) fn columns<'py>(
    py: Python<'py>,
    record: &RecordDescription,
) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for column in &record.columns {
        let described = PyDict::new(py);
        described.set_item("path", &column.path)?;
        described.set_item("unit", &column.unit)?;
        described.set_item("meaning", &column.meaning)?;
        described.set_item("range", column.range)?;
        described.set_item("codes", &column.codes)?;
        columns.set_item(&column.name, described)?;
    }
    Ok(columns)
}
