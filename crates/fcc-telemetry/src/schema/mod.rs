//! Generated from a [`Schema`](fcc_core::framework::schema::Schema): columns of
//! tables and arrays, the memory layout, and the messages of a recording with
//! their description. No field is named here.

mod columns;
mod description;
mod layout;
pub mod protobuf;
mod row;
mod words;

pub use columns::{Column, Leaves, columns};
pub use description::{DescribedColumn, RecordDescription};
pub use layout::{layout_table, spaced};
pub use row::{Row, header};
pub use words::{read_words, words, write_words};

/// The first paragraph of a doc comment in one line, without markup.
pub(crate) fn meaning(lines: &str) -> String {
    let words: Vec<_> = lines
        .lines()
        .map(str::trim)
        .take_while(|line| !line.is_empty())
        .collect();
    words.join(" ").replace(['[', ']', '`'], "")
}
