//! What belongs together in a calibration and `[navigation]`.

use fcc_calibration::Axes;

use super::places::Places;
use super::{CalibrationSection, Config, NavigationMethod, RawSource};

/// The earth's field at its surface until 2030, µT (World Magnetic Model 2025,
/// technical report, figure of the total intensity: 22 to 67).
const FIELD_UT: std::ops::RangeInclusive<f64> = 22.0..=67.0;
/// µT of a gauss.
const GAUSS_UT: f64 = 100.0;

/// Reports the message of each violated constraint, as `relations` does.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    if let Some(field) = config.navigation.magnetic_field_ut
        && let Some(message) = wrong_field(field)
    {
        report(&["navigation.magnetic_field_ut"], message);
    }
    let sources = config.raw_sources();
    let delays = config.navigation.is_by_filter();
    for source in &sources {
        let key = source.calibration_key();
        check_axes(&key, &source.calibration, report);
        if delays {
            check_delays(config, &key, &source.calibration, report);
        }
    }
    if let Some(section) = &config.built_in
        && !sources.iter().any(RawSource::is_built_in)
    {
        check_axes("built-in.calibration", &section.calibration, report);
    }
}

fn check_axes(section: &str, of: &CalibrationSection, report: &mut impl FnMut(&[&str], String)) {
    for (sensor, axes) in [
        ("accelerometer", Axes::from(&of.accelerometer)),
        ("gyroscope", Axes::from(&of.gyroscope)),
        ("magnetometer", Axes::from(&of.magnetometer)),
    ] {
        let (least, most) = axes.multiplies();
        let permitted = Axes::MULTIPLIES;
        if !permitted.contains(&least) || !permitted.contains(&most) {
            let key = |name: &str| format!("{section}.{sensor}.{name}");
            let message = format!(
                "multiplies what is measured, with scale, by {least:.2} along one direction and by \
                 {most:.2} along another: choose values with {} to {} along all; of axes that are \
                 nearly at right angles all misalignments are nearly 0",
                permitted.start(),
                permitted.end()
            );
            report(&[&key("misalignment"), &key("scale")], message);
        }
    }
}

fn check_delays(
    config: &Config,
    section: &str,
    of: &CalibrationSection,
    report: &mut impl FnMut(&[&str], String),
) {
    let longest_ms = config.navigation.longest_delay_ms;
    for (sensor, delay_ms) in of.delays_of_navigation() {
        if delay_ms > longest_ms {
            let key = format!("{section}.{sensor}.delay_ms");
            let message = format!(
                "is {delay_ms}, and navigation.longest_delay_ms is {longest_ms}: choose at most \
                 that, or a longer one (up to {} ms): navigation does not use what comes later",
                super::navigation::LONGEST_DELAY_MS
            );
            report(&[&key, "navigation.longest_delay_ms"], message);
        }
    }
}

/// Why this is not the earth's field.
fn wrong_field(field: [f64; 3]) -> Option<String> {
    let strength = field.iter().map(|part| part * part).sum::<f64>().sqrt();
    if FIELD_UT.contains(&strength) {
        return None;
    }
    let unit = if FIELD_UT.contains(&(strength * GAUSS_UT)) {
        "; multiply gauss by 100"
    } else {
        ""
    };
    Some(format!(
        "has a strength of {strength:.2}: choose north, east and down in µT, {} to {} together, as \
         everywhere on earth{unit}",
        FIELD_UT.start(),
        FIELD_UT.end()
    ))
}

/// What is given in the text and has no effect.
pub(super) fn without_effect(config: &Config, places: &Places<'_>) -> Vec<String> {
    let mut found = Vec::new();
    let has_raw = config.raw_sources().iter().any(RawSource::is_built_in);
    let mut say = |key: &str, why: &str| {
        if places.has(key) {
            found.push(format!("{key} has no effect: {why}"));
        }
    };
    if config.built_in.is_some() && !has_raw {
        let why = "built-in.raw_sensors is \"none\", its default: there is nothing to calibrate";
        say("built-in.calibration", why);
    }
    let of_the_filter = [
        "navigation.longest_delay_ms",
        "navigation.magnetic_field_ut",
        "navigation.year",
    ];
    match config.navigation.method {
        NavigationMethod::Measured => {
            for key in of_the_filter {
                let why =
                    "navigation.method is \"measured\", its default: sensors measure attitude";
                say(key, why);
            }
        }
        NavigationMethod::Kalman if config.navigation.magnetic_field_ut.is_some() => {
            let why = "navigation.magnetic_field_ut is given, so no model is needed";
            say("navigation.year", why);
        }
        NavigationMethod::Kalman if has_raw => {
            let why = "the magnetic field of the built-in aircraft is known";
            say("navigation.year", why);
        }
        NavigationMethod::Kalman => {}
    }
    found
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    const RAW: &str = "[built-in]\nraw_sensors = \"board\"\n[navigation]\nmethod = \"kalman\"\n";

    fn refused(text: &str) -> String {
        Config::parse(text, "f").unwrap_err().to_string()
    }

    #[test]
    fn a_calibration_that_loses_a_direction_is_refused() {
        let with = |misalignment: f64| {
            let all = vec![misalignment.to_string(); 6].join(", ");
            format!("[built-in.calibration.magnetometer]\nmisalignment = [{all}]\n")
        };
        // 1.49 times the unit matrix minus 0.49 everywhere: 1.49 - 3 · 0.49.
        let message = refused(&with(-0.49));
        let words = "f:2: built-in.calibration.magnetometer.misalignment: multiplies what is \
                     measured, with scale, by 0.02 along one direction";
        assert!(message.starts_with(words), "{message}");
        assert!(refused(&with(-0.5)).contains("by 0.00 along"));
        Config::parse(&with(-0.2), "f").unwrap();
    }

    #[test]
    fn a_delay_that_navigation_does_not_wait_for_is_refused() {
        let late = "[built-in.calibration.gnss]\ndelay_ms = 400\n";
        let message = refused(&format!("{RAW}{late}"));
        let words = "f:6: built-in.calibration.gnss.delay_ms: is 400, and \
                     navigation.longest_delay_ms is 200: choose at most that, or a longer one \
                     (up to 500 ms)";
        assert!(message.starts_with(words), "{message}");
        Config::parse(&format!("{RAW}longest_delay_ms = 400\n{late}"), "f").unwrap();
        let board = "[navigation]\nmethod = \"kalman\"\n[servo-board]\nserial = \"/dev/ttyUSB0\"\n\
                     [servo-board.differential_pressure]\ndelay_ms = 400\n\
                     [[sensor]]\nkind = \"icm42688\"\nspi = \"/dev/spidev0.0\"\n\
                     [[sensor]]\nkind = \"servo-board\"\n[[actuator]]\nkind = \"servo-board\"\n";
        let words = "f:6: servo-board.differential_pressure.delay_ms: is 400";
        let message = refused(board);
        assert!(message.starts_with(words), "{message}");
        // It says nothing of what navigation does not use, or is not used.
        for text in [
            format!("{RAW}[built-in.calibration.range]\ndelay_ms = 900\n"),
            format!("[built-in]\nraw_sensors = \"board\"\n{late}"),
        ] {
            Config::parse(&text, "f").unwrap();
        }
    }

    #[test]
    fn a_field_that_is_not_the_earths_is_refused() {
        let with = |field: &str| format!("{RAW}magnetic_field_ut = [{field}]\n");
        let zero = refused(&with("0, 0, 0"));
        let words = "f:5: navigation.magnetic_field_ut: has a strength of 0.00: choose north, east \
                     and down in µT, 22 to 67 together";
        assert!(zero.starts_with(words) && !zero.contains("gauss"), "{zero}");
        assert!(refused(&with("0.211, 0.0, 0.453")).ends_with("; multiply gauss by 100"));
        assert!(refused(&with("60, 0, 60")).contains("strength of 84.85"));
        Config::parse(&with("21.1, 0.0, 45.3"), "f").unwrap();
    }

    #[test]
    fn keys_without_effect_are_named() {
        let remarks = |text: &str| {
            let all = Config::parse(text, "f").unwrap().remarks(text);
            let mut keys = Vec::new();
            for remark in &all {
                if let Some((key, _)) = remark.split_once(" has no effect: ") {
                    keys.push(key.to_owned());
                }
            }
            keys
        };
        let calibrated = "[built-in.calibration.gnss]\ndelay_ms = 20\n";
        assert_eq!(remarks(calibrated), ["built-in.calibration"]);
        assert_eq!(remarks(&format!("{RAW}{calibrated}")), [""; 0]);
        let all = "longest_delay_ms = 100\nmagnetic_field_ut = [21.1, 0, 45.3]\nyear = 2026\n";
        assert_eq!(remarks(&format!("{RAW}{all}")), ["navigation.year"]);
        assert_eq!(remarks(&format!("{RAW}year = 2026\n")), ["navigation.year"]);
        let text = format!("{RAW}{all}").replace("kalman", "measured");
        assert_eq!(remarks(&text).len(), 3);
    }
}
