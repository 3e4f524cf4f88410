//! The JSON Schema of a configuration, for editors.
//!
//! A section's own reader says which keys it has and of which types they are: it is asked by
//! a deserializer without values. Ranges and defaults are those of the checks.

use std::iter::once;

use serde::de::value::{Error, MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Deserializer, Error as _, IntoDeserializer, Visitor};
use serde::{Deserialize, forward_to_deserialize_any};
use serde_json::{Map, Value, json};
use toml::Spanned;
use toml::de::DeTable;

use super::entry::{Entry, Keys};
use super::{
    ActuatorEntry, BuiltInSection, Config, SensorEntry, ServoBoardSection, XPlaneSection, ranges,
};

/// An entry of a list, in a path.
const ENTRY: &str = "[]";

/// The JSON Schema (draft 7) of a configuration.
pub fn schema() -> Value {
    let defaults = Config {
        x_plane: Some(XPlaneSection::default()),
        built_in: Some(BuiltInSection::default()),
        servo_board: Some(ServoBoardSection::default()),
        ..Config::default()
    };
    let lists = [
        ("sensor".to_owned(), list::<SensorEntry>()),
        ("actuator".to_owned(), list::<ActuatorEntry>()),
    ];
    let source = Source {
        read: &|probe| drop(Config::deserialize(probe)),
        range: &ranges::range_of,
        defaults: json!(defaults),
        others: lists.into_iter().collect(),
    };
    source.schema(&[])
}

/// All keys and sections, with the sections that they are in.
pub(super) fn keys() -> Vec<String> {
    fn below(prefix: &str, schema: &Value, keys: &mut Vec<String>) {
        let properties = schema.get("properties").and_then(Value::as_object);
        for (name, inner) in properties.into_iter().flatten() {
            let key = format!("{prefix}{name}");
            below(&format!("{key}."), inner, keys);
            keys.push(key);
        }
    }
    let mut found = Vec::new();
    below("", &schema(), &mut found);
    found
}

/// A list whose entries have the keys of their kind.
fn list<T: Entry>() -> Value {
    let of_kind = |kind: &&str| {
        let source = Source {
            read: &|probe| drop(T::read(kind, Spanned::new(0..0, DeTable::new()), probe)),
            range: &|key| ranges::range_of_entry(kind, key),
            defaults: Value::Null,
            others: Map::from_iter([("kind".to_owned(), json!({ "const": kind }))]),
        };
        source.schema(&[])
    };
    let kinds: Vec<_> = T::KINDS.iter().map(of_kind).collect();
    json!({ "type": "array", "items": { "oneOf": kinds } })
}

/// What a schema is made from.
struct Source<'s> {
    read: &'s dyn Fn(&mut Probe<'_>),
    range: &'s dyn Fn(&str) -> Option<(f64, f64)>,
    defaults: Value,
    /// Keys that are read in another way.
    others: Map<String, Value>,
}

impl Source<'_> {
    /// Of what is at a path.
    fn schema(&self, path: &[&'static str]) -> Value {
        let mut probe = Probe {
            path,
            asked: ("type", Value::Null),
            names: &[],
        };
        (self.read)(&mut probe);
        let inner = |name: &&'static str| {
            let inner = self.schema(&[path, &[*name]].concat());
            ((*name).to_owned(), inner)
        };
        let mut inner: Map<_, _> = probe.names.iter().map(inner).collect();
        let items = inner.remove(ENTRY);
        if path.is_empty() {
            inner.extend(self.others.clone());
        }
        let properties = (!inner.is_empty()).then_some(Value::Object(inner));
        let (least, most) = (self.range)(&path.join(".").replace(".[]", "")).unzip();
        let default = self.defaults.pointer(&format!("/{}", path.join("/")));
        let parts = [
            (probe.asked.0, Some(probe.asked.1)),
            ("minimum", least.map(Value::from)),
            ("maximum", most.map(Value::from)),
            ("default", default.cloned()),
            ("items", items),
            (
                "additionalProperties",
                properties.as_ref().map(|_| json!(false)),
            ),
            ("properties", properties),
        ];
        let given = parts.into_iter().filter_map(|(name, value)| {
            let value = value.filter(|value| !value.is_null());
            let is_whole = name == "default" && value.as_ref().is_some_and(Value::is_object);
            value
                .filter(|_| !is_whole)
                .map(|value| (name.to_owned(), value))
        });
        Value::Object(given.collect())
    }
}

type Names = &'static [&'static str];

/// Answers with no value, and notes what is asked for at its path.
pub(super) struct Probe<'p> {
    path: &'p [&'static str],
    asked: (&'static str, Value),
    names: Names,
}

impl Probe<'_> {
    fn note<T>(&mut self, key: &'static str, value: Value, names: Names) -> Result<T, Error> {
        self.asked = (key, value);
        self.names = names;
        Err(Error::custom("no value"))
    }
}

impl Keys<'_> for Probe<'_> {
    fn table<T: DeserializeOwned>(&mut self, _: Spanned<DeTable<'_>>, _: usize) -> Option<T> {
        T::deserialize(self).ok()
    }
}

impl IntoDeserializer<'_, Error> for &mut Probe<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

macro_rules! notes {
    ($($asked:tt => $($method:ident)*;)*) => { $($(
        fn $method<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
            self.note("type", json!($asked), &[])
        }
    )*)* };
}

impl<'de> Deserializer<'de> for &mut Probe<'_> {
    type Error = Error;

    notes! {
        null => deserialize_any;
        "boolean" => deserialize_bool;
        "string" => deserialize_str deserialize_string;
        "number" => deserialize_f64;
        "integer" => deserialize_i32 deserialize_i64 deserialize_u8 deserialize_u16
            deserialize_u32 deserialize_u64;
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_some(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let [_, rest @ ..] = self.path else {
            return self.note("type", json!("array"), &[ENTRY]);
        };
        self.path = rest;
        visitor.visit_seq(SeqDeserializer::new(once(self)))
    }

    fn deserialize_struct<V>(self, _: &str, keys: Names, visitor: V) -> Result<V::Value, Error>
    where
        V: Visitor<'de>,
    {
        let [key, rest @ ..] = self.path else {
            return self.note("type", json!("object"), keys);
        };
        self.path = rest;
        visitor.visit_map(MapDeserializer::new(once((*key, self))))
    }

    fn deserialize_enum<V>(self, _: &str, names: Names, _: V) -> Result<V::Value, Error>
    where
        V: Visitor<'de>,
    {
        self.note("enum", json!(names), &[])
    }

    forward_to_deserialize_any! {
        i8 i16 i128 u128 f32 char bytes byte_buf unit unit_struct newtype_struct tuple
        tuple_struct map identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at<'s>(schema: &'s Value, pointer: &str) -> &'s Value {
        let pointer = pointer.replace('.', "/properties/");
        schema.pointer(&pointer).unwrap_or(&Value::Null)
    }

    /// Types, ranges and defaults as the commented examples and the documents have them.
    #[test]
    fn each_key_has_its_type_its_range_and_its_default() {
        let schema = schema();
        for (key, expected) in [
            (
                ".loop.rate_hz",
                json!({ "type": "number", "minimum": 20.0, "maximum": 2000.0, "default": 40.0 }),
            ),
            (
                ".contingency.battery_charge_percent",
                json!({ "type": "number", "minimum": 0.0, "maximum": 100.0 }),
            ),
            (
                ".built-in.gusts",
                json!({ "enum": ["none", "light", "moderate", "severe"], "default": "none" }),
            ),
            (
                ".guidance.mode",
                json!({ "enum": ["hold", "plan", "timed-pattern"], "default": "timed-pattern" }),
            ),
            (".plan.file", json!({ "type": "string" })),
            (
                ".x-plane.simulator",
                json!({ "type": "string", "default": "127.0.0.1:49000" }),
            ),
            (
                ".engage.command_needs_switch",
                json!({ "type": "boolean", "default": true }),
            ),
            (".rights.commanders.items", Value::Null),
        ] {
            assert_eq!(*at(&schema, key), expected, "{key}");
        }
    }

    /// A number without a range would be accepted whatever it is. Servos and addresses check
    /// their own; a range in psi is of one chip.
    #[test]
    fn every_number_has_a_range() {
        fn walk(at: &str, schema: &Value, without: &mut Vec<String>) {
            if let Value::Object(inner) = schema {
                let is_number = ["number", "integer"]
                    .iter()
                    .any(|name| schema["type"] == *name);
                if is_number && schema.get("minimum").is_none() {
                    without.push(at.to_owned());
                }
                inner
                    .iter()
                    .for_each(|(name, inner)| walk(&format!("{at}/{name}"), inner, without));
            }
            let entries = schema.as_array().into_iter().flatten();
            entries.for_each(|entry| walk(at, entry, without));
        }
        let mut without = Vec::new();
        walk("", &schema(), &mut without);
        without.retain(|at| {
            let is_checked = ["/address", "/range_psi"]
                .iter()
                .any(|end| at.ends_with(end));
            !is_checked && !at.starts_with("/properties/actuator/")
        });
        assert_eq!(without, [""; 0]);
    }

    /// Every example and what it becomes with its defaults has no key that the schema lacks.
    #[test]
    fn a_configuration_has_the_keys_of_the_schema() {
        let text = include_str!("../../../../config/built-in.toml");
        let values = Config::parse(text, "f").unwrap().values().unwrap();
        let keys = keys();
        for (key, _) in crate::config::keyed(&values) {
            assert!(keys.contains(&key), "{key}");
        }
    }
}
