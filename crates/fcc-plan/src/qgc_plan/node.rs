//! A value of the JSON text and where it is.

use std::ops::RangeInclusive;

use serde_json::{Map, Value};

use crate::command::{Refusal, check, place};
use crate::item::Place;
use crate::problem::quoted;

/// A value and its path, such as `mission.items[3].params[4]`.
#[derive(Clone)]
pub(super) struct Node<'a> {
    pub(super) path: String,
    value: &'a Value,
}

impl<'a> Node<'a> {
    pub(super) fn root(value: &'a Value) -> Self {
        Self {
            path: String::new(),
            value,
        }
    }

    pub(super) fn refuse<T>(&self, message: impl Into<String>) -> Result<T, Refusal> {
        let path = match self.path.as_str() {
            "" => "the file",
            path => path,
        };
        Err((path.to_owned(), message.into()))
    }

    fn object(&self) -> Result<&'a Map<String, Value>, Refusal> {
        match self.value {
            Value::Object(object) => Ok(object),
            _ => self.refuse("give an object, {...}"),
        }
    }

    /// Refuses keys other than these: one with another name would have no effect.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), Refusal> {
        let unknown = self
            .object()?
            .keys()
            .find(|key| !known.contains(&key.as_str()));
        match unknown {
            None => Ok(()),
            Some(key) => self.refuse(format!(
                "has a key \"{}\", and there is none of this name: choose {}",
                quoted(key),
                known.join(", ")
            )),
        }
    }

    /// Refuses a key whose name has a word of one of these, `(word, key)`, and is another.
    pub(super) fn none_like(&self, known: &[(&str, &str)]) -> Result<(), Refusal> {
        for key in self.object()?.keys() {
            let words = key.to_ascii_lowercase();
            let meant = known.iter().find(|(word, _)| words.contains(word));
            if let Some((_, meant)) = meant.filter(|(_, meant)| meant != key) {
                let given = quoted(key);
                return self.refuse(format!("has a key \"{given}\": write \"{meant}\""));
            }
        }
        Ok(())
    }

    /// The one of these keys with a list or an object that is not empty.
    pub(super) fn content(&self, keys: &[&str]) -> Result<Option<&'a str>, Refusal> {
        let is_full = |value: &Value| match value {
            Value::Array(values) => !values.is_empty(),
            Value::Object(values) => !values.is_empty(),
            _ => false,
        };
        let mut entries = self.object()?.iter();
        let found = entries.find(|(key, value)| keys.contains(&key.as_str()) && is_full(value));
        Ok(found.map(|(key, _)| key.as_str()))
    }

    /// A key; none if it is missing or null.
    pub(super) fn optional(&self, key: &str) -> Result<Option<Self>, Refusal> {
        let path = match self.path.as_str() {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        };
        let value = self.object()?.get(key).filter(|value| !value.is_null());
        Ok(value.map(|value| Self { path, value }))
    }

    /// A key that has to be there.
    pub(super) fn key(&self, key: &str) -> Result<Self, Refusal> {
        match self.optional(key)? {
            Some(node) => Ok(node),
            None => self.refuse(format!("lacks \"{key}\"")),
        }
    }

    pub(super) fn list(&self) -> Result<impl Iterator<Item = Self> + use<'a>, Refusal> {
        let Value::Array(values) = self.value else {
            return self.refuse("give a list, [...]");
        };
        let path = self.path.clone();
        let nodes = values.iter().enumerate().map(move |(n, value)| Self {
            path: format!("{path}[{n}]"),
            value,
        });
        Ok(nodes)
    }

    pub(super) fn text(&self) -> Result<&'a str, Refusal> {
        match self.value.as_str() {
            Some(text) => Ok(text),
            None => self.refuse("give a text"),
        }
    }

    pub(super) fn boolean(&self) -> Result<bool, Refusal> {
        match self.value.as_bool() {
            Some(value) => Ok(value),
            None => self.refuse("give true or false"),
        }
    }

    pub(super) fn number(&self, range: &RangeInclusive<f64>) -> Result<f64, Refusal> {
        match self.value.as_f64() {
            Some(number) => check(&self.path, number, range),
            None => self.refuse("give a number"),
        }
    }

    /// A number, or NaN for null.
    pub(super) fn number_or_null(&self) -> Result<f64, Refusal> {
        match self.value {
            Value::Null => Ok(f64::NAN),
            value => match value.as_f64().filter(|number| number.is_finite()) {
                Some(number) => Ok(number),
                None => self.refuse("give a number, or null"),
            },
        }
    }

    pub(super) fn whole(&self, most: u16) -> Result<u16, Refusal> {
        match self.value.as_f64() {
            Some(number) if number.fract() == 0.0 && (0.0..=f64::from(most)).contains(&number) => {
                Ok(number as u16)
            }
            _ => self.refuse(format!("give a whole number, 0 to {most}")),
        }
    }

    /// `[latitude, longitude]`, and an altitude where there is one.
    pub(super) fn coordinate(&self) -> Result<(Place, Option<f64>), Refusal> {
        let numbers: Vec<f64> = self
            .list()?
            .take(4)
            .map(|node| node.number_or_null())
            .collect::<Result<_, _>>()?;
        let (latitude, longitude, altitude) = match *numbers.as_slice() {
            [latitude, longitude] => (latitude, longitude, None),
            [latitude, longitude, altitude] => (latitude, longitude, Some(altitude)),
            _ => return self.refuse("give [latitude, longitude] or with an altitude"),
        };
        if (latitude, longitude) == (0.0, 0.0) {
            return self.refuse("0, 0 means that it is not set: give a place");
        }
        let place = place(latitude, longitude)
            .map_err(|(name, message)| (format!("{}: {name}", self.path), message))?;
        Ok((place, altitude))
    }

    /// Whether latitude and longitude are 0: a place that was not set.
    pub(super) fn is_unset(&self) -> bool {
        let numbers = self.value.as_array();
        numbers.is_some_and(|numbers| {
            let mut place = numbers.iter().take(2);
            place.all(|number| number.as_f64() == Some(0.0))
        })
    }

    /// `[latitude, longitude, altitude]`.
    pub(super) fn position(&self) -> Result<(Place, f64), Refusal> {
        let (place, altitude) = self.coordinate()?;
        let name = format!("{}: altitude", self.path);
        let altitude = check(
            &name,
            altitude.unwrap_or(f64::NAN),
            &crate::command::ALTITUDE_M,
        )?;
        Ok((place, altitude))
    }
}
