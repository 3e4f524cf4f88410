//! What is wrong with a plan, and where.

use std::fmt;

use serde::Serialize;

/// One problem of a plan or of its file.
///
/// ```
/// let problem = fcc_plan::Problem::of_item(3, "latitude", "91: give -90 to 90");
/// assert_eq!(problem.to_string(), "item 3: latitude: 91: give -90 to 90");
/// ```
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Problem {
    /// The number of the item, from 1, as ground stations show it; none for what
    /// is of the whole plan, of its fence or its rally points.
    pub item: Option<usize>,
    /// The field, in the words of the file where it has some.
    pub field: String,
    /// What is wrong and what to do.
    pub message: String,
}

impl Problem {
    /// A problem of an item.
    pub fn of_item(item: usize, field: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            item: Some(item),
            field: field.into(),
            message: message.into(),
        }
    }

    /// A problem of something else.
    pub fn of(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            item: None,
            field: field.into(),
            message: message.into(),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(item) = self.item {
            write!(f, "item {item}: ")?;
        }
        if !self.field.is_empty() {
            write!(f, "{}: ", self.field)?;
        }
        f.write_str(&self.message)
    }
}

/// The longest quotation from a file, in characters.
const LONGEST_QUOTATION: usize = 40;

/// A text of a file, short enough for a message.
pub(crate) fn quoted(text: &str) -> String {
    match text.char_indices().nth(LONGEST_QUOTATION) {
        Some((end, _)) => format!("{}...", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}
