//! The legs of a plan, and what is wrong with single items.

use fcc_guidance::path::turn::smallest_circle_m;

use crate::conditions::Conditions;
use crate::flyable::speed_problem;
use crate::item::{Item, Loiter, Speed};
use crate::leg::{Leg, above_sea_level};
use crate::plan::Plan;
use crate::problem::Problem;
use crate::runway::runway_problem;

/// The legs of a plan; what is wrong with single items is noted.
pub(crate) fn legs(plan: &Plan, conditions: &Conditions, problems: &mut Vec<Problem>) -> Vec<Leg> {
    let mut legs: Vec<Leg> = Vec::new();
    let home = plan.home;
    let takes_off = plan
        .items
        .iter()
        .any(|item| matches!(item, Item::Takeoff { .. }));
    // Without a take-off it begins in the air, at the altitude of its first item.
    let first_m = plan.items.iter().find_map(Item::altitude);
    let first_m = first_m.and_then(|altitude| above_sea_level(altitude, plan).ok());
    let mut at = home.map(|home| {
        let begins_m = first_m.filter(|_| !takes_off).unwrap_or(home.altitude_m);
        (home.place, begins_m)
    });
    let mut airspeed_mps = plan.cruise_mps.unwrap_or(conditions.airspeed_mps);
    let mut ground_mps = None;
    for (n, item) in plan.items.iter().enumerate() {
        let number = n + 1;
        let mut note = |field: &str, message: String| {
            problems.push(Problem::of_item(number, field, message));
        };
        if let Some((field, message)) = item_problem(plan, number, item, airspeed_mps, conditions) {
            note(field, message);
        }
        match *item {
            Item::ChangeSpeed {
                speed: Some(Speed::AirspeedMps(mps)),
                ..
            } => (airspeed_mps, ground_mps) = (mps, None),
            Item::ChangeSpeed {
                speed: Some(Speed::GroundSpeedMps(mps)),
                ..
            } => ground_mps = Some(mps),
            // From here no leg leads to what is behind it: a command does.
            Item::Jump { times: None, .. } => {
                at = None;
                if let Some(last) = legs.last_mut() {
                    last.turns = false;
                }
            }
            _ => {}
        }
        if conditions.wind_mps >= airspeed_mps {
            let message = format!(
                "{airspeed_mps:.1} m/s is not more than the wind, {:.1} m/s: give a higher one",
                conditions.wind_mps
            );
            note("airspeed", message);
        }
        let altitude_m = match item
            .altitude()
            .map(|altitude| above_sea_level(altitude, plan))
        {
            Some(Err(message)) => {
                note("altitude", message.to_owned());
                None
            }
            Some(Ok(m)) => Some(m),
            None => at.map(|(_, m)| m),
        };
        let place = match item {
            Item::Return => home.map(|home| home.place),
            Item::LandStart { .. } => None,
            item => item.place(),
        };
        let (Some(place), Some(altitude_m)) = (place, altitude_m) else {
            continue;
        };
        if let Some(from) = at {
            let (length_m, course_deg, arrival_deg) = from.0.to(place);
            if length_m > 0.1 {
                let turns = matches!(item, Item::Waypoint { .. });
                let within_m = match item {
                    Item::Waypoint { radius_m, .. } => radius_m.unwrap_or(f64::INFINITY),
                    _ => f64::INFINITY,
                };
                legs.push(Leg {
                    from,
                    to: (place, altitude_m),
                    length_m,
                    course_deg,
                    arrival_deg,
                    item: number,
                    turns,
                    within_m,
                    airspeed_mps,
                    ground_mps,
                });
            }
        }
        at = Some((place, altitude_m));
    }
    legs
}

/// What is wrong with an item that is flown at this airspeed, whatever leg leads to it.
fn item_problem(
    plan: &Plan,
    number: usize,
    item: &Item,
    airspeed_mps: f64,
    conditions: &Conditions,
) -> Option<(&'static str, String)> {
    match *item {
        Item::ChangeSpeed {
            speed: Some(speed), ..
        } => Some(("speed", speed_problem(speed, conditions)?)),
        Item::Jump { to, .. } => Some(("jump", jump_problem(plan, number, to)?)),
        Item::Takeoff { .. } | Item::Land { .. } | Item::Return => {
            runway_problem(plan, number, item)
        }
        Item::Loiter(Loiter { radius_m, .. }) => {
            let radius_m = radius_m.unwrap_or(conditions.loiter_radius_m);
            Some((
                "radius",
                circle_problem(radius_m, airspeed_mps, conditions)?,
            ))
        }
        // After its last item the aircraft circles there.
        Item::Waypoint { .. } if number == plan.items.len() => {
            let message = circle_problem(conditions.loiter_radius_m, airspeed_mps, conditions)?;
            Some(("plan.loiter_radius_m, of the circle after it", message))
        }
        _ => None,
    }
}

fn jump_problem(plan: &Plan, number: usize, to: usize) -> Option<String> {
    if plan.item(to).is_none() {
        return Some(format!(
            "to {to}: there is no such item: give 1 to {}",
            plan.items.len()
        ));
    }
    // Back over items that take no way is a loop without time.
    let between = plan
        .items
        .get(to.saturating_sub(1)..number)
        .unwrap_or_default();
    let flies = between
        .iter()
        .any(|item| item.place().is_some() || *item == Item::Return);
    (to <= number && !flies)
        .then(|| format!("to {to}: nothing is flown between: jump to an item with a place"))
}

fn circle_problem(radius_m: f64, airspeed_mps: f64, conditions: &Conditions) -> Option<String> {
    let least_m = smallest_circle_m(airspeed_mps, conditions.wind_mps, conditions.bank_rad)?;
    (radius_m < least_m).then(|| {
        format!(
            "{radius_m:.0} m is too small at {airspeed_mps:.1} m/s in {:.1} m/s of wind with {:.0}° \
             of bank: give at least {:.0} m",
            conditions.wind_mps,
            conditions.bank_rad.to_degrees(),
            least_m.ceil()
        )
    })
}
