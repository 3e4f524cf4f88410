//! The messages for a set of structs.

use fcc_core::framework::schema::{Enumeration, Field, Kind, Structure, Type};

use crate::schema::meaning;

/// The messages and enums for some structs, each once.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct File {
    /// In order of first use.
    pub messages: Vec<Message>,
    /// In order of first use.
    pub enums: Vec<&'static Enumeration>,
}

/// A message.
#[derive(Clone, PartialEq, Debug)]
pub struct Message {
    /// Its name.
    pub name: String,
    /// What it is.
    pub meaning: String,
    /// Its fields, in order.
    pub fields: Vec<MessageField>,
    /// Whether it contains only one of its fields.
    pub is_choice: bool,
    /// The reserved numbers of removed fields.
    pub reserved: Vec<u32>,
}

/// A field of a message.
#[derive(Clone, PartialEq, Debug)]
pub struct MessageField {
    /// Its name.
    pub name: String,
    /// Its number.
    pub number: u32,
    /// What it means.
    pub meaning: String,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// The smallest and the largest value.
    pub range: Option<(f64, f64)>,
    /// Its type.
    pub of: FieldType,
}

/// The type of a field.
#[derive(Clone, PartialEq, Debug)]
pub enum FieldType {
    /// A single value.
    Leaf(Kind),
    /// A message, by its name.
    Message(String),
    /// A text.
    Text,
}

/// A text written with a struct that is not one of its fields.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Extra {
    /// The struct.
    pub structure: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its number.
    pub number: u32,
    /// What it means.
    pub meaning: &'static str,
}

impl File {
    /// The messages for these structs and all that they contain.
    pub fn of(roots: &[Type], extra: &[Extra]) -> Self {
        let mut file = Self::default();
        for root in roots {
            file.add(*root);
        }
        for extra in extra {
            let mut messages = file.messages.iter_mut();
            if let Some(message) = messages.find(|message| message.name == extra.structure) {
                message.fields.push(MessageField {
                    name: extra.name.to_owned(),
                    number: extra.number,
                    meaning: extra.meaning.to_owned(),
                    unit: "",
                    range: None,
                    of: FieldType::Text,
                });
            }
        }
        file
    }

    fn add(&mut self, of: Type) {
        match of {
            Type::Leaf(Kind::Code(of)) => {
                if !self.enums.contains(&of) {
                    self.enums.push(of);
                }
            }
            Type::Leaf(_) => {}
            Type::Struct(of) => self.add_message(of, false),
            Type::Choice(of) => self.add_message(of, true),
        }
    }

    fn add_message(&mut self, of: &'static Structure, is_choice: bool) {
        let name = name_of(of);
        if self.messages.iter().any(|known| known.name == name) {
            return;
        }
        let fields = of.fields.iter().chain(of.derived);
        self.messages.push(Message {
            name,
            meaning: meaning(of.meaning),
            fields: fields.map(field).collect(),
            is_choice,
            reserved: Vec::new(),
        });
        for inner in of.fields {
            self.add(inner.of);
        }
    }
}

fn field(of: &'static Field) -> MessageField {
    let name = snake(of.name);
    MessageField {
        name: match of.of {
            Type::Leaf(Kind::Instant) => format!("{name}_ns"),
            _ => name,
        },
        number: of.number,
        meaning: meaning(of.meaning),
        unit: of.unit(),
        range: of.range,
        of: match of.of {
            Type::Leaf(kind) => FieldType::Leaf(kind),
            Type::Struct(of) | Type::Choice(of) => FieldType::Message(name_of(of)),
        },
    }
}

/// The name of a struct's message; a reading is named after its value.
pub(crate) fn name_of(of: &Structure) -> String {
    let value = match of.fields {
        [value, ..] if of.is_reading => value,
        _ => return of.name.to_owned(),
    };
    let kind = match value.of {
        Type::Leaf(Kind::Code(of)) => of.name.to_owned(),
        Type::Leaf(Kind::Bool) => "Bool".to_owned(),
        Type::Leaf(Kind::Flags) => "Flags".to_owned(),
        Type::Leaf(Kind::Count(_)) => "Count".to_owned(),
        Type::Leaf(Kind::Signed(_)) => "Signed".to_owned(),
        Type::Leaf(Kind::Instant) => "Instant".to_owned(),
        Type::Leaf(Kind::Number) => String::new(),
        Type::Struct(of) | Type::Choice(of) => name_of(of),
    };
    format!("{kind}{}", of.name)
}

/// `StateChanged` as `state_changed`.
pub(crate) fn snake(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.extend(letter.to_lowercase());
    }
    text
}
