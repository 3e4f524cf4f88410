//! Texts beside the records.

/// A text that belongs to a flight and came during it, such as a flight plan that replaced
/// another one: an attachment of the file, before the events that refer to it, and at the
/// begin of each file that follows.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Document {
    /// Its name, unlike that of any other document of the flight.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// What is said of the content to readers that do not know the name.
pub(super) const MEDIA_TYPE: &str = "application/json";
