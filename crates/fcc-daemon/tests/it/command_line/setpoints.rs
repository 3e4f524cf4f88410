//! `fccd command`: set points out of range are refused, in the units of the
//! command line.

use std::time::Instant;

use super::{Flight, PATIENCE, fccd};

#[test]
fn set_points_beyond_the_limits_are_refused_in_the_units_given() {
    let folder = tempfile::tempdir().unwrap();
    let instance = format!("command-{}", std::process::id());
    let _flight = Flight::start(folder.path(), &instance);
    let command = |words: &[&str]| {
        let ended = fccd(folder.path(), &["command", "set", "--instance", &instance])
            .args(words)
            .output()
            .unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        (ended.status.code(), said.trim_end().to_owned())
    };
    // The envelope's 65 and 135 kt, minus its margin of 8 kt.
    assert_eq!(
        command(&["--airspeed-kt", "300", "--altitude-ft", "3200"]),
        (
            Some(11),
            "fccd: refused: airspeed is 300 kt: choose 73 to 127 kt".to_owned()
        )
    );
    assert_eq!(
        command(&["--height-ft", "1000"]),
        (
            Some(11),
            "fccd: refused: a height needs the elevation of its field: set \
             altimeter.field_elevation_ft in the configuration, or give an altitude"
                .to_owned()
        )
    );
    // The flight engages after 2 s.
    let begun = Instant::now();
    let mut carried_out = command(&["--altimeter-inhg", "30.2", "--altitude-ft", "3200"]);
    while carried_out.1.contains("standby") && begun.elapsed() < PATIENCE {
        carried_out = command(&["--altimeter-inhg", "30.2", "--altitude-ft", "3200"]);
    }
    assert_eq!(carried_out, (Some(0), String::new()));
    for (words, said) in [
        (
            ["--altimeter-inhg", "1013"],
            "fccd: altimeter setting is 1013 inHg: choose 27.76 to 31.3 inHg",
        ),
        (
            ["--altimeter-hpa", "29.92"],
            "fccd: altimeter setting is 29.92 hPa: choose 940 to 1060 hPa",
        ),
        (
            ["--pressure-altitude-ft", "1e6"],
            "fccd: pressure altitude is 1000000 ft: choose -1640.42 to 65616.8 ft",
        ),
        (
            ["--heading-deg", "800"],
            "fccd: heading is 800°: choose -720 to 720°",
        ),
        (
            ["--altitude-ft", "1e6"],
            "fccd: altitude is 1000000 ft: choose -1640.42 to 65616.8 ft",
        ),
        (
            ["--airspeed-kt", "nan"],
            "fccd: airspeed is NaN kt: choose 10 to 650 kt",
        ),
    ] {
        assert_eq!(command(&words), (Some(2), said.to_owned()));
    }
}
