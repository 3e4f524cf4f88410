//! Each path in the layout in examples/foxglove exists in a recording.

use std::fs;

use mcap::Summary;
use prost::Message as _;
use prost_types::field_descriptor_proto::Type;
use prost_types::{DescriptorProto, FileDescriptorSet};
use serde_json::Value;

use fcc_record::Recorder;

use crate::recording::flight::{about, flight, only_file, record_all, settings};

const LAYOUT: &str = include_str!("../../../../../examples/foxglove/fccd.json");

/// All strings in a value that name a topic.
fn paths(value: &Value) -> Vec<&str> {
    match value {
        Value::String(text) if text.starts_with('/') => vec![text],
        Value::Array(values) => values.iter().flat_map(paths).collect(),
        Value::Object(values) => values.values().flat_map(paths).collect(),
        _ => Vec::new(),
    }
}

fn message<'a>(set: &'a FileDescriptorSet, name: &str) -> &'a DescriptorProto {
    let is_named = |file: &prost_types::FileDescriptorProto, message: &DescriptorProto| {
        format!("{}.{}", file.package(), message.name()) == name
    };
    let files = set.file.iter();
    files
        .flat_map(|file| file.message_type.iter().map(move |message| (file, message)))
        .find(|(file, message)| is_named(file, message))
        .map_or_else(|| panic!("{name}"), |(_, message)| message)
}

/// Whether a message has a number at the end of a path of fields.
fn has_number(set: &FileDescriptorSet, of: &str, path: &[&str]) -> bool {
    let Some((first, rest)) = path.split_first() else {
        return false;
    };
    let fields = &message(set, of).field;
    let Some(field) = fields.iter().find(|field| field.name() == *first) else {
        return false;
    };
    match (field.r#type(), rest) {
        (Type::Message, rest) => has_number(set, &field.type_name()[1..], rest),
        (Type::String | Type::Bytes, _) => false,
        (_, rest) => rest.is_empty(),
    }
}

#[test]
fn every_path_of_the_layout_is_in_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let recorder = Recorder::start(about(), settings(folder.path())).unwrap();
    record_all(recorder, &flight(3));
    let bytes = fs::read(only_file(folder.path())).unwrap();
    let summary = Summary::read(&bytes).unwrap().unwrap();

    let layout: Value = serde_json::from_str(LAYOUT).unwrap();
    let paths = paths(&layout);
    assert!(paths.len() > 15, "{paths:?}");
    for path in &paths {
        let (topic, fields) = path.split_once('.').unwrap_or((path, ""));
        let channel = summary.channels.values().find(|c| c.topic == topic);
        let channel = channel.unwrap_or_else(|| panic!("{path}: no such topic"));
        let schema = channel.schema.as_ref().unwrap();
        let set = FileDescriptorSet::decode(&*schema.data).unwrap();
        // What Foxglove computes from it comes last.
        let fields = fields.split(".@").next().unwrap_or("");
        if !fields.is_empty() {
            let fields: Vec<&str> = fields.split('.').collect();
            assert!(
                has_number(&set, &schema.name, &fields),
                "{path}: no such number"
            );
        }
    }
    // Angles are shown in degrees.
    for path in paths.iter().filter(|path| path.contains("_rad")) {
        assert!(path.ends_with(".@degrees"), "{path}");
    }
    // Each panel of the layout is configured.
    let panels = layout["configById"].as_object().unwrap();
    let placed = layout["layout"].to_string();
    for panel in panels.keys() {
        assert!(placed.contains(panel.as_str()), "{panel}");
    }
}
