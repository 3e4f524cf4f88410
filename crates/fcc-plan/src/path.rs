//! The path of a plan over the ground in all winds that it is checked for, in pieces so
//! short that nothing between them is missed.

use fcc_guidance::path::turn::{Turn, smallest_circle_m};
use fcc_guidance::route::PLANNED_SHARE;

use crate::conditions::Conditions;
use crate::item::{Item, Loiter, Place};
use crate::leg::{Leg, above_sea_level};
use crate::legs::legs;
use crate::plan::Plan;

/// The length of a piece, m.
const PIECE_M: f64 = 60.0;
/// What is seen to every side of a piece's middle, m: twice what its length needs, for
/// the distance from the path.
const REACH_M: f64 = 60.0;
/// Places of a geodesic are computed so far apart, m; between them latitude and longitude
/// change evenly, which is 0.1 m off at most below 80° of latitude.
const CHORD_M: f64 = 1_000.0;
/// Radii of turns, and of circles within a circle, that are tried: so far apart, m, and so
/// many at most.
const RADII_M: f64 = 100.0;
const MOST_RADII: f64 = 12.0;

/// A part of the path.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Part {
    Leg,
    Turn,
    Circle,
    Jump,
}

/// A piece of the path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// The number of the item that it leads to.
    pub(crate) item: usize,
    pub(crate) part: Part,
    /// Its middle, and what is to be seen around it, m.
    pub(crate) place: Place,
    pub(crate) reach_m: f64,
    /// Its lowest altitude above mean sea level, m.
    pub(crate) low_m: f64,
    /// From the begin of the leg, m.
    pub(crate) along_m: f64,
    /// The elevation of the runway that it leads from or to, m.
    pub(crate) runway_m: Option<f64>,
}

/// Where the path is, with its altitude, m.
type At = (Place, f64);

/// Visits the pieces of one item's path.
struct Walk<'a> {
    item: usize,
    part: Part,
    runway_m: Option<f64>,
    visit: &'a mut dyn FnMut(&Piece),
}

impl Walk<'_> {
    fn piece(&mut self, place: Place, reach_m: f64, low_m: f64, along_m: f64) {
        (self.visit)(&Piece {
            item: self.item,
            part: self.part,
            place,
            reach_m,
            low_m,
            along_m,
            runway_m: self.runway_m,
        });
    }

    fn line(&mut self, from: At, to: At) {
        let (length_m, course_deg, _) = from.0.to(to.0);
        let altitude_m = |at_m: f64| {
            let share = at_m / length_m.max(1e-9);
            from.1 + (to.1 - from.1) * share
        };
        let chords = (length_m / CHORD_M).ceil().max(1.0);
        let chord_m = length_m / chords;
        let pieces = (chord_m / PIECE_M).ceil().max(1.0);
        let mut begin = from.0;
        for chord in 0..chords as usize {
            let chord = chord as f64;
            let end = from.0.ahead(course_deg, (chord + 1.0) * chord_m);
            for piece in 0..pieces as usize {
                let share = (piece as f64 + 0.5) / pieces;
                let (before_m, after_m) = (
                    (chord + piece as f64 / pieces) * chord_m,
                    (chord + (piece as f64 + 1.0) / pieces) * chord_m,
                );
                let low_m = altitude_m(before_m).min(altitude_m(after_m));
                let place = between(begin, end, share);
                self.piece(place, REACH_M, low_m, 0.5 * (before_m + after_m));
            }
            begin = end;
        }
    }

    /// An arc around a centre, from a bearing through an angle, degrees.
    fn arc(&mut self, arc: &Arc, from_deg: f64, through_deg: f64) {
        let length_m = arc.radius_m * through_deg.to_radians().abs();
        let pieces = (length_m / PIECE_M).ceil().max(1.0);
        for piece in 0..pieces as usize {
            let bearing_deg = from_deg + through_deg * (piece as f64 + 0.5) / pieces;
            let place = arc.centre.ahead(bearing_deg, arc.radius_m);
            self.piece(place, arc.reach_m, arc.low_m, arc.along_m);
        }
    }

    /// The area between two radii around a place.
    fn ring(&mut self, (centre, low_m): At, (inner_m, outer_m): (f64, f64)) {
        let (radii, reach_m) = radii(inner_m, outer_m);
        for radius_m in radii {
            let arc = Arc {
                centre,
                radius_m,
                reach_m,
                low_m,
                along_m: 0.0,
            };
            self.arc(&arc, 0.0, 360.0);
        }
    }

    /// The turns from one leg onto the next, with any radius that the wind may need.
    fn turn(&mut self, leg: &Leg, next: &Leg, (least_m, most_m): (f64, f64)) {
        let through_deg = (next.course_deg - leg.arrival_deg + 540.0).rem_euclid(360.0) - 180.0;
        let side = if through_deg < 0.0 { -1.0 } else { 1.0 };
        let arrival_deg = leg.arrival_deg;
        let (radii, reach_m) = radii(least_m, most_m);
        for radius_m in radii {
            let turn = Turn::within(through_deg.to_radians(), radius_m, leg.within_m);
            let share = |at_m: f64, of: &Leg| (at_m / of.length_m).clamp(0.0, 1.0);
            let before = share(turn.before_m(), leg);
            let after = share(turn.after_m(), next);
            let begins_m = leg.to.1 + (leg.from.1 - leg.to.1) * before;
            let ends_m = next.from.1 + (next.to.1 - next.from.1) * after;
            let arc = |centre: Place| Arc {
                centre,
                radius_m,
                reach_m,
                low_m: begins_m.min(leg.to.1).min(ends_m),
                along_m: leg.length_m,
            };
            let begin = leg.to.0.ahead(arrival_deg + 180.0, turn.before_m());
            let centre = begin.ahead(arrival_deg + side * 90.0, radius_m);
            let from_deg = arrival_deg - side * 90.0;
            match turn {
                Turn::FlyBy { .. } => self.arc(&arc(centre), from_deg, through_deg),
                Turn::FlyOver { beyond_rad, .. } => {
                    let back_deg = side * beyond_rad.to_degrees();
                    let first_deg = through_deg + back_deg;
                    self.arc(&arc(centre), from_deg, first_deg);
                    // On the other side of where the first one ends.
                    let second = centre.ahead(from_deg + first_deg, 2.0 * radius_m);
                    self.arc(&arc(second), from_deg + first_deg + 180.0, -back_deg);
                }
            }
        }
    }
}

/// A circle on which an arc is.
struct Arc {
    centre: Place,
    radius_m: f64,
    reach_m: f64,
    low_m: f64,
    along_m: f64,
}

/// Radii from one to another, and what is to be seen around each, m.
fn radii(from_m: f64, to_m: f64) -> (impl Iterator<Item = f64>, f64) {
    let steps = ((to_m - from_m) / RADII_M).ceil().clamp(0.0, MOST_RADII);
    let step_m = (to_m - from_m) / steps.max(1.0);
    let radii = (0..=steps as usize).map(move |n| from_m + n as f64 * step_m);
    (radii, REACH_M.max(0.6 * step_m))
}

/// A place a share of the way from one to another, which is near.
fn between(from: Place, to: Place, share: f64) -> Place {
    let east_deg = (to.longitude_deg - from.longitude_deg + 540.0).rem_euclid(360.0) - 180.0;
    Place {
        latitude_deg: from.latitude_deg + share * (to.latitude_deg - from.latitude_deg),
        longitude_deg: from.longitude_deg + share * east_deg,
    }
}

/// The circle of an item around a place of its own.
fn circle(plan: &Plan, item: usize, conditions: &Conditions) -> Option<(Place, f64, f64)> {
    match plan.item(item)? {
        Item::Loiter(Loiter {
            place: Some(place),
            radius_m,
            clockwise,
            ..
        }) => {
            let side = if *clockwise { 1.0 } else { -1.0 };
            let radius_m = radius_m.unwrap_or(conditions.loiter_radius_m);
            Some((*place, radius_m, side))
        }
        _ => None,
    }
}

/// Where a line from or to a place touches a circle, on the side that it is flown.
fn touching(place: Place, (centre, radius_m, side): (Place, f64, f64)) -> Place {
    let (distance_m, bearing_deg, _) = centre.to(place);
    if distance_m <= radius_m {
        return centre;
    }
    let aside_deg = (radius_m / distance_m).acos().to_degrees();
    centre.ahead(bearing_deg + side * aside_deg, radius_m)
}

/// Visits the whole path of a plan whose altitudes are known: legs, turns in any wind of
/// the conditions, circles, jumps, and the circle at its end.
pub(crate) fn walk(plan: &Plan, conditions: &Conditions, visit: &mut dyn FnMut(&Piece)) {
    let legs = legs(plan, conditions, &mut Vec::new());
    let takes_off = plan
        .items
        .iter()
        .any(|item| matches!(item, Item::Takeoff { .. }));
    let home = plan.home.map(|home| (home.place, home.altitude_m));
    // At the end of the legs so far; and the altitude, which a change of it may lower.
    let mut at: Option<At> = home.filter(|_| takes_off);
    let mut low_m = f64::INFINITY;
    for (n, item) in plan.items.iter().enumerate() {
        let number = n + 1;
        let altitude = item.altitude();
        let altitude_m = altitude.and_then(|altitude| above_sea_level(altitude, plan).ok());
        let index = legs.iter().position(|leg| leg.item == number);
        let mut walk = Walk {
            item: number,
            part: Part::Leg,
            runway_m: None,
            visit: &mut *visit,
        };
        if let Some((index, leg)) = index.and_then(|index| Some((index, legs.get(index)?))) {
            walk.runway_m = match item {
                Item::Land { .. } => Some(leg.to.1),
                _ => home
                    .filter(|home| takes_off && leg.from == *home)
                    .map(|home| home.1),
            };
            let before = index.checked_sub(1).and_then(|index| legs.get(index));
            let before = before.filter(|before| before.to.0 == leg.from.0);
            let left = before.and_then(|before| circle(plan, before.item, conditions));
            let from = left.map_or(leg.from.0, |(centre, radius_m, side)| {
                touching(leg.to.0, (centre, radius_m, -side))
            });
            let to = circle(plan, number, conditions)
                .map_or(leg.to.0, |circle| touching(leg.from.0, circle));
            walk.line((from, leg.from.1.min(low_m)), (to, leg.to.1));
            low_m = f64::INFINITY;
            if let Some(next) = legs.get(index + 1).filter(|_| leg.turns) {
                walk.part = Part::Turn;
                walk.turn(leg, next, turn_radii(leg, next, conditions));
            }
            at = Some(leg.to);
        } else if let (Some(place), Some(altitude_m)) = (item.place(), altitude_m) {
            if !matches!(item, Item::Takeoff { .. } | Item::Land { .. }) {
                walk.piece(place, REACH_M, altitude_m, 0.0);
            }
            at = Some((place, altitude_m));
        }
        walk.part = Part::Circle;
        walk.runway_m = None;
        match *item {
            Item::ChangeAltitude { .. } => low_m = low_m.min(altitude_m.unwrap_or(f64::INFINITY)),
            Item::Loiter(loiter) => {
                if let Some((centre, before_m)) = at {
                    let radius_m = loiter.radius_m.unwrap_or(conditions.loiter_radius_m);
                    let inner_m = if loiter.place.is_some() {
                        radius_m
                    } else {
                        0.0
                    };
                    let lower_m = altitude_m.unwrap_or(before_m).min(before_m).min(low_m);
                    walk.ring((centre, lower_m), (inner_m, radius_m));
                    at = Some((centre, altitude_m.unwrap_or(before_m)));
                }
            }
            Item::Waypoint { .. } if number == plan.items.len() => {
                if let Some(at) = at {
                    walk.ring(at, (0.0, conditions.loiter_radius_m));
                }
            }
            Item::Jump { to, .. } => {
                let goal = plan.items.get(to.saturating_sub(1)..).and_then(|items| {
                    items
                        .iter()
                        .find_map(|item| item.place().zip(item.altitude()))
                });
                let goal = goal.and_then(|(place, altitude)| {
                    Some((place, above_sea_level(altitude, plan).ok()?))
                });
                if let Some((at, goal)) = at.zip(goal) {
                    walk.part = Part::Jump;
                    walk.line(at, goal);
                }
            }
            _ => {}
        }
    }
}

/// The radii of a turn, against the wind and with it, m.
fn turn_radii(leg: &Leg, next: &Leg, conditions: &Conditions) -> (f64, f64) {
    let airspeed_mps = leg.airspeed_mps.max(next.airspeed_mps);
    let bank_rad = (PLANNED_SHARE * conditions.bank_rad.tan()).atan();
    let of = |wind_mps| smallest_circle_m(airspeed_mps, wind_mps, bank_rad);
    let most_m = of(conditions.wind_mps).or_else(|| of(0.0)).unwrap_or(0.0);
    (of(-conditions.wind_mps).unwrap_or(0.0).min(most_m), most_m)
}
