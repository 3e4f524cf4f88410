//! Plans that are accepted, and seldom meant.

use fcc_plan::{Level, Usual, read, unusual};

use crate::flyable::CONDITIONS;

/// From home at 47° north, 8° east and 430 m: items of command, latitude, longitude and
/// height above home. The ceiling is 13,000 ft.
fn said(items: &[(u16, f64, f64, f64)]) -> Vec<String> {
    let mut text = "QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 430 1\n".to_owned();
    for (n, (command, latitude_deg, longitude_deg, m)) in items.iter().enumerate() {
        let line = format!(
            "{} 0 3 {command} 0 0 0 0 {latitude_deg} {longitude_deg} {m} 1\n",
            n + 1
        );
        text.push_str(&line);
    }
    let plan = read(&text).unwrap();
    let usual = Usual {
        ground: Level::home(&plan).map(|home| (home, 60.0)),
        ceiling_m: 3_962.4,
    };
    let found = unusual(&plan, &CONDITIONS, &usual);
    found.iter().map(ToString::to_string).collect()
}

#[test]
fn items_on_the_ground_and_above_the_ceiling_are_remarked_on() {
    let low = said(&[
        (22, 47.02, 8.0, 40.0),
        (16, 47.1, 8.0, 0.0),
        (16, 47.2, 8.0, 59.0),
        (16, 47.3, 8.0, 60.0),
        (21, 47.4, 8.0, 0.0),
    ]);
    let words = "item 2: altitude: 0 m above the elevation of home, 430 m, is lower than \
                 terrain.margin_m, 60 m: fly higher";
    assert!(low[0].starts_with(words), "{low:?}");
    assert!(
        low[1].starts_with("item 3: altitude: 59 m above"),
        "{low:?}"
    );
    assert_eq!(low.len(), 2, "{low:?}");
    let nearly = said(&[(16, 47.2, 8.0, 59.9), (16, 47.3, 8.0, 3_962.5 - 430.0)]);
    let words = "59.9 m above the elevation of home, 430 m, is lower than terrain.margin_m, 60.0 m";
    assert!(nearly[0].contains(words), "{nearly:?}");
    let words = "(13000.3 ft) is above plan.service_ceiling_ft, 13000.0 ft";
    assert!(nearly[1].contains(words), "{nearly:?}");
    // 3,962 m are 13,000 ft.
    assert_eq!(said(&[(16, 47.1, 8.0, 3_962.0 - 430.0)]).len(), 0);
    let high = said(&[(16, 47.1, 8.0, 19_000.0)]);
    let words = "item 1: altitude: 19430 m above mean sea level (63747 ft) is above \
                 plan.service_ceiling_ft, 13000 ft: fly lower";
    assert!(high[0].starts_with(words), "{high:?}");
}

/// On a sphere of 6,371 km it is 5,699 km from 47° north, 8° east to 8° north, 47.1° east; a
/// degree of latitude at 47° is 111.2 km.
#[test]
fn a_leg_as_by_exchanged_coordinates_is_remarked_on() {
    let far = said(&[(16, 8.0, 47.1, 300.0), (16, 47.2, 8.0, 300.0)]);
    let question = "are latitude and longitude exchanged, here or in the place before? Otherwise \
                    it would be 11.1 km";
    assert!(far[0].starts_with("item 1: leg: it is "), "{far:?}");
    let km: f64 = far[0].split(' ').nth(5).unwrap().parse().unwrap();
    assert!((km - 5_699.0).abs() < 0.005 * 5_699.0, "{km}");
    assert!(far[0].ends_with(question), "{far:?}");
    assert!(far[1].starts_with("item 2: leg: it is "), "{far:?}");
    assert_eq!(far.len(), 2);
    // 7° of latitude, 778 km, and 8°, 889 km.
    assert_eq!(said(&[(16, 54.0, 8.0, 300.0)]).len(), 0);
    // Home is at 47° north, 8° east.
    let home = said(&[(16, 8.0, 47.0, 300.0)]);
    assert!(home[0].ends_with("Otherwise it would be 0 m"), "{home:?}");
    let long = said(&[(16, 55.0, 8.0, 300.0)]);
    let words = "item 1: leg: it is 890 km long, 4.8 h at 51.4 m/s: check both places";
    assert_eq!(long, [words]);
}

/// A jump forward leaves out what it passes: the plan has its end.
#[test]
fn a_jump_back_for_ever_is_remarked_on() {
    let said = |to: usize| {
        let text = format!(
            "QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 430 1\n1 0 3 16 0 0 0 0 47.1 8 300 1\n\
             2 0 2 177 {to} -1 0 0 0 0 0 1\n3 0 3 16 0 0 0 0 47.2 8 300 1\n\
             4 0 3 16 0 0 0 0 47.2 8.1 300 1\n"
        );
        let usual = Usual {
            ground: None,
            ceiling_m: 3_962.4,
        };
        let found = unusual(&read(&text).unwrap(), &CONDITIONS, &usual);
        found.iter().map(ToString::to_string).collect::<String>()
    };
    assert!(said(1).starts_with("item 2: jump: for ever: "));
    assert_eq!(said(4), "");
}

/// Ground stations write 0 for an elevation that they do not know.
#[test]
fn a_home_at_exactly_0_m_is_remarked_on_where_heights_are_above_it() {
    let said = |home_m: f64, frame: u8| {
        let text = format!(
            "QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 {home_m} 1\n1 0 {frame} 16 0 0 0 0 47.1 8 300 1\n"
        );
        let usual = Usual {
            ground: None,
            ceiling_m: 3_962.4,
        };
        let found = unusual(&read(&text).unwrap(), &CONDITIONS, &usual);
        found.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let words = "home: its elevation is exactly 0 m, and item 1 is above home: is it at the sea? \
                 Otherwise give its elevation above mean sea level";
    assert_eq!(said(0.0, 3), [words]);
    assert!(said(0.0, 0).is_empty() && said(0.5, 3).is_empty());
}
