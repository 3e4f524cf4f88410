//! QGroundControl's landing pattern of a fixed wing, as the items that it sends
//! to a vehicle: start of the landing sequence, approach, landing.

use super::node::Node;
use crate::command::{RADIUS_M, Refusal};
use crate::item::{Altitude, AltitudeDatum, Item, Loiter, LoiterEnd, Place};

pub(super) fn landing_pattern(node: &Node<'_>) -> Result<[Item; 3], Refusal> {
    let version = node.optional("version")?;
    let is_first = match &version {
        None => false,
        Some(version) => match version.whole(u16::MAX)? {
            number @ 1..=2 => number == 1,
            other => return version.refuse(format!("{other}: give 1 or 2")),
        },
    };
    // Version 1 says it of each place.
    let [approach_key, land_key] = if is_first {
        ["loiterAltitudeRelative", "landAltitudeRelative"]
    } else {
        ["altitudesAreRelative"; 2]
    };
    let at = |place: Node<'_>, is_relative: &str| -> Result<(Place, Altitude), Refusal> {
        let above = if node.key(is_relative)?.boolean()? {
            AltitudeDatum::Home
        } else {
            AltitudeDatum::SeaLevel
        };
        let (place, m) = place.position()?;
        Ok((place, Altitude { m, above }))
    };
    // Renamed in QGroundControl 4.1.
    let approach = match node.optional("landingApproachCoordinate")? {
        None if node.optional("loiterCoordinate")?.is_some() => node.key("loiterCoordinate")?,
        _ => node.key("landingApproachCoordinate")?,
    };
    let (approach, approach_altitude) = at(approach, approach_key)?;
    let (place, altitude) = at(node.key("landCoordinate")?, land_key)?;
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
