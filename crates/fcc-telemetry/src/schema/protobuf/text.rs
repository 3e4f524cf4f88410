//! The messages as text, for compilers.

use std::fmt::Write as _;

use fcc_core::framework::schema::{Enumeration, Kind};

use super::describe::{ONEOF, value_name};
use super::model::{FieldType, File, Message, MessageField};
use crate::schema::layout::end_of;
use crate::schema::meaning;

/// The longest line of a comment.
const WIDTH: usize = 80;

/// A file as the text of a `.proto`.
pub fn text(file: &File, package: &str) -> String {
    let mut out = format!(
        "// Generated from the declarations in the code (`schema!`); a test compares.\n\
         syntax = \"proto3\";\n\npackage {package};\n"
    );
    for of in &file.messages {
        message(&mut out, of);
    }
    for of in &file.enums {
        enumeration(&mut out, of);
    }
    out
}

fn message(out: &mut String, of: &Message) {
    out.push('\n');
    comment(out, "", &of.meaning);
    if of.fields.is_empty() && of.reserved.is_empty() {
        let _ = writeln!(out, "message {} {{}}", of.name);
        return;
    }
    let _ = writeln!(out, "message {} {{", of.name);
    for gone in &of.reserved {
        let _ = writeln!(out, "  reserved {gone};");
    }
    let indent = if of.is_choice { "    " } else { "  " };
    if of.is_choice {
        let _ = writeln!(out, "  oneof {ONEOF} {{");
    }
    for field in &of.fields {
        comment(out, indent, &comment_of(field));
        let optional = if field.is_optional() && !of.is_choice {
            "optional "
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "{indent}{optional}{} {} = {};",
            type_of(field),
            field.name,
            field.number
        );
    }
    if of.is_choice {
        out.push_str("  }\n");
    }
    out.push_str("}\n");
}

fn comment_of(field: &MessageField) -> String {
    let mut words = field.meaning.clone();
    if let Some((low, high)) = field.range {
        let _ = write!(words, " {} to {}.", end_of(low), end_of(high));
    }
    words
}

fn type_of(field: &MessageField) -> &str {
    match &field.of {
        FieldType::Leaf(Kind::Bool) => "bool",
        FieldType::Leaf(Kind::Code(of)) => of.name,
        FieldType::Leaf(Kind::Flags) => "fixed64",
        FieldType::Leaf(Kind::Count(_)) => "uint64",
        FieldType::Leaf(Kind::Signed(_)) => "sint64",
        FieldType::Leaf(Kind::Instant) => "sfixed64",
        FieldType::Leaf(Kind::Number) => "double",
        FieldType::Message(name) => name,
        FieldType::Text => "string",
    }
}

fn enumeration(out: &mut String, of: &Enumeration) {
    out.push('\n');
    comment(out, "", &meaning(of.meaning));
    let _ = writeln!(out, "enum {} {{", of.name);
    for variant in of.variants {
        comment(out, "  ", &meaning(variant.meaning));
        let name = value_name(of, variant.name);
        let _ = writeln!(out, "  {name} = {};", variant.number);
    }
    out.push_str("}\n");
}

/// A comment, wrapped.
fn comment(out: &mut String, indent: &str, words: &str) {
    let mut line = String::new();
    for word in words.split_whitespace() {
        if !line.is_empty() && indent.len() + 4 + line.len() + word.len() > WIDTH {
            let _ = writeln!(out, "{indent}//{line}");
            line.clear();
        }
        line.push(' ');
        line.push_str(word);
    }
    if !line.is_empty() {
        let _ = writeln!(out, "{indent}//{line}");
    }
}
