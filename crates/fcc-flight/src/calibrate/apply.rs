//! What was found, put over the configuration of a flight.

use std::path::PathBuf;

use toml::{Table, Value};

use super::entry::{given_of, over, turn};
use super::{CalibrationFile, CalibrationFileError, CalibrationKind, Entry};
use crate::config::{CalibrationSection, Config};
use fcc_calibration::Axes;

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
        if let Some(why) = what_differs(config, &entry) {
            let kind = entry.kind.name();
            let why = format!("the calibration of the {kind} is not used: {why}");
            applied.remarks.push(why);
            continue;
        }
        put(&mut changed, &entry)
            .map_err(|why| (path.clone(), CalibrationFileError::Unusable(why)))?;
        applied.used.push(entry);
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

/// What a configuration's navigation uses as it comes, if it does: no source has a
/// calibration of it, and `calibration.enabled` is not false. For users.
pub fn not_calibrated(config: &Config) -> Option<String> {
    let sources = config.raw_sources();
    let is_wanted = config.calibration.enabled && config.navigation.is_by_filter();
    if sources.is_empty() || !is_wanted {
        return None;
    }
    let none = CalibrationSection::default();
    let is_calibrated = |differs: fn(&CalibrationSection, &CalibrationSection) -> bool| {
        sources.iter().any(|one| differs(&one.calibration, &none))
    };
    let kinds = [
        (
            CalibrationKind::Gyroscope,
            is_calibrated(|one, none| one.gyroscope != none.gyroscope),
        ),
        (
            CalibrationKind::Accelerometer,
            is_calibrated(|one, none| one.accelerometer != none.accelerometer),
        ),
        (
            CalibrationKind::Magnetometer,
            is_calibrated(|one, none| one.magnetometer != none.magnetometer),
        ),
    ];
    let missing: Vec<_> = kinds
        .iter()
        .filter(|(_, is_calibrated)| !is_calibrated)
        .collect();
    let names: Vec<_> = missing.iter().map(|(kind, _)| kind.name()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "not calibrated: {}. Attitude and heading may err by several degrees, and flights end in \
             failsafe: use `fccd calibrate` for what there is of these",
            names.join(", ")
        )
    })
}

/// Why an entry is of other sensors, or of another configuration of them, if it is.
fn what_differs(config: &Config, entry: &Entry) -> Option<String> {
    let sources = config.raw_sources();
    let Some(source) = sources.iter().find(|source| source.place == entry.place) else {
        return Some(format!("{} gives no raw readings here", entry.place));
    };
    if source.sensor != entry.sensor {
        let (made_for, here) = (&entry.sensor, &source.sensor);
        return Some(format!("it was made for {made_for}, and here is {here}"));
    }
    let now = given_of(config, &entry.place, &entry.keys);
    let changed = changed_key(&now, &entry.replaced)?;
    // What was found may be given in the configuration, too.
    (now != entry.keys).then(|| {
        let key = source.calibration_key();
        format!("{key}.{changed} was changed since; calibrate it again, or change that back")
    })
}

/// The first key of another value than before.
fn changed_key(now: &Table, before: &Table) -> Option<String> {
    let mut keys = before.iter();
    keys.find_map(|(key, before)| match (now.get(key), before) {
        (Some(Value::Table(now)), Value::Table(before)) => {
            Some(format!("{key}.{}", changed_key(now, before)?))
        }
        (now, before) => (now != Some(before)).then(|| key.clone()),
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
    let mut sources = config.raw_sources().into_iter();
    let Some(source) = sources.find(|source| source.place == entry.place) else {
        return Ok(());
    };
    let mut values = Table::try_from(source.calibration).map_err(|error| error.to_string())?;
    over(&mut values, &entry.keys);
    let section: Result<CalibrationSection, _> = values.try_into();
    let section = section.map_err(|error: toml::de::Error| error.message().to_owned())?;
    config.set_calibration(&entry.place, &section);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::LockedCalibrationFile;
    use super::*;

    const DAY: u64 = 86_400;

    fn config(path: &std::path::Path, more: &str) -> Config {
        let text =
            format!("[calibration]\nfile = {path:?}\n[built-in]\nraw_sensors = \"board\"\n{more}");
        Config::parse(&text, "test").unwrap()
    }

    fn entry(kind: CalibrationKind, keys: &str) -> Entry {
        Entry {
            kind,
            place: "built-in".to_owned(),
            sensor: "simulated board, seed 1".to_owned(),
            date: "2026-11-22T22:50:00Z".to_owned(),
            unix_s: 1_795_387_800,
            program: "fccd 0.1.0".to_owned(),
            error: 0.01,
            error_limit: 0.05,
            unit: "°/s".to_owned(),
            temperature_k: None,
            aligned_with: Table::new(),
            replaced: Table::new(),
            keys: toml::from_str(keys).unwrap(),
        }
    }

    fn stored(entries: &[Entry]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state").join("fccd.calibration.toml");
        let mut file = LockedCalibrationFile::open(path.clone()).unwrap();
        for entry in entries {
            file.add(entry.clone()).unwrap();
        }
        (folder, path)
    }

    #[test]
    fn what_is_flown_uncalibrated_is_said() {
        let path = std::path::Path::new("none.toml");
        assert_eq!(not_calibrated(&config(path, "")), None);
        let kalman = "[navigation]\nmethod = \"kalman\"\n";
        let said = not_calibrated(&config(path, kalman)).unwrap();
        assert!(said.starts_with("not calibrated: gyroscope, accelerometer, magnetometer."));
        let two = format!(
            "{kalman}[built-in.calibration.gyroscope]\nbias_degps = [1.0, 0.0, 0.0]\n\
             [built-in.calibration.magnetometer]\nbias_ut = [1.0, 0.0, 0.0]\n"
        );
        let said = not_calibrated(&config(path, &two)).unwrap();
        assert!(said.starts_with("not calibrated: accelerometer."), "{said}");
    }

    #[test]
    fn what_was_found_replaces_the_same_keys_and_no_others() {
        let found = entry(
            CalibrationKind::Gyroscope,
            "[gyroscope]\nbias_degps = [0.5, 0.0, -0.25]\n",
        );
        let (_folder, path) = stored(&[found]);
        let given = "[built-in.calibration.gyroscope]\nbias_degps = [9.0, 9.0, 9.0]\n\
                     mounting = \"right-backward-down\"\n";
        let mut config = config(&path, given);
        let applied = apply(&mut config, 1_795_387_800 + DAY).unwrap();
        let gyroscope = config.built_in.unwrap().calibration.gyroscope;
        assert_eq!(gyroscope.bias_degps, [0.5, 0.0, -0.25]);
        assert_eq!(gyroscope.mounting.to_string(), "right-backward-down");
        let [said] = &applied.remarks[..] else {
            panic!("{applied:?}");
        };
        assert!(
            said.ends_with("gyroscope of 2026-11-22, error 0.010 °/s"),
            "{said}"
        );
    }

    #[test]
    fn stale_ones_are_used_and_said() {
        let mut field = entry(
            CalibrationKind::Magnetometer,
            "[magnetometer]\nbias_ut = [10.0, 0.0, 0.0]\n",
        );
        let axes = Axes::default();
        field.aligned_with = turn(axes.mounting, &axes.rotation);
        let (_folder, path) = stored(&[field]);
        for (more, days, expected) in [
            ("", 1, None),
            (
                "",
                181,
                Some("is 181 days old, calibration.stale_after_days is 180"),
            ),
            (
                "[built-in.calibration.accelerometer]\nmounting = \"backward-left-down\"\n",
                1,
                Some("an accelerometer that was turned in another way: calibrate it again"),
            ),
        ] {
            let mut config = config(&path, more);
            let applied = apply(&mut config, 1_795_387_800 + days * DAY).unwrap();
            let said = applied.remarks.join("\n");
            assert_eq!(applied.remarks.len(), 1 + usize::from(expected.is_some()));
            assert!(expected.is_none_or(|words| said.contains(words)), "{said}");
            let magnetometer = config.built_in.unwrap().calibration.magnetometer;
            assert_eq!(magnetometer.bias_ut, [10.0, 0.0, 0.0]);
        }
    }

    #[test]
    fn what_is_given_after_it_was_found_counts() {
        let turned = "[accelerometer]\nmounting = \"forward-left-up\"\n";
        let mut found = entry(CalibrationKind::Mounting, turned);
        found.replaced = toml::from_str(&turned.replace("left-up", "right-down")).unwrap();
        let (_folder, path) = stored(&[found]);
        let changed = "the calibration of the mounting is not used: \
                       built-in.calibration.accelerometer.mounting was changed since";
        for (given, flown, expected) in [
            ("forward-right-down", "forward-left-up", "calibrated by"),
            ("forward-left-up", "forward-left-up", "calibrated by"),
            ("right-backward-down", "right-backward-down", changed),
        ] {
            let more = format!("[built-in.calibration.accelerometer]\nmounting = \"{given}\"\n");
            let mut config = config(&path, &more);
            let applied = apply(&mut config, 1_795_387_800).unwrap();
            let [said] = &applied.remarks[..] else {
                panic!("{applied:?}");
            };
            assert!(said.starts_with(expected), "{said}");
            let mounting = config.built_in.unwrap().calibration.accelerometer.mounting;
            assert_eq!(mounting.to_string(), flown);
        }
    }

    #[test]
    fn a_file_that_cannot_be_used_is_refused_and_changes_nothing() {
        let bias = |bias: &str| {
            entry(
                CalibrationKind::Gyroscope,
                &format!("[gyroscope]\n{bias} = [500.0, 0.0, 0.0]\n"),
            )
        };
        for (key, expected) in [
            ("bias_degps", "bias_degps[0] is 500: choose -50 to 50"),
            ("bias", "unknown field `bias`"),
        ] {
            let (_folder, path) = stored(&[bias(key)]);
            let mut config = config(&path, "");
            let (_, error) = apply(&mut config, 0).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
            assert!(config.built_in.unwrap().calibration.to_core().is_none());
        }
        for (content, expected) in [
            ("", "is damaged"),
            ("hello\n", "was not written by fccd calibrate"),
            (
                "# fccd-calibration 2 00000000\n",
                "of another version of fccd (2",
            ),
            (
                "# fccd-calibration 1 00000000\nx",
                "is damaged, or was edited",
            ),
        ] {
            let (_folder, path) = stored(&[entry(CalibrationKind::Airspeed, "")]);
            std::fs::write(&path, content).unwrap();
            let (_, error) = apply(&mut config(&path, ""), 0).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
        }
    }

    #[test]
    fn the_old_file_is_kept_and_a_link_is_not_followed() {
        let of = |bias: &str| {
            entry(
                CalibrationKind::Airspeed,
                &format!("[differential_pressure]\nbias_pa = {bias}\n"),
            )
        };
        let (_folder, path) = stored(&[of("1.0"), of("2.0")]);
        let copy = path.with_extension("old.toml");
        let old = CalibrationFile::read(&copy).unwrap();
        assert_eq!(old.calibration, [of("1.0")]);
        assert_eq!(
            CalibrationFile::read(&path).unwrap().calibration,
            [of("2.0")]
        );
        std::fs::write(&path, "").unwrap();
        let damaged = CalibrationFile::read(&path).unwrap_err().to_string();
        let put_back = format!("put back {}, or remove it", copy.display());
        assert!(damaged.contains(&put_back), "{damaged}");
        std::fs::copy(&copy, &path).unwrap();
        let first = LockedCalibrationFile::open(path.clone()).unwrap();
        let second = LockedCalibrationFile::open(path.clone()).unwrap_err();
        assert!(second.to_string().contains("another fccd calibrate"));
        drop(first);
        assert!(LockedCalibrationFile::open(path.clone()).is_ok());
        let link = path.with_file_name("link.calibration.toml");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        let error = CalibrationFile::read(&link).unwrap_err().to_string();
        assert!(error.contains("symbolic link"), "{error}");
    }
}
