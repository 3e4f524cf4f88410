//! Drafts: no edit is lost, and none replaces another one unseen.

use std::collections::BTreeMap;

use fcc_plan::{
    Altitude, AltitudeDatum, Circle, Fence, Home, Item, Loiter, LoiterEnd, Obstacle, Place, Plan,
    Polygon, RallyPoint, Speed,
};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::common::Ground;

fn plan(latitude_deg: f64) -> Value {
    json!({ "items": [{ "kind": "waypoint",
        "place": { "latitude_deg": latitude_deg, "longitude_deg": 8.0 },
        "altitude": { "m": 900.0, "above": "sea-level" } }] })
}

#[test]
fn an_edit_of_an_older_revision_is_refused_with_the_newest() {
    let ground = Ground::new();
    let save = |based_on: Value, latitude_deg: f64| {
        let body = json!({ "based_on": based_on, "plan": plan(latitude_deg) });
        ground.change("PUT /api/drafts/survey%201", &body)
    };
    let first = save(Value::Null, 47.0);
    assert_eq!(first.status, 200, "{}", first.text());
    let first = first.json()["revision"].clone();
    let second = save(first.clone(), 47.1).json();
    // Another page has not seen the second.
    let refused = save(first.clone(), 47.2);
    assert_eq!(refused.status, 409);
    let newest = refused.json();
    assert_eq!(newest["revision"], second["revision"]);
    assert_eq!(newest["plan"]["items"][0]["place"]["latitude_deg"], 47.1);
    assert_eq!(save(Value::Null, 47.2).status, 409, "as if it were new");
    let kept = ground.get("/api/drafts/survey%201").json();
    assert_eq!(kept["plan"]["items"][0]["place"]["latitude_deg"], 47.1);
    assert_eq!(kept["hash"], second["hash"]);
    // Removed and made again: an edit of the removed one is not taken for one of the new one.
    assert_eq!(
        ground
            .change("DELETE /api/drafts/survey%201", &Value::Null)
            .status,
        204
    );
    assert_eq!(ground.get("/api/drafts/survey%201").status, 404);
    let again = save(Value::Null, 48.0).json();
    assert!(again["revision"].as_u64() > second["revision"].as_u64());
    assert_eq!(save(second["revision"].clone(), 47.3).status, 409);
}

#[test]
fn what_was_answered_is_there_after_a_restart() {
    let ground = Ground::new();
    for n in 0..20 {
        let name = format!("PUT /api/drafts/d{}", n % 3);
        let newest = ground.get(&format!("/api/drafts/d{}", n % 3));
        let based_on = if newest.status == 200 {
            newest.json()["revision"].clone()
        } else {
            Value::Null
        };
        let answer = ground.change(
            &name,
            &json!({ "based_on": based_on, "plan": plan(f64::from(n)) }),
        );
        assert_eq!(answer.status, 200);
    }
    // What an edit that was cut off has left.
    ground.write("state/drafts/d1.json.new", b"{\"name\"");
    let token = ground.running.token.as_str().to_owned();
    let again = Ground::again(ground);
    assert_eq!(again.running.token.as_str(), token);
    let list = again.get("/api/drafts").json();
    let names: Vec<&str> = list
        .as_array()
        .unwrap()
        .iter()
        .map(|draft| draft["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["d0", "d1", "d2"]);
    for (name, last) in [("d0", 18.0), ("d1", 19.0), ("d2", 17.0)] {
        let draft = again.get(&format!("/api/drafts/{name}")).json();
        assert_eq!(draft["plan"]["items"][0]["place"]["latitude_deg"], last);
    }
}

/// Pages that edit, edit what they have not seen, remove and read, and a station that is
/// ended between any two of these.
#[test]
fn in_any_order_no_edit_is_lost_and_none_is_replaced_unseen() {
    let mut random = 2026_u64;
    let mut draw = |below: u64| {
        // Knuth's MMIX generator.
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let mut ground = Ground::new();
    // What was answered: the newest revision and its latitude; and revisions that were.
    let mut newest: BTreeMap<String, (Value, f64)> = BTreeMap::new();
    let mut older: Vec<(String, Value)> = Vec::new();
    let mut refused = 0;
    for step in 0..1_000 {
        let name = format!("d{}", draw(4));
        let path = format!("/api/drafts/{name}");
        let latitude_deg = f64::from(step) * 0.01;
        match draw(100) {
            0..=59 => {
                let based_on = newest
                    .get(&name)
                    .map_or(Value::Null, |(revision, _)| revision.clone());
                let body = json!({ "based_on": based_on, "plan": plan(latitude_deg) });
                let saved = ground.change(&format!("PUT {path}"), &body);
                assert_eq!(saved.status, 200, "{step}: {}", saved.text());
                older.push((name.clone(), based_on));
                newest.insert(name, (saved.json()["revision"].clone(), latitude_deg));
            }
            60..=79 if !older.is_empty() => {
                let (name, based_on) = older[draw(older.len() as u64) as usize].clone();
                let is_new = based_on.is_null() && !newest.contains_key(&name);
                let body = json!({ "based_on": based_on, "plan": plan(-1.0) });
                let status = if is_new || !newest.contains_key(&name) {
                    continue;
                } else {
                    ground
                        .change(&format!("PUT /api/drafts/{name}"), &body)
                        .status
                };
                assert_eq!(status, 409, "{step}: {name} from {based_on}");
                refused += 1;
            }
            80..=84 => {
                let expected = if newest.remove(&name).is_some() {
                    204
                } else {
                    404
                };
                let removed = ground.change(&format!("DELETE {path}"), &Value::Null);
                assert_eq!(removed.status, expected, "{step}");
            }
            85..=86 => ground = Ground::again(ground),
            _ => {
                let found = ground.get(&path);
                let Some((revision, latitude_deg)) = newest.get(&name) else {
                    assert_eq!(found.status, 404, "{step}");
                    continue;
                };
                let found = found.json();
                assert_eq!(&found["revision"], revision, "{step}");
                let place = &found["plan"]["items"][0]["place"];
                assert_eq!(&place["latitude_deg"], latitude_deg, "{step}");
            }
        }
    }
    assert!(refused > 50);
    for (name, (revision, latitude_deg)) in &newest {
        let found = ground.get(&format!("/api/drafts/{name}")).json();
        assert_eq!(&found["revision"], revision);
        assert_eq!(
            &found["plan"]["items"][0]["place"]["latitude_deg"],
            latitude_deg
        );
    }
}

#[test]
fn a_file_is_imported_checked_and_exported_again() {
    let ground = Ground::new();
    let text = include_str!("../../../../config/plans/circuit.waypoints");
    let json_kind = ["Content-Type: application/json"];
    let send = |path: &str, body: Value| {
        ground.send(&format!("POST {path}"), &json_kind, &body.to_string())
    };
    let imported = send(
        "/api/plan/import",
        json!({ "text": text, "name": "circuit.waypoints" }),
    );
    assert_eq!(imported.status, 200, "{}", imported.text());
    let plan = imported.json()["plan"].clone();
    assert_eq!(plan["items"].as_array().unwrap().len(), 9);
    let checked = send("/api/plan/check", json!({ "plan": plan, "instance": null })).json();
    assert_eq!(checked["problems"], json!([]), "{checked}");
    let hash = fcc_plan::read(text).unwrap().hash().to_string();
    assert_eq!(checked["hash"], hash[..16]);
    for format in ["plan", "waypoints"] {
        let exported = send(
            "/api/plan/export",
            json!({ "plan": plan, "format": format }),
        );
        let again = fcc_plan::read(&exported.text()).unwrap();
        assert_eq!(again.hash().to_string(), hash, "{format}");
    }
    let wrong = text.replace("\n3\t0\t3\t16", "\n3\t0\t3\t82");
    let refused = send(
        "/api/plan/import",
        json!({ "text": wrong, "name": "wrong" }),
    );
    assert_eq!(refused.status, 400);
    assert_eq!(refused.json()["problems"][0]["item"], 3);
    // A leg that climbs too fast for the aircraft: at its item.
    let mut steep = plan;
    steep["items"][3]["altitude"]["m"] = json!(9_000.0);
    let checked = send(
        "/api/plan/check",
        json!({ "plan": steep, "instance": null }),
    )
    .json();
    let problem = &checked["problems"][0];
    assert_eq!(
        (&problem["item"], &problem["level"]),
        (&json!(4), &json!("error")),
        "{checked}"
    );
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1e6..1e6_f64,
        any::<f64>().prop_filter("finite", |x| x.is_finite())
    ]
}

fn place() -> impl Strategy<Value = Place> {
    (number(), number()).prop_map(|(latitude_deg, longitude_deg)| Place {
        latitude_deg,
        longitude_deg,
    })
}

fn altitude() -> impl Strategy<Value = Altitude> {
    let above = prop_oneof![
        Just(AltitudeDatum::SeaLevel),
        Just(AltitudeDatum::Home),
        Just(AltitudeDatum::Terrain)
    ];
    (number(), above).prop_map(|(m, above)| Altitude { m, above })
}

fn maybe<T: std::fmt::Debug + Clone>(
    of: impl Strategy<Value = T>,
) -> impl Strategy<Value = Option<T>> {
    proptest::option::of(of)
}

fn item() -> impl Strategy<Value = Item> {
    let end = prop_oneof![
        Just(LoiterEnd::Never),
        Just(LoiterEnd::Altitude),
        number().prop_map(LoiterEnd::Turns),
        number().prop_map(LoiterEnd::Seconds)
    ];
    let loiter = (
        maybe(place()),
        altitude(),
        maybe(number()),
        any::<bool>(),
        end,
        any::<bool>(),
    );
    let speed = prop_oneof![
        number().prop_map(Speed::AirspeedMps),
        number().prop_map(Speed::GroundSpeedMps)
    ];
    prop_oneof![
        (place(), altitude(), maybe(number())).prop_map(|(place, altitude, radius_m)| {
            Item::Waypoint {
                place,
                altitude,
                radius_m,
            }
        }),
        loiter.prop_map(
            |(place, altitude, radius_m, clockwise, end, leave_towards_next)| {
                Item::Loiter(Loiter {
                    place,
                    altitude,
                    radius_m,
                    clockwise,
                    end,
                    leave_towards_next,
                })
            }
        ),
        Just(Item::Return),
        (maybe(place()), altitude(), maybe(number())).prop_map(
            |(place, altitude, abort_altitude_m)| Item::Land {
                place,
                altitude,
                abort_altitude_m
            }
        ),
        (maybe(place()), altitude(), maybe(number())).prop_map(|(place, altitude, pitch_deg)| {
            Item::Takeoff {
                place,
                altitude,
                pitch_deg,
            }
        }),
        number().prop_map(|seconds| Item::Delay { seconds }),
        number().prop_map(|distance_m| Item::UntilDistance { distance_m }),
        altitude().prop_map(|altitude| Item::ChangeAltitude { altitude }),
        (maybe(speed), maybe(number())).prop_map(|(speed, throttle_percent)| Item::ChangeSpeed {
            speed,
            throttle_percent
        }),
        (any::<u16>(), maybe(any::<u32>())).prop_map(|(to, times)| Item::Jump {
            to: to.into(),
            times
        }),
        maybe(place()).prop_map(|place| Item::LandStart { place }),
        (
            any::<u16>(),
            any::<u8>(),
            proptest::array::uniform7(maybe(number()))
        )
            .prop_map(|(command, frame, parameters)| Item::Camera {
                command,
                frame,
                parameters
            }),
    ]
}

fn fence() -> impl Strategy<Value = Fence> {
    let polygon = (
        prop::collection::vec(place(), 0..5),
        any::<bool>(),
        any::<u16>(),
    )
        .prop_map(|(corners, inclusion, group)| Polygon {
            corners,
            inclusion,
            group,
        });
    let circle = (place(), number(), any::<bool>(), any::<u16>()).prop_map(
        |(centre, radius_m, inclusion, group)| Circle {
            centre,
            radius_m,
            inclusion,
            group,
        },
    );
    let lists = (
        prop::collection::vec(polygon, 0..3),
        prop::collection::vec(circle, 0..3),
    );
    (
        lists,
        maybe(number()),
        maybe(number()),
        maybe((place(), number())),
    )
        .prop_map(
            |((polygons, circles), floor_m, ceiling_m, return_point)| Fence {
                polygons,
                circles,
                floor_m,
                ceiling_m,
                return_point,
            },
        )
}

fn any_plan() -> impl Strategy<Value = Plan> {
    let home = (place(), number()).prop_map(|(place, altitude_m)| Home { place, altitude_m });
    let rally =
        (place(), number()).prop_map(|(place, altitude_m)| RallyPoint { place, altitude_m });
    let obstacle = (place(), number(), number()).prop_map(|(centre, radius_m, top_m)| Obstacle {
        centre,
        radius_m,
        top_m,
    });
    let lists = (
        prop::collection::vec(item(), 0..12),
        prop::collection::vec(rally, 0..3),
        prop::collection::vec(obstacle, 0..3),
    );
    (maybe(home), maybe(number()), lists, fence()).prop_map(
        |(home, cruise_mps, (items, rally, obstacles), fence)| Plan {
            home,
            cruise_mps,
            items,
            fence,
            rally,
            obstacles,
        },
    )
}

proptest! {
    /// Each number of each kind of item, to the last bit.
    #[test]
    fn a_plan_is_the_same_after_json(plan in any_plan()) {
        let text = serde_json::to_string(&plan).unwrap();
        let read: Plan = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(&read, &plan);
        prop_assert_eq!(read.hash(), plan.hash());
        prop_assert_eq!(serde_json::to_string(&read).unwrap(), text);
    }
}
