//! Files of plans.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use crate::plan::{Plan, limits};
use crate::problem::Problem;
use crate::{mavproxy, qgc_plan, wpl};

/// The format of a file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// QGroundControl's JSON.
    QgcPlan,
    /// `QGC WPL 110`.
    QgcWpl,
}

impl Format {
    /// By the end of a file's name: `.plan`, or `.waypoints`, `.wpl` or `.txt`.
    pub fn of_name(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()? {
            "plan" => Some(Self::QgcPlan),
            "waypoints" | "wpl" | "txt" => Some(Self::QgcWpl),
            _ => None,
        }
    }

    /// By the content.
    fn of_text(text: &str) -> Self {
        let begin = text.trim_start_matches('\u{feff}').trim_start();
        if begin.starts_with(['{', '/', '[']) {
            Self::QgcPlan
        } else {
            Self::QgcWpl
        }
    }
}

/// Why a file gives no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// It cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// Its name.
        file: String,
        /// The reason.
        source: io::Error,
    },
    /// It is no plan, or one that this program cannot fly.
    #[error("{}", each(file, problems))]
    Invalid {
        /// Its name.
        file: String,
        /// At least one.
        problems: Vec<Problem>,
    },
}

fn each(file: &str, problems: &[Problem]) -> String {
    let mut text = String::new();
    for (n, problem) in problems.iter().enumerate() {
        let end = if n == 0 { "" } else { "\n" };
        let _ = write!(text, "{end}{file}: {problem}");
    }
    text
}

/// Reads a plan from a text of either format, which its content tells; or a fence, or rally
/// points, of older versions of MAVProxy.
///
/// ```
/// let text = "QGC WPL 110\n\
///     0 1 0 16 0 0 0 0 47.4 8.5 430 1\n\
///     1 0 3 16 0 0 0 0 47.5 8.6 300 1\n\
///     2 0 3 82 0 0 0 0 47.5 8.6 300 1\n";
/// let problems = fcc_plan::read(text).unwrap_err();
/// assert!(problems[0].to_string().starts_with("item 2: line 4: command: 82 is not supported"));
/// ```
///
/// # Errors
/// All problems, at most [`limits::PROBLEMS`], in the order of the items, then the others.
pub fn read(text: &str) -> Result<Plan, Vec<Problem>> {
    let read = match Format::of_text(text) {
        Format::QgcPlan => qgc_plan::read(text),
        Format::QgcWpl => mavproxy::read(text).unwrap_or_else(|| wpl::read(text)),
    };
    read.map_err(|mut problems| {
        problems.sort_by_key(|problem| problem.item.unwrap_or(usize::MAX));
        problems
    })
}

/// Whether a text is meant as a plan: the first line of `QGC WPL` in any version, or the
/// `fileType` of QGroundControl's.
pub fn is_plan(text: &str) -> bool {
    match Format::of_text(text) {
        Format::QgcWpl => text
            .trim_start_matches('\u{feff}')
            .trim_start()
            .starts_with("QGC WPL"),
        Format::QgcPlan => {
            let is_type = |rest: &str| {
                rest.trim_start_matches([':', ' ', '\t'])
                    .starts_with("\"Plan\"")
            };
            text.split("\"fileType\"").skip(1).any(is_type)
        }
    }
}

/// Reads a plan from a file of either format.
///
/// # Errors
/// That it cannot be read, or all of its problems.
pub fn read_file(path: &Path) -> Result<Plan, FileError> {
    let file = path.display().to_string();
    let invalid = |message: &str| FileError::Invalid {
        file: file.clone(),
        problems: vec![Problem::of("", message)],
    };
    let mut bytes = Vec::new();
    // A pipe without a writer would be waited for.
    let is_file = path.metadata().and_then(|found| {
        let refused = || io::Error::other("it is no file: give one");
        found.is_file().then_some(()).ok_or_else(refused)
    });
    let read_in = is_file
        .and_then(|()| File::open(path))
        .and_then(|opened| opened.take(limits::FILE_BYTES + 1).read_to_end(&mut bytes));
    if let Err(source) = read_in {
        return Err(FileError::Unreadable { file, source });
    }
    if bytes.len() as u64 > limits::FILE_BYTES {
        return Err(invalid(
            "is larger than 4 MiB: a plan has at most 1,000 items",
        ));
    }
    let text = String::from_utf8(bytes)
        .map_err(|_| invalid("is not UTF-8: give a .plan or a QGC WPL 110 file"))?;
    read(&text).map_err(|problems| FileError::Invalid { file, problems })
}

/// The text of a plan in a format.
///
/// # Errors
/// What the format has no place for.
pub fn write(plan: &Plan, format: Format) -> Result<String, Vec<Problem>> {
    match format {
        Format::QgcPlan => Ok(qgc_plan::write(plan)),
        Format::QgcWpl => wpl::write(plan),
    }
}
