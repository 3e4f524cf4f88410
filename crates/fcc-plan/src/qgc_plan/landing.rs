//! QGroundControl's landing pattern of a fixed wing, as the items that it sends
//! to a vehicle: start of the landing sequence, approach, landing.

use super::node::Node;
use crate::command::{RADIUS_M, Refusal};
use crate::item::{Altitude, AltitudeDatum, Item, Loiter, LoiterEnd, Place};

pub(super) fn landing_pattern(node: &Node<'_>) -> Result<[Item; 3], Refusal> {
    let above = if node.key("altitudesAreRelative")?.boolean()? {
        AltitudeDatum::Home
    } else {
        AltitudeDatum::SeaLevel
    };
    let at = |key: &str| -> Result<(Place, Altitude), Refusal> {
        let (place, m) = node.key(key)?.position()?;
        Ok((place, Altitude { m, above }))
    };
    let (approach, approach_altitude) = at("landingApproachCoordinate")?;
    let (place, altitude) = at("landCoordinate")?;
    let loiters = match node.optional("useLoiterToAlt")? {
        Some(choice) => choice.boolean()?,
        None => true,
    };
    let approach_item = if loiters {
        Item::Loiter(Loiter {
            place: Some(approach),
            altitude: approach_altitude,
            radius_m: Some(node.key("loiterRadius")?.number(&RADIUS_M)?)
                .filter(|radius_m| *radius_m > 0.0),
            clockwise: node.key("loiterClockwise")?.boolean()?,
            end: LoiterEnd::Altitude,
            leave_towards_next: true,
        })
    } else {
        Item::Waypoint {
            place: approach,
            altitude: approach_altitude,
            radius_m: None,
        }
    };
    let land = Item::Land {
        place: Some(place),
        altitude,
        abort_altitude_m: None,
    };
    Ok([Item::LandStart { place: None }, approach_item, land])
}
