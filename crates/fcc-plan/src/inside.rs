//! Whether a leg stays inside the fence and clear of obstacles.

use std::f64::consts::PI;

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::path::LocalPlane;

use crate::check::Leg;
use crate::item::Place;
use crate::plan::{Fence, Obstacle, Polygon};

/// Points of a leg that are tried, m apart, and how many at most.
const STEP_M: f64 = 50.0;
const MOST_POINTS: usize = 2_000;

type Found = Option<(&'static str, String)>;

/// What of the fence a leg crosses, at points of it.
pub(crate) fn fence_problem(leg: &Leg, fence: &Fence) -> Found {
    let (low, high) = (leg.from.1.min(leg.to.1), leg.from.1.max(leg.to.1));
    // On the ground at home it is below any floor.
    if let Some(floor) = fence.floor_m.filter(|floor| leg.to.1 < *floor) {
        let message = format!(
            "{:.0} m is below its floor, {floor:.0} m",
            low.min(leg.to.1)
        );
        return Some(("fence", message));
    }
    if let Some(ceiling) = fence.ceiling_m.filter(|ceiling| high > *ceiling) {
        let message = format!("{high:.0} m is above its ceiling, {ceiling:.0} m");
        return Some(("fence", message));
    }
    if fence.polygons.is_empty() && fence.circles.is_empty() {
        return None;
    }
    points(leg).find_map(|(place, at_m)| {
        let why = outside(place, fence)?;
        let message = format!("{at_m:.0} m along the leg it is {why}: move a waypoint");
        Some(("fence", message))
    })
}

/// Points of a leg, and how far along it they are, m.
fn points(leg: &Leg) -> impl Iterator<Item = (Place, f64)> {
    let count = ((leg.length_m / STEP_M).ceil() as usize).clamp(1, MOST_POINTS);
    (0..=count).map(move |n| {
        let at_m = leg.length_m * n as f64 / count as f64;
        (leg.from.0.ahead(leg.course_deg, at_m), at_m)
    })
}

/// Why a place is not permitted.
fn outside(place: Place, fence: &Fence) -> Option<&'static str> {
    let in_circle = |centre: Place, radius_m: f64| place.to(centre).0 <= radius_m;
    let mut inclusions = 0;
    let mut included = false;
    for polygon in &fence.polygons {
        match (polygon.inclusion, contains(polygon, place)) {
            (false, true) => return Some("inside a polygon to stay outside of"),
            (false, false) => {}
            (true, inside) => {
                inclusions += 1;
                included |= inside;
            }
        }
    }
    for circle in &fence.circles {
        match (circle.inclusion, in_circle(circle.centre, circle.radius_m)) {
            (false, true) => return Some("inside a circle to stay outside of"),
            (false, false) => {}
            (true, inside) => {
                inclusions += 1;
                included |= inside;
            }
        }
    }
    (inclusions > 0 && !included).then_some("outside of the fence")
}

/// Whether the corners of a polygon go around a place, by the sum of the angles that
/// its sides are seen under: across the date line and around a pole as well.
fn contains(polygon: &Polygon, place: Place) -> bool {
    let plane = LocalPlane::at(
        place.latitude_deg.to_radians(),
        place.longitude_deg.to_radians(),
    );
    let bearing = |corner: &Place| {
        let seen = plane.position_m(
            corner.latitude_deg.to_radians(),
            corner.longitude_deg.to_radians(),
        );
        seen.y.atan2(seen.x)
    };
    let bearings: Vec<f64> = polygon.corners.iter().map(bearing).collect();
    let next = bearings.iter().cycle().skip(1);
    let sum: f64 = bearings.iter().zip(next).map(|(a, b)| wrap_pi(b - a)).sum();
    sum.abs() > PI
}

/// An obstacle that a leg meets.
pub(crate) fn obstacle_problem(leg: &Leg, obstacles: &[Obstacle]) -> Found {
    obstacles.iter().enumerate().find_map(|(n, obstacle)| {
        let centre = obstacle.centre;
        let plane = LocalPlane::at(
            centre.latitude_deg.to_radians(),
            centre.longitude_deg.to_radians(),
        );
        let seen = |place: Place| {
            plane.position_m(
                place.latitude_deg.to_radians(),
                place.longitude_deg.to_radians(),
            )
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
