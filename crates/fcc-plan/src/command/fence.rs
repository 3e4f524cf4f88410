//! Fences and rally points as commands, which is how text files have them.

use super::decode::{RADIUS_M, Refusal, whole};
use super::{ALTITUDE_M, Command, frame, id};
use crate::item::Place;
use crate::plan::{Circle, Fence, Polygon, RallyPoint, limits};

/// The commands that a fence is; its floor and ceiling have none.
pub(crate) fn fence_commands(fence: &Fence) -> impl Iterator<Item = Command> {
    let back = fence.return_point.map(|(place, altitude_m)| {
        let id = id::FENCE_RETURN_POINT;
        command(id, frame::RELATIVE, [0.0; 2], place, altitude_m)
    });
    let polygons = fence.polygons.iter().flat_map(|polygon| {
        let id = if polygon.inclusion {
            id::FENCE_POLYGON_INCLUSION
        } else {
            id::FENCE_POLYGON_EXCLUSION
        };
        let first = [polygon.corners.len() as f64, f64::from(polygon.group)];
        let corners = polygon.corners.iter();
        corners.map(move |corner| command(id, frame::GLOBAL, first, *corner, 0.0))
    });
    let circles = fence.circles.iter().map(|circle| {
        let id = if circle.inclusion {
            id::FENCE_CIRCLE_INCLUSION
        } else {
            id::FENCE_CIRCLE_EXCLUSION
        };
        let first = [circle.radius_m, f64::from(circle.group)];
        command(id, frame::GLOBAL, first, circle.centre, 0.0)
    });
    back.into_iter().chain(polygons).chain(circles)
}

/// The commands that rally points are.
pub(crate) fn rally_commands(rally: &[RallyPoint]) -> impl Iterator<Item = Command> {
    let one = |point: &RallyPoint| {
        let (id, frame) = (id::RALLY_POINT, frame::RELATIVE);
        command(id, frame, [0.0; 2], point.place, point.altitude_m)
    };
    rally.iter().map(one)
}

fn command(id: u16, frame: u8, [a, b]: [f64; 2], place: Place, altitude_m: f64) -> Command {
    let (latitude, longitude) = (place.latitude_deg, place.longitude_deg);
    Command {
        id,
        frame,
        parameters: [a, b, 0.0, 0.0, latitude, longitude, altitude_m],
    }
}

/// Puts a fence and rally points together from commands.
#[derive(PartialEq, Default)]
pub(crate) struct FenceReader {
    pub(crate) fence: Fence,
    pub(crate) rally: Vec<RallyPoint>,
    /// Corners that the last polygon still lacks.
    lacks: usize,
    corners: usize,
}

/// A place to return to, corners and circles; rally points.
const SUPPORTED: [u16; 6] = [
    id::FENCE_RETURN_POINT,
    id::FENCE_POLYGON_INCLUSION,
    id::FENCE_POLYGON_EXCLUSION,
    id::FENCE_CIRCLE_INCLUSION,
    id::FENCE_CIRCLE_EXCLUSION,
    id::RALLY_POINT,
];

impl FenceReader {
    /// Takes the next command, one of a fence or a rally point.
    pub(crate) fn take(&mut self, command: &Command) -> Result<(), Refusal> {
        if !SUPPORTED.contains(&command.id) {
            let given = command.id;
            return refused(
                "command",
                &format!("{given} is not supported: give 5000 to 5004, or 5100"),
            );
        }
        let inclusion = matches!(
            command.id,
            id::FENCE_POLYGON_INCLUSION | id::FENCE_CIRCLE_INCLUSION
        );
        match command.id {
            id::FENCE_POLYGON_INCLUSION | id::FENCE_POLYGON_EXCLUSION => {
                return self.corner(command, inclusion);
            }
            _ => self.complete()?,
        }
        let place = command.place()?;
        let altitude = |name| command.within(7, name, &ALTITUDE_M);
        match command.id {
            id::FENCE_CIRCLE_INCLUSION | id::FENCE_CIRCLE_EXCLUSION => {
                let radius_m = command.within(1, "radius", &RADIUS_M)?;
                if radius_m == 0.0 {
                    return refused("parameter 1 (radius)", "0: give the radius in m");
                }
                at_most(
                    "circles of the fence",
                    self.fence.circles.len(),
                    limits::FENCES,
                )?;
                self.fence.circles.push(Circle {
                    centre: place,
                    radius_m,
                    inclusion,
                    group: group(command, inclusion)?,
                });
            }
            id::RALLY_POINT => {
                if !matches!(command.frame, frame::RELATIVE | frame::RELATIVE_INT) {
                    return refused("frame", "a rally point is above home: give 3");
                }
                at_most("rally points", self.rally.len(), limits::RALLY_POINTS)?;
                self.rally.push(RallyPoint {
                    place,
                    altitude_m: altitude("altitude above home")?,
                });
            }
            id::FENCE_RETURN_POINT => {
                let altitude_m = altitude("altitude above home")?;
                // ArduPilot gives it no altitude, and MAVProxy writes 0 above sea level.
                let is_above_home = matches!(command.frame, frame::RELATIVE | frame::RELATIVE_INT);
                if altitude_m != 0.0 && !is_above_home {
                    return refused("frame", "a place to return to is above home: give 3");
                }
                if self.fence.return_point.is_some() {
                    return refused("command", "the fence has a place to return to: give one");
                }
                self.fence.return_point = Some((place, altitude_m));
            }
            _ => {}
        }
        Ok(())
    }

    fn corner(&mut self, command: &Command, inclusion: bool) -> Result<(), Refusal> {
        let corner = command.place()?;
        let group = group(command, inclusion)?;
        let most = limits::FENCE_CORNERS as f64;
        let count = command.within(1, "corners of the polygon", &(3.0..=most))?;
        at_most("corners of the fence", self.corners, limits::FENCE_CORNERS)?;
        self.corners += 1;
        let polygons = &mut self.fence.polygons;
        if self.lacks == 0 {
            at_most("polygons of the fence", polygons.len(), limits::FENCES)?;
            self.lacks = count as usize;
            polygons.push(Polygon {
                corners: Vec::new(),
                inclusion,
                group,
            });
        }
        if let Some(polygon) = polygons.last_mut() {
            if polygon.inclusion != inclusion {
                let what =
                    "the polygon before this one lacks corners: give as many as parameter 1 says";
                return refused("command", what);
            }
            if polygon.group != group {
                let what = format!(
                    "{group}: the corners before have {}: give all corners of a polygon the same",
                    polygon.group
                );
                return refused(GROUP, &what);
            }
            polygon.corners.push(corner);
        }
        self.lacks = self.lacks.saturating_sub(1);
        Ok(())
    }

    /// Whether the last polygon has all of its corners.
    pub(crate) fn complete(&self) -> Result<(), Refusal> {
        match self.lacks {
            0 => Ok(()),
            lacks => refused(
                "fence",
                &format!("the polygon lacks {lacks} corners: give as many as parameter 1 says"),
            ),
        }
    }
}

const GROUP: &str = "parameter 2 (inclusion group)";

/// The group of a zone to stay inside of; that of another has none.
fn group(command: &Command, inclusion: bool) -> Result<u16, Refusal> {
    match command.parameter(2) {
        given if !inclusion || given.is_nan() => Ok(0),
        given => Ok(whole(GROUP, given, 0.0..=f64::from(u16::MAX))? as u16),
    }
}

/// That one more is permitted.
pub(crate) fn at_most(name: &str, count: usize, most: usize) -> Result<(), Refusal> {
    if count < most {
        return Ok(());
    }
    refused(name, &format!("more than {most}: give at most so many"))
}

fn refused<T>(field: &str, message: &str) -> Result<T, Refusal> {
    Err((field.to_owned(), message.to_owned()))
}
