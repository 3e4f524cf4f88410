//! Speeds that an aircraft does not fly, and places where nothing is flown.

use crate::conditions::Conditions;
use crate::item::{Item, Place, Speed};
use crate::leg::Leg;
use crate::plan::Plan;
use crate::problem::Problem;

/// Nearer to a pole a compass shows no heading, and north turns too fast to fly by it,
/// degrees of latitude.
const MOST_LATITUDE_DEG: f64 = 85.0;
/// Speeds are told to a tenth, m/s: what is told as a limit is accepted.
const ROUNDING_MPS: f64 = 0.05;
/// Places so near to each other give no direction, m.
const NO_DIRECTION_M: f64 = 10.0;

fn is_between(slowest_mps: f64, fastest_mps: f64, mps: f64) -> bool {
    (slowest_mps - ROUNDING_MPS..=fastest_mps + ROUNDING_MPS).contains(&mps)
}

/// Why an indicated airspeed is not flown, m/s.
pub(crate) fn airspeed_problem(mps: f64, conditions: &Conditions) -> Option<String> {
    let (slowest, fastest) = (conditions.slowest_mps, conditions.fastest_mps);
    (!is_between(slowest, fastest, mps)).then(|| {
        format!(
            "{mps:.1} m/s is no airspeed of this aircraft: give {slowest:.1} to {fastest:.1} m/s, \
             or change autopilot.envelope"
        )
    })
}

/// Why a speed is not flown. One over the ground may be any that some wind permits.
pub(crate) fn speed_problem(speed: Speed, conditions: &Conditions) -> Option<String> {
    match speed {
        Speed::AirspeedMps(mps) => airspeed_problem(mps, conditions),
        Speed::GroundSpeedMps(mps) => {
            let (slowest, fastest) = (
                (conditions.slowest_mps - conditions.wind_mps).max(1.0),
                conditions.fastest_mps + conditions.wind_mps,
            );
            (!is_between(slowest, fastest, mps)).then(|| {
                format!(
                    "{mps:.1} m/s over the ground is not reached in any wind of up to {:.1} m/s: \
                     give {slowest:.1} to {fastest:.1} m/s",
                    conditions.wind_mps
                )
            })
        }
    }
}

fn near_pole(latitude_deg: f64) -> Option<String> {
    (latitude_deg.abs() > MOST_LATITUDE_DEG).then(|| {
        format!(
            "{latitude_deg:.2}° is too near to a pole: fly between -{MOST_LATITUDE_DEG:.0}° and \
             {MOST_LATITUDE_DEG:.0}°"
        )
    })
}

/// Home, items and rally points that are too near to a pole.
pub(crate) fn polar_problems(plan: &Plan) -> impl Iterator<Item = Problem> {
    let of = |place: Place| near_pole(place.latitude_deg);
    let home = plan.home.and_then(|home| of(home.place));
    let home = home.map(|message| Problem::of("home: latitude", message));
    let rally = plan.rally.iter().find_map(|rally| of(rally.place));
    let rally = rally.map(|message| Problem::of("rally point: latitude", message));
    let items = plan.items.iter().enumerate().filter_map(move |(n, item)| {
        let message = item.place().and_then(of)?;
        Some(Problem::of_item(n + 1, "latitude", message))
    });
    home.into_iter().chain(rally).chain(items)
}

/// A leg that leads too near to a pole, between places that are not. On a great circle the
/// sine of the course times the cosine of the latitude stays the same (Clairaut), and at its
/// highest latitude the course is east or west.
pub(crate) fn polar_problem(leg: &Leg) -> Option<(&'static str, String)> {
    let north = |course_deg: f64| course_deg.to_radians().cos();
    let passes_top = north(leg.course_deg) * north(leg.arrival_deg) < 0.0;
    if !passes_top {
        return None;
    }
    let Place { latitude_deg, .. } = leg.from.0;
    let across = leg.course_deg.to_radians().sin().abs() * latitude_deg.to_radians().cos();
    let highest_deg = across.acos().to_degrees().copysign(north(leg.course_deg));
    let message = near_pole(highest_deg)?;
    Some(("latitude", format!("the leg leads to {message}")))
}

/// Why two places give no runway its direction.
pub(crate) fn direction_problem(from: Place, to: Place, item: &Item) -> Option<String> {
    let (apart_m, ..) = from.to(to);
    (apart_m < NO_DIRECTION_M).then(|| match item {
        Item::Takeoff { .. } => format!(
            "is {apart_m:.0} m from home, so the runway has no direction: give a place on its \
             line, farther away, or none (0, 0), to take off straight ahead"
        ),
        _ => format!(
            "is {apart_m:.0} m from the place before, so the runway has no direction: move the \
             place before away, onto the runway's line"
        ),
    })
}
