//! What a take-off and a landing need.

use crate::conditions::Conditions;
use crate::flyable::direction_problem;
use crate::item::Item;
use crate::leg::{Leg, above_sea_level};
use crate::plan::Plan;

/// What flies above a runway is so high at least, m.
const LEAST_M: f64 = 30.0;

/// Whether a landing's leg leaves time for the glide path after the turn onto it.
pub(crate) fn last_leg(
    plan: &Plan,
    leg: &Leg,
    begins_m: f64,
    conditions: &Conditions,
) -> Option<(&'static str, String)> {
    if !matches!(plan.item(leg.item), Some(Item::Land { .. })) {
        return None;
    }
    let above_m = leg.from.1 - leg.to.1;
    // A plan that only lands begins where the aircraft is.
    if above_m != 0.0 && above_m < LEAST_M {
        let side = if above_m < 0.0 { "below" } else { "above" };
        let message = format!(
            "the leg to the landing begins {:.0} m {side} the runway: begin it at least \
             {LEAST_M:.0} m above",
            above_m.abs()
        );
        return Some(("approach", message));
    }
    let straight_m = leg.length_m - begins_m;
    (straight_m < conditions.final_m).then(|| {
        let message = format!(
            "the leg to the landing is straight for {:.0} m behind its turn, and needs {:.0} m: \
             move the waypoint before it away",
            straight_m.max(0.0),
            conditions.final_m
        );
        ("approach", message)
    })
}

/// The problem of an item to fly to behind this one, at which the flight ends.
fn flown_behind(plan: &Plan, number: usize, what: &str) -> Option<(&'static str, String)> {
    let behind = plan.items.get(number..)?;
    let flown = behind.iter().position(|item| item.place().is_some())?;
    let item = number + 1 + flown;
    Some((
        "command",
        format!("item {item} is behind {what}: remove it"),
    ))
}

/// What is behind a landing or a return is not flown, a take-off climbs before it turns, and a runway
/// has a direction.
pub(crate) fn runway_problem(
    plan: &Plan,
    number: usize,
    item: &Item,
) -> Option<(&'static str, String)> {
    let before = plan.items.get(..number - 1).unwrap_or_default();
    let from = match item {
        Item::Takeoff { .. } => plan.home.map(|home| home.place),
        _ => before.iter().rev().find_map(Item::place),
    };
    let direction = from.zip(item.place());
    if let Some(message) = direction.and_then(|(from, to)| direction_problem(from, to, item)) {
        return Some(("place", message));
    }
    match item {
        Item::Takeoff { altitude, .. } => {
            let (home_m, altitude_m) = (plan.home?.altitude_m, above_sea_level(*altitude, plan));
            (altitude_m.ok()? < home_m + LEAST_M).then(|| {
                let message = format!("give at least {LEAST_M:.0} m above home: it turns there");
                ("altitude", message)
            })
        }
        Item::Land { .. } => {
            let is_takeoff = |item: &Item| matches!(item, Item::Takeoff { .. });
            if item.place().is_none() && !before.iter().any(is_takeoff) {
                let message = "without a place it lands where it took off, and no take-off is \
                               before it: give a place";
                return Some(("place", message.to_owned()));
            }
            flown_behind(plan, number, "a landing, where the flight ends")
        }
        Item::Return => flown_behind(plan, number, "a return, which ends over home"),
        _ => None,
    }
}
