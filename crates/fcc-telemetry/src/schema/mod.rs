//! What follows from a [`Schema`](fcc_core::framework::schema::Schema):
//! columns of tables and arrays, the layout in memory, and the messages of a
//! recording with their description. Nothing here knows a field by name.

mod columns;
mod layout;
pub mod protobuf;
mod row;
mod words;

pub use columns::{Column, columns};
pub use layout::{layout_table, words_of};
pub use row::{Row, header};
pub use words::{Words, words, write_words};

/// The lines of a doc comment as one: its first paragraph, without the marks of
/// links and code.
pub(crate) fn meaning(lines: &str) -> String {
    let words: Vec<_> = lines
        .lines()
        .map(str::trim)
        .take_while(|line| !line.is_empty())
        .collect();
    words.join(" ").replace(['[', ']', '`'], "")
}
