//! Where an aircraft without power may land: the plan's landings, and its places to
//! return to.

use nalgebra::Vector2;

use super::pattern::{blows, course_of};
use crate::path::{LocalPlane, Motion, unit};
use crate::route::sequence::{Sequence, Steps};
use crate::route::{OverGround, Route, Runway, Step};

/// A place to land at; the greater, the better.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum SiteKind {
    /// A field: around a place to return to.
    Field,
    /// A runway of the plan, with more tail wind than it should have.
    Downwind,
    /// A runway of the plan, against the direction in which the plan lands.
    Reversed,
    /// A runway of the plan.
    Runway,
}

/// A place to land at.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Site {
    pub(super) kind: SiteKind,
    pub(super) at: LocalPlane,
    /// The direction of a runway; a field is landed on into the wind.
    course: Option<Vector2<f64>>,
    pub(super) elevation_m: f64,
    /// How far before the place it is aimed, m.
    pub(super) short_m: f64,
}

/// With more tail wind a runway is rather landed on against its direction, m/s (5 kt): the
/// handbook of the Cessna 172P (1981) adds a tenth to the landing's way for each 2 kt.
const MOST_TAIL_MPS: f64 = 2.572;
/// Against its direction the end of a runway is the beginning, and the place that is aimed
/// at is nearer to it than the length of a landing: it is aimed at so far before it, m. In
/// the plan's direction the ground roll alone needs this much behind the place (540 ft by
/// the handbook, and a quarter for 5 kt of tail wind).
const REVERSED_M: f64 = 200.0;

impl Site {
    /// The runway to land on, from where the aircraft is in its plane.
    pub(super) fn runway(&self, motion: &Motion) -> Runway {
        let into_wind = || {
            if blows(motion.wind_mps) {
                -course_of(motion.wind_mps)
            } else {
                course_of(-motion.position_m)
            }
        };
        Runway {
            at: self.at,
            course: self.course.unwrap_or_else(into_wind),
            elevation_m: self.elevation_m,
        }
    }
}

/// The sites of a route, nearest or not, with the aircraft in the plane of each.
pub(super) fn of(
    route: Route<'static>,
    ground_m: f64,
    here: OverGround,
) -> impl Iterator<Item = (Site, Motion)> {
    let runways = route.steps.iter().enumerate();
    let runways = runways.flat_map(move |(index, step)| match step {
        Step::Land {
            at, elevation_m, ..
        } => {
            let motion = here.motion_in(at);
            let from = Sequence::new(Steps::Plan(route)).approach_from(index);
            let course = from.and_then(|from| unit(-at.origin_of_m(&from)));
            let tail_mps = course.map_or(0.0, |course| course.dot(&motion.wind_mps));
            let kind = match course {
                None => SiteKind::Field,
                Some(_) if tail_mps > MOST_TAIL_MPS => SiteKind::Downwind,
                Some(_) => SiteKind::Runway,
            };
            let site = Site {
                kind,
                at: *at,
                course,
                elevation_m: *elevation_m,
                short_m: 0.0,
            };
            let reversed = Site {
                kind: SiteKind::Reversed,
                course: course.map(|course| -course),
                short_m: REVERSED_M,
                ..site
            };
            let is_open = course.is_some() && -tail_mps <= MOST_TAIL_MPS;
            [Some((site, motion)), is_open.then_some((reversed, motion))]
        }
        _ => [None, None],
    });
    let runways = runways.flatten();
    let fields = route.returns.iter().map(move |place| {
        let site = Site {
            kind: SiteKind::Field,
            at: place.at,
            course: None,
            elevation_m: ground_m,
            short_m: 0.0,
        };
        (site, here.motion_in(&place.at))
    });
    runways.chain(fields)
}

/// The elevation of the ground as far as the plan says it, m: of a landing, of the runway of
/// its take-off, or of home, which is the first place to return to, so high above it; 0
/// without one.
pub(super) fn ground_m(route: &Route<'_>, return_height_m: f64) -> f64 {
    let known = |step: &Step| match step {
        Step::Land { elevation_m, .. } => Some(*elevation_m),
        Step::Takeoff { runway, .. } => runway.map(|runway| runway.elevation_m),
        _ => None,
    };
    let home = route.returns.first();
    let home_m = home.map(|home| home.altitude_m - return_height_m);
    let planned_m = route.steps.iter().find_map(known);
    planned_m.or(home_m).unwrap_or(0.0)
}
