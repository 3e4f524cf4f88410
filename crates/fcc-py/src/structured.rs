//! Structs with a schema as numpy's structured arrays: the memory that Rust
//! filled is the array's, and its columns are views.

use std::any::TypeId;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::{Mutex, PoisonError};

use fcc_core::framework::schema::{Kind, Schema};
use fcc_telemetry::schema::{columns, words, write_words};
use numpy::{PyArray1, PyArrayDescr};
use pyo3::prelude::*;
use pyo3::types::PyDict;

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

    pub(crate) fn is_empty(&self) -> bool {
        self.words.is_empty()
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
        PyArray1::from_vec(py, self.words).call_method1("view", (dtype::<T>(py)?,))
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
    let made = make::<T>(py)?;
    let kept = made.clone().unbind();
    known()
        .get_or_insert_default()
        .insert(TypeId::of::<T>(), kept);
    Ok(made)
}

fn make<T: Schema>(py: Python<'_>) -> PyResult<Bound<'_, PyArrayDescr>> {
    let (mut names, mut formats, mut offsets) = (Vec::new(), Vec::new(), Vec::new());
    for column in columns::<T>() {
        names.push(column.name);
        formats.push(format_of(column.kind));
        offsets.push(column.offset);
    }
    let layout = PyDict::new(py);
    layout.set_item("names", names)?;
    layout.set_item("formats", formats)?;
    layout.set_item("offsets", offsets)?;
    layout.set_item("itemsize", words::<T>() * size_of::<u64>())?;
    PyArrayDescr::new(py, layout)
}

fn format_of(kind: Kind) -> String {
    let letter = match kind {
        Kind::Bool | Kind::Code(_) | Kind::Flags | Kind::Count(_) => 'u',
        Kind::Signed(_) | Kind::Instant => 'i',
        Kind::Number => 'f',
    };
    format!("{letter}{}", kind.bytes())
}
