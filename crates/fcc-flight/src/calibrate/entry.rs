//! What was found of one sensor.

use fcc_calibration::{Axes, Found, Mounting, Rotation, Values};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::CalibrationKind;
use crate::config::{Config, RawSource};

/// What was found of one sensor, in the configuration's own keys.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// What was calibrated.
    pub kind: CalibrationKind,
    /// The key of the source in the configuration.
    pub place: String,
    /// Which sensor it is.
    pub sensor: String,
    /// When, UTC.
    pub date: String,
    /// The same in s since 1970.
    pub unix_s: u64,
    /// The program that found it.
    pub program: String,
    /// The error that is left, in `unit`.
    pub error: f64,
    /// The largest error that was accepted.
    pub error_limit: f64,
    /// The unit of both.
    pub unit: String,
    /// The mean temperature meanwhile, if a sensor measured it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature_k: Option<f64>,
    /// Of a magnetometer, how the accelerometer was turned with which it was
    /// aligned: `mounting` and `rotation_deg`.
    #[serde(default, skip_serializing_if = "Table::is_empty")]
    pub aligned_with: Table,
    /// The values that the configuration had of the same keys: others given since
    /// count instead of what was found.
    #[serde(default, skip_serializing_if = "Table::is_empty")]
    pub replaced: Table,
    /// The keys of the place's calibration and their values.
    pub keys: Table,
}

/// When something was found, and by what.
#[derive(Clone, Debug)]
pub(super) struct Circumstances<'a> {
    pub(super) source: &'a RawSource,
    /// The configuration without what was found before.
    pub(super) given: &'a Config,
    /// What was found before, as far as it is used.
    pub(super) before: &'a [Entry],
    pub(super) unix_s: u64,
    pub(super) temperature_k: Option<f64>,
    pub(super) accelerometer: Axes,
}

impl Entry {
    pub(super) fn new(kind: CalibrationKind, found: &Found, at: &Circumstances<'_>) -> Self {
        let aligned_with = match found.values {
            Values::Magnetometer {
                mounting: Some(_), ..
            } => turn(at.accelerometer.mounting, &at.accelerometer.rotation),
            _ => Table::new(),
        };
        let mut keys = keys(&found.values);
        if matches!(found.values, Values::GyroscopeBias { .. }) {
            // Scale and misalignment stay as they were found.
            let mut before = at.before.iter();
            let same = before.find(|of| (of.kind, &of.place) == (kind, &at.source.place));
            if let Some(same) = same {
                let found = std::mem::replace(&mut keys, same.keys.clone());
                over(&mut keys, &found);
            }
        }
        let (unit, in_unit) = unit(&found.values);
        Self {
            kind,
            place: at.source.place.clone(),
            sensor: at.source.sensor.clone(),
            date: fcc_record::timestamp(at.unix_s.saturating_mul(1_000_000_000)),
            unix_s: at.unix_s,
            program: concat!("fccd ", env!("CARGO_PKG_VERSION")).to_owned(),
            error: rounded(in_unit * found.quality.error),
            error_limit: rounded(in_unit * found.quality.limit),
            unit: unit.to_owned(),
            temperature_k: at.temperature_k.map(rounded),
            aligned_with,
            replaced: given_of(at.given, &at.source.place, &keys),
            keys,
        }
    }

    /// What it is, for users.
    pub fn describe(&self) -> String {
        let (kind, day) = (self.kind.name(), self.date.split('T').next());
        let day = day.unwrap_or_default();
        format!("{kind} of {day}, error {:.3} {}", self.error, self.unit)
    }
}

/// What the error of a calibration is in, and by what its value in the core is
/// multiplied for it.
fn unit(found: &Values) -> (&'static str, f64) {
    const DEGREES: f64 = 180.0 / std::f64::consts::PI;
    match found {
        Values::Accelerometer(_) => ("m/s²", 1.0),
        Values::Gyroscope { .. } => ("%", 100.0),
        Values::GyroscopeBias { .. } => ("°/s", DEGREES),
        Values::Magnetometer { .. } => ("µT", 1.0),
        Values::Airspeed { .. } => ("Pa", 1.0),
        Values::Mounting { .. } => ("°", DEGREES),
    }
}

/// To a hundred-millionth: no sensor gives more.
fn rounded(value: f64) -> f64 {
    (value * 1e8).round() / 1e8
}

fn list(values: impl IntoIterator<Item = f64>) -> Value {
    let values = values.into_iter().map(rounded).map(Value::Float);
    Value::Array(values.collect())
}

fn section(name: &str, keys: Table) -> (String, Value) {
    (name.to_owned(), Value::Table(keys))
}

/// The values that a configuration has of these keys of a place's calibration.
pub(super) fn given_of(config: &Config, place: &str, keys: &Table) -> Table {
    let mut sources = config.raw_sources().into_iter();
    let source = sources.find(|source| source.place == place);
    // A configuration that was read can be written.
    let values = source.and_then(|source| Table::try_from(source.calibration).ok());
    values.map_or_else(Table::new, |values| same_keys(values, keys))
}

fn same_keys(values: Table, keys: &Table) -> Table {
    let same = values.into_iter().filter_map(|(key, value)| {
        let value = match (value, keys.get(&key)?) {
            (Value::Table(inner), Value::Table(keys)) => Value::Table(same_keys(inner, keys)),
            (value, _) => value,
        };
        Some((key, value))
    });
    same.collect()
}

/// Puts keys over others.
pub(super) fn over(values: &mut Table, keys: &Table) {
    for (key, new) in keys {
        match (values.get_mut(key), new) {
            (Some(Value::Table(inner)), Value::Table(keys)) => over(inner, keys),
            _ => {
                values.insert(key.clone(), new.clone());
            }
        }
    }
}

/// A mounting as the configuration has it.
pub(super) fn turn(mounting: Mounting, rotation: &Rotation) -> Table {
    let angles = rotation.angles();
    let degrees = [angles.roll_rad, angles.pitch_rad, angles.heading_rad].map(f64::to_degrees);
    Table::from_iter([
        ("mounting".to_owned(), Value::String(mounting.to_string())),
        ("rotation_deg".to_owned(), list(degrees)),
    ])
}

fn shape(bias: &str, axes: &Axes) -> Table {
    Table::from_iter([
        (bias.to_owned(), list(axes.bias)),
        ("scale".to_owned(), list(axes.scale)),
        ("misalignment".to_owned(), list(axes.misalignment)),
    ])
}

fn keys(values: &Values) -> Table {
    match values {
        Values::Accelerometer(axes) => {
            Table::from_iter([section("accelerometer", shape("bias_mps2", axes))])
        }
        Values::Gyroscope { axes, .. } => {
            let axes = Axes {
                bias: axes.bias.map(f64::to_degrees),
                ..*axes
            };
            Table::from_iter([section("gyroscope", shape("bias_degps", &axes))])
        }
        Values::GyroscopeBias { bias_radps } => {
            let bias = list(bias_radps.map(f64::to_degrees));
            let keys = Table::from_iter([("bias_degps".to_owned(), bias)]);
            Table::from_iter([section("gyroscope", keys)])
        }
        Values::Magnetometer { axes, mounting, .. } => {
            let mut keys = shape("bias_ut", axes);
            if let Some((mounting, rotation)) = mounting {
                keys.extend(turn(*mounting, rotation));
            }
            Table::from_iter([section("magnetometer", keys)])
        }
        Values::Airspeed { bias_pa } => {
            let bias = Value::Float(rounded(*bias_pa));
            let keys = Table::from_iter([("bias_pa".to_owned(), bias)]);
            Table::from_iter([section("differential_pressure", keys)])
        }
        Values::Mounting { mounting, rotation } => {
            let of = |name| section(name, turn(*mounting, rotation));
            Table::from_iter(["accelerometer", "gyroscope"].map(of))
        }
    }
}
