//! Plans that are refused, flown to their end, and not.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use super::fccd;

/// Altitudes above home, which is at 120 m: a leg to the north, and a landing behind it.
const STRAIGHT_IN: &str = "QGC WPL 110\n\
     0 1 0 16 0 0 0 0 45.00 8 120 1\n\
     1 0 3 16 0 0 0 0 45.03 8 150 1\n\
     2 0 3 21 0 0 0 0 45.08 8 0 1\n";
const CIRCUIT: &str = include_str!("../../../../../config/plans/circuit.waypoints");

fn legs(latitude_deg: f64, above_home_m: f64) -> String {
    let mut text = format!("QGC WPL 110\n0 1 0 16 0 0 0 0 {latitude_deg} 8 120 1\n");
    for n in 1..3 {
        let north_deg = latitude_deg + 0.02 * f64::from(n);
        writeln!(text, "{n} 0 3 16 0 0 0 0 {north_deg} 8 {above_home_m} 1").unwrap();
    }
    text
}

fn ended(folder: &Path, words: &[&str]) -> (Option<i32>, String) {
    let output = fccd(folder, words).output().unwrap();
    let both = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(both).unwrap())
}

/// Flies a plan in lockstep.
fn flown(plan: &str, config: &str, more: &[&str]) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.waypoints"), plan).unwrap();
    fs::write(
        folder.path().join("a.toml"),
        format!("[built-in]\n{config}"),
    )
    .unwrap();
    let fly = ["fly", "--lockstep", "--no-recording", "--quiet"];
    let files = ["--config", "a.toml", "--plan", "a.waypoints"];
    let words: Vec<&str> = fly.iter().chain(&files).chain(more).copied().collect();
    ended(folder.path(), &words)
}

/// Home is at 120 m: -200 m above it is below the sea.
#[test]
fn a_plan_below_home_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("low.waypoints"), legs(45.0, -200.0)).unwrap();
    let words = "low.waypoints: item 1: altitude: -80 m above mean sea level is 200 m below the \
                 elevation of home, 120 m";
    let check = ["plan", "check", "low.waypoints"];
    for command in [
        &check[..],
        &["fly", "--plan", "low.waypoints", "--lockstep"],
    ] {
        let (exit, said) = ended(folder.path(), command);
        assert_eq!((exit, said.contains(words)), (Some(2), true), "{said}");
    }
    // Another aircraft may be over a valley.
    fs::write(folder.path().join("x.toml"), "[x-plane]\n").unwrap();
    let with = ["plan", "check", "low.waypoints", "--config", "x.toml"];
    let (exit, said) = ended(folder.path(), &with);
    assert_eq!(
        (exit, said.contains("is there a valley?")),
        (Some(0), true),
        "{said}"
    );
}

/// 0.5 m above the ground the wheels, 1.35 m below the centre of gravity, are on it.
#[test]
fn an_aircraft_that_touches_the_ground_has_hit_it() {
    let (exit, said) = flown(
        &legs(45.0, 0.5),
        "ground_ft = 393.7\naltitude_ft = 800.0\n",
        &[],
    );
    assert_eq!(exit, Some(16), "{said}");
    let words = "the wheels touch the ground outside of a take-off or a landing";
    assert!(said.contains(words), "{said}");
    assert!(
        said.contains("ended: the aircraft hit the ground"),
        "{said}"
    );
}

#[test]
fn a_plan_without_the_time_is_not_flown() {
    let (exit, said) = flown(STRAIGHT_IN, "", &["--seconds", "60"]);
    assert_eq!(exit, Some(19), "{said}");
    let words = "ended: the time to fly is over, and the plan is not flown to its end: item 1 was \
                 flown, in the mode plan: give it more time (--seconds)";
    assert!(said.contains(words), "{said}");
}

/// Set to 1030 hPa, which is 140 m off the standard 1013.25 hPa of the built-in aircraft.
#[test]
fn a_refused_take_off_is_no_flown_plan() {
    let altimeter = "[altimeter]\nsetting_hpa = 1030.0\n";
    let (exit, said) = flown(CIRCUIT, altimeter, &[]);
    assert_eq!(exit, Some(19), "{said}");
    let words = "ended: the plan is not flown to its end: item 1 was flown, in the mode take-off; \
                 no take-off: the altimeter does not show the elevation of the plan's home";
    assert!(said.contains(words), "{said}");
}

/// It ends where it stands, and not when the time is over.
#[test]
fn a_glide_to_the_ground_ends_the_flight() {
    let stops = "engine_stops_at_s = 60\n[contingency]\nengine_out_below_rpm = 500\n";
    let (exit, said) = flown(CIRCUIT, stops, &[]);
    assert_eq!(exit, Some(19), "{said}");
    let words = "ended: the plan is not flown to its end: the mode glide was flown; it has glided \
                 without power, and stands";
    assert!(said.contains(words), "{said}");
}

/// It idles with 650 rpm.
#[test]
fn an_engine_that_is_out_takes_off_nowhere() {
    let slow = "[contingency]\nengine_out_below_rpm = 800\n";
    let (exit, said) = flown(CIRCUIT, slow, &[]);
    assert_eq!(exit, Some(19), "{said}");
    let words = "ended: the plan is not flown to its end: item 1 was flown, in the mode take-off; \
                 the take-off is given up: the engine is out; start it, or set engine_out_below_rpm \
                 below the speed at which it idles";
    assert!(said.contains(words), "{said}");
}

/// Nothing is configured that watches the engine.
#[test]
fn an_engine_that_does_not_run_gives_the_take_off_up() {
    let (exit, said) = flown(CIRCUIT, "engine_stops_at_s = 0\n", &[]);
    assert_eq!(exit, Some(19), "{said}");
    let words = "ended: the plan is not flown to its end: item 1 was flown, in the mode take-off; \
                 the take-off is given up: rotate_kt is not reached within longest_roll_m or the \
                 time of such a roll; look at the engine, the brakes and the load";
    assert!(said.contains(words), "{said}");
}

#[test]
fn a_plan_with_a_jump_for_ever_ends_with_its_time() {
    let plan = legs(45.0, 800.0) + "3 0 2 177 1 -1 0 0 0 0 0 1\n";
    let (exit, said) = flown(&plan, "", &[]);
    assert_eq!(exit, Some(0), "{said}");
    assert!(said.contains("ended: the time to fly is over\n"), "{said}");
    assert!(said.contains("item 3: jump: for ever"), "{said}");
}

#[test]
fn plans_are_flown_to_their_end() {
    let mut back = legs(45.0, 800.0);
    back += "3 0 3 20 0 0 0 0 0 0 0 1\n";
    for plan in [&legs(45.0, 800.0), &back, CIRCUIT] {
        let (exit, said) = flown(plan, "", &[]);
        assert_eq!(exit, Some(0), "{said}");
        assert!(
            said.contains("ended: the plan is flown to its end"),
            "{said}"
        );
    }
}

/// The other configuration has no plan of its own: it flew nothing, and 0 ticks of 27,000
/// were compared with exit code 0.
#[test]
fn another_configuration_is_compared_on_the_recorded_plan() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("a.waypoints"), CIRCUIT).unwrap();
    let other = "[built-in]\n[autopilot.heading]\nroll_rate_gain = 0.9\n";
    fs::write(at.join("other.toml"), other).unwrap();
    // The recording has no raw readings, so this one never engages.
    let idle = "[built-in]\nraw_sensors = \"board\"\n[navigation]\nmethod = \"kalman\"\n";
    fs::write(at.join("idle.toml"), idle).unwrap();
    let fly = ["fly", "--lockstep", "--quiet", "--recordings", "flown"];
    let (exit, said) = ended(at, &[&fly[..], &["--plan", "a.waypoints"]].concat());
    assert_eq!(exit, Some(0), "{said}");
    let recordings = fs::read_dir(at.join("flown")).unwrap();
    let mut files = recordings.map(|entry| entry.unwrap().path());
    let file = files.find(|path| path.extension().is_some_and(|ext| ext == "mcap"));
    let file = file.unwrap();
    let file = file.to_str().unwrap();

    let words = ["replay", file, "--json", "--config"];
    let (exit, said) = ended(at, &[&words[..], &["other.toml"]].concat());
    assert_eq!(exit, Some(0), "{said}");
    let result: serde_json::Value = serde_json::from_str(&said).unwrap();
    let deviation = &result["deviation"];
    assert_eq!(deviation["only_recorded"], 0, "{said}");
    assert!(deviation["compared"].as_u64() > Some(20_000), "{said}");
    assert!(said.contains("both fly the recorded plan"), "{said}");

    let (exit, said) = ended(at, &["replay", file, "--config", "idle.toml"]);
    assert_eq!(exit, Some(8), "{said}");
    assert!(said.contains("nothing was compared"), "{said}");
}

/// The throttle is closed for the deceleration to the approach's airspeed, and opened again:
/// with a lever that gives a share of the power that is another thrust than with one whose
/// square does. The sensor was doubted in 20 of 20 flights.
#[test]
fn a_sound_airspeed_is_not_doubted_on_a_calm_approach() {
    for seed in ["1", "2", "3"] {
        let (exit, said) = flown(STRAIGHT_IN, "", &["--seed", seed]);
        assert_eq!(exit, Some(0), "{said}");
        assert!(!said.contains("is excluded"), "seed {seed}: {said}");
    }
}

/// In calm air raw sensors show little but their noise.
#[test]
fn outputs_without_a_delay_are_not_late_in_calm_air() {
    let raw = "raw_sensors = \"board\"\n[navigation]\nmethod = \"kalman\"\n";
    let from_home = STRAIGHT_IN
        .replace("45.03", "45.05")
        .replace("45.08", "45.12");
    let (exit, said) = flown(&from_home.replace("150", "250"), raw, &["--seed", "4"]);
    assert_eq!(exit, Some(0), "{said}");
    assert!(!said.contains("take effect too late"), "{said}");
}

/// In degrees, and before the flight.
#[test]
fn plans_near_a_pole_are_refused() {
    for (latitude_deg, words) in [
        (89.9, "is too near to a pole: fly between -85° and 85°"),
        (81.0, "can between -80° and 80° only"),
    ] {
        let (exit, said) = flown(&legs(latitude_deg, 500.0), "", &[]);
        assert_eq!((exit, said.contains(words)), (Some(2), true), "{said}");
    }
}

#[test]
fn what_nothing_measures_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let checked = |simulator: &str, limits: &str| {
        let text = format!("{simulator}\n[contingency]\n{limits}");
        fs::write(folder.path().join("c.toml"), text).unwrap();
        let (exit, said) = ended(folder.path(), &["check", "c.toml"]);
        assert_eq!(exit, Some(0), "{said}");
        said
    };
    let voltage = "battery_voltage_v = 11.0\nengine_out_below_rpm = 500.0\n";
    let of_rows = checked("[x-plane]\ninput = \"data\"\nlocal_port = 49005\n", voltage);
    for words in [
        "contingency.battery_voltage_v is 11, and no sensor here measures the voltage",
        "contingency.engine_out_below_rpm is 500, and no sensor here measures the speed",
    ] {
        assert!(of_rows.contains(words), "{of_rows}");
    }
    let charge = "battery_charge_percent = 25.0\n";
    let of_datarefs = checked("[x-plane]", &format!("{voltage}{charge}"));
    let words = "contingency.battery_charge_percent is 25, and no sensor here measures the charge";
    assert!(of_datarefs.contains(words), "{of_datarefs}");
    assert_eq!(
        of_datarefs.matches("no sensor here").count(),
        1,
        "{of_datarefs}"
    );
    let of_built_in = checked("[built-in]", &format!("{voltage}{charge}"));
    assert!(!of_built_in.contains("no sensor here"), "{of_built_in}");
    let limits = format!("[contingency]\n{voltage}{charge}");
    let (_, said) = flown(STRAIGHT_IN, &limits, &["--seconds", "1"]);
    assert!(!said.contains("no sensor here"), "{said}");
}

#[test]
fn a_stick_that_takes_over_needs_a_sensor_that_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    for (keys, is_read) in [("", true), ("roll_channel = 0\n", false)] {
        let text = format!(
            "[built-in]\n[engage]\nstick_takeover = 0.3\n[[sensor]]\nkind = \"rc-receiver\"\n\
             path = \"/dev/ttyS1\"\n{keys}"
        );
        fs::write(folder.path().join("c.toml"), text).unwrap();
        let (exit, said) = ended(folder.path(), &["check", "c.toml"]);
        assert_eq!(
            (exit, said.contains("without effect")),
            (Some(0), !is_read),
            "{said}"
        );
    }
}

/// 19,120 m are 62,730 ft; from 45° north, 8° east to 8° north, 45° east it is far.
#[test]
fn what_is_seldom_meant_is_remarked_on() {
    let folder = tempfile::tempdir().unwrap();
    let checked = |plan: &str| {
        fs::write(folder.path().join("a.waypoints"), plan).unwrap();
        let words = ["plan", "check", "a.waypoints", "--json"];
        let (exit, said) = ended(folder.path(), &words);
        assert_eq!(exit, Some(0), "{said}");
        let printed: serde_json::Value = serde_json::from_str(&said).unwrap();
        let remarks = printed["remarks"].as_array().unwrap().clone();
        let texts = remarks
            .iter()
            .map(|remark| remark.as_str().unwrap().to_owned());
        texts.collect::<Vec<_>>()
    };
    let low = "item 1: altitude: 0 m above the elevation of home, 120 m, is lower than \
               terrain.margin_m, 60 m";
    let on_the_ground = checked(&legs(45.0, 0.0));
    assert!(on_the_ground[0].starts_with(low), "{on_the_ground:?}");
    let high = checked(&legs(45.0, 19_000.0));
    let words = "item 1: altitude: 19120 m above mean sea level (62730 ft) is above";
    assert!(high[0].starts_with(words), "{high:?}");
    let line = "3 0 3 16 0 0 0 0 8 45.05 300 1\n";
    let far = checked(&(legs(45.0, 300.0) + line));
    assert!(
        far[0].contains("are latitude and longitude exchanged"),
        "{far:?}"
    );
    assert!(checked(CIRCUIT).is_empty());
    // And in flight.
    let (_, said) = flown(&legs(45.0, 0.0), "", &["--seconds", "1"]);
    assert!(said.contains(low), "{said}");
}

#[test]
fn the_plan_of_a_configuration_is_checked_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[built-in]\n[guidance]\nmode = \"plan\"\n[plan]\nfile = \"a.waypoints\"\n";
    fs::write(folder.path().join("c.toml"), text).unwrap();
    for (plan, exit, words) in [
        (None, 2, "c.toml: plan.file: a.waypoints: cannot be read: "),
        (
            None,
            2,
            "a relative path begins in the folder where the program is started",
        ),
        (
            Some(legs(45.0, -200.0)),
            2,
            "plan.file: a.waypoints: item 1: altitude: -80 m",
        ),
        (
            Some(legs(45.0, 0.0)),
            0,
            "c.toml: remark: plan.file: a.waypoints: item 1: altitude: 0 m above the elevation",
        ),
        (Some(legs(45.0, 300.0)), 0, "c.toml: valid: "),
    ] {
        if let Some(plan) = plan {
            fs::write(folder.path().join("a.waypoints"), plan).unwrap();
        }
        let (code, said) = ended(folder.path(), &["check", "c.toml"]);
        assert_eq!((code, said.contains(words)), (Some(exit), true), "{said}");
    }
}

#[test]
fn a_plan_in_the_place_of_a_configuration_is_said_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.waypoints"), legs(45.0, 300.0)).unwrap();
    ended(folder.path(), &["plan", "convert", "a.waypoints", "a.plan"]);
    for plan in ["a.waypoints", "a.plan"] {
        let (code, said) = ended(folder.path(), &["check", plan]);
        let words = "this is a flight plan: give it as [plan] file, or with --plan";
        assert_eq!((code, said.trim()), (Some(2), &*format!("{plan}: {words}")));
    }
}

/// As of a configuration (`fccd --help`).
#[test]
fn a_plan_that_cannot_be_read_has_the_exit_code_of_a_wrong_one() {
    let folder = tempfile::tempdir().unwrap();
    for command in [
        &["check", "none.toml"][..],
        &["plan", "check", "none.plan"],
        &["plan", "show", "none.plan"],
        &["plan", "convert", "none.plan", "a.waypoints"],
        &["fly", "--plan", "none.plan"],
    ] {
        let (exit, said) = ended(folder.path(), command);
        assert_eq!(exit, Some(2), "{said}");
        assert!(said.contains("cannot be read: No such file"), "{said}");
    }
}

/// Two circles of 3 km, 2 km apart: what both have in common is permitted, and the rest of the
/// page is grey.
#[test]
fn a_fence_of_several_zones_is_shown_zone_by_zone_and_checked_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let fence = "3 0 0 5003 3000 0 0 0 45.01 8 0 1\n4 0 0 5003 3000 0 0 0 45.028 8 0 1\n";
    fs::write(folder.path().join("a.txt"), legs(45.0, 300.0) + fence).unwrap();
    let (exit, said) = ended(folder.path(), &["plan", "check", "a.txt"]);
    assert_eq!(exit, Some(2), "{said}");
    assert!(
        said.contains("item 1: fence: 0 m along the leg it is outside of the fence (inside one"),
        "{said}"
    );
    let (exit, said) = ended(
        folder.path(),
        &["plan", "show", "a.txt", "--html", "a.html"],
    );
    assert_eq!(exit, Some(0), "{said}");
    let row = said
        .lines()
        .find(|line| line.trim_start().starts_with("home"));
    let cells: Vec<_> = row.unwrap_or_default().split_whitespace().collect();
    let home = ["home", "45.00000,", "8.00000", "120.0", "m", "sea"];
    assert_eq!(cells, home, "{said}");
    let zone = "fence: circle of 3000 m around 45.01000, 8.00000: stay inside";
    assert!(said.contains(zone), "{said}");
    let page = fs::read_to_string(folder.path().join("a.html")).unwrap();
    // A row of squares of 4 px on each side of what is permitted.
    assert!(page.matches("<rect").count() > 100);
}
