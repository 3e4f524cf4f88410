//! The description in a recording, with which any program can read it.

use fcc_core::framework::schema::{Enumeration, Kind};
use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet, OneofDescriptorProto,
};

use super::model::{FieldType, File, Message, MessageField, snake};

/// A file as a serialized `FileDescriptorSet`.
pub fn describe(file: &File, name: &str, package: &str) -> Vec<u8> {
    let described = FileDescriptorProto {
        name: Some(name.to_owned()),
        package: Some(package.to_owned()),
        message_type: file.messages.iter().map(|m| message(m, package)).collect(),
        enum_type: file.enums.iter().map(|of| enumeration(of)).collect(),
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet {
        file: vec![described],
    }
    .encode_to_vec()
}

/// The name of the choice between a message's fields.
pub(super) const ONEOF: &str = "kind";

fn message(of: &Message, package: &str) -> DescriptorProto {
    let mut described = DescriptorProto {
        name: Some(of.name.clone()),
        ..DescriptorProto::default()
    };
    if of.is_choice {
        described.oneof_decl.push(oneof(ONEOF.to_owned()));
    }
    for field in &of.fields {
        let mut made = field_of(field, package);
        if of.is_choice {
            made.oneof_index = Some(0);
        } else if field.is_optional() {
            // How proto3 represents `optional`: a choice with one field.
            made.proto3_optional = Some(true);
            made.oneof_index = Some(described.oneof_decl.len() as i32);
            described.oneof_decl.push(oneof(format!("_{}", field.name)));
        }
        described.field.push(made);
    }
    described
}

const fn oneof(name: String) -> OneofDescriptorProto {
    OneofDescriptorProto {
        name: Some(name),
        options: None,
    }
}

impl MessageField {
    /// Whether it is written even if it is 0.
    pub(super) const fn is_optional(&self) -> bool {
        matches!(self.of, FieldType::Leaf(Kind::Number | Kind::Instant))
    }
}

fn field_of(field: &MessageField, package: &str) -> FieldDescriptorProto {
    let (kind, named) = match &field.of {
        FieldType::Leaf(Kind::Bool) => (Type::Bool, None),
        FieldType::Leaf(Kind::Code(of)) => (Type::Enum, Some(of.name)),
        FieldType::Leaf(Kind::Flags) => (Type::Fixed64, None),
        FieldType::Leaf(Kind::Count(_)) => (Type::Uint64, None),
        FieldType::Leaf(Kind::Signed(_)) => (Type::Sint64, None),
        FieldType::Leaf(Kind::Instant) => (Type::Sfixed64, None),
        FieldType::Leaf(Kind::Number) => (Type::Double, None),
        FieldType::Message(name) => (Type::Message, Some(name.as_str())),
        FieldType::Text => (Type::String, None),
    };
    FieldDescriptorProto {
        name: Some(field.name.clone()),
        number: i32::try_from(field.number).ok(),
        label: Some(Label::Optional.into()),
        r#type: Some(kind.into()),
        type_name: named.map(|name| format!(".{package}.{name}")),
        ..FieldDescriptorProto::default()
    }
}

fn enumeration(of: &Enumeration) -> EnumDescriptorProto {
    let value = of.variants.iter().map(|variant| EnumValueDescriptorProto {
        name: Some(value_name(of, variant.name)),
        number: Some(variant.number.into()),
        options: None,
    });
    EnumDescriptorProto {
        name: Some(of.name.to_owned()),
        value: value.collect(),
        ..EnumDescriptorProto::default()
    }
}

/// The proto3 name of an enum's value: prefixed with the enum's name, because
/// the values of all enums in a file share one scope.
pub(super) fn value_name(of: &Enumeration, variant: &str) -> String {
    format!("{}_{}", snake(of.name), snake(variant)).to_uppercase()
}
