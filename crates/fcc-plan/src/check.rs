//! Whether an aircraft can fly a plan, in any wind up to a speed.
//!
//! Items are taken in their order; a jump is checked for its target and its end, and
//! not for the leg that it makes. Turns are those between places; where a loiter
//! begins or ends there is none.

use fcc_guidance::path::turn::{Turn, smallest_circle_m};
use fcc_guidance::route::PLANNED_SHARE;

use crate::flyable::{airspeed_problem, polar_problem, polar_problems, speed_problem};
use crate::ground::obstacle_problems;
use crate::inside::{TurnAway, circles, fence_problem, heights, obstacle_problem};
use crate::item::{Altitude, AltitudeDatum, Item, Loiter, Place, Speed};
use crate::outline::Outline;
use crate::plan::{Plan, limits};
use crate::problem::Problem;
use crate::runway::{last_leg, runway_problem};

/// What flies the plan, and in what wind.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Conditions {
    /// True airspeed where the plan gives none, m/s.
    pub airspeed_mps: f64,
    /// The lowest and the highest indicated airspeed that is flown, m/s.
    pub slowest_mps: f64,
    /// See `slowest_mps`.
    pub fastest_mps: f64,
    /// The strongest wind, from any direction, m/s.
    pub wind_mps: f64,
    /// The largest bank of a turn, rad, below π/2.
    pub bank_rad: f64,
    /// The fastest climb, m/s.
    pub climb_mps: f64,
    /// The fastest descent, m/s.
    pub descent_mps: f64,
    /// The radius of a loiter whose item has none, m.
    pub loiter_radius_m: f64,
    /// A landing's last leg is straight for so long at least, m.
    pub final_m: f64,
    /// How far inside of the fence the aircraft turns away from it at least, m; none if
    /// it does not.
    pub fence_margin_m: Option<f64>,
}

/// A leg between two places, with its altitudes above sea level, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub(crate) from: (Place, f64),
    pub(crate) to: (Place, f64),
    pub(crate) length_m: f64,
    pub(crate) course_deg: f64,
    pub(crate) arrival_deg: f64,
    /// The number of the item at its end.
    pub(crate) item: usize,
    /// Whether there is a turn of the path at its end.
    pub(crate) turns: bool,
    /// How near the turn at its end passes the place, m.
    pub(crate) within_m: f64,
    pub(crate) airspeed_mps: f64,
    /// The speed over the ground that is demanded; none: what the airspeed gives.
    pub(crate) ground_mps: Option<f64>,
}

/// Checks a plan as a whole.
///
/// Altitudes above terrain are a problem: [`resolve`](crate::resolve) them before.
///
/// # Errors
/// All problems with item and reason, at most [`limits::PROBLEMS`].
pub fn check(plan: &Plan, conditions: &Conditions) -> Result<(), Vec<Problem>> {
    let mut problems = Vec::new();
    if plan.items.is_empty() {
        let what = if plan.fence.is_empty() && plan.rally.is_empty() {
            "there are none: give at least one"
        } else {
            "there are none, but a fence or rally points: put these behind the items of a plan"
        };
        problems.push(Problem::of("items", what));
    }
    if let Some(mps) = plan.cruise_mps
        && let Some(message) = airspeed_problem(mps, conditions)
    {
        problems.push(Problem::of("cruiseSpeed", message));
    }
    problems.extend(polar_problems(plan));
    let legs = legs(plan, conditions, &mut problems);
    let outline = Outline::of(plan, 0.0);
    for (n, leg) in legs.iter().enumerate() {
        let (before, next) = (n.checked_sub(1).and_then(|n| legs.get(n)), legs.get(n + 1));
        let begins_with = before.and_then(|before| turn_of(before, leg, conditions));
        let ends_with = next.and_then(|next| turn_of(leg, next, conditions));
        let begins_m = begins_with.map_or(0.0, |turn| turn.after_m());
        let ends_m = ends_with.map_or(0.0, |turn| turn.before_m());
        let turn_away = TurnAway::new(leg, conditions, begins_m, ends_m);
        let found = [
            climb(leg, conditions),
            next.zip(ends_with)
                .and_then(|(next, turn)| room(leg, next, begins_m, &turn)),
            last_leg(plan, leg, begins_m, conditions),
            outline.with(|fence| fence_problem(leg, fence, &turn_away)),
            obstacle_problem(leg, &plan.obstacles),
            polar_problem(leg),
        ];
        for (field, message) in found.into_iter().flatten() {
            problems.push(Problem::of_item(leg.item, field, message));
        }
    }
    if !plan.obstacles.is_empty() {
        problems.extend(obstacle_problems(plan, conditions));
    }
    outline.with(|fence| {
        heights(plan, fence, &legs, &mut problems);
        circles(plan, fence, conditions, &mut problems);
    });
    problems.sort_by_key(|problem| problem.item);
    problems.truncate(limits::PROBLEMS);
    if problems.is_empty() {
        Ok(())
    } else {
        Err(problems)
    }
}

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

/// The elevation of the plan's runway, m above mean sea level; none without a landing, or
/// where it is not known.
pub fn landing_elevation_m(plan: &Plan) -> Option<f64> {
    let altitude = plan.items.iter().find_map(|item| match item {
        Item::Land {
            place: Some(_),
            altitude,
            ..
        } => Some(*altitude),
        _ => None,
    })?;
    above_sea_level(altitude, plan).ok()
}

pub(crate) fn above_sea_level(altitude: Altitude, plan: &Plan) -> Result<f64, &'static str> {
    match (altitude.above, plan.home) {
        (AltitudeDatum::SeaLevel, _) => Ok(altitude.m),
        (AltitudeDatum::Home, Some(home)) => Ok(home.altitude_m + altitude.m),
        (AltitudeDatum::Home, None) => {
            Err("is above home, and the plan has no home: set it, or give it above sea level")
        }
        (AltitudeDatum::Terrain, _) => Err(
            "is above terrain, and there are no elevations: set terrain.folder in the \
             configuration, or give it above home or sea level",
        ),
    }
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
        Item::Loiter(loiter) => {
            let message = loiter_problem(&loiter, airspeed_mps, conditions)?;
            Some(("radius", message))
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

fn loiter_problem(loiter: &Loiter, airspeed_mps: f64, conditions: &Conditions) -> Option<String> {
    let radius_m = loiter.radius_m.unwrap_or(conditions.loiter_radius_m);
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

/// With the wind behind, which gives the least time.
fn climb(leg: &Leg, conditions: &Conditions) -> Option<(&'static str, String)> {
    let seconds = leg.length_m / (leg.airspeed_mps + conditions.wind_mps);
    let rate = (leg.to.1 - leg.from.1) / seconds;
    let (what, most) = if rate > 0.0 {
        ("climb", conditions.climb_mps)
    } else {
        ("descent", conditions.descent_mps)
    };
    (rate.abs() > most).then(|| {
        let message = format!(
            "the leg needs a {what} of {:.1} m/s, and {most:.1} m/s is the most: make it longer, \
             or the difference of altitude smaller",
            rate.abs()
        );
        ("altitude", message)
    })
}

/// Whether the turn at the end of a leg has room on it, beside that at its begin, and
/// on the next one.
fn room(leg: &Leg, next: &Leg, begins_m: f64, turn: &Turn) -> Option<(&'static str, String)> {
    let lacks = |room_m: f64, needs_m: f64, which: &str| {
        // Of a leg that the turn before it fills, that one is told.
        let room_m = room_m.max(0.0);
        (needs_m > room_m).then(|| {
            let message = format!(
                "the turn needs {needs_m:.0} m of the leg {which}, which has {room_m:.0} m: move a \
                 waypoint, fly slower, or turn less"
            );
            ("turn", message)
        })
    };
    lacks(leg.length_m - begins_m, turn.before_m(), "before").or_else(|| {
        // The last one has no turn that would be checked with it.
        lacks(next.length_m, turn.after_m(), "behind")
    })
}

fn turn_of(leg: &Leg, next: &Leg, conditions: &Conditions) -> Option<Turn> {
    if !leg.turns {
        return None;
    }
    let airspeed = leg.airspeed_mps.max(next.airspeed_mps);
    let bank_rad = (PLANNED_SHARE * conditions.bank_rad.tan()).atan();
    let radius_m = smallest_circle_m(airspeed, conditions.wind_mps, bank_rad)?;
    let through_deg = (next.course_deg - leg.arrival_deg + 540.0).rem_euclid(360.0) - 180.0;
    Some(Turn::within(
        through_deg.to_radians(),
        radius_m,
        leg.within_m,
    ))
}
