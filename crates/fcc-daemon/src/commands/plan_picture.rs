//! A plan as its table and its page show it: items, places, ground and fence.

use std::fmt::Write as _;

use fcc_core::flight::terrain::Terrain;
use fcc_plan::{AltitudeDatum, Item, Place, Plan, Polygon};
use fcc_report::{GroundLine, PlanFence, PlanLines, PlanPlace, PlanRow};

/// To a metre.
fn place_text(place: Place) -> String {
    format!("{:.5}, {:.5}", place.latitude_deg, place.longitude_deg)
}

/// A row of the table for each item.
pub(super) fn rows(plan: &Plan) -> Vec<PlanRow> {
    let mut before: Option<Place> = plan.home.map(|home| home.place);
    let row = |(n, item): (usize, &Item)| {
        let place = item.place();
        let leg = place
            .zip(before)
            .map(|(to, from)| from.to(to))
            .filter(|(length_m, ..)| *length_m > 0.1);
        before = place.or(before);
        let altitude = item.altitude().map_or_else(String::new, |altitude| {
            let above = match altitude.above {
                AltitudeDatum::SeaLevel => "sea",
                AltitudeDatum::Home => "home",
                AltitudeDatum::Terrain => "ground",
            };
            format!("{:.1} m {above}", altitude.m)
        });
        // What an item without a place does stands where the others' places stand.
        let text = item.to_string();
        let (what, value) = match text.split_once(": ").filter(|_| place.is_none()) {
            Some((what, value)) => (what.to_owned(), value.to_owned()),
            None => (text, place.map_or_else(String::new, place_text)),
        };
        [
            (n + 1).to_string(),
            what,
            value,
            altitude,
            leg.map_or_else(String::new, |(length_m, ..)| {
                format!("{:.2} km", length_m / 1e3)
            }),
            leg.map_or_else(String::new, |(_, course_deg, _)| {
                format!("{:.1}°", course_deg.rem_euclid(360.0))
            }),
        ]
    };
    let home = plan.home.map(|home| {
        let altitude = format!("{:.1} m sea", home.altitude_m);
        ["", "home", &place_text(home.place), &altitude, "", ""].map(str::to_owned)
    });
    home.into_iter()
        .chain(plan.items.iter().enumerate().map(row))
        .collect()
}

/// The places of a plan for its picture.
pub(super) fn places(plan: &Plan) -> Vec<PlanPlace> {
    let home = plan
        .home
        .map(|home| (None, home.place, home.altitude_m, None));
    let mut level_m = plan.home.map_or(0.0, |home| home.altitude_m);
    let home_m = level_m;
    let items = plan.items.iter().enumerate().filter_map(|(n, item)| {
        if let Some(altitude) = item.altitude() {
            let above_m = match altitude.above {
                AltitudeDatum::SeaLevel => 0.0,
                AltitudeDatum::Home | AltitudeDatum::Terrain => home_m,
            };
            level_m = altitude.m + above_m;
        }
        let circle_m = match item {
            Item::Loiter(loiter) => loiter.radius_m,
            _ => None,
        };
        item.place()
            .map(|place| (Some(n + 1), place, level_m, circle_m))
    });
    let all: Vec<_> = home.into_iter().chain(items).collect();
    let Some((_, origin, ..)) = all.first().copied() else {
        return Vec::new();
    };
    let mut along_m = 0.0;
    let mut last = origin;
    let place = |(item, place, altitude_m, circle_m): (_, Place, _, _)| {
        let (east_m, north_m) = from(origin, place);
        along_m += last.to(place).0;
        last = place;
        PlanPlace {
            item,
            north_m,
            east_m,
            altitude_m,
            along_m,
            circle_m,
        }
    };
    all.into_iter().map(place).collect()
}

/// The plan with its altitudes above mean sea level as far as they are known, and the
/// ground below its legs: the way to here and the elevation, m, and nothing where that is
/// not known.
pub(super) fn over_ground(
    plan: &Plan,
    terrain: Option<&Terrain<'_>>,
) -> (Plan, Vec<(f64, Option<f64>)>) {
    /// Between points of the profile, m, and how many of a leg at most.
    const STEP_M: f64 = 50.0;
    const MOST_POINTS: f64 = 2_000.0;
    let Some(terrain) = terrain else {
        return (plan.clone(), Vec::new());
    };
    let flown = fcc_plan::resolve(plan, terrain).unwrap_or_else(|_| plan.clone());
    let home = plan.home.map(|home| home.place);
    let all = home
        .into_iter()
        .chain(plan.items.iter().filter_map(Item::place));
    let all: Vec<_> = all.collect();
    let (mut ground, mut along_m) = (Vec::new(), 0.0);
    for (from, to) in all.iter().zip(all.iter().skip(1)) {
        let (length_m, course_deg, _) = from.to(*to);
        let steps = (length_m / STEP_M).ceil().clamp(1.0, MOST_POINTS) as u32;
        for step in 0..=steps {
            let at_m = length_m * f64::from(step) / f64::from(steps);
            let place = from.ahead(course_deg, at_m);
            let elevation_m = terrain.elevation_m(
                place.latitude_deg.to_radians(),
                place.longitude_deg.to_radians(),
            );
            ground.push((along_m + at_m, elevation_m));
        }
        along_m += length_m;
    }
    (flown, ground)
}

/// A place, m east and north of another one.
fn from(origin: Place, place: Place) -> (f64, f64) {
    let (distance_m, course_deg, _) = origin.to(place);
    let (sine, cosine) = course_deg.to_radians().sin_cos();
    (distance_m * sine, distance_m * cosine)
}

/// What the fence consists of, and the rally points, a line each.
pub(super) fn zones(plan: &Plan) -> String {
    let side = |inclusion: bool, group: u16| match (inclusion, group) {
        (true, 0) => "stay inside".to_owned(),
        (true, group) => format!("stay inside, group {group}"),
        (false, _) => "stay outside".to_owned(),
    };
    let mut text = String::new();
    for Polygon {
        corners,
        inclusion,
        group,
    } in &plan.fence.polygons
    {
        let side = side(*inclusion, *group);
        let _ = write!(
            text,
            "\nfence: polygon of {} corners: {side}",
            corners.len()
        );
    }
    for circle in &plan.fence.circles {
        let side = side(circle.inclusion, circle.group);
        let (at, radius_m) = (place_text(circle.centre), circle.radius_m);
        let _ = write!(
            text,
            "\nfence: circle of {radius_m:.0} m around {at}: {side}"
        );
    }
    let back = plan.fence.return_point;
    let rows = [
        ("floor, above sea level", plan.fence.floor_m),
        ("ceiling, above sea level", plan.fence.ceiling_m),
    ];
    for (name, altitude_m) in rows {
        if let Some(altitude_m) = altitude_m {
            let _ = write!(text, "\nfence: {name}: {altitude_m:.0} m");
        }
    }
    if let Some((place, altitude_m)) = back {
        let at = place_text(place);
        let _ = write!(
            text,
            "\nfence: return to {at}, {altitude_m:.0} m above home"
        );
    }
    for obstacle in &plan.obstacles {
        let (at, radius_m, top_m) = (
            place_text(obstacle.centre),
            obstacle.radius_m,
            obstacle.top_m,
        );
        let _ = write!(
            text,
            "\nobstacle: {radius_m:.0} m around {at}, up to {top_m:.0} m above sea level"
        );
    }
    if let Some(cruise_mps) = plan.cruise_mps {
        let _ = write!(text, "\ncruise speed: {cruise_mps:.1} m/s");
    }
    for point in &plan.rally {
        let (at, altitude_m) = (place_text(point.place), point.altitude_m);
        let _ = write!(text, "\nrally point: {at}, {altitude_m:.0} m above home");
    }
    text
}

/// The fence, from the plan's first place, or its own.
pub(super) fn fence(plan: &Plan) -> PlanFence {
    let home = plan.home.map(|home| home.place);
    let first = home
        .or_else(|| plan.items.iter().find_map(Item::place))
        .or_else(|| sides(plan).flatten().next());
    let permits = plan.fence.permits();
    let Some(origin) = first else {
        return PlanFence {
            sides: Vec::new(),
            permits: Box::new(|_| true),
        };
    };
    let line = |places: Vec<Place>| {
        places
            .into_iter()
            .map(|place| from(origin, place))
            .collect()
    };
    PlanFence {
        sides: sides(plan).map(line).collect(),
        permits: Box::new(move |(east_m, north_m)| {
            let course_deg = east_m.atan2(north_m).to_degrees();
            permits(origin.ahead(course_deg, east_m.hypot(north_m)))
        }),
    }
}

/// The sides of the fence, each closed.
fn sides(plan: &Plan) -> impl Iterator<Item = Vec<Place>> + '_ {
    let polygons = plan.fence.polygons.iter().map(|polygon| {
        let closed = polygon.corners.iter().chain(polygon.corners.first());
        closed.copied().collect()
    });
    let circles = plan.fence.circles.iter();
    polygons.chain(circles.map(|around| circle(around.centre, around.radius_m)))
}

/// Corners of a circle that is drawn.
const CORNERS: u32 = 90;

fn circle(centre: Place, radius_m: f64) -> Vec<Place> {
    let course_deg = |corner| 360.0 * f64::from(corner) / f64::from(CORNERS);
    let corners = (0..=CORNERS).map(|corner| centre.ahead(course_deg(corner), radius_m));
    corners.collect()
}

/// A plan on the ground: its legs, the circles of its loiters, and its fence.
pub(super) fn lines(plan: &Plan) -> PlanLines {
    let line = |places: Vec<Place>| -> GroundLine {
        let at = |place: Place| {
            (
                place.latitude_deg.to_radians(),
                place.longitude_deg.to_radians(),
            )
        };
        places.into_iter().map(at).collect()
    };
    let home = plan.home.map(|home| home.place);
    let places = plan.items.iter().filter_map(Item::place);
    let legs = home.into_iter().chain(places).collect();
    let loiters = plan.items.iter().filter_map(|item| match item {
        Item::Loiter(loiter) => Some(circle(loiter.place?, loiter.radius_m?)),
        _ => None,
    });
    PlanLines {
        path: std::iter::once(legs).chain(loiters).map(line).collect(),
        fence: sides(plan).map(line).collect(),
    }
}
