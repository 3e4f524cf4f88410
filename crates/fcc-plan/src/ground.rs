//! Plans over terrain: altitudes above it, and what of it they come too near to.

use std::collections::BTreeMap;

use fcc_core::flight::terrain::Terrain;

use crate::conditions::Conditions;
use crate::item::{Altitude, AltitudeDatum, Place};
use crate::path::{Part, Piece, walk};
use crate::plan::{Obstacle, Plan, limits};
use crate::problem::Problem;

/// Of the height over the runway, what the path has to be above the ground on the legs
/// from and to it, less what elevations may be wrong there, m: SRTM's are within 16 m at
/// 90 % of all places (Farr et al. 2007, "The Shuttle Radar Topography Mission").
const RUNWAY_SHARE: f64 = 0.5;
const ELEVATION_ERROR_M: f64 = 16.0;

/// The plan with its altitudes above terrain as altitudes above mean sea level: each of
/// its own place, or of the last place before it; home, if there is none.
///
/// # Errors
/// Every item at whose place the elevation is not known.
pub fn resolve(plan: &Plan, terrain: &Terrain<'_>) -> Result<Plan, Vec<Problem>> {
    let mut resolved = plan.clone();
    let mut problems = Vec::new();
    let mut at = plan.home.map(|home| home.place);
    for (n, item) in resolved.items.iter_mut().enumerate() {
        at = item.place().or(at);
        let Some(altitude) = item.altitude_mut() else {
            continue;
        };
        if altitude.above != AltitudeDatum::Terrain {
            continue;
        }
        let Some(place) = at else {
            let message = "is above terrain, and there is no place before it: give a home";
            problems.push(Problem::of_item(n + 1, "altitude", message));
            continue;
        };
        let (latitude, longitude) = place.radians();
        let Some(elevation_m) = terrain.elevation_m(latitude, longitude) else {
            let message = format!("is above terrain, and {}", unknown(place));
            problems.push(Problem::of_item(n + 1, "altitude", message));
            continue;
        };
        *altitude = Altitude {
            m: elevation_m + altitude.m,
            above: AltitudeDatum::SeaLevel,
        };
    }
    problems.truncate(limits::PROBLEMS);
    if problems.is_empty() {
        Ok(resolved)
    } else {
        Err(problems)
    }
}

fn unknown(place: Place) -> String {
    format!(
        "no elevation is known at {:.5}, {:.5}: its tile is missing, or has a void there",
        place.latitude_deg, place.longitude_deg
    )
}

/// What is worst on the path to an item.
#[derive(Default)]
struct Worst {
    /// How much it lacks, m, with the ground's height.
    low: Option<(f64, f64, Piece)>,
    unknown: Option<Piece>,
}

/// Where a plan, whose altitudes above terrain are [resolved](resolve), comes nearer to
/// the ground than a margin in m: at most one place of each item's path, and one where the
/// elevation is not known.
///
/// The path is the legs, the turns in any wind of the conditions, circles, jumps, and the
/// circle after the last item, in pieces of 60 m, with the highest post of the terrain
/// within 60 m to every side. On a leg from or to a runway the margin is half of the
/// height over the runway less 16 m, if that is less.
pub fn terrain_problems(
    plan: &Plan,
    conditions: &Conditions,
    terrain: &Terrain<'_>,
    margin_m: f64,
) -> Vec<Problem> {
    let mut worst: BTreeMap<usize, Worst> = BTreeMap::new();
    walk(plan, conditions, &mut |piece| {
        let (latitude, longitude) = piece.place.radians();
        let Some(ground_m) = terrain.highest_m(latitude, longitude, piece.reach_m) else {
            let worst = worst.entry(piece.item).or_default();
            worst.unknown.get_or_insert(*piece);
            return;
        };
        let lacks_m = ground_m + required_m(piece, margin_m) - piece.low_m;
        if lacks_m > 0.0 {
            let worst = worst.entry(piece.item).or_default();
            if worst.low.is_none_or(|(most_m, ..)| lacks_m > most_m) {
                worst.low = Some((lacks_m, ground_m, *piece));
            }
        }
    });
    let mut problems = Vec::new();
    for (item, worst) in worst {
        if let Some((lacks_m, ground_m, piece)) = worst.low {
            let below_m = ground_m - piece.low_m;
            let side = if below_m > 0.0 {
                format!(", {below_m:.0} m below")
            } else {
                " over".to_owned()
            };
            let message = format!(
                "{} it is at {:.0} m{side} ground of {ground_m:.0} m, at {:.5}, {:.5}, with {:.0} m \
                 to be kept: fly {:.0} m higher there, or around it",
                part(&piece),
                piece.low_m,
                piece.place.latitude_deg,
                piece.place.longitude_deg,
                required_m(&piece, margin_m).max(0.0),
                lacks_m.ceil(),
            );
            problems.push(Problem::of_item(item, "terrain", message));
        }
        if let Some(piece) = worst.unknown {
            let message = format!("{} {}", part(&piece), unknown(piece.place));
            problems.push(Problem::of_item(item, "terrain", message));
        }
    }
    problems.truncate(limits::PROBLEMS);
    problems
}

/// Half of a piece of the path, and what latitudes are apart at least, m for a degree.
const HALF_PIECE_M: f64 = 30.0;
const LATITUDE_DEGREE_M: f64 = 110_574.0;

/// Obstacles that turns, circles and the ways of jumps meet: the first of each item.
pub(crate) fn obstacle_problems(plan: &Plan, conditions: &Conditions) -> Vec<Problem> {
    let mut obstacles: Vec<_> = plan.obstacles.iter().enumerate().collect();
    let south_deg = |(_, obstacle): &(usize, &Obstacle)| obstacle.centre.latitude_deg;
    obstacles.sort_by(|a, b| south_deg(a).total_cmp(&south_deg(b)));
    let radii = obstacles.iter().map(|(_, obstacle)| obstacle.radius_m);
    let reach_m = radii.fold(0.0, f64::max) + HALF_PIECE_M;
    let mut problems: Vec<Problem> = Vec::new();
    walk(plan, conditions, &mut |piece| {
        let is_told = problems
            .last()
            .is_some_and(|last| last.item == Some(piece.item));
        if piece.part == Part::Leg || is_told || obstacles.is_empty() {
            return;
        }
        let aside_deg = reach_m / LATITUDE_DEGREE_M;
        let latitude_deg = piece.place.latitude_deg;
        let first = obstacles.partition_point(|at| south_deg(at) < latitude_deg - aside_deg);
        let near = obstacles.get(first..).unwrap_or_default().iter();
        let near = near.take_while(|at| south_deg(at) <= latitude_deg + aside_deg);
        let met = near.into_iter().find(|(_, obstacle)| {
            piece.low_m < obstacle.top_m
                && piece.place.to(obstacle.centre).0 < obstacle.radius_m + HALF_PIECE_M
        });
        if let Some((n, obstacle)) = met {
            let message = format!(
                "{} it comes to number {}, which has a radius of {:.0} m and is {:.0} m high: fly \
                 around or over it",
                part(piece),
                n + 1,
                obstacle.radius_m,
                obstacle.top_m
            );
            problems.push(Problem::of_item(piece.item, "obstacle", message));
        }
    });
    problems
}

fn required_m(piece: &Piece, margin_m: f64) -> f64 {
    piece.runway_m.map_or(margin_m, |runway_m| {
        let above_m = piece.low_m - runway_m;
        margin_m.min(RUNWAY_SHARE * above_m - ELEVATION_ERROR_M)
    })
}

/// Where on the way a piece is.
fn part(piece: &Piece) -> String {
    match piece.part {
        Part::Leg => format!("{:.0} m along the leg", piece.along_m),
        Part::Turn => "in the turn behind it".to_owned(),
        Part::Circle => "on the circle".to_owned(),
        Part::Jump => format!("{:.0} m along the way of the jump", piece.along_m),
    }
}
