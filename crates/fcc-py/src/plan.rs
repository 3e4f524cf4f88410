//! Flight plans: read, checked, written in either format.

use std::path::{Path, PathBuf};

use fcc_plan::{FileError, Format, Plan, Problem};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::config::{configuration, names_a_file};
use crate::errors;
use crate::json::to_python;

/// A flight plan of QGroundControl, or of `QGC WPL 110`. It cannot be changed.
///
/// `Plan(text)` reads a text of either format, `Plan.read(path)` a file. Raises
/// `PlanError` with every problem and its item.
///
/// >>> plan = fcc.Plan("""QGC WPL 110
/// ... 0 1 0 16 0 0 0 0 45.00 8.0 120 1
/// ... 1 0 3 16 0 0 0 0 45.05 8.0 700 1""")
/// >>> plan.items[0]["place"], plan.check()
/// ({'latitude_deg': 45.05, 'longitude_deg': 8.0}, [])
#[pyclass(name = "Plan", module = "fcc", frozen)]
pub(crate) struct PyPlan {
    plan: Plan,
}

fn invalid(problems: &[Problem]) -> PyErr {
    let lines: Vec<_> = problems.iter().map(ToString::to_string).collect();
    errors::PLAN.with(lines.join("\n"))
}

fn format_of(name: &str) -> PyResult<Format> {
    match name {
        "plan" => Ok(Format::QgcPlan),
        "wpl" => Ok(Format::QgcWpl),
        _ => Err(PyValueError::new_err(format!(
            "there is no format '{name}': choose plan or wpl"
        ))),
    }
}

#[pymethods]
impl PyPlan {
    #[new]
    fn new(text: &str) -> PyResult<Self> {
        if names_a_file(text, &["plan", "waypoints", "txt"]) {
            return Err(errors::PLAN.with(format!(
                "'{text}' is the name of a file: read it by Plan.read(path)"
            )));
        }
        let plan = fcc_plan::read(text).map_err(|problems| invalid(&problems))?;
        Ok(Self { plan })
    }

    /// Reads a file of either format, which its content tells.
    #[staticmethod]
    #[expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]
    fn read(path: PathBuf) -> PyResult<Self> {
        match fcc_plan::read_file(&path) {
            Ok(plan) => Ok(Self { plan }),
            Err(FileError::Unreadable { source, .. }) => Err(errors::of_file(&path, &source)),
            Err(error) => Err(errors::PLAN.with(error)),
        }
    }

    /// What keeps the aircraft of a configuration from flying it: of each problem the
    /// `item` (from 1; None: of the whole plan), the `field` and the `message`. Without a
    /// configuration it is a Cessna 172's, in 20 kt from any direction.
    #[pyo3(signature = (config = None))]
    fn check<'py>(
        &self,
        py: Python<'py>,
        config: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let problems = configuration(config)?.plan_problems(&self.plan);
        to_python(py, &problems)
    }

    /// Its items, as `fccd plan show --json` prints them: that of number n at index n - 1.
    #[getter]
    fn items<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.plan.items)
    }

    /// The SHA-256 of its content, whatever file it was in: 64 hexadecimal digits.
    #[getter]
    fn hash(&self) -> String {
        self.plan.hash().to_string()
    }

    /// Its text of a kind: "plan", QGroundControl's JSON, or "wpl". Raises `PlanError`
    /// for what the format has no place for.
    fn to_text(&self, kind: &str) -> PyResult<String> {
        fcc_plan::write(&self.plan, format_of(kind)?).map_err(|problems| invalid(&problems))
    }

    /// Writes it, in the format of the file's name: `.plan`, or `.waypoints`, `.wpl` or
    /// `.txt`. Raises `PlanError` for what the format has no place for.
    #[expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]
    fn write(&self, path: PathBuf) -> PyResult<()> {
        let format = Format::of_name(&path).ok_or_else(|| {
            PyValueError::new_err(format!(
                "{}: the format is not known by its name: end it with .plan, .waypoints, .wpl \
                 or .txt",
                path.display()
            ))
        })?;
        let text = fcc_plan::write(&self.plan, format).map_err(|problems| invalid(&problems))?;
        let others: [&Path; 0] = [];
        fcc_record::write_plan(&path, &others, text.as_bytes())
            .map_err(|error| errors::of_file(&path, &error))
    }

    fn __len__(&self) -> usize {
        self.plan.items.len()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.plan == other.plan
    }

    fn __hash__(&self) -> u64 {
        self.plan.hash().first_64_bits()
    }

    fn __repr__(&self) -> String {
        let items = self.plan.items.len();
        format!("<Plan {:.12} of {items} items>", self.plan.hash())
    }
}
