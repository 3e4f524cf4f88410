//! Whether a leg stays inside the fence and clear of obstacles.

use fcc_guidance::fence::{Bank, Escape, Fence, Shape, Zone};
use fcc_guidance::path::turn::smallest_circle_m;
use fcc_guidance::route::{OverGround, PLANNED_SHARE, ROLL_LAG_S, RouteConfig};
use nalgebra::Vector2;

use crate::conditions::Conditions;
use crate::item::{Item, Loiter, Place};
use crate::leg::{Leg, above_sea_level};
use crate::plan::{Obstacle, Plan};
use crate::problem::Problem;

/// Points of a leg that are tried near the fence, m apart, and how many at most.
const STEP_M: f64 = 50.0;
const MOST_POINTS: f64 = 2_000.0;
/// Between floor and ceiling there is a margin at both, and the air moves, m.
const LEAST_BAND_M: f64 = 30.0;
/// Longer than banking takes, s.
const BANKING_S: f64 = 5.0;

type Found = Option<(&'static str, String)>;

/// What of the fence a leg crosses, or comes too near to turn away from, at points of it.
pub(crate) fn fence_problem(leg: &Leg, fence: &Fence<'_>, turn: &TurnAway) -> Found {
    let (to_m, high_m) = (leg.to.1, leg.from.1.max(leg.to.1));
    // On the ground at home it is below any floor.
    if let Some(message) = height_problem(to_m, fence).or_else(|| height_problem(high_m, fence)) {
        return Some(("fence", message));
    }
    if fence.zones.is_empty() {
        return None;
    }
    let mut at_m = 0.0;
    // Where most is lacking to turn away.
    let mut nearest: Option<(f64, f64)> = None;
    loop {
        let place = leg.from.0.ahead(leg.course_deg, at_m);
        let (latitude, longitude) = place.radians();
        let clearance_m = fence.clearance_m(latitude, longitude, Vector2::zeros());
        if let Some(why) = outside(fence, place) {
            let message = format!("{at_m:.0} m along the leg it is {why}: move a waypoint");
            return Some(("fence", message));
        }
        let is_straight = (turn.from_m..=leg.length_m - turn.to_m).contains(&at_m);
        let lacks_m = is_straight.then(|| turn.lacks_m(leg, fence, place, clearance_m));
        let lacks_m = lacks_m
            .flatten()
            .filter(|m| nearest.is_none_or(|(most_m, _)| *m > most_m));
        nearest = lacks_m.map(|lacks_m| (lacks_m, at_m)).or(nearest);
        if at_m >= leg.length_m {
            let (lacks_m, at_m) = nearest?;
            let message = format!(
                "{at_m:.0} m along the leg it is too near to the fence to turn away from it with \
                 this wind behind: {lacks_m:.0} m more are needed: move a waypoint"
            );
            return Some(("fence", message));
        }
        let least_m = STEP_M.max(leg.length_m / MOST_POINTS);
        at_m = (at_m + (clearance_m - turn.reach_m).max(least_m)).min(leg.length_m);
    }
}

/// What is wrong with an altitude, m.
fn height_problem(altitude_m: f64, fence: &Fence<'_>) -> Option<String> {
    if let Some(floor) = fence.floor_m.filter(|floor| altitude_m < *floor) {
        return Some(format!(
            "{altitude_m:.0} m is below its floor, {floor:.0} m"
        ));
    }
    let ceiling = fence.ceiling_m.filter(|ceiling| altitude_m > *ceiling)?;
    Some(format!(
        "{altitude_m:.0} m is above its ceiling, {ceiling:.0} m"
    ))
}

/// Heights that the fence does not permit, of items to which no leg leads, and those of
/// the fence itself.
pub(crate) fn heights(plan: &Plan, fence: &Fence<'_>, legs: &[Leg], problems: &mut Vec<Problem>) {
    if let (Some(floor), Some(ceiling)) = (fence.floor_m, fence.ceiling_m)
        && ceiling - floor < LEAST_BAND_M
    {
        let message = format!(
            "the ceiling, {ceiling:.0} m, is {:.0} m above the floor: give at least \
             {LEAST_BAND_M} m",
            ceiling - floor
        );
        problems.push(Problem::of("fence", message));
    }
    for (n, item) in plan.items.iter().enumerate() {
        let has_leg = legs.iter().any(|leg| leg.item == n + 1);
        let is_on_runway = matches!(item, Item::Takeoff { .. } | Item::Land { .. });
        let altitude = item.altitude().filter(|_| !has_leg && !is_on_runway);
        let altitude_m = altitude.and_then(|altitude| above_sea_level(altitude, plan).ok());
        if let Some(message) = altitude_m.and_then(|m| height_problem(m, fence)) {
            problems.push(Problem::of_item(n + 1, "fence", message));
        }
    }
}

/// Circles that leave the fence: those of loiters, and the one after the last item.
pub(crate) fn circles(
    plan: &Plan,
    fence: &Fence<'_>,
    conditions: &Conditions,
    problems: &mut Vec<Problem>,
) {
    let usual_m = conditions.loiter_radius_m;
    for (n, item) in plan.items.iter().enumerate() {
        let (place, radius_m) = match *item {
            Item::Loiter(Loiter {
                place: Some(place),
                radius_m,
                ..
            }) => (place, radius_m.unwrap_or(usual_m)),
            // After its last item the aircraft circles there.
            Item::Waypoint { place, .. } if n + 1 == plan.items.len() => (place, usual_m),
            _ => continue,
        };
        let (latitude, longitude) = place.radians();
        let clearance_m = fence.clearance_m(latitude, longitude, Vector2::zeros());
        let lacks_m = radius_m + conditions.fence_margin_m.unwrap_or(0.0) - clearance_m;
        if lacks_m > 0.0 {
            let message = format!(
                "the circle of {radius_m:.0} m around it needs {lacks_m:.0} m more to the fence: \
                 move it, or give a smaller radius"
            );
            problems.push(Problem::of_item(n + 1, "fence", message));
        }
    }
}

/// Why a place is not permitted.
fn outside(fence: &Fence<'_>, place: Place) -> Option<&'static str> {
    let (latitude, longitude) = place.radians();
    let depth_m = |zone: &Zone<'_>| zone.depth_m(latitude, longitude, Vector2::zeros());
    let excluded = fence
        .zones
        .iter()
        .find(|zone| !zone.inclusion && depth_m(zone) > 0.0);
    if let Some(zone) = excluded {
        return Some(match zone.shape {
            Shape::Polygon { .. } => "inside a polygon to stay outside of",
            Shape::Circle { .. } => "inside a circle to stay outside of",
        });
    }
    let clearance_m = fence.clearance_m(latitude, longitude, Vector2::zeros());
    let is_inside_one = fence
        .zones
        .iter()
        .any(|zone| zone.inclusion && depth_m(zone) > 0.0);
    (clearance_m < 0.0).then_some(if is_inside_one {
        "outside of the fence (inside one zone to stay inside of, outside of another of its \
         group, which is kept as a whole)"
    } else {
        "outside of the fence"
    })
}

/// Whether an aircraft on a leg can still turn away from the fence, in the strongest wind
/// from behind.
pub(crate) struct TurnAway {
    airspeed_mps: f64,
    wind_mps: f64,
    bank_rad: f64,
    /// How far inside of the fence it stays; none if it is not watched.
    margin_m: Option<f64>,
    /// Where farther inside than this there is room for any turn.
    reach_m: f64,
    /// The parts at the begin and the end of the leg that are parts of turns.
    from_m: f64,
    to_m: f64,
}

impl TurnAway {
    /// On a leg between turns that begin or end so far from its ends, m.
    pub(crate) fn new(leg: &Leg, conditions: &Conditions, from_m: f64, to_m: f64) -> Self {
        let (airspeed_mps, wind_mps) = (leg.airspeed_mps, conditions.wind_mps);
        let bank_rad = (PLANNED_SHARE * conditions.bank_rad.tan()).atan();
        let radius_m = smallest_circle_m(airspeed_mps, wind_mps, bank_rad);
        let margin_m = conditions.fence_margin_m;
        let banking_m = BANKING_S * (airspeed_mps + wind_mps);
        Self {
            airspeed_mps,
            wind_mps,
            bank_rad,
            margin_m,
            reach_m: margin_m.map_or(0.0, |margin_m| {
                2.0 * radius_m.unwrap_or(f64::INFINITY) + banking_m + margin_m
            }),
            from_m,
            to_m,
        }
    }

    /// How much nearer to the fence a place is than it may be, m.
    fn lacks_m(&self, leg: &Leg, fence: &Fence<'_>, place: Place, clearance_m: f64) -> Option<f64> {
        let margin_m = self.margin_m.filter(|_| clearance_m < self.reach_m)?;
        let (latitude_rad, longitude_rad) = place.radians();
        let (sin, cos) = place.to(leg.to.0).1.to_radians().sin_cos();
        let course = Vector2::new(cos, sin);
        let here = OverGround {
            latitude_rad,
            longitude_rad,
            true_airspeed_mps: self.airspeed_mps,
            ground_velocity_mps: course * (self.airspeed_mps + self.wind_mps),
            wind_mps: course * self.wind_mps,
            ..OverGround::default()
        };
        let bank = Bank {
            now_rad: 0.0,
            commanded_rad: 0.0,
            turn_rad: self.bank_rad,
            rate_radps: RouteConfig::default().bank_rate_radps,
            lag_s: ROLL_LAG_S,
        };
        let escape = Escape::best(fence, &here, &bank)?;
        (escape.clearance_m < margin_m).then_some(margin_m - escape.clearance_m)
    }
}

/// An obstacle that a leg meets.
pub(crate) fn obstacle_problem(leg: &Leg, obstacles: &[Obstacle]) -> Found {
    obstacles.iter().enumerate().find_map(|(n, obstacle)| {
        let centre = obstacle.centre;
        let plane = centre.plane();
        let seen = |place: Place| {
            let (latitude, longitude) = place.radians();
            plane.position_m(latitude, longitude)
        };
        let (from, to) = (seen(leg.from.0), seen(leg.to.0));
        let way = to - from;
        let share = (-from.dot(&way) / way.dot(&way).max(1e-9)).clamp(0.0, 1.0);
        let apart_m = (from + way * share).norm();
        let low_m = leg.from.1.min(leg.to.1);
        (apart_m < obstacle.radius_m && low_m < obstacle.top_m).then(|| {
            let message = format!(
                "the leg comes within {apart_m:.0} m of number {}, which has a radius of {:.0} m \
                 and is {:.0} m high: fly around or over it",
                n + 1,
                obstacle.radius_m,
                obstacle.top_m
            );
            ("obstacle", message)
        })
    })
}
