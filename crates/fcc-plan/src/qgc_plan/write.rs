//! Writes a `.plan`.

use serde_json::{Value, json};

use crate::command::{Command, encode};
use crate::item::{Item, Place};
use crate::plan::{Home, Plan};

/// `MAV_AUTOPILOT_GENERIC` and `MAV_TYPE_FIXED_WING`.
const GENERIC_AUTOPILOT: u8 = 0;
const FIXED_WING: u8 = 1;

/// The plan as JSON text.
pub(crate) fn write(plan: &Plan) -> String {
    let items = plan.items.iter().enumerate();
    let mission = json!({
        "version": 2,
        "firmwareType": GENERIC_AUTOPILOT,
        "vehicleType": FIXED_WING,
        // QGroundControl wants the key, for a vehicle that cannot hover, too.
        "hoverSpeed": 5,
        "globalPlanAltitudeMode": 0,
        "items": items.map(|(n, item)| simple_item(n + 1, item)).collect::<Value>(),
    });
    // It wants this one, too: zeros where it is not set.
    let home = plan.home;
    let home = home.map(|Home { place, altitude_m }| position(place, altitude_m));
    let home = home.unwrap_or_else(|| json!([0, 0, 0]));
    let mission = with(mission, "plannedHomePosition", Some(home));
    let mission = with(
        mission,
        "cruiseSpeed",
        plan.cruise_mps.map(|mps| json!(mps)),
    );
    let root = json!({
        "fileType": "Plan",
        "version": 1,
        "groundStation": "fccd",
        "mission": mission,
        "geoFence": fence(plan),
        "rallyPoints": {
            "version": 2,
            "points": plan.rally.iter()
                .map(|point| position(point.place, point.altitude_m))
                .collect::<Value>(),
        },
    });
    let root = with(root, "fccd", own(plan));
    format!("{root:#}\n")
}

/// An object with one more key, if there is a value for it.
fn with(mut object: Value, key: &str, value: Option<Value>) -> Value {
    if let (Some(object), Some(value)) = (object.as_object_mut(), value) {
        object.insert(key.to_owned(), value);
    }
    object
}

fn simple_item(number: usize, item: &Item) -> Value {
    let Command {
        id,
        frame,
        parameters,
    } = encode(item);
    json!({
        "type": "SimpleItem",
        "autoContinue": true,
        "doJumpId": number,
        "command": id,
        "frame": frame,
        "params": parameters,
    })
}

fn fence(plan: &Plan) -> Value {
    let fence = &plan.fence;
    let polygons = fence.polygons.iter().map(|polygon| {
        let corners: Value = polygon.corners.iter().map(|c| coordinate(*c)).collect();
        let zone = json!({ "version": 1, "inclusion": polygon.inclusion, "polygon": corners });
        with(zone, "inclusionGroup", group(polygon.group))
    });
    let circles = fence.circles.iter().map(|circle| {
        let zone = json!({
            "version": 1,
            "inclusion": circle.inclusion,
            "circle": { "center": coordinate(circle.centre), "radius": circle.radius_m },
        });
        with(zone, "inclusionGroup", group(circle.group))
    });
    let value = json!({
        "version": 2,
        "polygons": polygons.collect::<Value>(),
        "circles": circles.collect::<Value>(),
    });
    let back = fence.return_point;
    let back = back.map(|(place, altitude_m)| position(place, altitude_m));
    with(value, "breachReturn", back)
}

/// A group other than the one that all zones have without the key.
fn group(group: u16) -> Option<Value> {
    (group != 0).then(|| json!(group))
}

/// What the format has no place for.
fn own(plan: &Plan) -> Option<Value> {
    let (floor, ceiling) = (plan.fence.floor_m, plan.fence.ceiling_m);
    if floor.is_none() && ceiling.is_none() && plan.obstacles.is_empty() {
        return None;
    }
    let obstacles = plan.obstacles.iter().map(|obstacle| {
        json!({
            "center": coordinate(obstacle.centre),
            "radius": obstacle.radius_m,
            "top": obstacle.top_m,
        })
    });
    Some(json!({
        "version": 1,
        "floor": floor,
        "ceiling": ceiling,
        "obstacles": obstacles.collect::<Value>(),
    }))
}

fn coordinate(place: Place) -> Value {
    json!([place.latitude_deg, place.longitude_deg])
}

fn position(place: Place, altitude_m: f64) -> Value {
    json!([place.latitude_deg, place.longitude_deg, altitude_m])
}
