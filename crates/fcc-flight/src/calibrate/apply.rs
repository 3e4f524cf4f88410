//! What was found, put over the configuration of a flight.

use std::path::PathBuf;

use toml::{Table, Value};

use super::entry::turn;
use super::{CalibrationFile, CalibrationFileError, CalibrationKind, Entry};
use crate::config::{CalibrationSection, Config};
use fcc_core::flight::calibration::Axes;

const DAY_S: f64 = 86_400.0;

/// What of the file is used.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Applied {
    /// What is used, and what is wrong with it, for users.
    pub remarks: Vec<String>,
    /// The entries that are used.
    pub used: Vec<Entry>,
}

/// Puts what `fccd calibrate` found over the same keys of a configuration,
/// unless `calibration.enabled` is false or nothing gives raw readings; what was
/// found of other sensors is left out. `unix_s` is the present time.
///
/// # Errors
/// When the file is damaged, or a value in it is out of its range, with the name
/// of the file.
pub fn apply(config: &mut Config, unix_s: u64) -> Result<Applied, (PathBuf, CalibrationFileError)> {
    let path = config.calibration_file();
    if !config.calibration.enabled || config.raw_sources().is_empty() {
        return Ok(Applied::default());
    }
    let file = CalibrationFile::read(&path).map_err(|error| (path.clone(), error))?;
    let mut applied = Applied::default();
    let mut changed = config.clone();
    for entry in file.calibration {
        match what_differs(config, &entry) {
            Some(why) => {
                let kind = entry.kind.name();
                let why = format!("the calibration of the {kind} is not used: {why}");
                applied.remarks.push(why);
            }
            None => {
                put(&mut changed, &entry)
                    .map_err(|why| (path.clone(), CalibrationFileError::Unusable(why)))?;
                applied.used.push(entry);
            }
        }
    }
    // The ranges are those of a file.
    let checked = changed
        .to_toml()
        .and_then(|text| Config::parse_without_aircraft(&text, "it"));
    if let Err(error) = checked {
        let first = error.problems().into_iter().next();
        let why = first.map_or_else(String::new, |problem| {
            format!("{} {}", problem.key.unwrap_or_default(), problem.message)
        });
        return Err((path, CalibrationFileError::Unusable(why)));
    }
    *config = changed;
    if !applied.used.is_empty() {
        let what: Vec<_> = applied.used.iter().map(Entry::describe).collect();
        let what = format!("calibrated by {}: {}", path.display(), what.join("; "));
        applied.remarks.insert(0, what);
    }
    let stale = applied.used.iter();
    let stale: Vec<_> = stale
        .filter_map(|entry| staleness(config, entry, unix_s))
        .collect();
    applied.remarks.extend(stale);
    Ok(applied)
}

/// Why an entry is of other sensors, if it is.
fn what_differs(config: &Config, entry: &Entry) -> Option<String> {
    let sources = config.raw_sources();
    let Some(source) = sources.iter().find(|source| source.place == entry.place) else {
        return Some(format!("{} gives no raw readings here", entry.place));
    };
    (source.sensor != entry.sensor).then(|| {
        format!(
            "it was made for {}, and here is {}",
            entry.sensor, source.sensor
        )
    })
}

/// Why something should be calibrated again, if it should.
fn staleness(config: &Config, entry: &Entry, unix_s: u64) -> Option<String> {
    let kind = entry.kind.name();
    let days = unix_s.saturating_sub(entry.unix_s) as f64 / DAY_S;
    let most = config.calibration.stale_after_days;
    if days > most {
        return Some(format!(
            "the calibration of the {kind} is {days:.0} days old, calibration.stale_after_days is \
             {most}: calibrate it again"
        ));
    }
    let is_aligned = entry.kind == CalibrationKind::Magnetometer && !entry.aligned_with.is_empty();
    let sources = config.raw_sources();
    let now = sources.iter().find_map(|source| {
        let section = &source.calibration.accelerometer;
        let is_default = *section == CalibrationSection::default().accelerometer;
        let axes = Axes::from(section);
        (!is_default).then(|| turn(axes.mounting, &axes.rotation))
    });
    let now = now.unwrap_or_else(|| turn(Axes::default().mounting, &Axes::default().rotation));
    (is_aligned && now != entry.aligned_with).then(|| {
        format!(
            "the {kind} was aligned with an accelerometer that was turned in another way: \
             calibrate it again"
        )
    })
}

/// Puts an entry's keys over those of its place.
fn put(config: &mut Config, entry: &Entry) -> Result<(), String> {
    let Some(section) = config.calibration_of(&entry.place) else {
        return Ok(());
    };
    let mut values = Table::try_from(*section).map_err(|error| error.to_string())?;
    over(&mut values, &entry.keys);
    *section = values
        .try_into()
        .map_err(|error: toml::de::Error| error.message().to_owned())?;
    Ok(())
}

fn over(values: &mut Table, keys: &Table) {
    for (key, new) in keys {
        match (values.get_mut(key), new) {
            (Some(Value::Table(inner)), Value::Table(keys)) => over(inner, keys),
            _ => {
                values.insert(key.clone(), new.clone());
            }
        }
    }
}
