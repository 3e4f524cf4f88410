//! Whether an aircraft can fly a plan, in any wind up to a speed.
//!
//! Items are taken in their order; a jump is checked for its target and its end, and
//! not for the leg that it makes. Turns are those between places; where a loiter
//! begins or ends there is none.

use fcc_guidance::path::turn::{Turn, smallest_circle_m};
use fcc_guidance::route::PLANNED_SHARE;

use crate::conditions::Conditions;
use crate::flyable::{airspeed_problem, polar_problem, polar_problems};
use crate::ground::obstacle_problems;
use crate::inside::{TurnAway, circles, fence_problem, heights, obstacle_problem};
use crate::leg::Leg;
use crate::legs::legs;
use crate::outline::Outline;
use crate::plan::{Plan, limits};
use crate::problem::Problem;
use crate::runway::last_leg;

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
        // A leg to a wrong place has no climb.
        let is_misplaced =
            |problem: &Problem| problem.item == Some(leg.item) && problem.field == "place";
        let has_climb = !problems.iter().any(is_misplaced);
        let found = [
            has_climb.then(|| climb(leg, conditions)).flatten(),
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
        let has = if which == "before" && begins_m > 0.0 {
            "of which the turn at its start leaves"
        } else {
            "which has"
        };
        // Less than what is shown is none.
        (needs_m > room_m + 0.5).then(|| {
            let message = format!(
                "the turn needs {needs_m:.0} m of the leg {which}, {has} {room_m:.0} m: move a \
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
