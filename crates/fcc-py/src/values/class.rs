//! A struct with a schema as a class of Python.

use fcc_core::framework::schema::{Kind, Schema, Value};
use fcc_telemetry::schema::{Column, spaced};
use numpy::{PyArray1, ToPyArray};
use pyo3::PyClass;
use pyo3::exceptions::{PyAttributeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyTuple};

use super::shape::{Leaf, Shape, fill, flat};
use crate::arguments::{numbers, shape_words};

/// A class of Python whose attributes are the values of a struct. Made by
/// `values_class!`.
pub trait Values: PyClass + Copy + Into<Self::Of> + From<Self::Of> {
    /// The struct.
    type Of: Schema;
    /// The names of readings that are no attributes.
    const WITHOUT: &'static [&'static str] = &[];
    /// Whether attributes can be set.
    const SETTABLE: bool = false;

    /// Its attributes, determined once.
    fn attributes() -> &'static Attributes;

    /// Replaces the values of an object.
    fn assign(_: &Bound<'_, Self>, _: Self::Of) {}

    /// The struct before any value is set: readings are NaN, which means not
    /// measured, and other values have their defaults.
    fn blank() -> Self::Of {
        Self::attributes().shape.blank(Self::WITHOUT)
    }

    /// The object of a struct of the loop: NaN for values that were never
    /// measured.
    fn from_core(core: &Self::Of) -> Self {
        let mut of = Self::blank();
        Self::attributes().shape.copy(core, &mut of, None);
        of.into()
    }

    /// The measurements of one tick, before their time is known: a reading that is
    /// not measured, or `missing`, has no time.
    fn sample(&self, missing: impl Fn(&str) -> bool) -> Self::Of {
        let mut sample = (*self).into();
        Self::attributes().shape.forget(&mut sample, missing);
        sample
    }
}

/// The attributes of a class.
pub struct Attributes {
    pub(crate) shape: &'static Shape,
    /// Each with its index among the values of the struct.
    pub(crate) leaves: Vec<(usize, &'static Leaf)>,
}

impl Attributes {
    /// The attributes of a class.
    pub fn new<V: Values>() -> Self {
        let shape = Shape::of::<V::Of>();
        let name = |leaf: &Leaf| shape.readings.get(leaf.reading?).copied();
        let is_attribute = |leaf: &Leaf| {
            leaf.is_value() && !name(leaf).is_some_and(|name| V::WITHOUT.contains(&name))
        };
        let all = shape.leaves.iter().enumerate();
        Self {
            shape,
            leaves: all.filter(|(_, leaf)| is_attribute(leaf)).collect(),
        }
    }
}

/// Declares a class whose attributes are the values of a struct, read-only
/// unless it is `settable`. Readings `without` which it is are no attributes.
/// Needs pyo3's prelude in scope.
#[macro_export]
macro_rules! values_class {
    (@settable) => {};
    (@settable settable) => {
        const SETTABLE: bool = true;

        fn assign(this: &Bound<'_, Self>, of: Self::Of) {
            this.borrow_mut().0 = of;
        }
    };
    (
        $(#[$meta:meta])*
        struct $name:ident($core:ty) $(without $without:expr)?, $($settable:ident)?;
        $($methods:item)*
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy)]
        pub(crate) struct $name($core);

        impl From<$core> for $name {
            fn from(core: $core) -> Self {
                Self(core)
            }
        }

        impl From<$name> for $core {
            fn from(values: $name) -> Self {
                values.0
            }
        }

        impl $crate::values::Values for $name {
            type Of = $core;
            $(const WITHOUT: &'static [&'static str] = &$without;)?
            $crate::values_class!(@settable $($settable)?);

            fn attributes() -> &'static $crate::values::Attributes {
                static KNOWN: std::sync::OnceLock<$crate::values::Attributes> =
                    std::sync::OnceLock::new();
                KNOWN.get_or_init($crate::values::Attributes::new::<Self>)
            }
        }

        #[pymethods]
        impl $name {
            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                $crate::values::written(py, *self)
            }

            fn __eq__(&self, other: &Self) -> bool {
                $crate::values::are_equal(*self, *other)
            }

            $($methods)*
        }
    };
}

/// The names of the attributes.
pub(crate) fn names<V: Values>() -> impl Iterator<Item = &'static str> {
    let leaves = V::attributes().leaves.iter();
    leaves.map(|(_, leaf)| leaf.column.name.as_str())
}

/// Adds the class to the module, with a property for each value.
///
/// # Errors
/// Those of Python.
pub fn register<V: Values>(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<V>()?;
    let py = module.py();
    let property = py.import("builtins")?.getattr("property")?;
    for &(index, leaf) in &V::attributes().leaves {
        let get = PyCFunction::new_closure(py, None, None, move |given, _| {
            let this = this::<V>(given)?;
            let values = flat(&(*this.borrow()).into());
            let value = values.as_slice().get(index).copied();
            to_python(
                given.py(),
                &leaf.column,
                value.unwrap_or(Value::Bool(false)),
            )
        })?;
        let set = V::SETTABLE.then(|| {
            PyCFunction::new_closure(py, None, None, move |given, _| -> PyResult<()> {
                let this = this::<V>(given)?;
                let mut of: V::Of = (*this.borrow()).into();
                set(&mut of, index, &leaf.column, &given.get_item(1)?)?;
                V::assign(&this, of);
                Ok(())
            })
        });
        let property = property.call1((get, set.transpose()?, py.None(), &leaf.column.meaning))?;
        py.get_type::<V>().setattr(&leaf.column.name, property)?;
    }
    Ok(())
}

fn this<'py, V: Values>(given: &Bound<'py, PyTuple>) -> PyResult<Bound<'py, V>> {
    Ok(given.get_item(0)?.cast_into::<V>()?)
}

fn set<T: Schema>(
    of: &mut T,
    index: usize,
    column: &Column,
    value: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let value = from_python(column, value).map_err(|error| {
        let why = error.value(value.py()).to_string();
        PyTypeError::new_err(format!("{}: {why}", column.name))
    })?;
    fill(of, |at| (at == index).then_some(value))
        .map_err(|error| PyValueError::new_err(error.to_string()))
}

/// An object from its values by their names; those that are not given are as in
/// [`Values::blank`].
///
/// # Errors
/// When a name or value is none of the struct's.
pub fn from_keywords<V: Values>(given: Option<&Bound<'_, PyDict>>) -> PyResult<V> {
    let mut of = V::blank();
    for (name, value) in given.into_iter().flatten() {
        let name: String = name.extract()?;
        let mut leaves = V::attributes().leaves.iter();
        let known = leaves.find(|(_, leaf)| leaf.column.name == name);
        let &(index, leaf) = known.ok_or_else(|| {
            let known: Vec<_> = names::<V>().collect();
            PyTypeError::new_err(format!(
                "{} has no '{name}': choose of {}",
                V::NAME,
                known.join(", ")
            ))
        })?;
        set(&mut of, index, &leaf.column, &value)?;
    }
    Ok(of.into())
}

/// An object from a row of numbers, one for each attribute.
pub(crate) fn from_row<V: Values>(row: &[f64]) -> V {
    let mut of = V::blank();
    let mut next = row.iter();
    let mut places = V::attributes().leaves.iter().peekable();
    let _ = fill(&mut of, |at| {
        let (_, leaf) = places.next_if(|(index, _)| *index == at)?;
        Some(from_number(leaf.column.kind, *next.next()?))
    });
    of.into()
}

/// An object from an array, with one number for each attribute.
///
/// # Errors
/// When it is of another shape.
pub fn from_array<V: Values>(row: &Bound<'_, PyAny>) -> PyResult<V> {
    let (shape, values) = numbers("row", row)?;
    let count = names::<V>().count();
    if shape == [count] {
        return Ok(from_row(&values));
    }
    Err(PyValueError::new_err(format!(
        "row is of shape {}: give ({count},)",
        shape_words(&shape)
    )))
}

/// An object as a row of numbers, appended.
pub(crate) fn as_row<V: Values>(of: V, row: &mut Vec<f64>) {
    let values = flat(&of.into());
    let leaves = V::attributes().leaves.iter();
    let numbers = leaves.filter_map(|(index, _)| values.as_slice().get(*index));
    row.extend(numbers.map(|value| to_number(*value)));
}

/// An object as an array, one number for each attribute.
pub fn to_array<V: Values>(py: Python<'_>, of: V) -> Bound<'_, PyArray1<f64>> {
    let mut row = Vec::new();
    as_row(of, &mut row);
    row.to_pyarray(py)
}

/// Whether all values are equal. NaN is equal to NaN where it is a value that is
/// not there, and never where it is a reading.
pub fn are_equal<V: Values>(one: V, other: V) -> bool {
    let (one, other) = (flat(&one.into()), flat(&other.into()));
    let mut leaves = V::attributes().leaves.iter();
    leaves.all(|(index, leaf)| {
        let (one, other) = (one.as_slice().get(*index), other.as_slice().get(*index));
        let is_nan =
            |value: Option<&Value>| matches!(value, Some(Value::Number(number)) if number.is_nan());
        one == other || leaf.reading.is_none() && is_nan(one) && is_nan(other)
    })
}

/// An object as Python prints it.
///
/// # Errors
/// Those of Python.
pub fn written<V: Values>(py: Python<'_>, of: V) -> PyResult<String> {
    let values = flat(&of.into());
    let fields = V::attributes().leaves.iter().map(|(index, leaf)| {
        let value = values.as_slice().get(*index).copied();
        let value = to_python(py, &leaf.column, value.unwrap_or(Value::Bool(false)))?;
        Ok(format!("{}={}", leaf.column.name, value.bind(py).repr()?))
    });
    let fields = fields.collect::<PyResult<Vec<_>>>()?;
    Ok(format!("{}({})", V::NAME, fields.join(", ")))
}

fn to_python(py: Python<'_>, column: &Column, value: Value) -> PyResult<Py<PyAny>> {
    Ok(match (value, column.kind) {
        (Value::Number(value), _) => value.into_pyobject(py)?.into_any().unbind(),
        (Value::Bool(value), _) => value.into_pyobject(py)?.to_owned().into_any().unbind(),
        (Value::Code(number), Kind::Code(of)) => code(of.name_of(number).unwrap_or_default())
            .into_pyobject(py)?
            .into_any()
            .unbind(),
        (Value::Code(number), _) => number.into_pyobject(py)?.into_any().unbind(),
        (Value::Flags(value) | Value::Count(value), _) => {
            value.into_pyobject(py)?.into_any().unbind()
        }
        (Value::Signed(value) | Value::Instant(value), _) => {
            value.into_pyobject(py)?.into_any().unbind()
        }
    })
}

fn from_python(column: &Column, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    Ok(match column.kind {
        Kind::Number => Value::Number(value.extract()?),
        Kind::Bool => Value::Bool(value.extract()?),
        Kind::Flags => Value::Flags(value.extract()?),
        Kind::Count(_) => Value::Count(value.extract()?),
        Kind::Signed(_) => Value::Signed(value.extract()?),
        Kind::Instant => Value::Instant(value.extract()?),
        Kind::Code(of) => {
            let wanted: String = value.extract()?;
            let known = of.variants.iter().find(|known| code(known.name) == wanted);
            let known = known.map(|variant| Value::Code(variant.number));
            known.ok_or_else(|| {
                let all: Vec<_> = of.variants.iter().map(|known| code(known.name)).collect();
                PyAttributeError::new_err(format!("'{wanted}': choose of {}", all.join(", ")))
            })?
        }
    })
}

/// The name of a variant in Python: `TimedPattern` is `timed-pattern`.
pub(crate) fn code(variant: &str) -> String {
    spaced(variant).replace(' ', "-")
}

fn to_number(value: Value) -> f64 {
    match value {
        Value::Bool(value) => f64::from(u8::from(value)),
        Value::Code(value) => value.into(),
        Value::Flags(value) | Value::Count(value) => value as f64,
        Value::Signed(value) | Value::Instant(value) => value as f64,
        Value::Number(value) => value,
    }
}

fn from_number(kind: Kind, number: f64) -> Value {
    match kind {
        Kind::Bool => Value::Bool(number != 0.0),
        Kind::Code(_) => Value::Code(number as u8),
        Kind::Flags => Value::Flags(number as u64),
        Kind::Count(_) => Value::Count(number as u64),
        Kind::Signed(_) => Value::Signed(number as i64),
        Kind::Instant => Value::Instant(number as i64),
        Kind::Number => Value::Number(number),
    }
}
